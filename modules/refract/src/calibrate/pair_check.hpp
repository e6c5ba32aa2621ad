// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PAIR_CHECK_HPP
#define OPENCV_REFRACT_PAIR_CHECK_HPP

#include "calibrate/rig_fit.hpp"

namespace cv { namespace refract {

/** fitRig, but throws where its pairs cannot be what the caller says they are: direct and refracted points swapped, or not of
the same unmoved target. */
RigFit fitCheckingPairs(Rig& rig, const RigTask& task);

}} // namespace

#endif // OPENCV_REFRACT_PAIR_CHECK_HPP
