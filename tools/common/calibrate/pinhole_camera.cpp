// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/pinhole_camera.hpp"
#include "console/failure.hpp"
#include "target/target.hpp"
#include <opencv2/calib3d.hpp>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MIN_POINTS = 4;       // of a view that is to have a pose

//! Keeps what was seen; calib3d knows no NaN and wants float.
void seenPoints(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels,
                std::vector<Point3f>& seenObject, std::vector<Point2f>& seenPixels)
{
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            seenObject.push_back(object[i]);
            seenPixels.push_back(pixels[i]);
        }
}

void roundTo(double step, Mat& numbers)
{
    for (auto it = numbers.begin<double>(); it != numbers.end<double>(); it++)
        *it = std::round(*it/step)*step;
}

//! Flags of ours as those of OpenCV.
int translated(int fixed, const std::vector<std::pair<int, int>>& flags)
{
    int result = 0;
    for (const auto& flag : flags)
        result |= fixed & flag.first ? flag.second : 0;
    return result;
}

int calibrateCameraFlags(int coefficients, int fixed)
{
    const int FIXED = translated(fixed, {{GLASS_FIX_K1, CALIB_FIX_K1}, {GLASS_FIX_K2, CALIB_FIX_K2}, {GLASS_FIX_K3, CALIB_FIX_K3},
                                         {GLASS_FIX_K4, CALIB_FIX_K4}, {GLASS_FIX_K5, CALIB_FIX_K5}, {GLASS_FIX_K6, CALIB_FIX_K6},
                                         {GLASS_FIX_TANGENT_DIST, CALIB_ZERO_TANGENT_DIST}});
    for (const auto& lens : pinholeLenses())
        if (lens.second.coefficients == coefficients)
            return lens.second.flags | FIXED;
    CV_Error_(Error::StsBadArg, ("coefficients is %d; cv::calibrateCamera has no such lens model", coefficients));
}

struct PinholeViews
{
    std::vector<std::vector<Point3f>> object;
    std::vector<std::vector<Point2f>> image;
    bool onBoards = true;               // all of them z = 0, which is all that calibrateCamera can start from
};

PinholeViews seenViews(const std::vector<TargetView>& views)
{
    PinholeViews result;
    for (const TargetView& view : views)
    {
        std::vector<Point3f> o;
        std::vector<Point2f> i;
        seenPoints(view.objectPoints, view.pixels, o, i);
        if ((int)o.size() < MIN_POINTS)
            continue;
        for (const Point3f& X : o)
            result.onBoards = result.onBoards && X.z == 0;
        result.object.push_back(o);
        result.image.push_back(i);
    }
    return result;
}

//! The best of several starts; infinite if there is none.
double calibrateFromFocalLengths(const PinholeViews& views, Size imageSize, int flags, const TermCriteria& criteria, Mat& K, Mat& D)
{
    double best = std::numeric_limits<double>::infinity();
    for (double focal : {0.7, 1.2, 2., 3.5, 6.})                // in image widths
        try
        {
            Mat cameraMatrix = (Mat_<double>(3, 3) << focal*imageSize.width, 0, 0.5*(imageSize.width - 1),
                                0, focal*imageSize.width, 0.5*(imageSize.height - 1), 0, 0, 1);
            Mat distCoeffs, rvecs, tvecs;
            const double rms = calibrateCamera(views.object, views.image, imageSize, cameraMatrix, distCoeffs, rvecs, tvecs,
                                               flags | CALIB_USE_INTRINSIC_GUESS, criteria);
            if (rms < best && cameraMatrix.at<double>(0, 0) > 0)
            {
                best = rms;
                K = cameraMatrix;
                D = distCoeffs;
            }
        }
        catch (const cv::Exception&) {}         // from there it finds nothing
    return best;
}

