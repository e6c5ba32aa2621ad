// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURVEY_START_HPP
#define REFRACT_TOOLS_SURVEY_START_HPP

#include "bundle/bundle_start.hpp"
#include "colmap/survey.hpp"

#include <map>

namespace tools {

//! Where a camera was, from outside.
struct KnownPosition
{
    cv::Vec3d center;
    double std;                 //!< of each coordinate
};

//! What the adjustment of a survey starts from. Its frame is that of the model, or of the positions, less `origin`.
struct SurveyStart
{
    std::vector<cv::Vec3d> rvecs, tvecs;        //!< scene -> camera 1, of each view
    std::vector<cv::Point3d> points;            //!< of the model's
    GivenLengths lengths;
    std::map<int, KnownPosition> positions;     //!< less `origin`
    cv::Vec3d origin;
    std::string scale;                          //!< what tells it
    bool isScaleOfWindow = false;
};

/** The unit of the rig's lengths by the first of these that there is: known lengths between points, positions, the base line of a rig of
several cameras, the window. Then each pose by its pixels and the points of the model, through the windows. Throws Failure.
@param lengthsPath, positionsPath may be empty; ids of lengths are COLMAP's
@param folder of the model, for a sentence */
SurveyStart startSurvey(const Survey& survey, const BundleStart& bundle, const std::string& lengthsPath, const std::string& positionsPath,
                        const std::string& folder, bool quiet);

//! As refractiveBundleAdjust takes what is known of poses near these; empty: nothing is known.
std::vector<cv::Mat> covariancesOfPoses(const SurveyStart& start, const std::vector<cv::Vec3d>& rvecs, std::vector<cv::Vec3d>& tvecs);

} // namespace tools

#endif // REFRACT_TOOLS_SURVEY_START_HPP
