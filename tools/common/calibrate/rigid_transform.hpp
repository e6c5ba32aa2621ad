// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIGID_TRANSFORM_HPP
#define REFRACT_TOOLS_RIGID_TRANSFORM_HPP

#include "math/rigid_transform.hpp"
#include "math/rotation.hpp"

namespace tools {

using cv::refract::RigidTransform;
using cv::refract::rotationMatrix;
using cv::refract::rotationVector;
using cv::refract::tangents;

inline RigidTransform transformOf(const cv::Vec3d& rvec, const cv::Vec3d& tvec) { return {rotationMatrix(rvec), tvec}; }

//! a -> b, of two frames that are both known from a third.
inline RigidTransform fromTo(const RigidTransform& a, const RigidTransform& b) { return b*a.inverse(); }

} // namespace tools

#endif // REFRACT_TOOLS_RIGID_TRANSFORM_HPP
