// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_FISHEYE_HPP
#define OPENCV_REFRACT_KERNELS_FISHEYE_HPP

#include "fisheye_bend.hpp"
#include "kernels_angles.hpp"

/* cv::fisheye's lens model, see lens_fisheye.cpp. */

namespace cv { namespace refract { namespace {

bool projectFisheye(const FisheyeModel& model, int n, const double* px, const double* py, const double* pz,
                    double* u, double* v)
{
    const FisheyeModel m = model;
    Answers answers;
    for (int i = 0; i < n; i += LANES)
    {
        const Lanes X = load(px, i, n), Y = load(py, i, n), r = sqrt(X*X + Y*Y), theta = angleOf(load(pz, i, n), r);
        Lanes factor, slope;
        bendFactor(m, theta*theta, factor, slope);
        const Lanes scale = theta*factor/larger(r, all(1e-300)), x = X*scale, y = Y*scale;
        const Mask good = theta < m.thetaMax;
        store(answers.where(good, m.fx*(x + m.alpha*y) + m.cx), u, i, n);
        store(m.fy*y + m.cy, v, i, n);
    }
    return answers.complete();
}

//! A search for the angle theta that is bent to |(xd, yd)|.
struct AngleSearch
{
    Lanes xd, yd, target, theta, slope, move;
};

/* Newton from a polynomial's guess; only a root in the middle of the domain is accepted here, as for OpenCV's model. */
bool unprojectFisheye(const FisheyeModel& model, int n, const double* pu, const double* pv,
                      double* px, double* py, double* pz)
{
    const FisheyeModel m = model;
    const double ENOUGH = 1e-8, REGULAR = 1e-3, fx = 1/m.fx, fy = 1/m.fy;   // the error is the square of the last move
    const int STEPS = 8;
    Answers answers;
    AngleSearch search[GROUP];
    for (int begin = 0; begin < n; begin += GROUP*LANES)
    {
        const int size = groupSize(begin, n);
        for (int g = 0; g < size; ++g)
        {
            AngleSearch& a = search[g];
            a.yd = (load(pv, begin + g*LANES, n) - m.cy)*fy;
            a.xd = (load(pu, begin + g*LANES, n) - m.cx)*fx - m.alpha*a.yd;
            const Lanes target2 = a.xd*a.xd + a.yd*a.yd, series = 1 + target2*polynomial(m.inverse, target2);
            a.target = sqrt(target2);
            a.theta = a.target*select((series > 0.5) & (series < 2), series, all(1));
        }
        bool more = true;
        for (int k = 0; k < STEPS && more; ++k)
        {
            more = false;
            for (int g = 0; g < size; ++g)
            {
                AngleSearch& a = search[g];
                Lanes factor;
                bendFactor(m, a.theta*a.theta, factor, a.slope);
                a.move = (a.target - a.theta*factor)*roughInverse(a.slope);
                a.theta += a.move;
                more = more || any(absolute(a.move) > ENOUGH);
            }
        }
        for (int g = 0; g < size; ++g)
        {
            const AngleSearch& a = search[g];
            const Mask good = (absolute(a.move) <= ENOUGH) & (a.theta >= 0) & (a.theta < m.thetaMax) & (a.slope > REGULAR);
            Lanes sine, cosine;
            sineCosine(a.theta, sine, cosine);
            const Lanes scale = select(a.target > 0, sine/larger(a.target, all(1e-300)), all(1));
            store(answers.where(good, a.xd*scale), px, begin + g*LANES, n);
            store(a.yd*scale, py, begin + g*LANES, n);
            store(cosine, pz, begin + g*LANES, n);
        }
    }
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_FISHEYE_HPP
