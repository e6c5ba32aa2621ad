// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURVEY_OUTPUT_HPP
#define REFRACT_TOOLS_SURVEY_OUTPUT_HPP

#include "bundle/bundle_findings.hpp"
#include "colmap/scene_depth.hpp"
#include "colmap/survey_adjustment.hpp"
#include <iosfwd>

/* What refract_bundle --colmap writes and says. */
namespace tools {

//! All that is known in the end.
struct SurveyResult
{
    Survey survey;
    SurveyStart start;
    SurveyAdjustment adjustment;
    BundleFindings findings;
    std::vector<NearestPinhole> pinholes;       //!< of each camera
    std::string unit;
};

//! id,x,y,z,sx,sy,sz,images,angle_deg,status, one row a point of the model.
std::string surveyPointsCsv(const SurveyResult& result);

//! view,rx_deg,ry_deg,rz_deg,tx,ty,tz and the std of each, then where camera 1 was, and its std.
std::string surveyPosesCsv(const SurveyResult& result);

//! "x, y, z" of the start's origin.
std::string originText(const SurveyStart& start);

/** The model with refined poses and points, less the start's origin: programs that take it reckon with few digits. Of its pixels those have
points that were used, its cameras (1, 2, ... as in the calibration) are the nearest pinholes. A point's error is that of the cameras with
their windows; points whose +- is more than a tenth of their distance are left out. The survey's model becomes
it, for want of memory. */
ColmapModel refractedModel(SurveyResult& result);

std::string surveyJson(const SurveyResult& result, const std::string& command);

//! At most ten lines of 80 columns.
void printSurvey(std::ostream& out, const SurveyResult& result);

/* A survey from a folder with a model of COLMAP to its results. */

struct SurveyOptions
{
    std::string model;                          //!< --colmap; empty: none
    std::vector<std::string> images;            //!< globs of names, one a camera; none: see surveyOf()
    std::string lengths, positions;             //!< files; may be empty
    bool robust = true;
    double memory = 0.;                         //!< GB that +- of poses and points may take; 0: any
    double pixelSigma = 0., maxRms = 0.;        //!< px; 0: not known, no limit
};

//! Throws Failure.
SurveyResult adjustColmap(const SurveyOptions& options, const BundleStart& start, const std::string& unit, bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_SURVEY_OUTPUT_HPP
