// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WRONG_TARGET_HPP
#define REFRACT_TOOLS_WRONG_TARGET_HPP

#include "assess/given.hpp"

/* A target that is not as it was said to be, told without a fit through the window. A sentence each; empty: it is not so. */
namespace tools {

//! A part of the board is found in place of all of it, and not the same part each time.
std::string partOfBoard(const Given& given);

//! Corners that no lens explains, each board where it fits best.
std::string badCorners(const Given& given);

} // namespace tools

#endif // REFRACT_TOOLS_WRONG_TARGET_HPP
