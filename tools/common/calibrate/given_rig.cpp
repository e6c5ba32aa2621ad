// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_rig.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <cmath>
#include <set>

using namespace cv::refract;

namespace tools {

bool GivenRigOptions::isDistanceKnown() const { return window.isDistanceSaid() || places.areOfMarkers(); }

std::vector<int> GivenRigOptions::windowsOf(int cameras) const
{
    if (sharedWindow)
        return std::vector<int>(cameras, 0);
    if (windowOfCamera.empty())
        return {};
    std::vector<int> windows;
    for (double number : parseNumbers(windowOfCamera, "--window-of-camera"))
    {
        if (number != std::floor(number) || std::abs(number) > 1e6)
            throw Failure("--window-of-camera=" + windowOfCamera + ": give whole numbers, as 1,1,2,2");
        windows.push_back((int)number);
    }
    if ((int)windows.size() != cameras)
        throw Failure(format("--window-of-camera=%s has %zu numbers, but there are %d cameras: give one for each",
                             windowOfCamera.c_str(), windows.size(), cameras));
    return windows;
}

//! Standard deviations of what is given.
void GivenRigOptions::takeStd(double square, RigOptions& rig) const
{
    GivenValues values;
    values.layers = rig.layers;
    values.outer = rig.outer;
    values.equalMedia = !hasDifferentMedia(rig.window);
    values.distance = isDistanceKnown();
    values.shape = rig.window.shape;
    values.square = square;
    values.millimetre = 1./millimetresIn(unit);
    values.flags = rig.flags;
    rig.std = std.of(values);
    rig.std.normal = places.normalStd();
    window.requireBow(rig.std, rig.flags);
    rig.window = withEstimated(rig.window, rig.std, rig.flags);
    const std::set<int> windows(rig.windows.begin(), rig.windows.end());
    if (rig.window.shape == WINDOW_BENT && !rig.window.wedge.empty() && windows.size() < rig.windows.size())
        throw Failure("a bent window that several cameras share cannot have a wedge, too, as its faces would have no common centre: say "
                      "--wedge-std=0 (and no --free=wedge), or leave --bow-std out");
}

void GivenRigOptions::takePlaces(int cameras, RigOptions& rig) const
{
    const std::string option = places.option();
    if (places.isSaid() && isRound(rig.window))
        throw Failure(option + " is of a flat window; where a " + window.shape() + " is, --center says, with --center-std");
    if (places.areOfMarkers() && rig.flags & GLASS_FREE_DISTANCE)
        throw Failure("--free=distance says that the images alone tell the distance, and --pane-points what is known of it: leave one out");
    rig.places = places.of(cameras, rig.windows);
    rig.placeOption = option;
}

RigOptions GivenRigOptions::of(int cameras, Channel channel, bool knowsPoses, double square) const
{
    RigOptions rig;
    for (const std::string& name : free)
        rig.flags |= freeFlags().at(name);
    const GivenWindow given = window.of(rig.flags, channel);
    rig.window = given.window;
    rig.layers = given.layers;
    rig.inner = given.inner;
    rig.outer = given.outer;
    rig.channel = channel;
    rig.windows = windowsOf(cameras);
    takePlaces(cameras, rig);
    if (knowsPoses)
        rig.flags |= GLASS_USE_POSES;
    if (hasDifferentMedia(rig.window) && !isDistanceKnown() && !isRound(rig.window))
        rig.flags |= GLASS_FREE_DISTANCE;
    takeStd(square, rig);
    return rig;
}

std::string GivenRigOptions::noticeOfLiquid(const GlassWindow& given) const
{
    const double LEAST_SOLID = 1.36;        // no solid that windows are made of has less; water has 1.333
    for (size_t i : {(size_t)0, given.index.size() - 1})
        if (!given.index.empty() && given.index[i] < LEAST_SOLID)
            return "--index=" + window.index() + format(": the %s has the index %.4g, as a liquid: no window is made of that. "
                   "The medium behind the window is --outer-index, a bare surface has no --thickness and no --index",
                   given.index.size() == 1 ? "window" : i ? "outermost layer" : "innermost layer", given.index[i]);
    return "";
}

} // namespace tools
