// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_start.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <map>

using namespace cv::refract;

namespace tools {

namespace {

struct Columns
{
    int first, count;
};

//! The columns of a camera that a name stands for; a window of another shape may have none.
std::vector<int> columnsOfName(const ParameterColumns& at, const std::string& name)
{
    const std::multimap<std::string, Columns> all = {
        {"normal", {at.normal, 3}}, {"center", {at.center, 3}}, {"center", {at.axis, 3}}, {"intrinsics", {at.lens, at.lensCount}},
        {"thickness", {at.thickness, at.layers}}, {"index", {at.index, at.layers}}, {"distance", {at.distance, 1}},
        {"radius", {at.radius, 1}}, {"outer-index", {at.outerIndex, 1}}, {"wedge", {at.wedge, at.curvature - at.wedge}},
        {"curvature", {at.curvature, 1}}};
    std::vector<int> columns;
    const auto range = all.equal_range(name);
    for (auto it = range.first; it != range.second; ++it)
        for (int i = 0; i < it->second.count && at.has(it->second.first); i++)
            columns.push_back(it->second.first + i);
    return columns;
}

//! Where each parameter of one camera is in another that has them all.
std::vector<int> sameColumns(const RefractiveCamera& from, const RefractiveCamera& to, int first)
{
    std::vector<int> columns;
    const std::vector<cv::String> all = to.parameterNames();
    for (const cv::String& name : from.parameterNames())
        columns.push_back(first + int(std::find(all.begin(), all.end(), name) - all.begin()));
    return columns;
}

//! What only a bundle has; where windows are is free unless GLASS_FIX_NORMAL says otherwise.
const std::map<std::string, int> PLACES = {{"normal", 0}, {"center", 0}, {"extrinsics", GLASS_FREE_EXTRINSICS}};

const char NONE[] = "none";

bool contains(const std::vector<std::string>& list, const std::string& name)
{
    return std::find(list.begin(), list.end(), name) != list.end();
}

int flagOf(const std::string& name)
{
    const auto place = PLACES.find(name);
    return place != PLACES.end() ? place->second : freeFlags().at(name);
}

//! What says where a window is, as --free names it: of a tube the axis, too.
std::string placeOf(const GlassWindow& window) { return isRound(window) ? "center" : "normal"; }

//! Of all windows of a rig, each once.
std::vector<std::string> placesOf(const RigModel& rig)
{
    std::vector<std::string> places;
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
        if (!contains(places, placeOf(camera->window())))
            places.push_back(placeOf(camera->window()));
    return places;
}

//! As the options say it, in the light of the file's images.
GivenWindow givenWindow(const BundleOptions& options, const Calibration& file)
{
    int flags = 0;
    for (const std::string& name : options.free)
        flags |= name == NONE ? 0 : flagOf(name);
    const GivenWindow given = options.window.of(flags, file.channel);
    const bool needsDistance = !isRound(given.window) && hasDifferentMedia(given.window);
    if (needsDistance && !options.window.isDistanceSaid() && !options.places.areOfMarkers())
        throw Failure("--distance is needed, from the camera's centre of projection to the window, as on its other side is another medium: "
                      "a ruler will do (--distance-std says how well it is known)");
    return given;
}

//! The windows of the options, where the start has none; refuses windows from both, or from nowhere.
void takeWindows(const BundleOptions& options, const std::string& path, Calibration& file)
{
    const bool isNone = std::none_of(file.cameras.begin(), file.cameras.end(), [](const CameraCalibration& c) { return c.windowGiven; });
    if (!options.window.isSaid())
    {
        if (isNone && !options.noWindow)
            throw Failure("'" + path + "' has no glass_window: say what the cameras look through, --thickness=5 --index=1.49 and "
                          "--window=dome with --radius where it is one, or --no-window if there is none");
        requireWindows(file, path, options.noWindow);
        return;
    }
    if (options.noWindow)
        throw Failure("--no-window says that there is none: leave --window, --thickness, --index and their kin out");
    // A glass_window without layers, in one medium, is none, either: programs that write all keys write it.
    const auto hasWindow = [](const CameraCalibration& c) { return refracts(c.camera->window()); };
    if (std::any_of(file.cameras.begin(), file.cameras.end(), hasWindow))
        throw Failure("'" + path + "' has a glass_window, which says what the cameras look through: leave --window, --thickness, --index "
                      "and their kin out, or the glass_window");
    if (!file.covariance.empty())
        throw Failure("'" + path + "' has a covariance, of cameras without windows: leave it out of the file, or the windows of the "
                      "options");
    const GivenWindow given = givenWindow(options, file);
    for (CameraCalibration& camera : file.cameras)
        camera.camera = copyWithWindow(camera.camera, given.window);
}

//! A start from there; how well they are known is for the covariance. @return of each camera; empty: not said
std::vector<GivenPlace> takePlaces(const BundleOptions& options, const std::string& path, Calibration& file)
{
    const std::string option = options.places.option();
    const std::vector<GivenPlace> places = options.places.of((int)file.cameras.size(), file.windows);
    if (places.empty())
        return places;
    if (!file.covariance.empty())
        throw Failure(option + " is for a start of nominal values: '" + path + "' has a covariance, which says how well its windows are "
                      "known; leave it out, or free them (--free=normal)");
    for (const char* const name : {"normal", "distance"})
        if (contains(options.free, name) && (options.places.areOfMarkers() || name == std::string("normal")))
            throw Failure(std::string("--free=") + name + " says that the matches alone tell it, and " + option + " what is known of it: "
                          "leave one out");
    for (size_t c = 0; c < file.cameras.size(); c++)
    {
        GlassWindow window = file.cameras[c].camera->window();
        if (isRound(window))
            throw Failure(option + " is of flat windows, and '" + path + "' has a camera behind a " + nameOfShape(window));
        places[c].putInto(window);
        file.cameras[c].camera = copyWithWindow(file.cameras[c].camera, window);
    }
    return places;
}

//! What is free where nothing is said: of a rig of nominal values, what a calibration is for.
std::vector<std::string> freeOf(const Calibration& file, const RigModel& rig, const BundleOptions& options)
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
    std::vector<std::string> free = {"extrinsics"};
    if (!options.noWindow && !options.places.isSaid())
        for (const std::string& place : placesOf(rig))
            free.insert(free.end() - 1, place);
    return free;
}

//! What says where windows are goes with their shapes, and is free of all or of none where a start knows no better.
void requirePlaces(const Calibration& file, const std::string& path, const RigModel& rig, const std::vector<std::string>& free)
{
    const std::vector<std::string> places = placesOf(rig);
    const std::string shape = nameOfShape(rig.cameras[0]->window());
    if (contains(free, "normal") && !contains(places, "normal"))
        throw Failure("--free=normal is of a flat window, and '" + path + "' has cameras behind a " + shape + ": where that is, "
                      "--free=center says");
    if (contains(free, "center") && !contains(places, "center"))
        throw Failure("--free=center is of a dome or tube, and '" + path + "' has flat windows: where they are, --free=normal says");
    if (file.covariance.empty() && places.size() > 1 && contains(free, "normal") != contains(free, "center"))
        throw Failure("'" + path + "' has flat windows and others, and no covariance: give both, --free=normal,center, or none of both");
}

//! What windows have, and images can tell.
void requireFreeOfWindows(const std::string& path, const RigModel& rig, int flags)
{
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        const GlassWindow window = camera->window();
        requireFreeOfShape(window, flags);
        if (!hasDifferentMedia(window) && (flags & GLASS_FREE_OUTER_INDEX))
            throw Failure("--free=outer-index: '" + path + "' has a window with the same medium on both sides; that medium is what "
                          "indices are relative to. Leave it out");
        if (window.thickness.empty() && (flags & (GLASS_FREE_WEDGE | GLASS_FREE_CURVATURE)))
            throw Failure("--free=wedge and curvature are of layers, and '" + path + "' has a window without: leave them out");
    }
}

