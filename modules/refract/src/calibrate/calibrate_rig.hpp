// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CALIBRATE_RIG_HPP
#define OPENCV_REFRACT_CALIBRATE_RIG_HPP

#include "calibrate/pair_check.hpp"

namespace cv { namespace refract {

// What the public calibrators check alike.

const int FIX_FLAGS = GLASS_FIX_FOCAL_LENGTH | GLASS_FIX_PRINCIPAL_POINT | GLASS_FIX_K1 | GLASS_FIX_K2 | GLASS_FIX_K3 |
                      GLASS_FIX_K4 | GLASS_FIX_K5 | GLASS_FIX_K6 | GLASS_FIX_TANGENT_DIST | GLASS_FIX_S1_S2_S3_S4 |
                      GLASS_FIX_TAUX_TAUY;
const int MONO_FLAGS = GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX |
                       GLASS_FREE_INTRINSICS | FIX_FLAGS | GLASS_ROBUST | GLASS_REQUIRE_WINDOW | GLASS_REQUIRE_INTRINSICS |
                       GLASS_REQUIRE_EXTRINSICS;

void checkFlags(int flags, int allowed);

/** Refuses windows and flags of which no data can tell, and windows that nobody looked through.
@param names of each camera's refracted views */
void checkWindows(const Rig& rig, const RigViews& views, int flags, const std::vector<String>& names);

}} // namespace

#endif // OPENCV_REFRACT_CALIBRATE_RIG_HPP
