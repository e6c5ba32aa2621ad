// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_GENERALIZED_P3P_HPP
#define OPENCV_REFRACT_GENERALIZED_P3P_HPP

#include "arrays/views.hpp"
#include "camera/camera.hpp"
#include "math/rigid_transform.hpp"

namespace cv { namespace refract {

//! A ray in the scene, camera coordinates.
struct SceneRay
{
    Vec3d origin, direction;    //!< direction unit
};

/** The motions that put three object points on three rays, which need not meet (the generalised perspective three-point
problem), before their origins. With X_i = o_i + s_i d_i the three distances between the points say

    |X_i - X_j|^2 = D_ij^2

in s. Newton's method begins at the solutions for rays from the mean origin: Grunert's quartic
(@cite Haralick1994). What is found is exact; where the
rays are far from central a solution may be missed (one in fifty behind 100 mm of tilted glass).
@return how many of `motions` were found */
int posesOfThreeRays(const SceneRay (&rays)[3], const Vec3d (&object)[3], RigidTransform (&motions)[4]);

//! All of them, at most eight: for callers with few samples, in ten times the time.
std::vector<RigidTransform> allPosesOfThreeRays(const SceneRay (&rays)[3], const Vec3d (&object)[3]);

//! False for three points on a line or in one place.
bool isTriangle(const Vec3d (&object)[3]);

//! The squared distances of points 0 and 1, 1 and 2, 2 and 0.
Vec3d squaredSides(const Vec3d (&object)[3]);

/** Newton's method in s; false if it does not converge to points before the origins.
@param X the points on their rays */
bool solveDistances(const SceneRay (&rays)[3], const Vec3d& squaredSides, Vec3d& s, Vec3d (&X)[3]);

//! The motion of a triangle to where its points are.
RigidTransform motionOfTriangle(const Vec3d (&object)[3], const Vec3d (&X)[3]);

//! The rays of an image's points that have one.
struct PointRays
{
    PointRays(const Camera& camera, const ImagePoints& points);
    std::vector<SceneRay> ray;
    std::vector<int> point;         //!< in the image
};

}} // namespace

#endif // OPENCV_REFRACT_GENERALIZED_P3P_HPP
