// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/Cholesky>
#include <Eigen/LU>

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

void subtractTransposeTimes(const MatrixRef& A, const MatrixRef& B, Eigen::Ref<MatrixXd> C)
{
    C.noalias() -= A.transpose()*B;
}

void addGram(const MatrixRef& A, double factor, MatrixXd& C)
{
    C.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(), factor);
}

MatrixXd inverse(const MatrixRef& A) { return A.inverse(); }
Eigen::Matrix2d inverse2(const Eigen::Matrix2d& A) { return A.inverse(); }
Eigen::Matrix3d inverse3(const Eigen::Matrix3d& A) { return A.inverse(); }

FullPivLU::FullPivLU(const MatrixRef& A) : lu_(std::make_shared<Eigen::FullPivLU<MatrixXd> >(A)) {}
bool FullPivLU::isInvertible() const { return lu_->isInvertible(); }
MatrixXd FullPivLU::inverse() const { return lu_->inverse(); }
VectorXd FullPivLU::solve(const VectorXd& b) const { return lu_->solve(b); }

LLT::LLT(const MatrixRef& A) : llt_(std::make_shared<Eigen::LLT<MatrixXd> >(A)) {}
bool LLT::isPositiveDefinite() const { return llt_->info() == Eigen::Success; }
MatrixXd LLT::L() const { return llt_->matrixL(); }
MatrixXd LLT::solveL(const MatrixRef& B) const { return llt_->matrixL().solve(B); }

LDLT::LDLT(const MatrixRef& A) : ldlt_(std::make_shared<Eigen::LDLT<MatrixXd> >(A)) {}
MatrixXd LDLT::L() const { return ldlt_->transpositionsP().transpose()*MatrixXd(ldlt_->matrixL()); }
VectorXd LDLT::D() const { return ldlt_->vectorD(); }
VectorXd LDLT::solve(const VectorXd& b) const { return ldlt_->solve(b); }
MatrixXd LDLT::solve(const MatrixXd& B) const { return ldlt_->solve(B); }
MatrixXd LDLT::inverse() const { return ldlt_->solve(MatrixXd::Identity(ldlt_->rows(), ldlt_->cols())); }

MatrixXd LDLT::solveTranspose(const MatrixRef& B) const
{
    const RowMajor X = ldlt_->solve(B.transpose());
    return X;
}

VectorXd LDLT::solveL(const VectorXd& b) const
{
    VectorXd x = ldlt_->transpositionsP()*b;
    ldlt_->matrixL().solveInPlace(x);
    return x;
}

}} // namespace
