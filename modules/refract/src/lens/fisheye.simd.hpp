// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FISHEYE_SIMD_HPP
#define OPENCV_REFRACT_FISHEYE_SIMD_HPP

#include "lens/fisheye_model.hpp"
#include "simd/angles.hpp"
#include "simd/vectors.hpp"

/* cv::fisheye's lens model, see lens_fisheye.cpp. */

namespace cv { namespace refract { namespace {

//! The camera's own place has none, though its angle would be 0.
inline Mask isDirection(Lanes r, Lanes Z) { return larger(r, absolute(Z)) > 0; }

bool projectFisheye(const FisheyeModel& model, int n, const double* px, const double* py, const double* pz,
                    double* u, double* v)
{
    const FisheyeModel m = model;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes X = load(px, at), Y = load(py, at), Z = load(pz, at), r = sqrt(X*X + Y*Y), theta = angleOf(Z, r);
        Lanes factor, slope;
        bendFactor(m, theta*theta, factor, slope);
        const Lanes scale = theta*factor/larger(r, all(1e-300)), x = X*scale, y = Y*scale;
        const Mask good = (theta < m.thetaMax) & isDirection(r, Z);
        store(answers.where(good, m.fx*(x + m.alpha*y) + m.cx), u, at);
        store(m.fy*y + m.cy, v, at);
    });
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
    eachGroup<AngleSearch>(n, [&](Group<AngleSearch>& group)
    {
        group.each([&](AngleSearch& a, Part at)
        {
            a.yd = (load(pv, at) - m.cy)*fy;
            a.xd = (load(pu, at) - m.cx)*fx - m.alpha*a.yd;
            const Lanes target2 = a.xd*a.xd + a.yd*a.yd;
            a.target = sqrt(target2);
            a.theta = a.target*guessRatio(m.inverse, target2);
        });
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            group.each([&](AngleSearch& a, Part)
            {
                Lanes factor;
                bendFactor(m, a.theta*a.theta, factor, a.slope);
                a.move = (a.target - a.theta*factor)*roughInverse(a.slope);
                a.theta += a.move;
            });
            more = group.some([&](const AngleSearch& a) { return absolute(a.move) > ENOUGH; });
        }
        group.each([&](AngleSearch& a, Part at)
        {
            const Mask good = (absolute(a.move) <= ENOUGH) & (a.theta >= 0) & (a.theta < m.thetaMax) & (a.slope > REGULAR);
            Lanes sine, cosine;
            sineCosine(a.theta, sine, cosine);
            const Lanes scale = select(a.target > 0, sine/larger(a.target, all(1e-300)), all(1));
            store(answers.where(good, a.xd*scale), px, at);
            store(a.yd*scale, py, at);
            store(cosine, pz, at);
        });
    });
    return answers.complete();
}

/* With e = (X, Y)/r: d(x, y) = theta_d/r (I - e e^T) + e theta_d' dtheta, dtheta = (Z e, -r)/|d|^2. On the axis theta_d/r
and theta_d' Z/|d|^2 are both 1/Z and e drops out, so it is 0 there and where r is too small for a number. */
bool projectJacobianFisheye(const FisheyeModel& model, int n, const double* px, const double* py, const double* pz,
                            double* u, double* v, const Columns& byDirection, const Columns& byParameters)
{
    const FisheyeModel m = model;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes X = load(px, at), Y = load(py, at), Z = load(pz, at), r2 = X*X + Y*Y, r = sqrt(r2);
        const Lanes theta = angleOf(Z, r), inverseR = 1/larger(r, all(1e-300)), inverseL2 = 1/(r2 + Z*Z);
        Lanes factor, slope;
        bendFactor(m, theta*theta, factor, slope);
        const Lanes thetaD = theta*factor, side = select(r > 0, thetaD*inverseR, 1/Z), along = slope*Z*inverseL2;
        const Mask beside = r > 0;
        const Lanes ex = select(beside, X*inverseR, all(0)), ey = select(beside, Y*inverseR, all(0));
        const Lanes x = thetaD*(ex + m.alpha*ey), y = thetaD*ey;
        store(answers.where((theta < m.thetaMax) & isDirection(r, Z), m.fx*x + m.cx), u, at);
        store(m.fy*y + m.cy, v, at);
        const Lanes xx = side + (along - side)*ex*ex, xy = (along - side)*ex*ey, yy = side + (along - side)*ey*ey;
        const Lanes back = -slope*r*inverseL2, xz = back*ex, yz = back*ey;
        storeAt(m.fx*(xx + m.alpha*xy), byDirection, 0, 0, at);
        storeAt(m.fx*(xy + m.alpha*yy), byDirection, 0, 1, at);
        storeAt(m.fx*(xz + m.alpha*yz), byDirection, 0, 2, at);
        storeAt(m.fy*xy, byDirection, 1, 0, at);
        storeAt(m.fy*yy, byDirection, 1, 1, at);
        storeAt(m.fy*yz, byDirection, 1, 2, at);
        if (!byParameters.data)
            return;
        storeAt(x, byParameters, 0, 0, at);
        storeAt(all(0), byParameters, 1, 0, at);
        storeAt(all(0), byParameters, 0, 1, at);
        storeAt(y, byParameters, 1, 1, at);
        for (int row = 0; row < 2; row++)
            for (int c = 0; c < 2; c++)
                storeAt(all(row == c), byParameters, row, 2 + c, at);
        Lanes power = theta;
        for (int c = 0; c < 4; c++)
        {
            power *= theta*theta;
            storeAt(m.fx*power*(ex + m.alpha*ey), byParameters, 0, 4 + c, at);
            storeAt(m.fy*power*ey, byParameters, 1, 4 + c, at);
        }
    });
    return answers.complete();
}

constexpr LensKernels<FisheyeModel> fisheyeTable = { projectFisheye, unprojectFisheye, projectJacobianFisheye };

}}} // namespace

#endif // OPENCV_REFRACT_FISHEYE_SIMD_HPP
