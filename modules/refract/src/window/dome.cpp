// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/dome.hpp"

/* With e = |S|, alpha the angle at the camera from the radius through it outwards and l = n_0 e sin(alpha), the path is at

    phi(alpha) = alpha - asin(l/(n_0 r_0)) + sum over the layers of [asin(l/(n_i r_i-1)) - asin(l/(n_i r_i))]

about S where it comes to the radius of the last term, which is the point's. Each term is an angle that the path passes, and grows
with l: so does phi up to alpha = 90 degrees. Beyond, l falls. From phi(0) = 0 to phi(180 degrees) = 180 degrees there is a path to
every point, unless some l are too large to leave the dome: that is so only where a medium is rarer than the camera's. Then light that
goes by the centre may also cross the axis behind it, to points on its other side: phi is more than 180 degrees there. */

namespace cv { namespace refract {

std::vector<Sphere> spheresOf(const GlassWindow& window)
{
    std::vector<Sphere> faces;
    double radius = window.radius, before = window.innerIndex;
    for (size_t i = 0; i <= window.thickness.size(); i++)
    {
        const double after = i < window.index.size() ? window.index[i] : window.outerIndex;
        faces.push_back({ radius, 1/radius, before*before, after*after, after, 1/(before*after) });
        if (i < window.thickness.size())
            radius += window.thickness[i];
        before = after;
    }
    return faces;
}

namespace {

//! phi(alpha) of the points of one radius, and its derivative.
struct AngleAtCenter
{
    AngleAtCenter(const Dome& dome_, double inverseRadius) : dome(dome_), inverse(inverseRadius), e(norm(Vec3d(dome_.center))) {}

    void operator()(double alpha, double& phi, double& slope) const
    {
        const double l = dome.inner*e*std::sin(alpha);
        double byMoment = 0, n = dome.inner;
        phi = alpha;
        const auto add = [&](double sign, double u)
        {
            phi += sign*std::asin(std::min(l*u/n, 1.));
            byMoment += sign*u/std::sqrt(std::max(n*n - l*l*u*u, 0.));
        };
        for (int k = 0; k < dome.count; k++)
        {
            add(-1, dome.faces[k].inverse);
            n = dome.faces[k].after;
            add(1, dome.faces[k].inverse);
        }
        add(-1, inverse);
        slope = 1 + byMoment*dome.inner*e*std::cos(alpha);
    }
    double at(double alpha) const
    {
        double phi, slope;
        (*this)(alpha, phi, slope);
        return phi;
    }

