// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/lens_maker.hpp"
#include "formats/colmap_model.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <cmath>

namespace tools {

using cv::format;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

namespace {

//! Of COLMAP: its parameters are one or two focal lengths, the centre, and these coefficients.
struct ColmapLens
{
    int id;
    const char* name;
    int focals, coefficients;
    const char* lens;           //!< null: OpenCV has none like it
};

const ColmapLens COLMAP_MODELS[] = {
    {0, "SIMPLE_PINHOLE", 1, 0, "opencv"}, {1, "PINHOLE", 2, 0, "opencv"}, {2, "SIMPLE_RADIAL", 1, 1, "opencv"},
    {3, "RADIAL", 1, 2, "opencv"}, {4, "OPENCV", 2, 4, "opencv"}, {5, "OPENCV_FISHEYE", 2, 4, "fisheye"},
    {6, "FULL_OPENCV", 2, 8, "opencv"}, {7, "FOV", 2, 1, nullptr}, {8, "SIMPLE_RADIAL_FISHEYE", 1, 1, "fisheye"},
    {9, "RADIAL_FISHEYE", 1, 2, "fisheye"}, {10, "THIN_PRISM_FISHEYE", 2, 8, nullptr},
    {11, "RAD_TAN_THIN_PRISM_FISHEYE", 2, 12, nullptr}, {12, "SIMPLE_DIVISION", 1, 1, nullptr}, {13, "DIVISION", 2, 1, nullptr},
    {14, "SIMPLE_FISHEYE", 1, 0, "fisheye"}, {15, "FISHEYE", 2, 0, "fisheye"}, {16, "EUCM", 2, 2, nullptr},
    {17, "EQUIRECTANGULAR", 0, 0, nullptr}};     // width, height

const ColmapLens* findColmapLens(const std::string& name)
{
    const auto found = std::find_if(std::begin(COLMAP_MODELS), std::end(COLMAP_MODELS),
                                    [&](const ColmapLens& m) { return m.name == name; });
    return found == std::end(COLMAP_MODELS) ? nullptr : found;
}

size_t countOf(const ColmapLens& model) { return (size_t)(model.focals + 2 + model.coefficients); }

} // namespace

cv::Ptr<RefractiveCamera> makeCamera(const std::string& model, const cv::Matx33d& cameraMatrix, std::vector<double> coefficients,
                                     const cv::Size& size)
{
    const std::vector<size_t> places = model == "fisheye" ? std::vector<size_t>{0, 4} : std::vector<size_t>{0, 4, 5, 8, 12, 14};
    while (!coefficients.empty() && coefficients.back() == 0. && coefficients.size() > places.back())
        coefficients.pop_back();
    const auto fitting = std::lower_bound(places.begin(), places.end(), coefficients.size());
    if (fitting == places.end())
        throw Failure(format("its lens has %zu coefficients, more than OpenCV's model has", coefficients.size()));
    coefficients.resize(*fitting, 0.);
    return possible("lens", [&] {
        const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::createByName(model, cameraMatrix, coefficients);
        camera->setImageSize(size);
        return camera;
    });
}

cv::Size imageSizeOf(double width, double height)
{
    const int LARGEST = 1 << 20;
    if (!(width >= 1 && width <= LARGEST && height >= 1 && height <= LARGEST))
        throw Failure(format("its image size is %gx%g", width, height));
    return cv::Size((int)width, (int)height);
}

cv::Ptr<RefractiveCamera> makeColmapCamera(const std::string& name, const std::vector<double>& parameters, const cv::Size& size)
{
    const ColmapLens* model = findColmapLens(name);
    if (!model)
        throw Failure("its camera model '" + name + "' is none of COLMAP's that are known here");
    if (!model->lens)
        throw Failure("its camera model " + name + " has no equal among OpenCV's: undistort the images there, or calibrate with OPENCV, "
                      "FULL_OPENCV or OPENCV_FISHEYE");
    if (parameters.size() != countOf(*model))
        throw Failure(format("%s has %zu parameters, here are %zu", name.c_str(), countOf(*model), parameters.size()));
    const double* p = parameters.data();
    const double* centre = p + model->focals;
    return makeCamera(model->lens, cameraMatrixOf(p[0], p[model->focals - 1], centre[0] - COLMAP_CORNER, centre[1] - COLMAP_CORNER),
                      std::vector<double>(centre + 2, p + parameters.size()), size);
}

std::string colmapModelName(int id, size_t& count)
{
    for (const ColmapLens& model : COLMAP_MODELS)
        if (model.id == id)
        {
            count = countOf(model);
            return model.name;
        }
    return "";
}

bool isColmapModel(const std::string& name) { return findColmapLens(name) != nullptr; }

GlassWindow makePort(const std::string& type, const std::vector<double>& p)
{
    const bool isDome = type == "DOMEPORT" || type == "domeport";
    if (!isDome && type != "FLATPORT" && type != "flatport")
        throw Failure("its port '" + type + "' is not known here: FLATPORT and DOMEPORT are");
    if (p.size() != 8)
        throw Failure(format("a port has 8 parameters, here are %zu", p.size()));
    return possible("port", [&] {
        GlassWindow window = isDome ? GlassWindow::dome({p[0], p[1], p[2]}, p[3], p[4], p[6], p[7])
                                    : GlassWindow({p[0], p[1], p[2]}, p[4], p[6], p[3], p[7]);
        window.innerIndex = p[5];
        window.check();
        return window;
    });
}

} // namespace tools
