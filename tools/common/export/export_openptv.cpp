// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/export_files.hpp"
#include "console/failure.hpp"

#include <cmath>

/* OpenPTV knows flat windows: what it can be told is exact. formats/openptv.cpp has its formula, and where its frames point. Its world
begins in the scene's medium, before the window of camera 1, with the axes of that camera, y up. What scx scales differs between its
versions, so it is 1, and the shape of a pixel is that of ptv.par. */

namespace tools {

namespace {

using cv::Matx33d;
using cv::Vec3d;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

const double PIXEL = 0.01;          // mm: any will do, as its lens is in mm, too
const double CORNER = 0.5;
const Matx33d FLIP(1, 0, 0, 0, -1, 0, 0, 0, -1);

std::string lineOf(const std::vector<double>& numbers)
{
    std::string text;
    for (double number : numbers)
        text += cv::format("%s%.17g", text.empty() ? "" : " ", number);
    return text + "\n";
}

//! One pane, the same before all cameras; refuses what OpenPTV has none like.
GlassWindow paneOf(const Calibration& calibration, size_t c)
{
    const GlassWindow window = calibration.cameras[c].camera->window(), first = calibration.cameras[0].camera->window();
    const std::string name = cv::format("camera%zu", c + 1);
    if (window.shape != cv::refract::WINDOW_FLAT || window.thickness.size() != 1)
        throw Failure(name + " looks through a window that OpenPTV has none like: it has flat panes of one layer");
    for (const cv::Vec2d& wedge : window.wedge)
        if (wedge != cv::Vec2d())
            throw Failure(name + " looks through a window with a wedge, and OpenPTV has none: calibrate with --wedge-std=0");
    if (window.thickness != first.thickness || window.index != first.index || window.innerIndex != first.innerIndex
        || window.outerIndex != first.outerIndex
        || calibration.cameras[c].camera->imageSize() != calibration.cameras[0].camera->imageSize())
        throw Failure(name + " has another pane, other media or another image size than camera1, and OpenPTV has one of each for all "
                      "cameras: calibrate with --exact, or give thickness and indices with a deviation of 0");
    return window;
}

//! Width of a pixel over its height.
double shapeOfPixels(const RefractiveCamera& camera)
{
    const cv::Mat K = camera.cameraMatrix();
    return K.at<double>(1, 1)/K.at<double>(0, 0);
}

double thicknessOf(const GlassWindow& window) { return window.thickness[0]; }

//! @param origin of the world, in the camera's frame
std::string orientationOf(const RefractiveCamera& camera, const Matx33d& cam_from_world, const Vec3d& origin, const std::string& name)
{
    const GlassWindow window = camera.window();
    const Matx33d dm = (FLIP*cam_from_world).t();
    const Vec3d centre = cam_from_world.t()*(-origin);
    const double toOrigin = window.normal.dot(origin) - window.distance - thicknessOf(window);
    if (!(toOrigin > 0))
        throw Failure(name + "'s window is not before the same water as that of camera 1, where OpenPTV's world begins");
    const Vec3d glass = cam_from_world.t()*window.normal*(-toOrigin);
    const cv::Mat K = camera.cameraMatrix();
    const double c = K.at<double>(1, 1)*PIXEL;
    const double xh = (K.at<double>(0, 2) + CORNER - camera.imageSize().width/2.)*PIXEL*shapeOfPixels(camera);
    const double yh = -(K.at<double>(1, 2) + CORNER - camera.imageSize().height/2.)*PIXEL;
    return lineOf({centre[0], centre[1], centre[2]})
        + lineOf({std::atan2(-dm(1, 2), dm(2, 2)), std::asin(std::max(-1., std::min(1., dm(0, 2)))), std::atan2(-dm(0, 1), dm(0, 0))})
        + "\n"
        + lineOf({dm(0, 0), dm(0, 1), dm(0, 2)}) + lineOf({dm(1, 0), dm(1, 1), dm(1, 2)}) + lineOf({dm(2, 0), dm(2, 1), dm(2, 2)}) + "\n"
        + lineOf({xh, yh}) + lineOf({c}) + "\n" + lineOf({glass[0], glass[1], glass[2]});
}

//! k1 k2 k3 p1 p2 scx she; refuses a lens that it has none like.
std::string lensOf(const RefractiveCamera& camera, const std::string& name)
{
    const cv::Mat K = camera.cameraMatrix();
    const std::vector<double> p = camera.lensParameters();
    std::vector<double> D(p.begin() + std::min<size_t>(4, p.size()), p.end());
    D.resize(std::max<size_t>(D.size(), 5), 0.);
    const bool isKnown = camera.lensModel() == "opencv" && K.at<double>(0, 1) == 0. && D[3] == 0.
        && std::all_of(D.begin() + 5, D.end(), [](double k) { return k == 0.; });
    if (!isKnown)
        throw Failure(name + " has a lens that OpenPTV has none like: of OpenCV's it has k1, k2, k3 and p1");
    const bool isBent = std::any_of(D.begin(), D.end(), [](double k) { return k != 0.; });
    const double MIDDLE = 1e-9;
    if (isBent && std::max(std::abs(K.at<double>(0, 2) + CORNER - camera.imageSize().width/2.),
                           std::abs(K.at<double>(1, 2) + CORNER - camera.imageSize().height/2.)) > MIDDLE)
        throw Failure(name + cv::format("'s distortion is about (%.6g, %.6g), and OpenPTV's is about the middle of the image: calibrate "
                                        "with a lens file whose centre is there, or without distortion", K.at<double>(0, 2),
                                        K.at<double>(1, 2)));
    const double c = K.at<double>(1, 1)*PIXEL;
    return lineOf({D[0]/std::pow(c, 2), D[1]/std::pow(c, 4), D[4]/std::pow(c, 6), 0., -D[2]/c, 1., 0.});
}

} // namespace

std::vector<ExportFile> openPtvFiles(const Calibration& calibration)
{
    const GlassWindow first = paneOf(calibration, 0);
    const double beyond = 2*(first.distance + thicknessOf(first));
    const Vec3d origin = first.normal*beyond;
    const cv::Size size = calibration.cameras[0].camera->imageSize();
    const double shape = shapeOfPixels(*calibration.cameras[0].camera), SAME = 1e-9;
    std::string names, control = lineOf({1}) + lineOf({0}) + lineOf({1});        // high pass, all cameras, TIFF
    for (double number : {(double)size.width, (double)size.height, PIXEL*shape, PIXEL, 0., first.innerIndex, first.index[0],
                          first.outerIndex, thicknessOf(first)})
        control += lineOf({number});
    std::vector<ExportFile> files;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        paneOf(calibration, c);
        const RefractiveCamera& camera = *calibration.cameras[c].camera;
        const RigidTransform& place = calibration.extrinsics[c];
        if (std::abs(shapeOfPixels(camera) - shape) > SAME)
            throw Failure(cv::format("camera%zu has another fx/fy than camera1, and OpenPTV has one shape of pixels for all cameras",
                                     c + 1));
        const std::string name = cv::format("camera%zu", c + 1), image = cv::format("cam%zu.tif", c + 1);
        files.push_back({image + ".ori", orientationOf(camera, place.R*FLIP, place.apply(origin), name)});
        files.push_back({image + ".addpar", lensOf(camera, name)});
        names += image + "\n" + image + "\n";
    }
    files.push_back({"ptv.par", lineOf({(double)calibration.cameras.size()}) + names + control});
    return files;
}

} // namespace tools
