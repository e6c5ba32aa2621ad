// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_SURVEY_HPP
#define REFRACT_TOOLS_COLMAP_SURVEY_HPP

#include "colmap/survey_output.hpp"

/* A survey from a folder with a model of COLMAP to its results. */
namespace tools {

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

#endif // REFRACT_TOOLS_COLMAP_SURVEY_HPP
