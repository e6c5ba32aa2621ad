// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ROTATION_HPP
#define OPENCV_REFRACT_ROTATION_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** Rodrigues' formula.
@param jacobian may be null, else 3x3 matrices dR / drvec[i] */
Matx33d rotationMatrix(const Vec3d& rvec, Matx33d* jacobian = NULL);

//! The rotation vector of a rotation matrix.
Vec3d rotationVector(const Matx33d& R);

//! Unit quaternion (w, x, y, z), w >= 0, found from the largest of its elements: no digits are lost.
Vec4d quaternionOf(const Matx33d& R);

//! Columns: two unit vectors across a unit vector u, and across each other; with u they are right-handed.
Matx32d tangents(const Vec3d& u);

//! Turns a unit vector to the z axis, the shortest way.
Matx33d turnToZ(const Vec3d& a);

//! A rotation vector's matrix and the derivatives of the matrix.
struct Rotation
{
    explicit Rotation(const double* rvec);
    Matx33d R;
    Matx33d dR[3];
    //! d(R v)/drvec
    Matx33d derivativeOf(const Vec3d& v) const;
    /** The right Jacobian of SO(3): the matrix of rvec + d is that of rvec times that of the small rotation J d (J. Sola et al.,
    A micro Lie theory for state estimation in robotics, 2018, eq. 67). */
    Matx33d rightJacobian() const;
};

}} // namespace

#endif // OPENCV_REFRACT_ROTATION_HPP
