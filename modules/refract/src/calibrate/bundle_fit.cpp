// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Start, fit, and what it tells. Points that start badly are tried again from where the fit has come to. */

#include "calibrate/bundle_fit.hpp"
#include "calibrate/bundle_search.hpp"
#include "calibrate/near_task.hpp"
#include "adjust/covariance.hpp"
#include "adjust/joint_fit.hpp"
#include "adjust/ray_midpoints.hpp"
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

namespace {

FitOutcome adjust(Problem& problem, const BundleTask& task)
{
    const bool isRobust = (task.flags & GLASS_ROBUST) != 0;
    const TermCriteria criteria = checkedCriteria(task.criteria);
    SceneOutliers outliers(problem, task.scale);
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    problem.setPoints(std::vector<Point3d>(task.points.size(), Point3d(NaN, NaN, NaN)), Masks());
    FitOutcome outcome = problem.findPointWithoutImage();       // of none: a shared window that a camera cannot look through
    if (!outcome.converged())
        return outcome;
    problem.setPoints(startPoints(problem, task.points), Masks());
    outcome = outliers.checkWhatIsLeft();
    if (!outcome.converged())
        return outcome;
    JointFit fit(problem, outliers, isRobust, problem.pointCount(), criteria), another = fit;
    if (isRobust)
        return searchRobustBundle(problem, outliers, fit, another);
    return searchBundle(problem, outliers, fit, another);
}

void describe(const Problem& problem, BundleFit& fit)
{
    const int cameras = problem.cameraCount();
    fit.points = problem.scene().points();
    for (Point3d& point : fit.points)
        point *= problem.sceneScale();
    fit.perViewErrors = Mat(problem.viewCount(), cameras, CV_64F, Scalar(std::numeric_limits<double>::quiet_NaN()));
    double sum = 0;
    for (const Image& image : problem.images())
    {
        sum += describeError(problem, image, image.camera, fit);
        fit.isUsed.push_back(std::vector<uchar>());
        for (double weight : image.rootWeights)
            fit.isUsed.back().push_back(weight > 0);
    }
    fit.rms = std::sqrt(sum/problem.pointCount());
    fit.poses = problem.poses();
}

FitOutcome fitNear(Rig& rig, const BundleTask& task, BundleFit& fit)
{
    Problem problem(rig, task.images.images, task.images.points, task.lengths, task.poses, task.posePriors, task.flags,
                    task.cameraPriors, task.rigCovariance, task.lengthScaleSigma);
    const FitOutcome outcome = adjust(problem, task);
    if (!outcome.isUsable())
        return outcome;
    const double variance = outcome.varianceFactor*problem.squaredError()/std::max(problem.freedom(), 1);
    Covariance covariance;
    const FitOutcome determined = covariance.compute(problem, variance, 0);     // first, as what is undetermined does not converge
    if (!determined.converged() || !outcome.converged())
        return determined.converged() ? outcome : determined;
    if (checkedCriteria(task.criteria).type & TermCriteria::EPS)        // else it is not where the squares are least
        covariance.widen(problem);
    const int count = problem.publicCount() - (problem.targetBlock() < 0 ? 0 : SharedTargetErrors::COUNT);
    eigen2cv(Eigen::MatrixXd(covariance.ofParameters.topLeftCorner(count, count)), fit.covariance);
    if (task.covarianceMemory > 0 && (double)covariance.bytes() > task.covarianceMemory)
        covariance.forgetPoses();
    if (task.wantsPoseCovariances)
        fit.poseCovariances = covariance.ofPoses();
    if (task.wantsPointDeviations)
        fit.pointDeviations = covariance.ofPoints();
    fit.sigma = std::sqrt(variance/task.images.variance);   // of a usual pixel
    fit.freedom = problem.freedom();
    describe(problem, fit);
    rig = problem.rig();
    toNearestCenters(rig, fit);
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    return outcome;
}

/** Where camera 1 is in the first view that has an image, if all of them are far from the origin. Then a pose that is held stays where it
is even if the scene's scale is found. */
NearOrigin originOf(const BundleTask& task)
{
    std::vector<Point3d> centers;
    const std::vector<bool> isSeen = task.images.seenViews();
    for (size_t view = 0; view < task.poses.size(); view++)
        if (isSeen[view])
            centers.push_back(Point3d(transformOf(task.poses[view]).inverse(Vec3d())));
    const bool canBeMoved = !centers.empty() && std::all_of(task.posePriors.begin(), task.posePriors.end(), canMove);
    return canBeMoved ? NearOrigin(centers) : NearOrigin();
}

} // namespace

FitOutcome fitBundle(Rig& rig, const BundleTask& task, BundleFit& fit)
{
    const NearOrigin origin = originOf(task);
    if (!origin.isMoved())
        return fitNear(rig, task, fit);
    BundleTask moved = task;
    origin.move(moved.points);
    for (size_t view = 0; view < task.poses.size(); view++)
        moveNear(origin, moved.poses[view], &moved.posePriors[view]);
    FitOutcome outcome = fitNear(rig, moved, fit);
    if (outcome.status == FitOutcome::NO_IMAGE)
        outcome.point += Point3d(origin.origin());
    for (Point3d& point : fit.points)
        point += Point3d(origin.origin());
    for (size_t view = 0; view < fit.poses.size(); view++)
    {
        const Matx66d farByNear = origin.farByNear(fit.poses[view]);
        if (view < fit.poseCovariances.size() && !fit.poseCovariances[view].empty())
            fit.poseCovariances[view] = Mat(farByNear)*fit.poseCovariances[view]*Mat(farByNear.t());
        fit.poses[view] = origin.toFar(fit.poses[view]);
    }
    return outcome;
}

}} // namespace
