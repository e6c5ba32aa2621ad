// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAIR_MISTAKES_HPP
#define REFRACT_TOOLS_PAIR_MISTAKES_HPP

#include "calibrate/calib_file.hpp"
#include "match/features.hpp"

#include <string>

/* Why a pair does not fit its calibration: mistakes, each undone and asked again how many features of both images then have a
point. Only where something is wrong, as finding features takes as long as matching all pixels. */
namespace tools {

/** By how much the two rays of each pair of features miss each other, px; infinite where they have no point before the cameras.
@param points written: camera-1 frame, of each pair */
std::vector<double> missesOf(const Calibration& calibration, const Partners& partners, std::vector<cv::Point3d>& points);

struct PairDiagnosis
{
    int features = 0;           //!< that are alike in both images
    double rows = NAN;          //!< median distance of their two rays, px; NaN: too few
    std::string mistake;        //!< a sentence: what was mistaken for what; empty: none of those that are known
};

//! Both images of one moment, 8-bit, grey or colour.
PairDiagnosis diagnosePair(const Calibration& calibration, const cv::Mat& image1, const cv::Mat& image2);

} // namespace tools

#endif // REFRACT_TOOLS_PAIR_MISTAKES_HPP
