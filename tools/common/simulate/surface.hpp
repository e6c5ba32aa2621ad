// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURFACE_HPP
#define REFRACT_TOOLS_SURFACE_HPP

#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>
#include <limits>
#include <memory>
#include <vector>

/* Surfaces that rays intersect. All in the frame of the scene, which is that of camera 1. */
namespace tools {

struct TextureOptions
{
    double size = 0.;           //!< of the coarsest grains; each octave halves it
    double contrast = 0.8;      //!< 0: none, 1: the darkest grains are nearly black
    int octaves = 8;
};

/* A texture that fills space, as the grain of wood or stone does: whatever surface is cut through it is textured, and all cameras
see the same there. The sum of several octaves of gradient noise, all of the same strength, so that it looks alike at all ranges.
The gradients come from a hash of the lattice point: no tables, the same on every machine. */
class SolidTexture
{
public:
    SolidTexture(const TextureOptions& options, uint64_t seed);

    /** Share of a surface's colour that the texture leaves, 1 - contrast ... 1.
    @param spacing between neighbouring samples there: octaves that they are too coarse for are left out, as they would give
    each camera another pattern */
    double at(const cv::Vec3d& point, double spacing) const;

private:
    struct Octave
    {
        double size;
        uint64_t seed;
    };

    cv::Matx33d turn_;          //!< so that usual planes are not parallel to the lattice
    double contrast_, scale_;
    std::vector<Octave> octaves_;
};

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

//! Surfaces with one texture through all of them.
struct TexturedScene
{
    std::vector<std::shared_ptr<const Surface>> surfaces;
    TextureOptions texture;
    uint64_t seed = 1;              //!< of the texture
};

//! The first surface on the ray of a sample, or none.
struct SurfaceHit
{
    const Surface* surface = nullptr;
    Intersection intersection;
};

SurfaceHit firstSurface(const TexturedScene& scene, const SceneRay& ray);

} // namespace tools

#endif // REFRACT_TOOLS_SURFACE_HPP
