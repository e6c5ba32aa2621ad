// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/rig_fit.hpp"
#include "adjust/covariance.hpp"
#include "adjust/joint_fit.hpp"
#include "arrays/arrays.hpp"
#include "start/incremental_start.hpp"
#include "start/inliers.hpp"
#include "start/rig_assembly.hpp"
#include "start/sealed_start.hpp"
#include "start/window_start.hpp"
#include "window/parameters.hpp"
#include "window/place.hpp"
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

double describeError(const Problem& problem, const Image& image, int column, RigFit& fit)
{
    const double squares = problem.squaredDistances(image);
    const int used = image.usedCount();
    fit.perViewErrors.at<double>(image.view, column) = used > 0 ? std::sqrt(squares/used) : NaN;
    return squares;
}

FitOutcome checkFreedom(const Problem& problem)
{
    FitOutcome outcome(problem.freedom() > 0 ? FitOutcome::CONVERGED : FitOutcome::TOO_FEW_EQUATIONS);
    outcome.count = problem.equationCount();
    outcome.expected = problem.unknownCount() + 1;
    return outcome;
}

namespace {

//! Its error, and which points of the target it has.
double describeImage(const Problem& problem, const Image& image, int column, int pointCount, RigFit& fit)
{
    const double squares = describeError(problem, image, column, fit);
    Mat mask(pointCount, 1, CV_8U, Scalar(0));
    for (size_t k = 0; k < image.points.index.size(); k++)
        mask.at<uchar>(image.points.index[k]) = image.rootWeights[k] > 0;
    fit.inliers[image.view*fit.perViewErrors.cols + column] = mask;
    return squares;
}

void describeImages(const Problem& problem, const RigTask& task, const std::vector<uchar>& status, RigFit& fit)
{
    const int columns = 2*problem.cameraCount();
    fit.perViewErrors = Mat(problem.viewCount(), columns, CV_64F, Scalar(NaN));
    fit.imageStatus = Mat(problem.viewCount(), columns, CV_8U, Scalar(GLASS_IMAGE_ABSENT));
    fit.inliers.assign(problem.viewCount()*columns, Mat());
    double sum = 0;
    for (size_t i = 0; i < problem.images().size(); i++)
    {
        const Image& image = problem.images()[i];
        const int column = 2*image.camera + (image.refracted ? 1 : 0);
        fit.imageStatus.at<uchar>(image.view, column) = status[i];
        sum += describeImage(problem, image, column, (int)task.views.object[image.view].size(), fit);
    }
    fit.rms = std::sqrt(sum/problem.pointCount());
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
void dropUnusable(const RigViews& inliers, const std::vector<Pose>& poses, RigTask& task)
{
    for (int c = 0; c < (int)inliers.cameras.size(); c++)
        for (int view = 0; view < inliers.count(); view++)
        {
            CameraViews& seen = task.views.cameras[c];
            if (inliers.cameras[c].direct[view].empty() || !poses[view].found)
                seen.direct[view].clear();
            if (inliers.cameras[c].refracted[view].empty() || !poses[view].found)
                seen.refracted[view].clear();
        }
}

Vec3d nearestOfAxis(const GlassWindow& tube) { return tube.center - tube.axis.dot(tube.center)*tube.axis; }

Mat toMat(const std::vector<OtherMinimum>& minima)
{
    Mat_<double> rows((int)minima.size(), 5, NaN);
    for (int c = 0; c < rows.rows; c++)
    {
        if (std::isnan(minima[c].excess))
            continue;
        GlassWindow other = minima[c].window;
        if (other.shape == WINDOW_TUBE)
            other.center = nearestOfAxis(other);
        const std::vector<double> window = windowParameters(other);
        const WindowLayout at = windowLayout(minima[c].window);
        std::copy_n(window.begin() + at.normal, 3, rows[c]);
        rows(c, 3) = minima[c].excess;
        rows(c, 4) = window[at.distance];
    }
    return rows;
}

//! A sealed rig exchanges its parameters for each other: asked of it is only what the caller names.
int requiredOf(const RigTask& task, const Rig& rig)
{
    return task.isSealed(rig) ? task.flags & REQUIRE_ALL : REQUIRE_ALL;
}

/** Of a fit that goes on to where a camera touches its dome: what images do not tell, by name; converged: there is no such. */
FitOutcome centersAtDomes(const Problem& problem)
{
    const double TOUCHES = 0.02;        // part of the radius
    FitOutcome outcome(FitOutcome::UNDETERMINED);
    outcome.dimension = 1;
    for (const ParameterBlock& block : problem.blocks())
    {
        if (block.kind != ParameterBlock::PLACE || block.at.shape != WINDOW_DOME || !block.isFree[0])
            continue;
        const GlassWindow window = problem.camera(block.index).window();
        if (!(distanceToSurface(window) < TOUCHES*window.radius))
            continue;
        const String name = block.names[0].substr(0, block.names[0].find('['));
        outcome.parameters.push_back({ problem.cameraCount() > 1 ? name + format(" of camera %d", block.index + 1) : name, NaN, NaN });
    }
    return outcome.parameters.empty() ? FitOutcome() : outcome;
}

Mat targetErrorsOf(const Problem& problem)
{
    Mat values(SharedTargetErrors::COUNT, 1, CV_64F, Scalar(NaN));
    if (problem.targetBlock() >= 0)
        eigen2cv(Eigen::VectorXd(problem.blocks()[problem.targetBlock()].values), values);
    return values;
}

int seenCount(const RigViews& views)
{
    int count = 0;
    for (const CameraViews& camera : views.cameras)
        for (int view = 0; view < views.count(); view++)
            count += countSeen(camera.refracted[view]) + countSeen(camera.direct[view]);
    return count;
}

//! Where the rig is given; false if a view has no pose there, or a point no image.
bool startAsGiven(const Rig& rig, const RigViews& views, const RigTask& task, RigStart& start)
{
    start = { rig, posesWithoutWindow(rig, views, task.knownPoses) };
    return placeTargets(start.rig, views, task.flags, start.poses) && (task.isRobust() || checkPoses(views, start.poses).converged());
}

} // namespace

FitOutcome findStart(const Rig& rig, RigTask& task, RigStart& start, std::vector<OtherMinimum>& minima)
{
    const int moved = task.isRefit ? task.flags | GLASS_FIX_NORMAL : task.flags;       // an earlier fit has found the windows
    const RigViews views = task.isRobust() ? inlierViews(rig, task.views, moved) : task.views;
    const int flags = task.searchFlags();
    const bool isAsGiven = task.isRefit && startAsGiven(rig, views, task, start);
    const bool searchesLens = (flags & GLASS_FREE_INTRINSICS) && !isAsGiven, isIncremental = task.isIncremental(rig) && !isAsGiven;
    FitOutcome outcome;
    if (isAsGiven)
        minima.assign(rig.count(), OtherMinimum());
    else if (isIncremental)
    {
        minima.assign(rig.count(), OtherMinimum());
        start = incrementalStart(rig, views, flags, minima);
    }
    else
    {
        start = { rig, std::vector<Pose>() };
        if (flags & GLASS_FREE_EXTRINSICS)
            placeByViews(views, task.knownPoses, start.rig);
        start.poses = posesWithoutWindow(start.rig, views, task.knownPoses);
        // A window at a known distance is found from where it is given, in the fit that finds the lens.
        outcome = startWindows(start.rig, views, start.poses, flags & GLASS_FREE_DISTANCE ? flags : task.flags, minima);
        placeTargets(start.rig, views, searchesLens ? 0 : flags, start.poses);
        if (outcome.converged())
            outcome = keepGivenPlaces(rig, views, start.poses, start.rig);
        if (!outcome.converged())
            return outcome;
        if (searchesLens && !task.isRobust())
            addPosesIgnoringWindow(start.rig, views, start.poses);
    }
    if (task.isRobust())
        dropUnusable(views, start.poses, task);
    else
        outcome = checkPoses(views, start.poses);
    if (outcome.converged() && searchesLens && !isIncremental)
        start = bestSealedStart(start, views, flags, minima);
    return outcome;
}

void toNearestCenters(Rig& rig, RigFit& fit)
{
    int first = 0;          // of the camera's parameters
    for (Camera& camera : rig.cameras)
    {
        GlassWindow window = camera.window();
        const WindowLayout& at = camera.layers().at();
        const Range center(first + camera.lensCount() + at.normal, first + camera.lensCount() + at.normal + 3);
        const Range axis(center.start + at.axis - at.normal, center.end + at.axis - at.normal);
        first += camera.parameterCount();
        if (window.shape != WINDOW_TUBE || countNonZero(fit.covariance(Range(center.start, axis.end), Range::all())) == 0)
            continue;
        const Vec3d a = window.axis, c = window.center;
        const double along = a.dot(c);
        Mat change = Mat::eye(fit.covariance.size(), CV_64F);
        Mat(Matx33d::eye() - a*a.t()).copyTo(change(center, center));
        Mat(-(a*c.t() + along*Matx33d::eye())).copyTo(change(center, axis));
        fit.covariance = change*fit.covariance*change.t();
        if (!fit.jacobian.empty())
            fit.jacobian.colRange(axis) += along*fit.jacobian.colRange(center);
        window.center = nearestOfAxis(window);
        camera.setWindow(window);
    }
}

//! Of a task all of whose views have points.
static FitOutcome fitSeen(Rig& rig, const RigTask& given, RigFit& fit)
{
    const TermCriteria criteria = checkedCriteria(given.criteria);
    RigTask task = given;
    RigStart start;
    std::vector<OtherMinimum> minima;
    FitOutcome outcome = findStart(rig, task, start, minima);
    if (!outcome.converged())
        return outcome;
    fit.otherMinima = toMat(minima);
    Problem problem(start.rig, task.views, start.poses, task.posePriors, task.cameraPriors, task.flags,
                    task.targetCovariance);
    problem.setPriorMeans(rig, task.knownPoses);
    TargetOutliers outliers(problem);
    if (!task.isRobust())
        outcome = checkFreedom(problem);
    if (outcome.converged())
        outcome = JointFit(problem, outliers, task.isRobust(), seenCount(given.views), criteria).run();
    if (outcome.isUsable())
    {
        const FitOutcome left = checkFreedom(problem);
        outcome = left.converged() ? outcome : left;
    }
    if (!outcome.isUsable())
        return outcome;

    // First, as what is undetermined is also what does not converge.
    const double variance = outcome.varianceFactor*problem.squaredError()/problem.freedom();
    Covariance covariance;
    const FitOutcome determined = covariance.compute(problem, variance, requiredOf(task, problem.rig()));
    if (determined.converged() && !outcome.converged())
    {
        const FitOutcome atDomes = centersAtDomes(problem);
        return atDomes.converged() ? outcome : atDomes;
    }
    if (!determined.converged())
        return determined;
    if (task.wantsCovariance && (criteria.type & TermCriteria::EPS))        // else it is not where the squares are least
        covariance.widen(problem);
    eigen2cv(covariance.ofParameters, fit.covariance);
    fit.sigma = std::sqrt(variance/task.views.variance);    // of a usual pixel
    fit.freedom = problem.freedom();
    fit.targetErrors = targetErrorsOf(problem);
    describeImages(problem, task, outliers.imageStatus(), fit);
    markUnusable(given, fit);
    if (task.wantsJacobian)
        eigen2cv(publicJacobian(problem), fit.jacobian);
    fit.poses = problem.poses();
    rig = problem.rig();
    toNearestCenters(rig, fit);
    sqrt(max(fit.covariance.diag(), 0), fit.stdDeviations);
    return outcome;
}

RigTask onlySeen(const RigTask& task, std::vector<int>& seen)
{
    seen.clear();
    for (int view = 0; view < task.views.count(); view++)
        if (hasPoints(task.views, view))
            seen.push_back(view);
    if ((int)seen.size() == task.views.count())
        return task;
    RigTask some = task;
    some.views = pick(task.views, seen);
    some.knownPoses.clear();
    some.posePriors.clear();
    for (int view : seen)
    {
        if (!task.knownPoses.empty())
            some.knownPoses.push_back(task.knownPoses[view]);
        if (!task.posePriors.empty())
            some.posePriors.push_back(task.posePriors[view]);
    }
    return some;
}

//! As if the other views had been there, without an image.
static void spread(const std::vector<int>& seen, int count, RigFit& fit)
{
    const RigFit some = fit;
    const int columns = some.perViewErrors.cols, first = some.jacobian.cols - 6*(int)seen.size();
    fit.poses.assign(count, Pose());
    fit.perViewErrors = Mat(count, columns, CV_64F, Scalar(NaN));
    fit.imageStatus = Mat(count, columns, CV_8U, Scalar(GLASS_IMAGE_ABSENT));
    fit.inliers.assign(count*columns, Mat());
    if (!some.jacobian.empty())
    {
        fit.jacobian = Mat::zeros(some.jacobian.rows, first + 6*count, CV_64F);
        some.jacobian.colRange(0, first).copyTo(fit.jacobian.colRange(0, first));
    }
    for (int i = 0; i < (int)seen.size(); i++)
    {
        const int view = seen[i];
        fit.poses[view] = some.poses[i];
        some.perViewErrors.row(i).copyTo(fit.perViewErrors.row(view));
        some.imageStatus.row(i).copyTo(fit.imageStatus.row(view));
        std::copy_n(some.inliers.begin() + i*columns, columns, fit.inliers.begin() + view*columns);
        if (!some.jacobian.empty())
            some.jacobian.colRange(first + 6*i, first + 6*i + 6).copyTo(fit.jacobian.colRange(first + 6*view, first + 6*view + 6));
    }
}

FitOutcome fitRig(Rig& rig, const RigTask& task, RigFit& fit)
{
    std::vector<int> seen;
    RigTask some = onlySeen(task, seen);
    const Rig given = rig;
    FitOutcome outcome = fitSeen(rig, some, fit);
    if (some.isRefit && !outcome.converged())
    {
        some.isRefit = false;
        rig = given;
        outcome = fitSeen(rig, some, fit);
    }
    if (outcome.view >= 0)
        outcome.view = seen[outcome.view];
    if (outcome.converged() && (int)seen.size() < task.views.count())
        spread(seen, task.views.count(), fit);
    return outcome;
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

void writePoses(const std::vector<Pose>& poses, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs)
{
    writeVectors(poses, &Pose::rvec, rvecs);
    writeVectors(poses, &Pose::tvec, tvecs);
}

}} // namespace
