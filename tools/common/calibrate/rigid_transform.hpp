// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIGID_TRANSFORM_HPP
#define REFRACT_TOOLS_RIGID_TRANSFORM_HPP

#include <opencv2/calib3d.hpp>

namespace tools {

inline cv::Matx33d rotationMatrix(const cv::Vec3d& rvec)
{
    cv::Matx33d R;
    cv::Rodrigues(rvec, R);
    return R;
}

inline cv::Vec3d rotationVector(const cv::Matx33d& R)
{
    cv::Vec3d rvec;
    cv::Rodrigues(R, rvec);
    return rvec;
}

//! X -> R X + T
struct RigidTransform
{
    cv::Matx33d R = cv::Matx33d::eye();
    cv::Vec3d T;

    cv::Vec3d operator*(const cv::Vec3d& X) const { return R*X + T; }
    //! First the other, then this.
    RigidTransform operator*(const RigidTransform& other) const { return {R*other.R, R*other.T + T}; }
    //! R^T (X - T)
    cv::Vec3d inverse(const cv::Vec3d& X) const { return R.t()*(X - T); }
};

inline RigidTransform transformOf(const cv::Vec3d& rvec, const cv::Vec3d& tvec) { return {rotationMatrix(rvec), tvec}; }

//! a -> b, of two frames that are both known from a third.
inline RigidTransform fromTo(const RigidTransform& a, const RigidTransform& b)
{
    const cv::Matx33d R = b.R*a.R.t();
    return {R, b.T - R*a.T};
}

} // namespace tools

#endif // REFRACT_TOOLS_RIGID_TRANSFORM_HPP
