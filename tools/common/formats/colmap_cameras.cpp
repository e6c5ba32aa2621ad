// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/colmap_cameras.hpp"
#include "formats/foreign_file.hpp"

#include <algorithm>
#include <sstream>

/* COLMAP: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[], one camera a line. */

namespace tools {

using cv::format;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

namespace {

//! Of COLMAP: its parameters are one or two focal lengths, the centre, and these coefficients.
struct ColmapLens
{
    const char* name;
    size_t focals, coefficients;
    const char* lens;           //!< null: OpenCV has none like it
};

const ColmapLens COLMAP_LENSES[] = {        // by id
    {"SIMPLE_PINHOLE", 1, 0, "opencv"}, {"PINHOLE", 2, 0, "opencv"}, {"SIMPLE_RADIAL", 1, 1, "opencv"}, {"RADIAL", 1, 2, "opencv"},
    {"OPENCV", 2, 4, "opencv"}, {"OPENCV_FISHEYE", 2, 4, "fisheye"}, {"FULL_OPENCV", 2, 8, "opencv"}, {"FOV", 2, 1, nullptr},
    {"SIMPLE_RADIAL_FISHEYE", 1, 1, "fisheye"}, {"RADIAL_FISHEYE", 1, 2, "fisheye"}, {"THIN_PRISM_FISHEYE", 2, 8, nullptr},
    {"RAD_TAN_THIN_PRISM_FISHEYE", 2, 12, nullptr}, {"SIMPLE_DIVISION", 1, 1, nullptr}, {"DIVISION", 2, 1, nullptr},
    {"SIMPLE_FISHEYE", 1, 0, "fisheye"}, {"FISHEYE", 2, 0, "fisheye"}, {"EUCM", 2, 2, nullptr},
    {"EQUIRECTANGULAR", 0, 0, nullptr}};    // width, height

const ColmapLens& colmapLens(const std::string& name)
{
    for (const ColmapLens& lens : COLMAP_LENSES)
        if (name == lens.name)
            return lens;
    throw Failure("its camera model '" + name + "' is none of COLMAP's that are known here");
}

bool isColmapModel(const std::string& name)
{
    return std::any_of(std::begin(COLMAP_LENSES), std::end(COLMAP_LENSES), [&](const ColmapLens& lens) { return name == lens.name; });
}

//! What the record of a camera begins with, byte by byte.
struct BinaryHead
{
    int32_t id, model;
    uint64_t width, height;

    std::string name() const { return (size_t)model < std::size(COLMAP_LENSES) ? COLMAP_LENSES[model].name : std::to_string(model); }
};

} // namespace

cv::Ptr<RefractiveCamera> makeColmapCamera(const std::string& name, const std::vector<double>& parameters, const cv::Size& size)
{
    const ColmapLens& model = colmapLens(name);
    if (!model.lens)
        throw Failure("its camera model " + name + " has no equal among OpenCV's: undistort the images there, or calibrate with OPENCV, "
                      "FULL_OPENCV or OPENCV_FISHEYE");
    if (parameters.size() != colmapParameterCount(name))
        throw Failure(format("%s has %zu parameters, here are %zu", name.c_str(), colmapParameterCount(name), parameters.size()));
    const double* p = parameters.data();
    const double* centre = p + model.focals;
    return makeCamera(model.lens, cameraMatrixOf(p[0], p[model.focals - 1], centre[0] - COLMAP_CORNER, centre[1] - COLMAP_CORNER),
                      std::vector<double>(centre + 2, p + parameters.size()), size);
}

std::vector<std::string> colmapModels()
{
    std::vector<std::string> names;
    for (const ColmapLens& lens : COLMAP_LENSES)
        names.push_back(lens.name);
    return names;
}

size_t colmapParameterCount(const std::string& model)
{
    const ColmapLens& lens = colmapLens(model);
    return lens.focals + 2 + lens.coefficients;
}

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

bool isColmapText(const ForeignFile& file)
{
    std::istringstream words(file.firstLine());
    std::string id, model;
    words >> id >> model;
    return isColmapModel(model) && leadingNumbers(id).size() == 1;
}

ForeignRig readColmapText(const ForeignFile& file)
{
    ForeignRig rig;
    for (const std::string& line : file.lines())
    {
        std::istringstream words(line);
        std::string id, model, rest;
        words >> id >> model;
        std::getline(words, rest);
        const std::vector<double> numbers = leadingNumbers(rest);
        if (numbers.size() < 2)
            throw Failure("a line has no image size: 'CAMERA_ID MODEL WIDTH HEIGHT PARAMS' is needed, and here is '" + line.substr(0, 60)
                          + "'");
        const auto camera = makeColmapCamera(model, {numbers.begin() + 2, numbers.end()}, imageSizeOf(numbers[0], numbers[1]));
        const size_t port = rest.find("PORT");
        const size_t word = port == std::string::npos ? port : rest.rfind(' ', port);
        if (word != std::string::npos)
            camera->setWindow(makePort(rest.substr(word + 1, port + 4 - word - 1), leadingNumbers(rest.substr(port + 4))));
        rig.add(camera);
    }
    return rig;
}

bool isColmapBinary(const ForeignFile& file)
{
    const size_t FIRST = 32, LARGEST = 1 << 20;
    if (file.bytes.size() < FIRST)
        return false;
    ByteReader in(file.bytes);
    const uint64_t count = in.number<uint64_t>();
    const BinaryHead head = in.number<BinaryHead>();
    return count >= 1 && count < 1000000 && head.id >= 0 && isColmapModel(head.name()) && head.width >= 1 && head.width <= LARGEST
        && head.height >= 1 && head.height <= LARGEST;
}

ForeignRig readColmapBinary(const ForeignFile& file)
{
    ForeignRig rig;
    ByteReader in(file.bytes);
    for (uint64_t left = in.number<uint64_t>(); left > 0; left--)
    {
        const BinaryHead head = in.number<BinaryHead>();
        std::vector<double> parameters(colmapParameterCount(head.name()));
        for (double& p : parameters)
            p = in.number<double>();
        rig.add(makeColmapCamera(head.name(), parameters, imageSizeOf((double)head.width, (double)head.height)));
    }
    if (in.left() > 0)
        throw Failure(std::to_string(in.left()) + " bytes follow its last record");
    return rig;
}

} // namespace tools
