// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASUREMENT_HPP
#define REFRACT_TOOLS_MEASUREMENT_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"

namespace tools {

/** A status of the tools, beyond cv::refract::RefractiveStatus: the residuals of a point are larger than noise and calibration
explain. */
const uchar INCONSISTENT = 9;

//! Another one: a pixel of the point lies outside of its image. (10 is the library's REFRACT_TOO_FEW_VIEWS.)
const uchar OUTSIDE_IMAGE = 11;

//! A pixel of each point in each camera, NaN where it was not seen.
using RigPixels = std::vector<std::vector<cv::Point2d>>;

//! Points in the camera-1 frame; NaN where there is no answer.
struct Measurement
{
    RigPixels pixels;                               //!< as seen
    std::vector<cv::Point3d> points;
    std::vector<cv::Vec3d> sigma;                   //!< one standard deviation of x, y, z
    std::vector<uchar> status;                      //!< cv::refract::RefractiveStatus, or INCONSISTENT, or OUTSIDE_IMAGE
    double noise = 0.;          //!< of a pixel coordinate, as this view shows it; 0: no more than stated, or nothing tells
    double worstResidual = 0.;  //!< px, of the inconsistent points

    int answers() const;                            //!< points that are not NaN
    int inconsistent() const;
    int seenPoints() const;                         //!< that the image shows, or at least two
    int contradicting() const;                      //!< inconsistent, or of rays that meet nowhere before the cameras
};

//! The observations of a view by the first cameras, through their windows.
RigPixels glassPixels(const View& view, int cameraCount);

/* The uncertainty has two parts: pixelSigma, one standard deviation of each pixel coordinate, and the calibration's own
covariance if the file has one. Unknown pixelSigma (NaN): unknown uncertainty. */

//! Maximum-likelihood triangulation by all cameras that see a point. @param pixels of each camera of the calibration
Measurement measureRig(const Calibration& calibration, const RigPixels& pixels, double pixelSigma);

//! Where the rays of camera 1 meet a plane (a, b, c, d) of its frame.
Measurement measureOnPlane(const Calibration& calibration, const std::vector<cv::Point2d>& pixels, const cv::Vec4d& plane,
                           double pixelSigma);

/** The points of a target of known shape, from its pose to camera 1. Residuals larger than pixelSigma take its place, and are
said in Measurement::noise. */
Measurement measureTarget(const Calibration& calibration, const std::vector<cv::Point3d>& objectPoints,
                          const std::vector<cv::Point2d>& pixels, double pixelSigma);

//! The same rig with the windows left out.
Calibration withoutWindows(const Calibration& calibration);

//! Standard deviation of a pixel coordinate, from the calibration's residuals; NaN where unknown.
double pixelSigmaOf(const Calibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_MEASUREMENT_HPP
