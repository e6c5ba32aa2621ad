// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RELATIVE_POSE_HPP
#define OPENCV_REFRACT_RELATIVE_POSE_HPP

#include "camera/camera.hpp"
#include "math/rigid_transform.hpp"

/* Two cameras' pose and what matches say of it. Two rays o + s d meet if

    g = (o2 - R o1 - T) . (R d1 x d2) = 0

(the generalised epipolar constraint, @cite Pless2003). A match's error is Sampson's, g over the length of its gradient by the
four pixel coordinates: to first order how far its two pixels together are from agreeing. Nothing is projected, so that a
thousand errors take some tenths of a millisecond. */

namespace cv { namespace refract {

//! A pixel's ray, tau normal + offset + s direction, and how it moves with the pixel. NaN where there is none.
struct PixelRay
{
    double tau;
    Vec3d direction;
    Vec2d tauByPixel;
    Vec3d directionByU, directionByV;
    double surface;                 //!< s at the last surface
    Vec3d offset, offsetByU, offsetByV;     //!< 0 behind parallel faces
};

std::vector<PixelRay> pixelRays(const Camera& camera, const std::vector<Point2d>& pixels);

struct Match
{
    Point2d pixel1, pixel2;
    PixelRay ray1, ray2;
};
typedef std::vector<Match> PixelMatches;

PixelMatches select(const PixelMatches& matches, const std::vector<int>& which);

//! Pixels of camera 1 and of camera 2.
typedef std::pair<std::vector<Point2d>, std::vector<Point2d> > MatchedPixels;

PixelMatches matchesOf(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels);

struct MatchedCameras
{
    const Camera &camera1, &camera2;
    Vec3d centre1, centre2;         //!< near which all rays pass, each in its camera
    bool refracts() const { return camera1.refracts() || camera2.refracts(); }
    //! A length at which refraction tells the most of the scale: how deep the windows are.
    double depth() const;
};

/** The pose at another length of T. T = centre2 - R centre1 + q baseline: the baseline is what pinholes at the centres know, and
hardly depends on the length. False where no q gives this length; T then keeps its direction. */
bool setLength(const MatchedCameras& pair, double length, RigidTransform& pose);

/** Of each match, NaN where it has no ray.
@param byPose if it is wanted, by the rotation vector (3) and by T (3)
@param limit errors beyond it need no exact value */
void sampsonErrors(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose,
                   std::vector<double>& errors, std::vector<Matx16d>* byPose, double limit = DBL_MAX);

//! The most likely pose near this one: the sum of squared errors, infinite if there is none.
double refine(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& pose, int iterations);

//! The same for the length that T has.
double refineAtLength(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& pose, int iterations);

/** The most likely rotation near this one if all points are infinitely far: the sum of squared errors, of which a match then has two,
infinite if there is none. */
double refineRotation(const PixelMatches& matches, Matx33d& R, int iterations);

//! Columns: how the rotation vector and T move by the five parameters that refineAtLength estimates.
Matx<double, 6, 5> motionAtLength(const RigidTransform& pose);

}} // namespace

#endif // OPENCV_REFRACT_RELATIVE_POSE_HPP
