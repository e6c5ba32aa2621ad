// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WRONG_VALUES_HPP
#define REFRACT_TOOLS_WRONG_VALUES_HPP

#include "assess/explanation.hpp"
#include "assess/given.hpp"

/* Values given wrongly: each is set free, or to what is likely instead, and the same images are fitted again. */
namespace tools {

//! As it was given: "1.5437" with so many digits, or "water:T=12 (1.33415)".
std::string typedIndex(const GivenIndex& index, int digits);

//! Square or thickness: pairs show the thickness in squares, only the ratio of the two.
Explanation wrongScale(const Given& given);

//! Coordinates of points in another unit than the window, where there are no pairs to show the thickness.
Explanation wrongUnitOfPoints(const Given& given);

Explanation wrongIndex(const Given& given);

//! Water taken for air, or air for water.
Explanation otherMedium(const Given& given);

//! A window for each camera, where some are said to share one.
Explanation ownWindows(const Given& given);

} // namespace tools

#endif // REFRACT_TOOLS_WRONG_VALUES_HPP
