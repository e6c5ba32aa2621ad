// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_JOINT_ERROR_HPP
#define REFRACT_TOOLS_JOINT_ERROR_HPP

#include "measure/eigen_matrix.hpp"
#include "measure/measurement.hpp"
#include <optional>

namespace tools {

/* How several points of one calibration err together. To first order

    dX = (J^T J)^-1 J^T (du - A dp),        J: pixels by point, A: pixels by the parameters p of the rig

where the noise du of each point's pixels is its own and dp, the error of the calibration, is the same for all: a length between two
points has less of it than their covariances alone would say, or more. */
struct JointError
{
    std::vector<MatrixXd> byCalibration;    //!< dX/dp of each point, 3 rows
    std::vector<MatrixXd> noise;            //!< 3x3, covariance of each point for pixels with a standard deviation of 1
};

/** Of points seen by the cameras whose pixel is not NaN.
@param plane on which they lie, a x + b y + c z = d: camera 1 alone sees them
A point that its cameras do not determine has NaN. */
JointError jointErrorOf(const Calibration& calibration, const std::vector<cv::Point3d>& points, const RigPixels& pixels,
                        const std::optional<cv::Vec4d>& plane);

} // namespace tools

#endif // REFRACT_TOOLS_JOINT_ERROR_HPP
