// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/rig_fit.hpp"
#include "arrays/arrays.hpp"
#include "calibrate/covariance.hpp"
#include "calibrate/information.hpp"
#include "calibrate/rig_robust.hpp"
#include "calibrate/sealed_start.hpp"
#include "calibrate/rig_start.hpp"
#include "calibrate/staged_start.hpp"
#include <opencv2/core/eigen.hpp>

namespace cv { namespace refract {

static const double NaN = std::numeric_limits<double>::quiet_NaN();

TermCriteria checkedCriteria(TermCriteria criteria)
{
    if (!(criteria.type & (TermCriteria::COUNT | TermCriteria::EPS)))
        CV_Error_(Error::StsBadArg, ("criteria.type is %d; it must have COUNT, EPS or both", criteria.type));
    if (!(criteria.type & TermCriteria::COUNT))
        criteria.maxCount = 1000;
    if (criteria.maxCount < 1)
        CV_Error_(Error::StsOutOfRange, ("criteria.maxCount is %d; it must be at least 1", criteria.maxCount));
    if ((criteria.type & TermCriteria::EPS) && !(criteria.epsilon >= 0 && std::isfinite(criteria.epsilon)))
        CV_Error_(Error::StsOutOfRange, ("criteria.epsilon is %g; it must be finite and not negative", criteria.epsilon));
    return criteria;
}

namespace {

void checkFreedom(const RigProblem& rig)
{
    if (rig.freedom() <= 0)
        CV_Error_(Error::StsBadArg, ("%d points were observed, which give %d equations for %d unknowns; take more views",
                                     rig.pointCount(), rig.equationCount(), rig.freeCount() + 6*rig.poseCount()));
}

void describeImages(const RigProblem& rig, const RigTask& task, const std::vector<uchar>& status, RigFit& fit)
{
    const int columns = 2*rig.cameraCount();
    fit.perViewErrors = Mat(rig.viewCount(), columns, CV_64F, Scalar(NaN));
    fit.imageStatus = Mat(rig.viewCount(), columns, CV_8U, Scalar(GLASS_IMAGE_ABSENT));
    fit.inliers.assign(rig.viewCount()*columns, Mat());
    double sum = 0;
    for (size_t i = 0; i < rig.images().size(); i++)
    {
        const RigImage& image = rig.images()[i];
        const int column = 2*image.camera + (image.refracted ? 1 : 0), used = image.usedCount();
        const double squares = rig.residuals(image).squaredNorm();
        sum += squares;
        fit.perViewErrors.at<double>(image.view, column) = used > 0 ? std::sqrt(squares/used) : NaN;
        fit.imageStatus.at<uchar>(image.view, column) = status[i];
        Mat mask((int)task.views.object[image.view].size(), 1, CV_8U, Scalar(0));
        for (size_t k = 0; k < image.points.index.size(); k++)
            mask.at<uchar>(image.points.index[k]) = image.rootWeights[k] > 0;
        fit.inliers[image.view*columns + column] = mask;
    }
    fit.rms = std::sqrt(sum/rig.pointCount());
}

//! Images that gave no pose to start from.
void markUnusable(const RigTask& task, RigFit& fit)
{
    for (int view = 0; view < task.views.count(); view++)
        for (int column = 0; column < fit.imageStatus.cols; column++)
        {
            const CameraViews& seen = task.views.cameras[column/2];
            const std::vector<Point2d>& pixels = (column % 2 == 0 ? seen.direct : seen.refracted)[view];
            uchar& status = fit.imageStatus.at<uchar>(view, column);
            if (status != GLASS_IMAGE_ABSENT || countSeen(pixels) == 0)
                continue;
            status = GLASS_IMAGE_UNUSABLE;
            fit.inliers[view*fit.imageStatus.cols + column] = Mat((int)pixels.size(), 1, CV_8U, Scalar(0));
        }
}

//! Takes images that no pose agrees with out of the task.
void dropUnusable(const RigViews& agreeing, const std::vector<Pose>& poses, RigTask& task)
{
    for (int c = 0; c < (int)agreeing.cameras.size(); c++)
        for (int view = 0; view < agreeing.count(); view++)
        {
            CameraViews& seen = task.views.cameras[c];
            if (agreeing.cameras[c].direct[view].empty() || !poses[view].found)
                seen.direct[view].clear();
            if (agreeing.cameras[c].refracted[view].empty() || !poses[view].found)
                seen.refracted[view].clear();
        }
}

Mat toMat(const std::vector<OtherMinimum>& minima)
{
    Mat_<double> rows((int)minima.size(), 5);
    for (int c = 0; c < rows.rows; c++)
    {
        Mat(minima[c].normal.t()).copyTo(rows(Rect(0, c, 3, 1)));
        rows(c, 3) = minima[c].excess;
        rows(c, 4) = minima[c].distance;
    }
    return rows;
}

//! A sealed rig exchanges its parameters for each other: asked of it is only what the caller names.
int requiredOf(const RigTask& task)
{
    return isSealed(task) ? task.flags & REQUIRE_ALL : REQUIRE_ALL;
}

//! Starts of windows and poses. Robust: images without a pose are taken out of the task.
RigStart findStart(const Rig& rig, RigTask& task, RigFit& fit)
{
    if (isStaged(task))
    {
        std::vector<OtherMinimum> minima(rig.count());
        const RigStart start = stagedStart(rig, task.views, task.flags, minima);
        checkPoses(task.views, start.poses);
        fit.otherMinima = toMat(minima);
        return start;
    }
    const bool isRobust = (task.flags & GLASS_ROBUST) != 0;
    const RigViews views = isRobust ? agreeingViews(rig, task.views) : task.views;
    RigStart start = { rig, posesWithoutWindow(rig, views, task.knownPoses) };
    std::vector<OtherMinimum> minima = startWindows(start.rig, views, start.poses, task.flags);
    addPosesThroughWindow(start.rig, views, start.poses);
    keepGivenNormals(rig, views, start.poses, start.rig);
    if (isSealed(task) && !isRobust)
        addPosesIgnoringWindow(start.rig, views, start.poses);
    if (isRobust)
        dropUnusable(views, start.poses, task);
    else
        checkPoses(views, start.poses);
    if (isSealed(task))
        start = bestSealedStart(start, views, task, minima);
    fit.otherMinima = toMat(minima);
    return start;
}

} // namespace

static int seenCount(const RigViews& views)
{
    int count = 0;
    for (const CameraViews& camera : views.cameras)
        for (int view = 0; view < views.count(); view++)
            count += countSeen(camera.refracted[view]) + countSeen(camera.direct[view]);
    return count;
}

RigFit fitRig(Rig& rig, const RigTask& task_)
{
    const TermCriteria criteria = checkedCriteria(task_.criteria);
    RigFit fit;
    RigTask task = task_;
    const RigStart start = findStart(rig, task, fit);
    RigProblem problem(start.rig, task.views, start.poses, task.knowledge, task.cameras, task.flags);
    if (!(task.flags & GLASS_ROBUST))
        checkFreedom(problem);
    RigFitProblem fitProblem(problem);
    const FitOutcome outcome = Fit(fitProblem, (task.flags & GLASS_ROBUST) != 0, seenCount(task_.views), criteria).run();
    checkFreedom(problem);

    // First, as what is undetermined is also what does not converge.
    const double variance = outcome.varianceFactor*problem.squaredError()/problem.freedom();
    eigen2cv(rigCovariance(problem, variance, requiredOf(task)), fit.covariance);
    if (!outcome.converged)
        CV_Error_(Error::StsNoConv, ("the calibration did not converge in %d iterations; raise criteria.maxCount, or fix "
                                     "what the views hardly determine", criteria.maxCount));
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    describeImages(problem, task, fitProblem.imageStatus(), fit);
    markUnusable(task_, fit);
    if (task.wantsJacobian)
        eigen2cv(rigJacobian(problem), fit.jacobian);
    for (int view = 0; view < problem.viewCount(); view++)
        fit.poses.push_back(problem.pose(view));
    rig = problem.rig();
    return fit;
}

static void writeVectors(const std::vector<Pose>& poses, Vec3d Pose::*member, OutputArrayOfArrays out)
{
    std::vector<Vec3d> vectors;
    for (const Pose& pose : poses)
        vectors.push_back(pose.found ? pose.*member : Vec3d::all(NaN));
    writeVectors(vectors, out);
}

void writeMat(const Mat& from, OutputArray to)
{
    if (to.needed())
        from.copyTo(to);
}

void writeFit(const RigFit& fit, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
              OutputArray covariance, OutputArray perViewErrors)
{
    writeVectors(fit.poses, &Pose::rvec, rvecs);
    writeVectors(fit.poses, &Pose::tvec, tvecs);
    writeMat(fit.stdDeviations, stdDeviations);
    writeMat(fit.covariance, covariance);
    writeMat(fit.perViewErrors, perViewErrors);
}

}} // namespace
