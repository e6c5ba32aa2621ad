// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURFACE_HPP
#define REFRACT_TOOLS_SURFACE_HPP

#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>
#include <limits>
#include <vector>

/* Surfaces that rays intersect. All in the frame of the scene, which is that of camera 1. */
namespace tools {

struct SceneRay
{
    cv::Vec3d origin, direction;    //!< direction of unit length; NaN where a pixel has no ray
    double least;                   //!< only points origin + s direction with s > least are beyond the window

    cv::Vec3d at(double s) const { return origin + s*direction; }
};

//! Where a ray meets a surface.
struct Intersection
{
    double s = std::numeric_limits<double>::infinity();
    cv::Vec3d normal;               //!< unit vector, to either side
};

class Surface
{
public:
    explicit Surface(const cv::Vec3d& color) : color_(color) {}
    virtual ~Surface() = default;

    //! Red, green, blue of its brightest grains, 0 ... 1.
    const cv::Vec3d& color() const { return color_; }

    //! Replaces `first` if the ray intersects this surface before it; returns whether it does.
    virtual bool intersect(const SceneRay& ray, Intersection& first) const = 0;

private:
    cv::Vec3d color_;
};

class Sphere : public Surface
{
public:
    Sphere(const cv::Vec3d& center, double radius, const cv::Vec3d& color)
        : Surface(color), center_(center), radius_(radius) {}
    bool intersect(const SceneRay& ray, Intersection& first) const override;

private:
    cv::Vec3d center_;
    double radius_;
};

class Plane : public Surface
{
public:
    //! Endless.
    Plane(const cv::Vec3d& point, const cv::Vec3d& normal, const cv::Vec3d& color);

    /** A rectangle round the point.
    @param right the direction in which it is 2 half.width long; what of it is along the normal is left out
    @param half half its sides */
    Plane(const cv::Vec3d& point, const cv::Vec3d& normal, const cv::Vec3d& right, const cv::Size2d& half,
          const cv::Vec3d& color);

    bool intersect(const SceneRay& ray, Intersection& first) const override;

private:
    cv::Vec3d point_, normal_, right_, down_;
    cv::Size2d half_;
};

//! A camera and where it stands in the scene.
struct Viewpoint
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    cv::Matx33d R = cv::Matx33d::eye();         //!< scene -> camera
    cv::Vec3d T = cv::Vec3d();
    //! The camera in the light of blue, green and red; empty: it is the same in all.
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> colours = {};

    //! z in the camera's frame.
    double depthOf(const cv::Vec3d& point) const { return (R*point + T)[2]; }
};

//! What pixels look along, from where it leaves the window on.
std::vector<SceneRay> raysOf(const std::vector<cv::Point2d>& pixels, const Viewpoint& view);

//! Angle between the rays of neighbouring pixels in the middle of the image, radians; 0 where there are no rays.
double pixelAngle(const Viewpoint& view);

} // namespace tools

#endif // REFRACT_TOOLS_SURFACE_HPP
