// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_OPENCV_SIMD_HPP
#define OPENCV_REFRACT_OPENCV_SIMD_HPP

#include "lens/opencv_model.hpp"
#include "simd/vectors.hpp"

/* OpenCV's lens model, see lens_opencv.cpp. */

namespace cv { namespace refract { namespace {

bool projectOpenCV(const OpenCVModel& model, int n, const double* px, const double* py, const double* pz,
                   double* u, double* v)
{
    const OpenCVModel m = model;    // a copy that no store can change stays in registers
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes z = load(pz, at), inverse = 1/z, x = load(px, at)*inverse, y = load(py, at)*inverse;
        Distorted<Lanes> d = distort(m, x, y);
        Mask good = (z > 0) & (x*x + y*y < m.sMax) & (d.determinant() > 0);
        if (m.tilted)
            good &= homography(m.tilt, d.x, d.y) > 0;
        store(answers.where(good, m.fx*d.x + m.cx), u, at);
        store(m.fy*d.y + m.cy, v, at);
    });
    return answers.complete();
}

//! The point (x, y) that is distorted to (xd, yd), as far as it is known.
struct PlaneSearch { Lanes xd, yd, x, y; };

inline PlaneSearch beginSearch(const OpenCVModel& m, Lanes u, Lanes v)
{
    PlaneSearch p;
    p.xd = u - m.cx;
    p.yd = v - m.cy;
    if (m.tilted)
    {
        const Mask inFront = homography(m.untilt, p.xd, p.yd) > 0;  // of the tilted sensor
        p.xd = select(inFront, p.xd, all(NAN));
    }
    else
    {
        p.xd *= m.untilt[0];
        p.yd *= m.untilt[4];
    }
    guess(m, p.xd, p.yd, p.x, p.y);
    return p;
}

/** A Newton step. It leaves an error of its square times the curvature, which is known in the image (OpenCVModel::near2). A
small step that makes up for a large difference is none: far out, where prism terms leave the Jacobian with one direction, both
products of a determinant may cancel.
@param regular where the lens is far from the edge of its domain
@return where more than rounding may be left */
inline Mask newtonStep(const OpenCVModel& m, PlaneSearch& p, Mask& regular)
{
    const double SINGULAR = 1e3, FAR2 = 1e-20, STEEP2 = 1e4;    // no Jacobian of an image is as steep
    const Distorted<Lanes> d = distort(m, p.x, p.y);
    const Lanes inverse = roughInverse(d.determinant()), ex = p.xd - d.x, ey = p.yd - d.y;
    const Lanes dx = (d.yy*ex - d.xy*ey)*inverse, dy = (d.xx*ey - d.yx*ex)*inverse;
    const Lanes change2 = dx*dx + dy*dy + (ex*ex + ey*ey)*(1/STEEP2);
    p.x += dx;
    p.y += dy;
    const Lanes s = p.x*p.x + p.y*p.y;
    regular = (s < m.sMax) & (inverse > 0) & (inverse < SINGULAR);
    return change2 > select(s > m.sNear, all(FAR2), all(m.near2));
}

/* Newton in the plane, from a start that in the image is so good that the first step is the last. Only a root in the
middle of the domain is accepted here: at its edge, where the Jacobian is nearly singular, the safeguarded search of
lens_opencv.cpp knows better. */
bool unprojectOpenCV(const OpenCVModel& model, int n, const double* u, const double* v, double* x, double* y, double* z)
{
    const OpenCVModel m = model;
    const int STEPS = 8;
    Answers answers;
    eachGroup<PlaneSearch>(n, [&](Group<PlaneSearch>& group)
    {
        group.each([&](PlaneSearch& p, Part at) { p = beginSearch(m, load(u, at), load(v, at)); });
        for (int k = 1; k <= m.shifts; k++)
            group.each([&](PlaneSearch& p, Part) { shift(m, k, p.xd, p.yd, p.x, p.y); });
        Answers found;
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            found = Answers();
            Mask unfinished = none();
            group.each([&](PlaneSearch& p, Part at)
            {
                Mask regular;
                const Mask open = newtonStep(m, p, regular);
                unfinished |= open;
                const Lanes inverse = inverseSqrt(1 + p.x*p.x + p.y*p.y);
                store(found.where(regular & isNot(open), p.x*inverse), x, at);
                store(p.y*inverse, y, at);
                store(inverse, z, at);
            });
            more = any(unfinished);
        }
        answers.add(found);
    });
    return answers.complete();
}

