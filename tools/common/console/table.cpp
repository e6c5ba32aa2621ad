// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"
#include "console/numbers.hpp"
#include <sys/stat.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <sstream>
#include <unistd.h>

namespace tools {

namespace {

//! Bytes of the character that begins there; 0: none does (RFC 3629).
size_t lengthOfCharacter(const std::string& text, size_t at)
{
    const unsigned char first = (unsigned char)text[at];
    const size_t length = first < 0x80 ? 1 : first >= 0xC2 && first < 0xE0 ? 2 : (first & 0xF0) == 0xE0 ? 3
        : first >= 0xF0 && first < 0xF5 ? 4 : 0;
    if (length == 0 || at + length > text.size())
        return 0;
    uint32_t code = length == 1 ? first : first & (0x7F >> length);
    for (size_t i = 1; i < length; i++)
    {
        const unsigned char next = (unsigned char)text[at + i];
        if ((next & 0xC0) != 0x80)
            return 0;
        code = code << 6 | (next & 0x3F);
    }
    const bool isLong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    return isLong || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? 0 : length;
}

} // namespace

std::string inLowerCase(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; });
    return text;
}

bool isUtf8(const std::string& text)
{
    for (size_t i = 0, length = 0; i < text.size(); i += length)
        if ((length = lengthOfCharacter(text, i)) == 0)
            return false;
    return true;
}

std::string toUtf8(const std::string& text)
{
    std::string result;
    for (size_t i = 0; i < text.size(); )
    {
        const size_t length = lengthOfCharacter(text, i);
        result += length ? text.substr(i, length) : "\xEF\xBF\xBD";
        i += length ? length : 1;
    }
    return result;
}

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

namespace {

const size_t GAP = 2, INDENT = 4;
const size_t FIRST = 8;         // columns by which the first may be wider than the others

size_t longestWord(const std::string& cell)
{
    size_t longest = 0;
    std::istringstream words(cell);
    for (std::string word; words >> word; )
        longest = std::max(longest, columnsOf(word));
    return longest;
}

bool isContinuation(char c) { return (c & 0xC0) == 0x80; }

//! Takes the characters that fit into so many columns off the beginning of a word.
std::string takeColumns(std::string& word, size_t columns)
{
    size_t end = 0, width = 0;
    while (end < word.size() && (width < columns || isContinuation(word[end])))
        width += !isContinuation(word[end++]);
    const std::string taken = word.substr(0, end);
    word.erase(0, end);
    return taken;
}

} // namespace

std::string plusMinus(double value, double std)
{
    const int decimals = decimalsOf(std);
    return rounded(value, decimals) + " +- " + rounded(std, decimals);
}

Table::Table(const std::vector<std::string>& heading, size_t screen) : rows_(1, heading), screen_(screen) {}

void Table::add(const std::vector<std::string>& row)
{
    rows_.push_back(row);
}

/** As wide as the cells are. Where that is too wide, headings are broken first, then the cells of the widest columns, those of
the first, which name the row, last; words stay whole. */
std::vector<size_t> Table::columnWidths() const
{
    std::vector<size_t> widths, bodies, words;
    for (const auto& row : rows_)
        for (size_t i = 0; i < row.size(); i++)
        {
            widths.resize(std::max(widths.size(), row.size()));
            bodies.resize(widths.size());
            words.resize(widths.size());
            widths[i] = std::max(widths[i], columnsOf(row[i]));
            words[i] = std::max(words[i], longestWord(row[i]) + (i == 0 ? INDENT : 0));
            if (&row != &rows_.front())
                bodies[i] = std::max(bodies[i], columnsOf(row[i]));
        }
    size_t total = 0;
    for (size_t w : widths)
        total += w + (total ? GAP : 0);
    for (bool headings : {true, false})
        for (size_t widest = 0; total > screen_ && widest < widths.size(); )
        {
            widest = widths.size();
            for (size_t i = 0; i < widths.size(); i++)
                if (widths[i] > (headings ? std::max(bodies[i], words[i]) : words[i]) &&
                    (widest == widths.size() || widths[i] + (widest == 0 ? FIRST : 0) > widths[widest]))
                    widest = i;
            if (widest < widths.size())
            {
                --widths[widest];
                total--;
            }
        }
    return widths;
}

