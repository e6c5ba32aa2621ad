// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/survey.hpp"
#include "console/failure.hpp"
#include "console/view_names.hpp"
#include "formats/colmap_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace tools {

using cv::format;

RigidTransform transformOf(const ColmapPose& pose)
{
    const cv::Vec4d q = pose.q/cv::norm(pose.q);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    return {cv::Matx33d(1 - 2*(y*y + z*z), 2*(x*y - z*w), 2*(x*z + y*w), 2*(x*y + z*w), 1 - 2*(x*x + z*z), 2*(y*z - x*w), 2*(x*z - y*w),
                        2*(y*z + x*w), 1 - 2*(x*x + y*y)), pose.t};
}

ColmapPose colmapPoseOf(const RigidTransform& transform) { return {cv::refract::quaternionOf(transform.R), transform.t}; }

bool matchesPattern(const std::string& name, const std::string& pattern)
{
    size_t n = 0, p = 0, star = std::string::npos, from = 0;
    while (n < name.size())
        if (p < pattern.size() && pattern[p] == '*')
        {
            star = p++;
            from = n;
        }
        else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]))
        {
            n++;
            p++;
        }
        else if (star != std::string::npos)
        {
            p = star + 1;
            n = ++from;
        }
        else
            return false;
    while (p < pattern.size() && pattern[p] == '*')
        p++;
    return p == pattern.size();
}

