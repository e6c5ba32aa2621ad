// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/failure.hpp"
#include "console/lines.hpp"
#include "formats/bytes.hpp"
#include "formats/colmap_model.hpp"
#include "formats/foreign_file.hpp"
#include "formats/lens_maker.hpp"

#include <cstdint>
#include <sstream>

/* COLMAP: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[], one camera a line. */

namespace tools {

namespace {

const int LARGEST = 1 << 20;        // of an image, px

//! The second word of a line.
std::string modelIn(const std::string& line)
{
    std::istringstream words(line);
    std::string id, model;
    words >> id >> model;
    return model;
}

} // namespace

bool isColmapText(const ForeignFile& file)
{
    return isColmapModel(modelIn(file.firstLine())) && leadingNumbers(file.firstLine()).size() == 1;
}

ForeignRig readColmapText(const ForeignFile& file)
{
    ForeignRig rig;
    std::istringstream in(file.bytes);
    for (std::string line; takeLine(in, line); )
    {
        if (line.find_first_not_of(" \t\r") == std::string::npos || line[line.find_first_not_of(" \t\r")] == '#')
            continue;
        const std::string model = modelIn(line);
        const std::string rest = model.empty() ? "" : line.substr(line.find(model) + model.size());
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
    const size_t FIRST = 32;
    size_t parameters = 0;
    if (file.bytes.size() < FIRST)
        return false;
    ByteReader in(file.bytes);
    const uint64_t count = in.number<uint64_t>();
    const int32_t id = in.number<int32_t>(), model = in.number<int32_t>();
    const uint64_t width = in.number<uint64_t>(), height = in.number<uint64_t>();
    return count >= 1 && count < 1000000 && id >= 0 && !colmapModelName(model, parameters).empty() && width >= 1 && width <= LARGEST
        && height >= 1 && height <= LARGEST;
}

ForeignRig readColmapBinary(const ForeignFile& file)
{
    ForeignRig rig;
    for (const ColmapCamera& camera : readColmapCameras(file.bytes))
        rig.add(makeColmapCamera(camera.model, camera.parameters, imageSizeOf((double)camera.width, (double)camera.height)));
    return rig;
}

ColmapCamera colmapCameraOf(const cv::refract::RefractiveCamera& camera, uint32_t id)
{
    const cv::Mat lens = camera.lensParameters();       // fx fy cx cy k1 k2 p1 p2 [k3 k4 k5 k6], or fisheye's k1 ... k4
    ColmapCamera result;
    result.id = id;
    result.model = camera.lensModel() == "fisheye" ? "OPENCV_FISHEYE" : lens.total() > 8 ? "FULL_OPENCV" : "OPENCV";
    result.width = (uint64_t)camera.imageSize().width;
    result.height = (uint64_t)camera.imageSize().height;
    result.parameters.assign(lens.ptr<double>(), lens.ptr<double>() + lens.total());
    result.parameters.resize(result.model == "FULL_OPENCV" ? 12 : 8, 0.);
    for (int i : {2, 3})
        result.parameters[i] += COLMAP_CORNER;
    return result;
}

} // namespace tools
