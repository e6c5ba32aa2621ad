// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/rig_camera.hpp"
#include "window/parameters.hpp"
#include "window/wedge.hpp"

namespace cv { namespace refract {

typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Map33;
typedef Eigen::Map<const Eigen::Vector3d> Map3;

static const double MAX_TRIAL_WEDGE = 1;        // radians: GlassWindow::check() refuses 90 degrees
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

Camera withWindow(const Camera& camera, const GlassWindow& window)
{
    Camera other(camera);
    other.setWindow(window);
    return other;
}

RigCamera::RigCamera(const Camera& camera)
    : behindWindow_(camera), bare_(withWindow(camera)), isLensPossible_(true), isWindowPossible_(true) {}

void RigCamera::set(const Parameters& parameters)
{
    extrinsics = TransformWithDerivatives(parameters.extrinsics);
    window.reset();
    if (!parameters.ownsWindow)
        window.reset(new WindowTransfer(Vec3d(parameters.normal), parameters.media[at().distance - at().media],
                                        TransformWithDerivatives(parameters.ownerExtrinsics), extrinsics));
    // A trial step may leave the domain of the focal lengths, or of the window.
    isLensPossible_ = parameters.lens[0] > 0 && parameters.lens[1] > 0;
    isWindowPossible_ = isLensPossible_ && setWindow(parameters);
    if (isLensPossible_)
        bare_.setLensParameters(Mat(1, lensCount(), CV_64F, const_cast<double*>(parameters.lens)));
}

bool RigCamera::setWindow(const Parameters& parameters)
{
    std::vector<double> all(parameters.lens, parameters.lens + lensCount());
    all.resize(lensCount() + at().count);
    double* const p = all.data() + lensCount();
    const Vec3d normal = window ? window->normal : Vec3d(parameters.normal);
    std::copy(normal.val, normal.val + 3, p + at().normal);
    std::copy(parameters.media, parameters.media + mediaCount(), p + at().media);
    const bool hasWedge = at().count > at().wedge;
    if (hasWedge && !(norm(Mat(1, at().count - at().wedge, CV_64F, p + at().wedge), NORM_L1) < MAX_TRIAL_WEDGE))
        return false;
    if (window && hasWedge && !turnWedge(parameters, p))
        return false;
    double& distance = p[at().distance];
    if (window)
        distance = window->distance;
    // With equal media the distance has no effect; another camera's need not be known well enough to be positive here.
    if (window && p[at().innerIndex] == p[at().outerIndex])
        distance = std::max(distance, 0.);
    if (!(normal[2] > 0 && distance >= 0))
        return false;
    for (int i = at().media; i < at().count; i++)
        if (!(p[i] <= upperBound(kindOf(at(), i))))
            return false;
    behindWindow_.setParameters(all);
    return true;
}

/* Of a window that is described in another camera's frame: its wedge along the axes here, and its thickness along the normal through
the centre of projection here. False where the faces meet before it. */
bool RigCamera::turnWedge(const Parameters& parameters, double* p) const
{
    const TransformWithDerivatives owner(parameters.ownerExtrinsics);
    const Matx33d R = extrinsics.rotation.R*owner.rotation.R.t();
    std::vector<double> given(p, p + at().count);
    std::copy(parameters.normal, parameters.normal + 3, given.begin() + at().normal);
    const GlassWindow moved = windowInFrame(withParameters(behindWindow_.window(), given.data()), R, extrinsics.T - R*owner.T);
    for (int i = 0; i < at().layers; i++)
    {
        p[at().thickness + i] = moved.thickness[i];
        p[at().wedge + 2*i] = moved.wedge[i][0];
        p[at().wedge + 2*i + 1] = moved.wedge[i][1];
    }
    return *std::min_element(moved.thickness.begin(), moved.thickness.end()) > 0;
}

const Camera* RigCamera::camera(bool refracted) const
{
    return refracted ? (isWindowPossible_ ? &behindWindow_ : nullptr) : (isLensPossible_ ? &bare_ : nullptr);
}

}} // namespace
