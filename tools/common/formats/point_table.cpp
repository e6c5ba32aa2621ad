// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/point_table.hpp"
#include "console/failure.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace tools {

namespace {

//! How a program names the columns of an observation.
struct LongForm
{
    const char *frame, *camera, *point, *u, *v;
};
const LongForm LONG_FORMS[] = {{"frame", "cam_id", "pt_idx", "x", "y"}};

bool has(const std::vector<std::string>& names, const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); }

//! From 0.
size_t cameraOf(const CsvTable& table, const CsvTable::Row& row, const LongForm& form)
{
    const double MOST = 1000.;
    const double camera = table.number(row, form.camera);
    if (!(camera >= 0. && camera < MOST) || camera != std::floor(camera))
        throw Failure(table.where(row) + ": " + form.camera + " must be the number of a camera, from 0");
    return (size_t)camera;
}

CsvTable oneRowAPoint(const std::string& path, const CsvTable& table, const LongForm& form)
{
    std::vector<std::string> names = {"image", "id"};
    size_t cameras = 0;
    for (const CsvTable::Row& row : table.rows())
        cameras = std::max(cameras, cameraOf(table, row, form) + 1);
    for (size_t c = 1; c <= cameras; c++)
        names.insert(names.end(), {"u" + std::to_string(c), "v" + std::to_string(c)});
    std::vector<CsvTable::Row> rows;
    std::map<std::pair<std::string, std::string>, size_t> places;
    for (const CsvTable::Row& row : table.rows())
    {
        const std::string &frame = table.text(row, form.frame), &point = table.text(row, form.point);
        const auto [place, isNew] = places.insert({{frame, point}, rows.size()});
        if (isNew)
        {
            rows.push_back({row.line, std::vector<std::string>(names.size())});
            rows.back().cells[0] = frame;
            rows.back().cells[1] = point;
        }
        const size_t at = 2 + 2*cameraOf(table, row, form);
        std::string* const cells = &rows[place->second].cells[at];
        if (!cells[0].empty() || !cells[1].empty())
            throw Failure(table.where(row) + ": camera " + table.text(row, form.camera) + " saw the point " + point + " of frame " + frame
                          + " in an earlier line already");
        cells[0] = table.textOrNone(row, form.u);
        cells[1] = table.textOrNone(row, form.v);
    }
    return CsvTable(path, names, rows);
}

} // namespace

CsvTable readPointTable(const std::string& path, const std::vector<std::string>& required, const std::string& what)
{
    const std::vector<std::string> heading = headingOf(path);
    for (const LongForm& form : LONG_FORMS)
    {
        const std::vector<std::string> all = {form.frame, form.camera, form.point, form.u, form.v};
        if (std::all_of(all.begin(), all.end(), [&](const std::string& name) { return has(heading, name.c_str()); }))
            return oneRowAPoint(path, CsvTable(path, all, what), form);
    }
    if (has(heading, "pt1_cam1_X"))
        throw Failure("'" + path + "' looks like a table of DLTdv or Argus, whose y counts from the bottom of the image in some versions, "
                      "and whose pixels count from 1 in some: write it as image,id,u1,v1,u2,v2,..., the middle of the upper left pixel "
                      "being (0, 0)");
    return CsvTable(path, required, what);
}

} // namespace tools
