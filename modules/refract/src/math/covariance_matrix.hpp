// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COVARIANCE_MATRIX_HPP
#define OPENCV_REFRACT_COVARIANCE_MATRIX_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** Throws unless a square matrix is a covariance: finite, symmetric and positive semidefinite, except for the rounding of printed
numbers. A quantity that is known exactly has the variance 0.
@param C CV_64F
@param name begins the text */
void checkCovariance(const Mat& C, const String& name);

}} // namespace

#endif // OPENCV_REFRACT_COVARIANCE_MATRIX_HPP
