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

//! The long form of calibrateGlassRig, whose flags may have FROM_EARLIER_FIT. That refuses what its header does not know.
GlassRigResult fitGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                           const std::vector<std::vector<Mat> >& imagePointsRefracted,
                           const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                           InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                           InputOutputArrayOfArrays tvecs, const GlassRigOptions& options);

}} // namespace

#endif // OPENCV_REFRACT_REFIT_HPP
