// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_TASK_HPP
#define OPENCV_REFRACT_RIG_TASK_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! What the calibrators are given beside the cameras.
struct RigTask
{
    RigViews views;
    std::vector<Pose> knownPoses;               //!< GLASS_USE_POSES: one per view, not found where it is not known; else empty
    std::vector<PosePrior> posePriors;          //!< of the same
    std::vector<CameraPrior> cameraPriors;      //!< one per camera, or empty
    Eigen::MatrixXd targetCovariance;           //!< of SharedTargetErrors, or empty
    int flags;
    TermCriteria criteria;
    bool wantsJacobian = false;
    bool wantsCovariance = true;                //!< as it holds; else only whether it exists, and as derivatives have it
    bool isRefit = false;                       //!< starts where an earlier fit has ended: no other minima are looked for

    bool isRobust() const { return (flags & GLASS_ROBUST) != 0; }
    //! Neither direct images nor poses.
    bool isThroughWindowsOnly() const;
    //! Images through the windows alone have to tell the lenses too, and of the cameras only coefficients may be known (to be small).
    bool isSealed(const Rig& rig) const;
    //! The flags of a search for where the fit begins, which has no priors: a lens that something tells stays as it is.
    int searchFlags() const;
    //! Images through the windows alone have to tell where the cameras are, and windows or lenses: each camera is fitted alone first.
    bool isIncremental(const Rig& rig) const;
};

}} // namespace

#endif // OPENCV_REFRACT_RIG_TASK_HPP
