// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/point_file.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "console/utf8.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

namespace tools {

namespace {

//! Cells with blanks, commas or semicolons between; what stands in quotes is one cell.
std::vector<std::string> cellsOf(const std::string& line)
{
    std::vector<std::string> cells;
    bool quoted = false, between = true;
    for (const char c : line)
    {
        if (c == '"')
            quoted = !quoted;
        const bool separates = !quoted && (c == ',' || c == ';' || std::isspace((unsigned char)c));
        if (!separates && between)
            cells.emplace_back();
        if (!separates)
            cells.back() += c;
        between = separates;
    }
    return cells;
}

//! Index of the column called `name` or `name`1, or the number of columns.
size_t columnOf(const std::vector<std::string>& names, const std::string& name)
{
    return std::find_if(names.begin(), names.end(),
                        [&](const std::string& n) { return inLowerCase(n) == name || inLowerCase(n) == name + "1"; }) - names.begin();
}

} // namespace

std::vector<cv::Point2d> readPixels(const std::string& path)
{
    std::ifstream in(path);
    if (!in)
        throw Failure("there is no file '" + path + "' that can be read");
    std::vector<cv::Point2d> pixels;
    size_t u = 0, v = 1;
    std::string line;
    bool first = true;
    for (int number = 1; takeLine(in, line); number++)
    {
        const std::vector<std::string> cells = cellsOf(line);
        if (cells.empty() || cells[0][0] == '#')
            continue;
        const bool heading = first && columnOf(cells, "u") < cells.size() && columnOf(cells, "v") < cells.size();
        first = false;
        if (heading)
        {
            u = columnOf(cells, "u");
            v = columnOf(cells, "v");
            continue;
        }
        cv::Point2d pixel;
        if (std::max(u, v) >= cells.size() || !parseNumber(cells[u], pixel.x)
            || !parseNumber(cells[v], pixel.y))
            throw Failure("'" + path + "' line " + std::to_string(number) + ": two numbers u v are needed");
        if (std::isfinite(pixel.x) && std::isfinite(pixel.y))       // nan: not seen
            pixels.push_back(pixel);
    }
    if (pixels.empty())
        throw Failure("'" + path + "' has no points: give one 'u v' a line");
    return pixels;
}

} // namespace tools
