// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_INNOVATIONS_HPP
#define REFRACT_TOOLS_INNOVATIONS_HPP

#include "history/check_history.hpp"

/* What is new in each check. The calibration's own error dp is one for all checks,

    score_t = G_t change_t + D_t dp + noise_t,      cov(dp) = C,    cov(noise_t) = G_t - D_t C D_t^T,

so that checks are not independent of each other and it does not average out. Each check is therefore held against what the calibration
and all checks before it say of dp, as if nothing had changed (a Kalman filter whose state is constant). What is left, the innovation,
is independent of all others, and normal with the covariance V_t, exactly. */
namespace tools {

//! Of one check. Rows: the parameters of CheckRecord::changes, one change after the other.
struct Innovation
{
    MatrixXd value;             //!< a column each scenario
    MatrixXd root, inverse;     //!< V = root root^T, and its pseudo-inverse: changes may look alike
    //! The same for each change by itself, as if nothing else had changed.
    MatrixXd alone;
    MatrixXd rootAlone;         //!< of its covariance
    VectorXd stdAlone;

    int rank() const { return (int)root.cols(); }
};

class InnovationFilter
{
public:
    //! @param covariance of the calibrated parameters; zeros: they are exact
    explicit InnovationFilter(const MatrixXd& covariance, Eigen::Index scenarios = 1);

    //! @param scores of the scenarios, of which the first is usually what was seen
    Innovation add(const CheckRecord& check, const std::vector<ChartedChange>& changes, const MatrixXd& scores);

private:
    MatrixXd C0_, C_, mean_;
};

} // namespace tools

#endif // REFRACT_TOOLS_INNOVATIONS_HPP
