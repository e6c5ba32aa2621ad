// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SEALED_START_HPP
#define OPENCV_REFRACT_SEALED_START_HPP

#include "calibrate/rig_fit.hpp"
#include "calibrate/rig_start.hpp"
#include "calibrate/window_start.hpp"

namespace cv { namespace refract {

//! Images through the windows alone have to tell the lenses too.
bool isSealed(const RigTask& task);

/** A sealed rig's cost has more than one minimum: distance against focal length, tilt against principal point and tangential
distortion. Some views are fitted a little from several lenses and distances, and from tilts of one window after the other;
the start is the best of the minima that these lead to when all views count.
@param others one per camera; the second best of these minima */
RigStart bestSealedStart(const RigStart& given, const RigViews& views, const RigTask& task,
                         std::vector<OtherMinimum>& others);

}} // namespace

#endif // OPENCV_REFRACT_SEALED_START_HPP
