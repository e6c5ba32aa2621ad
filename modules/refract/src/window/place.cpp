// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/place.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

namespace {

const double MAX_TRIAL_WEDGE = 1;       // radians: GlassWindow::check() refuses 90 degrees
const double MAX_TRIAL_BEND = 0.5;      // of a radius that a bent pane may be away, of 1

Vec3d across(const Vec3d& v, const Vec3d& axis) { return v - v.dot(axis)*axis; }

double angleBetween(const Vec3d& a, const Vec3d& b) { return std::atan2(norm(a.cross(b)), a.dot(b)); }

//! Of a point of a tube's axis only what is across the axis counts.
double distanceFromCenter(const WindowLayout& at, const double* p)
{
    const Vec3d center(p + at.normal);
    return norm(at.shape == WINDOW_TUBE ? across(center, normalize(Vec3d(p + at.axis))) : center);
}

bool isBeforeSurface(const WindowLayout& at, const double* p)
{
    if (hasCenter(at.shape))
        return distanceFromCenter(at, p) < p[at.distance];
    double away = p[at.distance];
    for (int i = at.thickness; i < at.thickness + at.layers; i++)
        away += p[i];
    const bool isBentALittle = at.shape != WINDOW_BENT || std::abs(p[at.curvature])*away < MAX_TRIAL_BEND;
    return p[at.normal + 2] > 0 && p[at.distance] >= 0 && isBentALittle;
}

} // namespace

bool hasCenter(int shape) { return shape == WINDOW_DOME || shape == WINDOW_TUBE; }

double distanceToSurface(const GlassWindow& window)
{
    if (!hasCenter(window.shape))
        return window.distance;
    return window.radius - distanceFromCenter(windowLayout(window), windowParameters(window).data());
}

bool isPossible(const WindowLayout& at, const double* p)
{
    double wedge = 0;
    for (int i = at.wedge; i < at.curvature; i++)
        wedge += std::abs(p[i]);
    if (!(wedge < MAX_TRIAL_WEDGE) || !isBeforeSurface(at, p))
        return false;
    for (int i = at.media; i < at.count; i++)
        if (!(p[i] <= upperBound(kindOf(at, i))))
            return false;
    for (int i = at.thickness; i < at.thickness + at.layers; i++)
        if (!(p[i] > 0))                // faces that meet before a camera
            return false;
    return true;
}

WindowPlace placeOf(const GlassWindow& window) { return { window.normal, window.center, window.axis }; }

GlassWindow withPlace(GlassWindow window, const WindowPlace& place)
{
    window.normal = place.normal;
    window.center = place.center;
    window.axis = place.axis;
    return window;
}

std::vector<WindowPlace> placesAround(const GlassWindow& window, double tilt, int count, double first)
{
    std::vector<WindowPlace> places;
    // A tube's center moves across its axis.
    const bool isTube = window.shape == WINDOW_TUBE;
    const Vec3d u = isTube ? normalize(across(std::abs(window.axis[0]) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0), window.axis))
                           : Vec3d(1, 0, 0);
    const Vec3d v = isTube ? window.axis.cross(u) : Vec3d(0, 1, 0);
    const double sine = std::sin(tilt);
    for (int i = 0; i < count; i++)
    {
        const double azimuth = (i + first)*2*CV_PI/count;
        const Vec3d away = sine*(std::cos(azimuth)*u + std::sin(azimuth)*v);
        places.push_back(placeOf(window));
        (hasCenter(window.shape) ? places.back().center : places.back().normal) =
            hasCenter(window.shape) ? window.radius*away : away + Vec3d(0, 0, std::cos(tilt));
    }
    for (double side : { -1., 1. })
        if (window.shape == WINDOW_DOME && tilt > 0)
        {
            places.push_back(placeOf(window));
            places.back().center = Vec3d(0, 0, side*sine*window.radius);
        }
    return places;
}

std::vector<WindowPlace> mirroredPlaces(const GlassWindow& window)
{
    std::vector<WindowPlace> places(hasCenter(window.shape) ? 2 : 1, placeOf(window));
    Vec3d& place = hasCenter(window.shape) ? places[0].center : places[0].normal;
    place = Vec3d(-place[0], -place[1], place[2]);
    if (hasCenter(window.shape))
        places[1].center = -window.center;
    return places;
}

double angleBetweenPlaces(const GlassWindow& a, const GlassWindow& b)
{
    if (!hasCenter(a.shape))
        return angleBetween(a.normal, b.normal);
    if (a.shape == WINDOW_DOME)
        return norm(a.center - b.center)/a.radius;
    const double turned = angleBetween(a.axis, b.axis);
    return norm(across(a.center, a.axis) - across(b.center, b.axis))/a.radius + std::min(turned, CV_PI - turned);
}

}} // namespace
