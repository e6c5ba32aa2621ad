// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/point_table.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include "formats/foreign_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace tools {

namespace {

const size_t MOST_CAMERAS = 1000;
const double CORNER = 0.5;          // where pixels count from the corner of the first

//! A point in one camera, as cells.
struct Observation
{
    std::string frame, point;
    size_t camera;
    std::string u, v;               //!< empty: not seen
    int line;
};

//! One row a point. @param first what the file calls the first camera
CsvTable tableOf(const std::string& path, const std::vector<Observation>& all, size_t first)
{
    std::vector<std::string> names = {"image", "id"};
    size_t cameras = 0;
    for (const Observation& o : all)
        cameras = std::max(cameras, o.camera + 1);
    for (size_t c = 1; c <= cameras; c++)
        names.insert(names.end(), {"u" + std::to_string(c), "v" + std::to_string(c)});
    std::vector<CsvTable::Row> rows;
    std::map<std::pair<std::string, std::string>, size_t> places;
    std::vector<std::vector<char>> seenBy;
    for (const Observation& o : all)
    {
        const auto [place, isNew] = places.insert({{o.frame, o.point}, rows.size()});
        if (isNew)
        {
            rows.push_back({o.line, std::vector<std::string>(names.size())});
            rows.back().cells[0] = o.frame;
            rows.back().cells[1] = o.point;
            seenBy.push_back(std::vector<char>(cameras, 0));
        }
        if (seenBy[place->second][o.camera]++)
            throw Failure("'" + path + "' line " + std::to_string(o.line) + ": camera " + std::to_string(first + o.camera)
                          + " saw the point " + o.point + " of frame " + o.frame + " in an earlier line already");
        rows[place->second].cells[2 + 2*o.camera] = o.u;
        rows[place->second].cells[3 + 2*o.camera] = o.v;
    }
    return CsvTable(path, names, rows);
}

//! A coordinate that counts from elsewhere, where it was seen.
std::string moved(double pixel) { return pixel == pixel ? cv::format("%.17g", pixel) : ""; }

//! How OpenLPT names the columns of an observation: the frame, the camera from 0, the point, u, v.
const std::vector<std::string> OPENLPT = {"frame", "cam_id", "pt_idx", "x", "y"};

CsvTable readOpenLpt(const std::string& path)
{
    const CsvTable table(path, OPENLPT, "a table of observations");
    std::vector<Observation> all;
    for (const CsvTable::Row& row : table.rows())
    {
        const double camera = table.number(row, OPENLPT[1]);
        if (!(camera >= 0. && camera < (double)MOST_CAMERAS) || camera != std::floor(camera))
            throw Failure(table.where(row) + ": " + OPENLPT[1] + " must be the number of a camera, from 0");
        all.push_back({table.text(row, OPENLPT[0]), table.text(row, OPENLPT[2]), (size_t)camera, table.textOrNone(row, OPENLPT[3]),
                       table.textOrNone(row, OPENLPT[4]), row.line});
    }
    return tableOf(path, all, 0);
}

//! pt3_cam1_x: 3, and 0, the first; false: it is another name.
bool isTrack(const std::string& name, size_t& point, size_t& camera)
{
    char digits[2][10];
    int end = 0;
    if (std::sscanf(name.c_str(), "pt%9[0-9]_cam%9[0-9]_x%n", digits[0], digits[1], &end) != 2 || end != (int)name.size())
        return false;
    point = std::stoul(digits[0]);
    camera = std::stoul(digits[1]) - 1;
    return camera < MOST_CAMERAS;
}

//! The image's height where y counts from the bottom.
double heightOf(const std::string& path, const PixelOrigin& origin, size_t camera)
{
    if (origin.yFrom.empty())
        throw Failure("'" + path + "' looks like a table of DLTdv or Argus, whose y counts from the top of the image in some versions, and "
                      "from its bottom in others: say --y-from=top or --y-from=bottom");
    if (origin.yFrom == "bottom" && (camera >= origin.images.size() || origin.images[camera].empty()))
        throw Failure("'" + path + "': y counts from the bottom, and the size of camera " + std::to_string(camera + 1)
                      + "'s image is not known: add it to the calibration (image_width, image_height)");
    return origin.yFrom == "bottom" ? origin.images[camera].height : 0.;
}

//! NaN where the cell is empty or nan.
double numberIn(const std::string& where, const std::string& cell)
{
    double number = NAN;
    if (!cell.empty() && cell != "nan" && cell != "NaN" && !(parseNumber(cell, number) && std::isfinite(number)))
        throw Failure(where + ": '" + cell + "' is no number");
    return number;
}

struct Track
{
    std::string point;
    size_t camera;
    int x, y;                       //!< columns
    double height;
};

std::vector<Track> tracksOf(const std::string& path, const CsvTable& table, const PixelOrigin& origin)
{
    std::vector<Track> tracks;
    for (int x = 0; x < (int)table.names().size(); x++)
    {
        const std::string& name = table.names()[x];
        size_t point, camera;
        if (!isTrack(name, point, camera))
            continue;
        const std::string y = name.substr(0, name.size() - 1) + "y";
        if (table.find(y) < 0)
            throw Failure("'" + path + "': there is no column '" + y + "'");
        tracks.push_back({std::to_string(point), camera, x, table.find(y), heightOf(path, origin, camera)});
    }
    return tracks;
}

CsvTable readTracks(const std::string& path, const PixelOrigin& origin)
{
    const CsvTable table(path, {}, "a table of tracks");
    const std::vector<Track> tracks = tracksOf(path, table, origin);
    std::vector<Observation> all;
    for (size_t r = 0; r < table.rows().size(); r++)
        for (const Track& track : tracks)
        {
            const CsvTable::Row& row = table.rows()[r];
            const double x = numberIn(table.where(row), row.cells[track.x]), y = numberIn(table.where(row), row.cells[track.y]);
            if (std::isnan(x) != std::isnan(y))
                throw Failure(table.where(row) + ": " + table.names()[track.x] + " and " + table.names()[track.y]
                              + " must both be numbers, or both empty");
            all.push_back({std::to_string(r + 1), track.point, track.camera, moved(x - 1),
                           moved(track.height > 0 ? track.height - y : y - 1), row.line});
        }
    return tableOf(path, all, 1);
}

//! Three lines of heading: scorer, bodyparts, coords; then one row a frame: its number, and x, y, likelihood of each part.
void addDeepLabCut(const std::string& path, size_t camera, std::vector<Observation>& all)
{
    const double LIKELY = 0.6;          // AniPose's own default
    const CsvTable table(path, {"scorer"}, "a table of DeepLabCut");
    const auto& rows = table.rows();
    if (rows.size() < 2 || rows[0].cells[0] != "bodyparts" || rows[1].cells[0] != "coords")
        throw Failure("'" + path + "' looks like a table of DeepLabCut, but its second and third line must begin with 'bodyparts' and "
                      "'coords' (of several animals it is not read)");
    for (size_t r = 2; r < rows.size(); r++)
        for (size_t i = 1; i + 2 < rows[r].cells.size(); i += 3)
        {
            const auto cell = [&](size_t k) { return numberIn(table.where(rows[r]), rows[r].cells[i + k]); };
            const bool isSeen = !(cell(2) < LIKELY);
            all.push_back({rows[r].cells[0], rows[0].cells[i], camera, isSeen ? moved(cell(0)) : "", isSeen ? moved(cell(1)) : "",
                           rows[r].line});
        }
}

//! The number of targets, then a line each: number, x, y, three sizes, sum of grey levels, number of correspondence (-1: none).
void addTargets(const std::string& path, const std::vector<std::string>& lines, size_t camera, std::vector<Observation>& all)
{
    const double count = leadingNumbers(lines[0])[0];
    if ((double)lines.size() != count + 1)
        throw Failure("'" + path + "' looks like OpenPTV's targets, but has " + std::to_string(lines.size() - 1)
                      + cv::format(" of %g: is it cut short?", count));
    for (size_t r = 1; r < lines.size(); r++)
    {
        const std::vector<double> cells = leadingNumbers(lines[r]);
        if (cells.size() < 8)
            throw Failure("'" + path + "' line " + std::to_string(r + 1) + ": 8 numbers of a target are expected");
        if (cells[7] >= 0)
            all.push_back({"0", cv::format("%.0f", cells[7]), camera, moved(cells[1] - CORNER), moved(cells[2] - CORNER), (int)r + 1});
    }
}

//! The files of a number after one that is not there would be left out without a word.
void requireNoGap(const std::string& pattern, size_t next)
{
    const size_t FARTHEST = 100;
    const auto numbered = [&](size_t number) { return std::string(pattern).replace(pattern.find("%d"), 2, std::to_string(number)); };
    for (size_t number = next; number < next + FARTHEST; number++)
        if (std::filesystem::is_regular_file(numbered(number)))
            throw Failure("there is '" + numbered(number) + "', but no '" + numbered(next) + "': number the cameras without a gap");
}

CsvTable readFilesOfCameras(const std::string& pattern)
{
    const std::vector<std::string> files = numberedFiles(pattern);
    if (files.empty())
        throw Failure("there is no file '" + pattern + "' with 0 or 1 in place of %d");
    const size_t first = std::string(pattern).replace(pattern.find("%d"), 2, "0") == files[0] ? 0 : 1;
    requireNoGap(pattern, first + files.size());
    std::vector<Observation> all;
    for (size_t c = 0; c < files.size(); c++)
    {
        const std::vector<std::string> heading = headingOf(files[c]), lines = contentsOf(files[c]).lines();
        if (!heading.empty() && heading[0] == "scorer")
            addDeepLabCut(files[c], c, all);
        else if (!lines.empty() && !leadingNumbers(lines[0]).empty())
            addTargets(files[c], lines, c, all);
        else
            throw Failure("'" + files[c] + "' is neither a table of DeepLabCut (scorer, bodyparts, coords) nor OpenPTV's targets, which "
                          "are the files of one camera each that are read");
    }
    return tableOf(pattern, all, first);
}

} // namespace

