// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_DERIVATIVES_HPP
#define OPENCV_REFRACT_KERNELS_DERIVATIVES_HPP

#include "lens/distortion.hpp"
#include "lens/fisheye_bend.hpp"
#include "simd/angles.hpp"

/* Derivatives: of the window's arrow by the point and by the window, of the lenses' by the direction and the lens. */

namespace cv { namespace refract { namespace {

template<typename At>
inline void storeAt(Lanes a, const Columns& columns, int row, int column, At at)
{
    store(a, columns.at(row, column), at);
}

struct Vector { Lanes x, y, z; };

template<typename At>
inline Vector loadRow(const Columns& columns, int row, At at)
{
    return { load(columns.at(row, 0), at), load(columns.at(row, 1), at), load(columns.at(row, 2), at) };
}
inline Lanes dot(const Vector& a, const Vector& b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
inline Lanes dot(const double* a, const Vector& b) { return a[0]*b.x + a[1]*b.y + a[2]*b.z; }

/* The direction is n + kappa r, r = X - U n, kappa = T_in / V; sum h_i T_i(p) = V with T_i = p/q_i gives by implicit
differentiation, with dT_i/dp = n_i^2/q_i^3, dT_i/dn_i = -p n_i/q_i^3, rho = p/V (regular on the axis) and
A = dT_in/dp / sum h_i dT_i/dp:

    d kappa/dU = -A rho/q_out          d kappa/dh_i = -A rho (1/q_i - 1/q_out)
    V d kappa/dV = A - kappa           d kappa/dn_i = A rho h_i n_i/q_i^3, for the inner medium less rho n_in/q_in^3 */
struct PathDerivative
{
    PathDerivative(const Stack& s, Lanes U, Lanes V2, Lanes ratio)
        : t2(V2*ratio*ratio), c2(1/(1 + t2)), rho(s.rarest*ratio*sqrt(c2)), rarest2(s.rarest*s.rarest),
          inverseIn(inverseQ(s.inner)), inverseOut(inverseQ(s.outer)), hOut(U - s.total)
    {
        Lanes sum = hOut*slope(s.outer, inverseOut);
        for (int k = 0; k < s.layers; ++k)
            sum += s.heights[k]*slope(s.indices[k], inverseQ(s.indices[k]));
        const Lanes A = slope(s.inner, inverseIn)/sum;
        kappa = rho*inverseIn;
        Arho = A*rho;
        byU = -Arho*inverseOut;
        bend = select(V2 > 0, (A - kappa)/V2, all(0));
    }
    Lanes inverseQ(double index) const
    {
        const double n2 = index*index;
        return inverseSqrt((n2 + (n2 - rarest2)*t2)*c2);
    }
    static Lanes slope(double index, Lanes inverse) { return (index*index)*inverse*inverse*inverse; }

    Lanes t2, c2, rho;
    double rarest2;
    Lanes inverseIn, inverseOut, hOut, kappa, Arho, byU, bend;     //!< bend: d kappa/dV / V
};

//! d kappa by every height and index; columns as Layers::parameterCount() orders them.
template<typename Put>
inline void mediaDerivatives(const Stack& s, const PathDerivative& d, const Put& put)
{
    for (int k = 0; k < s.layers; ++k)
    {
        const double index = s.indices[k];
        const Lanes inverse = d.inverseQ(index);
        put(3 + k, d.Arho*(d.inverseOut - inverse));
        if (k > 0)
            put(2 + s.layers + k, d.Arho*s.heights[k]*index*inverse*inverse*inverse);
    }
    const Lanes byInner = s.inner*d.inverseIn*d.inverseIn*d.inverseIn;
    put(2 + 2*s.layers, (d.Arho*s.heights[0] - d.rho)*byInner);
    put(3 + 2*s.layers, d.Arho*d.hOut*(s.outer*d.inverseOut*d.inverseOut*d.inverseOut));
}

/* Rows D by the direction -> by the point and by the window. With f = D.r and g = d kappa/dU f - kappa D.n the point's row
is kappa D + g n + bend f r, the unnormalised normal's (1 - kappa U) D + g X - U bend f r across n, any other f d kappa. */
void chainWindow(const Stack& s, int rows, int n, const double* px, const double* py, const double* pz,
                 const double* pRatio, const Columns& byDirection, const Columns& byPoint, const Columns& byWindow)
{
    const double* normal = s.normal;
    eachRegister(n, [&](auto at)
    {
        const Vector X = { load(px, at), load(py, at), load(pz, at) };
        const Lanes U = dot(normal, X);
        const Vector r = { X.x - U*normal[0], X.y - U*normal[1], X.z - U*normal[2] };
        const PathDerivative d(s, U, dot(r, r), load(pRatio, at));
        for (int row = 0; row < rows; ++row)
        {
            const Vector D = loadRow(byDirection, row, at);
            const Lanes f = dot(D, r), g = d.byU*f - d.kappa*dot(normal, D), h = d.bend*f;
            storeAt(d.kappa*D.x + g*normal[0] + h*r.x, byPoint, row, 0, at);
            storeAt(d.kappa*D.y + g*normal[1] + h*r.y, byPoint, row, 1, at);
            storeAt(d.kappa*D.z + g*normal[2] + h*r.z, byPoint, row, 2, at);
            if (!byWindow.data)
                continue;
            const Lanes side = 1 - d.kappa*U, back = U*h;
            const Vector m = { side*D.x + g*X.x - back*r.x, side*D.y + g*X.y - back*r.y, side*D.z + g*X.z - back*r.z };
            const Lanes along = dot(normal, m);
            storeAt(m.x - along*normal[0], byWindow, row, 0, at);
            storeAt(m.y - along*normal[1], byWindow, row, 1, at);
            storeAt(m.z - along*normal[2], byWindow, row, 2, at);
            mediaDerivatives(s, d, [&](int column, Lanes dKappa) { storeAt(f*dKappa, byWindow, row, column, at); });
        }
    });
}

void chainLinear(const double* A, int n, const double* px, const double* py, const double* pz, const Columns& byPoint,
                 const Columns& out)
{
    eachRegister(n, [&](auto at)
    {
        const Vector X = { load(px, at), load(py, at), load(pz, at) };
        const Vector moved = { dot(A, X), dot(A + 3, X), dot(A + 6, X) };
        for (int row = 0; row < 2; ++row)
            storeAt(dot(loadRow(byPoint, row, at), moved), out, row, 0, at);
    });
}

inline Vector cross(const Vector& a, const Vector& b)
{
    return { a.y*b.z - a.z*b.y, a.z*b.x - a.x*b.z, a.x*b.y - a.y*b.x };
}

void gaussNewton(int n, const double* R, const Columns& observed, const Columns& predicted, const Columns& byPoint1,
                 const Columns& byPoint2, double* px, double* py, double* pz, double* pMoved)
{
    eachRegister(n, [&](auto at)
    {
        Vector J[4], A[3] = {}, g = {};     // A: J^T J by rows
        for (int k = 0; k < 4; ++k)
        {
            J[k] = loadRow(k < 2 ? byPoint1 : byPoint2, k % 2, at);
            if (k >= 2)
            {
                const Vector D = J[k];
                J[k] = { D.x*R[0] + D.y*R[3] + D.z*R[6], D.x*R[1] + D.y*R[4] + D.z*R[7], D.x*R[2] + D.y*R[5] + D.z*R[8] };
            }
            const Lanes e = load(observed.at(k, 0), at) - load(predicted.at(k, 0), at);
            const Vector& D = J[k];
            g = { g.x + D.x*e, g.y + D.y*e, g.z + D.z*e };
            A[0] = { A[0].x + D.x*D.x, A[0].y + D.x*D.y, A[0].z + D.x*D.z };
            A[1] = { A[0].y, A[1].y + D.y*D.y, A[1].z + D.y*D.z };
            A[2] = { A[0].z, A[1].z, A[2].z + D.z*D.z };
        }
        // The rows of the inverse are cross products of the rows over the determinant.
        const Vector a = cross(A[1], A[2]), b = cross(A[2], A[0]), c = cross(A[0], A[1]);
        const Lanes inverse = 1/dot(A[0], a);
        const Vector step = { dot(a, g)*inverse, dot(b, g)*inverse, dot(c, g)*inverse };
        Lanes moved = all(0);
        for (const Vector& D : J)
            moved += square(dot(D, step));
        store(load(px, at) + step.x, px, at);
        store(load(py, at) + step.y, py, at);
        store(load(pz, at) + step.z, pz, at);
        store(moved, pMoved, at);
    });
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
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c)
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
    for (int k = 0; k < 3; ++k, power *= s)
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
    for (int c = TAUX; c < m.given; ++c)
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

/* With e = (X, Y)/r: d(x, y) = theta_d/r (I - e e^T) + e theta_d' dtheta, dtheta = (Z e, -r)/|d|^2. On the axis theta_d/r
and theta_d' Z/|d|^2 are both 1/Z and e drops out. */
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
        const Lanes ex = X*inverseR, ey = Y*inverseR, x = thetaD*(ex + m.alpha*ey), y = thetaD*ey;
        store(answers.where(theta < m.thetaMax, m.fx*x + m.cx), u, at);
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
        for (int row = 0; row < 2; ++row)
            for (int c = 0; c < 2; ++c)
                storeAt(all(row == c), byParameters, row, 2 + c, at);
        Lanes power = theta;
        for (int c = 0; c < 4; ++c)
        {
            power *= theta*theta;
            storeAt(m.fx*power*(ex + m.alpha*ey), byParameters, 0, 4 + c, at);
            storeAt(m.fy*power*ey, byParameters, 1, 4 + c, at);
        }
    });
    return answers.complete();
}

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_DERIVATIVES_HPP
