// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_LAYERS_SIMD_HPP
#define OPENCV_REFRACT_LAYERS_SIMD_HPP

#include "simd/vectors.hpp"
#include "window/path.hpp"

/* The physics of parallel layers, see layers.hpp. */

namespace cv { namespace refract { namespace {

bool traceOut(const Stack& stack, int n, const double* wx, const double* wy, const double* wz,
              double* tau, double* dx, double* dy, double* dz)
{
    const Stack s = stack;      // a copy that no store can change stays in registers
    const Constants<3> normal(s.normal);
    const double scale = s.inner/s.outer, inner2 = s.inner*s.inner, outer2 = s.outer*s.outer;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes x = load(wx, at), y = load(wy, at), z = load(wz, at);
        const Lanes c = normal[0]*x + normal[1]*y + normal[2]*z, c2 = inner2*c*c;
        // q^2 = n^2 - p^2 by the cosine: no cancellation near grazing where the medium is the camera's
        const Lanes qOut2 = (outer2 - inner2) + c2, qOut = s.inner == s.outer ? s.inner*c : sqrt(qOut2);
        Mask good = (c > 0) & (qOut2 > 0);
        Lanes sum = all(0);
        for (int k = 0; k < s.count; k++)
        {
            const Medium& medium = s.media[k];
            if (medium.isScene)
                continue;
            const Lanes q2 = (medium.index2 - inner2) + c2;
            good &= q2 > 0;
            sum += medium.height/medium.scale*(1 - qOut*inverseSqrt(q2));
        }
        const Lanes along = qOut*(1/s.outer) - scale*c;
        store(answers.where(good, sum), tau, at);
        store(scale*x + along*normal[0], dx, at);
        store(scale*y + along*normal[1], dy, at);
        store(scale*z + along*normal[2], dz, at);
    });
    return answers.complete();
}

struct Search
{
    Path<Lanes> path;
    Lanes ratio, step;      //!< t / V, and the last step of it
};

inline Lanes halleyStep(const PathFunction<Lanes>& F)
{
    return -F.value*F.slope*roughInverse(F.slope*F.slope + F.value*F.bend);
}

bool solveIn(const Stack& stack, int n, const double* px, const double* py, const double* pz, const double* pw,
             double* dx, double* dy, double* dz, double* ratio)
{
    // The relative error after a Halley step is a few times the cube of the relative step.
    const double ENOUGH = 1e-5;
    const int STEPS = 8;
    const Stack s = stack;
    Answers answers;
    eachGroup<Search>(n, [&](Group<Search>& group)
    {
        group.each([&](Search& search, Part at)
        {
            search.path = pathTo(s, load(px, at), load(py, at), load(pz, at), pw ? load(pw, at) : all(1));
            search.ratio = firstRatio(s, search.path);
        });
        bool more = true;
        for (int k = 0; k < STEPS && more; k++)
        {
            group.each([&](Search& search, Part)
            {
                search.step = halleyStep(PathFunction<Lanes>(s, search.path, search.ratio));
                search.ratio += search.step;
            });
            more = group.some([&](const Search& search) { return absolute(search.step) > ENOUGH*search.ratio; });
        }
        group.each([&](Search& search, Part at)
        {
            const Path<Lanes>& path = search.path;
            const Mask good = (path.scene > 0) & (absolute(search.step) <= ENOUGH*search.ratio);
            Lanes d[3];
            direction(s, path, search.ratio, d);
            store(answers.where(good, d[0]), dx, at);
            store(d[1], dy, at);
            store(d[2], dz, at);
            if (ratio)
                store(search.ratio, ratio, at);
        });
    });
    return answers.complete();
}

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
        for (int k = 0; k < s.layers; k++)
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

//! d kappa by every height and index.
template<typename Put>
inline void mediaDerivatives(const Stack& s, const PathDerivative& d, const Put& put)
{
    for (int k = 0; k < s.layers; k++)
    {
        const double index = s.indices[k];
        const Lanes inverse = d.inverseQ(index);
        put(k == 0 ? s.at.distance : s.at.thickness + k - 1, d.Arho*(d.inverseOut - inverse));
        if (k > 0)
            put(s.at.index + k - 1, d.Arho*s.heights[k]*index*inverse*inverse*inverse);
    }
    const Lanes byInner = s.inner*d.inverseIn*d.inverseIn*d.inverseIn;
    put(s.at.innerIndex, (d.Arho*s.heights[0] - d.rho)*byInner);
    put(s.at.outerIndex, d.Arho*d.hOut*(s.outer*d.inverseOut*d.inverseOut*d.inverseOut));
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
        for (int row = 0; row < rows; row++)
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
            storeAt(m.x - along*normal[0], byWindow, row, s.at.normal, at);
            storeAt(m.y - along*normal[1], byWindow, row, s.at.normal + 1, at);
            storeAt(m.z - along*normal[2], byWindow, row, s.at.normal + 2, at);
            mediaDerivatives(s, d, [&](int column, Lanes dKappa) { storeAt(f*dKappa, byWindow, row, column, at); });
        }
    });
}

constexpr LayerKernels layerTable = { traceOut, solveIn, chainWindow };

}}} // namespace

#endif // OPENCV_REFRACT_LAYERS_SIMD_HPP
