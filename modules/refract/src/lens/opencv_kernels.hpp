// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_OPENCV_HPP
#define OPENCV_REFRACT_KERNELS_OPENCV_HPP

#include "lens/distortion.hpp"
#include "simd/lanes.hpp"

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
        for (int k = 1; k <= m.shifts; ++k)
            group.each([&](PlaneSearch& p, Part) { shift(m, k, p.xd, p.yd, p.x, p.y); });
        Answers found;
        bool more = true;
        for (int k = 0; k < STEPS && more; ++k)
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

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_OPENCV_HPP
