// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_COVARIANCE_MATRIX_HPP
#define OPENCV_REFRACT_COVARIANCE_MATRIX_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** The one rule for covariances that are given. It throws, with the name and the numbers, unless a square matrix is one: finite,
symmetric and positive semidefinite, except for the rounding of printed numbers. A quantity that is known exactly has the variance 0,
and no covariance with others.
@param C CV_64F
@param name begins the text */
void checkCovariance(const Mat& C, const String& name);

/** The same of what is known before a fit: a variance of NaN says that nothing is known of a quantity, whose row and column are then
not read.
@return as given, but for rounding: symmetric, 0 beside what is exact or not known */
Mat_<double> knownCovariance(const Mat& C, const String& name);

}} // namespace

#endif // OPENCV_REFRACT_COVARIANCE_MATRIX_HPP
