// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/outside_image.hpp"
#include "console/table.hpp"
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();
const double BEYOND = 1.;       // px: a corner that is found at the border may lie a little beyond it

bool isOutside(const Calibration& calibration, size_t camera, const Point2d& pixel)
{
    const Size size = calibration.cameras[camera].camera->imageSize();
    return !size.empty() && seen(pixel)
        && !Rect2d(-BEYOND, -BEYOND, size.width + 2*BEYOND, size.height + 2*BEYOND).contains(pixel);
}

} // namespace

void forgetOutside(const Calibration& calibration, Measurement& m)
{
    for (size_t i = 0; i < m.points.size(); i++)
        for (size_t c = 0; c < m.pixels.size(); c++)
            if (isOutside(calibration, c, m.pixels[c][i]))
            {
                m.points[i] = Point3d(NOT_KNOWN, NOT_KNOWN, NOT_KNOWN);
                m.sigma[i] = Vec3d::all(NOT_KNOWN);
                m.status[i] = OUTSIDE_IMAGE;
            }
}

std::string outsideIn(const Calibration& calibration, const Measurement& m, const std::vector<std::string>& ids)
{
    std::string first;
    int count = 0;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        count += m.status[i] == OUTSIDE_IMAGE;
        for (size_t c = 0; c < m.pixels.size() && first.empty(); c++)
            if (isOutside(calibration, c, m.pixels[c][i]))
            {
                const Size size = calibration.cameras[c].camera->imageSize();
                first = format("'%s' at (%g, %g) in camera %zu (%dx%d)", ids[i].c_str(), m.pixels[c][i].x, m.pixels[c][i].y, c + 1,
                               size.width, size.height);
            }
    }
    if (!count)
        return "";
    return format("%d of %zu points lie outside of an image, first ", count, m.points.size()) + first
        + format("; status %d, no answer. Are these the pixels of images of another size, cropped, or with the cameras exchanged?",
                 OUTSIDE_IMAGE);
}

} // namespace tools
