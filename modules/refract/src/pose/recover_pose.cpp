// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Relative pose from matches of which some are wrong. Pinholes' poses are where the search begins (central_pose.hpp). The scale
shows only in how the rays miss the pinholes; its likelihood has one parameter, the length of T, over which all others are
estimated (its profile). Far out refraction fades and the profile becomes flat: lengths are told from one side only.

Of a flat scene the likelihood has two minima far apart, equal without windows. So it is followed from each start that leads
elsewhere, and where two ends are as likely there is no answer. */

#include "pose/central_pose.hpp"
#include "pose/chance.hpp"
#include "pose/relative_pose.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include "math/least_squares.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include <array>
#include <map>
#include <numeric>

namespace cv { namespace refract {

namespace {

const double INFINITE = std::numeric_limits<double>::infinity(), NaN = std::numeric_limits<double>::quiet_NaN();

PixelMatches select(const PixelMatches& matches, const std::vector<int>& which)
{
    PixelMatches some;
    for (int i : which)
    {
        some.pixel1.push_back(matches.pixel1[i]);
        some.pixel2.push_back(matches.pixel2[i]);
    }
    return some;
}

//! A pose, and the matches that agree with it.
struct Candidate
{
    RelativePose pose;
    double cost = DBL_MAX;              //!< sum of squared errors, cut off at the limit
    std::vector<int> agreeing;
    std::vector<double> errors;         //!< of these
};

Candidate judge(const MatchedCameras& pair, const PixelMatches& matches, const RelativePose& pose, double limit)
{
    Candidate c;
    c.pose = pose;
    Vec3d T;
    std::vector<double> errors;
    if (!translation(pair, pose, T))
        return c;
    sampsonErrors(pair, matches, pose.R, T, errors, nullptr);
    c.cost = 0;
    for (size_t i = 0; i < errors.size(); i++)
    {
        const bool agrees = std::abs(errors[i]) <= limit;       // NaN does not
        c.cost += agrees ? errors[i]*errors[i] : limit*limit;
        if (!agrees)
            continue;
        c.agreeing.push_back((int)i);
        c.errors.push_back(errors[i]);
    }
    return c;
}

//! Lengths of T at which refraction may tell something, each twice the one before; 1 where it tells nothing.
std::vector<double> lengthsToTry(const MatchedCameras& pair)
{
    if (!pair.refracts())
        return { 1. };
    const double unit = std::max(pair.camera1.layers().stack().total, pair.camera2.layers().stack().total)
                        + norm(pair.centre1) + norm(pair.centre2);
    std::vector<double> lengths;
    for (double length = unit/64; length < 20000*unit; length *= 2)
        lengths.push_back(length);
    return lengths;
}

//! How likely strewn matches agree with a pose of five of them: the other pixel lies in a strip along the curve.
Sampling samplingOf(const PixelMatches& matches, double limit)
{
    const double POSES = 4;                 // of a sample, on average
    const Size2d extent = extentOf(matches.pixel2);
    const double strip = 2*std::sqrt(2.)*limit*std::hypot(extent.width, extent.height);
    return { 5, POSES, strip/std::max(extent.area(), DBL_MIN) };
}

//! Estimates R and baseline anew from what agrees, while that helps.
void improve(const MatchedCameras& pair, const PixelMatches& matches, double limit, Candidate& best)
{
    for (int k = 0; k < 5 && best.agreeing.size() > 6; k++)
    {
        RelativePose pose = best.pose;
        if (std::isnan(refineAtLength(pair, select(matches, best.agreeing), pose, 10)))
            return;
        const Candidate refined = judge(pair, matches, pose, limit);
        if (!(refined.cost < 0.999*best.cost))
            return;
        best = refined;
    }
}

//! From a pinholes' pose, at the length that suits it, with limits that become narrower as the pose becomes exact.
Candidate fromCentral(const MatchedCameras& pair, const PixelMatches& matches, RelativePose pose, double limit)
{
    const double WIDE = 16;
    Candidate best;
    for (double wide : { WIDE*limit, WIDE/4*limit, limit })
    {
        Candidate here;
        for (double length : lengthsToTry(pair))
        {
            pose.length = length;
            const Candidate c = judge(pair, matches, pose, wide);
            if (c.cost < here.cost)
                here = c;
        }
        improve(pair, matches, wide, here);
        best = here;
        pose = here.pose;
    }
    return best;
}

//! Lengths and the least sums of squared errors there.
struct Profile
{
    std::vector<RelativePose> poses;        //!< at growing lengths
    std::vector<double> costs;              //!< infinite where there is none
    int best() const { return (int)(std::min_element(costs.begin(), costs.end()) - costs.begin()); }
};

double costAt(const MatchedCameras& pair, const PixelMatches& matches, double length, RelativePose& pose)
{
    pose.length = length;
    const double cost = refineAtLength(pair, matches, pose, 30);
    return std::isnan(cost) ? INFINITE : cost;
}

//! From the start outwards, each length from its neighbour's pose.
Profile profileOf(const MatchedCameras& pair, const PixelMatches& matches, const RelativePose& start)
{
    const std::vector<double> lengths = lengthsToTry(pair);
    const int count = (int)lengths.size();
    int first = 0;
    while (first < count - 1 && lengths[first] < start.length)
        first++;
    Profile profile;
    profile.poses.assign(count, start);
    profile.costs.assign(count, INFINITE);
    for (int direction : { 1, -1 })
    {
        RelativePose pose = start;
        for (int i = direction > 0 ? first : first - 1; i >= 0 && i < count; i += direction)
        {
            RelativePose next = pose;
            profile.costs[i] = costAt(pair, matches, lengths[i], next);
            if (profile.costs[i] < INFINITE)
                pose = next;
            profile.poses[i] = next;
        }
    }
    return profile;
}

//! The least cost near the profile's best, by golden sections of the logarithm of the length.
double minimize(const MatchedCameras& pair, const PixelMatches& matches, const Profile& profile, RelativePose& pose)
{
    const int at = profile.best(), last = (int)profile.costs.size() - 1;
    pose = profile.poses[at];
    double cost = profile.costs[at];
    if (last == 0 || at == last || at == 0)
        return cost;
    const double GOLDEN = 0.381966;
    double low = profile.poses[at - 1].length, middle = pose.length, high = profile.poses[at + 1].length;
    for (int k = 0; k < 25; k++)
    {
        const bool upper = high/middle > middle/low;
        const double length = upper ? middle*std::pow(high/middle, GOLDEN) : middle*std::pow(low/middle, GOLDEN);
        RelativePose next = pose;
        const double there = costAt(pair, matches, length, next);
        if (there < cost)
        {
            (upper ? low : high) = middle;
            middle = length;
            cost = there;
            pose = next;
        }
        else
            (upper ? high : low) = length;
    }
    return cost;
}

//! Where the profile, from its minimum towards one of its ends, rises to a cost; `open` if it does not.
double crossing(const MatchedCameras& pair, const PixelMatches& matches, const Profile& profile, const RelativePose& best,
                double cost, int direction, double open)
{
    RelativePose inside = best;
    for (int i = 0; i < (int)profile.costs.size(); i++)
    {
        const int at = direction > 0 ? i : (int)profile.costs.size() - 1 - i;
        const RelativePose& node = profile.poses[at];
        if (direction*(node.length - best.length) <= 0)
            continue;
        if (profile.costs[at] <= cost)
        {
            inside = node;
            continue;
        }
        double outside = node.length;
        for (int k = 0; k < 20; k++)
        {
            RelativePose middle = inside;
            const double length = std::sqrt(inside.length*outside);
            if (costAt(pair, matches, length, middle) <= cost)
                inside = middle;
            else
                outside = length;
        }
        return inside.length;
    }
    return open;
}

//! What is estimated, and its worth.
struct Estimate
{
    RelativePose pose;
    Vec3d T;
    Matx66d covariance;
    Vec2d interval;
    std::vector<int> agreeing;
    double variance;                    //!< of an error
    std::vector<double> squares;        //!< errors of all matches, squared, cut off at the limit
    double cost() const { return std::accumulate(squares.begin(), squares.end(), 0.); }
};

//! The square of Student's t that 5 % exceed.
double quantile95(double freedom)
{
    const double z = 1.959964;
    return z*z*(1 + (z*z + 1)/(2*freedom));
}

//! Of errors with a variance of 1, by N parameters that move rotation vector and T as the columns of `motion` say.
template<int N>
Matx66d covarianceOf(const std::vector<Matx16d>& byPose, const Matx<double, 6, N>& motion)
{
    SumOfSquares<N> sum;
    for (const Matx16d& by : byPose)
        sum.add(0, (by*motion).val);
    return motion*inverseOfPositive(sum.curvature)*motion.t();
}

//! How the errors move with rotation vector and T, and their covariance if the errors' variance is 1.
Matx66d covarianceOf(const MatchedCameras& pair, const PixelMatches& matches, const RelativePose& pose, const Vec3d& T,
                     bool atLength, std::vector<Matx16d>& byPose)
{
    std::vector<double> errors;
    sampsonErrors(pair, matches, pose.R, T, errors, &byPose);
    return atLength ? covarianceOf(byPose, motionAtLength(pair, pose)) : covarianceOf(byPose, Matx66d::eye());
}

//! The matches that agree, without those that stand out among them.
std::vector<int> usual(const Candidate& candidate)
{
    const double CUT_NORMAL = 3.89;         // exceeded with a chance of 1e-4
    std::vector<double> sizes;
    for (double e : candidate.errors)
        sizes.push_back(std::abs(e));
    const double scale = std::max(LEAST_SCALE, median(sizes)/0.6745);
    std::vector<int> some;
    for (size_t i = 0; i < sizes.size(); i++)
        if (sizes[i] <= CUT_NORMAL*scale)
            some.push_back(candidate.agreeing[i]);
    return some;
}

/** Without matches that alone tell something of the pose, of whatever many others: none of these would show that one is wrong, and a
pose gains by turning until it agrees with a wrong one. So before a plane a single match off it is not believed. */
std::vector<int> confirmed(const MatchedCameras& pair, const PixelMatches& matches, const RelativePose& pose,
                           const std::vector<int>& chosen)
{
    const double MOST = 0.5;
    const size_t MANY = 60;
    Vec3d T;
    if (chosen.size() < MANY || !translation(pair, pose, T))
        return chosen;
    std::vector<Matx16d> byPose;
    const Matx66d C = covarianceOf(pair, select(matches, chosen), pose, T, !pair.refracts(), byPose);
    std::vector<int> some;
    for (size_t i = 0; i < chosen.size(); i++)
        if (!((byPose[i]*C*byPose[i].t())(0) > MOST))       // what part of its error a match's own pull takes
            some.push_back(chosen[i]);
    return some;
}

//! The most likely pose over all lengths, from a good one; false if too few matches agree.
bool estimate(const MatchedCameras& pair, const PixelMatches& matches, double limit, Candidate best, Estimate& e)
{
    std::vector<int> fitted;
    Profile profile;
    double cost = INFINITE;
    for (int k = 0; k < 5; k++)
    {
        const std::vector<int> next = confirmed(pair, matches, best.pose, usual(best));
        if (next.size() <= 6 || next == fitted)
            break;
        fitted = next;
        const PixelMatches some = select(matches, fitted);
        profile = profileOf(pair, some, best.pose);
        RelativePose pose;
        cost = minimize(pair, some, profile, pose);
        if (!(cost < INFINITE))
            return false;
        best = judge(pair, matches, pose, limit);
    }
    if (fitted.empty() || best.agreeing.size() <= 6)
        return false;
    const PixelMatches some = select(matches, fitted);
    const double freedom = (double)fitted.size() - (pair.refracts() ? 6 : 5), variance = cost/freedom;
    const double most = cost + quantile95(freedom)*variance;
    e.pose = best.pose;
    e.interval = Vec2d(0, INFINITE);
    if (pair.refracts())
        e.interval = Vec2d(crossing(pair, some, profile, best.pose, most, -1, 0),
                           crossing(pair, some, profile, best.pose, most, 1, INFINITE));
    if (e.pose.length >= profile.poses.back().length)       // most likely infinite
        costAt(pair, some, e.interval[0] > 0 ? e.interval[0] : 1, e.pose);
    if (!translation(pair, e.pose, e.T))
        return false;
    std::vector<Matx16d> byPose;
    e.covariance = variance*covarianceOf(pair, some, e.pose, e.T, e.interval[1] == INFINITE, byPose);
    e.agreeing = best.agreeing;
    e.variance = variance;
    e.squares.assign(matches.size(), limit*limit);
    for (size_t i = 0; i < best.agreeing.size(); i++)
        e.squares[best.agreeing[i]] = best.errors[i]*best.errors[i];
    return true;
}

//! Where the search from pinholes' poses ends, each place once.
std::vector<Candidate> placesOf(const MatchedCameras& pair, const PixelMatches& matches, double limit,
                                const std::vector<RelativePose>& starts)
{
    const double NEAR = 0.01;               // radians
    const double SAME = 1e-6;               // of several limits the same matches may agree
    std::vector<Candidate> places;
    for (auto start = starts.begin(); start != starts.end(); start++)
    {
        if (std::any_of(starts.begin(), start, [&](const RelativePose& other)
                        { return norm(other.R - start->R) < SAME && norm(other.baseline - start->baseline) < SAME; }))
            continue;
        const Candidate c = fromCentral(pair, matches, *start, limit);
        const auto same = std::find_if(places.begin(), places.end(), [&](const Candidate& place)
                                       { return norm(rotationVector(place.pose.R.t()*c.pose.R)) < NEAR; });
        if (same == places.end())
            places.push_back(c);
        else if (c.cost < same->cost)
            *same = c;
    }
    return places;
}

//! From one rotation vector to another, which may turn the long way round.
Vec3d difference(const Vec3d& from, Vec3d to)
{
    const double angle = norm(to);
    const Vec3d otherWay = angle > 0 ? to*(1 - 2*CV_PI/angle) : to;
    return norm(otherWay - from) < norm(to - from) ? otherWay - from : to - from;
}

/** Whether another estimate, and none of those that the covariance speaks of, is as likely. Which of two poses of a plane is right
shows in no single match: each is off both by noise alone, in directions of its own. So the costs differ by the sum of as many
random numbers, and by more only if one of the poses is wrong (@cite Vuong1989); if both agree with nearly as many matches, as
what was cut off is no noise. The covariance may be that at one length, at which both are compared. */
bool isRival(const MatchedCameras& pair, const PixelMatches& matches, const Estimate& e, const Estimate& other)
{
    const double FAR = 5, CERTAIN = 3;      // standard deviations
    const double LEFT = 1e-6;               // square pixels, that refineAtLength leaves
    const double AS_MANY = 0.9;
    double sum = 0, squares = 0;
    for (size_t i = 0; i < e.squares.size(); i++)
    {
        const double apart = other.squares[i] - e.squares[i];
        sum += apart;
        squares += apart*apart;
    }
    if ((double)other.agreeing.size() < AS_MANY*(double)e.agreeing.size() || sum > LEFT + CERTAIN*std::sqrt(squares))
        return false;
    RelativePose pose = other.pose;
    costAt(pair, select(matches, other.agreeing), e.pose.length, pose);
    const Vec3d off = difference(rotationVector(e.pose.R), rotationVector(pose.R));
    return off.dot(inverseOfPositive(e.covariance.get_minor<3, 3>(0, 0))*off)*e.variance > FAR*FAR*std::max(e.variance, LEFT);
}

bool recover(const Camera& camera1, const Camera& camera2, const PixelMatches& matches, double prob, double threshold,
             Estimate& e)
{
    const Bearings b1 = bearingsOf(camera1, matches.pixel1), b2 = bearingsOf(camera2, matches.pixel2);
    const MatchedCameras pair = { camera1, camera2, b1.centre, b2.centre };
    const std::vector<Candidate> places = placesOf(pair, matches, threshold,
                                                   centralPoses(b1, b2, threshold/camera1.lens().parameters()[0], prob));
    size_t most = 0;
    for (const Candidate& place : places)
        most = std::max(most, place.agreeing.size());
    std::vector<Estimate> estimates;
    for (const Candidate& place : places)
    {
        Estimate here;
        if (2*place.agreeing.size() >= most && estimate(pair, matches, threshold, place, here))
            estimates.push_back(here);
    }
    if (estimates.empty())
        return false;
    const auto best = std::min_element(estimates.begin(), estimates.end(),
                                       [](const Estimate& a, const Estimate& b) { return a.cost() < b.cost(); });
    e = *best;
    return !isChance((int)matches.size(), (int)e.agreeing.size(), samplingOf(matches, threshold))
           && std::none_of(estimates.begin(), estimates.end(), [&](const Estimate& other)
                           { return &other != &*best && isRival(pair, matches, e, other); });
}

} // namespace

/** Those that both cameras saw, each once: a copy tells nothing.
@param index of each, in the result; of one that was not seen: the result's size */
static PixelMatches differentMatches(const std::vector<Point2d>& all1, const std::vector<Point2d>& all2, std::vector<int>& index)
{
    PixelMatches matches;
    std::map<std::array<double, 4>, int> known;
    for (size_t i = 0; i < all1.size(); i++)
    {
        index.push_back(-1);
        if (!isSeen(all1[i]) || !isSeen(all2[i]))
            continue;
        const auto entry = known.insert({ { { all1[i].x, all1[i].y, all2[i].x, all2[i].y } }, (int)matches.size() });
        index.back() = entry.first->second;
        if (!entry.second)
            continue;
        matches.pixel1.push_back(all1[i]);
        matches.pixel2.push_back(all2[i]);
    }
    std::replace(index.begin(), index.end(), -1, (int)matches.size());
    return matches;
}

static int recoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                       const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                       OutputArray mask, Estimate& e)
{
    const Camera &c1 = cameraOf(camera1, "camera1"), &c2 = cameraOf(camera2, "camera2");
    const std::vector<Point2d> all1 = readPoints2(points1, "points1"), all2 = readPoints2(points2, "points2");
    const int count = (int)all1.size();
    if (all1.size() != all2.size())
        CV_Error_(Error::StsUnmatchedSizes, ("points1 has %d points, points2 %d; they must agree", count, (int)all2.size()));
    if (count < 6)
        CV_Error_(Error::StsBadArg, ("points1 has %d points; a relative pose needs at least 6", count));
    if (!(prob > 0 && prob < 1))
        CV_Error_(Error::StsOutOfRange, ("prob is %g; it must lie between 0 and 1", prob));
    if (!(threshold > 0) || !std::isfinite(threshold))
        CV_Error_(Error::StsOutOfRange, ("threshold is %g; it must be positive", threshold));
    std::vector<int> index;
    const PixelMatches matches = differentMatches(all1, all2, index);
    const bool found = recover(c1, c2, matches, prob, threshold, e);
    std::vector<uchar> chosen(matches.size() + 1, 0);           // the last: what was not seen
    for (size_t i = 0; found && i < e.agreeing.size(); i++)
        chosen[e.agreeing[i]] = 1;
    Mat agrees(count, 1, CV_8U);
    for (int i = 0; i < count; i++)
        agrees.at<uchar>(i) = chosen[index[i]];
    if (mask.needed())
        agrees.copyTo(mask);
    if (!found)
        return 0;
    Mat(e.pose.R).copyTo(R);
    Mat(e.T).copyTo(T);
    return countNonZero(agrees);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                          const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask)
{
    CV_INSTRUMENT_REGION();

    Estimate e;
    return recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, e);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, InputArray cameraMatrix1, InputArray distCoeffs1,
                          const GlassWindow& window1, InputArray cameraMatrix2, InputArray distCoeffs2,
                          const GlassWindow& window2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask)
{
    CV_INSTRUMENT_REGION();

    return refractiveRecoverPose(points1, points2, RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                                 RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2), R, T, prob, threshold, mask);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                          const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask, OutputArray covariance, Vec2d& scaleInterval)
{
    CV_INSTRUMENT_REGION();

    Estimate e;
    const int count = recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, e);
    scaleInterval = count > 0 ? e.interval : Vec2d(NaN, NaN);
    Mat(count > 0 ? e.covariance : Matx66d::all(NaN)).copyTo(covariance);
    return count;
}

}} // namespace
