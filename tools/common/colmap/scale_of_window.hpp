// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCALE_OF_WINDOW_HPP
#define REFRACT_TOOLS_SCALE_OF_WINDOW_HPP

#include "bundle/matches.hpp"
#include "colmap/survey.hpp"

namespace tools {

//! What to do where nothing tells the scale.
const char SCALE_ADVICE[] = "; give --lengths or --positions";

//! What refraction tells of the unit of a model.
struct ScaleOfWindow
{
    double factor;              //!< the calibration's unit over that of the model
    GivenLengths asLengths;     //!< one object's, between points, so uncertain that the images have the say
};

/** A few images that share most points are adjusted with the scene at many distances; that where rays meet best tells the scale. How well
is for the whole adjustment to say. Throws Failure where no distance has an answer, where the best is the nearest or the farthest tried, and
without a window.
@param folder of the model, for a sentence */
ScaleOfWindow scaleOfWindow(const Survey& survey, const RigModel& rig, const std::string& folder, bool quiet);

} // namespace tools

#endif // REFRACT_TOOLS_SCALE_OF_WINDOW_HPP
