// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/matches.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "formats/point_table.hpp"

#include <cmath>
#include <map>
#include <set>

using cv::format;

namespace tools {

namespace {

std::string pixelColumn(const char* coordinate, int camera) { return coordinate + std::to_string(camera + 1); }

std::string stdColumn(int camera) { return "std" + std::to_string(camera + 1); }

//! A column that is misspelt would be left out without a word.
void requireKnownColumns(const CsvTable& table, const std::string& path, const std::set<std::string>& known, const std::string& what)
{
    for (const std::string& name : table.names())
        if (!known.count(name))
            throw Failure("'" + path + "' has the column '" + name + "', which means nothing here: " + what);
}

CsvTable openMatches(const std::string& path, const Calibration& start, const std::string& startPath, const std::string& yFrom)
{
    const int cameras = (int)start.cameras.size();
    std::vector<std::string> required = {"id"};
    for (int c = 0; c < cameras; c++)
        required.insert(required.end(), {pixelColumn("u", c), pixelColumn("v", c)});
    const CsvTable table = readPointTable(path, required, format("a table of the pixels of the %d cameras of '%s'", cameras,
                                                                 startPath.c_str()), {yFrom, start.imageSizes()});
    if (table.find(pixelColumn("u", cameras)) >= 0)
        throw Failure(format("'%s' has pixels of camera %d, but '%s' has %d cameras", path.c_str(), cameras + 1, startPath.c_str(),
                             cameras));
    std::set<std::string> known(required.begin(), required.end());
    known.insert({"image", "x", "y", "z", "sx", "sy", "sz", "status"});
    for (int c = 0; c < cameras; c++)
        known.insert(stdColumn(c));
    requireKnownColumns(table, path, known, "an optional image, id, and u1,v1,u2,v2,... are wanted, std1,std2,... and what else "
                        "refract_match and refract_measure write");
    for (int c = 1; c < cameras; c++)
        if ((table.find(stdColumn(c)) >= 0) != (table.find(stdColumn(0)) >= 0))
            throw Failure("'" + path + "' has the standard deviations of some cameras only: give std1,std2,... of all, or of none");
    return table;
}

//! Of a pixel that was seen.
double readStd(const CsvTable& table, const CsvTable::Row& row, int camera, const cv::Point2d& pixel)
{
    const double std = table.numberOrNone(row, stdColumn(camera));
    if (seen(pixel) && !(std > 0 && std::isfinite(std)))
        throw Failure(table.where(row) + ": " + stdColumn(camera) + format(" is %g; the standard deviation of a pixel that was seen must "
                                                                           "be more than 0", std));
    return std;
}

//! Where it is no pixel of the camera, the columns are not those of the camera, or not raw.
void requireInside(const cv::Point2d& pixel, const cv::Size& size, const std::string& where, int camera)
{
    if (isFarOutside(pixel, size))
        throw Failure(where + format(": (%g, %g) is outside the image of camera %d, which has %dx%d pixels; raw pixels are wanted, "
                                     "(0, 0) the middle of the first one", pixel.x, pixel.y, camera + 1, size.width, size.height));
}

void requireCommonPoints(const Matches& matches, const std::string& path)
{
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        int common = 0;
        for (int i = 0; i < (int)matches.names.size(); i++)
            common += matches.pixels[c][i].x == matches.pixels[c][i].x && matches.seenBy(i) > 1;
        if (!common)
            throw Failure(format("'%s': camera %d has no point in common with another camera; a point is one row, with its pixel in each "
                                 "camera that saw it", path.c_str(), c + 1));
    }
}

} // namespace

int Matches::seenBy(int point) const
{
    int count = 0;
    for (const std::vector<cv::Point2d>& ofCamera : pixels)
        count += ofCamera[point].x == ofCamera[point].x;
    return count;
}

double Matches::usualStd() const
{
    double squares = 0.;
    int count = 0;
    for (size_t c = 0; c < stds.size(); c++)
        for (size_t i = 0; i < stds[c].size(); i++)
            if (isSeen((int)c, (int)i))
            {
                squares += stds[c][i]*stds[c][i];
                count++;
            }
    return count ? std::sqrt(squares/count) : 0.;
}

Matches readMatches(const std::string& path, const Calibration& start, const std::string& startPath, const std::string& yFrom)
{
    const int cameras = (int)start.cameras.size();
    if (cameras < 2)
        throw Failure("'" + startPath + "' has one camera: what one camera sees at one place has no depth. A rig of two cameras or "
                      "more is wanted; for a camera that moves, see refractiveBundleAdjust in doc/howto_bundle.md");
    const CsvTable table = openMatches(path, start, startPath, yFrom);
    Matches matches;
    matches.pixels.resize(cameras);
    matches.stds.resize(table.find(stdColumn(0)) >= 0 ? cameras : 0);
    std::map<PointName, int> lines;
    const bool hasImages = table.find("image") >= 0;
    for (const CsvTable::Row& row : table.rows())
    {
        const PointName name = {hasImages ? table.text(row, "image") : "", table.text(row, "id")};
        const auto first = lines.insert({name, row.line});
        if (!first.second)
            throw Failure(table.where(row) + format(": the point '%s' is in line %d already", name.text().c_str(), first.first->second)
                          + (hasImages ? "" : "; if it is of another moment, add a column image with the moment's name"));
        matches.names.push_back(name);
        for (int c = 0; c < cameras; c++)
        {
            matches.pixels[c].push_back(table.pixelOrNone(row, pixelColumn("u", c), pixelColumn("v", c)));
            requireInside(matches.pixels[c].back(), start.cameras[c].camera->imageSize(), table.where(row), c);
            if (!matches.stds.empty())
                matches.stds[c].push_back(readStd(table, row, c, matches.pixels[c].back()));
        }
    }
    requireCommonPoints(matches, path);
    return matches;
}