/** From one focal length: k1 to k4 are 0 at first, as all together leave the right valley from a crude start. */
double calibrateFisheyeFrom(double focal, const PinholeViews& views, Size imageSize, int fixed, Matx33d& K, Vec4d& D)
{
    K = Matx33d(focal, 0, 0.5*(imageSize.width - 1), 0, focal, 0.5*(imageSize.height - 1), 0, 0, 1);
    D = Vec4d();
    const int flags = fisheye::CALIB_USE_INTRINSIC_GUESS | fisheye::CALIB_RECOMPUTE_EXTRINSIC | fisheye::CALIB_FIX_SKEW
        | translated(fixed, {{GLASS_FIX_K1, fisheye::CALIB_FIX_K1}, {GLASS_FIX_K2, fisheye::CALIB_FIX_K2},
                             {GLASS_FIX_K3, fisheye::CALIB_FIX_K3}, {GLASS_FIX_K4, fisheye::CALIB_FIX_K4}});
    const int noBend = fisheye::CALIB_FIX_K1 | fisheye::CALIB_FIX_K2 | fisheye::CALIB_FIX_K3 | fisheye::CALIB_FIX_K4;
    const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS, 100, 1e-10);
    double rms = std::numeric_limits<double>::infinity();
    for (int stage : {noBend, 0})
    {
        std::vector<Mat> rvecs, tvecs;          // it takes none that are not empty
        rms = fisheye::calibrate(views.object, views.image, imageSize, K, D, rvecs, tvecs, flags | stage, criteria);
    }
    return checkRange(K) && checkRange(D) && K(0, 0) > 0 && K(1, 1) > 0 ? rms : std::numeric_limits<double>::infinity();
}

Ptr<RefractiveCamera> calibrateFisheye(const PinholeViews& views, Size imageSize, int fixed, double& rms)
{
    if (!views.onBoards)
        CV_Error(Error::StsNotImplemented, "cv::fisheye::calibrate takes flat targets alone: give --camera with a lens to start "
                                           "from, and --free=intrinsics");
    Mat cameraMatrix, distCoeffs;
    rms = std::numeric_limits<double>::infinity();
    for (double focal : {0.2, 0.3, 0.45, 0.7, 1.1})             // in image widths; 1/pi: a half circle across the image
        try
        {
            Matx33d K;
            Vec4d D;
            const double error = calibrateFisheyeFrom(focal*imageSize.width, views, imageSize, fixed, K, D);
            if (error >= rms)
                continue;
            rms = error;
            cameraMatrix = Mat(K, true);
            distCoeffs = Mat(D, true);
        }
        catch (const cv::Exception&) {}         // from there it finds nothing
    if (cameraMatrix.empty())
        CV_Error(Error::StsNoConv, "cv::fisheye::calibrate finds no fisheye camera for these points");
    roundTo(1e-5, cameraMatrix);
    roundTo(1e-6, distCoeffs);
    return RefractiveCamera::createFisheye(cameraMatrix, distCoeffs);
}

const size_t MIN_VIEWS = 3;         // of a flat board, to determine a lens
const size_t MIN_COMMON = 4;         // points of a view that two cameras see

//! Points that both cameras saw through their windows, view by view.
void commonPoints(const RigData& data, const std::vector<int>& views, int camera1, int camera2,
                  std::vector<std::vector<Point3f>>& object, std::vector<std::vector<Point2f>>& image1,
                  std::vector<std::vector<Point2f>>& image2)
{
    for (int i : views)
    {
        const View& view = data.views[i];
        if (!view.hasGlass(camera1) || !view.hasGlass(camera2))
            continue;
        std::vector<Point3f> points;
        std::vector<Point2f> pixels1, pixels2;
        for (size_t k = 0; k < view.objectPoints.size(); k++)
            if (seen(view.glass[camera1][k]) && seen(view.glass[camera2][k]))
            {
                points.emplace_back(view.objectPoints[k]);
                pixels1.emplace_back(view.glass[camera1][k]);
                pixels2.emplace_back(view.glass[camera2][k]);
            }
        if (points.size() < MIN_COMMON)
            continue;
        object.push_back(points);
        image1.push_back(pixels1);
        image2.push_back(pixels2);
    }
}

bool isFisheye(const refract::RefractiveCamera& camera) { return camera.lensModel() == "fisheye"; }

