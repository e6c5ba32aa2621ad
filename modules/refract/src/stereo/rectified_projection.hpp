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

//! Along which the second image's pinhole is: 0 x, 1 y.
inline int axisOf(const RectifiedProjection& first, const RectifiedProjection& second)
{
    const Vec3d base = second.centre - first.centre;
    return std::abs(base[0]) >= std::abs(base[1]) ? 0 : 1;
}

}} // namespace

#endif // OPENCV_REFRACT_RECTIFIED_PROJECTION_HPP
