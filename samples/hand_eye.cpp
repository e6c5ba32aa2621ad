// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A robot carries a camera behind a window before a board that stays: cv::calibrateHandEye on the board's poses through the
// window, then the window from all images and the robot's poses together. Both are simulated, with the robot's errors. The
// +- takes the hand-eye transform as exact: its own errors come on top.

#include <opencv2/calib3d.hpp>
#include <opencv2/core/affine.hpp>
#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

const int VIEWS = 25;
const double PIXEL_SIGMA = 0.1, ROBOT_MM = 0.1, ROBOT_RAD = 0.01*CV_PI/180;

static Affine3d noise(RNG& random)
{
    return Affine3d(ROBOT_RAD*Vec3d(random.gaussian(1), random.gaussian(1), random.gaussian(1)),
                    ROBOT_MM*Vec3d(random.gaussian(1), random.gaussian(1), random.gaussian(1)));
}

static std::vector<Point3d> board()
{
    std::vector<Point3d> corners;
    for (int y = 0; y < 7; y++)
        for (int x = 0; x < 9; x++)
            corners.push_back(Point3d(25*(x - 4), 25*(y - 3), 0));
    return corners;
}

//! What the robot tells and the camera sees.
struct Recording
{
    std::vector<Affine3d> gripperToBase;        // as the robot believes
    std::vector<Mat> pixels;
};

static Recording record(const Ptr<refract::RefractiveCamera>& camera, const Affine3d& cameraToGripper,
                        const Affine3d& boardToBase, RNG& random)
{
    Recording recording;
    while ((int)recording.pixels.size() < VIEWS)
    {
        const Vec3d turn(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-1.2, 1.2));
        const Vec3d move(random.uniform(-40., 40.), random.uniform(-40., 40.), random.uniform(450., 650.));
        const Affine3d boardToCamera(turn, move);
        Mat_<Vec2d> pixels;
        std::vector<uchar> status;
        refract::refractiveProjectPoints(board(), boardToCamera.rvec(), boardToCamera.translation(), camera, pixels, status);
        if (countNonZero(status) > 0)
            continue;
        for (Vec2d& p : pixels)
            p += Vec2d(random.gaussian(PIXEL_SIGMA), random.gaussian(PIXEL_SIGMA));
        recording.pixels.push_back(pixels);
        recording.gripperToBase.push_back(boardToBase*boardToCamera.inv()*cameraToGripper.inv()*noise(random));
    }
    return recording;
}

//! Poses of the board through the window as it is thought to be.
static std::vector<Affine3d> boardPoses(const Recording& recording, const Ptr<refract::RefractiveCamera>& camera)
{
    std::vector<Affine3d> poses;
    for (const Mat& pixels : recording.pixels)
    {
        Vec3d rvec, tvec;
        if (!refract::refractiveSolvePnP(board(), pixels, camera, rvec, tvec))
            CV_Error(Error::StsError, "a view of the board has no pose");
        poses.push_back(Affine3d(rvec, tvec));
    }
    return poses;
}

static Affine3d handEye(const std::vector<Affine3d>& gripperToBase, const std::vector<Affine3d>& boardToCamera)
{
    std::vector<Mat> Rg, tg, Rb, tb;
    for (size_t i = 0; i < gripperToBase.size(); i++)
    {
        Rg.push_back(Mat(gripperToBase[i].rotation()));
        tg.push_back(Mat(gripperToBase[i].translation()));
        Rb.push_back(Mat(boardToCamera[i].rotation()));
        tb.push_back(Mat(boardToCamera[i].translation()));
    }
    Matx33d R;
    Vec3d t;
    calibrateHandEye(Rg, tg, Rb, tb, R, t, CALIB_HAND_EYE_PARK);
    return Affine3d(R, t);
}

