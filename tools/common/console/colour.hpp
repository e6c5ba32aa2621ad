#ifndef REFRACT_TOOLS_COLOUR_HPP
#define REFRACT_TOOLS_COLOUR_HPP

#include <ostream>
#include <string>

namespace tools {

enum class Tone { GOOD, DOUBTFUL, BAD };

/** The text in green, yellow or red if `out` is std::cout and that is a terminal; as it is in files and pipes, where NO_COLOR is set
to anything (no-color.org), and on terminals without colours (TERM=dumb). */
std::string toned(const std::ostream& out, const std::string& text, Tone tone);

} // namespace tools

#endif // REFRACT_TOOLS_COLOUR_HPP
