// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SEEN_POINTS_HPP
#define REFRACT_TOOLS_SEEN_POINTS_HPP

#include "export/central_camera.hpp"

namespace tools {

//! Scene points, camera frame, and their pixels: central cameras are fitted to them and compared with them.
struct SeenPoints
{
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    bool allBeyondWindow = true;        //!< hardly a pixel meets one of the depths within its window
};

//! Pixels all over the image, seen at depths whose inverses are evenly spaced.
SeenPoints seenPoints(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range, int columns, int rows, int depths);

//! Throws Failure if the camera of that name sees hardly anything of the range.
void requireEnough(const SeenPoints& seen, const cv::Vec2d& range, const std::string& name);

/** Where a fit begins: the true camera matrix, as if the window's outer medium were all round. A flat port makes the focal length
longer by the ratio of the indices. */
cv::Mat startingMatrix(const cv::refract::RefractiveCamera& camera);

//! The error of a central camera.
CentralError errorOf(const SeenPoints& seen, const CentralCamera& central);

} // namespace tools

#endif // REFRACT_TOOLS_SEEN_POINTS_HPP
