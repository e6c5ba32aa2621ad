// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POINTS_SIMD_HPP
#define OPENCV_REFRACT_POINTS_SIMD_HPP

#include "arrays/moderate.hpp"
#include "points/point_kernels.hpp"
#include "simd/vectors.hpp"

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

//! Where rays are off the axis: by how much, and the last face, which leans.
struct OffAxis { Columns offset; Surface lastSurface; };
struct OnAxis {};

template<typename At>
inline Vector originOf(const OnAxis&, const double* axis, Lanes tau, At) { return { tau*axis[0], tau*axis[1], tau*axis[2] }; }
template<typename At>
inline Vector originOf(const OffAxis& off, const double* axis, Lanes tau, At at)
{
    const Vector offset = loadRow(off.offset, 0, at);
    return { tau*axis[0] + offset.x, tau*axis[1] + offset.y, tau*axis[2] + offset.z };
}

bool meetPlane(const Stack& stack, const Surface& lastSurface, const double* plane, const double* planeD, int n, const double* tau,
               const double* dx, const double* dy, const double* dz, double* x, double* y, double* z, double* mu)
{
    const Stack s = stack;
    const Surface last = lastSurface;
    const Constants<3> normal(s.normal), abc(plane);
    const double axis = abc[0]*normal[0] + abc[1]*normal[1] + abc[2]*normal[2];
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes a = load(dx, at), b = load(dy, at), c = load(dz, at), t = load(tau, at);
        const Lanes along = abc[0]*a + abc[1]*b + abc[2]*c, ahead = load(planeD, at) - t*axis, m = along/ahead;
        const Lanes shift = m*t, X = a + shift*normal[0], Y = b + shift*normal[1], Z = c + shift*normal[2];
        Mask good = (along*ahead > 0) & (m - m == 0);
        if (s.refracts)
            good &= isBeyondAlong(last, X, Y, Z, m, a, b, c);
        store(answers.where(good, X), x, at);
        store(Y, y, at);
        store(Z, z, at);
        if (mu)
            store(m, mu, at);
    });
    return answers.complete();
}

bool meetPlaneOffAxis(const Stack& stack, const Surface& lastSurface, const Columns& offset, const double* plane, const double* planeD,
                      int n, const double* tau, const double* dx, const double* dy, const double* dz, double* x, double* y, double* z,
                      double* mu)
{
    const OffAxis off = { offset, lastSurface };
    const Constants<3> normal(stack.normal), abc(plane);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Vector o = originOf(off, normal.value, load(tau, at), at), d = { load(dx, at), load(dy, at), load(dz, at) };
        const Lanes along = dot(abc.value, d), ahead = load(planeD, at) - dot(abc.value, o), m = along/ahead;
        const Vector X = { d.x + m*o.x, d.y + m*o.y, d.z + m*o.z };
        const Mask good = (along*ahead > 0) & (m - m == 0) &
                          isBeyondAlong(off.lastSurface, X.x, X.y, X.z, m, d.x, d.y, d.z);
        store(answers.where(good, X.x), x, at);
        store(X.y, y, at);
        store(X.z, z, at);
        if (mu)
            store(m, mu, at);
    });
    return answers.complete();
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

inline Vector keep(Mask m, const Vector& a)
{
    const Lanes zero = all(0);
    return { select(m, a.x, zero), select(m, a.y, zero), select(m, a.z, zero) };
}

struct RayLanes { Mask seen; Vector d, o; };

//! What the rays of cameras may be.
enum RayKind { ON_AXIS, OFF_AXIS, WITH_SHEETS };

//! d is 0 where the ray is not seen.
template<RayKind KIND, typename At>
inline RayLanes loadRay(const CameraRays& rays, At at)
{
    const Lanes u = load(rays.seen, at), zero = all(0);
    RayLanes ray;
    ray.seen = u == u;
    ray.d = keep(ray.seen, { load(rays.dx, at), load(rays.dy, at), load(rays.dz, at) });
    const Lanes tau = select(ray.seen, load(rays.tau, at), zero);
    ray.o = { tau*rays.axis[0] + rays.centre[0], tau*rays.axis[1] + rays.centre[1], tau*rays.axis[2] + rays.centre[2] };
    if (KIND != ON_AXIS && rays.offset.data)
    {
        const Vector offset = keep(ray.seen, loadRow(rays.offset, 0, at));
        ray.o = { ray.o.x + offset.x, ray.o.y + offset.y, ray.o.z + offset.z };
    }
    return ray;
}

