// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIGID_MOTION_HPP
#define OPENCV_REFRACT_RIGID_MOTION_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! x -> R x + t: object -> camera, or camera 1 -> camera 2.
struct RigidMotion
{
    Matx33d R;
    Vec3d t;
};

}} // namespace

#endif // OPENCV_REFRACT_RIGID_MOTION_HPP
