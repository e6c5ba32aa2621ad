// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_power.hpp"
#include "console/table.hpp"
#include <algorithm>

namespace tools {
namespace {

const double CERTAIN = 0.95;            // probability with which --detect degrees must show

//! How many times as many images would show the tilt, or 0 if no number would.
int imagesNeeded(const WindowCheck& window, const CheckResult& result, double degrees)
{
    for (int n = 2; n <= 10000; n++)
        if (powerOf(window, result, degrees, 1./n) >= CERTAIN)
            return n;
    return 0;
}

//! The least tilt that would show, to one digit.
double tiltThatShows(const WindowCheck& window, const CheckResult& result)
{
    const double CEILING = 90.;
    for (double decade = 1e-4; decade < CEILING; decade *= 10.)
        for (int digit = 1; digit < 10; digit++)
            if (powerOf(window, result, digit*decade) >= CERTAIN)
                return digit*decade;
    return 0.;
}

//! --detect of a centre, as a length.
std::string detected(const WindowCheck& window, const CheckOptions& o)
{
    return format("%.3g (%g deg, as seen from a radius away)", o.detect*window.lengthPerDegree, o.detect);
}

//! Empty, or why a scene does not tell.
std::string whyNotOfScene(const CheckResult& result, const CheckOptions& o)
{
    if (result.changed)
        return "";
    const std::string more = "give images of more, and more textured, things, near and far, in the corners too, at more moments";
    if (result.turns.empty())
        return "the images do not tell how the cameras stand to each other: " + more;
    for (const TurnCheck& turn : result.turns)
        if (powerOf(turn, result, o.detect) < CERTAIN && !o.hasHistory())
            return format("camera %d: these images would show a turn by %g deg with a probability of only %.0f %%, so 'unchanged' cannot "
                          "be said; ", turn.camera + 1, o.detect, 100.*powerOf(turn, result, o.detect)) + more + ", or ask for a larger "
                "--detect";
    return "";
}

} // namespace

std::string whyNot(const CheckResult& result, const CheckOptions& o, const CheckInput& input)
{
    if (o.isOfScene())
        return whyNotOfScene(result, o);
    if (result.changed)
        return "";
    for (const WindowCheck& window : result.windows)
    {
        const double power = powerOf(window, result, o.detect);
        if (power >= CERTAIN || o.hasHistory())
            continue;
        const int times = imagesNeeded(window, result, o.detect);
        const bool pairs = o.images.anyDirect(), commonMotion = pairs && o.placement > 0;    // which more pairs share
        const std::string noisy = result.sigma > input.sigma ? format("the new images are noisier than the calibration's (%.3g px, "
            "there %.3g px: check focus, light, motion); ", result.sigma, input.sigma) : "";
        const double shown = tiltThatShows(window, result);
        const std::string more = commonMotion ? format("more pairs do not help, as all boards or the camera's mount may have moved by %.2g "
            "between direct and glass images: give a smaller --placement-std if they stood better, or ", o.placement)
                                              : !times ? "" : format("take about %d times as many %s%s, or ", times,
            pairs ? "pairs" : "images",
            pairs ? " (a nearer board or one with more corners also helps)" : " or, far better, a pair without and with the window");
        const std::string change = window.lengthPerDegree > 0. ? "a motion of the centre by " + detected(window, o)
                                                               : format("a tilt of %g deg", o.detect);
        return noisy + format("camera %d: these images would show %s with a probability of only %.0f %%, so 'unchanged' "
                              "cannot be said; ", window.camera + 1, change.c_str(), 100.*power) + more
            + (shown > 0. ? format("ask for --detect=%g", shown) : std::string("ask for a larger --detect"));
    }
    if (result.windows.empty())
        return "the images do not tell where any window is: take a pair without and with the window, or more images";
    return "";
}

std::string verdictOf(const CheckResult& result, const std::string& why)
{
    const bool windows = std::any_of(result.windows.begin(), result.windows.end(), [](const WindowCheck& w) { return w.moved; });
    return !why.empty() ? CANNOT_TELL : !result.changed ? "unchanged" : windows ? "moved" : "changed";
}

} // namespace tools
