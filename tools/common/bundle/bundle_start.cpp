// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_start.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"

#include <algorithm>
#include <cmath>
#include <map>

using namespace cv::refract;

namespace tools {

namespace {

const std::map<std::string, int> FREE = {
    {"normal", 0}, {"extrinsics", GLASS_FREE_EXTRINSICS}, {"intrinsics", GLASS_FREE_INTRINSICS},
    {"thickness", GLASS_FREE_THICKNESS}, {"index", GLASS_FREE_INDEX}, {"distance", GLASS_FREE_DISTANCE},
    {"outer-index", GLASS_FREE_OUTER_INDEX}, {"wedge", GLASS_FREE_WEDGE}};

const char NONE[] = "none";

bool contains(const std::vector<std::string>& list, const std::string& name)
{
    return std::find(list.begin(), list.end(), name) != list.end();
}

//! What is free where nothing is said: of a rig of nominal values, what a calibration is for.
std::vector<std::string> freeOf(const Calibration& file, const BundleOptions& options)
{
    if (contains(options.free, NONE) && options.free.size() > 1)
        throw Failure("--free=none says that nothing is free: leave the other names out");
    if (contains(options.free, NONE))
        return {};
    if (options.noWindow && !options.free.empty())
        for (const std::string& name : options.free)
            if (name != "extrinsics" && name != "intrinsics")
                throw Failure("--free=" + name + " is of windows, and --no-window says that there is none");
    if (!options.free.empty() || !file.covariance.empty())
        return options.free;
    if (options.noWindow)
        return {"extrinsics"};
    return {"normal", "extrinsics"};
}

//! The columns of a camera that a name stands for.
std::vector<int> columnsOfName(const ParameterColumns& at, const std::string& name)
{
    const std::map<std::string, std::pair<int, int>> ranges = {
        {"normal", {at.normal, at.normal + 3}}, {"intrinsics", {at.lens, at.lens + at.lensCount}},
        {"thickness", {at.thickness, at.thickness + at.layers}}, {"index", {at.index, at.index + at.layers}},
        {"distance", {at.distance, at.distance + 1}}, {"outer-index", {at.outerIndex, at.outerIndex + 1}},
        {"wedge", {at.wedge, at.curvature}}};
    std::vector<int> columns;
    const auto range = ranges.find(name);
    for (int i = range == ranges.end() ? 0 : range->second.first; range != ranges.end() && i < range->second.second; i++)
        columns.push_back(i);
    return columns;
}

//! What is free again: the earlier calibration has no say.
void forget(const std::vector<std::string>& free, const RigModel& rig, cv::Mat& covariance)
{
    std::vector<int> columns;
    for (const std::string& name : free)
    {
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<int> own = columnsOfName(columnsOf(rig, c), name);
            columns.insert(columns.end(), own.begin(), own.end());
        }
        for (int i = extrinsicsColumn(rig, 1); name == "extrinsics" && i < covariance.rows; i++)
            columns.push_back(i);
    }
    for (int i : columns)
    {
        covariance.row(i) = 0.;
        covariance.col(i) = 0.;
    }
}

//! A window without wedges gets some, which start at 0; of what was known nothing is lost.
void addWedges(RigModel& rig, int camera, cv::Mat& covariance)
{
    GlassWindow window = rig.cameras[camera]->window();
    if (!window.wedge.empty() || window.thickness.empty())
        return;
    const int at = columnsOf(rig, camera).end, more = 2*(int)window.thickness.size();
    window.wedge.assign(window.thickness.size(), cv::Vec2d());
    rig.cameras[camera]->setWindow(window);
    if (covariance.empty())
        return;
    std::vector<int> kept;
    for (int i = 0; i < covariance.rows; i++)
        kept.push_back(i < at ? i : i + more);
    cv::Mat larger = cv::Mat::zeros(covariance.rows + more, covariance.cols + more, CV_64F);
    for (size_t i = 0; i < kept.size(); i++)
        for (size_t j = 0; j < kept.size(); j++)
            larger.at<double>(kept[i], kept[j]) = covariance.at<double>((int)i, (int)j);
    covariance = larger;
}

GivenStd stdOf(const BundleOptions& options, const GlassWindow& window, double millimetre, int flags)
{
    GivenValues given;
    for (size_t i = 0; i < window.index.size(); i++)
        given.layers.push_back({window.index[i]});
    given.outer = {window.outerIndex};
    given.equalMedia = window.innerIndex == window.outerIndex;
    given.distance = !given.equalMedia;
    given.millimetre = millimetre;
    given.flags = flags;
    return options.std.of(given);
}

//! Of nominal values: as well as a data sheet knows them, as in refract_calib.
cv::Mat covarianceOfGiven(const BundleOptions& options, double millimetre, int flags, RigModel& rig)
{
    std::vector<std::pair<int, GivenStd>> owners;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const GlassWindow window = rig.cameras[c]->window();
        const GivenStd std = stdOf(options, window, millimetre, flags);
        cv::Mat none;
        if (std.wedge > 0.)
            addWedges(rig, c, none);
        if (rig.ownsWindow(c))
            owners.push_back({c, std});
    }
    cv::Mat covariance = cv::Mat::zeros(columnCount(rig), columnCount(rig), CV_64F);
    for (const auto& owner : owners)
    {
        const ParameterColumns at = columnsOf(rig, owner.first);
        const auto set = [&](int column, double std) { covariance.at<double>(column, column) = std*std; };
        for (int i = 0; i < at.layers; i++)
        {
            set(at.thickness + i, owner.second.thickness);
            set(at.index + i, owner.second.indexOf(i));
        }
        set(at.distance, owner.second.distance);
        set(at.outerIndex, owner.second.outerIndex);
        for (int i = at.wedge; i < at.curvature; i++)
            set(i, owner.second.wedge);
    }
    return covariance;
}

