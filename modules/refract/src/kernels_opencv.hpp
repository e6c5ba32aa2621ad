// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_OPENCV_HPP
#define OPENCV_REFRACT_KERNELS_OPENCV_HPP

#include "distortion.hpp"
#include "lanes.hpp"

namespace cv { namespace refract { namespace {

bool projectOpenCV(const OpenCVModel& m, int n, const double* px, const double* py, const double* pz, double* u, double* v)
{
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes z = load(pz, i, n), inverse = 1/z, x = load(px, i, n)*inverse, y = load(py, i, n)*inverse;
        Distorted<Lanes> d = distort(m, x, y);
        Mask good = (z > 0) & (x*x + y*y < m.sMax) & (d.determinant() > 0);
        if (m.tilted)
            good &= homography(m.tilt, d.x, d.y) > 0;
        bad |= ~good;
        store(select(good, m.fx*d.x + m.cx, noAnswer()), u, i, n);
        store(m.fy*d.y + m.cy, v, i, n);
    }
    return !any(bad);
}

/* Newton in the plane from the inverse radial series. Only a root in the middle of the domain is accepted here: at its
edge, where the Jacobian is nearly singular, the safeguarded search of lens_opencv.cpp knows better. */
bool unprojectOpenCV(const OpenCVModel& m, int n, const double* pu, const double* pv, double* px, double* py, double* pz)
{
    const double ENOUGH = 1e-8, REGULAR = 1e-3;     // the error after a step is of the order of its square
    const int STEPS = 8;
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        Lanes xd = (load(pu, i, n) - m.cx)/m.fx, yd = (load(pv, i, n) - m.cy)/m.fy;
        Mask good = xd == xd;
        if (m.tilted)
            good &= homography(m.untilt, xd, yd) > 0;
        const Lanes sd = xd*xd + yd*yd;
        const double* b = m.inverse;
        const Lanes series = 1 + sd*(b[0] + sd*(b[1] + sd*(b[2] + sd*b[3])));
        const Lanes scale = select((series > 0.5) & (series < 2), series, all(1));
        Lanes x = xd*scale, y = yd*scale, move = all(1), determinant = move;
        for (int k = 0; k < STEPS && any(move > ENOUGH); ++k)
        {
            const Distorted<Lanes> d = distort(m, x, y);
            determinant = d.determinant();
            const Lanes ex = xd - d.x, ey = yd - d.y, inverse = 1/determinant;
            const Lanes stepX = (d.yy*ex - d.xy*ey)*inverse, stepY = (d.xx*ey - d.yx*ex)*inverse;
            x += stepX;
            y += stepY;
            move = absolute(stepX) + absolute(stepY);
        }
        const Lanes s = x*x + y*y, z = 1/sqrt(1 + s);
        good &= (move <= ENOUGH) & (s < m.sMax) & (determinant > REGULAR);
        bad |= ~good;
        store(select(good, x*z, noAnswer()), px, i, n);
        store(y*z, py, i, n);
        store(z, pz, i, n);
    }
    return !any(bad);
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_OPENCV_HPP
