// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECKED_STEREO_HPP
#define REFRACT_TOOLS_CHECKED_STEREO_HPP

#include "stereo/dense_stereo.hpp"
#include "stereo/match_support.hpp"
#include "stereo/wide_search.hpp"
#include <string>

/* Dense stereo that does not guess: matches that nothing supports are removed, and what the images say against the calibration or
the range of depths is said, or the pair is refused. */
namespace tools {

/* Row errors of a pair against what its calibration may be off by, and what could explain them. An error along the rows cannot be
seen: it is a wrong depth. So each cause that explains the errors across the rows is asked for its errors along them. */

//! How far the matches of a region of rectified1 miss their rows.
struct RowCell
{
    cv::Point at;           //!< pixel of the match that is the median
    double offset;          //!< px: the median
    double sigma;           //!< of the median, from the differences in the region
};

struct RowCheck
{
    double found = NAN;         //!< RMS, px; NaN: too few matches tell
    double expected = NAN;      //!< RMS of one standard deviation, px: of the calibration's covariance and the noise
    double times = 0;           //!< found in units of expected, all directions by themselves: about 1 if all is well
    double depthChange = 0;     //!< share of the depths, RMS: by so much the causes that explain the rows would change them
    std::string causes;         //!< those that explain them best, with their sizes, joined by "or"; empty: none explains them
    bool contradicts() const { return times > 3; }
};

RowCheck checkRows(const RectifiedRig& rig, const DenseStereo& stereo);

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
    std::string whyNothingFits(const WideDepths& seen, double mostRows, const cv::Mat& image1, const cv::Mat& image2) const;

    const RectifiedRig& rig_;
    MatcherOptions options_;
    bool crop_;
    std::string file_;
    WideSearch wide_;
};

} // namespace tools

#endif // REFRACT_TOOLS_CHECKED_STEREO_HPP
