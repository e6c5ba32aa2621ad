// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_FIT_HPP
#define OPENCV_REFRACT_BUNDLE_FIT_HPP

#include "adjust/outliers.hpp"
#include "calibrate/bundle_images.hpp"
#include "calibrate/rig_fit.hpp"

namespace cv { namespace refract {

//! What a bundle adjustment is given beside the cameras.
struct BundleTask
{
    BundleImages images;
    std::vector<Point3d> points;                //!< NaN: not known
    std::vector<Pose> poses;                    //!< scene -> camera 1 of each view
    std::vector<PosePrior> posePriors;      //!< of the same
    std::vector<CameraPrior> cameraPriors;      //!< one per camera, or empty
    std::vector<KnownLength> lengths;
    Eigen::MatrixXd rigCovariance;              //!< of the public parameters, from an earlier calibration; empty: nothing is known
    double lengthScaleSigma = 0;                //!< of a relative error that all lengths share; 0: there is none; NaN: not known
    int flags;
    TermCriteria criteria;
    ScaleSources scale;
    bool wantsPoseCovariances = false, wantsPointDeviations = false;
    double covarianceMemory = 0;                //!< bytes that these may take; 0: any
};

//! What it finds beside the cameras; a column of perViewErrors is a camera. In place of inliers: isUsed.
struct BundleFit : RigFit
{
    Masks isUsed;                               //!< per image of the task, per point of it
    std::vector<Mat> poseCovariances;           //!< if wanted
    std::vector<Point3d> points;                //!< NaN: left out
    Mat pointDeviations;                        //!< if wanted
};

//! Starts of points, fit, and what it tells, as fitRig().
FitOutcome fitBundle(Rig& rig, const BundleTask& task, BundleFit& fit);

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_FIT_HPP
