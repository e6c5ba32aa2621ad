// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/curved_path.hpp"
#include "window/curved.hpp"
#include "window/dome.hpp"

/* A tube's axis a leaves k = n w.a the same in all media. Across the axis a ray is one through a dome's cross-section whose media
have the indices m_i = sqrt(n_i^2 - k^2), and along it goes k/m_i times its length there. With the rarest medium's m and k = t m,
the point that the ray has reached along the axis,

    z(t) = sum k/m_i (length in the cross-section),

grows with t: of all ways across, light takes the one of least sum of m_i times length, L(k), and each of these sums is concave in
k; so L is, and z = -dL/dk. It is z = 0 for t = 0, and has no limit unless the cross-section loses its light.

Where it loses some, light may come by other ways across, too, by the centre (DomeWay), for some range of k and not for k = 0. Along
these z(t) need not grow: where it passes z shows at some values of t. */

namespace cv { namespace refract {

namespace {

class Section
{
public:
    Section(const CurvedFaces& window, const Vec3d& X, double w) : window_(window), across_(X[0], X[1], 0), weight_(w)
    {
        rarest_ = window.inner;
        for (int k = 0; k < window.count; k++)
            rarest_ = std::min(rarest_, window.faces[k].after);
        dome_ = Dome();
        dome_.center[0] = window.center[0];
        dome_.center[1] = window.center[1];
        spheres_.resize(window.count);
        dome_.faces = spheres_.data();
        dome_.count = window.count;
    }

    /** The direction across of a ray whose rarest medium has the index m across and k along, with k for its third component.
    @param way DOME_WAYS: that of the least sum, else the one to take */
    uchar direction(double m, double k, Vec3d& d, DomeWay way = DOME_WAYS)
    {
        const auto across = [&](double index) { return std::sqrt((index - rarest_)*(index + rarest_) + m*m); };
        double before = dome_.inner = across(window_.inner);
        for (int i = 0; i < window_.count; i++)
        {
            const double after = across(window_.faces[i].after), curvature = window_.faces[i].curvature;
            spheres_[i] = { 1/curvature, curvature, before*before, after*after, after, 1/(before*after) };
            before = after;
        }
        dome_.outer = before;
        Vec3d there;
        uchar status = REFRACT_OK;
        if (way == DOME_WAYS)
            status = findDomePath(dome_, across_, weight_, there);
        else if (!findDomeWay(dome_, across_, weight_, way, there))
            status = REFRACT_TOTAL_REFLECTION;
        d = dome_.inner*normalize(there) + Vec3d(0, 0, k);
        return status;
    }

    //! z(t) and the direction at the camera, of a finite point.
    uchar follow(double t, Vec3d& d, double& z, DomeWay way = DOME_WAYS)
    {
        const double m = rarest_/std::sqrt(1 + t*t);
        uchar status = direction(m, t*m, d, way);
        if (status != REFRACT_OK)
            return status;
        Vec3d P, p = d;
        status = traceCurved(window_, P, p);
        const double s = (across_/weight_ - P).dot(Vec3d(p[0], p[1], 0))/(p[0]*p[0] + p[1]*p[1]);
        z = P[2] + s*p[2];
        return status;
    }

    double rarest() const { return rarest_; }

private:
    const CurvedFaces& window_;
    Vec3d across_;
    double weight_, rarest_;
    std::vector<Sphere> spheres_;
    Dome dome_;
};

//! Of an infinitely far point, with z >= 0, k is known.
uchar followInfinity(const CurvedFaces& window, const Vec3d& X, Vec3d& direction)
{
    Section section(window, X, 0);
    const double length = norm(X), m = window.outer*std::sqrt(X[0]*X[0] + X[1]*X[1])/length;
    const double rarest = section.rarest(), m2 = m*m + (rarest - window.outer)*(rarest + window.outer);
    return m2 > 0 ? section.direction(std::sqrt(m2), window.outer*X[2]/length, direction) : (uchar)REFRACT_TOTAL_REFLECTION;
}

/** t where z(t) is z > 0, between secants and halves.
@param sides directions next to it, of less and of more */
uchar solveAlong(Section& section, double straight, double z, Vec3d (&sides)[2], Vec3d& direction)
{
    const int STEPS = 300;
    const double HUGE_T = 1e150, ROUNDING = 4*DBL_EPSILON;
    double t[2] = { 0, straight }, reached[2] = { 0, 0 }, here = 0;
    uchar beyond = section.follow(t[1], sides[1], reached[1]);      // of t[1]: why it has no light
    while (beyond == REFRACT_OK && reached[1] < z && t[1] < HUGE_T)
    {
        t[0] = t[1];
        reached[0] = reached[1];
        sides[0] = sides[1];
        beyond = section.follow(t[1] *= 2, sides[1], reached[1]);
    }
    direction = sides[1];
    here = reached[1];
    uchar status = beyond;
    for (int k = 0; k < STEPS && t[1] - t[0] > ROUNDING*t[1] && !(status == REFRACT_OK && std::abs(here - z) <= ROUNDING*z); k++)
    {
        const double secant = t[0] + (t[1] - t[0])*(z - reached[0])/(reached[1] - reached[0]);
        const bool isGood = beyond == REFRACT_OK && k % 3 < 2 && secant > t[0] && secant < t[1];
        const double next = isGood ? secant : 0.5*(t[0] + t[1]);
        status = section.follow(next, direction, here);
        const int side = status == REFRACT_OK && here < z ? 0 : 1;
        t[side] = next;
        reached[side] = here;
        sides[side] = direction;
        if (side == 1)
            beyond = status;
    }
    return status == REFRACT_OK ? status : beyond;
}

//! One kind of way across, followed along the axis.
class WayAlong
{
public:
    WayAlong(const CurvedFaces& window, const Vec3d& X, double w, DomeWay way)
        : window_(window), section_(window, X, w), X_(X), w_(w), way_(way) {}