std::string unitOf(const Calibration& file, const std::string& path, const BundleOptions& options)
{
    if (!options.unit.empty() && !file.unit.empty() && options.unit != file.unit)
        throw Failure("--unit=" + options.unit + ": the lengths of '" + path + "' are in " + file.unit);
    return !options.unit.empty() ? options.unit : !file.unit.empty() ? file.unit : "mm";
}

} // namespace

cv::Mat_<double> valuesOf(const RigModel& rig)
{
    cv::Mat_<double> values;
    const auto add = [&values](const std::vector<double>& list) {
        if (!list.empty())
            values.push_back(cv::Mat(list, true));
    };
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        const GlassWindow window = camera->window();
        values.push_back(camera->lensParameters());
        add({window.normal[0], window.normal[1], window.normal[2], window.distance});
        add(window.thickness);
        add(window.index);
        add({window.innerIndex, window.outerIndex});
        for (const cv::Vec2d& wedge : window.wedge)
            add({wedge[0], wedge[1]});
    }
    for (size_t c = 1; c < rig.cameras.size(); c++)
    {
        const cv::Vec3d rvec = rotationVector(rig.extrinsics[c].R), T = rig.extrinsics[c].T;
        add({rvec[0], rvec[1], rvec[2], T[0], T[1], T[2]});
    }
    return values;
}

std::vector<std::string> freeNames()
{
    std::vector<std::string> names = {NONE};
    for (const auto& entry : FREE)
        names.push_back(entry.first);
    return names;
}

BundleStart startOf(const Calibration& file, const std::string& path, const BundleOptions& options)
{
    BundleStart start;
    start.rig = modelOf(file).clone();
    start.rig.windows = file.windows;
    start.free = freeOf(file, options);
    for (const std::string& name : start.free)
        start.flags |= FREE.at(name);
    if (!contains(start.free, "normal"))
        start.flags |= GLASS_FIX_NORMAL;
    for (const CameraCalibration& camera : file.cameras)
    {
        const GlassWindow window = camera.camera->window();
        if (window.shape != WINDOW_FLAT)
            throw Failure("'" + path + "' has a camera behind a " + nameOfShape(window) + "; refract_bundle takes flat windows. Calibrate "
                          "it with refract_calib, or call refractiveBundleAdjust (opencv2/refract.hpp)");
        if (window.innerIndex == window.outerIndex && (start.flags & (GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX)))
            throw Failure("--free=distance and --free=outer-index: '" + path + "' has a window with the same medium on both sides; "
                          "there the distance has no effect on the image, and that medium is what indices are relative to. Leave "
                          "them out");
        if (window.thickness.empty() && (start.flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_WEDGE)))
            throw Failure("--free=thickness, index and wedge are of layers, and '" + path + "' has a window without: leave them out");
    }
    const double millimetre = 1./millimetresIn(unitOf(file, path, options));
    if (file.covariance.empty())
    {
        if (!options.noWindow)
            start.covariance = covarianceOfGiven(options, millimetre, start.flags, start.rig);
        return start;
    }
    if (options.std.isSaid())
        throw Failure("--thickness-std and its kin are for a start of nominal values: '" + path + "' has a covariance, which says how "
                      "well each value is known; leave them out, or free what it does not know (--free)");
    start.covariance = file.covariance.clone();
    if (start.flags & GLASS_FREE_WEDGE)
        for (int c = 0; c < (int)start.rig.cameras.size(); c++)
            addWedges(start.rig, c, start.covariance);
    forget(start.free, start.rig, start.covariance);
    return start;
}

namespace {

//! Median of measured over given lengths, with the start; 0: none could be measured.
double ratioOfLengths(const BundleStart& start, const Matches& matches, const GivenLengths& lengths)
{
    const Measurement measured = measureRig(calibrationOf(start.rig), matches.pixels, 1.);
    std::vector<double> ratios;
    for (const GivenLength& l : lengths.list)
    {
        const double found = cv::norm(measured.points[l.a] - measured.points[l.b]);
        if (std::isfinite(found))
            ratios.push_back(found/l.length);
    }
    if (ratios.empty())
        return 0.;
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size()/2, ratios.end());
    return ratios[ratios.size()/2];
}

} // namespace

void requireScale(const BundleStart& start, const std::string& path, const Matches& matches, const GivenLengths& lengths)
{
    if (lengths.list.empty())
    {
        if (start.flags & GLASS_FREE_EXTRINSICS)
            throw Failure("nothing tells the scale: R and T are free, and there are no --lengths. Give --lengths=lengths.csv (one known "
                          "distance will do), or say with --free what is free, without extrinsics, and T of '" + path + "' tells it");
        return;
    }
    const double ratio = ratioOfLengths(start, matches, lengths);
    if (ratio > 0. && isRatioOfUnits(ratio))
        throw Failure(cv::format("with '%s' the lengths come out %.3g times as long as they are given: are they in another unit than T, "
                                 "thickness and distance there?", path.c_str(), ratio));
}

} // namespace tools
