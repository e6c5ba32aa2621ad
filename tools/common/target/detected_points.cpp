// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/detected_points.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "formats/point_table.hpp"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <tuple>

namespace tools {

namespace {

std::vector<std::string> splitWords(const std::string& line)
{
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word; )
        words.push_back(word);
    return words;
}

//! The columns by name: the first comment line of the file with a single '#'.
class Columns
{
public:
    Columns(const std::vector<std::string>& names, const std::string& path) : names_(names)
    {
        filename = find("filename");
        x = find("x");
        y = find("y");
        byWeight = find("weight") >= 0;
        weight = byWeight ? find("weight") : find("level");
        if (filename < 0 || x < 0 || y < 0)
            throw Failure("'" + path + "': the columns filename, x and y are needed");
    }
    size_t size() const { return names_.size(); }
    int filename, x, y, weight;
    bool byWeight;
private:
    int find(const std::string& name) const
    {
        const auto found = std::find(names_.begin(), names_.end(), name);
        return found == names_.end() ? -1 : (int)(found - names_.begin());
    }
    std::vector<std::string> names_;
};

//! NaN if the row says that the point was not seen.
cv::Point2d pointOf(const std::vector<std::string>& row, const Columns& columns, const std::string& where)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const cv::Point2d none(nan, nan);
    if (row[columns.x] == "-" || row[columns.y] == "-" || (columns.weight >= 0 && row[columns.weight] == "-"))
        return none;
    cv::Point2d point;
    double weight = 1.;
    if (!parseNumber(row[columns.x], point.x) || !parseNumber(row[columns.y], point.y)
        || !std::isfinite(point.x) || !std::isfinite(point.y)
        || (columns.weight >= 0 && !parseNumber(row[columns.weight], weight)))
        throw Failure(where + ": x, y and weight or level must be numbers or '-'");
    return columns.byWeight && weight <= 0 ? none : point;
}

} // namespace

std::vector<std::pair<std::string, std::vector<cv::Point2d>>> readCornersVnl(const std::string& path, int count)
{
    std::ifstream in(path);
    if (!in)
        throw Failure("there is no file '" + path + "' that can be read");
    std::vector<std::pair<std::string, std::vector<cv::Point2d>>> images;
    std::unique_ptr<Columns> columns;
    std::string line;
    for (int number = 1; takeLine(in, line); number++)
    {
        if (line.empty() || line.compare(0, 2, "##") == 0 || line.compare(0, 2, "#!") == 0)
            continue;
        if (line[0] == '#')
        {
            if (!columns)
                columns.reset(new Columns(splitWords(line.substr(1)), path));
            continue;
        }
        const std::vector<std::string> row = splitWords(line);
        const std::string where = "'" + path + "' line " + std::to_string(number);
        if (row.empty())
            continue;
        if (!columns)
            throw Failure(where + ": a line '# filename x y' must come before the data");
        if (row.size() != columns->size())
            throw Failure(where + ": " + std::to_string(columns->size()) + " columns expected; is the file cut short?");
        if (images.empty() || images.back().first != row[columns->filename])
            images.push_back({row[columns->filename], {}});
        images.back().second.push_back(pointOf(row, *columns, where));
    }
    for (auto& image : images)
    {
        std::vector<cv::Point2d>& points = image.second;
        if (points.size() == 1 && count > 1 && points[0].x != points[0].x)
            points.clear();
        else if ((int)points.size() != count)
            throw Failure("'" + path + "' has " + std::to_string(points.size()) + " points of '" + image.first
                          + "', the target has " + std::to_string(count) + ": check --size, or the file is cut short");
    }
    return images;
}

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