namespace {

//! Names -> places, and the images in their order.
struct PointIndex
{
    explicit PointIndex(const Matches& matches)
    {
        for (int i = 0; i < (int)matches.names.size(); i++)
        {
            places[matches.names[i]] = i;
            images.insert(matches.names[i].image);
            ids.insert(matches.names[i].id);
        }
    }
    //! -1: there is none.
    int find(const std::string& image, const std::string& id) const
    {
        const auto found = places.find({image, id});
        return found == places.end() ? -1 : found->second;
    }
    std::map<PointName, int> places;
    std::set<std::string> images, ids;
};

double positive(const CsvTable& table, const CsvTable::Row& row, const std::string& name)
{
    const double number = table.number(row, name);
    if (!(number > 0))
        throw Failure(table.where(row) + format(": %s is %g; it must be more than 0", name.c_str(), number)
                      + (name == "std" ? " (one standard deviation: the U of a certificate over its k)" : ""));
    return number;
}

//! The pairs of points that a row is of.
std::vector<std::pair<int, int>> pairsOf(const CsvTable& table, const CsvTable::Row& row, const std::string& matchesPath,
                                         const PointIndex& index)
{
    const std::string id1 = table.text(row, "id1"), id2 = table.text(row, "id2");
    const int column = table.find("image");
    const std::string image = column < 0 ? "" : row.cells[column];
    if (id1 == id2)
        throw Failure(table.where(row) + ": id1 and id2 are both '" + id1 + "'; a length is between two points");
    for (const std::string& id : {id1, id2})
        if (!index.ids.count(id))
            throw Failure(table.where(row) + ": '" + matchesPath + "' has no point '" + id + "'");
    if (!image.empty() && !index.images.count(image))
        throw Failure(table.where(row) + ": '" + matchesPath + "' has no image '" + image + "'");
    std::vector<std::pair<int, int>> pairs;
    for (const std::string& at : image.empty() ? index.images : std::set<std::string>{image})
        if (index.find(at, id1) >= 0 && index.find(at, id2) >= 0)
            pairs.push_back({index.find(at, id1), index.find(at, id2)});
    if (pairs.empty())
        throw Failure(table.where(row) + ": no image of '" + matchesPath + "' has both '" + id1 + "' and '" + id2 + "'");
    return pairs;
}

} // namespace

Matches thinned(const Matches& matches, const GivenLengths& lengths)
{
    const size_t ENOUGH = 200, count = matches.names.size();       // of points and of lengths
    std::vector<uchar> kept(count, 0);
    for (size_t i = 0; i < count; i += std::max<size_t>(1, count/ENOUGH))
        kept[i] = 1;
    for (size_t i = 0; i < lengths.list.size(); i += std::max<size_t>(1, lengths.list.size()/ENOUGH))
        kept[lengths.list[i].a] = kept[lengths.list[i].b] = 1;
    Matches some = matches;
    for (std::vector<cv::Point2d>& pixels : some.pixels)
        for (size_t i = 0; i < count; i++)
            if (!kept[i])
                pixels[i] = cv::Point2d(NAN, NAN);
    return some;
}

GivenLengths readLengths(const std::string& path, const std::string& matchesPath, const Matches& matches)
{
    const std::string what = "a table of known lengths";
    const CsvTable table(path, {"id1", "id2", "length", "std"}, what);
    requireKnownColumns(table, path, {"image", "id1", "id2", "length", "std"}, "an optional image, and id1,id2,length,std are wanted");
    const PointIndex index(matches);
    GivenLengths lengths;
    std::map<std::pair<double, double>, int> objects;
    std::map<std::pair<int, int>, int> lines;
    for (const CsvTable::Row& row : table.rows())
    {
        const double length = positive(table, row, "length"), std = positive(table, row, "std");
        if (std >= length/3)
            throw Failure(table.where(row) + format(": a length of %g with a standard deviation of %g is not known; are the columns "
                                                    "exchanged?", length, std));
        const int object = objects.insert({{length, std}, (int)objects.size()}).first->second;
        for (const std::pair<int, int>& pair : pairsOf(table, row, matchesPath, index))
        {
            const auto first = lines.insert({std::minmax(pair.first, pair.second), row.line});
            if (!first.second)
                throw Failure(table.where(row) + format(": the length between '%s' and '%s' is in line %d already",
                                                        matches.names[pair.first].text().c_str(),
                                                        matches.names[pair.second].text().c_str(), first.first->second));
            lengths.list.push_back({pair.first, pair.second, length, std, object, row.line});
        }
    }
    lengths.objects = (int)objects.size();
    return lengths;
}

double GivenLengths::leastStd() const
{
    double least = 0.;
    for (const GivenLength& l : list)
        least = least > 0. ? std::min(least, l.std/l.length) : l.std/l.length;
    return least;
}

double GivenLengths::commonStd() const { return std::hypot(leastStd(), factorStd); }

std::vector<int> GivenLengths::rowsOfObjects() const
{
    std::vector<int> times(objects, 0);
    for (const GivenLength& l : list)
        times[l.object]++;
    return times;
}

std::vector<cv::Vec4d> GivenLengths::rows() const
{
    const double OF_MOMENT = 1./20., least = leastStd();
    const std::vector<int> times = rowsOfObjects();
    std::vector<cv::Vec4d> result;
    for (const GivenLength& l : list)
    {
        const double beyond = std::max(l.std*l.std - std::pow(least*l.length, 2), 0.);
        result.push_back({(double)l.a, (double)l.b, l.length, std::sqrt(beyond*times[l.object] + std::pow(OF_MOMENT*l.std, 2))});
    }
    return result;
}

} // namespace tools
