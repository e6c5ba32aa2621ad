// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Pose of a target among wrong matches. Random samples of three points give poses (generalized_p3p.hpp); all points score a pose by
their squared distances from its images, cut off at the limit (MSAC: @cite TorrZisserman2000). A pose with a lower cost than
all before is refined on its inliers (LO-RANSAC: @cite ChumMatasKittler2003). */

#include "pose/a_contrario.hpp"
#include "pose/consensus.hpp"
#include "pose/pose_covariance.hpp"
#include "pose/generalized_p3p.hpp"
#include "arrays/arrays.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include "points/point_kernels.hpp"

namespace cv { namespace refract {

namespace {

//! Scores poses by all points (MSAC).
class MsacScorer
{
public:
    MsacScorer(const Camera& camera, const ImagePoints& points, double limit) : camera_(camera), points_(points), limit2_(limit*limit)
    {
        for (const Point3d& X : points.object)
        {
            x_.push_back(X.x); y_.push_back(X.y); z_.push_back(X.z);
        }
    }

    /** The cost of a pose, or some number above `enough` where it is.
    @param errors of the points; may be null */
    double score(const RigidTransform& motion, double enough, double* errors = nullptr) const
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK], cost = 0;
        uchar status[BLOCK];
        const int count = (int)points_.pixel.size();
        for (int begin = 0; begin < count && cost <= enough; begin += BLOCK)
        {
            const int n = std::min(BLOCK, count - begin);
            std::copy_n(&x_[begin], n, x); std::copy_n(&y_[begin], n, y); std::copy_n(&z_[begin], n, z);
            pointKernels().transform(motion.R.val, motion.t.val, n, x, y, z);
            for (int i = 0; i < n; i++)     // most poses are wrong: no time for the reason why a point has no image
                status[i] = camera_.layers().isBeyond(x[i], y[i], z[i]) ? REFRACT_OK : REFRACT_BEHIND_WINDOW;
            camera_.project(n, x, y, z, nullptr, u, v, status);
            for (int i = 0; i < n; i++)
            {
                const Point2d& p = points_.pixel[begin + i];
                const double e2 = status[i] == REFRACT_OK ? (u[i] - p.x)*(u[i] - p.x) + (v[i] - p.y)*(v[i] - p.y) : DBL_MAX;
                cost += std::min(e2, limit2_);
                if (errors)
                    errors[begin + i] = std::sqrt(e2);
            }
        }
        return cost;
    }

    Consensus consensus(const RigidTransform& motion) const
    {
        std::vector<double> errors(points_.pixel.size());
        score(motion, DBL_MAX, errors.data());
        Consensus c;
        c.motion = motion;
        c.cost = 0;
        for (size_t i = 0; i < errors.size(); i++)
            c.add((int)i, errors[i], std::sqrt(limit2_));
        return c;
    }

private:
    const Camera& camera_;
    const ImagePoints& points_;
    const double limit2_;
    std::vector<double> x_, y_, z_;
};

ImagePoints select(const ImagePoints& points, const std::vector<int>& which)
{
    ImagePoints some;
    for (int i : which)
    {
        some.object.push_back(points.object[i]);
        some.pixel.push_back(points.pixel[i]);
        some.index.push_back(points.index[i]);
    }
    return some;
}

//! A better pose from the inliers of this one, if there is one.
bool localOptimize(const Camera& camera, const ImagePoints& points, const MsacScorer& scorer, int iterations, Consensus& best)
{
    const ImagePoints inliers = select(points, best.inliers);
    if (inliers.pixel.size() < 4 || scatterRank(inliers.object) < 2)
        return false;
    Pose pose = poseOf(best.motion);
    if (std::isnan(refinePose(camera, inliers, pose, iterations)))
        return false;
    const Consensus refined = scorer.consensus(transformOf(pose));
    if (!(refined.cost < best.cost))
        return false;
    best = refined;
    return true;
}

//! Samples after which, with this confidence, one had no wrong point.
double samplesNeeded(int inliers, int count, double confidence)
{
    const double right = (double)inliers*(inliers - 1)*(inliers - 2)/((double)count*(count - 1)*(count - 2));
    return right > 0 ? std::log(1 - confidence)/std::log1p(-std::min(right, 1 - DBL_EPSILON)) : DBL_MAX;
}

//! What a search may take.
struct Effort
{
    int samples;
    double confidence;
};

Consensus searchPose(const Camera& camera, const ImagePoints& points, const MsacScorer& scorer, const Effort& effort, const Pose& guess)
{
    const int QUICK = 4;                // iterations: a start for the next score
    const PointRays rays(camera, points);
    const int count = (int)rays.ray.size();
    Consensus best;
    const auto consider = [&](const RigidTransform& motion)
    {
        if (!(scorer.score(motion, best.cost) < best.cost))
            return;
        best = scorer.consensus(motion);
        for (int k = 0; k < 3 && localOptimize(camera, points, scorer, QUICK, best); k++) {}
    };
    if (guess.found)
        consider(transformOf(guess));
    RNG random(0x52414E53);
    for (int k = 0; k < effort.samples && count >= 3; k++)
    {
        if (k >= samplesNeeded((int)best.inliers.size(), count, effort.confidence))
            break;
        int sample[3];
        sample[0] = random.uniform(0, count);
        do sample[1] = random.uniform(0, count); while (sample[1] == sample[0]);
        do sample[2] = random.uniform(0, count); while (sample[2] == sample[0] || sample[2] == sample[1]);
        SceneRay three[3];
        Vec3d object[3];
        for (int i = 0; i < 3; i++)
        {
            three[i] = rays.ray[sample[i]];
            object[i] = Vec3d(points.object[rays.point[sample[i]]]);
        }
        RigidTransform motions[4];
        const int found = posesOfThreeRays(three, object, motions);
        for (int i = 0; i < found; i++)
            consider(motions[i]);
    }
    return best;
}

//! How likely uniformly random pixels are inliers of a pose of three of them.
Sampling samplingOf(const ImagePoints& points, double limit)
{
    const double POSES = 2;             // of a sample, on average
    return { 3, POSES, CV_PI*limit*limit/std::max(extentOf(points.pixel).area(), DBL_MIN) };
}

} // namespace

