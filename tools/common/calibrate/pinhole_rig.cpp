// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/pinhole_rig.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/failure.hpp"
#include <opencv2/calib3d.hpp>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const size_t MIN_VIEWS = 3;         // of a flat board, to determine a lens
const size_t MIN_POINTS = 4;        // in common, of a view

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
        if (points.size() < MIN_POINTS)
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