namespace {

//! Which camera took an image, and when.
struct Taken
{
    int camera;
    std::string moment;
};

int cameraCount(const ColmapRig& rig)
{
    return (int)std::count_if(rig.sensors.begin(), rig.sensors.end(), [](const ColmapSensor& s) { return s.type == COLMAP_CAMERA; });
}

//! The rig of the model with as many cameras; null: there is none.
const ColmapRig* rigOf(const ColmapModel& model, int cameras)
{
    for (const ColmapRig& rig : model.rigs)
        if (cameraCount(rig) == cameras)
            return &rig;
    return nullptr;
}

/** Cameras in another order look elsewhere from elsewhere. The model's rig is in its own unit and seen through pinholes in water: only what
is far off tells. Throws Failure. */
void requireSameOrder(const ColmapRig& own, const RigModel& rig)
{
    const double TURN = 30.*CV_PI/180., BASE = 0.5;         // of the longest base line
    std::vector<RigidTransform> places;
    for (const ColmapSensor& sensor : own.sensors)
        if (sensor.type == COLMAP_CAMERA && (sensor.isPlaced || &sensor == &own.sensors[0]))
            places.push_back(sensor.isPlaced ? transformOf(sensor.sensor_from_rig) : RigidTransform());
    if (places.size() != rig.cameras.size())
        return;                             // COLMAP knows none of them
    std::vector<cv::Vec3d> bases;
    double longest = 0., calibrated = 0., turn = 0.;
    for (size_t c = 1; c < places.size(); c++)
    {
        const RigidTransform place = fromTo(places[0], places[c]);
        turn = std::max(turn, cv::norm(rotationVector(place.R*rig.extrinsics[c].R.t())));
        bases.push_back(place.t);
        longest = std::max(longest, cv::norm(place.t));
        calibrated = std::max(calibrated, cv::norm(rig.extrinsics[c].t));
    }
    bool isSame = turn < TURN;
    for (size_t c = 1; c < places.size() && longest > 0. && calibrated > 0.; c++)
        isSame = isSame && cv::norm(bases[c - 1]/longest - rig.extrinsics[c].t/calibrated) < BASE;
    if (!isSame)
        throw Failure("the cameras of the model's rig are not beside each other as those of the calibration: in another order? Say with "
                      "--images='GLOB' for each camera which images are its own");
}

std::vector<Taken> takenByRig(const ColmapModel& model, const ColmapRig& rig)
{
    std::map<uint32_t, int> cameraOf;
    for (const ColmapSensor& sensor : rig.sensors)
        if (sensor.type == COLMAP_CAMERA)
            cameraOf.insert({sensor.id, (int)cameraOf.size()});
    std::unordered_map<uint64_t, std::string> frameOf;
    for (const ColmapFrame& frame : model.frames)
        for (const ColmapData& data : frame.data)
            if (data.type == COLMAP_CAMERA && frame.rig == rig.id)
                frameOf[data.id] = "frame " + std::to_string(frame.id);
    std::vector<Taken> all;
    for (const ColmapImage& image : model.images)
    {
        const auto camera = cameraOf.find(image.camera);
        const auto frame = frameOf.find(image.id);
        if (camera == cameraOf.end() || frame == frameOf.end())
            throw Failure("image '" + image.name + "' is of no camera of the model's rig: give --images for each camera");
        all.push_back({camera->second, frame->second});
    }
    return all;
}

std::vector<Taken> takenByNames(const ColmapModel& model, const std::vector<std::string>& globs)
{
    std::vector<Taken> all;
    std::vector<std::vector<std::string>> names(globs.size());
    std::vector<std::vector<size_t>> images(globs.size());
    for (const ColmapImage& image : model.images)
    {
        int camera = -1;
        for (size_t c = 0; c < globs.size(); c++)
            if (matchesPattern(image.name, globs[c]))
            {
                if (camera >= 0)
                    throw Failure("image '" + image.name + "' is of two cameras: --images=" + globs[camera] + " and " + globs[c]);
                camera = (int)c;
            }
        if (camera >= 0)
        {
            names[camera].push_back(image.name);
            images[camera].push_back(all.size());
        }
        all.push_back({camera, image.name});
    }
    for (size_t c = 0; c < globs.size(); c++)
        if (names[c].empty())
            throw Failure("no image of the model is of --images=" + globs[c] + ": its names are like '" + model.images[0].name + "'");
    if (globs.size() == 1)
        return all;
    for (std::vector<std::string>& ofCamera : names)
        ofCamera = viewNames(ofCamera);
    takeOffCameras(names);
    for (size_t c = 0; c < globs.size(); c++)
        for (size_t i = 0; i < images[c].size(); i++)
            all[images[c][i]].moment = names[c][i];
    return all;
}

//! Two images of one camera are of two moments, and some of two cameras of one. Throws Failure.
void requireMoments(const ColmapModel& model, const std::vector<Taken>& taken, size_t cameras)
{
    std::map<std::pair<std::string, int>, std::string> names;
    std::map<std::string, int> moments;
    bool isShared = false;
    for (size_t i = 0; i < taken.size(); i++)
    {
        if (taken[i].camera < 0)
            continue;
        std::string& name = names[{taken[i].moment, taken[i].camera}];
        if (!name.empty())
            throw Failure(format("images '%s' and '%s' of camera %d are of one moment, by their names or by the model's frames: leave one "
                                 "out", name.c_str(), model.images[i].name.c_str(), taken[i].camera + 1));
        name = model.images[i].name;
        isShared = isShared || ++moments[taken[i].moment] > 1;
    }
    if (cameras > 1 && !isShared)
        throw Failure("no two cameras have an image of one moment: images of one moment have equal names or numbers in all cameras, and "
                      "here they are like '" + model.images[0].name + "'");
}

std::vector<Taken> takenBy(const ColmapModel& model, const RigModel& calibrated, const std::vector<std::string>& globs,
                           const std::string& folder)
{
    const int cameras = (int)calibrated.cameras.size();
    if (!globs.empty() && (int)globs.size() != cameras)
        throw Failure(format("--images is given %d time%s, and the calibration has %d camera%s: give it for each", (int)globs.size(),
                             globs.size() == 1 ? "" : "s", cameras, cameras == 1 ? "" : "s"));
    if (globs.empty() && cameras > 1)
    {
        const ColmapRig* const rig = rigOf(model, cameras);
        if (!rig)
            throw Failure(format("the calibration has %d cameras, and '%s' no rig of as many: say with --images='GLOB' for each camera "
                                 "which images are its own", cameras, folder.c_str()));
        requireSameOrder(*rig, calibrated);
        return takenByRig(model, *rig);
    }
    const auto isOfSeveral = [](const ColmapRig& rig) { return cameraCount(rig) > 1; };
    if (globs.empty() && std::any_of(model.rigs.begin(), model.rigs.end(), isOfSeveral))
        throw Failure("the calibration has one camera, and '" + folder + "' a rig of several: say with --images='GLOB' which images are "
                      "its own");
    return takenByNames(model, globs.empty() ? std::vector<std::string>{"*"} : globs);
}

int pointCount(const ColmapImage& image)
{
    return (int)std::count_if(image.pixels.begin(), image.pixels.end(), [](const ColmapPixel& p) { return p.point != NO_COLMAP_POINT; });
}

void requireSizes(const ColmapModel& model, const RigModel& rig, const std::vector<Taken>& taken)
{
    std::unordered_map<uint32_t, cv::Size> sizes;
    for (const ColmapCamera& camera : model.cameras)
        sizes[camera.id] = cv::Size((int)camera.width, (int)camera.height);
    for (size_t i = 0; i < model.images.size(); i++)
    {
        if (taken[i].camera < 0)
            continue;
        const cv::Size is = sizes[model.images[i].camera], calibrated = rig.cameras[taken[i].camera]->imageSize();
        if (!calibrated.empty() && is != calibrated)
            throw Failure(format("image '%s' is of %dx%d pixels, and camera %d was calibrated with %dx%d: are the images raw, and of this "
                                 "camera?", model.images[i].name.c_str(), is.width, is.height, taken[i].camera + 1, calibrated.width,
                                 calibrated.height));
    }
}

//! Empty: none.
std::string reasonToLeaveOut(const ColmapImage& image, const Taken& taken)
{
    if (taken.camera < 0)
        return "not one of --images";
    if (!isPose(image.cam_from_world))
        return "its pose is no rotation and place";
    const int count = pointCount(image);
    return count < MIN_POINTS ? format("%d points, %d are needed", count, MIN_POINTS) : "";
}

} // namespace

