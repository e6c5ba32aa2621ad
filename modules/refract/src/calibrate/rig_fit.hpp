// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_FIT_HPP
#define OPENCV_REFRACT_RIG_FIT_HPP

#include "start/multi_start.hpp"
#include "start/rig_task.hpp"

namespace cv { namespace refract {

//! What the joint fit finds beside the cameras.
struct RigFit
{
    std::vector<Pose> poses;        //!< object -> camera 1; not found where a view has no point, or none left
    double rms = 0;                 //!< pixels
    double sigma = 0;               //!< of a pixel coordinate: the residuals of pixels, by what priors leave of the freedom
    int freedom = 0;                //!< equations - unknowns; priors are equations
    Mat covariance, stdDeviations;  //!< of the public parameters
    Mat perViewErrors;              //!< columns: direct, refracted of each camera
    Mat jacobian;                   //!< if wanted
    Mat imageStatus;                //!< GlassImageStatus, as perViewErrors
    std::vector<Mat> inliers;       //!< of each element of perViewErrors, row by row
    Mat targetErrors;               //!< 7x1: SharedTargetErrors; NaN: no prior was given
    Mat otherMinima;                //!< one row a camera: normal, excess, distance
};

//! Both limits in force: what the caller left open is generous.
TermCriteria checkedCriteria(TermCriteria criteria);

//! The task without views that no image shows, of which nothing is known. seen: the others.
RigTask onlySeen(const RigTask& task, std::vector<int>& seen);

//! Starts of windows and poses. Robust: images without a pose are taken out of the task. minima: the second best of each window.
FitOutcome findStart(const Rig& rig, RigTask& task, RigStart& start, std::vector<OtherMinimum>& minima);

//! Starts, fit, and what it tells. rig is start and result; it and fit mean nothing unless the outcome is CONVERGED.
FitOutcome fitRig(Rig& rig, const RigTask& task, RigFit& fit);

//! Whether there are more equations than unknowns.
FitOutcome checkFreedom(const Problem& problem);

//! What a calibration and a bundle adjustment tell of one image alike: its RMS. Returns its squares.
double describeError(const Problem& problem, const Image& image, int column, RigFit& fit);

/** While a tube is estimated, its center is any point of its axis. What is returned is the one nearest to the camera: with
c' = c - (a.c) a of center c and axis a, so do the center's rows of the covariance, and the axis' columns of the jacobian (if there is
one), which is a turn about c' then. Tubes that were given stay as they are. */
void toNearestCenters(Rig& rig, RigFit& fit);

//! As rvecs and tvecs, if these are wanted.
void writePoses(const std::vector<Pose>& poses, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs);
void writeMat(const Mat& from, OutputArray to);     //!< if it is wanted

}} // namespace

#endif // OPENCV_REFRACT_RIG_FIT_HPP
