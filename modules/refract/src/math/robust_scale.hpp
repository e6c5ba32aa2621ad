// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_ROBUST_SCALE_HPP
#define OPENCV_REFRACT_ROBUST_SCALE_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

// How large errors usually are where some are wrong. Errors are lengths in the image, of the Rayleigh distribution where
// they are right; a scale is the standard deviation of one coordinate.

//! The quantile of a Rayleigh distribution that a good point exceeds with a chance of 1e-4, in scales.
const double CUT = std::sqrt(-2*std::log(1e-4));
const double LEAST_SCALE = 1e-7;    //!< pixels: errors of perfect data are rounding

//! 0 if there are no values.
double median(std::vector<double> values);

//! The scale that the median tells.
double scaleOf(const std::vector<double>& errors);

/** Errors that were cut off at `cut` scales have this part of the mean square that all have. With x = cut^2/2, the mean of
r^2/(2 sigma^2) below the cut is 1 - x/(e^x - 1). */
double truncationFactor(double cut);

//! The scale of the errors below `cut` scales, from a first guess of it.
double truncatedScale(const std::vector<double>& errors, double scale, double cut);

}} // namespace

#endif // OPENCV_REFRACT_ROBUST_SCALE_HPP
