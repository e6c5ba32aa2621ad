// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_REFIT_HPP
#define OPENCV_REFRACT_REFIT_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

/** A flag of fitGlassRig alone: what is given is where an earlier fit of the same images, or of some of them, has ended. So no other
minima are looked for, unless that fit does not end near. */
const int FROM_EARLIER_FIT = 1 << 30;

//! Of a fit, what RigFit has of the same names.
struct FitStatistics
{
    double rms, sigma;
    int freedom;
};

//! calibrateGlassRig (that of targets), whose flags may have FROM_EARLIER_FIT. The public call refuses what its header does not know.
FitStatistics fitGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                          const std::vector<std::vector<Mat> >& imagePointsRefracted, const std::vector<Ptr<RefractiveCamera> >& cameras,
                          const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
                          InputOutputArrayOfArrays rvecs, InputOutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                          OutputArray perViewErrors, OutputArray imageStatus, OutputArrayOfArrays inliers, OutputArray otherMinima,
                          InputArray targetCovariance, OutputArray targetErrors, int flags, InputArrayOfArrays poseCovariances,
                          TermCriteria criteria, InputArrayOfArrays cameraCovariances,
                          const std::vector<std::vector<Mat> >& pixelCovariancesDirect = std::vector<std::vector<Mat> >(),
                          const std::vector<std::vector<Mat> >& pixelCovariancesRefracted = std::vector<std::vector<Mat> >());

}} // namespace

#endif // OPENCV_REFRACT_REFIT_HPP
