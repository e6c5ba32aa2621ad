// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LENS_CHOICE_HPP
#define REFRACT_TOOLS_LENS_CHOICE_HPP

#include "calibrate/starting_model.hpp"

/* The lens that the images can carry: as many coefficients as held-out images (or, of too few images, held-out parts of the target)
support. Where there are direct images, these decide. */
namespace tools {

//! A lens model that was tried.
struct LensScore
{
    std::string model;          //!< opencv, fisheye
    int flags;                  //!< GLASS_FIX_...: the coefficients that stay 0
    int coefficients;           //!< that are free
    double px;                  //!< held-out RMS; NaN: it could not be fitted
};

const int RICHEST_LENS = 8;             // coefficients that are tried
const int POLYNOMIAL_LENS = 5;          // at most; more are of a rational lens

struct LensChoice
{
    std::vector<LensScore> scores = {};     //!< empty: nothing was chosen
    int chosen = 0;
    bool byImages = true;       //!< false: by parts of the target
    bool direct = true;         //!< false: images through the window
    bool undetermined = false;  //!< the images do not tell a focal length: no other model makes that better
    std::vector<cv::Mat> leftOut = {};  //!< of each camera, what they leave open of left out coefficients; empty: its lens is known

    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> lenses = {};   //!< of each camera, as fitted; null: its lens is known

    const LensScore& lens() const { return scores[chosen]; }
    std::string sentence() const;
};

//! Empty where all lenses are known, no candidate can be fitted, or the images do not determine one.
//! @param robust points far from the richest lens's fit do not count
//! @param richest coefficients that are tried, 5 or 8
LensChoice chooseLens(const RigData& data, const RigOptions& options, bool robust, int richest = RICHEST_LENS);

//! The options for the lens that was chosen.
//! @param richest coefficients, of those that are left open too
void setLens(const LensChoice& choice, RigOptions& options, int richest = RICHEST_LENS);

} // namespace tools

#endif // REFRACT_TOOLS_LENS_CHOICE_HPP
