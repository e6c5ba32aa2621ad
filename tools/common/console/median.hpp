// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEDIAN_HPP
#define REFRACT_TOOLS_MEDIAN_HPP

#include <vector>

namespace tools {

//! Of an even number the upper one of the two in the middle; NaN of none.
double median(std::vector<double> values);

} // namespace tools

#endif // REFRACT_TOOLS_MEDIAN_HPP
