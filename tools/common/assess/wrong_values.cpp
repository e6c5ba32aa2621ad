// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wrong_values.hpp"
#include "assess/fit_quality.hpp"
#include "calibrate/units.hpp"
#include "console/table.hpp"
#include <set>
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

} // namespace

std::string typedIndex(const GivenIndex& index, int digits)
{
    return index.isNamed() ? index.material + format(" (%.5f)", index.value) : format("%.*g", digits, index.value);
}

Explanation wrongScale(const Given& given)
{
    if (!hasPairs(given.data) || given.options.window.thickness.empty())
        return {"", NO_FIT};
    RigOptions options = given.options;
    options.flags = (options.flags | GLASS_FREE_THICKNESS) & ~GLASS_FREE_INDEX;
    const GlassWindow pane = onePane(given.options.window);
    if (!(pane.index[0] > 1.))
        return {"", NO_FIT};
    double best = NO_FIT, ratio = 1.;
    for (double start : {1., 0.1, 10., 0.01, 100., 1000.})
    {
        options.window = pane;
        options.window.thickness[0] *= start;
        RigModel rig;
        const double px = medianErrorOfFit(given.data, options, &rig);
        if (px >= 0.5*best)
            continue;
        best = px;
        ratio = rig.cameras[0]->window().thickness[0]/pane.thickness[0];
    }
    if (!(given.square > 0))
        return {format("lengths %.3g times as long%s", 1./ratio, isRatioOfUnits(ratio) ? " (a wrong unit?)" : ""), best};
    std::string sentence = format("--square=%.3g in place of %.4g%s", given.square/ratio, given.square,
                                  isRatioOfUnits(ratio) ? " (a wrong unit?)" : "");
    if (given.options.window.thickness.size() == 1)
        sentence += format(", or --thickness=%.3g in place of %.4g", pane.thickness[0]*ratio, pane.thickness[0]);
    else
        sentence += format(", or each --thickness times %.3g", ratio);
    return {sentence + ", as only their ratio shows", best};
}

Explanation wrongUnitOfPoints(const Given& given)
{
    Explanation best{"", NO_FIT};
    if (given.square > 0 || hasPairs(given.data))
        return best;
    for (double factor : {1000., 0.001})
    {
        Given other = given;
        for (Moment& m : other.data.moments)
            for (cv::Point3d& X : m.objectPoints)
                X *= factor;
        if (other.options.flags & GLASS_FREE_DISTANCE)
            other.options.window.distance *= factor;
        const double px = medianErrorOfFit(other.data, other.options);
        if (px < best.px)
            best = {format("x, y, z %g times as large: are they in another unit than --thickness?", factor), px};
    }
    return best;
}

Explanation wrongIndex(const Given& given)
{
    if (!hasPairs(given.data) || given.options.window.index.size() != 1)
        return {"", NO_FIT};
    RigOptions options = given.options;
    options.flags = (options.flags | GLASS_FREE_INDEX) & ~GLASS_FREE_THICKNESS;
    options.window.index[0] = USUAL_INDEX;
    RigModel rig;
    const double px = medianErrorOfFit(given.data, options, &rig);
    const double index = px < NO_FIT ? rig.cameras[0]->window().index[0] : 1.;
    const std::vector<GivenIndex>& layers = given.options.layers;
    return {format("--index=%.3g in place of ", index)
            + typedIndex(layers.empty() ? GivenIndex{given.options.window.index[0]} : layers[0], 4),
            index > 1.2 && index < 2.5 ? px : NO_FIT};
}

Explanation otherMedium(const Given& given)
{
    RigOptions options = given.options;
    GlassWindow& window = options.window;
    const bool air = window.outerIndex == 1.;
    window.outerIndex = air ? 1.333 : 1.;
    if (window.outerIndex == window.innerIndex)
        options.flags &= ~GLASS_FREE_DISTANCE;
    else
    {
        options.flags |= GLASS_FREE_DISTANCE;
        if (window.distance == 0.)
            window.distance = startDistance(given.data, given.square);
    }
    if (window.thickness.empty() && window.outerIndex == window.innerIndex)
        return {"", NO_FIT};
    const GivenIndex& outer = given.options.outer;
    return {format("--outer-index=%g in place of %s (the medium in which the board was)", window.outerIndex,
                   typedIndex(outer.isNamed() ? outer : GivenIndex{given.options.window.outerIndex}, 6).c_str()),
            medianErrorOfFit(given.data, options)};
}

Explanation ownWindows(const Given& given)
{
    const std::vector<int>& windows = given.options.windows;
    if (std::set<int>(windows.begin(), windows.end()).size() == windows.size())
        return {"", NO_FIT};
    RigOptions options = given.options;
    options.windows.clear();
    return {"a window of its own for each camera: leave --shared-window (--window-of-camera) out", medianErrorOfFit(given.data, options)};
}

} // namespace tools
