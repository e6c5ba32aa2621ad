#include "export/measured_points.hpp"
#include "console/cli.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace tools {

namespace {

//! The comma-separated cells of a line.
std::vector<std::string> cellsOf(std::string line)
{
    if (!line.empty() && line.back() == '\r')
        line.pop_back();
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line)
    {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += c;
    }
    return cells;
}

//! Where in a line the columns stand.
struct Columns
{
    size_t image, x, y, z;
    std::vector<size_t> u, v;
};

size_t columnOf(const std::vector<std::string>& heading, const std::string& name, const std::string& path)
{
    const size_t at = std::find(heading.begin(), heading.end(), name) - heading.begin();
    if (at == heading.size())
        throw Failure("'" + path + "' has no column '" + name + "' in its first line: give what refract_measure wrote for these cameras");
    return at;
}

Columns columnsOf(const std::vector<std::string>& heading, const std::string& path, int cameras)
{
    Columns columns = {columnOf(heading, "image", path), columnOf(heading, "x", path), columnOf(heading, "y", path),
                       columnOf(heading, "z", path), {}, {}};
    for (int c = 1; c <= cameras; c++)
    {
        columns.u.push_back(columnOf(heading, "u" + std::to_string(c), path));
        columns.v.push_back(columnOf(heading, "v" + std::to_string(c), path));
    }
    return columns;
}

} // namespace

std::vector<MeasuredPoint> readMeasuredPoints(const std::string& path, int cameras)
{
    std::ifstream in(path);
    std::string line;
    if (!in || !std::getline(in, line))
        throw Failure("there is no file '" + path + "' that can be read, or it is empty");
    const std::vector<std::string> heading = cellsOf(line);
    const Columns columns = columnsOf(heading, path, cameras);
    std::vector<MeasuredPoint> points;
    for (int number = 2; std::getline(in, line); number++)
    {
        const std::vector<std::string> cells = cellsOf(line);
        if (line.empty())
            continue;
        if (cells.size() != heading.size())
            throw Failure(cv::format("'%s', line %d: %d cells, and the first line has %d", path.c_str(), number, (int)cells.size(),
                                     (int)heading.size()));
        const auto numberOf = [&](size_t column) {
            double value = NAN;
            if (!cells[column].empty() && cells[column] != "nan" && !parseNumber(cells[column], value))
                throw Failure(cv::format("'%s', line %d: '%s' is no number", path.c_str(), number, cells[column].c_str()));
            return value;
        };
        MeasuredPoint point = {cells[columns.image], {}, {numberOf(columns.x), numberOf(columns.y), numberOf(columns.z)}};
        for (int c = 0; c < cameras; c++)
            point.pixels.emplace_back(numberOf(columns.u[c]), numberOf(columns.v[c]));
        if (std::isfinite(point.X.x + point.X.y + point.X.z))
            points.push_back(point);
    }
    return points;
}

} // namespace tools
