// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WEDGE_SIMD_HPP
#define OPENCV_REFRACT_WEDGE_SIMD_HPP

#include "window/layers.simd.hpp"
#include "window/wedge_derivatives.simd.hpp"

/* Light through faces that are not parallel, in the window's frame. With the optical vector p = index * direction, of which a face
of normal m changes m.p = c alone (Snell's law),

    p' = p + gamma m,    gamma = sqrt(c^2 + n'^2 - n^2) - c

and P' = P + s p from one face to the next, s = (distance - m.P)/(m.p) there. */

namespace cv { namespace refract { namespace {

/* The outgoing line goes through P - (s_0 + s_1 + ...) p, which is - sum over the faces of gamma m (s_0 + ... up to there): a sum of
what is small, without a difference of points; on the axis where all m are one. */
bool traceOutWedge(const TiltedFaces& window, int n, const double* wx, const double* wy, const double* wz,
                   double* tau, const Columns& offset, double* dx, double* dy, double* dz)
{
    const Constants<9> axes(window.axes);
    const Face* const faces = window.faces;
    const int count = window.count;
    const double inner = window.inner, inverseOuter = 1/window.outer;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes zero = all(0);
        const Vector w = intoFrame(axes.value, { load(wx, at), load(wy, at), load(wz, at) });
        Vector p = { inner*w.x, inner*w.y, inner*w.z }, P = { zero, zero, zero }, origin = P;
        Lanes sum = zero;
        Mask good = p.z > 0;
        for (int k = 0; k < count; k++)
        {
            const Face& face = faces[k];
            const Lanes c = dot(face.normal, p), s = (face.distance - dot(face.normal, P))/c, after2 = c*c + face.excess;
            good &= (c > 0) & (s >= 0) & (after2 > 0);
            const Lanes gamma = after2*inverseSqrt(after2) - c;
            P = plus(P, s, p);
            p = plus(p, gamma, face.normal);
            sum += s;
            origin = plus(origin, -gamma*sum, face.normal);
        }
        store(answers.where(good, origin.z), tau, at);
        const Vector o = outOfFrame(axes.value, { origin.x, origin.y, zero }), d = outOfFrame(axes.value, p);
        storeAt(o.x, offset, 0, 0, at);
        storeAt(o.y, offset, 0, 1, at);
        storeAt(o.z, offset, 0, 2, at);
        store(d.x*inverseOuter, dx, at);
        store(d.y*inverseOuter, dy, at);
        store(d.z*inverseOuter, dz, at);
    });
    return answers.complete();
}

/* A point's direction: Newton's method in the tangent t (2 components) of the direction in the rarest medium, from that of
parallel faces. The error is where the ray of t misses the point, in the plane through it that is parallel to the last face.

Optical vectors are in units of rarest cos(theta) of the rarest medium: (t, 1) there, and

    c'^2 = c^2 + excess (1 + t^2),    excess = (n'^2 - n^2)/rarest^2 */
struct WedgeSearch
{
    Path<Lanes> path;           //!< by parallel faces
    Lanes ratio, step, slope;   //!< t/V of these, the last step of it, and dV/dt
    Vector X;                   //!< the point, in the window's frame
    Lanes height;               //!< of the scene's medium, along the last face's normal
    Lanes tx, ty;
    Lanes J[2][2];              //!< inverse of d miss/d t
    Lanes step2, bound2;        //!< square of the last step; of the step that the derivatives are from
    Mask good;

    // The ray of t behind a face, and its derivatives by t.
    Vector p, P, dp[2], dP[2];
    Lanes inverseIn, inverseQ;              //!< 1/c before and behind the first face
    Lanes c, behind2, both;                 //!< at the face to pass: m.p before it, its square behind it, 1/(c c')
    Lanes inverseLast, dLast[2];            //!< 1/c' of the last face passed, and its derivatives over -c'^2
};

//! What the stages below have in common. A root waits for the one before it, so each ends a stage (see Group).
struct WedgeStages
{
    WedgeStages(const Stack& s, const TiltedFaces& window)
        : unit(1/(s.rarest*s.rarest)), inner2(s.inner*s.inner*unit), gap(window.faces[0].distance),
          after2(window.faces[0].after*window.faces[0].after*unit), isInnerRarest(s.inner == s.rarest) {}

    //! The first face is across the axis. q^2 = n^2 - p^2 by t: no cancellation near grazing.
    void firstRoots(WedgeSearch& search) const
    {
        const Lanes t2 = search.tx*search.tx + search.ty*search.ty;
        search.inverseIn = isInnerRarest ? all(1) : inverseSqrt(inner2 + (inner2 - 1)*t2);
        search.inverseQ = inverseSqrt(after2 + (after2 - 1)*t2);
    }

