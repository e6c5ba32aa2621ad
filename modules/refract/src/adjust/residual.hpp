// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RESIDUAL_HPP
#define OPENCV_REFRACT_RESIDUAL_HPP

#include "adjust/rig_camera.hpp"
#include "adjust/shared_target_errors.hpp"
#include "arrays/views.hpp"

namespace cv { namespace refract {

/** Predicted minus observed pixel of all points of one image, with analytic derivatives through Camera::projectJacobian.

    object --pose, errors of all targets--> camera 1 --extrinsics--> camera --window, lens--> pixel

The camera is evaluated once for all its images (RigCamera). Blocks in this order: pose (rvec, tvec; 6), the errors that all targets
share (7; if the problem has them), extrinsics (rvec, T; 6) but for camera 1, lens, and through a window its place, its media,
and the owner's extrinsics if the window is neither the camera's own nor camera 1's.

Every point has a weight: its residual, whitened (whitening.hpp), is multiplied by the weight's root. 0: left out. Half a pixel has
two rows as well, one of which is 0. */
class ImageResidual
{
public:
    struct Kind
    {
        bool refracted, isCamera1, ownerIsCamera1, hasTargetErrors;
    };
    //! All arguments must outlive it. rootWeights: one per point.
    ImageResidual(const RigCamera& camera, const ImagePoints& points, const std::vector<double>& rootWeights, const Kind& kind,
                  const SharedTargetErrors& targetErrors);

    int count() const { return 2*(int)points_.pixel.size(); }
    const std::vector<int>& blockSizes() const { return sizes_; }

    /** @param residuals u, v of each point; infinite where one with a weight has no image
    @param jacobians null, or count() x size of each block, row by row; null where it is not wanted
    @return false if some point with a weight has no image, or the camera is impossible */
    bool evaluate(const double* pose, double* residuals, double** jacobians) const;

private:
    struct Target;
    struct Point;
    bool project(const Camera& camera, const double* pose, double* residuals) const;
    bool linearize(const Camera& camera, const double* pose, double* residuals, double** jacobians) const;
    void placePoints(const SimilarityTransform& placed, int begin, int n, double* x, double* y, double* z, uchar* status) const;
    bool writeResidual(int i, double u, double v, uchar status, double* residuals) const;
    void writeJacobians(const Target& target, Point& point, int i, double** jacobians) const;
    void writeTargetErrors(const Target& target, const Point& point, double* rows) const;

    const RigCamera& camera_;
    const ImagePoints& points_;
    const std::vector<double>& rootWeights_;
    const SharedTargetErrors& targetErrors_;
    bool refracted_;
    std::vector<int> sizes_;
    int targets_, extrinsics_, lens_, place_, media_, owner_;    //!< position of each block; -1: there is none
};

}} // namespace

#endif // OPENCV_REFRACT_RESIDUAL_HPP