    const Dome& dome;
    double inverse, e;
};

//! Newton's method between low, where phi is not larger, and high, where it is not smaller; or the other way round where phi falls.
double solveBetween(const AngleAtCenter& angle, double phi, double alpha, double low, double high, bool falls = false)
{
    const int STEPS = 200;
    const double FAR = 1e-9;        // radians: where light grazes the slope is infinite, and steps are short far from the root
    alpha = std::min(std::max(alpha, low), high);
    for (int k = 0; k < STEPS; k++)
    {
        double value, slope;
        angle(alpha, value, slope);
        ((value < phi) != falls ? low : high) = alpha;
        double next = alpha - (value - phi)/slope;
        const bool isStuck = std::abs(next - alpha) <= 1e-3*(high - low) && std::abs(value - phi) > FAR;
        if (!(next >= low && next <= high) || isStuck)
            next = 0.5*(low + high);
        const double step = std::abs(next - alpha);
        alpha = next;
        if (step <= DBL_EPSILON*alpha)
            break;
    }
    return alpha;
}

//! Between low, where phi falls, and high, where it grows: where it is least.
double leastBetween(const AngleAtCenter& angle, double low, double high)
{
    for (int k = 0; k < 60; k++)
    {
        const double middle = 0.5*(low + high);
        double phi, slope;
        angle(middle, phi, slope);
        (slope < 0 ? low : high) = middle;
    }
    return high;
}

//! Light that crosses the axis: between first, where phi is larger, and 180 degrees. NaN: there is none.
double solveAcross(const AngleAtCenter& angle, double phi, double first)
{
    if (!(angle.at(first) >= phi))
        return std::numeric_limits<double>::quiet_NaN();
    double far = first, near = CV_PI;
    for (double middle; (middle = 0.5*(far + near)) > far && middle < near;)
        (angle.at(middle) >= phi ? far : near) = middle;
    return far;
}

//! The largest moment l that leaves the dome, if it is less than light at the camera may have.
double mostMoment(const Dome& dome, double atCamera)
{
    double most = atCamera;
    for (int k = 0; k < dome.count; k++)
        most = std::min(most, dome.faces[k].after*dome.faces[k].radius);
    return most;
}

} // namespace

uchar findDomePath(const Dome& dome, const Vec3d& X, double w, Vec3d& direction)
{
    const Vec3d S(dome.center), b = X - w*S;
    if (!(norm(b) > w*dome.faces[dome.count - 1].radius))
        return REFRACT_BEHIND_WINDOW;
    const AngleAtCenter angle(dome, w/norm(b));
    direction = X;
    if (angle.e == 0)
        return REFRACT_OK;
    const Vec3d axis = -S/angle.e, across = X - axis.dot(X)*axis;
    const double away = norm(across), phi = std::atan2(away, axis.dot(b)), straight = std::atan2(away, axis.dot(X));
    const double most = mostMoment(dome, dome.inner*angle.e);
    double low = 0, high = CV_PI;
    if (most < dome.inner*angle.e)
    {
        const double last = std::asin(most/(dome.inner*angle.e));
        if (phi <= angle.at(last))
            high = last;
        else
        {
            low = leastBetween(angle, CV_PI - last, CV_PI);
            if (!(angle.at(low) <= phi))
            {
                const double crossing = solveAcross(angle, 2*CV_PI - phi, CV_PI - last);
                direction = std::cos(crossing)*axis - (away > 0 ? std::sin(crossing)/away : 0)*across;
                return std::isnan(crossing) ? REFRACT_TOTAL_REFLECTION : REFRACT_OK;
            }
        }
    }
    const double alpha = solveBetween(angle, phi, straight, low, high);
    direction = std::cos(alpha)*axis;
    if (away > 0)
        direction += std::sin(alpha)/away*across;
    return REFRACT_OK;
}

bool findDomeWay(const Dome& dome, const Vec3d& X, double w, DomeWay way, Vec3d& direction)
{
    const Vec3d S(dome.center), b = X - w*S;
    const AngleAtCenter angle(dome, w/norm(b));
    const double most = mostMoment(dome, dome.inner*angle.e);
    if (!(norm(b) > w*dome.faces[dome.count - 1].radius) || !(most < dome.inner*angle.e))
        return false;
    const Vec3d axis = -S/angle.e, across = X - axis.dot(X)*axis;
    const double away = norm(across), seen = std::atan2(away, axis.dot(b)), phi = way == ACROSS_AXIS ? 2*CV_PI - seen : seen;
    const double last = std::asin(most/(dome.inner*angle.e)), first = CV_PI - last;
    double low = way == OUTWARDS ? 0 : CV_PI, high = way == OUTWARDS ? last : CV_PI, value, slope;
    angle(CV_PI, value, slope);
    if (way == BY_CENTER_MORE || way == BY_CENTER_LESS)
    {
        if (!(slope > 0))                   // then phi falls to 180 degrees
            return false;
        low = leastBetween(angle, first, CV_PI);
    }
    const bool falls = way == ACROSS_AXIS || way == BY_CENTER_MORE;
    if (falls)
    {
        high = low;
        low = first;
    }
    const double atLow = angle.at(low), atHigh = angle.at(high);
    if (!(std::min(atLow, atHigh) <= phi && phi <= std::max(atLow, atHigh)))
        return false;
    const double alpha = solveBetween(angle, phi, 0.5*(low + high), low, high, falls);
    direction = std::cos(alpha)*axis;
    if (away > 0)
        direction += (way == ACROSS_AXIS ? -1 : 1)*std::sin(alpha)/away*across;
    return true;
}

}} // namespace
