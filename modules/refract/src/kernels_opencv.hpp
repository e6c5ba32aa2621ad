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
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes z = load(pz, i, n), inverse = 1/z, x = load(px, i, n)*inverse, y = load(py, i, n)*inverse;
        Distorted<Lanes> d = distort(m, x, y);
        Mask good = (z > 0) & (x*x + y*y < m.sMax) & (d.determinant() > 0);
        if (m.tilted)
            good &= homography(m.tilt, d.x, d.y) > 0;
        store(answers.where(good, m.fx*d.x + m.cx), u, i, n);
        store(m.fy*d.y + m.cy, v, i, n);
    }
    return answers.complete();
}

//! Where the search for the undistorted point begins: the radius by a polynomial, then what is not radial.
inline void firstGuess(const OpenCVModel& m, Lanes xd, Lanes yd, Lanes& x, Lanes& y)
{
    const Lanes sd = xd*xd + yd*yd, series = 1 + sd*polynomial(m.inverse, sd);
    const Lanes scale = select((series > 0.5) & (series < 2), series, all(1));
    x = xd*scale;
    y = yd*scale;
    const Radial<Lanes> radial(m, x*x + y*y);
    Lanes a, b;
    displace(m, radial, x, y, a, b);
    x -= (a - x*radial.F)*scale;
    y -= (b - y*radial.F)*scale;
}

//! A search for the undistorted point of (xd, yd).
struct PlaneSearch
{
    Lanes xd, yd, x, y;
    Lanes xx, xy, yx, yy, determinant;  //!< inverse of the Jacobian; the determinant of the Jacobian
    Lanes move2;                        //!< square of the step that was taken with the fresh Jacobian
    Mask inFront;                       //!< of the tilted sensor
};

//! Goes to where the distorted point would be right, were the map linear. Returns the square of the step.
inline Lanes correct(PlaneSearch& p, Lanes xd, Lanes yd)
{
    const Lanes ex = p.xd - xd, ey = p.yd - yd, dx = p.xx*ex + p.xy*ey, dy = p.yx*ex + p.yy*ey;
    p.x += dx;
    p.y += dy;
    return dx*dx + dy*dy;
}

inline void newtonStep(const OpenCVModel& m, PlaneSearch& p)
{
    const Distorted<Lanes> d = distort(m, p.x, p.y);
    p.determinant = d.determinant();
    const Lanes inverse = roughInverse(p.determinant);
    p.xx = d.yy*inverse;
    p.xy = -d.xy*inverse;
    p.yx = -d.yx*inverse;
    p.yy = d.xx*inverse;
    p.move2 = correct(p, d.x, d.y);
}

/** A step with the Jacobian of the last Newton step. It leaves an error of the order of the product of both steps.
@return square of that product */
inline Lanes chordStep(const OpenCVModel& m, PlaneSearch& p)
{
    Lanes xd, yd;
    displace(m, Radial<Lanes>(m, p.x*p.x + p.y*p.y), p.x, p.y, xd, yd);
    return p.move2*correct(p, xd, yd);
}

/* Newton in the plane. Only a root in the middle of the domain is accepted here: at its edge, where the Jacobian is nearly
singular, the safeguarded search of lens_opencv.cpp knows better. */
bool unprojectOpenCV(const OpenCVModel& model, int n, const double* pu, const double* pv, double* px, double* py, double* pz)
{
    const OpenCVModel m = model;
    const double ENOUGH = 1e-30, REGULAR = 1e-3, fx = 1/m.fx, fy = 1/m.fy;
    const int TURNS = 4, CHORDS = 3;
    Answers answers;
    PlaneSearch search[GROUP];
    for (int begin = 0; begin < n; begin += GROUP*LANES)
    {
        const int size = groupSize(begin, n);
        Lanes error[GROUP];
        for (int g = 0; g < size; ++g)
        {
            PlaneSearch& p = search[g];
            p.xd = (load(pu, begin + g*LANES, n) - m.cx)*fx;
            p.yd = (load(pv, begin + g*LANES, n) - m.cy)*fy;
            p.inFront = m.tilted ? homography(m.untilt, p.xd, p.yd) > 0 : p.xd == p.xd;
            firstGuess(m, p.xd, p.yd, p.x, p.y);
        }
        bool more = true;
        for (int k = 0; k < TURNS && more; ++k)
        {
            for (int g = 0; g < size; ++g)
                newtonStep(m, search[g]);
            for (int chord = 0; chord < CHORDS && more; ++chord)
            {
                more = false;
                for (int g = 0; g < size; ++g)
                {
                    error[g] = chordStep(m, search[g]);
                    more = more || any(error[g] > ENOUGH);
                }
            }
        }
        for (int g = 0; g < size; ++g)
        {
            const PlaneSearch& p = search[g];
            const Lanes s = p.x*p.x + p.y*p.y, z = inverseSqrt(1 + s);
            const Mask good = p.inFront & (error[g] <= ENOUGH) & (s < m.sMax) & (p.determinant > REGULAR);
            store(answers.where(good, p.x*z), px, begin + g*LANES, n);
            store(p.y*z, py, begin + g*LANES, n);
            store(z, pz, begin + g*LANES, n);
        }
    }
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_OPENCV_HPP
