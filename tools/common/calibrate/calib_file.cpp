// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/window_face.hpp"
#include "camera/storage.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/keys.hpp"
#include "formats/foreign_rig.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace tools {

using cv::FileNode;
using cv::FileStorage;
using cv::format;
using cv::refract::RefractiveCamera;

namespace {

const double UNIT = 1e-4;       // more than rounding leaves of a normal's length

double readNumber(const FileNode& node, double otherwise)
{
    return node.isReal() || node.isInt() ? (double)node : otherwise;
}

std::vector<double> readList(const FileNode& node)
{
    std::vector<double> numbers;
    if (node.isSeq())
        for (const FileNode& number : node)
            numbers.push_back(readNumber(number, NAN));
    return numbers;
}

void readEstimate(const FileNode& node, CameraCalibration& calibration)
{
    calibration.rms = readNumber(node["rms"], -1.);
    const FileNode window = node["glass_window_std"];
    if (!window.isMap())
        return;
    WindowStd& result = calibration.windowStd;
    result.normalDeg = readList(window["normal_deg"]);
    result.distance = readNumber(window["distance"], 0.);
    result.center = readList(window["center"]);
    result.axisDeg = readList(window["axis_deg"]);
    result.radius = readNumber(window["radius"], 0.);
    result.thickness = readList(window["thickness"]);
    result.index = readList(window["index"]);
    result.outerIndex = readNumber(window["outer_index"], 0.);
    result.wedge = readList(window["wedge"]);
    result.curvature = readNumber(window["curvature"], 0.);
}

void writeCamera(FileStorage& fs, const CameraCalibration& calibration)
{
    calibration.camera->write(fs);
    const WindowStd& window = calibration.windowStd;
    if (window.isKnown())
    {
        fs << "glass_window_std" << "{";
        if (window.center.empty())
            fs << "normal_deg" << window.normalDeg << "distance" << window.distance;
        else
            fs << "center" << window.center << "radius" << window.radius;
        if (!window.axisDeg.empty())
            fs << "axis_deg" << window.axisDeg;
        fs << "thickness" << window.thickness << "index" << window.index << "outer_index" << window.outerIndex;
        if (!window.wedge.empty())
            fs << "wedge" << window.wedge;
        if (calibration.camera->window().shape == cv::refract::WINDOW_BENT)
            fs << "curvature" << window.curvature;
        fs << "}";
    }
    if (calibration.rms >= 0)
        fs << "rms" << calibration.rms;
}

bool isCameraModel(const std::string& filename)
{
    return std::filesystem::path(filename).extension() == ".cameramodel";
}

void requireDistortion(const FileNode& camera, const std::string& filename)
{
    if (!camera["camera_matrix"].empty() && camera["distortion_coefficients"].empty())
        throw Failure("'" + filename + "' has no distortion_coefficients for its camera_matrix: is it cut short or edited? For "
                      "a lens without distortion write distortion_coefficients: [ 0., 0., 0., 0., 0. ]");
}

CameraCalibration readCamera(const FileNode& node, const std::string& filename, const cv::Ptr<RefractiveCamera>& camera)
{
    CameraCalibration calibration;
    calibration.camera = camera;
    requireDistortion(node, filename);
    calibration.windowGiven = !node["glass_window"].empty();
    const std::vector<double> normal = readList(node["glass_window"]["normal"]);
    calibration.normalLength = normal.empty() ? 1. : cv::norm(normal);
    readEstimate(node, calibration);
    return calibration;
}

//! What the residuals told: not below 0, and finite.
double readNotNegative(const FileStorage& fs, const char* key, double otherwise, const std::string& filename)
{
    const FileNode node = fs[key];
    const double number = readNumber(node, NAN);
    if (!node.empty() && !(number >= 0. && std::isfinite(number)))
        throw Failure("'" + filename + "': " + key + " must be a number, and not below 0: was the file edited? Calibrate "
                      "again");
    return node.empty() ? otherwise : number;
}

std::string cameraName(size_t camera) { return "camera" + std::to_string(camera + 1); }

//! What follows R and T of a camera after the first: nothing for the second, then its number.
std::string placeSuffix(size_t camera) { return camera == 1 ? "" : std::to_string(camera + 1); }

//! The map of a camera; one alone is at the top level.
FileNode cameraNode(const FileStorage& fs, size_t camera)
{
    const FileNode root = fs.isOpened() ? fs.root() : FileNode();
    return root[cameraName(0)].empty() ? root : root[cameraName(camera)];
}

//! Of each camera, and of the file.
void requireKnownKeys(const FileStorage& fs, const std::string& filename)
{
    const std::vector<std::string> ofCamera = {"image_width", "image_height", "camera_matrix", "distortion_coefficients", "lens_model",
                                               "glass_window", "glass_window_std"};
    std::vector<std::string> known = {"window_of_camera", "covariance", "residual_sigma", "degrees_of_freedom", "target_square",
                                      "placement_std", "channel", "verdict", "contradictions", "weak_points", "window_serial",
                                      "calibration_time"};
    known.insert(known.end(), ofCamera.begin(), ofCamera.end());
    if (!fs.isOpened())
        return;
    requireNoMisspelling(fs.root(), known, filename);
    for (size_t c = 0; !fs[cameraName(c)].empty(); c++)
        requireNoMisspelling(fs[cameraName(c)], ofCamera, filename);
}

//! The same of a file that cannot be read, whatever the reason.
void explainByKeys(const std::string& filename)
{
    try
    {
        requireKnownKeys(cv::refract::openStorage(filename), filename);
    }
    catch (const cv::Exception&)        // no such file
    {
    }
}

//! What the module reads of a file.
struct Rig
{
    std::vector<cv::Ptr<RefractiveCamera>> cameras;
    std::vector<cv::Mat> Rs, Ts;
    std::vector<int> windows;
    cv::Mat covariance;
    bool isForeign = false;             //!< of another program, which the module does not read
};

void requireFew(const Rig& rig, const std::string& filename)
{
    if (rig.cameras.size() > MAX_CAMERAS)
        throw Failure(format("'%s' has %zu cameras; the tools are for up to %d", filename.c_str(), rig.cameras.size(), MAX_CAMERAS));
}

//! Of another program; no cameras: it is not.
Rig readForeign(const std::string& filename)
{
    Rig rig;
    const auto foreign = isCameraModel(filename) ? std::optional<ForeignRig>() : readForeignRig(filename);
    if (!foreign)
        return rig;
    rig.isForeign = true;
    rig.cameras = foreign->cameras;
    rig.Rs = foreign->Rs;
    rig.Ts = foreign->Ts;
    requireFew(rig, filename);
    return rig;
}

Rig readRig(const std::string& filename)
{
    Rig rig = readForeign(filename);
    if (rig.isForeign && rig.cameras.size() > 1 && rig.Rs.empty())
        throw Failure(format("'%s' has %zu cameras, and does not say where they are from each other (R, T): calibrate them together "
                             "with refract_calib, with --camera and --camera2 for their lenses", filename.c_str(), rig.cameras.size()));
    if (rig.isForeign && rig.Rs.empty())
    {
        rig.Rs.push_back(cv::Mat::eye(3, 3, CV_64F));
        rig.Ts.push_back(cv::Mat::zeros(3, 1, CV_64F));
    }
    if (rig.isForeign)
        return rig;
    if (!std::filesystem::is_regular_file(filename) && !isCameraModel(filename))
        throw Failure("there is no calibration file '" + filename + "'");
    try
    {
        cv::refract::readRig(filename, rig.cameras, rig.Rs, rig.Ts, rig.windows, rig.covariance);
    }
    catch (const cv::Exception& e)
    {
        explainByKeys(filename);
        throw Failure(e.err + ". If it is what refract_calib wrote, was it edited or cut short? Calibrate again. (Of other programs it is "
                      "no file of cameras that is known here: doc/formats.md)");
    }
    requireFew(rig, filename);
    return rig;
}

//! Where a camera's parameters begin in the covariance of its file.
int firstParameter(const std::vector<cv::Ptr<RefractiveCamera>>& cameras, size_t camera)
{
    int first = 0;
    for (size_t c = 0; c < camera; c++)
        first += (int)cameras[c]->parameterNames().size();
    return first;
}

} // namespace

