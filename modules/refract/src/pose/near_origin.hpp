// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_NEAR_ORIGIN_HPP
#define OPENCV_REFRACT_NEAR_ORIGIN_HPP

#include <opencv2/core.hpp>
#include <vector>

/* A target in survey coordinates lies far from their origin. A small turn about that moves it by metres, so that rotation and
translation are one combination, of which closed forms and steps have no digits. The target's points are moved to an origin among
them, and its poses back: R X + t = R (X - o) + (t + R o). */

namespace cv { namespace refract {

struct ImagePoints;
struct Pose;

class NearOrigin
{
public:
    //! Of points that stay where they are.
    NearOrigin() {}
    //! The first point, where the points are far from 0.
    explicit NearOrigin(const std::vector<Point3d>& points);

    bool isNear(const std::vector<Point3d>& points) const;

    bool isMoved() const { return origin_ != Vec3d(); }
    const Vec3d& origin() const { return origin_; }
    void move(std::vector<Point3d>& points) const;
    //! The pose of the moved points, by that of the given ones.
    Pose toNear(Pose pose) const;
    //! The pose of the given points, by that of the moved ones. @param scale of both
    Pose toFar(Pose pose, double scale = 1) const;
    //! Derivatives of (rvec, tvec) of the moved points by those of the given ones, and the other way round.
    Matx66d nearByFar(const Pose& pose) const { return byOther(pose, 1); }
    Matx66d farByNear(const Pose& pose) const { return byOther(pose, -1); }

private:
    Matx66d byOther(const Pose& pose, double sign) const;
    Vec3d origin_;
};

//! Moves the points' object coordinates.
NearOrigin moveNear(ImagePoints& points);

}} // namespace

#endif // OPENCV_REFRACT_NEAR_ORIGIN_HPP
