// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/points_csv.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace tools {

std::vector<DetectedImage> readPointsCsv(const std::string& path)
{
    const CsvTable table(path, {"view", "x", "y", "z", "u", "v"}, "a file of observed points");
    std::vector<DetectedImage> views;
    std::map<std::string, size_t> viewOf;
    std::set<std::tuple<std::string, double, double, double>> known;
    for (const CsvTable::Row& row : table.rows())
    {
        const std::string& name = table.text(row, "view");
        const cv::Point3d X(table.number(row, "x"), table.number(row, "y"), table.number(row, "z"));
        const cv::Point2d pixel = table.pixelOrNone(row, "u", "v");
        if (!known.insert({name, X.x, X.y, X.z}).second)
            throw Failure(table.where(row) + cv::format(": view '%s' has the point (%g, %g, %g) already: each point of a view is "
                          "seen once in a camera", name.c_str(), X.x, X.y, X.z));
        if (viewOf.emplace(name, views.size()).second)
            views.push_back({name, path, {}, {}});
        views[viewOf[name]].objectPoints.push_back(X);
        views[viewOf[name]].points.push_back(pixel);
    }
    std::sort(views.begin(), views.end(), [](const DetectedImage& a, const DetectedImage& b) { return a.stem < b.stem; });
    return views;
}

} // namespace tools