//! Which lanes have a sheet; its normal is 0 elsewhere.
template<typename At>
inline Mask loadSheet(const CameraRays& rays, At at, Vector& normal)
{
    const Lanes x = load(rays.sheet.at(0, 0), at);
    const Mask isSheet = x == x;
    normal = keep(isSheet, loadRow(rays.sheet, 0, at));
    return isSheet;
}

//! The first ray that each lane sees, if there is one that is not part of a sheet.
template<RayKind KIND, typename At>
inline RayLanes firstRay(int cameras, const CameraRays* rays, At at)
{
    RayLanes first = loadRay<KIND>(rays[0], at);
    Vector normal;
    Mask isSheet = none();
    if (KIND == WITH_SHEETS && rays[0].sheet.data)
        isSheet = loadSheet(rays[0], at, normal);
    for (int c = 1; c < cameras && KIND == WITH_SHEETS && any(isSheet); c++)
    {
        RayLanes next = loadRay<KIND>(rays[c], at);
        if (rays[c].sheet.data)
            next.seen &= isNot(loadSheet(rays[c], at, normal));
        const Mask better = isSheet & next.seen;
        const auto choose = [&](Lanes a, Lanes b) { return select(better, b, a); };
        first.d = { choose(first.d.x, next.d.x), choose(first.d.y, next.d.y), choose(first.d.z, next.d.z) };
        first.o = { choose(first.o.x, next.o.x), choose(first.o.y, next.o.y), choose(first.o.z, next.o.z) };
        isSheet &= isNot(better);
    }
    for (int c = 1; c < cameras && any(isNot(first.seen)); c++)
    {
        const RayLanes next = loadRay<KIND>(rays[c], at);
        const auto otherwise = [&](Lanes a, Lanes b) { return select(first.seen, a, b); };
        first.d = { otherwise(first.d.x, next.d.x), otherwise(first.d.y, next.d.y), otherwise(first.d.z, next.d.z) };
        first.o = { otherwise(first.o.x, next.o.x), otherwise(first.o.y, next.o.y), otherwise(first.o.z, next.o.z) };
        first.seen |= next.seen;
    }
    return first;
}

/* Least squares of (I - d d^T)(X - o), of a sheet with the normal m of m.(X - o), in a frame (s, a, b) with s along the first ray:
there what is small between rays that are nearly parallel is a product of small numbers, not a difference of large ones. */
template<RayKind KIND>
inline void meetRaysOf(int n, int cameras, const CameraRays* rays, double* px, double* py, double* pz, double* pApart, double* pNearest)
{
    eachRegister(n, [&](auto at)
    {
        const RayLanes first = firstRay<KIND>(cameras, rays, at);
        Vector a, b;
        vectorsAcross(first.d, a, b);
        Lanes ss = all(0), sa = all(0), sb = all(0), aa = all(0), ab = all(0), bb = all(0);
        Vector g = {};
        for (int c = 0; c < cameras; c++)
        {
            RayLanes ray = loadRay<KIND>(rays[c], at);
            const Vector w = { ray.o.x - first.o.x, ray.o.y - first.o.y, ray.o.z - first.o.z };
            if (KIND == WITH_SHEETS && rays[c].sheet.data)
            {
                Vector m;
                const Mask isSheet = loadSheet(rays[c], at, m);
                m = keep(ray.seen, m);
                const Lanes ms = dot(m, first.d), ma = dot(m, a), mb = dot(m, b), off = dot(m, w);
                g = { g.x + ms*off, g.y + ma*off, g.z + mb*off };
                ss += ms*ms; sa += ms*ma; sb += ms*mb; aa += ma*ma; ab += ma*mb; bb += mb*mb;
                ray.d = keep(isNot(isSheet), ray.d);
            }
            const Lanes ds = dot(ray.d, first.d), da = dot(ray.d, a), db = dot(ray.d, b);
            const Lanes ws = dot(w, first.d), wa = dot(w, a), wb = dot(w, b);
            const Lanes along = da*wa + db*wb, across = da*da + db*db, aaOwn = ds*ds + db*db, bbOwn = ds*ds + da*da;
            g = { g.x + across*ws - ds*along, g.y + aaOwn*wa - da*(ds*ws + db*wb), g.z + bbOwn*wb - db*(ds*ws + da*wa) };
            ss += across; sa -= ds*da; sb -= ds*db; aa += aaOwn; ab -= da*db; bb += bbOwn;
        }
        const Lanes inverse = 1/(aa*bb - ab*ab), ka = (bb*sa - ab*sb)*inverse, kb = (aa*sb - ab*sa)*inverse;
        const Lanes apart = ss - ka*sa - kb*sb, s = (g.x - ka*g.y - kb*g.z)/apart;
        const Lanes ga = g.y - sa*s, gb = g.z - sb*s, A = (bb*ga - ab*gb)*inverse, B = (aa*gb - ab*ga)*inverse;
        const Vector X = { first.o.x + s*first.d.x + A*a.x + B*b.x, first.o.y + s*first.d.y + A*a.y + B*b.y,
                           first.o.z + s*first.d.z + A*a.z + B*b.z };
        Lanes nearest = s;
        for (int c = 0; c < cameras; c++)
        {
            const RayLanes ray = loadRay<KIND>(rays[c], at);
            const Lanes far = dot(ray.d, { X.x - ray.o.x, X.y - ray.o.y, X.z - ray.o.z });
            nearest = select(ray.seen & (far < nearest), far, nearest);
        }
        store(X.x, px, at);
        store(X.y, py, at);
        store(X.z, pz, at);
        store(apart, pApart, at);
        store(nearest, pNearest, at);
    });
}

