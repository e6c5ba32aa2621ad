// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/diagnosis.hpp"
#include "console/table.hpp"
#include "diagnose/plain_fit.hpp"
#include "diagnose/image_mistakes.hpp"
#include "diagnose/value_mistakes.hpp"

using namespace cv::refract;

namespace tools {

namespace {

//! All reasons there may be; whether images explain some.
std::vector<std::string> reasonsFor(const CalibrationInput& input, bool& explained)
{
    std::vector<std::string> reasons = diagnose(input);
    explained = !reasons.empty();
    reasons.insert(reasons.end(), input.notices.begin(), input.notices.end());
    return reasons;
}

/** Of a pane before each camera an image tells the tilt only through perspective; of one that cameras share, they tell it together. Not a
cause of errors: windows of their own fit as well. */
std::string sharingAdvice(const CalibrationInput& input)
{
    if (input.data.cameraCount == 1 || !input.options.windows.empty() || input.options.window.shape != WINDOW_FLAT)
        return "";
    const Explanation shared = sharedWindows(input);
    if (!(shared.px < largestSoundError(input.data)))
        return "";
    return format("With %s they fit within %.2g px: say so if these cameras look through one window. ", shared.sentence.c_str(), shared.px);
}

//! A fit does not converge along what is hardly determined.
std::string undeterminedAdvice(const CalibrationInput& input)
{
    const int flags = input.options.flags;
    // The distance is set free without being asked for where it is needed.
    const bool asked = flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_OUTER_INDEX | GLASS_FREE_INTRINSICS);
    return "the images hardly determine what is free. " + sharingAdvice(input) + (asked ? "Leave out --free=..., g" : "G")
        + "ive what you know (--thickness, --index, --distance, --camera), or add images: pairs, more tilt, more depth";
}

} // namespace

std::string explainError(const std::string& error, const CalibrationInput& input)
{
    bool explained;
    const std::vector<std::string> reasons = reasonsFor(input, explained);
    return reasons.empty() ? error : error + ". However, " + alternatives(reasons);
}

std::string explainError(const CalibrationError& error, const CalibrationInput& input)
{
    if (error.cause != CalibrationError::NOT_CONVERGED)
        return explainError(error.err, input);
    bool explained;
    const std::vector<std::string> reasons = reasonsFor(input, explained);
    const std::string advice = undeterminedAdvice(input);
    if (explained)          // what fits is likelier than that nothing would
        return error.reason + ": " + alternatives(reasons) + ". If it is not that, " + advice;
    return error.reason + ": " + advice + (reasons.empty() ? "" : ". However, " + alternatives(reasons));
}

} // namespace tools
