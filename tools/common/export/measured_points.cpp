// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/measured_points.hpp"
#include "console/csv.hpp"

#include <cmath>

namespace tools {

std::vector<MeasuredPoint> readMeasuredPoints(const std::string& path, int cameras)
{
    std::vector<std::string> required = {"image"};
    for (int c = 1; c <= cameras; c++)
        for (const char* const coordinate : {"u", "v"})
            required.push_back(coordinate + std::to_string(c));
    required.insert(required.end(), {"x", "y", "z"});
    const CsvTable table(path, required, "what refract_measure writes for these cameras");
    std::vector<MeasuredPoint> points;
    for (const CsvTable::Row& row : table.rows())
    {
        const auto numberOf = [&](const std::string& name) { return table.numberOrNone(row, name); };
        MeasuredPoint point = {table.text(row, "image"), {}, {numberOf("x"), numberOf("y"), numberOf("z")}};
        for (int c = 1; c <= cameras; c++)
            point.pixels.emplace_back(numberOf("u" + std::to_string(c)), numberOf("v" + std::to_string(c)));
        if (std::isfinite(point.X.x + point.X.y + point.X.z))
            points.push_back(point);
    }
    return points;
}

} // namespace tools
