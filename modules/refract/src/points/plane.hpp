// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PLANE_HPP
#define OPENCV_REFRACT_PLANE_HPP

#include "camera/camera.hpp"

namespace cv { namespace refract {

//! The plane z = depth; throws unless depth > 0 (infinity allowed) with the argument's name.
Vec4d planeOfDepth(double depth, const char* name);

//! Throws unless (a, b, c) is finite and not zero and d is not NaN.
void checkPlane(const Vec4d& plane, const char* name);

/** Where rays o + s d meet the plane a x + b y + c z = d, as homogeneous points d + mu o with mu = 1/s, so that
a plane at infinity (d infinite) needs no case of its own.
@param planeD d of each lane
@param mu may be null */
void meetPlane(const Layers& layers, int n, const Vec3d& abc, const double* planeD, const Rays& rays,
               double* x, double* y, double* z, double* mu, uchar* status);

}} // namespace

#endif // OPENCV_REFRACT_PLANE_HPP
