// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/misfit.hpp"
#include "assess/fit_quality.hpp"
#include "assess/mixed_up_images.hpp"
#include "assess/wrong_target.hpp"
#include "assess/wrong_values.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>

using namespace cv::refract;

namespace tools {

namespace {

const double ALONE = 10.;               // times what the same corners leave if each image may be fitted alone:
const double ALONE_PX = 1.;             // the given values do not belong to them
const double EXPLAINS = 0.3;            // a mistake undone leaves less than this share
const double AS_GOOD = 3.;              // as the best of them

const char* const NOTHING_TRIED = "neither another square, thickness, index or medium, nor images exchanged or wrongly paired "
    "explain it. Check --pattern and --size, that the images are from this camera with the same zoom and focus, that the target "
    "is flat, and the images themselves";

//! Those that leave less than that, and are about as good as the best of them.
std::vector<Explanation> bestBelow(double most, const std::vector<Explanation>& tried)
{
    double best = most;
    for (const Explanation& e : tried)
        best = std::min(best, e.px);
    std::vector<Explanation> explaining;
    for (const Explanation& e : tried)
        if (e.px < most && e.px <= AS_GOOD*best)
            explaining.push_back(e);
    return explaining;
}

std::string joined(const std::vector<std::string>& reasons)
{
    if (reasons.empty())
        return NOTHING_TRIED;
    std::string text;
    for (size_t i = 0; i < reasons.size(); i++)
        text += (i ? "; or " : "") + reasons[i];
    return text;
}

} // namespace

std::vector<std::string> explainMisfit(const Given& given)
{
    const double now = medianErrorOfFit(given.data, given.options);
    std::vector<std::string> sentences;
    for (const std::string& sentence : {badCorners(given), partOfBoard(given)})
        if (!sentence.empty())
            sentences.push_back(sentence);
    const double most = std::min(EXPLAINS*now, largestSoundError(given.data));
    std::vector<Explanation> explaining = bestBelow(most, {wrongScale(given), wrongUnitOfPoints(given), mirrored(given),
        wrongIndex(given), directAndGlassExchanged(given), directAndGlassExchangedOfOne(given), camerasExchanged(given, true),
        camerasExchanged(given, false), otherMedium(given), ownWindows(given), unpaired(given)});
    // What each camera alone explains, any mistake in what they have in common explains better.
    if (explaining.empty())
        explaining = bestBelow(most, {otherMoments(given)});
    for (const Explanation& e : explaining)
        sentences.push_back(format("the same images fit within %.2g px with ", e.px) + e.sentence);
    return sentences;
}

void requireSensible(const RigCalibration& c, const Given& given)
{
    const double now = medianCornerError(c.data, c.residuals);
    double alone = 0.;
    for (int k = 0; k < c.data.cameraCount; k++)
        alone = std::max({alone, c.baselines.throughGlass[k], c.lensSources[k].rms});
    std::string fault;
    if (now > largestSoundError(c.data) || (now > ALONE_PX && now > ALONE*alone))
        fault = format("the calibration does not fit its images: half of the corners lie more than %.2g px from where it puts "
                       "them", now);
    else if (hasPairs(given.data) && !hasPairs(c.data))
        fault = format("all %d pair(s) contradict the calibration", given.data.countPairs());
    if (!fault.empty())
    {
        std::vector<std::string> reasons = explainMisfit(given);
        reasons.insert(reasons.end(), given.notices.begin(), given.notices.end());
        throw Failure(fault + ": " + joined(reasons));
    }
}

std::string explainError(const std::string& error, const Given& given)
{
    // The library speaks of its own arguments.
    const std::string theirs = "; raise criteria.maxCount, or fix what the views hardly determine";
    const size_t at = error.find(theirs);
    std::vector<std::string> reasons = explainMisfit(given);
    const bool explained = !reasons.empty();
    reasons.insert(reasons.end(), given.notices.begin(), given.notices.end());
    if (at == std::string::npos)
        return reasons.empty() ? error : error + ". However, " + joined(reasons);
    // The distance is set free without being asked for where it is needed.
    const bool asked = given.options.flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_OUTER_INDEX
                                              | GLASS_FREE_INTRINSICS);
    const std::string undetermined = std::string("the images hardly determine what is free. ") + (asked ? "Leave out "
        "--free=..., g" : "G") + "ive what you know (--thickness, --index, --distance, --camera), or add images: pairs, more tilt, "
        "more depth";
    const std::string head = error.substr(0, at) + ": ", tail = error.substr(at + theirs.size());
    if (explained)          // what fits is likelier than that nothing would
        return head + joined(reasons) + ". If it is not that, " + undetermined + tail;
    return head + undetermined + tail + (reasons.empty() ? "" : ". However, " + joined(reasons));
}

} // namespace tools
