// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LENS_CANDIDATE_HPP
#define OPENCV_REFRACT_LENS_CANDIDATE_HPP

#include "adjust/held_out.hpp"
#include "calibrate/rig_fit.hpp"

/* A lens that selectLensCoefficients tries, and what its errors on held-out parts tell. */
namespace cv { namespace refract {

struct LensCandidate
{
    int flags;                          //!< GLASS_FIX_...
    int coefficients;                   //!< that are free, of the camera with most
    bool isRational;
    bool isFitted;                      //!< if not to the end, too: left out, it would leave the choice to what is far worse
    bool isConverged;
    RigStart fitted;
    std::vector<HeldOutPart> parts;
    std::vector<std::vector<double> > errors;   //!< of each image's points
    double squares;                     //!< of all parts
    FitOutcome determined;              //!< or which parameters are not
};

//! From the simplest lens on.
std::vector<LensCandidate> candidatesOf(const Rig& rig, int flags);

double pointsOf(const std::vector<HeldOutPart>& parts);
//! Of squares(a) - squares(b). The parts are the same in all candidates, so their differences are what tells.
double standardError(const LensCandidate& a, const LensCandidate& b);
//! Of its squares: of exact data all lenses that can are as good, and differ in their rounding.
double unseen(const LensCandidate& candidate);
//! Proven, by a standard error.
bool isWorse(const LensCandidate& a, const LensCandidate& b);

}} // namespace

#endif // OPENCV_REFRACT_LENS_CANDIDATE_HPP
