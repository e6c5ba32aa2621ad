// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Relative pose from matches of which some are wrong. The search, on a part of the matches where there are many, begins with
pinholes' poses (central_pose.hpp), and is followed by a fit of all inliers. The scale shows only in how the rays miss the pinholes;
what is known of it is the likelihood's profile (length_profile.hpp).

Of a flat scene the likelihood has two minima far apart, equal without windows. So it is followed from each start that leads
elsewhere, and where two ends are as likely there is no answer. */

#include "pose/central_pose.hpp"
#include "pose/chance.hpp"
#include "pose/consensus.hpp"
#include "pose/length_profile.hpp"
#include "pose/pose_covariance.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include "math/least_squares.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include "window/parameters.hpp"
#include <array>
#include <map>
#include <numeric>

namespace cv { namespace refract {

namespace {

const double INFINITE = std::numeric_limits<double>::infinity(), NaN = std::numeric_limits<double>::quiet_NaN();

//! Pixels of camera 1 and of camera 2.
typedef std::pair<std::vector<Point2d>, std::vector<Point2d> > MatchedPixels;

Consensus score(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& motion, double limit)
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

//! How likely uniformly random matches agree with a pose of five of them: the other pixel lies in a strip along the curve.
Sampling samplingOf(const std::vector<Point2d>& pixels2, double limit)
{
    const double POSES = 4;                 // of a sample, on average
    const Size2d extent = extentOf(pixels2);
    const double strip = 2*std::sqrt(2.)*limit*std::hypot(extent.width, extent.height);
    return { 5, POSES, strip/std::max(extent.area(), DBL_MIN) };
}

bool isInfinitelyFar(const MatchedCameras& pair, const RigidTransform& motion)
{
    return pair.refracts() && norm(motion.t) >= 0.99*lengthsToTry(pair).back();
}

//! The most likely pose near this one: over all lengths, if windows tell them and they are finite.
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

//! Estimates the pose anew from the inliers, while that helps.
void localOptimize(const MatchedCameras& pair, const PixelMatches& matches, double limit, Consensus& best)
{
    for (int k = 0; k < 5 && best.inliers.size() > 6; k++)
    {
        RigidTransform pose = best.motion;
        if (!(refineLength(pair, select(matches, best.inliers), pose, 10) < INFINITE))
            return;
        Consensus refined = score(pair, matches, pose, limit);
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
            Consensus c = score(pair, matches, motion, wide);
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

//! What is estimated, and its worth.
struct Estimate
{
    RigidTransform motion;
    Matx66d covariance;
    Vec2d interval;
    RigidTransform likely;              //!< of all lengths, though the most likely one be infinite
    Matx66d ofNoise;                    //!< covariance of that, all lengths
    std::vector<int> fitted, inliers;
    double variance;                    //!< of an error
    std::vector<double> squares;        //!< errors of all matches, squared, cut off at the limit
    double cost() const { return std::accumulate(squares.begin(), squares.end(), 0.); }
};

//! Of errors with a variance of 1, by N parameters that move rotation vector and T as the columns of `motion` say.
template<int N>
Matx66d covarianceOf(const std::vector<Matx16d>& byPose, const Matx<double, 6, N>& motion)
{
    SumOfSquares<N> sum;
    for (const Matx16d& by : byPose)
        sum.add(0, (by*motion).val);
    return motion*inverseOfPositive(sum.curvature)*motion.t();
}

/** How the errors move with rotation vector and T, and their covariance if the errors' variance is 1. That all points are in front is
an inequality and no observation: at its bound the errors rise steeply on one side, and say nothing of the other. */
Matx66d covarianceOf(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose, bool atLength,
                     std::vector<Matx16d>& byPose)
{
    const double OF_LINES = 0;              // the errors of rays that may meet anywhere
    std::vector<double> errors;
    sampsonErrors(pair, matches, pose, errors, &byPose, OF_LINES);
    return atLength ? covarianceOf(byPose, motionAtLength(pose)) : covarianceOf(byPose, Matx66d::eye());
}

//! The inliers without those that stand out among them.
std::vector<int> withoutOutliers(const Consensus& consensus)
{
    const double CUT_NORMAL = 3.89;         // exceeded with a chance of 1e-4
    std::vector<double> sizes;
    for (double e : consensus.errors)
        sizes.push_back(std::abs(e));
    const double scale = std::max(LEAST_SCALE, median(sizes)/0.6745);
    std::vector<int> some;
    for (size_t i = 0; i < sizes.size(); i++)
        if (sizes[i] <= CUT_NORMAL*scale)
            some.push_back(consensus.inliers[i]);
    return some;
}

/** Without matches that alone tell something of the pose, of whatever many others: none of these would show that one is wrong, and a
pose gains by turning until it agrees with a wrong one. So before a plane a single match off it is not believed. */
std::vector<int> withoutHighLeverage(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose,
                                     const std::vector<int>& chosen)
{
    const double MOST = 0.5;
    const size_t MANY = 60;
    if (chosen.size() < MANY)
        return chosen;
    std::vector<Matx16d> byPose;
    const Matx66d C = covarianceOf(pair, select(matches, chosen), pose, !pair.refracts(), byPose);
    std::vector<int> some;
    for (size_t i = 0; i < chosen.size(); i++)
        if (!((byPose[i]*C*byPose[i].t())(0) > MOST))       // what part of its error a match's own pull takes
            some.push_back(chosen[i]);
    return some;
}

//! Some of many matches, the same ones every time.
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

//! From one rotation vector to another, which may turn the long way round.
Vec3d difference(const Vec3d& from, Vec3d to)
{
    const double angle = norm(to);
    const Vec3d otherWay = angle > 0 ? to*(1 - 2*CV_PI/angle) : to;
    return norm(otherWay - from) < norm(to - from) ? otherWay - from : to - from;
}

//! The rotation's covariance becomes at least another one, in all directions.
void widen(Matx66d& covariance, const Matx33d& other)
{
    const Matx33d own = covariance.get_minor<3, 3>(0, 0);
    Vec3d variances, ratios;
    Matx33d axes, turned;                   // rows
    if (!checkRange(Mat(own)) || !checkRange(Mat(other)) || !eigen(own, variances, axes) || !(variances[2] > 0))
        return;
    const Vec3d sigmas(std::sqrt(variances[0]), std::sqrt(variances[1]), std::sqrt(variances[2]));
    const Matx33d whitening = Matx33d::diag(Vec3d(1/sigmas[0], 1/sigmas[1], 1/sigmas[2]))*axes;
    eigen(whitening*other*whitening.t(), ratios, turned);
    for (int k = 0; k < 3; k++)
        ratios[k] = std::max(ratios[k] - 1, 0.);
    const Matx33d root = axes.t()*Matx33d::diag(sigmas)*turned.t(), wider = own + root*Matx33d::diag(ratios)*root.t();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            covariance(r, c) = wider(r, c);
}

/** Where lengths are hardly known, the pose at an end of the length's 95 % interval may be farther off than the covariance of the best pose
says: that becomes at least so large in this direction. */
void widenToLength(const RigidTransform& end, Estimate& e)
{
    const double NORMAL = 3.841459, MUCH = 2;       // the square that 5 % exceed; more of it than rounding and curvature
    const Vec3d turned = difference(rotationVector(e.motion.R), rotationVector(end.R)), moved = end.t - e.motion.t;
    const Vec6d off(turned[0], turned[1], turned[2], moved[0], moved[1], moved[2]);
    const double off2 = off.dot(inverseOfPositive(e.covariance)*off);
    if (off2 > MUCH*NORMAL)
        e.covariance += (1/NORMAL - 1/off2)*off*off.t();
}

/** The rotation at an end of the length's 95 % interval is as likely as that, and as uncertain as it is there. A covariance of the best
pose need not say this: where T is hardly known, rotation and T are not each other's linear functions. */
void widenToEnd(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& end, Estimate& e)
{
    const double NORMAL = 3.841459;         // the square that 5 % exceed
    std::vector<Matx16d> byPose;
    const Vec3d off = difference(rotationVector(e.motion.R), rotationVector(end.R));
    widen(e.covariance, off*off.t()*(1/NORMAL));
    widen(e.covariance, (e.variance*covarianceOf(pair, matches, end, !pair.refracts(), byPose)).get_minor<3, 3>(0, 0));
}

/** Whether all points may be infinitely far, so that T has no direction. A match's error along its curve is noise then, as the one across
it; else it is what the point's distance does. By the ratio of their mean squares, whose logarithm is nearly normal (Fisher's z). */
bool isWithoutDirection(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& pose)
{
    const double CUT_NORMAL = 3.72;         // exceeded with a chance of 1e-4
    const double OF_LINES = 0, count = (double)matches.size(), freedomAcross = count - 5, freedomAlong = count + 2;
    std::vector<double> errors;
    sampsonErrors(pair, matches, pose, errors, nullptr, OF_LINES);
    const double across = norm(errors, NORM_L2SQR);
    Matx33d R = pose.R;
    const double both = refineRotation(matches, R, 30), noise = std::max(across/freedomAcross, LEAST_SCALE*LEAST_SCALE);
    const double ratio = (both - across)/freedomAlong/noise;
    return !(std::log(ratio) > CUT_NORMAL*std::sqrt(2/freedomAlong + 2/freedomAcross));
}

//! The most likely pose over all lengths, from a good one; false if there are too few inliers.
bool estimate(const MatchedCameras& pair, const PixelMatches& matches, double limit, const RigidTransform& start, Estimate& e)
{
    std::vector<int> fitted;
    PixelMatches some;
    Consensus best = score(pair, matches, start, limit);
    double cost = INFINITE;
    for (int k = 0; k < 5; k++)
    {
        std::vector<int> next = withoutHighLeverage(pair, matches, best.motion, withoutOutliers(best));
        if (next.size() <= 6 || next == fitted)
            break;
        RigidTransform motion = best.motion;
        fitted = std::move(next);
        some = select(matches, fitted);
        if (k == 0)
            motion = mostLikelyLength(pair, sampleOf(some), motion);
        cost = refineLength(pair, some, motion, 50);
        if (!(cost < INFINITE))
            return false;
        best = score(pair, matches, motion, limit);
    }
    if (fitted.empty() || best.inliers.size() <= 6)
        return false;
    const double freedom = (double)fitted.size() - (pair.refracts() ? 6 : 5);
    std::vector<Matx16d> byPose;
    e.motion = best.motion;
    e.variance = cost/freedom;
    const Matx66d unconstrained = e.variance*covarianceOf(pair, some, e.motion, !pair.refracts(), byPose);
    const LengthInterval lengths =
        lengthInterval(pair, some, { e.motion, cost, freedom, unconstrained.get_minor<3, 3>(3, 3) });
    e.interval = lengths.lengths;
    e.likely = e.motion;
    e.ofNoise = unconstrained;
    if (isInfinitelyFar(pair, e.motion))
    {
        setLength(pair, e.interval[0] > 0 ? e.interval[0] : 1, e.motion);
        if (!(refineAtLength(pair, some, e.motion, 30) < INFINITE))
            return false;
    }
    e.covariance = e.variance*covarianceOf(pair, some, e.motion, e.interval[1] == INFINITE, byPose);
    for (const RigidTransform& end : lengths.ends)
    {
        if (e.interval[1] < INFINITE)
            widenToLength(end, e);
        widenToEnd(pair, some, end, e);
    }
    if (e.interval[1] == INFINITE && isWithoutDirection(pair, some, e.motion))
        for (int k = 0; k < 36; k++)
            if (k/6 >= 3 || k % 6 >= 3)
                e.covariance.val[k] = NaN;
    e.fitted = fitted;
    e.inliers = best.inliers;
    e.squares.assign(matches.size(), limit*limit);
    for (size_t i = 0; i < best.inliers.size(); i++)
        e.squares[best.inliers[i]] = best.errors[i]*best.errors[i];
    return true;
}

//! Where the search from pinholes' poses ends, each place once.
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

/** Whether another estimate, and none of those that the covariance speaks of, is as likely. Which of two poses of a plane is right
shows in no single match: each is off both by noise alone, in directions of its own. So the costs differ by the sum of as many
random numbers, and by more only if one of the poses is wrong (@cite Vuong1989); if both agree with nearly as many matches, as
what was cut off is no noise. The covariance may be that at one length, at which both are compared. */
bool isAmbiguous(const MatchedCameras& pair, const PixelMatches& matches, const Estimate& e, const Estimate& other)
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
    if ((double)other.inliers.size() < AS_MANY*(double)e.inliers.size() || sum > LEFT + CERTAIN*std::sqrt(squares))
        return false;
    RigidTransform motion = other.motion;
    setLength(pair, norm(e.motion.t), motion);
    refineAtLength(pair, select(matches, other.inliers), motion, 30);
    const Vec3d off = difference(rotationVector(e.motion.R), rotationVector(motion.R));
    return off.dot(inverseOfPositive(e.covariance.get_minor<3, 3>(0, 0))*off)*e.variance > FAR*FAR*std::max(e.variance, LEFT);
}

PixelMatches matchesOf(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels)
{
    const std::vector<PixelRay> rays1 = pixelRays(camera1, pixels.first), rays2 = pixelRays(camera2, pixels.second);
    PixelMatches matches;
    for (size_t i = 0; i < pixels.first.size(); i++)
        matches.push_back({ pixels.first[i], pixels.second[i], rays1[i], rays2[i] });
    return matches;
}

//! What a camera's parameter must not fall below: no index is below 1, no distance below 0.
double leastValue(const Camera& camera, int parameter)
{
    const int ofWindow = parameter - camera.lensCount();
    if (ofWindow < 0)
        return -std::numeric_limits<double>::infinity();
    const WindowLayout layout = windowLayout(camera.window());
    return lowerBound(kindOf(layout, ofWindow), camera.parameters()[parameter]);
}

/** How the estimate moves with one camera's parameters, those that vary: by differences of the errors.
@param which camera, 1 or 2 */
Mat motionByCamera(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, const RigidTransform& motion,
                   int which, const Mat& covariance)
{
    const double STEP = 0.1;                    // standard deviations
    const auto errorsAt = [&](const Camera& c1, const Camera& c2, std::vector<Matx16d>* byPose)
    {
        std::vector<double> errors;
        sampsonErrors({ c1, c2, Vec3d(), Vec3d() }, matchesOf(c1, c2, pixels), motion, errors, byPose);
        return errors;
    };
    std::vector<Matx16d> byPose;
    errorsAt(camera1, camera2, &byPose);
    SumOfSquares<6> sum;
    for (const Matx16d& by : byPose)
        sum.add(0, by.val);
    const Matx66d inverse = inverseOfPositive(sum.curvature);
    const Camera& camera = which == 1 ? camera1 : camera2;
    Mat moved = Mat::zeros(6, covariance.rows, CV_64F);
    for (int k = 0; k < covariance.rows; k++)
    {
        const double deviation = std::sqrt(std::max(covariance.at<double>(k, k), 0.));
        if (deviation == 0)
            continue;
        std::vector<double> errors[2];
        double at[2];
        for (int side = 0; side < 2; side++)
        {
            std::vector<double> parameters = camera.parameters();
            at[side] = std::max(parameters[k] + (side ? STEP : -STEP)*deviation, leastValue(camera, k));
            parameters[k] = at[side];
            Camera changed = camera;
            changed.setParameters(parameters);
            errors[side] = which == 1 ? errorsAt(changed, camera2, nullptr) : errorsAt(camera1, changed, nullptr);
        }
        Vec6d gradient;
        for (size_t i = 0; i < byPose.size(); i++)
        {
            const double change = (errors[1][i] - errors[0][i])/(at[1] - at[0]);
            for (int r = 0; r < 6 && !std::isnan(change); r++)
                gradient[r] += byPose[i](r)*change;
        }
        Mat(inverse*gradient).copyTo(moved.col(k));
    }
    return moved;
}

/** Adds what inexact cameras do to the pose, and makes the interval of its length longer: by as much, in the logarithm, as the
length's standard deviation grows. */
void addCameras(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, const Mat (&covariances)[2], Estimate& e)
{
    MatchedPixels fitted;
    for (int i : e.fitted)
    {
        fitted.first.push_back(pixels.first[i]);
        fitted.second.push_back(pixels.second[i]);
    }
    Matx66d ofCameras = Matx66d::zeros();
    for (int which : { 1, 2 })
    {
        const Mat& C = covariances[which - 1];
        if (C.empty())
            continue;
        const Mat G = motionByCamera(camera1, camera2, fitted, e.likely, which, C);
        ofCameras += Matx66d(Mat(G*C*G.t()).ptr<double>());
    }
    const Vec3d along = normalize(e.likely.t);
    const double noise = along.dot(e.ofNoise.get_minor<3, 3>(3, 3)*along);
    const double growth = std::sqrt(1 + along.dot(ofCameras.get_minor<3, 3>(3, 3)*along)/noise), length = norm(e.likely.t);
    if (growth > 1 && std::isfinite(growth))
        for (int k = 0; k < 2; k++)
            e.interval[k] = length*std::pow(e.interval[k]/length, growth);
    e.covariance += ofCameras;
}

bool recover(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, double prob, double threshold, Estimate& e)
{
    const PixelMatches matches = matchesOf(camera1, camera2, pixels), sample = sampleOf(matches);
    std::vector<Point2d> sample1, sample2;
    for (const Match& m : sample)
    {
        sample1.push_back(m.pixel1);
        sample2.push_back(m.pixel2);
    }
    const Bearings b1 = bearingsOf(camera1, sample1), b2 = bearingsOf(camera2, sample2);
    const MatchedCameras pair = { camera1, camera2, b1.centre, b2.centre };
    const std::vector<Consensus> places = placesOf(pair, sample, threshold,
                                                   centralPoses(b1, b2, threshold/camera1.lens().parameters()[0], prob));
    size_t most = 0;
    for (const Consensus& place : places)
        most = std::max(most, place.inliers.size());
    std::vector<Estimate> estimates;
    for (const Consensus& place : places)
    {
        Estimate here;
        if (2*place.inliers.size() >= most && estimate(pair, matches, threshold, place.motion, here))
            estimates.push_back(here);
    }
    if (estimates.empty())
        return false;
    const auto best = std::min_element(estimates.begin(), estimates.end(),
                                       [](const Estimate& a, const Estimate& b) { return a.cost() < b.cost(); });
    e = *best;
    return !isExplainedByChance((int)matches.size(), (int)e.inliers.size(), samplingOf(pixels.second, threshold))
           && std::none_of(estimates.begin(), estimates.end(), [&](const Estimate& other)
                           { return &other != &*best && isAmbiguous(pair, matches, e, other); });
}

} // namespace

/** Those that both cameras saw, each once: a copy tells nothing.
@param index of each, in the result; of one that was not seen: the result's size */
static MatchedPixels differentMatches(const std::vector<Point2d>& all1, const std::vector<Point2d>& all2, std::vector<int>& index)
{
    MatchedPixels matches;
    std::map<std::array<double, 4>, int> known;
    for (size_t i = 0; i < all1.size(); i++)
    {
        index.push_back(-1);
        if (!isWhole(all1[i]) || !isWhole(all2[i]))
            continue;
        const auto entry = known.insert({ { { all1[i].x, all1[i].y, all2[i].x, all2[i].y } }, (int)matches.first.size() });
        index.back() = entry.first->second;
        if (!entry.second)
            continue;
        matches.first.push_back(all1[i]);
        matches.second.push_back(all2[i]);
    }
    std::replace(index.begin(), index.end(), -1, (int)matches.first.size());
    return matches;
}

static void readCameraCovariances(InputArrayOfArrays given, const Camera& camera1, const Camera& camera2, Mat (&covariances)[2])
{
    if (given.empty())
        return;
    std::vector<Mat> all;
    given.getMatVector(all);
    if (all.size() != 2)
        CV_Error_(Error::StsUnmatchedSizes, ("cameraCovariances has %d matrices; it must be one for each of the 2 cameras",
                                             (int)all.size()));
    covariances[0] = readCameraCovariance(all[0], camera1, "cameraCovariances[0]");
    covariances[1] = readCameraCovariance(all[1], camera2, "cameraCovariances[1]");
}

static int recoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                       const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                       OutputArray mask, InputArrayOfArrays cameraCovariances, Estimate& e)
{
    const Camera &c1 = cameraOf(camera1, "camera1"), &c2 = cameraOf(camera2, "camera2");
    const std::vector<Point2d> all1 = readPoints2(points1, "points1"), all2 = readPoints2(points2, "points2");
    const int count = (int)all1.size();
    if (all1.size() != all2.size())
        CV_Error_(Error::StsUnmatchedSizes, ("points1 has %d points, points2 %d; they must agree", count, (int)all2.size()));
    if (count == 0)
    {
        mask.release();
        return 0;
    }
    if (count < 6)
        CV_Error_(Error::StsBadArg, ("points1 has %d points; a relative pose needs at least 6", count));
    if (!(prob > 0 && prob < 1))
        CV_Error_(Error::StsOutOfRange, ("prob is %g; it must lie between 0 and 1", prob));
    if (!(threshold > 0) || !std::isfinite(threshold))
        CV_Error_(Error::StsOutOfRange, ("threshold is %g; it must be positive", threshold));
    Mat covariances[2];
    readCameraCovariances(cameraCovariances, c1, c2, covariances);
    std::vector<int> index;
    const MatchedPixels matches = differentMatches(all1, all2, index);
    const bool found = recover(c1, c2, matches, prob, threshold, e);
    if (found && !cameraCovariances.empty())
        addCameras(c1, c2, matches, covariances, e);
    std::vector<uchar> chosen(matches.first.size() + 1, 0);           // the last: what was not seen
    for (size_t i = 0; found && i < e.inliers.size(); i++)
        chosen[e.inliers[i]] = 1;
    Mat isInlier(count, 1, CV_8U);
    for (int i = 0; i < count; i++)
        isInlier.at<uchar>(i) = chosen[index[i]];
    if (mask.needed())
        isInlier.copyTo(mask);
    if (!found)
        return 0;
    Mat(e.motion.R).copyTo(R);
    Mat(e.motion.t).copyTo(T);
    return countNonZero(isInlier);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                          const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask)
{
    CV_INSTRUMENT_REGION();

    Estimate e;
    return recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, noArray(), e);
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
                          OutputArray mask, OutputArray covariance, Vec2d& scaleInterval, InputArrayOfArrays cameraCovariances)
{
    CV_INSTRUMENT_REGION();

    Estimate e;
    const int count = recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, cameraCovariances, e);
    scaleInterval = count > 0 ? e.interval : Vec2d(NaN, NaN);
    if (covariance.needed())
        Mat(count > 0 ? e.covariance : Matx66d::all(NaN)).copyTo(covariance);
    return count;
}

}} // namespace
