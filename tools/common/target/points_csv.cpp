// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/points_csv.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "formats/point_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace tools {

std::vector<DetectedImage> readPointsCsv(const std::string& path)
{
    const CsvTable table(path, {"view", "x", "y", "z", "u", "v"}, "a file of observed points (without --target, which says where "
                         "the points of a table are)");
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

std::vector<DetectedImage> readPointTableOf(const Target& target, const std::string& path, int camera, cv::Size imageSize,
                                            const std::string& yFrom)
{
    const PixelOrigin origin = {yFrom, std::vector<cv::Size>(camera + 1, imageSize)};
    const CsvTable table = readPointTable(path, {"id", "u1", "v1"}, "a table of points", origin);
    const std::string number = table.find("u2") < 0 ? "1" : std::to_string(camera + 1), u = "u" + number, v = "v" + number;
    if (table.find(u) < 0 || table.find(v) < 0)
        throw Failure("'" + path + "' has no columns " + u + " and " + v + ", which would be those of camera " + number);
    std::map<std::string, size_t> places;
    for (size_t i = 0; i < target.ids().size(); i++)
        places[target.ids()[i]] = i;
    const std::vector<cv::Point2d> none(target.ids().size(), cv::Point2d(NAN, NAN));
    std::map<std::string, DetectedImage> views;
    std::set<std::pair<std::string, std::string>> known;
    for (const CsvTable::Row& row : table.rows())
    {
        const std::string name = table.find("image") < 0 ? "1" : table.text(row, "image"), id = table.text(row, "id");
        if (!places.count(id))
            throw Failure(table.where(row) + ": --target has no point '" + id + "'");
        if (!known.insert({name, id}).second)
            throw Failure(table.where(row) + ": view '" + name + "' has the point '" + id + "' already");
        DetectedImage& view = views.emplace(name, DetectedImage{name, path, none, {}}).first->second;
        view.points[places[id]] = table.pixelOrNone(row, u, v);
    }
    std::vector<DetectedImage> all;
    for (const auto& view : views)
        all.push_back(view.second);
    return all;
}

} // namespace tools
