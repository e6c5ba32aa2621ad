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
k; so L is, and z = -dL/dk. It is z = 0 for t = 0, and has no limit unless the cross-section loses its light. */

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

    //! The direction across of a ray whose rarest medium has the index m across and k along, with k for its third component.
    uchar direction(double m, double k, Vec3d& d)
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
        const uchar status = findDomePath(dome_, across_, weight_, there);
        d = dome_.inner*normalize(there) + Vec3d(0, 0, k);
        return status;
    }

    //! z(t) and the direction at the camera, of a finite point.
    uchar follow(double t, Vec3d& d, double& z)
    {
        const double m = rarest_/std::sqrt(1 + t*t);
        uchar status = direction(m, t*m, d);
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
        if (status == REFRACT_OK && X[2] > 0)
            status = solveAlong(section, X[2]/std::sqrt(X[0]*X[0] + X[1]*X[1]), X[2]/w, starts, direction);
    }
    bool isFound = status == REFRACT_OK && doesReach(window, X, w, direction);
    for (Vec3d start : { starts[0], starts[1], X })
    {
        if (isFound)
            break;
        approachPoint(window, X, w, start);
        isFound = doesReach(window, X, w, direction = start);
    }
    if (given[2] < 0)
        direction[2] = -direction[2];
    if (isFound)
        return REFRACT_OK;
    return status != REFRACT_OK ? status : (uchar)REFRACT_NOT_CONVERGED;
}

}} // namespace
