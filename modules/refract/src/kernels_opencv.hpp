// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_OPENCV_HPP
#define OPENCV_REFRACT_KERNELS_OPENCV_HPP

#include "distortion.hpp"
#include "lanes.hpp"

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

//! A search for the undistorted point of (xd, yd).
struct PlaneSearch
{
    Lanes xd, yd, x, y;
    Lanes xx, xy, yx, yy, inverse;      //!< the Jacobian of the last Newton step, 1/determinant
    Lanes move2;                        //!< square of that step
    Mask unfinished;                    //!< more than rounding may be left
    Mask inFront;                       //!< of the tilted sensor
};

//! Goes to where the distorted point would be right, were the map linear. Returns the square of the step.
inline Lanes correct(PlaneSearch& p, Lanes xd, Lanes yd)
{
    const Lanes ex = p.xd - xd, ey = p.yd - yd;
    const Lanes dx = (p.yy*ex - p.xy*ey)*p.inverse, dy = (p.xx*ey - p.yx*ex)*p.inverse;
    p.x += dx;
    p.y += dy;
    return dx*dx + dy*dy;
}

//! Leaves an error of the step's square times the curvature, which is known in the image (OpenCVModel::near2).
inline void newtonStep(const OpenCVModel& m, PlaneSearch& p)
{
    const Distorted<Lanes> d = distort(m, p.x, p.y);
    p.xx = d.xx;
    p.xy = d.xy;
    p.yx = d.yx;
    p.yy = d.yy;
    p.inverse = roughInverse(d.determinant());
    p.move2 = correct(p, d.x, d.y);
    p.unfinished = (p.move2 > m.near2) | (p.x*p.x + p.y*p.y > m.sNear);
}

//! A step with the Jacobian of the last Newton step. It leaves an error of the order of the product of both steps.
inline void chordStep(const OpenCVModel& m, PlaneSearch& p)
{
    const double ENOUGH2 = 1e-30;
    const Radial<Lanes> radial(m, p.x*p.x + p.y*p.y);
    Lanes xd, yd;
    displace(m, radial.s, radial.F + tangential(m, p.x, p.y), p.x, p.y, xd, yd);
    p.unfinished = p.move2*correct(p, xd, yd) > ENOUGH2;
}

/* Newton in the plane, from a start that in the image is so good that the first step is the last. Only a root in the
middle of the domain is accepted here: at its edge, where the Jacobian is nearly singular, the safeguarded search of
lens_opencv.cpp knows better. */
bool unprojectOpenCV(const OpenCVModel& model, int n, const double* pu, const double* pv, double* px, double* py, double* pz)
{
    const OpenCVModel m = model;
    const double SINGULAR = 1e3, fx = 1/m.fx, fy = 1/m.fy;
    const int TURNS = 4, CHORDS = 3;
    Answers answers;
    eachGroup<PlaneSearch>(n, [&](Group<PlaneSearch>& group)
    {
        const auto unfinished = [&] { return group.some([&](const PlaneSearch& p) { return p.unfinished; }); };
        group.each([&](PlaneSearch& p, Part at)
        {
            p.xd = (load(pu, at) - m.cx)*fx;
            p.yd = (load(pv, at) - m.cy)*fy;
            p.inFront = m.tilted ? homography(m.untilt, p.xd, p.yd) > 0 : p.xd == p.xd;
            guess(m, p.xd, p.yd, all(0), all(0), p.x, p.y);
        });
        for (int k = 0; k < m.shifts; ++k)
            group.each([&](PlaneSearch& p, Part) { shift(m, p.xd, p.yd, p.x, p.y); });
        bool more = true;
        for (int k = 0; k < TURNS && more; ++k)
        {
            group.each([&](PlaneSearch& p, Part) { newtonStep(m, p); });
            more = unfinished();
            for (int chord = 0; chord < CHORDS && more; ++chord)
            {
                group.each([&](PlaneSearch& p, Part) { chordStep(m, p); });
                more = unfinished();
            }
        }
        group.each([&](PlaneSearch& p, Part at)
        {
            const Lanes s = p.x*p.x + p.y*p.y, z = inverseSqrt(1 + s);
            const Mask good = p.inFront & isNot(p.unfinished) & (s < m.sMax) & (p.inverse > 0) & (p.inverse < SINGULAR);
            store(answers.where(good, p.x*z), px, at);
            store(p.y*z, py, at);
            store(z, pz, at);
        });
    });
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_OPENCV_HPP
