// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RESIDUAL_HPP
#define OPENCV_REFRACT_RESIDUAL_HPP

#include "calibrate/rig_camera.hpp"
#include "arrays/views.hpp"
#include <array>
#include <ceres/cost_function.h>

namespace cv { namespace refract {

/** One Ceres cost: predicted minus observed pixel of all points of one image, with analytic derivatives through
Camera::projectJacobian.

    object --pose--> camera 1 --extrinsics--> camera --window, lens--> pixel

The pose is taken from the parameter blocks; the camera is evaluated once for all its images (RigCamera), which must hold
the values of the other blocks. Blocks in this order: pose (rvec, tvec; 6), extrinsics (rvec, T; 6) but for camera 1, lens,
and through a window its normal (3, unit), media, and the owner's extrinsics if the window is neither the camera's own nor
camera 1's.

Every point has a weight: its residual is multiplied by the weight's root. 0: left out. */
class ImageResidual : public ceres::CostFunction
{
public:
    struct Image
    {
        bool refracted, isCamera1, ownerIsCamera1;
    };
    //! All arguments must outlive the cost. rootWeights: one per point.
    static ceres::CostFunction* Create(const RigCamera& camera, const ImagePoints& points,
                                       const std::vector<double>& rootWeights, const Image& image);

    //! False where a point has no image: Ceres takes a shorter step.
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

private:
    ImageResidual(const RigCamera& camera, const ImagePoints& points, const std::vector<double>& rootWeights,
                  const Image& image);

    struct Point;
    bool project(const Camera& camera, const double* pose, double* residuals) const;
    bool linearize(const Camera& camera, const double* pose, double* residuals, double** jacobians) const;
    void placePoints(const Matx33d& R1, const Vec3d& t1, int begin, int n, double* x, double* y, double* z,
                     uchar* status) const;
    bool writeResidual(int i, double u, double v, uchar status, double* residuals) const;
    void writeJacobians(const Rotation& object, const Point& point, int i, double** jacobians) const;

    const RigCamera& camera_;
    const ImagePoints& points_;
    const std::vector<double>& rootWeights_;
    bool refracted_;
    int extrinsics_, lens_, normal_, media_, owner_;    //!< position of each block; -1: there is none
};

}} // namespace

#endif // OPENCV_REFRACT_RESIDUAL_HPP
