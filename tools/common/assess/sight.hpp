// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SIGHT_HPP
#define REFRACT_TOOLS_SIGHT_HPP

#include "assess/view_derivatives.hpp"
#include "calibrate/rig_data.hpp"

/* New images of one moment against a calibration: the pixels, and the board's pose, which nobody knows. */
namespace tools {

//! Images of one moment, the pixels in the order of differentiateView, and the board's pose so far.
struct Sight
{
    std::vector<cv::Point3d> objectPoints;
    std::vector<ImageOfView> images;
    Eigen::VectorXd pixels;
    cv::Vec3d rvec, tvec;
};

//! The start: the pose that one of the images tells. Throws Failure if none does.
Sight sightOf(const RigModel& rig, const Moment& moment);

/** How far the pixels of moments are from a calibration that has not seen them, each board where it fits best, and how far
they should be:

    r = Q^T (pixels - predicted),   S = sigma^2 I + A C A^T,   A = Q^T byParameters,   Q: free of the poses

Most of r is pixel noise whatever the calibration does. What the calibration's errors do lies in the few directions in which
A C A^T is larger than sigma^2: these tell whether C is true. */
struct Misfit
{
    double squares = 0., expectedSquares = 0.;          //!< of all of r, px^2
    double chiSquare = 0.;      //!< of the part of r that the calibration governs
    int directions = 0;         //!< of it

    void add(const Misfit& other);
    double ratio() const;               //!< RMS over expected RMS; NaN: nothing was added
    double calibrationRatio() const;    //!< root of chiSquare per direction: 1 where C is true; NaN: no direction
};

//! Throws Failure if no pose of the target explains its points.
Misfit misfitOf(const RigModel& rig, const cv::Mat& covariance, double sigma, const std::vector<Moment>& moments);

} // namespace tools

#endif // REFRACT_TOOLS_SIGHT_HPP
