// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Has a camera of a rig turned since its calibration, and how far? From one pair of images of any scene, without a board.
//
//   turned_camera [--rig=calib.yml --left=left.jpg --right=right.jpg --near=430 --far=1250 --bump=0.1]
//
// --bump turns camera 2 of the calibration first, so that there is something to find: by so many degrees about x.

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/refract.hpp>
#include <iostream>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/features.hpp>
#else
#include <opencv2/features2d.hpp>
#endif

using namespace cv;

const double SEARCH = 6;            // px from the epipolar curve: what a camera may have turned
const double MAY_TURN = 0.3;        // degrees, one standard deviation
const Point2d OFFSET(0.25, 0.25);   // px, by which SIFT is off that doubles the image with cv::resize: all but with enable_precise_upscale

struct Matches
{
    std::vector<Point2d> left, right;
};

//! Pairs of features that are alike, clearly before all others; half of them may be wrong.
static Matches alike(const Mat& left, const Mat& right)
{
    const float CLEARLY = 0.8f;
    const Ptr<SIFT> sift = SIFT::create(4000);
    std::vector<KeyPoint> keys1, keys2;
    Mat descriptors1, descriptors2;
    sift->detectAndCompute(left, noArray(), keys1, descriptors1);
    sift->detectAndCompute(right, noArray(), keys2, descriptors2);
    std::vector<std::vector<DMatch> > candidates;
    BFMatcher(NORM_L2).knnMatch(descriptors1, descriptors2, candidates, 2);
    Matches matches;
    for (const std::vector<DMatch>& two : candidates)
        if (two.size() == 2 && two[0].distance < CLEARLY*two[1].distance)
        {
            matches.left.push_back(Point2d(keys1[two[0].queryIdx].pt) - OFFSET);
            matches.right.push_back(Point2d(keys2[two[0].trainIdx].pt) - OFFSET);
        }
    return matches;
}

//! R and T of a camera that turns about its own centre.
static void turn(const Vec3d& rvec, Mat& R, Mat& T)
{
    Matx33d turned;
    Rodrigues(rvec, turned);
    R = Mat(turned)*R;
    T = Mat(turned)*T;
}

//! Of R, as a rotation vector, and T: one standard deviation of a turn about each axis. T turns with R.
static Mat covarianceOfTurn(const Mat& R, const Mat& T, double std)
{
    const double STEP = 1e-3;       // Rodrigues takes turns below 1e-5 for none
    Mat byTurn(6, 3, CV_64F);
    for (int i = 0; i < 3; i++)
    {
        Mat ends[2];
        for (int side = 0; side < 2; side++)
        {
            Vec3d rvec;
            rvec[i] = side ? STEP : -STEP;
            Mat turnedR = R, turnedT = T, rotation;
            turn(rvec, turnedR, turnedT);
            Rodrigues(turnedR, rotation);
            vconcat(rotation, turnedT, ends[side]);
        }
        byTurn.col(i) = (ends[1] - ends[0])*(std/(2*STEP));
    }
    return byTurn*byTurn.t();
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{rig   | samples/data/scene/truth.yml | calibration of two cameras}"
        "{left  | samples/data/scene/glass1/scene.jpg | image of camera 1}"
        "{right | samples/data/scene/glass2/scene.jpg | image of camera 2}"
        "{near  | 430 | z of the scene in the frame of camera 1} {far | 1250 | the same, the far end}"
        "{bump  | 0.1 | degrees by which camera 2 is turned in the calibration}");
    std::vector<Ptr<refract::RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    refract::readRig(args.get<String>("rig"), cameras, Rs, Ts);
    const Mat left = imread(args.get<String>("left"), IMREAD_GRAYSCALE), right = imread(args.get<String>("right"), IMREAD_GRAYSCALE);
    if (left.empty() || right.empty() || cameras.size() != 2)
    {
        std::cerr << "a calibration of two cameras and an image of each are wanted\n";
        return 1;
    }
    const double bump = args.get<double>("bump");
    turn(Vec3d(bump*CV_PI/180, 0, 0), Rs[1], Ts[1]);
    const Mat before = Rs[1].clone();

    // Only what is near the refracted epipolar curve, within the depths of the scene, can be right.
    const Matches all = alike(left, right);
    std::vector<double> distances;
    refract::refractiveEpipolarDistance(all.left, all.right, cameras[0], cameras[1], Rs[1], Ts[1], distances, noArray(), 1,
                                        Vec2d(args.get<double>("near"), args.get<double>("far")));
    Matches near;
    for (size_t i = 0; i < distances.size(); i++)
        if (std::abs(distances[i]) < SEARCH)            // false for NaN
        {
            near.left.push_back(all.left[i]);
            near.right.push_back(all.right[i]);
        }

    // All points, and R and T of camera 2 within what it may have turned; the rest stays. Wrong matches are left out.
    const int place = (int)(cameras[0]->parameterNames().size() + cameras[1]->parameterNames().size());
    refract::BundleAdjustOptions options(refract::GLASS_FIX_NORMAL | refract::GLASS_ROBUST);
    options.rigCovariance = Mat::zeros(place + 6, place + 6, CV_64F);
    covarianceOfTurn(Rs[1], Ts[1], MAY_TURN*CV_PI/180).copyTo(options.rigCovariance(Rect(place, place, 6, 6)));
    const std::vector<std::vector<Mat> > pixels = { { Mat(near.left) }, { Mat(near.right) } };
    std::vector<Point3d> points;
    const refract::BundleAdjustResult result = refract::refractiveBundleAdjust(pixels, cameras, std::vector<int>(), Rs, Ts, noArray(),
                                                                               noArray(), points, noArray(), options);
    Vec3d turned;
    Rodrigues(Rs[1]*before.t(), turned);
    std::cout << format("%zu of %zu matches are near their curves, %d agree; %.3f px RMS\n", near.left.size(), all.left.size(),
                        countNonZero(result.inliers[0]), result.rms);
    bool isGood = true;
    const double truth[] = { -bump, 0, 0 };
    for (int i = 0; i < 3; i++)
    {
        const double found = turned[i]*180/CV_PI, std = std::sqrt(result.covariance.at<double>(place + i, place + i))*180/CV_PI;
        isGood &= std::abs(found - truth[i]) < 4*std;
        std::cout << format("camera 2 turned about %c by %7.4f +- %.4f degrees (true: %.4f)\n", "xyz"[i], found, std, truth[i]);
    }
    return isGood ? 0 : 1;
}
