// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_POINT_ERROR_HPP
#define REFRACT_TOOLS_POINT_ERROR_HPP

#include "measure/measurement.hpp"

/* The expected error of a measured point, from pixel noise and from the calibration's covariance: one standard deviation, the root
mean square of the 3-D distance from the truth. Several cameras: triangulation by those that see the point; one camera: a point on
a plane perpendicular to the camera's axis. */
namespace tools {

//! At one range, over a grid of pixels of camera 1 that reaches the image's borders.
struct ErrorMap
{
    double range = 0.;                  //!< z in the frame of camera 1
    std::vector<cv::Point2d> pixels;    //!< row by row
    cv::Size grid;
    std::vector<double> total;          //!< NaN where a point is not seen
    std::vector<double> pixelNoise;     //!< the part that is due to pixel noise

    bool seen() const;                  //!< anything at all
    double best() const;                //!< NaN if nothing is seen
    double worst() const;
    double percentile95() const;        //!< of what is seen: the worst may be a single point at a border
    double median() const;
    double seenShare() const;           //!< of the grid
    double worstPixelNoise() const;
};

//! Sums over the points of maps that are seen: squared errors, in the two parts that add up to the total.
struct ErrorSquares
{
    double calibration = 0., pixelNoise = 0.;
    int count = 0;

    void add(const ErrorMap& map);
};

const int ERROR_MAP_COLUMNS = 25;       //!< of all maps whose worst point is reported, as it depends on the grid

/** @param columns of the grid. */
ErrorMap mapErrors(const Calibration& calibration, double range, double pixelSigma, int columns);

//! A grid over an image, borders included.
std::vector<cv::Point2d> gridOver(cv::Size image, int columns, cv::Size& grid);

} // namespace tools

#endif // REFRACT_TOOLS_POINT_ERROR_HPP