std::vector<double> errorsOf(const std::vector<cv::Vec3i>& observations, const std::vector<cv::Point2d>& pixels, const RigModel& rig,
                             const std::vector<cv::Vec3d>& rvecs, const std::vector<cv::Vec3d>& tvecs,
                             const std::vector<cv::Point3d>& points)
{
    const size_t cameras = rig.cameras.size();
    std::vector<double> errors(observations.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<std::vector<int>> rows(rvecs.size()*cameras);
    for (size_t i = 0; i < observations.size(); i++)
        rows[observations[i][0]*cameras + observations[i][1]].push_back((int)i);
    for (size_t image = 0; image < rows.size(); image++)
    {
        const size_t view = image/cameras, camera = image % cameras;
        if (rows[image].empty() || std::isnan(rvecs[view][0]))
            continue;
        const RigidTransform pose = rig.extrinsics[camera]*transformOf(rvecs[view], tvecs[view]);
        std::vector<cv::Point3d> shown;
        std::vector<cv::Point2d> projected;
        for (int row : rows[image])
            shown.push_back(points[observations[row][2]]);
        cv::refract::refractiveProjectPoints(shown, rotationVector(pose.R), pose.t, rig.cameras[camera], projected);
        for (size_t k = 0; k < projected.size(); k++)
            errors[rows[image][k]] = cv::norm(projected[k] - pixels[rows[image][k]]);
    }
    return errors;
}

std::vector<cv::Vec3d> vectorsOf(const std::vector<cv::Mat>& arrays)
{
    std::vector<cv::Vec3d> vectors;
    for (const cv::Mat& array : arrays)
        vectors.push_back(cv::Vec3d(array.ptr<double>()));
    return vectors;
}

void Survey::leaveOut(int view)
{
    for (size_t i = 0; i < viewOf.size(); i++)
        if (viewOf[i] == view)
        {
            leftOut.push_back({model.images[i].name, "no pose fits"});
            viewOf[i] = cameraOf[i] = -1;
        }
}

Survey surveyOf(ColmapModel model, const RigModel& rig, const std::vector<std::string>& globs, const std::string& folder)
{
    const std::vector<Taken> taken = takenBy(model, rig, globs, folder);
    requireMoments(model, taken, rig.cameras.size());
    requireSizes(model, rig, taken);
    Survey survey;
    std::unordered_map<uint64_t, int> indexOf;
    for (size_t i = 0; i < model.points.size(); i++)
        indexOf[model.points[i].id] = (int)i;
    std::map<std::string, int> views;
    for (size_t i = 0; i < model.images.size(); i++)
    {
        const ColmapImage& image = model.images[i];
        const std::string reason = reasonToLeaveOut(image, taken[i]);
        const bool isUsed = reason.empty();
        survey.cameraOf.push_back(isUsed ? taken[i].camera : -1);
        survey.viewOf.push_back(isUsed ? views.insert({taken[i].moment, (int)views.size()}).first->second : -1);
        if (!isUsed)
        {
            survey.leftOut.push_back({image.name, reason});
            continue;
        }
        if (survey.viewOf[i] == (int)survey.views.size())
            survey.views.push_back(taken[i].moment);
        for (size_t k = 0; k < image.pixels.size(); k++)
            if (image.pixels[k].point != NO_COLMAP_POINT)
            {
                survey.observations.push_back({survey.viewOf[i], taken[i].camera, indexOf[image.pixels[k].point]});
                survey.pixels.push_back({image.pixels[k].x - COLMAP_CORNER, image.pixels[k].y - COLMAP_CORNER});
                survey.sources.push_back({(int)i, (int)k});
            }
    }
    survey.model = std::move(model);
    if (survey.views.size() < 2)
        throw Failure(format("'%s' has %d image%s with a pose and %d points or more: at least two are needed", folder.c_str(),
                             survey.imageCount(), survey.imageCount() == 1 ? "" : "s", MIN_POINTS));
    return survey;
}

} // namespace tools
