// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/relative_estimate.hpp"
#include "pose/length_profile.hpp"
#include "pose/pose_covariance.hpp"
#include "pose/relative_search.hpp"
#include "math/least_squares.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

namespace {

const double INFINITE = std::numeric_limits<double>::infinity(), NaN = std::numeric_limits<double>::quiet_NaN();

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
void widenToLength(const RigidTransform& end, RelativeEstimate& e)
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
void widenToEnd(const MatchedCameras& pair, const PixelMatches& matches, const RigidTransform& end, RelativeEstimate& e)
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

} // namespace

bool estimateRelativePose(const MatchedCameras& pair, const PixelMatches& matches, double limit, const RigidTransform& start,
                          RelativeEstimate& e)
{
    std::vector<int> fitted;
    PixelMatches some;
    Consensus best = consensusOf(pair, matches, start, limit);
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
        best = consensusOf(pair, matches, motion, limit);
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

bool isAmbiguous(const MatchedCameras& pair, const PixelMatches& matches, const RelativeEstimate& e, const RelativeEstimate& other)
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

void addCameras(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, const Mat (&covariances)[2],
                RelativeEstimate& e)
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

}} // namespace
