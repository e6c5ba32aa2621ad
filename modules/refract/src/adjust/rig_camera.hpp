// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_CAMERA_HPP
#define OPENCV_REFRACT_RIG_CAMERA_HPP

#include "camera/camera.hpp"
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

//! The same lens behind another window, or none.
Camera withWindow(const Camera& camera, const GlassWindow& window = GlassWindow());

/** One camera of the rig at one set of parameter values: what all its images share. */
class RigCamera
{
public:
    //! Lens model and number of layers.
    explicit RigCamera(const Camera& camera);

    //! What describes the camera. Extrinsics are null for camera 1.
    struct Parameters
    {
        const double* extrinsics;
        const double* lens;
        const double* normal;               //!< in the owner's frame
        const double* media;                //!< the window's other parameters; the distance is the owner's
        const double* ownerExtrinsics;
        bool ownsWindow;
    };
    void set(const Parameters& parameters);

    int lensCount() const { return behindWindow_.lensCount(); }
    //! Of the window's parameters.
    const WindowLayout& at() const { return behindWindow_.layers().at(); }
    int mediaCount() const { return at().count - at().media; }

    //! With its window, or the lens alone; null where the parameters are impossible.
    const Camera* camera(bool refracted) const;

    TransformWithDerivatives extrinsics;
    std::unique_ptr<WindowTransfer> window;     //!< null if it is the camera's own

private:
    bool setWindow(const Parameters& parameters);
    bool turnWedge(const Parameters& parameters, double* ofWindow) const;
    Camera behindWindow_, bare_;
    bool isLensPossible_, isWindowPossible_;
};

}} // namespace

#endif // OPENCV_REFRACT_RIG_CAMERA_HPP