//! cv::stereoCalibrate knows no fisheye: what a pinhole with the same matrix would see.
void straighten(const refract::RefractiveCamera& camera, std::vector<std::vector<Point2f>>& images)
{
    if (isFisheye(camera))
        for (std::vector<Point2f>& image : images)
            fisheye::undistortPoints(image, image, camera.cameraMatrix(), camera.distCoeffs(), noArray(), camera.cameraMatrix());
}

Mat coefficientsLeft(const refract::RefractiveCamera& camera)
{
    return isFisheye(camera) ? Mat() : camera.distCoeffs();
}

//! R and T of camera 2 from camera 1; returns cv::stereoCalibrate's RMS.
double placeBeside(const RigData& data, const std::vector<int>& views, const Calibration& rig, int camera1, int camera2,
                   Matx33d& R, Vec3d& T)
{
    std::vector<std::vector<Point3f>> object;
    std::vector<std::vector<Point2f>> image1, image2;
    commonPoints(data, views, camera1, camera2, object, image1, image2);
    if (object.empty())
        throw Failure(format("--pinhole-out needs a view that camera %d and camera %d see through their windows", camera1 + 1,
                             camera2 + 1));
    straighten(*rig.cameras[camera1].camera, image1);
    straighten(*rig.cameras[camera2].camera, image2);
    const auto lens = [&](int c) { return rig.cameras[c].camera; };
    Mat K1 = lens(camera1)->cameraMatrix(), D1 = coefficientsLeft(*lens(camera1)), K2 = lens(camera2)->cameraMatrix(),
        D2 = coefficientsLeft(*lens(camera2)), E, F;
    return stereoCalibrate(object, image1, image2, K1, D1, K2, D2, data.imageSize[camera1], R, T, E, F,
                           CALIB_FIX_INTRINSIC | CALIB_USE_LU);
}

} // namespace

const std::map<std::string, PinholeLens>& pinholeLenses()
{
    const int PRISM = CALIB_RATIONAL_MODEL | CALIB_THIN_PRISM_MODEL;
    static const std::map<std::string, PinholeLens> lenses = {
        {"pinhole", {0, CALIB_FIX_K1 | CALIB_FIX_K2 | CALIB_FIX_K3 | CALIB_ZERO_TANGENT_DIST}},
        {"opencv4", {4, CALIB_FIX_K3}},
        {"opencv5", {5, 0}},
        {"opencv8", {8, CALIB_RATIONAL_MODEL}},
        {"opencv12", {12, PRISM}},
        {"opencv14", {14, PRISM | CALIB_TILTED_MODEL}},
        {"fisheye", {FISHEYE_LENS, 0}}};
    return lenses;
}

Ptr<RefractiveCamera> calibratePinhole(const std::vector<TargetView>& targetViews, Size imageSize, int coefficients, int fixed,
                                       double& rms, int solver)
{
    const PinholeViews views = seenViews(targetViews);
    if (coefficients == FISHEYE_LENS)
    {
        const Ptr<RefractiveCamera> camera = calibrateFisheye(views, imageSize, fixed, rms);
        camera->setImageSize(imageSize);
        return camera;
    }
    const int flags = calibrateCameraFlags(coefficients, fixed) | solver;
    const TermCriteria criteria(TermCriteria::COUNT + TermCriteria::EPS, 200, 1e-13);
    Mat cameraMatrix, distCoeffs, rvecs, tvecs;
    if (views.onBoards)
        rms = calibrateCamera(views.object, views.image, imageSize, cameraMatrix, distCoeffs, rvecs, tvecs, flags, criteria);
    else
        rms = calibrateFromFocalLengths(views, imageSize, flags, criteria, cameraMatrix, distCoeffs);
    if (cameraMatrix.empty())
        CV_Error(Error::StsNoConv, "cv::calibrateCamera finds no pinhole camera for these points");
    distCoeffs = distCoeffs.reshape(1, 1).colRange(0, coefficients).clone();
    // LAPACK need not sum in the same order twice; its last digits, far below what images tell, would show in all that follows.
    roundTo(1e-5, cameraMatrix);
    roundTo(1e-6, distCoeffs);
    Ptr<RefractiveCamera> camera = RefractiveCamera::create(cameraMatrix, distCoeffs);
    camera->setImageSize(imageSize);
    return camera;
}

