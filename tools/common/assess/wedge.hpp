// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WEDGE_HPP
#define REFRACT_TOOLS_WEDGE_HPP

#include <opencv2/refract.hpp>

/* A window whose faces are not quite parallel, as a perturbation of one whose faces are: the model that is calibrated and
measured with knows no wedge, so this says what a wedge that is there would do to it. */
namespace tools {

//! How the outermost surface of a window lies to the others.
struct Wedge
{
    cv::Vec3d tilt;         //!< tangent to the normal n: the surface's normal is n + tilt
    double lift = 0.;       //!< of the surface's point on the axis through the centre of projection, along n
};

/** Where the outgoing rays of pixels meet planes z = const, traced surface by surface.
@param z of each point.
@return NaN where there is no such point. */
std::vector<cv::Point3d> traceWedge(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                    const std::vector<cv::Point2d>& pixels, const Wedge& wedge,
                                    const std::vector<double>& z);

/** How far the wedge moves the images of points: to first order in the tilt, as the ray through the unmoved pixel is traced
and its miss is carried back to the image.
@param points camera frame. */
std::vector<cv::Point2d> wedgeShift(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                    const std::vector<cv::Point3d>& points, const Wedge& wedge);

} // namespace tools

#endif // REFRACT_TOOLS_WEDGE_HPP