void meetRays(int n, int cameras, const CameraRays* rays, double* px, double* py, double* pz, double* pApart, double* pNearest)
{
    bool isOffAxis = false, hasSheets = false;
    for (int c = 0; c < cameras; c++)
    {
        isOffAxis |= rays[c].offset.data != nullptr;
        hasSheets |= rays[c].sheet.data != nullptr;
    }
    (hasSheets ? meetRaysOf<WITH_SHEETS> : isOffAxis ? meetRaysOf<OFF_AXIS> : meetRaysOf<ON_AXIS>)
        (n, cameras, rays, px, py, pz, pApart, pNearest);
}

void normals(int n, const double* pax, const double* pay, const double* paz, const double* pbx, const double* pby, const double* pbz,
             double* px, double* py, double* pz)
{
    eachRegister(n, [&](auto at)
    {
        const Vector a = { load(pax, at), load(pay, at), load(paz, at) }, b = { load(pbx, at), load(pby, at), load(pbz, at) };
        const Vector m = cross(a, b);
        const Lanes inverse = 1/sqrt(dot(m, m));
        store(m.x*inverse, px, at);
        store(m.y*inverse, py, at);
        store(m.z*inverse, pz, at);
    });
}

void slide(int n, const double* observed, const double* predicted, const Columns& gradient, const double* pdx, const double* pdy,
           const double* pdz, double* pS, double* pError, double* pSine)
{
    eachRegister(n, [&](auto at)
    {
        const Vector g = loadRow(gradient, 0, at), d = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Lanes error = load(observed, at) - load(predicted, at), along = dot(g, d);
        store(load(pS, at) + error/along, pS, at);
        store(error*error, pError, at);
        store(along*along/dot(g, g), pSine, at);
    });
}

