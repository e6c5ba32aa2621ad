// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_ROBUST_HPP
#define OPENCV_REFRACT_RIG_ROBUST_HPP

#include "calibrate/rig_problem.hpp"

namespace cv { namespace refract {

//! What became of the images and of their points; see rig_robust.cpp.
struct RobustOutcome
{
    bool converged;
    double varianceFactor;              //!< corrects the residuals' variance for what was cut off
    std::vector<uchar> imageStatus;     //!< GlassImageStatus, in the order of RigProblem::images()
};

/** Solves with points left out that are wrong, and images whose target was not where the view's other images have it.
Throws if fewer than half of the points fit.
@param seenCount points that the caller gave */
RobustOutcome solveRobustly(RigProblem& rig, int seenCount, const TermCriteria& criteria);

/** The views without the points that agree with no common pose of their image, to start from. Images without a pose
become empty. */
RigViews agreeingViews(const Rig& rig, const RigViews& views);

}} // namespace

#endif // OPENCV_REFRACT_RIG_ROBUST_HPP
