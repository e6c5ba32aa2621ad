// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MESH_HPP
#define REFRACT_TOOLS_MESH_HPP

#include "simulate/surface.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/BVH>
#include <array>
#include <vector>

namespace tools {

using Triangle = std::array<cv::Vec3d, 3>;      //!< its corners, in either order

//! Triangles in any number and order, each flat; which of their sides is seen does not matter.
class Mesh : public Surface
{
public:
    //! @param triangles at least one
    Mesh(const std::vector<Triangle>& triangles, const cv::Vec3d& color);

    bool intersect(const SceneRay& ray, Intersection& first) const override;

private:
    std::vector<Triangle> triangles_;
    Eigen::KdBVH<double, 3, int> tree_;     //!< of their numbers
};

} // namespace tools

#endif // REFRACT_TOOLS_MESH_HPP