    //! Whether a path of this kind comes from the point.
    bool find(Vec3d& direction)
    {
        const int STEPS = 24;
        const double FARTHER = 8;
        Place last = at(0);
        const auto passes = [&](double t)
        {
            const Place next = at(t);
            const bool isFound = last.isLit != next.isLit ? isBetween(last.isLit ? last : next, edge(last, next), direction)
                                                          : next.isLit && isBetween(last, next, direction);
            last = next;
            return isFound;
        };
        for (int k = 1; k < STEPS; k++)
            if (passes(std::tan(0.5*CV_PI*k/STEPS)))
                return true;
        for (int k = 0; k < STEPS && last.isLit && last.beyond < 0; k++)
            if (passes(FARTHER*last.t))
                return true;
        return false;
    }

private:
    struct Place
    {
        double t, beyond;       //!< of the point's z
        bool isLit;
        Vec3d direction;
    };

    Place at(double t)
    {
        Place place;
        double z = 0;
        place.t = t;
        place.isLit = section_.follow(t, place.direction, z, way_) == REFRACT_OK;
        place.beyond = z - X_[2]/w_;
        return place;
    }

    //! The last place with light, of two of which one has some.
    Place edge(Place a, Place b)
    {
        const int HALVES = 40;
        for (int k = 0; k < HALVES; k++)
        {
            const Place middle = at(0.5*(a.t + b.t));
            (middle.isLit == a.isLit ? a : b) = middle;
        }
        return a.isLit ? a : b;
    }

    //! Between two places with light: regula falsi, the end that stays having half its weight (Illinois).
    bool isBetween(Place a, Place b, Vec3d& direction)
    {
        const int STEPS = 60;
        if (!(a.beyond*b.beyond <= 0))
            return false;
        for (int k = 0; k < STEPS; k++)
        {
            const double part = k % 4 < 3 ? a.beyond/(a.beyond - b.beyond) : 0.5;
            const Place middle = at(a.t + part*(b.t - a.t));
            if (!middle.isLit)
                return false;
            if (doesReach(window_, X_, w_, direction = middle.direction))
                break;
            if ((middle.beyond < 0) == (b.beyond < 0))
                a.beyond /= 2;
            else
                a = b;
            b = middle;
        }
        approachPoint(window_, X_, w_, direction);
        return doesReach(window_, X_, w_, direction);
    }

    const CurvedFaces& window_;
    Section section_;
    Vec3d X_;
    double w_;
    DomeWay way_;
};

} // namespace

uchar findTubePath(const CurvedFaces& window, const Vec3d& given, double w, Vec3d& direction)
{
    const Vec3d X(given[0], given[1], std::abs(given[2]));
    // Behind a caustic the section has several ways, and where the one that it takes ends, z(t) jumps: steps from there may arrive.
    Vec3d starts[2] = { X, X };
    uchar status;
    if (w == 0)
        status = followInfinity(window, X, direction);
    else
    {
        Section section(window, X, w);
        double z = 0;
        status = section.follow(0, direction, z);
        starts[0] = direction;
        const double straight = X[2]/std::sqrt(X[0]*X[0] + X[1]*X[1]);
        if (status == REFRACT_OK && straight > 0)
            status = solveAlong(section, straight, X[2]/w, starts, direction);
    }
    bool isFound = status == REFRACT_OK && doesReach(window, X, w, direction);
    for (Vec3d start : { starts[0], starts[1], X })
    {
        if (isFound)
            break;
        approachPoint(window, X, w, start);
        isFound = doesReach(window, X, w, direction = start);
    }
    for (int way = 0; way < DOME_WAYS && w > 0 && !isFound; way++)
        isFound = WayAlong(window, X, w, (DomeWay)way).find(direction);
    if (given[2] < 0)
        direction[2] = -direction[2];
    if (isFound)
        return REFRACT_OK;
    return status != REFRACT_OK ? status : (uchar)REFRACT_NOT_CONVERGED;
}

}} // namespace
