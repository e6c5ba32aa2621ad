// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/mixed_up_images.hpp"
#include "assess/fit_quality.hpp"
#include "console/table.hpp"
#include <algorithm>

namespace tools {

namespace {

const int MOST_TO_EXCHANGE = 4;         // cameras: each two of them are a fit of all

//! @param only of this camera; -1: of all
RigData exchanged(const RigData& given, int only)
{
    RigData data = given;
    for (Moment& m : data.moments)
        for (int c = 0; c < data.cameraCount; c++)
            if (only < 0 || only == c)
                std::swap(m.direct[c], m.glass[c]);
    return data;
}

enum Mirror { POINTS, ROWS, COLUMNS };

//! @param only camera; negative: all, with what they have of direct images and of those through the window
RigData mirroredData(const RigData& given, Mirror mirror, int only)
{
    RigData data = given;
    for (Moment& m : data.moments)
    {
        for (cv::Point3d& X : m.objectPoints)
            X.x *= mirror == POINTS ? -1. : 1.;
        for (int c = 0; c < data.cameraCount; c++)
            for (std::vector<cv::Point2d>* pixels : {&m.direct[c], &m.glass[c]})
                for (cv::Point2d& p : *pixels)
                {
                    if (only >= 0 && only != c)
                        continue;
                    if (mirror == ROWS)
                        p.y = data.imageSize[c].height - 1. - p.y;
                    if (mirror == COLUMNS)
                        p.x = data.imageSize[c].width - 1. - p.x;
                }
    }
    return data;
}

Explanation better(const Explanation& a, const Explanation& b) { return b.px < a.px ? b : a; }

} // namespace

Explanation directAndGlassExchanged(const Given& given)
{
    if (!hasPairs(given.data))
        return {"", NO_FIT};
    return {"--direct and --glass exchanged", medianErrorOfFit(exchanged(given.data, -1), given.options)};
}

Explanation directAndGlassExchangedOfOne(const Given& given)
{
    Explanation best{"", NO_FIT};
    if (given.data.cameraCount == 1 || !hasPairs(given.data))
        return best;
    for (int c = 0; c < given.data.cameraCount; c++)
    {
        const std::string suffix = cameraSuffix(c);
        best = better(best, {"--direct" + suffix + " and --glass" + suffix + " exchanged",
                             medianErrorOfFit(exchanged(given.data, c), given.options)});
    }
    return best;
}

Explanation camerasExchanged(const Given& given, bool glass)
{
    const auto& known = given.options.known;
    const bool lensKnown = std::any_of(known.begin(), known.end(), [](const auto& camera) { return bool(camera); });
    Explanation best{"", NO_FIT};
    if (!hasPairs(given.data) || (!glass && !lensKnown) || given.data.cameraCount > MOST_TO_EXCHANGE)
        return best;
    for (int b = 1; b < given.data.cameraCount; b++)
        for (int a = 0; a < b; a++)
        {
            RigData data = given.data;
            for (Moment& m : data.moments)
                glass ? std::swap(m.glass[a], m.glass[b]) : std::swap(m.direct[a], m.direct[b]);
            const std::string first = cameraSuffix(a), second = cameraSuffix(b), direct = "--direct" + first + " and --direct" + second;
            const std::string sentence = glass ? "--glass" + first + " and --glass" + second + " exchanged" : direct + " exchanged";
            best = better(best, {sentence + (lensKnown ? "" : " (or " + direct + ")"), medianErrorOfFit(data, given.options)});
        }
    return best;
}

Explanation otherMoments(const Given& given)
{
    if (given.data.cameraCount < 2)
        return {"", NO_FIT};
    double worst = 0.;
    for (int c = 0; c < given.data.cameraCount; c++)
    {
        const Given one = oneCamera(given, c);
        worst = std::max(worst, medianErrorOfFit(one.data, one.options));
    }
    return {"each camera calibrated alone, so equal names of " + std::string(given.data.cameraCount == 2 ? "camera 1 and camera 2"
            : "different cameras") + " are not the same moment (or the cameras moved to each other)", worst};
}

Explanation mirrored(const Given& given)
{
    Explanation best{"", NO_FIT};
    const auto ofBoard = [](const Moment& m) { return !m.neighbours.empty(); };
    if (std::all_of(given.data.moments.begin(), given.data.moments.end(), ofBoard))
        return best;                    // whose points are found in images
    const auto attempt = [&](Mirror mirror, int camera, const std::string& sentence) {
        best = better(best, {sentence, medianErrorOfFit(mirroredData(given.data, mirror, camera), given.options)});
    };
    for (Mirror mirror : {POINTS, ROWS})
        attempt(mirror, -1, "the points mirrored: x, y, z are in a left-handed frame (one axis turned round, or two columns "
                "exchanged), or u or v is counted from the other side");
    const int cameras = given.data.cameraCount;
    for (int c = 0; c < cameras && cameras > 1 && cameras <= MOST_TO_EXCHANGE; c++)
        for (Mirror mirror : {ROWS, COLUMNS})
            attempt(mirror, c, format("u or v of camera %d counted from the other side: its images are mirrored to those of the "
                                      "others", c + 1));
    return best;
}

Explanation unpaired(const Given& given)
{
    if (!hasPairs(given.data))
        return {"", NO_FIT};
    RigData data = given.data;
    data.moments.clear();
    for (const Moment& m : given.data.moments)
    {
        Moment direct = m, glass = m;
        for (int c = 0; c < data.cameraCount; c++)
        {
            direct.glass[c].clear();
            glass.direct[c].clear();
        }
        if (m.hasGlass())
            data.moments.push_back(glass);
        if (m.countDirect())
            data.moments.push_back(direct);
    }
    return {"each image fitted alone, so equal names of --direct and --glass are not one place of the board (it moved, or it "
            "was hand-held: --unpaired)", medianErrorOfFit(data, given.options)};
}

} // namespace tools