void gaussNewton(int n, int cameras, const CameraErrors* errors, double* px, double* py, double* pz, double* pMoved)
{
    const double LEAST = 1e-13;     // of the determinant: below it, A is too near to a singular one for its inverse
    eachRegister(n, [&](auto at)
    {
        Vector A[3] = {}, g = {};       // A: J^T J by rows
        for (int c = 0; c < cameras; c++)
        {
            const CameraErrors& camera = errors[c];
            Lanes uError = all(0);
            Vector byU = {};
            for (int k = 0; k < 2; k++)
            {
                const Lanes observed = load(camera.observed.at(k, 0), at);
                const Mask seen = observed == observed;
                Lanes e = select(seen, observed - load(camera.predicted.at(k, 0), at), all(0));
                Vector D = keep(seen, loadRow(camera.byPoint, k, at));
                if (camera.whitening.data)
                {
                    const Lanes own = load(camera.whitening.at(k == 0 ? 0 : 2, 0), at);
                    const Lanes across = k == 0 ? all(0) : load(camera.whitening.at(1, 0), at);
                    const Lanes u = e;
                    const Vector U = D;
                    e = own*e + across*uError;
                    D = { own*D.x + across*byU.x, own*D.y + across*byU.y, own*D.z + across*byU.z };
                    uError = u;
                    byU = U;
                }
                if (const double* R = camera.R)
                    D = { D.x*R[0] + D.y*R[3] + D.z*R[6], D.x*R[1] + D.y*R[4] + D.z*R[7], D.x*R[2] + D.y*R[5] + D.z*R[8] };
                g = { g.x + D.x*e, g.y + D.y*e, g.z + D.z*e };
                A[0] = { A[0].x + D.x*D.x, A[0].y + D.x*D.y, A[0].z + D.x*D.z };
                A[1] = { A[0].y, A[1].y + D.y*D.y, A[1].z + D.y*D.z };
                A[2] = { A[0].z, A[1].z, A[2].z + D.z*D.z };
            }
        }
        // The rows of the inverse are cross products of the rows over the determinant.
        const Vector a = cross(A[1], A[2]), b = cross(A[2], A[0]), c = cross(A[0], A[1]);
        const Lanes determinant = dot(A[0], a), trace = A[0].x + A[1].y + A[2].z;
        const Lanes inverse = 1/select(determinant > LEAST*trace*trace*trace, determinant, all(NAN));
        const Vector step = { dot(a, g)*inverse, dot(b, g)*inverse, dot(c, g)*inverse };
        store(load(px, at) + step.x, px, at);
        store(load(py, at) + step.y, py, at);
        store(load(pz, at) + step.z, pz, at);
        store(step.x*dot(A[0], step) + step.y*dot(A[1], step) + step.z*dot(A[2], step), pMoved, at);
    });
}

//! Some rows of C at once, so that a register of B is loaded once for all of them; b: B's from first on.
template<int ROWS, typename At>
inline void carryRows(const PixelsByParameters& A, const double* C, int perRow, int p, const Lanes (*b)[2], int first, int end, At at,
                      Lanes e[2][2])
{
    Lanes t[ROWS][2];
    for (int i = 0; i < ROWS; i++)
        t[i][0] = t[i][1] = all(0);
    for (int q = first; q < end; q++)
        for (int i = 0; i < ROWS; i++)
        {
            const double c = C[(p + i)*perRow + q];
            t[i][0] += c*b[q - first][0];
            t[i][1] += c*b[q - first][1];
        }
    for (int i = 0; i < ROWS; i++)
        for (int k = 0; k < 2; k++)
        {
            const Lanes a = load(A.values.at(k, A.which[p + i]), at);
            e[k][0] += a*t[i][0];
            e[k][1] += a*t[i][1];
        }
}

void carryCovariance(int n, const PixelsByParameters& A, const PixelsByParameters& B, const double* C, bool isSame, const Columns& E)
{
    enum { ROWS = 4, CHUNK = 32 };      // a copy of B's columns side by side: their places are too alike for the cache
    const auto smaller = [](int i, int j) { return i < j ? i : j; };
    eachRegister(n, [&](auto at)
    {
        Lanes e[2][2] = { { all(0), all(0) }, { all(0), all(0) } }, b[CHUNK][2];
        for (int first = 0; first < B.count; first += CHUNK)
        {
            const int last = smaller(first + CHUNK, B.count);
            for (int q = first; q < last; q++)
                for (int k = 0; k < 2; k++)
                    b[q - first][k] = load(B.values.at(k, B.which[q]), at);
            int p = 0;
            for (; p + ROWS <= A.count; p += ROWS)
                carryRows<ROWS>(A, C, B.count, p, b, first, isSame ? smaller(p + ROWS, last) : last, at, e);
            for (; p < A.count; p++)
                carryRows<1>(A, C, B.count, p, b, first, isSame ? smaller(p + 1, last) : last, at, e);
        }
        storeAt(isSame ? e[0][0] + e[0][0] : e[0][0], E, 0, 0, at);
        storeAt(isSame ? e[0][1] + e[1][0] : e[0][1], E, 0, 1, at);
        storeAt(isSame ? e[1][0] + e[0][1] : e[1][0], E, 1, 0, at);
        storeAt(isSame ? e[1][1] + e[1][1] : e[1][1], E, 1, 1, at);
    });
}

