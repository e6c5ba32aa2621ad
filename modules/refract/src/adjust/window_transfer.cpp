// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/window_transfer.hpp"

namespace cv { namespace refract {

typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Map33;
typedef Eigen::Map<const Eigen::Vector3d> Map3;

static const double NOWHERE_ELSE[6] = { 0, 0, 0, 0, 0, 0 };

TransformWithDerivatives::TransformWithDerivatives(const double* six)
    : rotation(six ? six : NOWHERE_ELSE), T(six ? six + 3 : NOWHERE_ELSE) {}

TransformWithDerivatives::TransformWithDerivatives(const Pose& pose) : rotation(pose.rvec.val), T(pose.tvec) {}

WindowTransfer::WindowTransfer(const Vec3d& ownerNormal, double ownerDistance, const TransformWithDerivatives& owner,
                               const TransformWithDerivatives& camera)
{
    const Vec3d normal1 = owner.rotation.R.t()*ownerNormal;
    normal = camera.rotation.R*normal1;
    distance = ownerDistance - ownerNormal.dot(owner.T) + normal.dot(camera.T);

    const Map33 R(camera.rotation.R.val), Ro(owner.rotation.R.val);
    const Eigen::RowVector3d T = Map3(camera.T.val).transpose();
    byWindow.setZero();
    byWindow.topLeftCorner<3, 3>() = R*Ro.transpose();
    byWindow.bottomLeftCorner<1, 3>() = T*byWindow.topLeftCorner<3, 3>() - Map3(owner.T.val).transpose();
    byWindow(3, 3) = 1;
    byOwner.setZero();
    for (int i = 0; i < 3; i++)
        byOwner.col(i).head<3>() = R*(Map33(owner.rotation.dR[i].val).transpose()*Map3(ownerNormal.val));
    byOwner.bottomLeftCorner<1, 3>() = T*byOwner.topLeftCorner<3, 3>();
    byOwner.bottomRightCorner<1, 3>() = -Map3(ownerNormal.val).transpose();
    byCamera.setZero();
    byCamera.topLeftCorner<3, 3>() = Map33(camera.rotation.derivativeOf(normal1).val);
    byCamera.bottomLeftCorner<1, 3>() = T*byCamera.topLeftCorner<3, 3>();
    byCamera.bottomRightCorner<1, 3>() = Map3(normal.val).transpose();
}

}} // namespace
