// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WINDOW_TRANSFER_HPP
#define OPENCV_REFRACT_WINDOW_TRANSFER_HPP

#include "math/rotation.hpp"
#include "pose/poses.hpp"
#include <Eigen/Core>

namespace cv { namespace refract {

// Not aligned: they are members of what std::vector and plain new hold.
template<int Rows, int Columns>
using PlainMatrix = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor | Eigen::DontAlign>;
typedef PlainMatrix<6, 6> Matrix6;

//! Where a camera of the rig is, X = R X1 + T, with the derivatives by rvec.
struct TransformWithDerivatives
{
    //! rvec and T; null: camera 1.
    explicit TransformWithDerivatives(const double* six = nullptr);
    explicit TransformWithDerivatives(const Pose& pose);
    Vec3d apply(const Vec3d& X) const { return rotation.R*X + T; }
    Rotation rotation;
    Vec3d T;
};

/** A window's normal and distance, described in the frame of one camera of the rig (its owner), in the frame of another.
With n.X = d the first surface, X_owner = Ro X1 + To and X = R X1 + T:

    n1 = Ro^T n_owner,  d1 = d_owner - n_owner.To;    n = R n1,  d = d1 + n.T */
struct WindowTransfer
{
    WindowTransfer(const Vec3d& ownerNormal, double ownerDistance, const TransformWithDerivatives& owner,
                   const TransformWithDerivatives& camera);
    Vec3d normal;
    double distance;
    // Rows: normal (3), distance.
    PlainMatrix<4, 4> byWindow;             //!< by the owner's normal and distance
    PlainMatrix<4, 6> byOwner, byCamera;    //!< by rvec and T of the two
};

}} // namespace

#endif // OPENCV_REFRACT_WINDOW_TRANSFER_HPP
