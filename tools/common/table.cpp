#include "table.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace tools {

namespace {

//! Characters on the screen: UTF-8 continuation bytes take no place.
size_t width(const std::string& cell)
{
    return std::count_if(cell.begin(), cell.end(), [](char c) { return (c & 0xC0) != 0x80; });
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

void Table::print(std::ostream& out) const
{
    std::vector<size_t> widths;
    for (const auto& row : rows_)
    {
        widths.resize(std::max(widths.size(), row.size()));
        for (size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], width(row[i]));
    }
    for (const auto& row : rows_)
    {
        std::string line;
        for (size_t i = 0; i < row.size(); ++i)
        {
            const std::string space(widths[i] - width(row[i]), ' ');
            line += (i ? "  " : "") + (i ? space + row[i] : row[i] + space);
        }
        out << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
        if (&row == &rows_.front())
        {
            size_t total = 0;
            for (size_t w : widths)
                total += w + 2;
            out << std::string(total - 2, '-') << '\n';
        }
    }
}

} // namespace tools
