// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/next_step.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

namespace {

//! The source of the budget that has the largest share of a point's error; null: there is no budget.
const BudgetRow* largestShare(const Assessment& a)
{
    const BudgetRow* largest = nullptr;
    for (size_t i = 0; i + 1 < a.budget.size(); i++)        // the last is the total
        if (std::isfinite(a.budget[i].share) && (!largest || a.budget[i].share > largest->share))
            largest = &a.budget[i];
    return largest;
}

//! Of the camera that has the fewest.
int fewestPairs(const RigCalibration& c)
{
    int fewest = c.data.countPairs(0);
    for (int k = 1; k < c.data.cameraCount; k++)
        fewest = std::min(fewest, c.data.countPairs(k));
    return fewest;
}

//! "another pair: near (z = 490 mm), in the middle of the image, ..."
std::string nextPair(const Assessment& a, int count)
{
    const std::string pairs = (count == 1 ? std::string("another ") : format("%d more ", count))
        + (a.advice.arePairs ? "pair" : "image") + (count == 1 ? "" : "s");
    return a.advice.pairs.empty() ? pairs : pairs + (count == 1 ? ": " : ", first: ") + a.advice.pairs[0].placement;
}

//! What a point's error is mostly made of, and what makes that smaller.
std::string toMeasureBetter(const RigCalibration& c, const Assessment& a)
{
    const BudgetRow* largest = largestShare(a);
    if (!largest)
        return "take more images";
    const std::string share = format("%.0f %% of a point's error", 100.*largest->share);
    if (!largest->given.empty())
        return "know the " + largest->source + " better than " + largest->given + ", " + share;
    if (largest->source != CALIBRATION_NOISE)
        return "take sharper images: " + share + " is the noise of its own pixels";
    if (a.advice.pairs.empty())
        return "take more images: " + share + " is noise of the calibration's";
    return "take " + nextPair(a, 1) + format(" (the worst point then has %.3g instead of %.3g %s)", a.advice.pairs[0].quality.worstPoint,
                                             a.advice.now.worstPoint, c.unit.c_str());
}

std::string worstView(const RigCalibration& c)
{
    double worst = 0.;
    std::string name;
    for (int k = 0; k < c.data.cameraCount; k++)
        for (int i : c.fit.views)
            for (bool glass : {true, false})
            {
                const double px = rmsOf(c, k, glass, i).px;
                if (!(px > worst))
                    continue;
                worst = px;
                name = "'" + c.data.views[i].stem + "'" + ofCamera(k, c.data.cameraCount)
                    + (glass ? "" : ", direct");
            }
    return name + format(" (%.3g px)", worst);
}

//! Of the first limit that is not met.
std::string toMeet(const LimitCheck& limit, const RigCalibration& c, const Assessment& a)
{
    if (!limit.notJudged.empty())
        return "take " + nextPair(a, std::max(1, ENOUGH_PAIRS - fewestPairs(c)));
    if (limit.unit == "px")
        return "look at the images that fit worst, first " + worstView(c) + ": focus, motion, light, a board that is not flat";
    if (limit.unit == "deg")
        return "take " + nextPair(a, 1);
    return toMeasureBetter(c, a);
}

} // namespace

std::string nextStep(const RigCalibration& c, const Assessment& a, const Findings& f)
{
    if (!f.contradictions.empty())
        return "put right what the images contradict, and calibrate again";
    for (const LimitCheck& limit : f.limits)
        if (!limit.met())
            return toMeet(limit, c, a);
    const int pairs = fewestPairs(c);
    if (pairs > 0 && pairs < ENOUGH_PAIRS)
        return "take " + nextPair(a, ENOUGH_PAIRS - pairs);
    return (f.weak.empty() ? "measure (refract_measure); to do so better, " : "mend what is weak; then ") + toMeasureBetter(c, a);
}

} // namespace tools