//! Where the board stands: the mean over all views.
static Affine3d meanBoard(const Recording& recording, const Affine3d& cameraToGripper,
                          const std::vector<Affine3d>& boardToCamera)
{
    const Affine3d first = recording.gripperToBase[0]*cameraToGripper*boardToCamera[0];
    Vec3d turn, move;
    for (size_t i = 0; i < boardToCamera.size(); i++)
    {
        const Affine3d from = recording.gripperToBase[i]*cameraToGripper*boardToCamera[i]*first.inv();
        turn += from.rvec()/(double)boardToCamera.size();
        move += (from*first).translation()/(double)boardToCamera.size();
    }
    return Affine3d(Affine3d(turn).rotation()*first.rotation(), move);
}

int main()
{
    RNG random(3);
    const Matx33d K(1600, 0, 640, 0, 1600, 512, 0, 0, 1);
    const std::vector<double> D{ -0.1, 0.05, 0, 0 };
    const refract::GlassWindow window(Vec3d(-0.12, 0.2, 1), 12, 1.52, 30), straight(Vec3d(0, 0, 1), 12, 1.52, 30);
    const Ptr<refract::RefractiveCamera> truth = refract::RefractiveCamera::create(K, D, window);
    const Affine3d cameraToGripper(Vec3d(0.1, -0.2, 1.5), Vec3d(40, -25, 110));
    const Affine3d boardToBase(Vec3d(3, 0.1, 0.2), Vec3d(700, 50, 20));
    const Recording recording = record(truth, cameraToGripper, boardToBase, random);

    // The start: a window straight ahead, for which the hand-eye transform makes up as far as it can. So the two take turns
    // until the window stays where it is.
    const Ptr<refract::RefractiveCamera> camera = refract::RefractiveCamera::create(K, D, straight);
    const std::vector<std::vector<Point3d> > targets(VIEWS, board());
    const double turn = ROBOT_RAD*ROBOT_RAD, move = ROBOT_MM*ROBOT_MM;
    refract::GlassRigOptions options(refract::GLASS_USE_POSES);
    options.poseCovariances.assign(VIEWS, Mat::diag(Mat(Vec6d(turn, turn, turn, move, move, move))));
    refract::GlassRigResult result;
    Affine3d eye;
    double moved = 1;
    int rounds = 0;
    for (; rounds < 100 && moved > 1e-5; rounds++)
    {
        const Vec3d before = camera->window().normal;
        const std::vector<Affine3d> seen = boardPoses(recording, camera);
        eye = handEye(recording.gripperToBase, seen);
        const Affine3d stand = meanBoard(recording, eye, seen);
        std::vector<Mat> rvecs, tvecs, Rs(1, Mat::eye(3, 3, CV_64F)), Ts(1, Mat::zeros(3, 1, CV_64F));
        for (const Affine3d& gripper : recording.gripperToBase)
        {
            const Affine3d pose = eye.inv()*gripper.inv()*stand;      // board -> camera, as the robot has it
            rvecs.push_back(Mat(pose.rvec(), true));
            tvecs.push_back(Mat(pose.translation(), true));
        }
        result = refract::calibrateGlassRig(targets, std::vector<std::vector<Mat> >(),
                                            std::vector<std::vector<Mat> >(1, recording.pixels),
                                            std::vector<Ptr<refract::RefractiveCamera> >(1, camera), std::vector<int>(), Rs, Ts,
                                            rvecs, tvecs, options);
        moved = norm(camera->window().normal - before);
    }

    std::cout << format("%d rounds, %.3f px RMS; truth and result, with one standard deviation:\n", rounds, result.rms);
    bool isGood = true;
    for (int i = 0; i < 2; i++)
    {
        const double expected = truth->window().normal[i], found = camera->window().normal[i];
        const double sigma = result.stdDeviations.at<double>(8 + i);      // fx, fy, cx, cy, k1, k2, p1, p2, normal, ...
        std::cout << format("normal[%d] %8.5f  found %8.5f +- %.5f\n", i, expected, found, sigma);
        isGood = isGood && std::abs(found - expected) < 4*sigma;
    }
    const Affine3d error = eye*cameraToGripper.inv();
    std::cout << "camera -> gripper: " << cameraToGripper.translation() << "  found " << eye.translation() << " mm, turned by "
              << norm(error.rvec())*180/CV_PI << " degrees" << std::endl;
    return isGood ? 0 : 1;
}
