// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/target_lengths.hpp"

namespace tools {

using cv::Point3d;

//! Measured and true, of each pair of neighbours that was measured.
static std::vector<std::pair<double, double>> lengthsOf(const View& view, const std::vector<Point3d>& points)
{
    std::vector<std::pair<double, double>> lengths;
    for (const auto& pair : view.neighbours)
    {
        const double measured = cv::norm(points[pair.second] - points[pair.first]);
        if (measured == measured)
            lengths.push_back({measured, cv::norm(view.objectPoints[pair.second] - view.objectPoints[pair.first])});
    }
    return lengths;
}

std::vector<double> lengthErrors(const View& view, const std::vector<Point3d>& points)
{
    std::vector<double> errors;
    for (const auto& length : lengthsOf(view, points))
        errors.push_back(length.first - length.second);
    return errors;
}

std::vector<double> lengthRatios(const View& view, const std::vector<Point3d>& points)
{
    std::vector<double> ratios;
    for (const auto& length : lengthsOf(view, points))
        ratios.push_back(length.first/length.second);
    return ratios;
}

} // namespace tools