//! Row k of a camera's derivatives, in the frame of camera 1.
template<typename At>
inline Vector inFrame1(const PixelsByPoint& camera, int k, At at)
{
    const Vector D = loadRow(camera.byPoint, k, at);
    const double* R = camera.R;
    if (!R)
        return D;
    return { D.x*R[0] + D.y*R[3] + D.z*R[6], D.x*R[1] + D.y*R[4] + D.z*R[7], D.x*R[2] + D.y*R[5] + D.z*R[8] };
}

//! Upper triangle of a symmetric matrix.
struct Symmetric { Lanes xx, xy, xz, yy, yz, zz; };

inline Vector operator*(const Symmetric& A, const Vector& v)
{
    return { A.xx*v.x + A.xy*v.y + A.xz*v.z, A.xy*v.x + A.yy*v.y + A.yz*v.z, A.xz*v.x + A.yz*v.y + A.zz*v.z };
}

//! The inverse by Cholesky's factors of A scaled to a diagonal of ones; NaN where A is singular.
inline Symmetric inverseOf(const Symmetric& A)
{
    const double LEAST = 2.220446e-16;      // of a pivot
    const auto root = [=](Lanes pivot) { return 1/sqrt(select(pivot > LEAST, pivot, all(NAN))); };
    const Lanes sx = 1/sqrt(A.xx), sy = 1/sqrt(A.yy), sz = 1/sqrt(A.zz);
    // A = S L L^T S; k = 1/diagonal of L, m = L^-1.
    const Lanes lyx = A.xy*sx*sy, lzx = A.xz*sx*sz, ky = root(1 - lyx*lyx), lzy = (A.yz*sy*sz - lzx*lyx)*ky;
    const Lanes kz = root(1 - lzx*lzx - lzy*lzy), myx = -lyx*ky, mzy = -lzy*ky*kz, mzx = -(lzx + lzy*myx)*kz;
    return { sx*sx*(1 + myx*myx + mzx*mzx), sx*sy*(myx*ky + mzx*mzy), sx*sz*mzx*kz,
             sy*sy*(ky*ky + mzy*mzy), sy*sz*mzy*kz, sz*sz*kz*kz };
}

void pointCovariance(int n, int cameras, const PixelsByPoint* pixels, double variance, const Columns& E, const Columns& byPixel,
                     const Columns& covariance)
{
    eachRegister(n, [&](auto at)
    {
        const Lanes zero = all(0);
        Symmetric A = { zero, zero, zero, zero, zero, zero };       // J^T J
        for (int k = 0; k < 2*cameras; k++)
        {
            const Vector D = inFrame1(pixels[k/2], k % 2, at);
            A = { A.xx + D.x*D.x, A.xy + D.x*D.y, A.xz + D.x*D.z, A.yy + D.y*D.y, A.yz + D.y*D.z, A.zz + D.z*D.z };
        }
        const Symmetric inverse = inverseOf(A);
        Symmetric C = { variance*inverse.xx, variance*inverse.xy, variance*inverse.xz, variance*inverse.yy, variance*inverse.yz,
                        variance*inverse.zz };
        for (int k = 0; E.data && k < 2*cameras; k++)
        {
            const Vector F = inverse*inFrame1(pixels[k/2], k % 2, at);
            storeAt(F.x, byPixel, k, 0, at);
            storeAt(F.y, byPixel, k, 1, at);
            storeAt(F.z, byPixel, k, 2, at);
        }
        for (int k = 0; E.data && k < 2*cameras; k++)
        {
            Vector g = { zero, zero, zero };
            for (int l = 0; l < 2*cameras; l++)
            {
                const Lanes e = load(E.at(k, l), at);
                const Vector F = loadRow(byPixel, l, at);
                g = { g.x + e*F.x, g.y + e*F.y, g.z + e*F.z };
            }
            const Vector F = loadRow(byPixel, k, at);
            C = { C.xx + F.x*g.x, C.xy + F.x*g.y, C.xz + F.x*g.z, C.yy + F.y*g.y, C.yz + F.y*g.z, C.zz + F.z*g.z };
        }
        storeAt(C.xx, covariance, 0, 0, at); storeAt(C.xy, covariance, 0, 1, at); storeAt(C.xz, covariance, 0, 2, at);
        storeAt(C.xy, covariance, 1, 0, at); storeAt(C.yy, covariance, 1, 1, at); storeAt(C.yz, covariance, 1, 2, at);
        storeAt(C.xz, covariance, 2, 0, at); storeAt(C.yz, covariance, 2, 1, at); storeAt(C.zz, covariance, 2, 2, at);
    });
}

