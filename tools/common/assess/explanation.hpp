// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXPLANATION_HPP
#define REFRACT_TOOLS_EXPLANATION_HPP

#include <string>

namespace tools {

//! A mistake that may be why images do not fit.
struct Explanation
{
    std::string sentence;
    double px;                  //!< what the same images leave with it undone, see medianErrorOfFit
};

} // namespace tools

#endif // REFRACT_TOOLS_EXPLANATION_HPP
