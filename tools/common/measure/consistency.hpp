// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CONSISTENCY_HPP
#define REFRACT_TOOLS_CONSISTENCY_HPP

#include "measure/measurement.hpp"

/* Consistency of the observations: pixels that no point, or no pose of the target, explains. */
namespace tools {

/** Tests the observations of each point for consistency. Two pixels have four coordinates, and a point three: one residual is left,
about the distance of the second pixel from its epipolar curve over sqrt(2). It is compared with the noise and the calibration's
covariance. A larger residual is added to sigma; beyond a few standard deviations the status becomes INCONSISTENT, and far beyond
(20 of them, and at least 2 px) the point becomes NaN. */
void checkConsistency(const Calibration& calibration, double pixelSigma, Measurement& measurement);

//! The same of a target's pose: one that leaves large residuals makes all its points INCONSISTENT and their sigma NaN.
void checkPose(double pixelSigma, Measurement& measurement);

/** What points that are seen by more cameras than it takes tell of the noise of a pixel, whatever the pixels are said to be worth: where
their rays miss each other. */
class ShownNoise
{
public:
    //! @param m of a rig; points that are NaN tell nothing
    ShownNoise(const Calibration& calibration, const Measurement& m);

    double sigma() const;                           //!< px, without the calibration's part; NaN: nothing tells
    int dof() const { return dof_; }
    //! Beyond chance, even if the calibration errs by three standard deviations, which is one error for all points.
    bool isMoreThan(double pixelSigma) const;
    //! The same whatever the calibration errs by: by what no error of its parameters makes of the rays. False where points are few.
    bool refutes(double pixelSigma) const;

private:
    struct Part
    {
        int dof;
        double square, ofCalibration;               //!< per degree of freedom, px^2
    };
    std::vector<Part> parts_;
    int dof_ = 0;
    double besideCalibration_ = 0.;                 //!< sum of squares, px^2
    int dofBesideCalibration_ = 0;
};

} // namespace tools

#endif // REFRACT_TOOLS_CONSISTENCY_HPP