// Curves: see epipolar_curve.hpp for t and unit.

const double CURVE_END = 1e-10;     // of t, from infinity and from the ray's origin

//! How far along its ray the last surface is.
inline Lanes lengthToSurface(const OnAxis&, const CurveFrame& frame, Lanes tau, const Vector& origin, const Vector& d)
{
    return frame.lastSurface.curvature > 0 ? lengthTo(frame.lastSurface, origin.x, origin.y, origin.z, d.x, d.y, d.z)
                                           : (frame.lastSurface.distance - tau)/dot(frame.normal, d);
}
inline Lanes lengthToSurface(const OffAxis&, const CurveFrame& frame, Lanes, const Vector& origin, const Vector& d)
{ return lengthTo(frame.lastSurface, origin.x, origin.y, origin.z, d.x, d.y, d.z); }

template<typename Off>
inline bool curvesOfRays(const CurveFrame& given, const Off& off, int n, const double* pTau, const double* pdx, const double* pdy,
                         const double* pdz, const Columns& curves)
{
    const CurveFrame frame = given;
    const Constants<9> R(frame.R);
    const Constants<3> T(frame.T);
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes tau = load(pTau, at);
        const Vector d = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Vector c = originOf(off, frame.normal, tau, at);
        const Vector o = { dot(R.value, c) + T[0], dot(R.value + 3, c) + T[1], dot(R.value + 6, c) + T[2] };
        const Lanes length2 = dot(o, o), unit = select(length2 > 0, 1/sqrt(length2), all(1));
        Lanes sNear = larger(lengthToSurface(off, frame, tau, c, d), all(0)), tFar = all(CURVE_END);
        Mask good = d.x == d.x;
        if (frame.isLimited)
        {
            const Lanes sFar = (frame.far - c.z)/d.z;
            sNear = larger(sNear, (frame.near - c.z)/d.z);
            good &= (d.z > 0) & (sFar > sNear);
            tFar = larger(1/(1 + sFar*unit), tFar);
        }
        const Lanes tNear = 1/(1 + sNear*unit);
        storeAt(dot(R.value, d), curves, 0, CURVE_DIRECTION, at);
        storeAt(dot(R.value + 3, d), curves, 0, CURVE_DIRECTION + 1, at);
        storeAt(dot(R.value + 6, d), curves, 0, CURVE_DIRECTION + 2, at);
        storeAt(o.x, curves, 0, CURVE_ORIGIN, at);
        storeAt(o.y, curves, 0, CURVE_ORIGIN + 1, at);
        storeAt(o.z, curves, 0, CURVE_ORIGIN + 2, at);
        storeAt(unit, curves, 0, CURVE_UNIT, at);
        storeAt(answers.where(good, tFar), curves, 0, CURVE_FAR, at);
        storeAt(tNear*(1 - CURVE_END), curves, 0, CURVE_NEAR, at);      // not on the surface itself
    });
    return answers.complete();
}

bool curvesOf(const CurveFrame& frame, int n, const double* tau, const Columns& offset, const double* dx, const double* dy,
              const double* dz, const Columns& curves)
{
    return offset.data ? curvesOfRays(frame, OffAxis{ offset, frame.lastSurface }, n, tau, dx, dy, dz, curves)
                       : curvesOfRays(frame, OnAxis(), n, tau, dx, dy, dz, curves);
}

