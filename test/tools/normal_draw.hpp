// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Random numbers of a covariance.
#ifndef REFRACT_TEST_TOOLS_NORMAL_DRAW_HPP
#define REFRACT_TEST_TOOLS_NORMAL_DRAW_HPP

#include "math/dense.hpp"
#include "scenes.hpp"

namespace scenes {

//! S with S S^T = C. What has no variance has a row of exact zeros.
inline Eigen::MatrixXd rootOf(const Eigen::MatrixXd& C)
{
    const cv::refract::CorrelationSpectrum spectrum(C);
    return spectrum.root(spectrum.rank());
}

//! Of the covariance root root^T.
inline Eigen::VectorXd drawn(const Eigen::MatrixXd& root, Random& random)
{
    Eigen::VectorXd z(root.cols());
    for (double& value : z)
        value = random.normal(1.);
    return cv::refract::timesVector(root, z);
}

} // namespace scenes

#endif // REFRACT_TEST_TOOLS_NORMAL_DRAW_HPP
