// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POINTS_SIMD_HPP
#define OPENCV_REFRACT_POINTS_SIMD_HPP

#include "arrays/moderate.hpp"
#include "points/epipolar_curve.simd.hpp"
#include "points/plane.simd.hpp"
#include "points/triangulate.simd.hpp"

/* The vector code of point_kernels.hpp. */

namespace cv { namespace refract { namespace {

bool transform(const double* rotation, const double* translation, int n, double* x, double* y, double* z)
{
    const Constants<9> R(rotation);
    const Constants<3> t(translation);
    Mask extreme = none();
    eachRegister(n, [&](auto at)
    {
        const Lanes a = load(x, at), b = load(y, at), c = load(z, at);
        const Lanes X = R[0]*a + R[1]*b + R[2]*c + t[0];
        const Lanes Y = R[3]*a + R[4]*b + R[5]*c + t[1];
        const Lanes Z = R[6]*a + R[7]*b + R[8]*c + t[2];
        store(X, x, at);
        store(Y, y, at);
        store(Z, z, at);
        extreme |= isExtreme(X, Y, Z);
    });
    return !any(extreme);
}

void multiples(const double* vector, int n, const double* factor, double* x, double* y, double* z)
{
    const Constants<3> v(vector);
    eachRegister(n, [&](auto at)
    {
        const Lanes f = load(factor, at);
        store(f*v[0], x, at);
        store(f*v[1], y, at);
        store(f*v[2], z, at);
    });
}

bool pinhole(const double* matrix, const double* direction, int n, const double* x, const double* y, const double* z,
             double* u, double* v)
{
    const Constants<9> H(matrix);
    const Constants<3> axis(direction);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes a = load(x, at), b = load(y, at), c = load(z, at);
        const Lanes inverse = 1/(H[6]*a + H[7]*b + H[8]*c);
        const Mask good = axis[0]*a + axis[1]*b + axis[2]*c > 0;
        store(answers.where(good, (H[0]*a + H[1]*b + H[2]*c)*inverse), u, at);
        store((H[3]*a + H[4]*b + H[5]*c)*inverse, v, at);
    });
    return answers.complete();
}

void chordRoots(int n, const double* u, const double* v, double* roots)
{
    eachRegister(n, [&](auto at)
    {
        const Lanes uA = load(u, at), vA = load(v, at), uB = load(u + 2, at), vB = load(v + 2, at);
        const Lanes chordU = uB - uA, chordV = vB - vA, aU = load(u + 1, at) - uA, aV = load(v + 1, at) - vA;
        const Lanes length2 = larger(chordU*chordU + chordV*chordV, all(1e-300));
        const Lanes distance = absolute(aU*chordV - aV*chordU)*inverseSqrt(length2);
        store(select(distance - distance == 0, sqrt(distance), all(0)), roots, at);
    });
}

bool areClose(int n, double tolerance, const double* t, const double* u, const double* v, const double* tMiddle,
              const double* uMiddle, const double* vMiddle, double* slack)
{
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes uA = load(u, at), vA = load(v, at), uB = load(u + 1, at), vB = load(v + 1, at);
        const Lanes chordU = uB - uA, chordV = vB - vA;
        const auto height = [&](const double* pu, const double* pv)     // over the chord, times its length
        { return chordU*(load(pv, at) - vA) - chordV*(load(pu, at) - uA); };
        const Lanes place = 2*(load(tMiddle + 1, at) - load(tMiddle, at))/(load(t + 1, at) - load(t, at));
        const Lanes middle = height(uMiddle, vMiddle), other = height(uMiddle + 1, vMiddle + 1);
        const Lanes skew = (other/(1 - place*place) - middle)/place, most = absolute(middle);
        const Lanes near = 0.25*skew*skew/most, far = 0.385*absolute(skew), more = select(near < far, near, far);
        const Lanes reach = most + select(more == more, more, all(0));      // else the fourth point is out of sight
        const Lanes enough = 0.95*tolerance + 1e-13*(absolute(uB) + absolute(vB));  // far out, pixels are rounding
        const Lanes rest = enough*enough*(chordU*chordU + chordV*chordV) - reach*reach;
        store(answers.where(rest >= 0, rest), slack, at);
    });
    return answers.complete();
}

//! The polynomial of a tile along one of its rows, at the nodes.
void alongRow(const double* values, const double* row, double* along)
{
    for (int c = 0; c < NODES; c += LANES)
    {
        Lanes sum = all(0);
        for (int r = 0; r < NODES; r++)
            sum += row[r]*load(values + NODES*r, Part{ c, NODES });
        store(sum, along, Part{ c, NODES });
    }
}

void interpolate(const double* values, const double* row, const double* columns, int n, double* out)
{
    double along[NODES];
    alongRow(values, row, along);
    eachRegister(n, [&](auto at)
    {
        Lanes sum = all(0);
        for (int c = 0; c < NODES; c++)
            sum += along[c]*load(columns + n*c, at);
        store(sum, out, at);
    });
}

void interpolateSurface(const SurfaceTile& tile, const double* row, const double* columns, const double* planeD, int n,
                        double* u, double* v)
{
    double alongU[3][NODES], alongV[3][NODES];
    for (int k = 0; k < 3; k++)
    {
        alongRow(tile.u[k], row, alongU[k]);
        alongRow(tile.v[k], row, alongV[k]);
    }
    const double atCentre = tile.atCentre, middle = tile.middle, scale = tile.scale;
    eachRegister(n, [&](auto at)
    {
        const Lanes s = (1/(load(planeD, at) - atCentre) - middle)*scale;
        Lanes sumU = all(0), sumV = all(0);
        for (int c = 0; c < NODES; c++)
        {
            const Lanes column = load(columns + n*c, at);
            sumU += (alongU[0][c] + s*(alongU[1][c] + s*alongU[2][c]))*column;
            sumV += (alongV[0][c] + s*(alongV[1][c] + s*alongV[2][c]))*column;
        }
        store(sumU, u, at);
        store(sumV, v, at);
    });
}

void chainLinear(const double* A, int n, const double* px, const double* py, const double* pz, const Columns& byPoint,
                 const Columns& out)
{
    eachRegister(n, [&](auto at)
    {
        const Vector X = { load(px, at), load(py, at), load(pz, at) };
        const Vector moved = { dot(A, X), dot(A + 3, X), dot(A + 6, X) };
        for (int row = 0; row < 2; row++)
            storeAt(dot(loadRow(byPoint, row, at), moved), out, row, 0, at);
    });
}

constexpr PointKernels pointTable = {
    transform, multiples, pinhole, meetPlane, meetPlaneOffAxis, chordRoots, areClose, chainLinear, interpolate, interpolateSurface,
    meetRays, gaussNewton, carryCovariance, pointCovariance, curvesOf, nearestToRay, curvePoints, approachPixel, distanceDerivatives,
    normals, slide
};

}}} // namespace

#endif // OPENCV_REFRACT_POINTS_SIMD_HPP
