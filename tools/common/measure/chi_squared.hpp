// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHI_SQUARED_HPP
#define REFRACT_TOOLS_CHI_SQUARED_HPP

namespace tools {

//! P(chi^2 > x) of so many degrees of freedom, a finite sum; 1 for x <= 0.
double upperTailChiSquared(int dof, double x);

} // namespace tools

#endif // REFRACT_TOOLS_CHI_SQUARED_HPP
