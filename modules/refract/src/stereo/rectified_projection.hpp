// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RECTIFIED_PROJECTION_HPP
#define OPENCV_REFRACT_RECTIFIED_PROJECTION_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! P = K [I, -centre] of a rectified image, rectified frame.
struct RectifiedProjection
{
    //! Throws with the name unless P is 3x4, K not singular.
    RectifiedProjection(InputArray P, const char* name);
    Matx33d K, inverseK;
    Vec3d centre;
};

//! Along which the second image's pinhole is: 0 x, 1 y. Throws if it is the first's.
int axisOf(const RectifiedProjection& first, const RectifiedProjection& second);

}} // namespace

#endif // OPENCV_REFRACT_RECTIFIED_PROJECTION_HPP
