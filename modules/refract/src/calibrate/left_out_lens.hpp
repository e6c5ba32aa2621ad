// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LEFT_OUT_LENS_HPP
#define OPENCV_REFRACT_LEFT_OUT_LENS_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

/** What the data leave open of the coefficients that a choice of lenses left out, as a prior of mean 0: all have one width in pixels at the
image's corner, which the data tell (empirical Bayes: the evidence of MacKay, Bayesian interpolation, 1992). Those that bend along the
radius (k) have one width, the tangential ones (p) another.
@param problem where the choice was fitted; what was left out is free
@param isLeftOut of each parameter of each camera's lens
@return of each camera L x L, CV_64F: NaN for what was not left out */
std::vector<Mat> priorsOfLeftOut(const Problem& problem, const std::vector<std::vector<bool> >& isLeftOut);

}} // namespace

#endif // OPENCV_REFRACT_LEFT_OUT_LENS_HPP
