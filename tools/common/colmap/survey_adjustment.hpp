// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURVEY_ADJUSTMENT_HPP
#define REFRACT_TOOLS_SURVEY_ADJUSTMENT_HPP

#include "bundle/bundle_adjustment.hpp"
#include "bundle/bundle_start.hpp"
#include "bundle/measures.hpp"
#include "colmap/survey.hpp"
#include <map>

namespace tools {

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

//! Cameras, windows, poses and points that fit a survey best.
struct SurveyAdjustment
{
    BundleAdjustment bundle;                    //!< its points are those of the model; less the start's origin
    std::vector<cv::Vec3d> rvecs, tvecs;        //!< scene -> camera 1, of each view; NaN: most of its observations are wrong
    std::vector<cv::Mat> viewCovariances;       //!< 6x6 each; 0: it is the frame; NaN: not found, for want of memory
    bool arePointsAlone = false;                //!< then +- of points are those of known cameras and views
    std::vector<uchar> used;                    //!< of each observation
    std::vector<double> errors;                 //!< of each observation, px: where it was seen from where it is projected; NaN: no point
    std::vector<int> images;                    //!< of each point: how many observations are used
    std::vector<double> angles;                 //!< of each point: the largest between its rays, degrees
    double scaleStd = 0.;                       //!< relative, of the distance known best between two places of the rig, or by positions;
                                                //!< infinite: not known
    std::vector<char> isVague;                  //!< of each point: its +- is more than a tenth of its distance
    int largeErrors = 0;                        //!< how many are

    bool hasPose(int view) const { return rvecs[view] == rvecs[view]; }
    RigidTransform poseOf(int view) const { return tools::transformOf(rvecs[view], tvecs[view]); }
    //! Where camera 1 was.
    cv::Vec3d centreOf(int view) const { return poseOf(view).inverse(cv::Vec3d()); }
    cv::Matx33d centreCovariance(int view) const;
};

/** Throws Failure that says what the images do not determine, or why there is no answer.
@param memory GB that +- of views and points may take; 0: any */
SurveyAdjustment adjustSurvey(const Survey& survey, const BundleStart& bundle, const SurveyStart& start, bool robust, double memory,
                              bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_SURVEY_ADJUSTMENT_HPP
