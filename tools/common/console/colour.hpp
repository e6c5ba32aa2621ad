// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLOUR_HPP
#define REFRACT_TOOLS_COLOUR_HPP

#include <ostream>
#include <string>

namespace tools {

enum class Tone { GOOD, DOUBTFUL, BAD };

//! TERM says that the terminal knows what escape sequences do.
bool takesEscapes();

/** The text in green, yellow or red if `out` is std::cout and that is a terminal; as it is in files and pipes, where NO_COLOR is set
to anything (no-color.org), and on terminals without colours (TERM=dumb). */
std::string toned(const std::ostream& out, const std::string& text, Tone tone);

} // namespace tools

#endif // REFRACT_TOOLS_COLOUR_HPP
