// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/QR>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

PivotedQR::PivotedQR(const MatrixRef& A) : qr_(std::make_shared<Eigen::ColPivHouseholderQR<MatrixXd> >(A)) {}

PivotedQR::PivotedQR(const MatrixRef& A, double threshold)
{
    const auto qr = std::make_shared<Eigen::ColPivHouseholderQR<MatrixXd> >(A);
    qr->setThreshold(threshold);
    qr_ = qr;
}

int PivotedQR::rank() const { return (int)qr_->rank(); }
int PivotedQR::column(int i) const { return (int)qr_->colsPermutation().indices()[i]; }
MatrixXd PivotedQR::rotate(const MatrixRef& B) const { return qr_->householderQ().adjoint()*B; }
VectorXd PivotedQR::solve(const VectorXd& b) const { return qr_->solve(b); }
MatrixXd PivotedQR::solve(const MatrixXd& B) const { return qr_->solve(B); }

MatrixXd PivotedQR::solveR(const MatrixRef& B) const
{
    const int count = rank();
    MatrixXd X = MatrixXd::Zero(qr_->cols(), B.cols());
    X.topRows(count) = qr_->matrixQR().topLeftCorner(count, count).triangularView<Eigen::Upper>().solve(B.topRows(count));
    return qr_->colsPermutation()*X;
}

// A = Q R of the rank's rows of R; R^T has all columns, so that R^+ is the transpose of R^T's least squares.
static MatrixXd pseudoInverse(const PivotedQR& qr, const MatrixRef& A)
{
    const int rank = qr.rank();
    if (rank == 0)
        return MatrixXd::Zero(A.cols(), A.rows());
    const MatrixXd R = qr.rotate(A).topRows(rank), Qt = qr.rotate(MatrixXd::Identity(A.rows(), A.rows())).topRows(rank);
    return transposeTimes(QR(R.transpose()).solve(MatrixXd(MatrixXd::Identity(A.cols(), A.cols()))), Qt);
}

MatrixXd pseudoInverse(const MatrixRef& A) { return pseudoInverse(PivotedQR(A), A); }
MatrixXd pseudoInverse(const MatrixRef& A, double threshold) { return pseudoInverse(PivotedQR(A, threshold), A); }

}} // namespace
