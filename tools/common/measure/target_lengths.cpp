// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/target_lengths.hpp"

namespace tools {

using cv::Point3d;

std::vector<double> lengthErrors(const View& view, const std::vector<Point3d>& points)
{
    std::vector<double> errors;
    for (const auto& pair : view.neighbours)
    {
        const double measured = cv::norm(points[pair.second] - points[pair.first]);
        if (measured == measured)
            errors.push_back(measured - cv::norm(view.objectPoints[pair.second] - view.objectPoints[pair.first]));
    }
    return errors;
}

} // namespace tools
