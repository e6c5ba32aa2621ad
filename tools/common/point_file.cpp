#include "point_file.hpp"
#include "cli.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace tools {

namespace {

std::vector<std::string> cellsOf(std::string line)
{
    std::replace_if(line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream in(line);
    std::vector<std::string> cells;
    for (std::string cell; in >> cell; )
        cells.push_back(cell);
    return cells;
}

//! Index of the column called `name` or `name`1, or the number of columns.
size_t columnOf(const std::vector<std::string>& names, const std::string& name)
{
    return std::find_if(names.begin(), names.end(),
                        [&](const std::string& n) { return n == name || n == name + "1"; }) - names.begin();
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
    for (int number = 1; std::getline(in, line); ++number)
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
