// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WEDGE_HPP
#define REFRACT_TOOLS_WEDGE_HPP

#include <opencv2/refract.hpp>

/* A wedge that a window has and its calibration does not know: what it would do to the images. */
namespace tools {

//! How the outermost surface of a window lies, against where it is thought to be.
struct Wedge
{
    cv::Vec3d tilt;         //!< tangent to the normal n: the surface's normal is, to first order, n + tilt
    double lift = 0.;       //!< of the surface's point on the axis through the centre of projection, along n
};

//! The window as it is; it has layers.
cv::refract::GlassWindow withWedge(cv::refract::GlassWindow window, const Wedge& wedge);

/** How far the wedge moves the images of points.
@param points camera frame. */
std::vector<cv::Point2d> wedgeShift(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                    const std::vector<cv::Point3d>& points, const Wedge& wedge);

} // namespace tools

#endif // REFRACT_TOOLS_WEDGE_HPP
