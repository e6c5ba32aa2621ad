// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/match_noise.hpp"
#include "measure/chi_squared.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double RARE = 1e-4;               // of right matches: taken for a wrong one

//! Of right matches: v = floor^2 + share^2 s^2 by Fisher scoring, each of the two 0 where the likelihood would have it below.
MatchNoise likeliestNoise(const std::vector<MatchResidual>& residuals)
{
    const int ITERATIONS = 50;
    double squares = 0., scales2 = 0.;
    int count = 0;
    for (const MatchResidual& r : residuals)
    {
        squares += r.squares;
        scales2 += r.count*r.scale2;
        count += r.count;
    }
    if (count == 0)
        return {};
    const double LEAST = 1e-12;         // px^2: exact pixels have no noise
    double a = 0.5*squares/count, b = 0.5*squares/scales2;
    for (int iteration = 0; iteration < ITERATIONS; iteration++)
    {
        Matx22d H;
        Vec2d g;
        for (const MatchResidual& r : residuals)
        {
            const double v = std::max(LEAST, a + b*r.scale2), weight = 1./(v*v);
            const Vec2d row(1., r.scale2);
            H += r.count*weight*(row*row.t());
            g += weight*r.squares*row;
        }
        const Vec2d best = H.solve(g, DECOMP_CHOLESKY);
        a = std::max(0., best[0]);
        b = std::max(0., best[1]);
        if (a <= 0.)
            b = std::max(0., g[1]/H(1, 1));
        else if (b <= 0.)
            a = std::max(0., g[0]/H(0, 0));
    }
    return {std::sqrt(a), std::sqrt(b)};
}

//! Half of all residuals are below what the median of chi^2 has with it; the same at all scales.
MatchNoise noiseOfMedian(const std::vector<MatchResidual>& residuals)
{
    const double MEDIAN = 0.4549;       // of chi^2 with one degree of freedom
    std::vector<double> all;
    for (const MatchResidual& r : residuals)
        if (r.count > 0)
            all.push_back(r.squares/r.count);
    if (all.empty())
        return {};
    std::nth_element(all.begin(), all.begin() + all.size()/2, all.end());
    return {std::sqrt(all[all.size()/2]/MEDIAN), 0.};
}

} // namespace

double MatchNoise::stdOf(double scale) const { return std::hypot(floor, share*scale); }

double MatchNoise::varianceOf(const MatchResidual& residual) const { return floor*floor + share*share*residual.scale2; }

bool MatchResidual::isWithin(const MatchNoise& noise) const
{
    return count > 0 && (squares <= 0. || upperTailChiSquared(count, squares/noise.varianceOf(*this)) > RARE);
}

std::vector<MatchResidual> residualsOf(const ScaledMatches& scaled, const RigModel& rig)
{
    const Matches& matches = scaled.matches;
    Mat errors;
    triangulate(rig, matches.pixels, TRIANGULATE_OPTIMAL, errors);
    std::vector<MatchResidual> residuals;
    for (int i = 0; i < scaled.size(); i++)
    {
        MatchResidual r{0., 0., 0};
        int cameras = 0;
        for (int c = 0; c < matches.cameraCount(); c++)
            if (matches.isSeen(c, i))
            {
                const double error = errors.at<double>(i, c);
                r.squares += error*error;
                r.scale2 += scaled.scales[c][i]*scaled.scales[c][i];
                cameras++;
            }
        r.scale2 /= cameras;
        r.count = std::isfinite(r.squares) ? 2*cameras - 3 : 0;
        residuals.push_back(r);
    }
    return residuals;
}

MatchNoise noiseOf(const std::vector<MatchResidual>& residuals)
{
    const int ROUNDS = 20;
    MatchNoise noise = noiseOfMedian(residuals);
    size_t before = 0;
    for (int round = 0; round < ROUNDS; round++)
    {
        std::vector<MatchResidual> right;
        for (const MatchResidual& r : residuals)
            if (r.isWithin(noise))
                right.push_back(r);
        if (right.size() == before)
            break;
        before = right.size();
        noise = likeliestNoise(right);
    }
    return noise;
}

} // namespace tools
