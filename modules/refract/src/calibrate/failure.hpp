// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FAILURE_HPP
#define OPENCV_REFRACT_FAILURE_HPP

#include "adjust/fit_outcome.hpp"

namespace cv { namespace refract {

enum class FitKind { CALIBRATION, BUNDLE };

//! Throws CalibrationError, with what the user is told, unless the fit has converged.
void throwUnlessConverged(const FitOutcome& outcome, FitKind kind);

}} // namespace

#endif // OPENCV_REFRACT_FAILURE_HPP
