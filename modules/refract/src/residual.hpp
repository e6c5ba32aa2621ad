// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RESIDUAL_HPP
#define OPENCV_REFRACT_RESIDUAL_HPP

#include "camera.hpp"
#include "views.hpp"
#include <ceres/cost_function.h>

namespace cv { namespace refract {

/** One Ceres cost: predicted minus observed pixel of all points of one image, with analytic derivatives through
Camera::projectJacobian.

    object --pose--> camera 1 --extrinsics (camera 2 only)--> camera --window, lens--> pixel

Parameter blocks, in this order: pose (rvec, tvec; 6), extrinsics (rvec, T; 6) for camera 2 only, lens, and through a
window its normal (3, unit) and media (distance, thickness[], index[], innerIndex, outerIndex).

A pane that both cameras share is described in the frame of camera 1: camera 2 sees the normal n2 = R n1 at the distance
d2 = d1 + n2.T, as n1.X1 = d1 and X2 = R X1 + T. */
class ImageResidual : public ceres::CostFunction
{
public:
    enum Window { WITHOUT, OWN, OF_CAMERA_1 };

    //! camera: gives the lens model and the number of layers; its parameters are not used. Both must outlive the cost.
    static ceres::CostFunction* Create(const Camera& camera, const ImagePoints& points, bool isCamera2, Window window);

    //! False where a point has no image: Ceres takes a shorter step.
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

private:
    ImageResidual(const Camera& camera, const ImagePoints& points, bool isCamera2, Window window);

    struct Point;
    struct Frames;
    bool hasWindow() const { return window_ != WITHOUT; }
    bool setCamera(double const* const* parameters, Camera& camera) const;
    void writeJacobians(const Frames& frames, Point& point, int i, double** jacobians) const;

    const Camera& camera_;
    const ImagePoints& points_;
    Window window_;
    int extrinsics_, lens_, normal_, media_;    //!< position of each block; extrinsics_ = -1 for camera 1
};

//! The window that camera 2 sees of a pane described in the frame of camera 1.
void windowInCamera2(const Matx33d& R, const Vec3d& T, Vec3d& normal, double& distance);

//! A rotation vector's matrix and the derivatives of the matrix.
struct Rotation
{
    explicit Rotation(const double* rvec);
    Matx33d R;
    Matx33d dR[3];
    //! d(R v)/drvec
    Matx33d derivativeOf(const Vec3d& v) const;
};

}} // namespace

#endif // OPENCV_REFRACT_RESIDUAL_HPP