void Calibration::add(const CameraCalibration& camera, const RigidTransform& cam_from_cam1)
{
    cameras.push_back(camera);
    extrinsics.push_back(cam_from_cam1);
}

bool isOfRig(const std::string& filename)
{
    if (isCameraModel(filename))
        return false;
    const Rig foreign = readForeign(filename);
    return foreign.isForeign ? foreign.cameras.size() > 1 : !cv::refract::openStorage(filename)[cameraName(0)].empty();
}

KnownLens readLens(const std::string& filename, const std::string& name)
{
    size_t which = 0;
    while (!name.empty() && cameraName(which) != name)
        which++;
    const Rig foreign = readForeign(filename);
    if (foreign.isForeign && which >= foreign.cameras.size())
        throw Failure(format("'%s' has %zu cameras, and no %s", filename.c_str(), foreign.cameras.size(), name.c_str()));
    if (foreign.isForeign)
        return {foreign.cameras[which], cv::Mat()};
    KnownLens lens{RefractiveCamera::read(filename, name), cv::Mat()};
    if (isCameraModel(filename))
        return lens;
    const FileStorage fs = cv::refract::openStorage(filename);
    requireDistortion(cameraNode(fs, which), filename);
    if (fs["covariance"].empty())
        return lens;
    const Rig rig = readRig(filename);
    const int first = firstParameter(rig.cameras, which), count = lens.camera->lensParameters().rows;
    lens.covariance = rig.covariance(cv::Rect(first, first, count, count)).clone();
    return lens;
}