void Table::print(std::ostream& out) const
{
    const std::vector<size_t> widths = columnWidths();
    for (const auto& row : rows_)
    {
        std::vector<std::vector<std::string>> cells;        // each in its lines
        size_t lines = 1;
        for (size_t i = 0; i < row.size(); i++)
        {
            cells.push_back(brokenInto(row[i], widths[i], std::string(i ? 0 : INDENT, ' '), LongWords::WHOLE));
            lines = std::max(lines, cells[i].size());
        }
        for (size_t k = 0; k < lines; k++)
        {
            std::string line;
            for (size_t i = 0; i < row.size(); i++)
            {
                const std::string cell = k < cells[i].size() ? cells[i][k] : "";
                const std::string space(widths[i] - columnsOf(cell), ' ');
                line += (i ? std::string(GAP, ' ') : "") + (i ? space + cell : cell + space);
            }
            out << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
        }
        if (&row == &rows_.front())
        {
            size_t total = 0;
            for (size_t w : widths)
                total += w + GAP;
            out << std::string(total - GAP, '-') << '\n';
        }
    }
}

size_t columnsOf(const std::string& text)
{
    return std::count_if(text.begin(), text.end(), [](char c) { return !isContinuation(c); });
}

std::vector<std::string> brokenInto(const std::string& text, size_t columns, const std::string& indent, LongWords longWords)
{
    if (columnsOf(text) <= columns)
        return {text};
    std::vector<std::string> lines(1, text.substr(0, text.find_first_not_of(' ')));    // its own indent stays
    const std::string next = lines[0] + indent;
    std::istringstream words(text);
    bool first = true;          // of its line
    for (std::string word; words >> word; first = false)
    {
        if (!first && columnsOf(lines.back()) + 1 + columnsOf(word) > columns)
        {
            lines.push_back(next);
            first = true;
        }
        while (longWords == LongWords::BROKEN && columnsOf(lines.back()) + columnsOf(word) > columns && first && columnsOf(next) < columns)
        {
            lines.back() += takeColumns(word, columns - columnsOf(lines.back()));
            lines.push_back(next);
        }
        lines.back() += (first ? "" : " ") + word;
    }
    return lines;
}

std::vector<std::string> firstOf(const std::vector<std::string>& lines, size_t count, size_t columns)
{
    const std::string MORE = " ...";
    if (lines.size() <= count)
        return lines;
    std::vector<std::string> first(lines.begin(), lines.begin() + count);
    while (!first.empty() && columnsOf(first.back()) + MORE.size() > columns)
    {
        const size_t space = first.back().find_last_of(' ');
        first.back().resize(space == std::string::npos ? columns - MORE.size() : space);
    }
    if (!first.empty())
        first.back() += MORE;
    return first;
}

std::string alternatives(const std::vector<std::string>& sentences, size_t most)
{
    if (sentences.size() - std::min(most, sentences.size()) == 1)        // to say that there is one other takes as many words
        most++;
    std::string text;
    for (size_t i = 0; i < std::min(most, sentences.size()); i++)
        text += (i ? "; or " : "") + sentences[i];
    return text + (sentences.size() > most ? "; or one of " + std::to_string(sentences.size() - most) + " others" : "");
}

bool takeLine(std::istream& in, std::string& line)
{
    const int END = std::istream::traits_type::eof();
    line.clear();
    if (!in || in.peek() == END)
        return false;
    std::streambuf& bytes = *in.rdbuf();
    for (int c = bytes.sbumpc(); c != END && c != '\n'; c = bytes.sbumpc())
    {
        if (c == '\r')
        {
            if (bytes.sgetc() == '\n')
                bytes.sbumpc();
            break;
        }
        line += (char)c;
    }
    return true;
}

bool errorsFollowOutput()
{
    struct stat out, err;
    return fstat(STDOUT_FILENO, &out) == 0 && fstat(STDERR_FILENO, &err) == 0 && out.st_dev == err.st_dev && out.st_ino == err.st_ino;
}

} // namespace tools