template<typename At>
inline Vector loadVector(const Columns& columns, int first, At at)
{
    return { load(columns.at(0, first), at), load(columns.at(0, first + 1), at), load(columns.at(0, first + 2), at) };
}

inline Lanes within(Lanes a, Lanes low, Lanes high) { return select(a < low, low, select(a > high, high, a)); }

/* The directions in which the other camera sees the curve lie in a plane across N = o x D, with o seen from the origin of the
pixel's own ray e: o + s D is parallel to the part of e in the plane where (o x e).N + s (D x e).N = 0. */
template<typename Off>
inline void nearestTo(const Columns& curves, const double* pAxis, const Off& off, int n, const double* pTau, const double* pdx,
                      const double* pdy, const double* pdz, double* pT)
{
    const Constants<3> axis(pAxis);
    eachRegister(n, [&](auto at)
    {
        const Lanes tau = load(pTau, at), unit = load(curves.at(0, CURVE_UNIT), at);
        const Lanes tFar = load(curves.at(0, CURVE_FAR), at), tNear = load(curves.at(0, CURVE_NEAR), at);
        const Vector e = { load(pdx, at), load(pdy, at), load(pdz, at) };
        const Vector D = loadVector(curves, CURVE_DIRECTION, at), o = loadVector(curves, CURVE_ORIGIN, at);
        const Vector own = originOf(off, axis.value, tau, at), from = { o.x - own.x, o.y - own.y, o.z - own.z };
        const Vector N = cross(from, D);
        const Lanes s = dot(cross(from, e), N)/dot(cross(e, D), N);
        const Lanes end = select(dot(e, D) > unit*dot(e, from), tFar, tNear);
        const Lanes t = within(select(s > 0, 1/(1 + s*unit), end), tFar, tNear);
        store(select(t == t, t, 0.5*(tFar + tNear)), pT, at);
    });
}

void nearestToRay(const Columns& curves, const double* axis, int n, const double* tau, const Columns& offset, const double* dx,
                  const double* dy, const double* dz, double* t)
{
    if (offset.data)
        nearestTo(curves, axis, OffAxis{ offset, Surface() }, n, tau, dx, dy, dz, t);
    else
        nearestTo(curves, axis, OnAxis(), n, tau, dx, dy, dz, t);
}

void curvePoints(const Columns& curves, int n, const double* pT, double* x, double* y, double* z)
{
    eachRegister(n, [&](auto at)
    {
        const Lanes t = load(pT, at), s = (1 - t)/(t*load(curves.at(0, CURVE_UNIT), at));
        const Vector D = loadVector(curves, CURVE_DIRECTION, at), o = loadVector(curves, CURVE_ORIGIN, at);
        store(o.x + s*D.x, x, at);
        store(o.y + s*D.y, y, at);
        store(o.z + s*D.z, z, at);
    });
}

void approachPixel(const Columns& curves, double enough, int n, const double* pixelU, const double* pixelV, const double* pu,
                   const double* pv, const Columns& byPoint, double* pT, const Columns& nearest)
{
    const double POINT = 1e-9;      // pixels: so short a curve has no direction
    eachRegister(n, [&](auto at)
    {
        const Lanes t = load(pT, at), tFar = load(curves.at(0, CURVE_FAR), at), tNear = load(curves.at(0, CURVE_NEAR), at);
        const Lanes speed = 1/(t*t*load(curves.at(0, CURVE_UNIT), at));     // of s by -t
        const Vector D = loadVector(curves, CURVE_DIRECTION, at);
        const Lanes cu = dot(loadRow(byPoint, 0, at), D)*speed, cv = dot(loadRow(byPoint, 1, at), D)*speed;
        const Lanes eu = load(pixelU, at) - load(pu, at), ev = load(pixelV, at) - load(pv, at);
        const Lanes c2 = cu*cu + cv*cv, inverse = 1/sqrt(c2), along = (eu*cu + ev*cv)*inverse, across = (cu*ev - cv*eu)*inverse;
        const Mask hasDirection = c2 > POINT*POINT;
        const Lanes next = within(t - along*inverse, tFar, tNear), step = absolute(next - t)*sqrt(c2);
        const Lanes moved = select(hasDirection, step, 0*(c2 + eu + ev));
        const Mask arrived = moved <= enough, atEnd = isNot(hasDirection) | (arrived & (absolute(along) > enough));
        const Lanes length = sqrt(larger(eu*eu + ev*ev, all(1e-300)));
        const Lanes distance = select(atEnd, select(across < 0, -length, length), across) + 0*moved;   // NaN where moved is
        store(select(arrived, t, next), pT, at);
        storeAt(distance, nearest, 0, NEAREST_DISTANCE, at);
        storeAt(select(atEnd, eu/distance, -cv*inverse), nearest, 0, NEAREST_NORMAL, at);
        storeAt(select(atEnd, ev/distance, cu*inverse), nearest, 0, NEAREST_NORMAL + 1, at);
        storeAt(moved, nearest, 0, NEAREST_MOVED, at);
        storeAt(select(atEnd, all(1), all(0)), nearest, 0, NEAREST_AT_END, at);
    });
}