std::vector<cv::Size> Calibration::imageSizes() const
{
    std::vector<cv::Size> sizes;
    for (const CameraCalibration& camera : cameras)
        sizes.push_back(camera.camera->imageSize());
    return sizes;
}

Calibration readCalibration(const std::string& filename)
{
    const Rig rig = readRig(filename);
    Calibration calibration;
    calibration.windows = rig.windows;
    calibration.covariance = rig.covariance;
    // Of a .cameramodel and of other programs' files, nothing else is known.
    const bool isOwn = !isCameraModel(filename) && !rig.isForeign;
    const FileStorage fs = isOwn ? cv::refract::openStorage(filename) : FileStorage();
    requireKnownKeys(fs, filename);
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        calibration.add(readCamera(cameraNode(fs, c), filename, rig.cameras[c]), {rig.Rs[c], rig.Ts[c]});
        if (rig.isForeign)
            calibration.cameras[c].windowGiven = refracts(rig.cameras[c]->window());
    }
    calibration.rms = readNumber(fs["rms"], -1.);
    calibration.sigma = readNotNegative(fs, "residual_sigma", -1., filename);
    calibration.dof = readNotNegative(fs, "degrees_of_freedom", 0., filename);
    if (fs["unit"].isString())
        fs["unit"] >> calibration.unit;
    calibration.square = readNumber(fs["target_square"], 0.);
    calibration.placementStd = readNotNegative(fs, "placement_std", -1., filename);
    if (fs["channel"].isString())
        calibration.channel = channelOf(fs["channel"]);
    calibration.label = readLabel(fs);
    calibration.provenance = readProvenance(fs, filename);
    if (fs["verdict"].isString())
        fs["verdict"] >> calibration.verdict;
    if (fs["contradictions"].isSeq())
        fs["contradictions"] >> calibration.contradictions;
    if (fs["weak_points"].isSeq())
        fs["weak_points"] >> calibration.weakPoints;
    if (fs["calibration_time"].isString())
        fs["calibration_time"] >> calibration.time;
    if (fs["command"].isString())
        fs["command"] >> calibration.command;
    return calibration;
}

