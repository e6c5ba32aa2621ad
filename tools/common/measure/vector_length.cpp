// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/vector_length.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

VectorLength lengthOf(const VectorXd& estimate, const MatrixXd& covariance)
{
    if (estimate.size() == 1)
        return {estimate[0], std::sqrt(std::max(0., covariance(0, 0)))};
    const double length = estimate.norm(), trace = covariance.trace();
    const VectorXd along = length > 0. ? VectorXd(estimate/length) : VectorXd(VectorXd::Zero(estimate.size()));
    const double variance = std::max(0., along.dot(cv::refract::timesVector(covariance, along))), across = std::max(0., trace - variance);
    // Errors across it make a vector longer, whatever they are: by as much its length is in doubt.
    return {length, std::hypot(std::sqrt(variance), std::hypot(length, std::sqrt(across)) - length)};
}

} // namespace tools
