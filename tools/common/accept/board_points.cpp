// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/board_points.hpp"
#include "console/failure.hpp"
#include "measure/consistency.hpp"
#include "measure/measured_views.hpp"
#include "measure/measurement.hpp"
#include "measure/outside_image.hpp"

namespace tools {

namespace {

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
    MeasuredFiles files;
    files.images = images;
    const RigImages sets = readGlassImages(files, true, calibration, &target, quiet);
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
