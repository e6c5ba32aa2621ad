// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_THREE_RAYS_HPP
#define OPENCV_REFRACT_THREE_RAYS_HPP

#include "precomp.hpp"

namespace cv { namespace refract {

//! A ray in the scene, camera coordinates.
struct SceneRay
{
    Vec3d origin, direction;    //!< direction unit
};

//! Object -> camera.
struct RigidMotion
{
    Matx33d R;
    Vec3d t;
};

/** The motions that put three object points on three rays, which need not meet (the generalised perspective three-point
problem), before their origins. With X_i = o_i + s_i d_i the three distances between the points say

    |X_i - X_j|^2 = D_ij^2

in s. Newton's method begins at the solutions for rays from the mean origin: Grunert's quartic
(@cite Haralick1994). What is found is exact; where the
rays are far from central a solution may be missed (one in fifty behind 100 mm of tilted glass).
@return how many of `motions` were found */
int posesOfThreeRays(const SceneRay (&rays)[3], const Vec3d (&object)[3], RigidMotion (&motions)[4]);

}} // namespace

#endif // OPENCV_REFRACT_THREE_RAYS_HPP
