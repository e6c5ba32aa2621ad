// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SPLINE_SIMD_HPP
#define OPENCV_REFRACT_SPLINE_SIMD_HPP

#include "lens/spline_model.hpp"
#include "lens/stereographic_model.hpp"
#include "simd/lanes.hpp"

/* mrcal's splined lens, see lens_splined.cpp. What a point is to its control points is computed for all lanes at once; the control
points, two numbers each and four side by side, fill registers of their own, one point after the other. */

namespace cv { namespace refract { namespace {

enum { PAIRS = 4, ROW = 2*PAIRS, ROW_REGISTERS = ROW/LANES };

//! By how much one point moves in the plane: rows of control points by their weights.
template<int ORDER>
inline void addControls(const double* controls, int stride, const double* pairWeights, const double* rowWeights, double* moved)
{
    double sums[ROW];
    for (int part = 0; part < ROW_REGISTERS; part++)
    {
        const Whole at = { part*LANES };
        Lanes sum = all(0);
        for (int j = 0; j <= ORDER; j++)
            sum += rowWeights[j*LANES]*load(controls + 2*j*stride, at);
        store(sum*load(pairWeights, at), sums, at);
    }
    for (int k = 0; k < 2; k++)
        moved[k*LANES] = (sums[k] + sums[2 + k]) + (sums[4 + k] + sums[6 + k]);
}

//! A register's points in the plane of the projection -> by how much the surface moves them.
template<int ORDER>
inline void addSurface(const SplineModel& m, Lanes gx, Lanes gy, Lanes* moved)
{
    const Whole here = { 0 };
    double g[2][LANES], sums[2*LANES], weights[(ORDER + 1)*LANES], pairWeights[LANES][ROW] = {};
    int first[LANES];
    store(gx, g[0], here);
    store(gy, g[1], here);
    for (int l = 0; l < LANES; l++)
    {
        const int cellX = splineCell<ORDER>(g[0][l], m.nx), cellY = splineCell<ORDER>(g[1][l], m.ny);
        first[l] = 2*((cellY - 1)*m.nx + cellX - 1);
        g[0][l] -= cellX;
        g[1][l] -= cellY;
    }
    Lanes across[ORDER + 1], down[ORDER + 1];
    splineWeights<ORDER>(load(g[0], here), across);
    splineWeights<ORDER>(load(g[1], here), down);
    for (int k = 0; k <= ORDER; k++)
    {
        store(across[k], weights, Whole{ k*LANES });
        for (int l = 0; l < LANES; l++)
            pairWeights[l][2*k] = pairWeights[l][2*k + 1] = weights[k*LANES + l];
    }
    for (int k = 0; k <= ORDER; k++)
        store(down[k], weights, Whole{ k*LANES });
    for (int l = 0; l < LANES; l++)
        addControls<ORDER>(m.controls + first[l], m.nx, pairWeights[l], weights + l, sums + l);
    moved[0] = load(sums, here);
    moved[1] = load(sums, Whole{ LANES });
}

//! Lanes whose cell leaves no doubt; a and b lie in the rectangle.
inline Mask isCertain(const SplineModel& m, Lanes a, Lanes b)
{
    if (!m.certain)
        return all(0) == 0;
    double p[2][LANES], certain[LANES];
    store((a + m.edge[0])*m.cellsPerUnit, p[0], Whole{ 0 });
    store((b + m.edge[1])*m.cellsPerUnit, p[1], Whole{ 0 });
    for (int l = 0; l < LANES; l++)
    {
        const int x = (int)p[0][l], y = (int)p[1][l];
        const int column = x < m.cellColumns ? x : m.cellColumns - 1, row = y < m.cellRows ? y : m.cellRows - 1;
        certain[l] = m.certain[row*m.cellColumns + column] == CERTAIN_CELL;
    }
    return load(certain, Whole{ 0 }) > 0;
}

bool projectSpline(const SplineModel& model, int n, const double* px, const double* py, const double* pz, double* u, double* v)
{
    const SplineModel m = model;
    Answers answers;
    eachRegister(n, [&](auto at)
    {
        const Lanes X = load(px, at), Y = load(py, at), Z = load(pz, at), r2 = X*X + Y*Y, length = sqrt(r2 + Z*Z);
        const Lanes scale = 2/stereographicDivisor(r2, length, Z), a = X*scale, b = Y*scale;
        const Mask inside = (absolute(a) <= m.edge[0]) & (absolute(b) <= m.edge[1]);
        const Lanes safeA = select(inside, a, all(0)), safeB = select(inside, b, all(0));
        const Lanes gx = splineCoordinate(safeA, m.perUnit, m.nx), gy = splineCoordinate(safeB, m.perUnit, m.ny);
        Lanes moved[2];
        if (m.order == 3)
            addSurface<3>(m, gx, gy, moved);
        else
            addSurface<2>(m, gx, gy, moved);
        store(answers.where(inside & isCertain(m, safeA, safeB), m.fx*(a + moved[0]) + m.cx), u, at);
        store(m.fy*(b + moved[1]) + m.cy, v, at);
    });
    return answers.complete();
}

constexpr SplineKernels splineTable = { projectSpline };

}}} // namespace

#endif // OPENCV_REFRACT_SPLINE_SIMD_HPP
