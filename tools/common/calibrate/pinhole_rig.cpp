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

//! Points that both cameras saw through their windows, moment by moment.
void commonPoints(const RigData& data, const std::vector<int>& moments, int camera1, int camera2,
                  std::vector<std::vector<Point3f>>& object, std::vector<std::vector<Point2f>>& image1,
                  std::vector<std::vector<Point2f>>& image2)
{
    for (int moment : moments)
    {
        const Moment& m = data.moments[moment];
        if (!m.hasGlass(camera1) || !m.hasGlass(camera2))
            continue;
        std::vector<Point3f> points;
        std::vector<Point2f> pixels1, pixels2;
        for (size_t i = 0; i < m.objectPoints.size(); i++)
            if (seen(m.glass[camera1][i]) && seen(m.glass[camera2][i]))
            {
                points.emplace_back(m.objectPoints[i]);
                pixels1.emplace_back(m.glass[camera1][i]);
                pixels2.emplace_back(m.glass[camera2][i]);
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
double placeBeside(const RigData& data, const std::vector<int>& moments, const Calibration& rig, int camera1, int camera2,
                   Matx33d& R, Vec3d& T)
{
    std::vector<std::vector<Point3f>> object;
    std::vector<std::vector<Point2f>> image1, image2;
    commonPoints(data, moments, camera1, camera2, object, image1, image2);
    if (object.empty())
        throw Failure(format("--pinhole-out needs a moment that camera %d and camera %d see through their windows", camera1 + 1,
                             camera2 + 1));
    straighten(*rig.cameras[camera1].camera, image1);
    straighten(*rig.cameras[camera2].camera, image2);
    const auto lens = [&](int c) { return rig.cameras[c].camera; };
    Mat K1 = lens(camera1)->cameraMatrix(), D1 = coefficientsLeft(*lens(camera1)), K2 = lens(camera2)->cameraMatrix(),
        D2 = coefficientsLeft(*lens(camera2)), E, F;
    return stereoCalibrate(object, image1, image2, K1, D1, K2, D2, data.imageSize[camera1], R, T, E, F, CALIB_FIX_INTRINSIC);
}

} // namespace

int pinholeCoefficients(const refract::RefractiveCamera& camera)
{
    const int RICHEST = 8;      // that a few views determine
    const String model = camera.lensModel();
    if (model == "fisheye")
        return FISHEYE_LENS;
    const bool isOpenCV = model == "opencv" || model == "LENSMODEL_PINHOLE" || model.find("LENSMODEL_OPENCV") == 0;
    return isOpenCV ? camera.lensParameters().rows - 4 : RICHEST;
}

CameraCalibration calibratePinholeThroughGlass(const RigData& data, int camera, const std::vector<int>& moments,
                                               int coefficients)
{
    std::vector<TargetView> views;
    bool solid = false;
    for (int i : moments)
        if (data.moments[i].hasGlass(camera))
        {
            views.push_back({data.moments[i].objectPoints, data.moments[i].glass[camera]});
            solid = solid || isSolid(data.moments[i].objectPoints);
        }
    if (views.size() < MIN_VIEWS && !solid)
        throw Failure("--pinhole-out needs at least 3 images through the window for each camera");
    CameraCalibration result;
    result.camera = calibratePinhole(views, data.imageSize[camera], coefficients, result.rms);
    return result;
}

Calibration calibratePinholeRig(const RigData& data, const std::vector<int>& moments, int coefficients)
{
    Calibration rig;
    for (int c = 0; c < data.cameraCount; c++)
        rig.add(calibratePinholeThroughGlass(data, c, moments, coefficients));
    rig.rms = rig.cameras[0].rms;
    if (rig.single())
        return rig;
    double squares = 0;
    for (const auto& link : cameraLinks(data, true))
    {
        Matx33d R;
        Vec3d T;
        squares += std::pow(placeBeside(data, moments, rig, link.first, link.second, R, T), 2);
        rig.Rs[link.second] = R*rig.Rs[link.first];
        rig.Ts[link.second] = R*rig.Ts[link.first] + T;
    }
    rig.rms = std::sqrt(squares/(data.cameraCount - 1));
    return rig;
}

} // namespace tools
