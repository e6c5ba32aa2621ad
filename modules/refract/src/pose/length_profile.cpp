// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/length_profile.hpp"
#include "math/quantile.hpp"

namespace cv { namespace refract {

namespace {

const double INFINITE = std::numeric_limits<double>::infinity();

double costAt(const MatchedCameras& pair, const PixelMatches& matches, double length, RigidTransform& pose)
{
    setLength(pair, length, pose);
    return refineAtLength(pair, matches, pose, 30);
}

//! The square of Student's t that 5 % exceed.
double quantile95(double freedom)
{
    const double z = 1.959964;
    return z*z*(1 + (z*z + 1)/(2*freedom));
}

//! Squared distance from a point to the sphere |x| = radius where the squared length of x is sum m_i x_i^2.
double squaredDistanceToSphere(const Vec3d& point, double radius, const Vec3d& m)
{
    // x_i = m_i p_i/(m_i + mu): the least mu for which |x| = radius is between -min(m) and where all terms are too small.
    double low = -std::min(m[0], std::min(m[1], m[2])), high = std::max(m[0], std::max(m[1], m[2]))*norm(point)/radius;
    const auto at = [&](double mu) { return Vec3d(m[0]*point[0]/(m[0] + mu), m[1]*point[1]/(m[1] + mu), m[2]*point[2]/(m[2] + mu)); };
    for (int k = 0; k < 40; k++)
    {
        const double middle = (low + high)/2;
        (norm(at(middle)) > radius ? low : high) = middle;
    }
    const Vec3d off = at(high) - point;
    return m[0]*off[0]*off[0] + m[1]*off[1]*off[1] + m[2]*off[2]*off[2];
}

//! By how much the sum of squares at the true length is above the least one in 95 % of all cases, in variances.
class ExcessQuantile
{
public:
    explicit ExcessQuantile(const LengthEvidence& evidence) : student_(quantile95(evidence.freedom))
    {
        isKnown_ = checkRange(Mat(evidence.covariance)) && eigen(evidence.covariance, variances_, axes_) && variances_[2] > 0;
        RNG random(0x4C454E47);
        for (int i = 0; i < DRAWS; i++)
            draws_.push_back(Vec3d(random.gaussian(1), random.gaussian(1), random.gaussian(1)));
    }

    double operator()(const Vec3d& T) const
    {
        const double STRAIGHT = 20;             // standard deviations
        if (!isKnown_ || norm(T) > STRAIGHT*std::sqrt(variances_[0]))
            return student_;
        const Vec3d centre = axes_*T, m(1/variances_[0], 1/variances_[1], 1/variances_[2]);
        std::vector<double> excess;
        for (const Vec3d& draw : draws_)
        {
            const Vec3d point(centre[0] + draw[0]*std::sqrt(variances_[0]), centre[1] + draw[1]*std::sqrt(variances_[1]),
                              centre[2] + draw[2]*std::sqrt(variances_[2]));
            excess.push_back(squaredDistanceToSphere(point, norm(T), m));
        }
        const double NORMAL = 3.841459;         // of one parameter, with as many observations as one likes
        return student_*std::max(1., quantile(std::move(excess), 0.95)/NORMAL);
    }

private:
    static const int DRAWS = 1000;
    double student_;
    bool isKnown_;
    Vec3d variances_;
    Matx33d axes_;                              // rows
    std::vector<Vec3d> draws_;
};

/** Where, from the most likely length on, lengths are ruled out; `open` if none is.
@param pose in: the most likely one, out: at the last length that is not ruled out */
template<typename Excess>
double lastPossible(const MatchedCameras& pair, double factor, double open, const Excess& excess, RigidTransform& pose)
{
    const double DIGITS = 1e-4;
    const std::vector<double> lengths = lengthsToTry(pair);
    const double ZERO = 1e-6;           // of the shortest length to try
    const double length = norm(pose.t), limit = factor > 1 ? lengths.back() : ZERO*lengths.front();
    double inside = std::log(length), inner = -1;       // of the excess less its quantile
    for (double next = length*factor; ; next *= factor)
    {
        const double clamped = next < lengths.front() || next > lengths.back() ? limit : next;
        RigidTransform there = pose;
        double outer = excess(clamped, there);
        if (outer > 0)
        {
            // Regula falsi in the logarithm, the end that stays having half its weight (Illinois).
            double outside = std::log(clamped);
            for (int k = 0; k < 40 && std::abs(outside - inside) > DIGITS; k++)
            {
                const double part = outer < INFINITE && k % 4 < 3 ? inner/(inner - outer) : 0.5;
                const double middle = inside + part*(outside - inside);
                RigidTransform between = pose;
                const double value = excess(std::exp(middle), between);
                if (value <= 0)
                {
                    inside = middle;
                    inner = value;
                    outer /= 2;
                    pose = between;
                }
                else
                {
                    outside = middle;
                    outer = value;
                    inner /= 2;
                }
            }
            return std::exp(inside);
        }
        pose = there;
        if (clamped == limit)
            return open;
        inside = std::log(clamped);
        inner = outer;
    }
}

} // namespace

std::vector<double> lengthsToTry(const MatchedCameras& pair)
{
    if (!pair.refracts())
        return { 1. };
    const double unit = pair.depth();
    std::vector<double> lengths;
    for (double length = unit/512; length < 20000*unit; length *= 2)
        lengths.push_back(length);
    return lengths;
}

RigidTransform mostLikelyLength(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& start)
{
    const std::vector<double> lengths = lengthsToTry(pair);
    const int count = (int)lengths.size();
    int first = 0;
    while (first < count - 1 && lengths[first] < norm(start.t))
        first++;
    RigidTransform best = start;
    double least = INFINITE;
    for (int direction : { 1, -1 })
    {
        RigidTransform pose = start;
        for (int i = direction > 0 ? first : first - 1; i >= 0 && i < count; i += direction)
        {
            RigidTransform next = pose;
            const double cost = costAt(pair, matches, lengths[i], next);
            if (cost < INFINITE)
                pose = next;
            if (cost < least)
            {
                least = cost;
                best = next;
            }
        }
    }
    return best;
}

LengthInterval lengthInterval(const MatchedCameras& pair, const PixelMatches& matches, const LengthEvidence& evidence)
{
    LengthInterval interval = { Vec2d(0, INFINITE), { evidence.pose, evidence.pose } };
    if (!pair.refracts())
        return interval;
    const ExcessQuantile quantile(evidence);
    const double variance = evidence.cost/evidence.freedom;
    const auto excess = [&](double length, RigidTransform& pose)
    {
        const double cost = costAt(pair, matches, length, pose);
        return cost - evidence.cost - quantile(pose.t)*variance;
    };
    interval.lengths[0] = lastPossible(pair, 0.5, 0, excess, interval.ends[0]);
    interval.lengths[1] = lastPossible(pair, 2, INFINITE, excess, interval.ends[1]);
    return interval;
}

}} // namespace
