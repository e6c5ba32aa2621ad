// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/plane_lens.hpp"
#include "lens/stereographic.hpp"

/* mrcal's models of the whole sphere, (a, b) in the plane of PlaneLens:

    STEREOGRAPHIC   (a, b) = 2 tan(theta/2) (X, Y)/|(X, Y)|,  theta = angle to the z axis
    LONLAT          a = longitude atan2(X, Z),  b = latitude asin(Y/|d|)
    LATLON          a = latitude asin(X/|d|),   b = longitude atan2(Y, Z)

Domain: all directions but those with no image or with two: straight backwards for STEREOGRAPHIC; the poles and the half
plane behind the camera, where the longitude jumps from pi to -pi, for the others. */

namespace cv { namespace refract {

namespace {

class StereographicLens : public PlaneLens
{
public:
    explicit StereographicLens(const LensSpec& spec) : PlaneLens(spec) {}

private:
    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d*) const CV_OVERRIDE
    {
        return stereographic(d, plane, byDirection);
    }
    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE
    {
        d = stereographicDirection(plane);
        return std::isfinite(d[2]) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
    }
};

//! Longitude and latitude of an image whose equator is horizontal, or (LATLON) vertical: the same with x and y exchanged.
class LongitudeLens : public PlaneLens
{
public:
    LongitudeLens(const LensSpec& spec, int longitude) : PlaneLens(spec), lon_(longitude), lat_(1 - longitude) {}

private:
    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d*) const CV_OVERRIDE
    {
        const double x = d[lon_], y = d[lat_], z = d[2], h2 = x*x + z*z, h = std::sqrt(h2), n2 = h2 + y*y;
        plane[lon_] = std::atan2(x, z);
        plane[lat_] = std::atan2(y, h);
        if (byDirection)
        {
            Matx23d& J = *byDirection = Matx23d::zeros();
            J(lon_, lon_) = z/h2;
            J(lon_, 2) = -x/h2;
            J(lat_, lon_) = -y*x/(h*n2);
            J(lat_, lat_) = h/n2;
            J(lat_, 2) = -y*z/(h*n2);
        }
        return h > 0 && std::abs(plane[lon_]) < CV_PI ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
    }

    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE
    {
        const double lon = plane[lon_], lat = plane[lat_];
        d[lon_] = std::cos(lat)*std::sin(lon);
        d[lat_] = std::sin(lat);
        d[2] = std::cos(lat)*std::cos(lon);
        return std::abs(lon) < CV_PI && std::abs(lat) < 0.5*CV_PI ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
    }

    const int lon_, lat_;
};

} // namespace

Ptr<Lens> makeStereographicLens(const LensSpec& spec) { return makePtr<StereographicLens>(spec); }
Ptr<Lens> makeLonLatLens(const LensSpec& spec) { return makePtr<LongitudeLens>(spec, 0); }
Ptr<Lens> makeLatLonLens(const LensSpec& spec) { return makePtr<LongitudeLens>(spec, 1); }

}} // namespace
