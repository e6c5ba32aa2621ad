// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/diagnosis.hpp"
#include "diagnose/fit_quality.hpp"
#include "diagnose/image_mistakes.hpp"
#include "diagnose/target_mistakes.hpp"
#include "diagnose/value_mistakes.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <set>

using namespace cv::refract;

namespace tools {

namespace {

const double IMPLAUSIBLE = 10.;         // times the RMS of the same corners if each camera is fitted separately:
const double MIN_IMPLAUSIBLE_PX = 1.;   // then the given values do not belong to the images
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

bool hasBoardsOnly(const CalibrationInput& input)
{
    return std::all_of(input.data.views.begin(), input.data.views.end(), [](const View& view) { return !view.neighbours.empty(); });
}

bool canSwapCameras(const CalibrationInput& input)
{
    return hasPairs(input.data) && input.data.cameraCount > 1 && input.data.cameraCount <= MAX_SWAPPED_CAMERAS;
}

bool sharesWindows(const CalibrationInput& input)
{
    const std::vector<int>& windows = input.options.windows;
    return std::set<int>(windows.begin(), windows.end()).size() < windows.size();
}

//! The mistakes that are tried, in the order in which they are reported.
const Mistake MISTAKES[] = {
    {[](const CalibrationInput& input) { return hasPairs(input.data) && !input.options.window.thickness.empty(); }, wrongScale},
    {[](const CalibrationInput& input) { return !hasPairs(input.data) && !(input.square > 0); }, wrongUnitOfPoints},
    {[](const CalibrationInput& input) { return !hasBoardsOnly(input); }, mirroredPoints},
    {[](const CalibrationInput& input) { return hasPairs(input.data) && input.options.window.index.size() == 1; }, wrongIndex},
    {[](const CalibrationInput& input) { return hasPairs(input.data); }, swappedStates},
    {[](const CalibrationInput& input) { return hasPairs(input.data) && input.data.cameraCount > 1; }, swappedStatesOfOneCamera},
    {canSwapCameras, swappedGlassImages},
    {[](const CalibrationInput& input) { return canSwapCameras(input) && hasKnownLens(input); }, swappedDirectImages},
    {[](const CalibrationInput&) { return true; }, wrongMedium},
    {sharesWindows, separateWindows},
    {[](const CalibrationInput& input) { return hasPairs(input.data); }, unpairedImages}};

//! What each camera explains by itself, any mistake in what they have in common explains better: tried if nothing else explains.
const Mistake LAST_MISTAKES[] = {
    {[](const CalibrationInput& input) { return input.data.cameraCount > 1; }, unrelatedViews}};

template <size_t N>
std::vector<Explanation> explanationsOf(const CalibrationInput& input, const Mistake (&mistakes)[N], double maxPx)
{
    std::vector<Explanation> tried;
    for (const Mistake& mistake : mistakes)
        if (mistake.appliesTo(input))
            tried.push_back(mistake.undo(input));
    return bestBelow(maxPx, tried);
}

} // namespace

std::vector<std::string> diagnose(const CalibrationInput& input)
{
    const double now = medianErrorOfFit(input.data, input.options);
    std::vector<std::string> sentences;
    for (const std::string& sentence : {badCorners(input), partOfBoard(input)})
        if (!sentence.empty())
            sentences.push_back(sentence);
    const double most = std::min(EXPLAINS*now, largestSoundError(input.data));
    std::vector<Explanation> explaining = explanationsOf(input, MISTAKES, most);
    if (explaining.empty())
        explaining = explanationsOf(input, LAST_MISTAKES, most);
    for (const Explanation& e : explaining)
        sentences.push_back(format("the same images fit within %.2g px with ", e.px) + e.sentence);
    return sentences;
}

void requirePlausible(const RigData& data, const std::vector<Residual>& residuals, double rmsOfSeparateFits,
                      const CalibrationInput& input)
{
    const double now = medianCornerError(data, residuals);
    std::string fault;
    if (now > largestSoundError(data) || (now > MIN_IMPLAUSIBLE_PX && now > IMPLAUSIBLE*rmsOfSeparateFits))
        fault = format("the calibration does not fit its images: half of the corners lie more than %.2g px from where it puts "
                       "them", now);
    else if (hasPairs(input.data) && !hasPairs(data))
        fault = format("all %d pair(s) contradict the calibration", input.data.countPairs());
    if (!fault.empty())
    {
        std::vector<std::string> reasons = diagnose(input);
        reasons.insert(reasons.end(), input.notices.begin(), input.notices.end());
        throw Failure(fault + ": " + joined(reasons));
    }
}

namespace {

//! All reasons there may be; whether images explain some.
std::vector<std::string> reasonsFor(const CalibrationInput& input, bool& explained)
{
    std::vector<std::string> reasons = diagnose(input);
    explained = !reasons.empty();
    reasons.insert(reasons.end(), input.notices.begin(), input.notices.end());
    return reasons;
}

//! A fit does not converge along what is hardly determined.
std::string undeterminedAdvice(int flags)
{
    // The distance is set free without being asked for where it is needed.
    const bool asked = flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_OUTER_INDEX | GLASS_FREE_INTRINSICS);
    return std::string("the images hardly determine what is free. ") + (asked ? "Leave out --free=..., g" : "G")
        + "ive what you know (--thickness, --index, --distance, --camera), or add images: pairs, more tilt, more depth";
}

} // namespace

std::string explainError(const std::string& error, const CalibrationInput& input)
{
    bool explained;
    const std::vector<std::string> reasons = reasonsFor(input, explained);
    return reasons.empty() ? error : error + ". However, " + joined(reasons);
}

std::string explainError(const CalibrationError& error, const CalibrationInput& input)
{
    if (error.cause != CalibrationError::NOT_CONVERGED)
        return explainError(error.err, input);
    bool explained;
    const std::vector<std::string> reasons = reasonsFor(input, explained);
    const std::string advice = undeterminedAdvice(input.options.flags);
    if (explained)          // what fits is likelier than that nothing would
        return error.reason + ": " + joined(reasons) + ". If it is not that, " + advice;
    return error.reason + ": " + advice + (reasons.empty() ? "" : ". However, " + joined(reasons));
}

} // namespace tools
