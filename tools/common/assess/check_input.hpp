// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_INPUT_HPP
#define REFRACT_TOOLS_CHECK_INPUT_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/provenance.hpp"
#include "calibrate/rig_model.hpp"

namespace tools {

/* A calibration as a check of new images starts from it. */

struct CheckInput
{
    RigModel rig;
    cv::Mat covariance;         //!< of its parameters, as Fit::covariance; empty: they are exact
    double sigma;               //!< of a pixel coordinate
    double dof;                 //!< degrees of freedom of sigma
    std::vector<UncertaintySource> sources = {};    //!< of the covariance, as far as the file has them
    double square = 0.;                             //!< of the board that it was made with; 0: not known
};

/** From what a calibration file says. @param pixelSigma given by the user; 0: that of the residuals.
Throws Failure if the file does not say enough. @param filename for the text */
CheckInput checkInputOf(const Calibration& calibration, const std::string& filename, double pixelSigma);

//! The same calibration with a column for each angle of a wedge; one that it does not have is 0, exactly.
CheckInput withWedges(const CheckInput& input);

//! The same with columns for the scale and the motion of the targets. @param covariance of these; empty: they are exact
CheckInput withTargetColumns(const CheckInput& input, const cv::Mat& covariance);

//! How much panes of one kind differ from each other, standard deviations.
struct PaneStd
{
    double thickness, index;
    double wedge;                   //!< of each of its two angles, about 0, radians
};

/** A calibration whose panes were exchanged since for others of the same kind. Thickness and index are the calibrated ones with the
difference of two panes; wedges are about 0. */
CheckInput withNewPanes(const CheckInput& input, const PaneStd& std);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_INPUT_HPP
