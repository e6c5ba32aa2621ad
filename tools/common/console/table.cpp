// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/table.hpp"
#include "console/lines.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace tools {

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

} // namespace

std::string plusMinus(double value, double std)
{
    const int decimals = std > 0 ? std::max(0, 1 - (int)std::floor(std::log10(std))) : 6;
    return format("%.*f +- %.*f", decimals, value, decimals, std);
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

} // namespace tools
