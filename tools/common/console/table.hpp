// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TABLE_HPP
#define REFRACT_TOOLS_TABLE_HPP

#include <opencv2/core.hpp>
#include <iosfwd>
#include <istream>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace tools {

/* Pages, XML and JSON are UTF-8; what users give may be anything. */
bool isUtf8(const std::string& text);

//! The letters of ASCII; others stay as they are.
std::string inLowerCase(std::string text);

//! With a replacement character for each byte that is none of a character: for names of files, which may be any bytes.
std::string toUtf8(const std::string& text);

enum class Tone { GOOD, DOUBTFUL, BAD };

//! TERM says that the terminal knows what escape sequences do.
bool takesEscapes();

/** The text in green, yellow or red if `out` is std::cout and that is a terminal; as it is in files and pipes, where NO_COLOR is set
to anything (no-color.org), and on terminals without colours (TERM=dumb). */
std::string toned(const std::ostream& out, const std::string& text, Tone tone);

/** A plain text table: the first column flush left, the others flush right. Fits a terminal: where it is wider, the cells of the
widest columns are broken between words. */
class Table
{
public:
    //! @param screen columns of the terminal
    explicit Table(const std::vector<std::string>& heading, size_t screen = 100);
    void add(const std::vector<std::string>& row);      //!< missing cells are empty
    void print(std::ostream& out) const;
private:
    std::vector<size_t> columnWidths() const;

    std::vector<std::vector<std::string>> rows_;
    size_t screen_;
};

using cv::format;   //!< printf for a cell

//! "7.040 +- 0.020": two digits of the standard deviation, and the value as far.
std::string plusMinus(double value, double std);

//! Characters on the screen: UTF-8 continuation bytes take no place.
size_t columnsOf(const std::string& text);

enum class LongWords { WHOLE, BROKEN };

/** Lines of so many columns at most, broken between words; `indent` begins the second and on. A word that is longer than a line stays
whole, and the line is longer, or is broken. */
std::vector<std::string> brokenInto(const std::string& text, size_t columns, const std::string& indent, LongWords longWords);

//! The first of these lines; where some are missing the last ends with "...".
std::vector<std::string> firstOf(const std::vector<std::string>& lines, size_t count, size_t columns);

//! "a; or b; or c". @param most of them; then how many others there are
std::string alternatives(const std::vector<std::string>& sentences, size_t most = std::numeric_limits<size_t>::max());

//! One line of a file, whichever of LF, CR LF or CR alone ends it; false: there is none.
bool takeLine(std::istream& in, std::string& line);

//! What goes to stderr comes out where stdout does: on one terminal, in one file, into one pipe.
bool errorsFollowOutput();

} // namespace tools

#endif // REFRACT_TOOLS_TABLE_HPP
