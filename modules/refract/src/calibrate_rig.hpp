// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CALIBRATE_RIG_HPP
#define OPENCV_REFRACT_CALIBRATE_RIG_HPP

#include "rig_fit.hpp"

namespace cv { namespace refract {

// What the public calibrators check alike.

const int MONO_FLAGS = GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX |
                       GLASS_FREE_INTRINSICS | GLASS_FIX_PRINCIPAL_POINT | GLASS_ROBUST;

void checkFlags(int flags, int allowed);

/** Refuses windows and flags of which no data can tell, and windows that nobody looked through.
@param names of each camera's refracted views */
void checkWindows(const Rig& rig, const RigViews& views, int flags, const std::vector<String>& names);

}} // namespace

#endif // OPENCV_REFRACT_CALIBRATE_RIG_HPP
