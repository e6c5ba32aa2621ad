// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_REPORT_FIGURES_HPP
#define REFRACT_TOOLS_REPORT_FIGURES_HPP

#include "assess/assessment.hpp"
#include "report/page_template.hpp"

/* The figures of the report as its template takes them: each with a title, and how to read it. Each makes a step of progress. */
namespace tools {

class Progress;

//! Of one camera.
PageList figuresOf(const RigCalibration& calibration, int camera, Progress& progress);

//! The rig from two sides.
PageList rigFigures(const RigCalibration& calibration, Progress& progress);

PageValues errorOverRange(const RigCalibration& calibration, const Assessment& assessment, Progress& progress);

//! Over the image, at each range.
void addErrorMaps(PageList& list, const RigCalibration& calibration, const Assessment& assessment, Progress& progress);

} // namespace tools

#endif // REFRACT_TOOLS_REPORT_FIGURES_HPP
