// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/detected_images.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "console/view_names.hpp"
#include "formats/point_table.hpp"
#include "target/target_search.hpp"
#include <algorithm>
#include <cmath>
#include <filesystem>
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

/** Images of a target whose dots have names: a table of points in any program's form (point_table.hpp), whose points are called as the
target's. One that has pixels of one camera only is that of each; a table without frames is one view.
@param yFrom see PixelOrigin */
static std::vector<DetectedImage> readPointTableOf(const Target& target, const std::string& path, int camera, cv::Size imageSize,
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

int DetectedImage::seenCount() const
{
    return (int)std::count_if(points.begin(), points.end(), seen);
}

const DetectedImage* DetectedImages::find(const std::string& stem) const
{
    const auto found = std::find_if(images.begin(), images.end(), [&](const DetectedImage& image) { return image.stem == stem; });
    return found == images.end() ? nullptr : &*found;
}

namespace {

void addImage(DetectedImages& set, const std::string& name, const std::string& path, const std::vector<cv::Point2d>& points)
{
    if (points.empty())
        set.withoutTarget.push_back(path);
    else
        set.images.push_back({name, path, points, {}});
}

DetectedImages imagesWith(const std::vector<std::vector<cv::Point2d>>& points, const std::vector<std::string>& paths, cv::Size size)
{
    DetectedImages set;
    set.files = paths;
    set.imageSize = size;
    const std::vector<std::string> names = viewNames(paths);
    for (size_t i = 0; i < paths.size(); i++)
        addImage(set, names[i], paths[i], points[i]);
    return set;
}

//! Points of another image size are not.
void requireInside(const std::string& path, const std::string& image, const std::vector<cv::Point2d>& points, cv::Size size)
{
    for (const cv::Point2d& p : points)
        if (isFarOutside(p, size))
            throw Failure("'" + path + "': a point of '" + image + "' is at " + cv::format("(%g, %g)", p.x, p.y)
                          + ", outside of an image of " + sizeText(size) + ": check --image-size, or the size that the "
                          "calibration says");
}

std::string extensionOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

//! Tables of which each camera has its own: %d stands for its number.
bool areFilesOfCameras(const std::string& source) { return source.find("%d") != std::string::npos; }

//! Not the target's: x, y, z are in it.
bool hasCoordinates(const std::string& path)
{
    if (areFilesOfCameras(path))
        return false;
    const std::vector<std::string> heading = headingOf(path);
    return std::find(heading.begin(), heading.end(), "view") != heading.end();
}

//! The file that has this camera's points.
std::string fileOf(const ImageSource& source)
{
    if (!areFilesOfCameras(source.source))
        return source.source;
    const std::vector<std::string> files = numberedFiles(source.source);
    return source.camera < (int)files.size() ? files[source.camera] : source.source;       // what is missing, the reader says
}

DetectedImages imagesOfPointFile(const ImageSource& source, const Target* target)
{
    const std::string& path = source.source;
    const cv::Size imageSize = source.imageSize;
    if (imageSize.empty())
        throw Failure("'" + path + "' does not say how large the images are: add --image-size=WIDTHxHEIGHT");
    DetectedImages set;
    set.files = {fileOf(source)};
    set.imageSize = imageSize;
    const bool hasNames = target && target->pattern() == Target::DOTS;
    if (areFilesOfCameras(path) && !hasNames)
        throw Failure("'" + path + "' has pixels of points, and --target=FILE must say where these are");
    if (hasNames && extensionOf(path) != ".vnl" && !hasCoordinates(path))
        set.images = readPointTableOf(*target, path, source.camera, imageSize, source.yFrom);
    else if (extensionOf(path) == ".csv")
        set.images = readPointsCsv(path);
    else
        for (const auto& image : readCornersVnl(path, target->count()))
            addImage(set, stemOf(image.first), image.first, image.second);
    for (const DetectedImage& image : set.images)
        requireInside(path, extensionOf(path) == ".csv" ? image.stem : image.path, image.points, imageSize);
    return set;
}

void requireDistinctStems(const DetectedImages& set, const std::string& source)
{
    std::set<std::string> stems;
    for (const DetectedImage& image : set.images)
        if (!stems.insert(image.stem).second)
            throw Failure("two images of '" + source + "' are called '" + image.stem
                          + "': each needs a name of its own, as equal names mean images of one moment");
}

} // namespace

namespace {

//! No image is one of two cameras, nor one without and with the window. @param files of each source
void requireOwnFiles(const std::vector<ImageSource>& sources, const std::vector<std::vector<std::string>>& files)
{
    const auto nameOf = [&](size_t s) { return cv::format("the %s of camera %d", sources[s].name.c_str(), sources[s].camera + 1); };
    std::map<std::filesystem::path, size_t> known;
    for (size_t s = 0; s < files.size(); s++)
        for (const std::string& file : files[s])
        {
            const size_t first = known.insert({std::filesystem::weakly_canonical(file), s}).first->second;
            if (first != s)
                throw Failure("'" + file + "' is one of " + nameOf(first) + " and one of " + nameOf(s) + ": give each its own images");
        }
}

} // namespace

bool isPointFile(const std::string& source)
{
    const std::string OPENPTV = "_targets";
    const bool areTargets = source.size() > OPENPTV.size() && source.substr(source.size() - OPENPTV.size()) == OPENPTV;
    return areTargets || areFilesOfCameras(source) || extensionOf(source) == ".vnl" || extensionOf(source) == ".csv";
}

std::vector<DetectedImages> readDetectedImages(const std::vector<ImageSource>& sources, const Target* target, bool quiet, Channel channel)
{
    std::vector<std::vector<std::string>> files;
    size_t count = 0;
    for (const ImageSource& source : sources)
    {
        if (!target && extensionOf(source.source) != ".csv" && !areFilesOfCameras(source.source))
            throw Failure("'" + source.source + "' shows a target that must be known: give --size and --square (only a points.csv "
                          "brings its own coordinates)");
        files.push_back(isPointFile(source.source) ? std::vector<std::string>() : expandGlob(source.source));
        count += files.back().size();
    }
    requireOwnFiles(sources, files);
    const std::vector<cv::Size> sizes = checkImages(sources, files, channel, quiet);
    std::vector<std::unique_ptr<TargetSearch>> searches;        // null: of a point file
    for (size_t s = 0; s < sources.size(); s++)
        searches.push_back(files[s].empty() ? nullptr : std::make_unique<TargetSearch>(sources[s].source, files[s], *target, channel));
    Progress progress("searching images for the target", (int)count, quiet);
    for (const auto& search : searches)
        if (search)
            search->begin(progress);
    std::vector<DetectedImages> sets;
    for (size_t s = 0; s < sources.size(); s++)
    {
        sets.push_back(searches[s] ? imagesWith(searches[s]->finish(progress), files[s], sizes[s])
                                   : imagesOfPointFile(sources[s], target));
        if (sets.back().images.empty())
            throw Failure("'" + sources[s].source + "' has no points of the target: check --pattern and --size, or --target");
        requireDistinctStems(sets.back(), sources[s].source);
    }
    return sets;
}

DetectedImages readDetectedImages(const std::string& source, const Target* target, cv::Size imageSize, bool quiet, Channel channel)
{
    return readDetectedImages({{source, imageSize, 0, "images", ""}}, target, quiet, channel)[0];
}

} // namespace tools
