// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/match_noise.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! What the residuals of one match tell.
struct Told
{
    double squares, scale2;         //!< px^2; mean of the squared scales
    int count;                      //!< independent numbers in the squares
};

std::vector<Told> toldBy(const Matches& matches, const std::vector<std::vector<double>>& scales, const BundleAdjustment& fit)
{
    const int count = (int)matches.names.size();
    std::vector<Told> all(count, {0., 0., 0});
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        std::vector<Point2d> modelled;
        const RigidTransform& place = fit.fit.rig.extrinsics[c];
        refractiveProjectPoints(fit.points, rotationVector(place.R), place.T, fit.fit.rig.cameras[c], modelled);
        for (int i = 0; i < count; i++)
            if (fit.used[c][i] && seen(modelled[i]))
            {
                const Point2d miss = modelled[i] - matches.pixels[c][i];
                all[i].squares += miss.dot(miss);
                all[i].scale2 += scales[c][i]*scales[c][i];
                all[i].count++;
            }
    }
    all.erase(std::remove_if(all.begin(), all.end(), [](const Told& told) { return told.count < 2; }), all.end());
    for (Told& told : all)
    {
        told.scale2 /= told.count;
        told.count = 2*told.count - 3;
    }
    return all;
}

} // namespace

double MatchNoise::stdOf(double scale) const { return std::hypot(floor, share*scale); }

MatchNoise noiseOfMatches(const Matches& matches, const std::vector<std::vector<double>>& scales, const BundleAdjustment& fit)
{
    const int ITERATIONS = 50;
    const std::vector<Told> all = toldBy(matches, scales, fit);
    double squares = 0., scales2 = 0.;
    int count = 0;
    for (const Told& told : all)
    {
        squares += told.squares;
        scales2 += told.count*told.scale2;
        count += told.count;
    }
    if (count == 0)
        return {};
    // v = a + b s^2: Fisher scoring, each of the two 0 where the likelihood would have it below.
    double a = 0.5*squares/count, b = 0.5*squares/scales2;
    for (int iteration = 0; iteration < ITERATIONS; iteration++)
    {
        Matx22d H;
        Vec2d g;
        for (const Told& told : all)
        {
            const double v = a + b*told.scale2, weight = 1./(v*v);
            const Vec2d row(1., told.scale2);
            H += told.count*weight*(row*row.t());
            g += weight*told.squares*row;
        }
        const Vec2d best = H.solve(g, DECOMP_CHOLESKY);
        a = std::max(0., best[0]);
        b = std::max(0., best[1]);
        if (a <= 0.)
            b = g[1]/H(1, 1);
        else if (b <= 0.)
            a = g[0]/H(0, 0);
    }
    return {std::sqrt(a), std::sqrt(b)};
}

} // namespace tools
