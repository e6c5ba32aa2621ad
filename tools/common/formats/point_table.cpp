// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/point_table.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

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

//! One row a point.
CsvTable tableOf(const std::string& path, const std::vector<Observation>& all)
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
            throw Failure("'" + path + "' line " + std::to_string(o.line) + ": camera " + std::to_string(o.camera) + " saw the point "
                          + o.point + " of frame " + o.frame + " in an earlier line already");
        rows[place->second].cells[2 + 2*o.camera] = o.u;
        rows[place->second].cells[3 + 2*o.camera] = o.v;
    }
    return CsvTable(path, names, rows);
}

//! A coordinate that counts from elsewhere, where it was seen.
std::string moved(double pixel) { return pixel == pixel ? cv::format("%.17g", pixel) : ""; }

//! How a program names the columns of an observation.
struct LongForm
{
    const char *frame, *camera, *point, *u, *v;
};
const LongForm OPENLPT = {"frame", "cam_id", "pt_idx", "x", "y"};

size_t cameraOf(const CsvTable& table, const CsvTable::Row& row, const LongForm& form)
{
    const double camera = table.number(row, form.camera);
    if (!(camera >= 0. && camera < (double)MOST_CAMERAS) || camera != std::floor(camera))
        throw Failure(table.where(row) + ": " + form.camera + " must be the number of a camera, from 0");
    return (size_t)camera;
}

CsvTable readLongForm(const std::string& path, const LongForm& form)
{
    const CsvTable table(path, {form.frame, form.camera, form.point, form.u, form.v}, "a table of observations");
    std::vector<Observation> all;
    for (const CsvTable::Row& row : table.rows())
        all.push_back({table.text(row, form.frame), table.text(row, form.point), cameraOf(table, row, form),
                       table.textOrNone(row, form.u), table.textOrNone(row, form.v), row.line});
    return tableOf(path, all);
}

//! pt3_cam1_X: 3 and 1; false: it is another name.
bool isTrack(const std::string& name, int& point, size_t& camera)
{
    size_t number = 0;
    char axis = 0;
    int end = 0;
    const bool is = std::sscanf(name.c_str(), "pt%d_cam%zu_%c%n", &point, &number, &axis, &end) == 3 && end == (int)name.size()
        && std::strchr("Xx", axis) && point >= 0 && number >= 1 && number <= MOST_CAMERAS;
    camera = number - 1;
    return is;
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

CsvTable readTracks(const std::string& path, const PixelOrigin& origin)
{
    const CsvTable table(path, {}, "a table of tracks");
    std::vector<Observation> all;
    for (size_t r = 0; r < table.rows().size(); r++)
        for (const std::string& name : table.names())
        {
            int point;
            size_t camera;
            if (!isTrack(name, point, camera))
                continue;
            const std::string y = name.substr(0, name.size() - 1) + (name.back() == 'X' ? "Y" : "y");
            const cv::Point2d pixel = table.pixelOrNone(table.rows()[r], name, y);
            const double height = heightOf(path, origin, camera);
            all.push_back({std::to_string(r + 1), std::to_string(point), camera, moved(pixel.x - 1),
                           moved(height > 0 ? height - pixel.y : pixel.y - 1), table.rows()[r].line});
        }
    return tableOf(path, all);
}

std::vector<std::string> linesOf(const std::string& path)
{
    std::ifstream in(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line); )
        lines.push_back(line.substr(0, line.find_last_not_of("\r\n ") + 1));
    return lines;
}

double numberIn(const std::string& where, const std::string& cell)
{
    double number = NAN;
    if (!cell.empty() && cell != "nan" && cell != "NaN" && !parseNumber(cell, number))
        throw Failure(where + ": '" + cell + "' is no number");
    return number;
}

bool isDeepLabCut(const std::vector<std::string>& lines) { return !lines.empty() && lines[0].compare(0, 7, "scorer,") == 0; }

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
bool isTargets(const std::vector<std::string>& lines)
{
    double count;
    return !lines.empty() && std::istringstream(lines[0]) >> count;
}

void addTargets(const std::string& path, const std::vector<std::string>& lines, size_t camera, std::vector<Observation>& all)
{
    const size_t CELLS = 8;
    double count = 0.;
    std::istringstream(lines[0]) >> count;
    if ((double)lines.size() != count + 1)
        throw Failure("'" + path + "' looks like OpenPTV's targets, but has " + std::to_string(lines.size() - 1)
                      + cv::format(" of %g: is it cut short?", count));
    for (size_t r = 1; r < lines.size(); r++)
    {
        std::istringstream in(lines[r]);
        double cells[CELLS];
        for (double& cell : cells)
            if (!(in >> cell))
                throw Failure("'" + path + "' line " + std::to_string(r + 1) + ": 8 numbers of a target are expected");
        if (cells[CELLS - 1] >= 0)
            all.push_back({"0", cv::format("%.0f", cells[CELLS - 1]), camera, moved(cells[1] - CORNER), moved(cells[2] - CORNER),
                           (int)r + 1});
    }
}

CsvTable readFilesOfCameras(const std::string& pattern)
{
    const std::vector<std::string> files = numberedFiles(pattern);
    if (files.empty())
        throw Failure("there is no file '" + pattern + "' with 0 or 1 in place of %d");
    std::vector<Observation> all;
    for (size_t c = 0; c < files.size(); c++)
    {
        const std::vector<std::string> lines = linesOf(files[c]);
        if (isDeepLabCut(lines))
            addDeepLabCut(files[c], c, all);
        else if (isTargets(lines))
            addTargets(files[c], lines, c, all);
        else
            throw Failure("'" + files[c] + "' is neither a table of DeepLabCut (scorer, bodyparts, coords) nor OpenPTV's targets, which "
                          "are the files of one camera each that are read");
    }
    return tableOf(pattern, all);
}

} // namespace

void PixelOrigin::addTo(OptionParser& parser)
{
    parser.add("--y-from", yFrom, "top or bottom: where y counts from in --points of DLTdv or Argus").check(isMember({"top", "bottom"}));
}

CsvTable readPointTable(const std::string& path, const std::vector<std::string>& required, const std::string& what,
                        const PixelOrigin& origin)
{
    if (path.find("%d") != std::string::npos)
        return readFilesOfCameras(path);
    const std::vector<std::string> heading = headingOf(path);
    const auto has = [&](const char* name) { return std::find(heading.begin(), heading.end(), name) != heading.end(); };
    if (has(OPENLPT.frame) && has(OPENLPT.camera) && has(OPENLPT.point) && has(OPENLPT.u) && has(OPENLPT.v))
        return readLongForm(path, OPENLPT);
    int point;
    size_t camera;
    if (std::any_of(heading.begin(), heading.end(), [&](const std::string& name) { return isTrack(name, point, camera); }))
        return readTracks(path, origin);
    if (has("scorer"))
        throw Failure("'" + path + "' looks like DeepLabCut's table of one camera: give those of all, with %d in place of the camera's "
                      "number");
    return CsvTable(path, required, what);
}

} // namespace tools
