// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace tools {

namespace {

//! Characters on the screen: UTF-8 continuation bytes take no place.
size_t width(const std::string& cell)
{
    return std::count_if(cell.begin(), cell.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

const size_t SCREEN = 100, GAP = 2, INDENT = 4;
const size_t FIRST = 8;         // columns by which the first may be wider than the others

size_t longestWord(const std::string& cell)
{
    size_t longest = 0;
    std::istringstream words(cell);
    for (std::string word; words >> word; )
        longest = std::max(longest, width(word));
    return longest;
}

//! Lines of a width at most; the second and on are indented if wanted.
std::vector<std::string> brokenInto(const std::string& cell, size_t most, bool indent)
{
    if (width(cell) <= most)
        return {cell};
    std::vector<std::string> lines(1, cell.substr(0, cell.find_first_not_of(' ')));    // its own indent stays
    const std::string next = lines[0] + (indent ? std::string(INDENT, ' ') : "");
    std::istringstream words(cell);
    bool first = true;
    for (std::string word; words >> word; first = false)
        if (!first && width(lines.back()) + 1 + width(word) > most)
            lines.push_back(next + word);
        else
            lines.back() += (first ? "" : " ") + word;
    return lines;
}

} // namespace

std::string plusMinus(double value, double std)
{
    const int decimals = std > 0 ? std::max(0, 1 - (int)std::floor(std::log10(std))) : 6;
    return format("%.*f +- %.*f", decimals, value, decimals, std);
}

Table::Table(const std::vector<std::string>& heading) : rows_(1, heading) {}

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
            widths[i] = std::max(widths[i], width(row[i]));
            words[i] = std::max(words[i], longestWord(row[i]) + (i == 0 ? INDENT : 0));
            if (&row != &rows_.front())
                bodies[i] = std::max(bodies[i], width(row[i]));
        }
    size_t total = 0;
    for (size_t w : widths)
        total += w + (total ? GAP : 0);
    for (bool headings : {true, false})
        for (size_t widest = 0; total > SCREEN && widest < widths.size(); )
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
            cells.push_back(brokenInto(row[i], widths[i], i == 0));
            lines = std::max(lines, cells[i].size());
        }
        for (size_t k = 0; k < lines; k++)
        {
            std::string line;
            for (size_t i = 0; i < row.size(); i++)
            {
                const std::string cell = k < cells[i].size() ? cells[i][k] : "";
                const std::string space(widths[i] - width(cell), ' ');
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

} // namespace tools
