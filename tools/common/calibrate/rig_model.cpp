// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rig_model.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "window/wedge.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

RigModel RigModel::clone() const
{
    RigModel copy = *this;
    for (Ptr<RefractiveCamera>& camera : copy.cameras)
        camera = camera->clone();
    return copy;
}

void RigModel::add(const Ptr<RefractiveCamera>& camera, const RigidTransform& cam_from_cam1)
{
    cameras.push_back(camera);
    extrinsics.push_back(cam_from_cam1);
}

bool RigModel::ownsWindow(int camera) const
{
    for (int other = 0; other < camera; other++)
        if (sharesWindow(camera, other))
            return false;
    return true;
}

bool RigModel::sharesWindow(int camera, int other) const
{
    return camera == other || (!windows.empty() && windows[camera] == windows[other]);
}

int countWindows(const RigModel& rig)
{
    int count = 0;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        count += rig.ownsWindow(c);
    return count;
}

GlassWindow seenFrom(const GlassWindow& window, const RigidTransform& there)
{
    GlassWindow seen = windowInFrame(window, there.R, there.t);
    if (!isRound(seen))
        seen.distance = std::max(0., seen.distance);
    return seen;
}

void shareWindow(RigModel& rig, int owner)
{
    const GlassWindow window = rig.cameras[owner]->window();
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        if (c != owner && rig.sharesWindow(owner, c))
            rig.cameras[c]->setWindow(seenFrom(window, fromTo(rig.extrinsics[owner], rig.extrinsics[c])));
}

Ptr<RefractiveCamera> copyWithWindow(const Ptr<RefractiveCamera>& camera, const GlassWindow& window)
{
    const Ptr<RefractiveCamera> copy = camera->clone();
    copy->setWindow(window);
    return copy;
}

std::vector<std::vector<int>> camerasWithoutWindows(const RigModel& rig)
{
    std::vector<std::vector<int>> sets(1);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        if (!refracts(rig.cameras[c]->window()))
            continue;
        std::vector<int> ofPane;
        for (int k = 0; k < (int)rig.cameras.size(); k++)
            if (rig.sharesWindow(c, k))
                ofPane.push_back(k);
        sets[0].push_back(c);
        sets.push_back({c});
        sets.push_back(ofPane);
    }
    std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) {
        return a.size() != b.size() ? a.size() > b.size() : a < b; });
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    if (sets.back().empty())            // no camera has any
        sets.pop_back();
    return sets;
}

std::string takenWithoutWindow(const std::vector<int>& cameras, int count)
{
    std::string names;
    for (int c : cameras)
        names += (names.empty() ? "" : ", ") + std::to_string(c + 1);
    const bool all = (int)cameras.size() == count, one = cameras.size() == 1;
    return "images" + (all ? std::string() : (one ? " of camera " : " of cameras ") + names)
        + (one ? " taken without the window: they fit with no glass before the camera"
               : " taken without the windows: they fit with no glass before the cameras");
}

void poseInCamera(const RigModel& rig, int camera, Vec3d& rvec, Vec3d& tvec)
{
    if (camera == 0)
        return;
    const RigidTransform& cam_from_cam1 = rig.extrinsics[camera];
    rvec = rotationVector(cam_from_cam1.R*rotationMatrix(rvec));
    tvec = cam_from_cam1.apply(tvec);
}

std::vector<Point3d> pointsOfTarget(const RigModel& rig, std::vector<Point3d> objectPoints)
{
    for (Point3d& X : objectPoints)
        X *= rig.targetScale;
    return objectPoints;
}

void poseInImage(const RigModel& rig, int camera, bool glass, Vec3d& rvec, Vec3d& tvec)
{
    if (glass && !rig.targetCovariance.empty())
    {
        rvec = rotationVector(rig.targetMotion.R*rotationMatrix(rvec));
        tvec = rig.targetMotion.apply(tvec);
    }
    poseInCamera(rig, camera, rvec, tvec);
}

void poseFromImage(const RigModel& rig, int camera, bool glass, Vec3d& rvec, Vec3d& tvec)
{
    poseInCamera1(rig, camera, rvec, tvec);
    if (!glass || rig.targetCovariance.empty())
        return;
    rvec = rotationVector(rig.targetMotion.R.t()*rotationMatrix(rvec));
    tvec = rig.targetMotion.inverse(tvec);
}

void poseInCamera1(const RigModel& rig, int camera, Vec3d& rvec, Vec3d& tvec)
{
    const RigidTransform& cam_from_cam1 = rig.extrinsics[camera];
    rvec = rotationVector(cam_from_cam1.R.t()*rotationMatrix(rvec));
    tvec = cam_from_cam1.inverse(tvec);
}

RigModel modelOf(const Calibration& calibration)
{
    RigModel rig;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        rig.add(calibration.cameras[c].camera, calibration.extrinsics[c]);
    return rig;
}

Calibration firstTwoCameras(const Calibration& rig)
{
    Calibration pair = rig;
    pair.cameras.resize(2);
    pair.extrinsics.resize(2);
    pair.windows.resize(std::min(rig.windows.size(), (size_t)2));
    pair.provenance.sources.clear();            // they speak of all cameras
    if (rig.covariance.empty())
        return pair;
    const RigModel all = modelOf(rig);
    const int ofPair = columnsOf(all, 1).end, place = extrinsicsColumn(all, 1);
    const Range here[] = {Range(0, ofPair), Range(ofPair, ofPair + 6)}, there[] = {Range(0, ofPair), Range(place, place + 6)};
    pair.covariance = Mat(ofPair + 6, ofPair + 6, CV_64F, Scalar(0));       // Mat::zeros would be written into the rig's
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            rig.covariance(there[i], there[j]).copyTo(pair.covariance(here[i], here[j]));
    return pair;
}

std::vector<Point3d> triangulate(const RigModel& rig, const std::vector<std::vector<Point2d>>& pixels, int method,
                                 OutputArray reprojectionErrors)
{
    std::vector<Mat> Rs, Ts;
    for (const RigidTransform& place : rig.extrinsics)
    {
        Rs.push_back(Mat(place.R));
        Ts.push_back(Mat(place.t));
    }
    std::vector<Point3d> points;
    triangulateRefractive(rig.cameras, Rs, Ts, pixels, points, noArray(), method, 1., noArray(), noArray(), reprojectionErrors);
    return points;
}

Calibration calibrationOf(const RigModel& rig)
{
    Calibration calibration;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        calibration.cameras.push_back({camera, WindowStd(), -1.});
    calibration.windows = rig.windows;
    calibration.extrinsics = rig.extrinsics;
    return calibration;
}

} // namespace tools