//! The sensor's tilt at a distorted point, and its linear map there.
struct Tilt
{
    Tilt(const OpenCVModel& m, Lanes xd, Lanes yd) : x(xd), y(yd), w(all(1)), xx(w), xy(all(0)), yx(xy), yy(w)
    {
        if (!m.tilted)
            return;
        w = homography(m.tilt, x, y);
        const Lanes inverse = 1/w;
        xx = (m.tilt[0] - x*m.tilt[6])*inverse;
        xy = (m.tilt[1] - x*m.tilt[7])*inverse;
        yx = (m.tilt[3] - y*m.tilt[6])*inverse;
        yy = (m.tilt[4] - y*m.tilt[7])*inverse;
    }
    Lanes x, y, w, xx, xy, yx, yy;
};

//! Derivatives by fx, fy, cx, cy and the coefficients as given.
template<typename At>
inline void byOpenCVParameters(const OpenCVModel& m, Lanes x, Lanes y, const Distorted<Lanes>& d, const Tilt& tilt,
                               const Columns& out, At at)
{
    const Radial<Lanes> radial(m, x*x + y*y);
    const Lanes s = radial.s, D = radial.inverseD, zero = all(0);
    storeAt(tilt.x, out, 0, 0, at);
    storeAt(zero, out, 1, 0, at);
    storeAt(zero, out, 0, 1, at);
    storeAt(tilt.y, out, 1, 1, at);
    for (int r = 0; r < 2; r++)
        for (int c = 0; c < 2; c++)
            storeAt(all(r == c), out, r, 2 + c, at);
    const auto put = [&](int c, Lanes dx, Lanes dy)
    {
        if (c >= m.given)
            return;
        storeAt(m.fx*(tilt.xx*dx + tilt.xy*dy), out, 0, 4 + c, at);
        storeAt(m.fy*(tilt.yx*dx + tilt.yy*dy), out, 1, 4 + c, at);
    };
    const int numerator[] = { K1, K2, K3 }, denominator[] = { K4, K5, K6 };
    Lanes power = s*D;
    for (int k = 0; k < 3; k++, power *= s)
    {
        put(numerator[k], x*power, y*power);
        const Lanes byD = -radial.F*power;
        put(denominator[k], x*byD, y*byD);
    }
    put(P1, 2*x*y, s + 2*y*y);
    put(P2, s + 2*x*x, 2*x*y);
    put(S1, s, zero);
    put(S2, s*s, zero);
    put(S3, zero, s);
    put(S4, zero, s*s);
    for (int c = TAUX; c < m.given; c++)
    {
        const double* T = m.dTilt[c - TAUX];
        const Lanes inverse = 1/tilt.w, dw = T[6]*d.x + T[7]*d.y + T[8];
        storeAt(m.fx*((T[0]*d.x + T[1]*d.y + T[2]) - tilt.x*dw)*inverse, out, 0, 4 + c, at);
        storeAt(m.fy*((T[3]*d.x + T[4]*d.y + T[5]) - tilt.y*dw)*inverse, out, 1, 4 + c, at);
    }
}

bool projectJacobianOpenCV(const OpenCVModel& model, int n, const double* px, const double* py, const double* pz,
                           double* u, double* v, const Columns& byDirection, const Columns& byParameters)
{
    const OpenCVModel m = model;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes z = load(pz, at), inverse = 1/z, x = load(px, at)*inverse, y = load(py, at)*inverse;
        const Distorted<Lanes> d = distort(m, x, y);
        const Tilt tilt(m, d.x, d.y);
        const Mask good = (z > 0) & (x*x + y*y < m.sMax) & (d.determinant() > 0) & (tilt.w > 0);
        store(answers.where(good, m.fx*tilt.x + m.cx), u, at);
        store(m.fy*tilt.y + m.cy, v, at);
        const Lanes fx = m.fx*inverse, fy = m.fy*inverse;
        const Lanes ux = fx*(tilt.xx*d.xx + tilt.xy*d.yx), uy = fx*(tilt.xx*d.xy + tilt.xy*d.yy);
        const Lanes vx = fy*(tilt.yx*d.xx + tilt.yy*d.yx), vy = fy*(tilt.yx*d.xy + tilt.yy*d.yy);
        storeAt(ux, byDirection, 0, 0, at);
        storeAt(uy, byDirection, 0, 1, at);
        storeAt(-(ux*x + uy*y), byDirection, 0, 2, at);
        storeAt(vx, byDirection, 1, 0, at);
        storeAt(vy, byDirection, 1, 1, at);
        storeAt(-(vx*x + vy*y), byDirection, 1, 2, at);
        if (byParameters.data)
            byOpenCVParameters(m, x, y, d, tilt, byParameters, at);
    });
    return answers.complete();
}

constexpr LensKernels<OpenCVModel> openCVTable = { projectOpenCV, unprojectOpenCV, projectJacobianOpenCV };

}}} // namespace

#endif // OPENCV_REFRACT_OPENCV_SIMD_HPP