void requireWindows(const Calibration& calibration, const std::string& filename, bool noWindow, const std::string& option)
{
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const CameraCalibration& camera = calibration.cameras[c];
        const std::string which = calibration.single() ? "" : format(" for camera %d", (int)c + 1);
        if (!camera.windowGiven && !noWindow)
            throw Failure("'" + filename + "' has no glass_window" + which + ": calibrate through the glass with refract_calib"
                          + (option.empty() ? "" : ", or say " + option + " if there is none"));
        if (camera.windowGiven && noWindow)
            throw Failure("'" + filename + "' has a glass_window" + which + ": leave " + option + " out");
        if (!(std::abs(camera.normalLength - 1.) < UNIT))
            throw Failure("'" + filename + "': the normal" + which + format(" has the length %g in place of 1: was the file "
                          "edited? Calibrate again, or divide its three numbers by that", camera.normalLength));
    }
}

void warnOfContradictions(const Calibration& calibration, const std::string& filename, const Command& command)
{
    if (!calibration.contradictions.empty())
        command.warn("'" + filename + "' was marked as not usable when it was made, and the errors of its results may be larger than "
                     "their +-: " + calibration.contradictions[0] + "; calibrate again with the right values");
}

Calibration readCalibration(const std::string& filename, bool noWindow, const Command& command, const std::string& option)
{
    const Calibration calibration = readCalibration(filename);
    requireWindows(calibration, filename, noWindow, option);
    warnOfContradictions(calibration, filename, command);
    return calibration;
}

void writeCameras(FileStorage& fs, const Calibration& calibration)
{
    if (calibration.single())
    {
        writeCamera(fs, calibration.cameras[0]);
        return;
    }
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        fs << cameraName(c) << "{";
        writeCamera(fs, calibration.cameras[c]);
        fs << "}";
    }
    for (size_t c = 1; c < calibration.cameras.size(); c++)
        fs << "R" + placeSuffix(c) << cv::Mat(calibration.extrinsics[c].R) << "T" + placeSuffix(c) << cv::Mat(calibration.extrinsics[c].t);
    if (!calibration.windows.empty())
        fs << "window_of_camera" << calibration.windows;
    if (calibration.rms >= 0)
        fs << "rms" << calibration.rms;
}

void writeCalibration(const std::string& filename, const Calibration& calibration)
{
    writeStorage(filename, ".yml", [&](FileStorage& fs)
    {
        fs << "command" << calibration.command << "refract_version" << REFRACT_VERSION << "opencv_version" << CV_VERSION
           << "calibration_time" << calibration.time;
        if (!calibration.verdict.empty())
            fs << "verdict" << calibration.verdict;
        if (!calibration.contradictions.empty())
            fs << "contradictions" << calibration.contradictions;
        if (!calibration.weakPoints.empty())
            fs << "weak_points" << calibration.weakPoints;
        writeLabel(fs, calibration.label);
        if (!calibration.unit.empty())
            fs << "unit" << calibration.unit;
        if (calibration.square > 0)
            fs << "target_square" << calibration.square;
        if (calibration.placementStd >= 0)
            fs << "placement_std" << calibration.placementStd;
        if (calibration.channel != BRIGHTNESS)
            fs << "channel" << nameOf(calibration.channel);
        writeCameras(fs, calibration);
        if (calibration.dof > 0)
            fs << "residual_sigma" << calibration.sigma << "degrees_of_freedom" << calibration.dof;
        if (!calibration.covariance.empty())
            fs << "covariance" << calibration.covariance;
        writeProvenance(fs, calibration.provenance);
    });
}

} // namespace tools
