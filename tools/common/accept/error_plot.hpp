// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ERROR_PLOT_HPP
#define REFRACT_TOOLS_ERROR_PLOT_HPP

#include "accept/acceptance.hpp"

namespace tools {

//! Errors with their U over the tested length, between the limits. SVG.
std::string drawErrorsOverLength(const Acceptance& acceptance);

//! Where the lengths were, seen from above (z-x), each coloured by its error over its limit, in the box that was calibrated. SVG.
std::string drawErrorsInVolume(const Acceptance& acceptance);

} // namespace tools

#endif // REFRACT_TOOLS_ERROR_PLOT_HPP
