// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHANGED_VALUE_HPP
#define REFRACT_TOOLS_CHANGED_VALUE_HPP

#include "assess/change.hpp"
#include "assess/check_level.hpp"
#include "assess/check_problem.hpp"

/* By how much a change has changed a rig, in numbers and as a sentence. */
namespace tools {

struct ValueAboutAxis
{
    std::string axis;           //!< "x"
    double value, std;
};

//! The estimate of one quantity of a change.
struct ChangedValue
{
    double value, std;
    std::string unit;
    //! Of a vector: one may be known ten times as well as another, which a length does not say.
    std::vector<ValueAboutAxis> aboutAxes = {};
};
std::vector<ChangedValue> valuesOf(const Change& change, const VectorXd& delta, const MatrixXd& covariance);

//! "window of camera 1 tilted by 0.102 +- 0.004 degrees"
std::string sentenceOf(const Change& change, const std::vector<ChangedValue>& values);

/* What control charts (history/) take of a check. */

//! A hypothesis of the table, tested.
struct TestedChange
{
    const Change* change;
    TestedDirections at;
    double gain, probability;
    CheckFit fit;               //!< chiSquare infinite: none
};

/** What the images tell about the changes that have a control chart, in the parameters of these:

    score = information change + byParameters dp + noise,    cov(score) = information where nothing changed. */
struct ChartedScore
{
    std::vector<Change> changes;    //!< all of whose parameters the images tell, in the table's order
    VectorXd score;                 //!< of their parameters, one change after the other
    MatrixXd information;
    MatrixXd byParameters;          //!< by the error of the calibrated parameters, in the order of withWedges()
};

//! @param information of all changes of the table. @param parameters that were calibrated
ChartedScore chartedScoreOf(const std::vector<TestedChange>& tested, const CheckProblem::Information& information, int parameters);

} // namespace tools

#endif // REFRACT_TOOLS_CHANGED_VALUE_HPP
