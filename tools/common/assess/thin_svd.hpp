// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_THIN_SVD_HPP
#define REFRACT_TOOLS_THIN_SVD_HPP

#include <Eigen/Core>

namespace tools {

//! U diag(values) V^T = A, values descend; U has as many columns as there are values. By bisection, for large A.
struct ThinSvd
{
    explicit ThinSvd(const Eigen::MatrixXd& A);
    Eigen::VectorXd values;
    Eigen::MatrixXd U;
};

} // namespace tools

#endif // REFRACT_TOOLS_THIN_SVD_HPP
