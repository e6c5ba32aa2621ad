// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/colour.hpp"

#include <unistd.h>
#include <cstdlib>
#include <iostream>

namespace tools {

bool takesEscapes()
{
    const char* const terminal = std::getenv("TERM");
    return terminal && terminal != std::string("dumb");
}

std::string toned(const std::ostream& out, const std::string& text, Tone tone)
{
    const char* const none = std::getenv("NO_COLOR");
    if (&out != &std::cout || !isatty(STDOUT_FILENO) || !takesEscapes() || (none && *none))
        return text;
    const char* const code = tone == Tone::GOOD ? "32" : tone == Tone::BAD ? "31" : "33";
    return std::string("\033[1;") + code + "m" + text + "\033[0m";
}

} // namespace tools
