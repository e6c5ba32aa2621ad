// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/summary.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

class GivenRows
{
public:
    //! @param factor from the deviation's unit to the value's
    void add(const std::string& name, const std::string& value, const Std& std, const std::string& unit, double factor = 1.)
    {
        const bool exact = !(std.value > 0.);
        rows_.push_back({name, {value, exact ? "exact" : format("%.2g", std.value*factor) + unit,
                                !std.source.empty() ? std.source : exact ? "" : "given"}});
    }
    void add(const std::string& name, const std::string& value, const std::string& std, const std::string& source)
    {
        rows_.push_back({name, {value, std, source}});
    }
    const std::vector<SummaryRow>& rows() const { return rows_; }

private:
    std::vector<SummaryRow> rows_;
};

//! A material's name says how well its index is known, also where its own deviation was not asked for.
Std ofIndex(const GivenIndex& index, Std std)
{
    if (index.isNamed() && std.source.empty())
        std.source = index.name;
    return std;
}

void addLayers(const RigCalibration& c, GivenRows& rows)
{
    const GlassWindow& window = c.options.window;
    const GivenStd& std = c.options.std;
    for (size_t i = 0; i < window.thickness.size(); i++)
    {
        const std::string layer = window.thickness.size() == 1 ? "" : format(" of layer %zu", i + 1);
        if (!(c.options.flags & GLASS_FREE_THICKNESS))
            rows.add("thickness" + layer, format("%g %s", window.thickness[i], c.unit.c_str()), std.thickness, " " + c.unit);
        if (!(c.options.flags & GLASS_FREE_INDEX))
            rows.add("index" + layer, format("%.6g", window.index[i]),
                     i < c.options.layers.size() ? ofIndex(c.options.layers[i], std.indexOf(i)) : std.indexOf(i), "");
    }
    if (!window.thickness.empty() && !isRound(window) && !(c.options.flags & GLASS_FREE_WEDGE))
        rows.add("wedge of each layer", "0'", std.wedge, "'", 1./ARC_MINUTE);
}

//! Of a flat window, with what the markers on it tell and what they share.
void addPlace(const RigCalibration& c, const GivenPlace& place, GivenRows& rows)
{
    const GivenStd& std = c.options.std;
    const std::string source = place.tellsDistance() ? c.options.placeOption : "";
    const cv::Vec3d n = place.normal;
    rows.add("normal", format("(%.4g, %.4g, %.4g)", n[0], n[1], n[2]), Std(std::hypot(std.normal, place.normalStd()), source), " degrees",
             180./CV_PI);
    if (place.tellsDistance() && hasDifferentMedia(c.options.window))
        rows.add("distance to the window", format("%.5g %s", place.distance, c.unit.c_str()),
                 Std(std::hypot(std.distance, place.distanceStd()), source), " " + c.unit);
}

//! Of the first surface.
void addShape(const RigCalibration& c, GivenRows& rows)
{
    const GlassWindow& window = c.options.window;
    const GivenStd& std = c.options.std;
    if (isRound(window) && !(c.options.flags & GLASS_FREE_RADIUS))
        rows.add("radius of the inner face", format("%g %s", window.radius, c.unit.c_str()), std.radius, " " + c.unit);
    for (const GivenPlace& place : c.options.places)
        addPlace(c, place, rows);
    if (std.center > 0.)
        rows.add("centre", format("(%g, %g, %g) %s", window.center[0], window.center[1], window.center[2], c.unit.c_str()), std.center,
                 " " + c.unit);
    if (window.shape == WINDOW_BENT && !(c.options.flags & GLASS_FREE_CURVATURE))
        rows.add("bow", "0 mm per m", std.bow, " mm per m");
    if (!isRound(window) && hasDifferentMedia(window) && !(c.options.flags & GLASS_FREE_DISTANCE) && !c.options.areMarkersGiven())
        rows.add("distance to the window", format("%g %s", window.distance, c.unit.c_str()), std.distance, " " + c.unit);
}

void addMedia(const RigCalibration& c, GivenRows& rows)
{
    const GlassWindow& window = c.options.window;
    if (window.innerIndex != 1.)
        rows.add("index of the camera's medium", format("%.6g", window.innerIndex), ofIndex(c.options.inner, Std()), "");
    if (!(c.options.flags & GLASS_FREE_OUTER_INDEX))
        rows.add("index of the scene's medium", format("%.6g", window.outerIndex), ofIndex(c.options.outer, c.options.std.outerIndex), "");
}

void addLenses(const RigCalibration& c, GivenRows& rows)
{
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.lensSources[k].kind == LensSource::FROM_FILE)
            rows.add(c.data.cameraCount == 1 ? std::string("lens") : format("lens of camera %d", k + 1), "its file's",
                     c.options.flags & GLASS_FREE_INTRINSICS ? "refined"
                     : c.options.knownCovariance[k].empty() ? "exact" : "its covariance", "--camera");
}

} // namespace

std::vector<SummaryRow> givenRows(const RigCalibration& c)
{
    GivenRows rows;
    const Std& scale = c.options.std.scale;
    if (c.square > 0.)
        rows.add("square of the board", format("%g %s", c.square, c.unit.c_str()), scale, " " + c.unit, c.square);
    else
        rows.add("scale of the targets", "1", scale, " %", 100.);
    addLayers(c, rows);
    addMedia(c, rows);
    addShape(c, rows);
    if (c.data.countPairs() > 0)
        rows.add("motion of all boards, direct to glass", "0 " + c.unit, c.options.std.placement, " " + c.unit);
    addLenses(c, rows);
    if (c.options.flags & GLASS_USE_POSES)
        rows.add("poses of the target", "its file's", "its sigmas", "--poses");
    return rows.rows();
}

} // namespace tools
