// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECKED_STEREO_HPP
#define REFRACT_TOOLS_CHECKED_STEREO_HPP

#include "stereo/match_support.hpp"
#include "stereo/row_check.hpp"
#include "stereo/wide_search.hpp"

/* Dense stereo that does not guess: matches that nothing supports are removed, and what the images say against the calibration or
the range of depths is said, or the pair is refused. */
namespace tools {

struct PairDiagnosis;

struct CheckedStereo
{
    DenseStereo stereo;                     //!< without what is not supported
    RowCheck rows;
    std::string refusal;                    //!< a sentence; empty: the points are to be used
    std::vector<std::string> warnings;      //!< a sentence each: parts of the scene are left out, or points have a larger sigma
};

class StereoChecker
{
public:
    /** @param crop the range leaves out a part of the scene on purpose
    @param file of the calibration, for sentences */
    StereoChecker(const RectifiedRig& rig, const MatcherOptions& options, bool crop, const std::string& file);

    CheckedStereo match(const cv::Mat& image1, const cv::Mat& image2) const;

private:
    void judgeRange(const WideDepths& seen, CheckedStereo& result) const;
    void judgeRows(const cv::Mat& image1, const cv::Mat& image2, const MatchSupport& support, CheckedStereo& result) const;
    std::string whatFeaturesSay(const PairDiagnosis& diagnosis) const;
    std::string whyNothingFits(const WideDepths& seen, const cv::Mat& image1, const cv::Mat& image2) const;

    const RectifiedRig& rig_;
    MatcherOptions options_;
    bool crop_;
    std::string file_;
    WideSearch wide_;
};

} // namespace tools

#endif // REFRACT_TOOLS_CHECKED_STEREO_HPP
