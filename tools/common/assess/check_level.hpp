// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_LEVEL_HPP
#define REFRACT_TOOLS_CHECK_LEVEL_HPP

#include "assess/check_problem.hpp"
#include "measure/eigen_matrix.hpp"
#include <vector>

/* Tests of many hypotheses at once, with one probability of a false alarm. A hypothesis is a part of the score, which under
"nothing changed" is normal with covariance G; its gain s^T G^-1 s, over its degrees of freedom, follows F. */
namespace tools {

//! One hypothesis: columns of G, and the directions within them that the images tell.
struct TestedDirections
{
    int first;
    MatrixXd directions;        //!< a column each
    int count() const { return (int)directions.cols(); }
};

//! By how much chi^2 falls if it is freed.
double gainOf(const TestedDirections& tested, const MatrixXd& G, const VectorXd& score);

//! Probability of a gain as large as this or larger if nothing changed. @param dof of the noise
double probabilityOf(double gain, int count, double dof);

/** The probability below which the least one of all hypotheses is with the probability falseAlarm, if nothing changed. Hypotheses
overlap, so that this is more than Bonferroni's falseAlarm / count: the quantile over draws of the score, always the same ones. */
double criticalProbability(const std::vector<TestedDirections>& tested, const MatrixXd& G, double dof, double falseAlarm);

/* What a check cannot show: a given value that was wrong in the calibration, and still is. The calibrated values have absorbed most of it,
as they would now. */

struct UnseenError
{
    std::string of;             //!< "thickness"
    double least;               //!< that would show; infinity: none would
    std::string unit;           //!< empty: it has none
    bool isOfTarget = false;    //!< its size: a target of another size shows it
};

/** Each error moves the calibrated values as its source in the calibration file says; of several windows the one that shows least. First
that of the target. @param dof of the noise. @param critical probability of a gain that is a change. @param power probability with which it
must show */
std::vector<UnseenError> unseenErrors(const CheckInput& input, const CheckProblem& problem, const CheckFit& asCalibrated, double dof,
                                      double critical, double power);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_LEVEL_HPP