std::vector<TargetView> targetViewsOf(const RigData& data, int camera, bool glass)
{
    std::vector<TargetView> views;
    for (const View& view : data.views)
        if (!(glass ? view.glass : view.direct)[camera].empty())
            views.push_back({view.objectPoints, (glass ? view.glass : view.direct)[camera]});
    return views;
}

bool determineLens(const std::vector<TargetView>& views)
{
    const size_t LEAST_OF_FLAT = 3;
    return views.size() >= LEAST_OF_FLAT
        || std::any_of(views.begin(), views.end(), [](const TargetView& v) { return isSolid(v.objectPoints); });
}

bool isSolid(const std::vector<Point3d>& objectPoints)
{
    const double FLAT = 0.02;           // thickness over width
    if (objectPoints.size() < 6)
        return false;
    Mat points = Mat(objectPoints).reshape(1).clone(), mean, spread;
    reduce(points, mean, 0, REDUCE_AVG);
    points -= repeat(mean, points.rows, 1);
    SVD::compute(points, spread, SVD::NO_UV);
    return spread.at<double>(2) > FLAT*spread.at<double>(0);
}

int pinholeCoefficients(const RigModel& rig, int camera)
{
    const int RICHEST = 8;      // that a few views determine
    const String model = rig.cameras[camera]->lensModel();
    if (model == "fisheye")
        return FISHEYE_LENS;
    if (model != "opencv" && model != "LENSMODEL_PINHOLE" && model.find("LENSMODEL_OPENCV") != 0)
        return RICHEST;
    const Mat known = rig.known.empty() ? Mat() : rig.known[camera].covariance, lens = rig.cameras[camera]->lensParameters();
    int count = lens.rows - INTRINSICS;
    const auto isLeftOut = [&](int i) { return known.at<double>(i, i) > 0 || lens.at<double>(i) == 0; };
    if (known.empty() || !std::isnan(known.at<double>(0, 0)) || count > RICHEST)
        return count;           // of a file
    while (count > 0 && isLeftOut(INTRINSICS + count - 1))
        count--;
    return count == 0 ? 0 : count <= 4 ? 4 : count == 5 ? 5 : RICHEST;
}

CameraCalibration calibratePinholeThroughGlass(const RigData& data, int camera, const std::vector<int>& views,
                                               int coefficients)
{
    std::vector<TargetView> targetViews;
    bool solid = false;
    for (int i : views)
        if (data.views[i].hasGlass(camera))
        {
            targetViews.push_back({data.views[i].objectPoints, data.views[i].glass[camera]});
            solid = solid || isSolid(data.views[i].objectPoints);
        }
    if (targetViews.size() < MIN_VIEWS && !solid)
        throw Failure("--pinhole-out needs at least 3 images through the window for each camera");
    CameraCalibration result;
    result.camera = calibratePinhole(targetViews, data.imageSize[camera], coefficients, 0, result.rms, CALIB_USE_LU);
    return result;
}

Calibration calibratePinholeRig(const RigData& data, const std::vector<int>& views, int coefficients)
{
    Calibration rig;
    for (int c = 0; c < data.cameraCount; c++)
        rig.add(calibratePinholeThroughGlass(data, c, views, coefficients));
    rig.rms = rig.cameras[0].rms;
    if (rig.single())
        return rig;
    double squares = 0;
    for (const auto& link : cameraLinks(data, true))
    {
        Matx33d R;
        Vec3d T;
        squares += std::pow(placeBeside(data, views, rig, link.first, link.second, R, T), 2);
        rig.extrinsics[link.second] = RigidTransform{R, T}*rig.extrinsics[link.first];
    }
    rig.rms = std::sqrt(squares/(data.cameraCount - 1));
    return rig;
}

} // namespace tools
