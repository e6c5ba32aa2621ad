// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/dense.hpp"
#include <Eigen/QR>

namespace cv { namespace refract {

using Eigen::MatrixXd;
using Eigen::VectorXd;

QR::QR(const MatrixRef& A) : qr_(std::make_shared<Eigen::HouseholderQR<MatrixXd> >(A)) {}
MatrixXd QR::R() const { return qr_->matrixQR().topRows(std::min(qr_->rows(), qr_->cols())).triangularView<Eigen::Upper>(); }
MatrixXd QR::Q() const { return qr_->householderQ(); }
MatrixXd QR::rotate(const MatrixRef& B) const { return qr_->householderQ().adjoint()*B; }
VectorXd QR::solve(const VectorXd& b) const { return qr_->solve(b); }
MatrixXd QR::solve(const MatrixXd& B) const { return qr_->solve(B); }

}} // namespace
