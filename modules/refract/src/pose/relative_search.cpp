// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/relative_search.hpp"
#include "pose/length_profile.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

static const double INFINITE = std::numeric_limits<double>::infinity();

Consensus consensusOf(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& motion, double limit)
{
    Consensus c;
    std::vector<double> errors;
    c.motion = motion;
    c.cost = 0;
    sampsonErrors(pair, matches, motion, errors, nullptr, limit);
    for (size_t i = 0; i < errors.size(); i++)
        c.add((int)i, errors[i], limit);
    return c;
}

bool isInfinitelyFar(const MatchedCameras& pair, const RigidTransform& motion)
{
    return pair.refracts() && norm(motion.t) >= 0.99*lengthsToTry(pair).back();
}

double refineLength(const MatchedCameras& pair, const PixelMatches& matches, RigidTransform& motion, int iterations)
{
    double cost = INFINITE;
    if (pair.refracts() && !isInfinitelyFar(pair, motion))
        cost = refine(pair, matches, motion, iterations);
    if (cost < INFINITE && !isInfinitelyFar(pair, motion))
        return cost;
    setLength(pair, lengthsToTry(pair).back(), motion);
    return refineAtLength(pair, matches, motion, iterations);
}

namespace {

//! Estimates the pose anew from the inliers, while that helps.
void localOptimize(const MatchedCameras& pair, const PixelMatches& matches, double limit, Consensus& best)
{
    for (int k = 0; k < 5 && best.inliers.size() > 6; k++)
    {
        RigidTransform pose = best.motion;
        if (!(refineLength(pair, select(matches, best.inliers), pose, 10) < INFINITE))
            return;
        Consensus refined = consensusOf(pair, matches, pose, limit);
        if (!(refined.cost < 0.999*best.cost))
            return;
        best = std::move(refined);
    }
}

//! From a pinholes' pose, at the length that suits it, with limits that become narrower as the pose becomes exact.
Consensus fromCentral(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pinholes, double limit)
{
    const double WIDE = 16;
    Consensus best;
    best.motion = { pinholes.R, pair.centre2 - pinholes.R*pair.centre1 + (pair.refracts() ? pair.depth() : 1.)*pinholes.t };
    for (double wide : { WIDE*limit, WIDE/4*limit, limit })
    {
        Consensus here;
        for (double length : lengthsToTry(pair))
        {
            RigidTransform motion = best.motion;
            if (!setLength(pair, length, motion))
                continue;
            Consensus c = consensusOf(pair, matches, motion, wide);
            if (c.cost < here.cost)
                here = std::move(c);
        }
        if (here.inliers.empty())
            return here;
        localOptimize(pair, matches, wide, here);
        best = std::move(here);
    }
    return best;
}

} // namespace

PixelMatches sampleOf(const PixelMatches& matches)
{
    const size_t MOST = 500;
    PixelMatches some;
    RNG random(0x53554253);
    size_t left = matches.size(), wanted = std::min(MOST, left);
    for (size_t i = 0; i < matches.size() && wanted > 0; i++, left--)
        if (random.uniform(0., 1.)*(double)left < (double)wanted)
        {
            some.push_back(matches[i]);
            wanted--;
        }
    return some;
}

std::vector<Consensus> placesOf(const MatchedCameras& pair, const PixelMatches& matches, double limit,
                                const std::vector<RigidTransform>& starts)
{
    const double NEAR = 0.01;               // radians
    const double SAME = 1e-6;               // of several limits the same matches may be inliers
    std::vector<Consensus> places;
    for (auto start = starts.begin(); start != starts.end(); start++)
    {
        if (std::any_of(starts.begin(), start, [&](const RigidTransform& other)
                        { return norm(other.R - start->R) < SAME && norm(other.t - start->t) < SAME; }))
            continue;
        const Consensus c = fromCentral(pair, matches, *start, limit);
        const auto same = std::find_if(places.begin(), places.end(), [&](const Consensus& place)
                                       { return norm(rotationVector(place.motion.R.t()*c.motion.R)) < NEAR; });
        if (same == places.end())
            places.push_back(c);
        else if (c.cost < same->cost)
            *same = c;
    }
    return places;
}

}} // namespace
