// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/value_mistakes.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/starting_model.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "diagnose/plain_fit.hpp"
#include <algorithm>
#include <numeric>

using namespace cv::refract;

namespace tools {

namespace {

const double USUAL_INDEX = 1.5;

//! One pane that shifts rays as the layers together do, at small angles.
GlassWindow onePane(const GlassWindow& window)
{
    GlassWindow pane = window;
    double thickness = 0., shift = 0.;
    for (size_t i = 0; i < window.thickness.size(); i++)
    {
        thickness += window.thickness[i];
        shift += window.thickness[i]*(1. - window.outerIndex/window.index[i]);
    }
    pane.thickness = {thickness};
    pane.index = {window.outerIndex/(1. - shift/thickness)};
    pane.materials.clear();
    if (!window.wedge.empty())
        pane.wedge.assign(1, std::accumulate(window.wedge.begin(), window.wedge.end(), cv::Vec2d()));
    return pane;
}

/** Where targets are some ten times as far away as the window's outer face: images that hardly show a window fit in any unit.
@param factor by which all targets were made larger for this fit */
bool isMoreUsual(const Fit& fit, double factor)
{
    const double USUAL = 10.;
    const GlassWindow window = fit.rig.cameras[0]->window();
    const double inside = isRound(window) ? window.radius : window.distance;
    const double depth = std::accumulate(window.thickness.begin(), window.thickness.end(), inside);
    std::vector<double> ranges;
    for (const cv::Vec3d& t : fit.tvecs)
        ranges.push_back(cv::norm(t));
    const double range = median(ranges)/(USUAL*depth);
    return std::abs(std::log(range)) < std::abs(std::log(range/factor));
}

//! Cameras that look the same way may look through one window: its number for each, from 1.
std::vector<int> windowsBySide(const RigModel& rig)
{
    std::vector<int> windows;
    std::vector<cv::Vec3d> sides;           // which way the first camera of each looks
    for (const RigidTransform& cam_from_cam1 : rig.extrinsics)
    {
        const cv::Vec3d axis = cam_from_cam1.R.t()*cv::Vec3d(0., 0., 1.);
        const auto side = std::find_if(sides.begin(), sides.end(), [&](const cv::Vec3d& other) { return other.dot(axis) > 0.; });
        windows.push_back(1 + (int)(side - sides.begin()));
        if (side == sides.end())
            sides.push_back(axis);
    }
    return windows;
}

} // namespace

std::string typedIndex(const GivenIndex& index, int digits)
{
    return index.isNamed() ? index.material + format(" (%.5f)", index.value) : format("%.*g", digits, index.value);
}

Explanation wrongScale(const CalibrationInput& input)
{
    RigOptions options = input.options;
    options.flags = (options.flags | GLASS_FREE_THICKNESS) & ~GLASS_FREE_INDEX;
    if (isRound(options.window))        // a dome has two lengths of its own, and no simple pane that does as much
        return {"", NO_FIT};
    const GlassWindow pane = onePane(input.options.window);
    if (!(pane.index[0] > 1.))
        return {"", NO_FIT};
    double best = NO_FIT, ratio = 1.;
    for (double start : {1., 0.1, 10., 0.01, 100., 1000.})
    {
        options.window = pane;
        options.window.thickness[0] *= start;
        Fit fit;
        const double px = medianErrorOfFit(input.data, options, &fit);
        if (px >= 0.5*best)
            continue;
        best = px;
        ratio = fit.rig.cameras[0]->window().thickness[0]/pane.thickness[0];
    }
    if (!(input.square > 0))
        return {format("lengths %.3g times as long%s", 1./ratio, isRatioOfUnits(ratio) ? " (a wrong unit?)" : ""), best};
    std::string sentence = format("--square=%.3g in place of %.4g%s", input.square/ratio, input.square,
                                  isRatioOfUnits(ratio) ? " (a wrong unit?)" : "");
    if (input.options.window.thickness.size() == 1)
        sentence += format(", or --thickness=%.3g in place of %.4g", pane.thickness[0]*ratio, pane.thickness[0]);
    else
        sentence += format(", or each --thickness times %.3g", ratio);
    return {sentence + ", as only their ratio shows", best};
}

Explanation wrongUnitOfPoints(const CalibrationInput& input)
{
    Explanation best{"", NO_FIT};
    for (double factor : {1000., 0.001})
    {
        CalibrationInput other = input;
        for (View& view : other.data.views)
            for (cv::Point3d& X : view.objectPoints)
                X *= factor;
        if (other.options.flags & GLASS_FREE_DISTANCE)
            other.options.window.distance *= factor;
        Fit fit;
        const double px = medianErrorOfFit(other.data, other.options, &fit);
        if (px < best.px && isMoreUsual(fit, factor))
            best = {format("x, y, z %g times as large: are they in another unit than --thickness?", factor), px};
    }
    return best;
}

Explanation wrongIndex(const CalibrationInput& input)
{
    RigOptions options = input.options;
    options.flags = (options.flags | GLASS_FREE_INDEX) & ~GLASS_FREE_THICKNESS;
    options.window.index[0] = USUAL_INDEX;
    Fit fit;
    const double px = medianErrorOfFit(input.data, options, &fit);
    const double index = px < NO_FIT ? fit.rig.cameras[0]->window().index[0] : 1.;
    const std::vector<GivenIndex>& layers = input.options.layers;
    return {format("--index=%.3g in place of ", index)
            + typedIndex(layers.empty() ? GivenIndex{input.options.window.index[0]} : layers[0], 4),
            index > 1.2 && index < 2.5 ? px : NO_FIT};
}

Explanation wrongMedium(const CalibrationInput& input)
{
    RigOptions options = input.options;
    GlassWindow& window = options.window;
    const bool air = window.outerIndex == 1.;
    window.outerIndex = air ? 1.333 : 1.;
    if (window.outerIndex == window.innerIndex)
        options.flags &= ~GLASS_FREE_DISTANCE;
    else if (!isRound(window))
    {
        options.flags |= GLASS_FREE_DISTANCE;
        if (window.distance == 0.)
            window.distance = startDistance(input.data, input.square);
    }
    if (window.thickness.empty() && window.outerIndex == window.innerIndex)
        return {"", NO_FIT};
    const GivenIndex& outer = input.options.outer;
    return {format("--outer-index=%g in place of %s (the medium in which the board was)", window.outerIndex,
                   typedIndex(outer.isNamed() ? outer : GivenIndex{input.options.window.outerIndex}, 6).c_str()),
            medianErrorOfFit(input.data, options)};
}

Explanation wrongMediumOfEach(const CalibrationInput& input, double clean)
{
    Explanation worst{"", NO_FIT};
    for (int c = 0; c < input.data.cameraCount; c++)
    {
        const CalibrationInput one = oneCamera(input, c);
        const Explanation other = wrongMedium(one);
        const double given = medianErrorOfFit(one.data, one.options);
        if (other.px == NO_FIT && given == NO_FIT)      // its images determine no lens by themselves
            continue;
        if (!(other.px < clean) || !(EXPLAINS_AS_WELL*other.px < given))
            return {"", NO_FIT};
        if (worst.px == NO_FIT || worst.px < other.px)
            worst = other;
    }
    return worst;
}

Explanation wrongShape(const CalibrationInput& input)
{
    const GlassWindow& given = input.options.window;
    Explanation best{"", NO_FIT};
    const auto attempt = [&](const GlassWindow& window, int flags, const std::string& sentence) {
        RigOptions options = input.options;
        options.window = window;
        options.flags = (options.flags & ~(GLASS_FREE_DISTANCE | GLASS_FREE_RADIUS | GLASS_FREE_CURVATURE | GLASS_FREE_WEDGE)) | flags;
        const double px = medianErrorOfFit(input.data, options);
        if (px < best.px)
            best = {sentence, px};
    };
    GlassWindow other;
    other.thickness = given.thickness;
    other.index = given.index;
    other.innerIndex = given.innerIndex;
    other.outerIndex = given.outerIndex;
    if (isRound(given))
    {
        const bool tellsDistance = given.outerIndex != given.innerIndex;
        other.distance = tellsDistance ? startDistance(input.data, input.square) : 0.;
        attempt(other, tellsDistance ? GLASS_FREE_DISTANCE : 0, "a flat pane: leave --window out");
    }
    if (given.shape != WINDOW_DOME)
    {
        other.shape = WINDOW_DOME;
        other.distance = 0.;
        other.radius = 2.*startDistance(input.data, input.square);          // hardly larger than a board
        attempt(other, GLASS_FREE_RADIUS, "--window=dome --radius=... (of the drawing)");
    }
    return best;
}

Explanation wrongFocalLength(const CalibrationInput& input)
{
    const double FAR = 1.5;             // times; what is nearer, a fit that starts from it tells
    const int COEFFICIENTS = 5;
    RigOptions options = input.options;
    std::string sentence;
    try
    {
        for (int c = 0; c < input.data.cameraCount; c++)
        {
            if (!options.known[c])
                continue;
            const double given = options.known[c]->cameraMatrix().at<double>(0, 0);
            const auto pinhole = calibratePinholeThroughGlass(input.data, c, allViews(input.data), COEFFICIENTS).camera;
            const double seen = pinhole->cameraMatrix().at<double>(0, 0);
            if (std::max(seen/given, given/seen) < FAR)
                continue;
            options.known[c] = pinhole;
            options.knownCovariance[c] = cv::Mat();
            sentence += (sentence.empty() ? "" : ", ") + format("--camera%s: a focal length of about %.0f px in place of %g",
                                                                c ? std::to_string(c + 1).c_str() : "", seen, given);
        }
    }
    catch (const std::exception&)       // no images for a pinhole camera
    {
        return {"", NO_FIT};
    }
    if (sentence.empty())
        return {"", NO_FIT};
    return {sentence + " (mistyped, not in pixels, or of another camera?)", medianErrorOfFit(input.data, options)};
}

Explanation separateWindows(const CalibrationInput& input)
{
    RigOptions options = input.options;
    options.windows.clear();
    return {"a window of its own for each camera: leave --shared-window (--window-of-camera) out", medianErrorOfFit(input.data, options)};
}

Explanation sharedWindows(const CalibrationInput& input)
{
    RigOptions options = input.options;
    try
    {
        std::vector<LensSource> sources;
        options.windows = windowsBySide(startModel(input.data, options, sources));
    }
    catch (const std::exception&)
    {
        return {"", NO_FIT};
    }
    std::string list;
    for (int window : options.windows)
        list += (list.empty() ? "" : ",") + std::to_string(window);
    return {"--window-of-camera=" + list, medianErrorOfFit(input.data, options)};
}

} // namespace tools
