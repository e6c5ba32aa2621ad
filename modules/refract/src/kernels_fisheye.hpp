// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_FISHEYE_HPP
#define OPENCV_REFRACT_KERNELS_FISHEYE_HPP

#include "fisheye_bend.hpp"
#include "kernels_angles.hpp"

/* cv::fisheye's lens model, see lens_fisheye.cpp. */

namespace cv { namespace refract { namespace {

bool projectFisheye(const FisheyeModel& m, int n, const double* px, const double* py, const double* pz,
                    double* u, double* v)
{
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes X = load(px, i, n), Y = load(py, i, n), r = sqrt(X*X + Y*Y), theta = angleOf(load(pz, i, n), r);
        Lanes factor, slope;
        bendFactor(m, theta*theta, factor, slope);
        const Lanes scale = theta*factor/larger(r, all(1e-300)), x = X*scale, y = Y*scale;
        const Mask good = theta < m.thetaMax;
        bad |= ~good;
        store(select(good, m.fx*(x + m.alpha*y) + m.cx, noAnswer()), u, i, n);
        store(m.fy*y + m.cy, v, i, n);
    }
    return !any(bad);
}

/* Newton from the inverse series; only a root in the middle of the domain is accepted here, as for OpenCV's model. */
bool unprojectFisheye(const FisheyeModel& m, int n, const double* pu, const double* pv, double* px, double* py, double* pz)
{
    const double ENOUGH = 1e-8, REGULAR = 1e-3;
    const int STEPS = 8;
    Mask bad = all(0) != 0;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes yd = (load(pv, i, n) - m.cy)/m.fy, xd = (load(pu, i, n) - m.cx)/m.fx - m.alpha*yd;
        const Lanes target2 = xd*xd + yd*yd, target = sqrt(target2);
        const double* b = m.inverse;
        const Lanes series = 1 + target2*(b[0] + target2*(b[1] + target2*(b[2] + target2*b[3])));
        Lanes theta = target*select((series > 0.5) & (series < 2), series, all(1)), move = all(1), slope = move;
        for (int k = 0; k < STEPS && any(absolute(move) > ENOUGH); ++k)
        {
            Lanes factor;
            bendFactor(m, theta*theta, factor, slope);
            move = (target - theta*factor)/slope;
            theta += move;
        }
        const Mask good = (absolute(move) <= ENOUGH) & (theta >= 0) & (theta < m.thetaMax) & (slope > REGULAR);
        bad |= ~good;
        Lanes sine, cosine;
        sineCosine(theta, sine, cosine);
        const Lanes scale = select(target > 0, sine/larger(target, all(1e-300)), all(1));
        store(select(good, xd*scale, noAnswer()), px, i, n);
        store(yd*scale, py, i, n);
        store(cosine, pz, i, n);
    }
    return !any(bad);
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_FISHEYE_HPP