/* The nearest point's own motion along the curve changes nothing. So the distance changes with the other's pixel by the normal n,
and with all else by -n dC, the image of a motion of X along any way that keeps it on the moving ray: for the first camera's
pixel the least one with the right image. Where an end stops X, it stays in the end's plane. */
void distanceDerivatives(const CurveMotion& given, int n, const double* px, const double* py, const double* pz,
                         const double* pdx, const double* pdy, const double* pdz, const double* pmx, const double* pmy,
                         const double* pmz, const Columns& byPoint1, const Columns& byPoint2, const Columns& nearest,
                         const Columns& out)
{
    const CurveMotion motion = given;
    const double *R = motion.R, *B = motion.dTranslation, *shift = motion.shift;
    eachRegister(n, [&](auto at)
    {
        const Lanes nu = load(nearest.at(0, NEAREST_NORMAL), at), nv = load(nearest.at(0, NEAREST_NORMAL + 1), at);
        const Vector a = loadRow(byPoint2, 0, at), b = loadRow(byPoint2, 1, at);
        const Vector g = { nu*a.x + nv*b.x, nu*a.y + nv*b.y, nu*a.z + nv*b.z };
        const Vector Y = { load(px, at) - shift[0], load(py, at) - shift[1], load(pz, at) - shift[2] };
        for (int k = 0; k < 3; k++)
        {
            const double* A = motion.dRotation[k];
            const Vector moved = { dot(A, Y), dot(A + 3, Y), dot(A + 6, Y) };
            storeAt(-dot(g, moved), out, 0, 4 + k, at);
            storeAt(-(g.x*B[k] + g.y*B[3 + k] + g.z*B[6 + k]), out, 0, 7 + k, at);
        }
        const Vector d = { load(pdx, at), load(pdy, at), load(pdz, at) }, m = { load(pmx, at), load(pmy, at), load(pmz, at) };
        const Vector h = { g.x*R[0] + g.y*R[3] + g.z*R[6], g.x*R[1] + g.y*R[4] + g.z*R[7], g.x*R[2] + g.y*R[5] + g.z*R[8] };
        const Lanes f = dot(h, d)/dot(m, d);
        const Vector k = { h.x - f*m.x, h.y - f*m.y, h.z - f*m.z };
        const Vector U = loadRow(byPoint1, 0, at), V = loadRow(byPoint1, 1, at);
        const Lanes UU = dot(U, U), UV = dot(U, V), VV = dot(V, V), kU = dot(k, U), kV = dot(k, V), inverse = 1/(UU*VV - UV*UV);
        storeAt((UV*kV - VV*kU)*inverse, out, 0, 0, at);
        storeAt((UV*kU - UU*kV)*inverse, out, 0, 1, at);
        storeAt(nu, out, 0, 2, at);
        storeAt(nv, out, 0, 3, at);
    });
}

constexpr PointKernels pointTable = {
    transform, multiples, pinhole, meetPlane, meetPlaneOffAxis, chordRoots, areClose, chainLinear, interpolate, interpolateSurface,
    meetRays, gaussNewton, carryCovariance, pointCovariance, curvesOf, nearestToRay, curvePoints, approachPixel, distanceDerivatives,
    normals, slide
};

}}} // namespace

#endif // OPENCV_REFRACT_POINTS_SIMD_HPP
