// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_TRIANGULATE_SIMD_HPP
#define OPENCV_REFRACT_TRIANGULATE_SIMD_HPP

#include "points/point_kernels.hpp"
#include "simd/vectors.hpp"

/* The point that rays and sheets of two or more cameras meet in, its refinement and its covariance. */

namespace cv { namespace refract { namespace {

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

}}} // namespace

#endif // OPENCV_REFRACT_TRIANGULATE_SIMD_HPP
