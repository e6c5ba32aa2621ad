// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/measuring_lines.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

using cv::Vec3d;

namespace tools {

namespace {

const size_t LINES = 7, LENGTHS_A_LINE = 5;
const double OF_DIAGONAL = 2./3., NEXT_TO_LINE = 0.05, ACROSS = 0.1, SAME_LENGTH = 0.01;

Vec3d endOf(const Acceptance& a, size_t length, int end) { return a.points.points[a.lengths[length].length.ends[end]].X; }

bool isOnLine(const Acceptance& a, size_t line, size_t length)
{
    const Vec3d start = endOf(a, line, 0), along = endOf(a, line, 1) - start;
    const Vec3d own = endOf(a, length, 1) - endOf(a, length, 0);
    const double scale = norm(along);
    if (norm(own.cross(along)) > ACROSS*norm(own)*scale)            // a short one that crosses it
        return false;
    for (int end : {0, 1})
        if (norm((endOf(a, length, end) - start).cross(along))/scale > NEXT_TO_LINE*scale)
            return false;
    return true;
}

//! Lengths that differ, in the volume.
size_t countDistinct(const Acceptance& a, const MeasuringLine& line)
{
    std::vector<double> lengths;
    for (size_t i : line)
        if (!a.lengths[i].outside)
            lengths.push_back(a.lengths[i].length.length);
    std::sort(lengths.begin(), lengths.end());
    size_t count = 0;
    double last = 0.;
    for (double length : lengths)
        if (length > (1 + SAME_LENGTH)*last)
        {
            count++;
            last = length;
        }
    return count;
}

} // namespace

std::vector<MeasuringLine> measuringLines(const Acceptance& a)
{
    std::vector<size_t> order(a.lengths.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t i, size_t j) {
        return a.lengths[i].length.length > a.lengths[j].length.length; });
    std::vector<MeasuringLine> lines;
    for (size_t i : order)
    {
        const auto line = std::find_if(lines.begin(), lines.end(), [&](const MeasuringLine& l) { return isOnLine(a, l[0], i); });
        if (line == lines.end())
            lines.push_back({i});
        else
            line->push_back(i);
    }
    return lines;
}

std::vector<std::string> missingOf(const Acceptance& a)
{
    const std::vector<MeasuringLine> lines = measuringLines(a);
    size_t whole = 0;
    double longest = 0.;
    for (const MeasuringLine& line : lines)
        whole += countDistinct(a, line) >= LENGTHS_A_LINE;
    for (const LengthResult& length : a.lengths)
        longest = std::max(longest, length.outside ? 0. : length.length.length);
    std::vector<std::string> missing;
    if (whole < LINES)
        missing.push_back(format("%zu of %zu measuring lines have %zu lengths or more (of %zu lines)", whole, LINES, LENGTHS_A_LINE,
                                 lines.size()));
    if (!a.volume.box)
        missing.push_back("the volume is not known, of whose diagonal the longest length must be two thirds (--volume)");
    else if (longest < OF_DIAGONAL*a.volume.box->diagonal())
        missing.push_back(format("the longest length is %.2g of the diagonal of %s, %.4g, not two thirds",
                                 longest/a.volume.box->diagonal(), a.volume.name().c_str(), a.volume.box->diagonal()));
    return missing;
}

} // namespace tools
