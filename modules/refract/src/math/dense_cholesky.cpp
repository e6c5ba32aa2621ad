// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/Cholesky>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;
// What Eigen itself takes for the result of such expressions; it decides about the order of sums.
typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMajor;

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
