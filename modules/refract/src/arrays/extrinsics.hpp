// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_EXTRINSICS_HPP
#define OPENCV_REFRACT_EXTRINSICS_HPP

#include "arrays/arrays.hpp"
#include "math/rigid_transform.hpp"

namespace cv { namespace refract {

//! "name[i]"
String numbered(const char* name, int i);

/** Rs and Ts of a rig, camera 1 -> camera, one per camera; both may be left out for one camera. Throws unless the first is the
identity within rounding; it is exact in the result. */
std::vector<RigidTransform> readExtrinsics(InputArrayOfArrays Rs, InputArrayOfArrays Ts, int cameras);

//! 3x3; a rotation vector, if only that has room.
void writeRotation(const Matx33d& R, OutputArray out);

//! 3x3 and 3x1 CV_64F; whatever is not wanted is left out.
void writeExtrinsics(const std::vector<RigidTransform>& extrinsics, OutputArrayOfArrays Rs, OutputArrayOfArrays Ts);

}} // namespace

#endif // OPENCV_REFRACT_EXTRINSICS_HPP
