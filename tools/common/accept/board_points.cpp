// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/board_points.hpp"
#include "calibrate/rig_data.hpp"
#include "console/failure.hpp"
#include "measure/consistency.hpp"
#include "measure/measurement.hpp"
#include "measure/outside_image.hpp"
#include <algorithm>

namespace tools {

namespace {

//! One image for each camera is one view, whatever their names.
void nameSingles(RigImages& sets)
{
    std::string name;
    for (const DetectedImages& set : sets.glass)
        if (set.files.size() > 1 || set.images.size() > 1)
            return;
    for (DetectedImages& set : sets.glass)
        for (DetectedImage& image : set.images)
            image.stem = name = name.empty() ? image.stem : name;
}

void add(const View& view, const Measurement& m, TestPoints& points)
{
    for (size_t i = 0; i < m.points.size(); i++)
    {
        TestPoint point{view.stem, std::to_string(i), m.points[i], {}, m.sigma[i], m.status[i]};
        for (const std::vector<cv::Point2d>& pixels : m.pixels)
            point.pixels.push_back(pixels[i]);
        points.points.push_back(point);
    }
}

} // namespace

BoardPoints measureBoards(const Calibration& calibration, const std::vector<std::string>& images, const Target& target, double pixelSigma,
                          bool quiet)
{
    RigSources sources;
    sources.channel = calibration.channel;
    std::copy(images.begin(), images.end(), sources.glass.begin());
    PerCamera<cv::Size> sizes;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        sizes[c] = calibration.cameras[c].camera->imageSize();
    RigImages sets = readRigImages(sources, &target, sizes, quiet);
    nameSingles(sets);
    BoardPoints result;
    result.points.source = images[0];
    result.points.havePixels = result.points.haveSigma = true;
    for (const DetectedImages& set : sets.glass)
        result.files.insert(result.files.end(), set.files.begin(), set.files.end());
    for (const View& view : groupIntoViews(&target, sets, false, 1).views)
    {
        if (view.countGlass() < 2)
            continue;
        Measurement m = measureRig(calibration, glassPixels(view, (int)calibration.cameras.size()), pixelSigma);
        forgetOutside(calibration, m);
        checkConsistency(calibration, pixelSigma, m);
        add(view, m, result.points);
    }
    if (result.points.points.empty())
        throw Failure("no two cameras have images of one name with the target: images of one moment need equal names");
    return result;
}

} // namespace tools
