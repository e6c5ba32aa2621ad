// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHANGED_VALUE_HPP
#define REFRACT_TOOLS_CHANGED_VALUE_HPP

#include "assess/change.hpp"

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

} // namespace tools

#endif // REFRACT_TOOLS_CHANGED_VALUE_HPP
