// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ROUNDED_HPP
#define REFRACT_TOOLS_ROUNDED_HPP

#include <string>

/* Numbers beside their uncertainty: two significant digits of it, and the value as far (GUM 7.2.6), whatever the unit is. */
namespace tools {

//! Digits after the decimal point that an uncertainty leaves; below 0 tens, hundreds. Of 0 and NaN 6.
int decimalsOf(double uncertainty);

//! @param sign also of a positive number
std::string rounded(double value, int decimals, bool sign = false);

} // namespace tools

#endif // REFRACT_TOOLS_ROUNDED_HPP