GivenValues givenValuesOf(const GlassWindow& window, const BundleOptions& options, const Calibration& file)
{
    GivenValues given;
    if (options.window.isSaid())
    {
        const GivenWindow said = givenWindow(options, file);
        given.layers = said.layers;
        given.outer = said.outer;
        return given;
    }
    for (double index : window.index)
        given.layers.push_back({index});
    given.outer = {window.outerIndex};
    return given;
}

//! How well the values of windows are given.
GivenStd stdOf(const GlassWindow& window, const RigModel& rig, const BundleOptions& options, const Calibration& file, double millimetre,
               int flags)
{
    GivenValues given = givenValuesOf(window, options, file);
    given.equalMedia = !hasDifferentMedia(window);
    given.distance = !given.equalMedia || options.places.areOfMarkers();
    given.shape = window.shape;
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
        given.others.push_back(camera->window().shape);
    given.millimetre = millimetre;
    given.flags = flags;
    GivenStd std = options.std.of(given);
    std.normal = options.places.normalStd();
    if (options.window.isSaid())
        options.window.requireBow(std, flags);
    return std;
}

std::string unitOf(const Calibration& file, const std::string& path, const BundleOptions& options)
{
    if (!options.unit.empty() && !file.unit.empty() && options.unit != file.unit)
        throw Failure("--unit=" + options.unit + ": the lengths of '" + path + "' are in " + file.unit);
    return !options.unit.empty() ? options.unit : !file.unit.empty() ? file.unit : "mm";
}

} // namespace

