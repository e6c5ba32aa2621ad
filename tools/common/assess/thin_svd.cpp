// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/thin_svd.hpp"
#include <Eigen/SVD>

// A source of its own: Eigen's template takes half a minute.
namespace tools {

ThinSvd::ThinSvd(const Eigen::MatrixXd& A)
{
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU);
    values = svd.singularValues();
    U = svd.matrixU();
}

} // namespace tools
