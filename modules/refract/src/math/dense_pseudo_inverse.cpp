// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/QR>

namespace cv { namespace refract {

using Eigen::MatrixXd;

MatrixXd pseudoInverse(const MatrixRef& A)
{
    return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).pseudoInverse();
}

MatrixXd pseudoInverse(const MatrixRef& A, double threshold)
{
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod;
    cod.setThreshold(threshold);
    cod.compute(A);
    return cod.pseudoInverse();
}

}} // namespace