    template<bool DERIVATIVES>
    void passFirst(WedgeSearch& search) const
    {
        const Lanes zero = all(0), x = search.tx, y = search.ty, s0 = gap*search.inverseIn;
        const Lanes q = (after2 + (after2 - 1)*(x*x + y*y))*search.inverseQ;
        search.p = { x, y, q };
        search.P = { s0*x, s0*y, all(gap) };
        search.good = search.height > 0;
        if (!DERIVATIVES)
            return;
        const Lanes bend = (1 - inner2)*s0*search.inverseIn*search.inverseIn, slope = (after2 - 1)*search.inverseQ, xy = bend*x*y;
        search.dp[0] = { all(1), zero, slope*x };
        search.dp[1] = { zero, all(1), slope*y };
        search.dP[0] = { s0 + bend*x*x, xy, zero };
        search.dP[1] = { xy, s0 + bend*y*y, zero };
    }

    void root(const Face& face, WedgeSearch& search) const
    {
        const Lanes secant2 = 1 + (search.tx*search.tx + search.ty*search.ty);
        search.c = dot(face.normal, search.p);
        search.behind2 = search.c*search.c + face.excess*unit*secant2;
        search.both = inverseSqrt(search.c*search.c*search.behind2);
    }

    template<bool DERIVATIVES>
    void pass(const Face& face, WedgeSearch& search) const
    {
        const double* const m = face.normal;
        const Lanes c = search.c, inverseBehind = c*search.both, behind = search.behind2*inverseBehind, inverse = search.both*behind;
        const Lanes length = (face.distance - dot(m, search.P))*inverse;
        search.good &= (c > 0) & (length > 0) & (search.behind2 > 0);
        const Vector p = search.p;
        const Lanes t[2] = { search.tx, search.ty };
        for (int j = 0; j < 2 && DERIVATIVES; j++)
        {
            const Vector dp = search.dp[j], dP = search.dP[j];
            const Lanes dc = dot(m, dp), dBehind = (c*dc + face.excess*unit*t[j])*inverseBehind;
            const Lanes dLength = -(dot(m, dP) + length*dc)*inverse;
            search.dP[j] = plus(plus(dP, length, dp), dLength, p);
            search.dp[j] = plus(dp, dBehind - dc, m);
            search.dLast[j] = -dBehind*inverseBehind;
        }
        search.P = plus(search.P, length, p);
        search.p = plus(p, behind - c, m);
        search.inverseLast = inverseBehind;
    }

    //! The step, with the derivatives of this ray or of the one that had them last.
    template<bool DERIVATIVES>
    void move(WedgeSearch& search) const
    {
        const Vector &p = search.p, &P = search.P;
        const Lanes length = search.height*search.inverseLast, w = search.path.weight;
        const Lanes missX = w*P.x + length*p.x - search.X.x, missY = w*P.y + length*p.y - search.X.y;
        if (DERIVATIVES)
        {
            const auto byX = [&](int j) { return w*search.dP[j].x + length*(search.dp[j].x + search.dLast[j]*p.x); };
            const auto byY = [&](int j) { return w*search.dP[j].y + length*(search.dp[j].y + search.dLast[j]*p.y); };
            const Lanes xx = byX(0), xy = byX(1), yx = byY(0), yy = byY(1), inverse = roughInverse(xx*yy - xy*yx);
            search.J[0][0] = yy*inverse;
            search.J[0][1] = -xy*inverse;
            search.J[1][0] = -yx*inverse;
            search.J[1][1] = xx*inverse;
        }
        const Lanes x = search.J[0][0]*missX + search.J[0][1]*missY, y = search.J[1][0]*missX + search.J[1][1]*missY;
        search.tx -= x;
        search.ty -= y;
        search.step2 = x*x + y*y;
        if (DERIVATIVES)
            search.bound2 = search.step2;
    }

