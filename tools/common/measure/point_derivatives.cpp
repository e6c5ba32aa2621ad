// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/point_derivatives.hpp"
#include "measure/eigen_matrix.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

PointDerivatives differentiatePoints(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points,
                                     const Vec3d& rvec, const Vec3d& tvec)
{
    Mat ignored, jacobian;
    refractiveProjectPoints(points, rvec, tvec, camera, ignored, noArray(), jacobian);
    const Eigen::MatrixXd J = toEigen(jacobian);
    return {J.leftCols(6), J.rightCols(J.cols() - 6)};
}

} // namespace tools