//! The inliers that do not stand out among them: the limit is often generous, and a wrong point within it pulls the pose.
static std::vector<int> withoutOutliers(const Consensus& consensus)
{
    const size_t ENOUGH = 12;           // to tell the scale
    if (consensus.inliers.size() < ENOUGH)
        return consensus.inliers;
    const double scale = std::max(LEAST_SCALE, truncatedScale(consensus.errors, scaleOf(consensus.errors), CUT));
    std::vector<int> some;
    for (size_t i = 0; i < consensus.inliers.size(); i++)
        if (consensus.errors[i] <= CUT*scale)
            some.push_back(consensus.inliers[i]);
    return some;
}

static void refineOnInliers(const Camera& camera, const ImagePoints& points, const MsacScorer& scorer, Consensus& best)
{
    std::vector<int> last;
    for (int k = 0; k < 10; k++)
    {
        const std::vector<int> fitted = withoutOutliers(best);
        const ImagePoints some = select(points, fitted);
        Pose pose = poseOf(best.motion);
        if (fitted == last || scatterRank(some.object) < 2 || std::isnan(refinePose(camera, some, pose)))
            return;
        best = scorer.consensus(transformOf(pose));
        last = fitted;
    }
}

//! The pose that points agree with best, refined on those that do.
static Consensus bestConsensus(const Camera& camera, const ImagePoints& points, double limit, const Effort& effort, const Pose& guess)
{
    const MsacScorer scorer(camera, points, limit);
    Consensus best = searchPose(camera, points, scorer, effort, guess);
    for (int k = 0; k < 10 && localOptimize(camera, points, scorer, 100, best); k++) {}
    refineOnInliers(camera, points, scorer, best);
    return best;
}

//! The pose and its inliers; not found if there is none.
static Pose solveRobustly(const Camera& camera, const ImagePoints& points, double limit, const Effort& effort,
                          const Pose& guess, std::vector<int>& inliers)
{
    const Consensus best = bestConsensus(camera, points, limit, effort, guess);
    const ImagePoints some = select(points, best.inliers);
    const int different = countDifferent(some);
    if (different < 4 || scatterRank(some.object) < 2
        || isExplainedByChance(countDifferent(points), different, samplingOf(points, limit)))
        return Pose();
    inliers = some.index;
    return poseOf(best.motion);
}

//! A third of the points right: still 18 samples of three right ones.
static const Effort OF_ONE_POSE = { 500, 0.9999 };

double costOfOnePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints)
{
    const double LIMIT = 8;             // pixels: of a rough window
    const ImagePoints points = observedWhole(objectPoints, imagePoints);
    const double most = LIMIT*LIMIT*(double)points.pixel.size();
    return points.pixel.size() < 4 ? most : std::min(most, bestConsensus(camera, points, LIMIT, OF_ONE_POSE, Pose()).cost);
}

