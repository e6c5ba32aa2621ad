// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIGID_TRANSFORM_HPP
#define OPENCV_REFRACT_RIGID_TRANSFORM_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! x_in_b = R x_in_a + t: object -> camera, or camera 1 -> camera 2.
struct RigidTransform
{
    Matx33d R = Matx33d::eye();
    Vec3d t;

    Vec3d apply(const Vec3d& x) const { return R*x + t; }
    //! R^T (x - t)
    Vec3d inverse(const Vec3d& x) const { return R.t()*(x - t); }
    RigidTransform inverse() const { return { R.t(), -(R.t()*t) }; }
    //! First the other, then this.
    RigidTransform operator*(const RigidTransform& other) const { return { R*other.R, R*other.t + t }; }
};

}} // namespace

#endif // OPENCV_REFRACT_RIGID_TRANSFORM_HPP