    double unit, inner2, gap, after2;
    bool isInnerRarest;
};

//! A step of Newton's method; without DERIVATIVES it takes those of a step before.
template<bool DERIVATIVES>
inline void wedgeStep(const Stack& s, const TiltedFaces& window, Group<WedgeSearch>& group)
{
    const WedgeStages stages(s, window);
    group.each([&](WedgeSearch& search, Part) { stages.firstRoots(search); });
    group.each([&](WedgeSearch& search, Part)
    {
        stages.passFirst<DERIVATIVES>(search);
        stages.root(window.faces[1], search);
    });
    const int last = window.count - 1;
    for (int k = 1; k < last; k++)
        group.each([&](WedgeSearch& search, Part)
        {
            stages.pass<DERIVATIVES>(window.faces[k], search);
            stages.root(window.faces[k + 1], search);
        });
    group.each([&](WedgeSearch& search, Part)
    {
        stages.pass<DERIVATIVES>(window.faces[last], search);
        stages.move<DERIVATIVES>(search);
    });
}

/* The path through parallel faces, and the derivatives that it has: of the distance V by t is 1/ratio across the radius and slope along
it. What a step with them leaves is of second order in the wedge. */
inline void startWedge(const Stack& s, Group<WedgeSearch>& group)
{
    const double NEAR = 0.05;       // relative: the next step is a few times its cube
    const int STEPS = 3;
    group.each([&](WedgeSearch& search, Part) { search.ratio = firstRatio(s, search.path); });
    bool more = true;
    for (int k = 0; k < STEPS && more; k++)
    {
        group.each([&](WedgeSearch& search, Part)
        {
            const PathFunction<Lanes> F(s, search.path, search.ratio);
            search.step = halleyStep(F);
            search.slope = F.slope - 2*search.step*F.bend;
            search.ratio += search.step;
        });
        more = group.some([&](const WedgeSearch& search) { return absolute(search.step) > NEAR*search.ratio; });
    }
    group.each([&](WedgeSearch& search, Part)
    {
        const Lanes ratio = search.ratio, slope = search.slope, x = search.X.x, y = search.X.y;
        const Lanes along = (1 - ratio*slope)*roughInverse(larger(slope*search.path.radius2, all(1e-300)));
        search.tx = ratio*x;
        search.ty = ratio*y;
        search.J[0][0] = ratio + along*x*x;
        search.J[0][1] = search.J[1][0] = along*x*y;
        search.J[1][1] = ratio + along*y*y;
        search.bound2 = all(1e300);         // these derivatives are not the wedge's: no such step is the last
    });
}

//! What a step leaves is a few times itself times the step that its derivatives are from.
inline Lanes leftBy(const WedgeSearch& search) { return search.step2*search.bound2; }

//! Of leftBy.
inline Lanes enoughFor(const WedgeSearch& search)
{
    const double ENOUGH = 1e-16;
    return ENOUGH*ENOUGH*square(1 + search.tx*search.tx + search.ty*search.ty);
}

bool solveInWedge(const Stack& stack, const TiltedFaces& window, int n, const double* px, const double* py, const double* pz,
                  const double* pw, double* dx, double* dy, double* dz)
{
    const int STEPS = 10;
    const double MOST = 1e16;       // of t^2: what goes astray ends beyond, where every step is small
    const Stack s = stack;
    const Constants<9> axes(window.axes);
    const Face& last = window.faces[window.count - 1];
    Answers answers;
    eachGroup<WedgeSearch>(n, [&](Group<WedgeSearch>& group)
    {
        group.each([&](WedgeSearch& search, Part at)
        {
            const Lanes weight = pw ? load(pw, at) : all(1);
            const Vector X = intoFrame(axes.value, { load(px, at), load(py, at), load(pz, at) });
            search.X = X;
            search.height = dot(last.normal, X) - weight*last.distance;
            Path<Lanes>& path = search.path;
            path.weight = weight;
            path.scene = X.z - weight*s.total;
            path.radius2 = X.x*X.x + X.y*X.y;
        });
        startWedge(s, group);
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            if (k % 2 == 1)
                wedgeStep<true>(s, window, group);
            else
                wedgeStep<false>(s, window, group);
            more = group.some([&](const WedgeSearch& search) { return leftBy(search) > enoughFor(search); });
        }
        group.each([&](WedgeSearch& search, Part at)
        {
            const double inner2 = s.inner*s.inner, excess = inner2 - s.rarest*s.rarest;
            const Lanes t2 = search.tx*search.tx + search.ty*search.ty;
            const Mask good = search.good & (leftBy(search) <= enoughFor(search)) & (t2 < MOST);
            const Lanes kappa = excess > 0 ? s.rarest*inverseSqrt(inner2 + excess*t2) : all(1);
            const Vector d = outOfFrame(axes.value, { kappa*search.tx, kappa*search.ty, all(1) });
            store(answers.where(good, d.x), dx, at);
            store(d.y, dy, at);
            store(d.z, dz, at);
        });
    });
    return answers.complete();
}

constexpr WedgeKernels wedgeTable = { traceOutWedge, solveInWedge, chainWedge };

}}} // namespace

#endif // OPENCV_REFRACT_WEDGE_SIMD_HPP
