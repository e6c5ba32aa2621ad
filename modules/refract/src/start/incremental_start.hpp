// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_INCREMENTAL_START_HPP
#define OPENCV_REFRACT_INCREMENTAL_START_HPP

#include "start/multi_start.hpp"

namespace cv { namespace refract {

/** Where the joint fit of a sealed rig starts of which hardly anything is known, not even where its cameras are: each camera alone
first (its best minima, see bestSealedStart), then pairs behind one window, so that all get the window of one of them, then all.
The best wins.
@param given lenses and windows; places only where the views do not tell them
@param others one per camera; the second best minimum */
RigStart incrementalStart(const Rig& given, const RigViews& views, int flags, std::vector<OtherMinimum>& others);

}} // namespace

#endif // OPENCV_REFRACT_INCREMENTAL_START_HPP