//! What flags free and the windows have not yet, which starts at 0; of what was known nothing is lost.
static void addFree(int flags, RigModel& rig, cv::Mat& covariance)
{
    RigModel larger = rig.clone();
    for (const cv::Ptr<RefractiveCamera>& camera : larger.cameras)
        camera->setWindow(withEstimated(camera->window(), GivenStd(), flags));
    std::vector<int> columns;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const std::vector<int> own = sameColumns(*rig.cameras[c], *larger.cameras[c], columnsOf(larger, c).lens);
        columns.insert(columns.end(), own.begin(), own.end());
    }
    const int count = columnCount(larger);
    for (int i = extrinsicsColumn(larger, 1); i < count; i++)
        columns.push_back(i);
    cv::Mat more = cv::Mat::zeros(count, count, CV_64F);
    for (int i = 0; i < covariance.rows; i++)
        for (int j = 0; j < covariance.cols; j++)
            more.at<double>(columns[i], columns[j]) = covariance.at<double>(i, j);
    rig = larger;
    covariance = more;
}

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

cv::Mat covarianceOfGiven(const std::function<GivenStd(const GlassWindow&)>& of, int flags, RigModel& rig)
{
    std::vector<GivenStd> stds;
    for (const cv::Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        const GlassWindow window = camera->window();
        stds.push_back(of(window));
        camera->setWindow(withEstimated(window, stds.back(), flags));
    }
    cv::Mat covariance = cv::Mat::zeros(columnCount(rig), columnCount(rig), CV_64F);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        if (rig.ownsWindow(c))
            putVariances(stds[c], columnsOf(rig, c), covariance);
    return covariance;
}

std::vector<std::string> freeNames()
{
    std::vector<std::string> names = {NONE};
    for (const std::map<std::string, int>& flags : {PLACES, freeFlags()})
        for (const auto& entry : flags)
            names.push_back(entry.first);
    return names;
}

BundleStart startOf(Calibration file, const std::string& path, const BundleOptions& options)
{
    takeWindows(options, path, file);
    const std::vector<GivenPlace> places = takePlaces(options, path, file);
    BundleStart start;
    start.placeOption = places.empty() ? "" : options.places.option();
    start.rig = modelOf(file).clone();
    start.rig.windows = file.windows;
    start.free = freeOf(file, start.rig, options);
    requirePlaces(file, path, start.rig, start.free);
    for (const std::string& name : start.free)
        start.flags |= flagOf(name);
    if (!contains(start.free, "normal") && !contains(start.free, "center"))
        start.flags |= GLASS_FIX_NORMAL;
    requireFreeOfWindows(path, start.rig, start.flags);
    const double millimetre = 1./millimetresIn(unitOf(file, path, options));
    if (file.covariance.empty())
    {
        const auto std = [&](const GlassWindow& window) { return stdOf(window, start.rig, options, file, millimetre, start.flags); };
        if (!options.noWindow)
            start.covariance = covarianceOfGiven(std, start.flags, start.rig);
        for (int c = 0; c < (int)places.size(); c++)
            if (start.rig.ownsWindow(c) && places[c].tellsDistance())
                places[c].addTo(start.rig.cameras[c]->window(), columnsOf(start.rig, c), start.covariance);
        return start;
    }
    if (options.std.isSaid())
        throw Failure("--thickness-std and its kin are for a start of nominal values: '" + path + "' has a covariance, which says how "
                      "well each value is known; leave them out, or free what it does not know (--free)");
    start.covariance = file.covariance.clone();
    addFree(start.flags, start.rig, start.covariance);
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
    return median(ratios);
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
