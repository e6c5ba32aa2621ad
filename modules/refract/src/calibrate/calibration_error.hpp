// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CALIBRATION_ERROR_HPP
#define OPENCV_REFRACT_CALIBRATION_ERROR_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** Throws it as CV_Error throws: the program's error callback, or standard error, hears of it once, and cv::setBreakOnError()
works. cv::error() alone would throw a copy of the base class. */
[[noreturn]] void raise(CalibrationError error);

}} // namespace

#endif // OPENCV_REFRACT_CALIBRATION_ERROR_HPP