Option addYFrom(OptionParser& parser, std::string& yFrom)
{
    return parser.add("--y-from", yFrom, "top or bottom: where y counts from in tables of DLTdv or Argus")
        .check(isMember({"top", "bottom"}));
}

CsvTable readPointTable(const std::string& path, const std::vector<std::string>& required, const std::string& what,
                        const PixelOrigin& origin)
{
    const bool isOfCameras = path.find("%d") != std::string::npos;
    const std::vector<std::string> heading = isOfCameras ? std::vector<std::string>() : headingOf(path);
    size_t point, camera;
    if (std::any_of(heading.begin(), heading.end(), [&](const std::string& name) { return isTrack(name, point, camera); }))
        return readTracks(path, origin);
    if (!origin.yFrom.empty())
        throw Failure("--y-from=" + origin.yFrom + " is for tables of DLTdv or Argus (pt1_cam1_X,pt1_cam1_Y,...), and '" + path
                      + "' is none: leave it out");
    if (isOfCameras)
        return readFilesOfCameras(path);
    const auto has = [&](const std::string& name) { return std::count(heading.begin(), heading.end(), name) > 0; };
    if (std::all_of(OPENLPT.begin(), OPENLPT.end(), has))
        return readOpenLpt(path);
    if (has("scorer"))
        throw Failure("'" + path + "' looks like DeepLabCut's table of one camera: give those of all, with %d in place of the camera's "
                      "number");
    return CsvTable(path, required, what);
}

} // namespace tools
