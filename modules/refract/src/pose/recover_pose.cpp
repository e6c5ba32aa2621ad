// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Relative pose from matches of which some are wrong. About their mean origins the rays are nearly central:
cv::findEssentialMat on the bearings, with limits from the caller's to many times that, gives R and the baseline. The scale shows
only in how the rays miss the mean origins; its likelihood has one parameter, the length of T, over which all others are estimated
(its profile). Far out refraction fades and the profile becomes flat: lengths are told from one side only. */

#include "pose/chance.hpp"
#include "pose/relative_pose.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include "math/least_squares.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include <array>
#include <set>

namespace cv { namespace refract {

namespace {

const double INFINITE = std::numeric_limits<double>::infinity(), NaN = std::numeric_limits<double>::quiet_NaN();

//! A camera as a pinhole at its rays' mean origin.
struct Bearings
{
    Matx33d turn = Matx33d::eye();          //!< camera -> pinhole, which looks along the mean ray
    Vec3d centre;                           //!< of the pinhole, in the camera
    std::vector<Point2d> normalized;        //!< NaN where there is no ray in front
};

Bearings bearingsOf(const Camera& camera, const std::vector<Point2d>& pixels)
{
    Bearings b;
    std::vector<Vec3d> directions(pixels.size(), Vec3d::all(NaN));
    Vec3d look;
    int found = 0;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        double tau;
        Vec3d d;
        uchar status = REFRACT_OK;
        camera.unproject(1, &pixels[i].x, &pixels[i].y, &tau, &d[0], &d[1], &d[2], &status);
        if (status != REFRACT_OK)
            continue;
        directions[i] = d;
        look += d;
        b.centre += tau*camera.layers().normal();
        found++;
    }
    b.normalized.assign(pixels.size(), Point2d(NaN, NaN));
    if (!(norm(look) > 0))
        return b;
    b.centre *= 1./found;
    const Vec3d axis = normalize(look).cross(Vec3d(0, 0, 1));
    const double sine = norm(axis);
    b.turn = sine > 0 ? rotationMatrix(axis*(std::atan2(sine, normalize(look)[2])/sine)) : Matx33d::eye();
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Vec3d d = b.turn*directions[i];
        if (d[2] > 0.05)                    // normalised coordinates end before 90 degrees
            b.normalized[i] = Point2d(d[0]/d[2], d[1]/d[2]);
    }
    return b;
}

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

//! Poses of pinholes at the centres, for several limits.
std::vector<RelativePose> centralPoses(const Camera& camera1, const Bearings& b1, const Bearings& b2, double prob,
                                       double threshold)
{
    std::vector<Point2d> n1, n2;
    for (size_t i = 0; i < b1.normalized.size(); i++)
        if (isSeen(b1.normalized[i]) && isSeen(b2.normalized[i]))
        {
            n1.push_back(b1.normalized[i]);
            n2.push_back(b2.normalized[i]);
        }
    std::vector<RelativePose> poses;
    if (n1.size() < 6)
        return poses;
    const double focalLength = camera1.lens().parameters()[0];
    for (double limit = threshold; limit <= 32*threshold; limit *= 2)
    {
        Mat mask, R, t;
        const Mat E = findEssentialMat(n1, n2, Mat(Matx33d::eye()), RANSAC, prob, limit/focalLength, 1000, mask);
        if (E.rows != 3 || recoverPose(E, n1, n2, Mat(Matx33d::eye()), R, t, 1e9, mask) < 6)
            continue;
        poses.push_back({ b2.turn.t()*Matx33d(R)*b1.turn, b2.turn.t()*Vec3d(t.ptr<double>()), 1 });
    }
    return poses;
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
};

//! The square of Student's t that 5 % exceed.
double quantile95(double freedom)
{
    const double z = 1.959964;
    return z*z*(1 + (z*z + 1)/(2*freedom));
}

//! Of N parameters that move rotation vector and T as the columns of `motion` say.
template<int N>
Matx66d covarianceOf(const std::vector<double>& errors, const std::vector<Matx16d>& byPose, const Matx<double, 6, N>& motion,
                     double variance)
{
    SumOfSquares<N> sum;
    for (size_t i = 0; i < errors.size(); i++)
        sum.add(errors[i], (byPose[i]*motion).val);
    return variance*(motion*inverseOfPositive(sum.curvature)*motion.t());
}

Matx66d covarianceOf(const MatchedCameras& pair, const PixelMatches& matches, const RelativePose& pose, const Vec3d& T,
                     double variance, bool atLength)
{
    std::vector<double> errors;
    std::vector<Matx16d> byPose;
    sampsonErrors(pair, matches, pose.R, T, errors, &byPose);
    return atLength ? covarianceOf(errors, byPose, motionAtLength(pair, pose), variance)
                    : covarianceOf(errors, byPose, Matx66d::eye(), variance);
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

//! The most likely pose over all lengths, from a good one; false if too few matches agree.
bool estimate(const MatchedCameras& pair, const PixelMatches& matches, double limit, Candidate best, Estimate& e)
{
    std::vector<int> fitted;
    Profile profile;
    double cost = INFINITE;
    for (int k = 0; k < 5; k++)
    {
        const std::vector<int> next = usual(best);
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
    if (e.pose.length >= profile.poses.back().length && e.interval[0] > 0)      // most likely infinite
        costAt(pair, some, e.interval[0], e.pose);
    if (!translation(pair, e.pose, e.T))
        return false;
    e.covariance = covarianceOf(pair, some, e.pose, e.T, variance, e.interval[1] == INFINITE);
    e.agreeing = best.agreeing;
    return true;
}

//! How many of the matches are not copies of others, which tell nothing.
size_t countDifferent(const PixelMatches& matches, const std::vector<int>& chosen)
{
    std::set<std::array<double, 4> > different;
    for (int i : chosen)
        different.insert({ { matches.pixel1[i].x, matches.pixel1[i].y, matches.pixel2[i].x, matches.pixel2[i].y } });
    return different.size();
}

bool recover(const Camera& camera1, const Camera& camera2, const PixelMatches& matches, double prob, double threshold,
             Estimate& e)
{
    const Bearings b1 = bearingsOf(camera1, matches.pixel1), b2 = bearingsOf(camera2, matches.pixel2);
    const MatchedCameras pair = { camera1, camera2, b1.centre, b2.centre };
    Candidate best;
    for (const RelativePose& pose : centralPoses(camera1, b1, b2, prob, threshold))
    {
        const Candidate c = fromCentral(pair, matches, pose, threshold);
        if (c.cost < best.cost)
            best = c;
    }
    return countDifferent(matches, best.agreeing) > 6 && estimate(pair, matches, threshold, best, e)
           && !isChance((int)matches.size(), (int)e.agreeing.size(), samplingOf(matches, threshold));
}

} // namespace

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
    PixelMatches matches;
    std::vector<int> index;
    for (int i = 0; i < count; i++)
        if (isSeen(all1[i]) && isSeen(all2[i]))
        {
            matches.pixel1.push_back(all1[i]);
            matches.pixel2.push_back(all2[i]);
            index.push_back(i);
        }
    const bool found = recover(c1, c2, matches, prob, threshold, e);
    Mat agrees(count, 1, CV_8U, Scalar(0));
    for (size_t i = 0; found && i < e.agreeing.size(); i++)
        agrees.at<uchar>(index[e.agreeing[i]]) = 1;
    if (mask.needed())
        agrees.copyTo(mask);
    if (!found)
        return 0;
    Mat(e.pose.R).copyTo(R);
    Mat(e.T).copyTo(T);
    return (int)e.agreeing.size();
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
