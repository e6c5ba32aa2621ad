// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/colmap_survey.hpp"

namespace tools {

namespace {

const double VAGUE = 0.1;       // of a scale that the window alone tells: what it is told beforehand has no say up to here

} // namespace

SurveyResult adjustColmap(const SurveyOptions& options, const BundleStart& start, const std::string& unit, bool quiet)
{
    SurveyResult result;
    result.unit = unit;
    result.survey = surveyOf(readColmapModel(options.model), start.rig, options.images, options.model);
    result.start = startSurvey(result.survey, start, options.lengths, options.positions, options.model, quiet);
    const auto adjusted = [&](const BundleStart& from) {
        return adjustSurvey(result.survey, from, result.start, options.robust, options.memory, quiet); };
    result.adjustment = adjusted(start);
    for (int view = 0; view < (int)result.survey.views.size(); view++)
        if (!result.adjustment.hasPose(view))
            result.survey.leaveOut(view);
    result.findings = findingsOf(start, result.start.lengths, result.adjustment.bundle, options.pixelSigma, options.maxRms);
    checkPlaces(start, [&](const BundleStart& freed) { return adjusted(freed).bundle; }, result.findings);
    result.findings.scale = scaleText(result.start, result.adjustment);
    if (result.start.isScaleOfWindow && !(result.adjustment.scaleStd <= VAGUE))
        result.findings.weak.insert(result.findings.weak.begin(), "the scale, which the window alone tells: give --lengths or --positions");
    result.pinholes = pinholesOf(result.survey, result.adjustment);
    return result;
}

} // namespace tools
