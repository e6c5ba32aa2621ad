// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;
// What Eigen itself takes for the result of such expressions; it decides about the order of sums.
typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMajor;

MatrixXd product(const MatrixRef& A, const MatrixRef& B) { return A*B; }
MatrixXd transposeTimes(const MatrixRef& A, const MatrixRef& B, double factor) { return factor*A.transpose()*B; }
MatrixXd timesTranspose(const MatrixRef& A, const MatrixRef& B) { return A*B.transpose(); }
VectorXd timesVector(const MatrixRef& A, const VectorRef& x) { return A*x; }
VectorXd transposeTimesVector(const MatrixRef& A, const VectorRef& x, double factor) { return factor*A.transpose()*x; }
VectorXd diagonalOfProduct(const MatrixRef& A, const MatrixRef& B) { return (A*B).diagonal(); }
MatrixXd propagated(const MatrixRef& C, const MatrixRef& A)
{
    const RowMajor result = A*C*A.transpose();
    return result;
}

void addGram(const MatrixRef& A, double factor, MatrixXd& C)
{
    C.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(), factor);
}

}} // namespace
