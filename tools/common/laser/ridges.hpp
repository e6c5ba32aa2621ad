// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIDGES_HPP
#define REFRACT_TOOLS_RIDGES_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

/* Bright lines to a part of a pixel (C. Steger, An unbiased detector of curvilinear structures, PAMI 20, 1998): in the image smoothed by a
Gaussian, the line runs where the first derivative across it is zero,

    t = -(r_x n_x + r_y n_y) / r_nn,      |t n_x|, |t n_y| <= 1/2,

n the direction of the most negative second derivative r_nn. White noise of a pixel, s, makes an error of t of
s / (sqrt(8 pi) sigma^2 |r_nn|). */
namespace tools {

/* An image in which little but the laser line is bright: by how much its colour exceeds the two others, which are the same on white, grey
and black; or what an image without the laser does not show; or the brightness. */

enum LaserColour { LASER_BLUE, LASER_GREEN, LASER_RED, LASER_ANY };

//! "red", "green", "blue", "any"
std::vector<std::string> laserColourNames();
LaserColour laserColourOf(const std::string& name);

/** @param image grey or BGR, 8 or 16 bits (a 16-bit one counts 256 as one grey value)
@param without the same view with the laser off, of the same size and type; or empty
@return CV_32F */
cv::Mat laserSignal(const cv::Mat& image, LaserColour colour, const cv::Mat& without = cv::Mat());

struct RidgePoint
{
    cv::Point2d pixel;
    cv::Vec2d across;           //!< unit vector, the image's x and y
    double curvature;           //!< -r_nn: how sharp and bright the line is
    double sigma;               //!< px, of the position across, one standard deviation
};

/** @param signal CV_32F, in which the line is bright
@param scale px, standard deviation of the Gaussian: that of the line's own profile finds it best
@param noise standard deviation of a pixel of the signal. Points that noise alone would make are left out */
std::vector<RidgePoint> findRidges(const cv::Mat& signal, double scale, double noise);

//! Standard deviation of a pixel, from what a plane through its neighbours does not explain (J. Immerkaer, CVIU 64, 1996), by the median.
double noiseOf(const cv::Mat& signal);

/** The scale at which points respond most: the standard deviation of the line's profile.
@param pixels on the line. @return px, of a table of scales; 0 if there are no points */
double scaleOfLine(const cv::Mat& signal, const std::vector<cv::Point2d>& pixels);

/** The standard deviation, px, that white noise leaves out of the points' errors (speckle, texture): with it, the median of the residuals
is what their variances say. 0: none. @param variances by white noise */
double excessNoise(const std::vector<double>& residuals, const std::vector<double>& variances);

//! Pixels at the border of an image that have no ridge, as what is beyond is not known.
int borderOf(double scale);

//! How far points must be along the line for their errors to be independent.
inline double independentAfter(double scale) { return 3.*scale; }

} // namespace tools

#endif // REFRACT_TOOLS_RIDGES_HPP
