// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/measured_views.hpp"
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include "target/detected_images.hpp"
#include <algorithm>
#include <map>
#include <set>

namespace tools {

namespace {

void warnNotFound(const DetectedImages& set, const std::string& which, const Command& command)
{
    if (!set.withoutTarget.empty())
        command.warn("skipped" + which + ", as the target was not found: " + listed(set.withoutTarget));
}

//! Views of a single camera cannot be triangulated.
void warnUnpaired(const std::vector<View>& views, size_t cameras, const Command& command)
{
    for (size_t c = 0; c < cameras; c++)
    {
        std::vector<std::string> alone;
        for (const View& view : views)
            if (view.countGlass() == 1 && view.hasGlass((int)c))
                alone.push_back(view.stem);
        if (!alone.empty())
            command.warn(format("skipped of camera %zu, as ", c + 1)
                         + (cameras == 2 ? format("camera %zu has no", 2 - c) : std::string("no other camera has an"))
                         + " image of that name with the target: " + listed(alone));
    }
}

//! As a target of dots calls them; else they are counted.
MeasuredView withIds(const View& view, const Target* target)
{
    MeasuredView measured{view, target ? target->ids() : std::vector<std::string>()};
    for (size_t i = measured.ids.size(); i < view.objectPoints.size(); i++)
        measured.ids.push_back(std::to_string(i));
    return measured;
}

std::vector<MeasuredView> readImages(const MeasuredFiles& files, bool triangulates, const Calibration& calibration, const Target* target,
                                     const Command& command)
{
    const RigImages sets = readGlassImages(files, triangulates, calibration, target, command.quiet());
    for (size_t c = 0; c < files.images.size(); c++)
        warnNotFound(sets.glass[c], files.images.size() == 1 ? "" : format(" of camera %zu", c + 1), command);
    const std::vector<View> views = groupIntoViews(target, sets, false, 1).views;
    std::vector<MeasuredView> measured;
    for (const View& view : views)
        if (view.countGlass() > 1 || !triangulates)
            measured.push_back(withIds(view, target));
    if (measured.empty() && files.images.size() == 2)
        throw Failure("no image of '" + files.images[0] + "' has the name of one of '" + files.images[1]
                      + "': images of one moment need equal names");
    if (measured.empty())
        throw Failure("no two cameras have images of one name with the target: images of one moment need equal names");
    if (triangulates)
        warnUnpaired(views, files.images.size(), command);
    return measured;
}

//! Whether each id stands once, be it in several images.
bool isPointPerId(const CsvTable& table)
{
    std::set<std::string> ids;
    for (const CsvTable::Row& row : table.rows())
        ids.insert(table.text(row, "id"));
    return ids.size() == table.rows().size();
}

//! Points that are no target.
std::vector<MeasuredView> readPoints(const MeasuredFiles& files, const Calibration& calibration)
{
    const CsvTable table = readPointTable(files.points, {"id", "u1", "v1"}, "a file of image points",
                                          {files.origin.yFrom, calibration.imageSizes()});
    MeasuredView view;
    view.stem = stemOf(files.points);
    const int cameras = (int)calibration.cameras.size();
    if (table.find(format("u%d", cameras + 1)) >= 0)
        throw Failure(format("'%s' has pixels of camera %d, the calibration '%s' has %d camera%s", files.points.c_str(),
                             cameras + 1, files.calibration.c_str(), cameras, cameras == 1 ? "" : "s"));
    std::map<std::string, int> lineOf;
    const bool isOfMoments = table.find("image") >= 0 && !isPointPerId(table);
    for (const CsvTable::Row& row : table.rows())
    {
        view.ids.push_back((isOfMoments ? table.text(row, "image") + "/" : "") + table.text(row, "id"));
        const auto first = lineOf.emplace(view.ids.back(), row.line);
        if (!first.second)
            throw Failure(table.where(row) + format(": the id '%s' stands in line %d already: give each point an id of its own, in one "
                                                    "row with its pixels in all cameras", view.ids.back().c_str(), first.first->second));
        view.objectPoints.emplace_back();
        for (int c = 0; c < cameras; c++)
        {
            const std::string u = format("u%d", c + 1), v = format("v%d", c + 1);
            if (table.find(u) < 0 || table.find(v) < 0)
                continue;
            view.glass[c].push_back(table.pixelOrNone(row, u, v));
        }
    }
    return {view};
}

} // namespace

RigImages readGlassImages(const MeasuredFiles& files, bool triangulates, const Calibration& calibration, const Target* target, bool quiet)
{
    RigSources sources;
    sources.channel = calibration.channel;
    sources.yFrom = files.origin.yFrom;
    sources.viewPattern = files.viewPattern;
    std::copy(files.images.begin(), files.images.end(), sources.glass.begin());
    PerCamera<cv::Size> sizes;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        sizes[c] = calibration.cameras[c].camera->imageSize();
    RigImages sets = readRigImages(sources, target, sizes, quiet);
    if (triangulates)
        sets.nameSingles();
    return sets;
}

std::vector<MeasuredView> readMeasuredViews(const MeasuredFiles& files, bool triangulates, const Calibration& calibration,
                                            const Target* target, const Command& command)
{
    return files.points.empty() ? readImages(files, triangulates, calibration, target, command) : readPoints(files, calibration);
}

} // namespace tools