std::vector<Point2d> pointsOfOnePose(const Camera& camera, const std::vector<Point3d>& objectPoints,
                                     const std::vector<Point2d>& imagePoints)
{
    const double NARROWEST = 2, WIDEST = 32;    // pixels: noise plus what a rough window or lens does
    const double ALL = 0.9, MORE = 1.25;        // parts: what a wider limit must gain of a wrong window, and does not of wrong points
    const ImagePoints points = observedWhole(objectPoints, imagePoints);
    std::vector<Point2d> chosen;
    if (points.pixel.size() < 4)
        return chosen;
    const double count = (double)points.pixel.size(), least = std::max(4., LEAST_INLIER_RATIO*count);
    std::vector<int> inliers;
    for (double limit = NARROWEST; limit <= WIDEST && (double)inliers.size() < ALL*count; limit *= 2)
    {
        std::vector<int> wider;
        solveRobustly(camera, points, limit, OF_ONE_POSE, Pose(), wider);
        if (!inliers.empty() && (double)wider.size() < MORE*(double)inliers.size())
            break;
        inliers = wider;
    }
    if ((double)inliers.size() < least)
        return chosen;
    chosen.assign(imagePoints.size(), Point2d(1, 1)*std::numeric_limits<double>::quiet_NaN());
    for (int i : inliers)
        chosen[i] = imagePoints[i];
    return chosen;
}

bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                              OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess, int iterationsCount,
                              float reprojectionError, double confidence, OutputArray inliers_)
{
    CV_INSTRUMENT_REGION();

    if (iterationsCount < 1)
        CV_Error_(Error::StsOutOfRange, ("iterationsCount is %d; it must be at least 1", iterationsCount));
    if (!(reprojectionError > 0) || !std::isfinite(reprojectionError))
        CV_Error_(Error::StsOutOfRange, ("reprojectionError is %g; it must be positive", (double)reprojectionError));
    if (!(confidence > 0 && confidence < 1))
        CV_Error_(Error::StsOutOfRange, ("confidence is %g; it must lie between 0 and 1", confidence));
    const Camera& seenBy = cameraOf(camera);
    ImagePoints points = readPosePoints(objectPoints, imagePoints, 4);
    const NearOrigin origin = moveNear(points);
    std::vector<int> inliers;
    const Effort effort = { iterationsCount, confidence };
    const Pose guess = useExtrinsicGuess ? origin.toNear(readPose(rvec, tvec)) : Pose();
    const Pose pose = solveRobustly(seenBy, points, reprojectionError, effort, guess, inliers);
    if (inliers_.needed())
        Mat(inliers, true).copyTo(inliers_);
    if (!pose.found)
        return false;
    writePose(origin.toFar(pose), rvec, tvec);
    return true;
}

bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                              OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess, int iterationsCount,
                              float reprojectionError, double confidence, OutputArray inliers_, OutputArray covariance,
                              double sigma, InputArray cameraCovariance)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    const PoseNoise noise = readPoseNoise(sigma, cameraCovariance, seenBy);
    std::vector<int> inliers;
    const bool found = refractiveSolvePnPRansac(objectPoints, imagePoints, camera, rvec, tvec, useExtrinsicGuess, iterationsCount,
                                                reprojectionError, confidence, inliers);
    if (inliers_.needed())
        Mat(inliers, true).copyTo(inliers_);
    if (!found)
    {
        covariance.release();
        return false;
    }
    // Those of the points that the pose was fitted to.
    ImagePoints points = readPosePoints(objectPoints, imagePoints, 4);
    const NearOrigin origin = moveNear(points);
    const MsacScorer scorer(seenBy, points, reprojectionError);
    const Pose pose = origin.toNear(readPose(rvec, tvec));
    const ImagePoints fitted = select(points, withoutOutliers(scorer.consensus(transformOf(pose))));
    if (covariance.needed())
        Mat(poseCovariance(seenBy, fitted, origin, pose, noise)).copyTo(covariance);
    return true;
}

bool refractiveSolvePnPRansac(InputArray objectPoints, InputArray imagePoints, InputArray cameraMatrix, InputArray distCoeffs,
                              const GlassWindow& window, OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess,
                              int iterationsCount, float reprojectionError, double confidence, OutputArray inliers)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolvePnPRansac(objectPoints, imagePoints, RefractiveCamera::create(cameraMatrix, distCoeffs, window), rvec,
                                    tvec, useExtrinsicGuess, iterationsCount, reprojectionError, confidence, inliers);
}

}} // namespace
