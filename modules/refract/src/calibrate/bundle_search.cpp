// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Lengths and halves of pixels leave minima beside the right one. A point in a wrong one drags the cameras along, until all fit badly
and none is left alone. So cameras come near by points of which no other minimum is nearly as low, and all points go to their least one
whenever the cameras have moved. What is not decided in the end is not told. */

#include "calibrate/bundle_search.hpp"
#include "adjust/point_minima.hpp"
#include "adjust/ray_midpoints.hpp"
#include "math/robust_scale.hpp"
#include "start/multi_start.hpp"
#include "start/one_distance.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

const double LEAD = 25;         // of a minimum that is decided, in variances of a residual
const int ROUNDS = 10;          // of points that go to other minima

void holdMediaAndLenses(Problem& problem, bool isHeld)
{
    for (ParameterBlock& block : problem.blocks())
        if (block.kind == ParameterBlock::MEDIA || block.kind == ParameterBlock::LENS)
            for (size_t i = 0; i < block.isFree.size(); i++)
                block.isHeld[i] = isHeld && block.isFree[i];
}

//! Of a problem, to come back to.
class Snapshot
{
public:
    explicit Snapshot(const Problem& problem) : points_(problem.scene().points()), pixelSigma_(problem.pixelSigma())
    {
        for (const Image& image : problem.images())
        {
            inliers_.push_back(std::vector<uchar>());
            for (double weight : image.rootWeights)
                inliers_.back().push_back(weight > 0);
        }
        for (const ParameterBlock& block : problem.blocks())
        {
            values_.push_back(block.values);
            isHeld_.push_back(block.isHeld);
        }
    }
    void restore(Problem& problem) const
    {
        for (size_t i = 0; i < values_.size(); i++)
        {
            problem.blocks()[i].values = values_[i];
            problem.blocks()[i].isHeld = isHeld_[i];
        }
        problem.updateCameras();
        problem.setPixelSigma(pixelSigma_);
        problem.setPoints(points_, inliers_);
    }

private:
    std::vector<Point3d> points_;
    Masks inliers_;
    double pixelSigma_;
    std::vector<Eigen::VectorXd> values_;
    std::vector<std::vector<bool> > isHeld_;
};

double varianceOf(const Problem& problem) { return problem.squaredError()/std::max(problem.freedom(), 1); }

int countFinite(const std::vector<Point3d>& points)
{
    return (int)std::count_if(points.begin(), points.end(), [](const Point3d& point) { return std::isfinite(point.x); });
}

//! With outliers all are used, as none is known to be right.
void useWhatTells(Problem& problem, const std::vector<Point3d>& points, const JointFit& fit)
{
    problem.setPoints(points, Masks());
    if (!fit.isRobust())
        problem.setPoints(pointsThatTell(problem), Masks());
}

//! Of those that started badly, where the cameras are now have them.
std::vector<Point3d> withPointsThatStartedBadly(const Problem& problem)
{
    const std::vector<Point3d> before = problem.scene().points();
    std::vector<Point3d> points = startPoints(problem, before);
    for (size_t i = 0; i < before.size(); i++)
        if (std::isfinite(before[i].x))
            points[i] = before[i];
    return points;
}

/** Uses points of which no other minimum is nearly as low; where these are too few to determine what is free, also those that lead by less.
@param all where all points are then
@return how many are used; 0: all, as there are no others, or nothing is determined without them */
int usePointsOfOneMinimum(Problem& problem, const SceneOutliers& outliers, std::vector<Point3d>& all)
{
    const int SPARE = 5;            // equations: fewer would not show that a point is wrong
    for (double lead : { LEAD, 0.2*LEAD, 0.04*LEAD, 0.01*LEAD })
    {
        const std::vector<Point3d> some = pointsOfOneMinimum(problem, lead);
        all = problem.scene().points();
        const int count = countFinite(some);
        if (count == countFinite(all))
            return 0;
        problem.setPoints(some, Masks());
        if (count > 0 && outliers.checkWhatIsLeft().converged() && problem.freedom() > SPARE)
            return count;
        problem.setPoints(all, Masks());
    }
    return 0;
}

/** Points of which another minimum is nearly as low have no say for a while; then all are where the rest has them least.
@param step what is done without them
@return how many points the others are; 0: nothing was done */
template<class Step>
int decideByPointsOfOneMinimum(Problem& problem, const SceneOutliers& outliers, const JointFit& fit, Step step)
{
    std::vector<Point3d> all;
    const int count = usePointsOfOneMinimum(problem, outliers, all);
    if (count == 0)
        return 0;
    step();
    std::vector<Point3d> now = startPoints(problem, problem.scene().points());
    for (size_t i = 0; i < now.size(); i++)
        now[i] = std::isfinite(now[i].x) ? now[i] : all[i];
    useWhatTells(problem, startPoints(problem, now), fit);
    moveToLeastMinima(problem);
    return count;
}

//! From where the start is.
FitOutcome approach(Problem& problem, const SceneOutliers& outliers, JointFit& fit)
{
    for (int used = 0, before = -1; used > before; )
    {
        before = used;
        used = decideByPointsOfOneMinimum(problem, outliers, fit, [&]() { fit.approach(); });
    }
    FitOutcome outcome = fit.approach();
    for (int round = 0; round < ROUNDS && outcome.isUsable(); round++)
    {
        const int before = countFinite(problem.scene().points());
        if (!fit.isRobust())
            useWhatTells(problem, withPointsThatStartedBadly(problem), fit);
        const bool areMore = countFinite(problem.scene().points()) > before;
        if (!moveToLeastMinima(problem) && !areMore)
            break;
        outcome = fit.approach();
    }
    return outcome;
}

FitOutcome run(Problem& problem, JointFit& fit)
{
    FitOutcome outcome = fit.run();
    for (int round = 0; round < ROUNDS && outcome.isUsable() && moveToLeastMinima(problem); round++)
        outcome = fit.run();
    return outcome;
}

/** What hardly tells a minimum from another may have chosen the wrong one, and the cameras follow. Without it, they may not.
@return converged if that was better */
FitOutcome runByPointsOfOneMinimum(Problem& problem, const SceneOutliers& outliers, JointFit& fit)
{
    const Snapshot before(problem);
    const double variance = varianceOf(problem);
    FitOutcome outcome(FitOutcome::MAX_ITERATIONS);
    if (decideByPointsOfOneMinimum(problem, outliers, fit, [&]() { fit.run(); }))
        outcome = run(problem, fit);
    if (!outcome.converged() || !(varianceOf(problem) < variance))
    {
        before.restore(problem);
        outcome.status = FitOutcome::MAX_ITERATIONS;
    }
    return outcome;
}

/** With points that tell nothing of the cameras, and without those that may as well be where another minimum is: they would be stated as if
they were known, and drag cameras along. */
FitOutcome runWithWhatIsDecided(Problem& problem, const SceneOutliers& outliers, JointFit& fit, const FitOutcome& outcome)
{
    const int telling = countFinite(problem.scene().points());
    problem.setPoints(startPoints(problem, problem.scene().points()), Masks());
    const std::vector<Point3d> all = problem.scene().points();
    problem.setPoints(pointsOfOneMinimum(problem, LEAD), Masks());
    if (countFinite(pointsThatTell(problem)) == telling)
        return outcome;
    if (outliers.checkWhatIsLeft().converged())
        return run(problem, fit);
    problem.setPoints(all, Masks());
    return outcome;
}

FitOutcome approachAndRun(Problem& problem, const SceneOutliers& outliers, JointFit& fit)
{
    // Normals, R and T, poses and points first: while they are far off, distances and lenses would run away along what makes up
    // for them, into other minima.
    holdMediaAndLenses(problem, true);
    FitOutcome outcome = approach(problem, outliers, fit);
    holdMediaAndLenses(problem, false);
    return outcome.isUsable() ? run(problem, fit) : outcome;
}

//! The windows' places stay while it lives.
class HeldPlaces
{
public:
    explicit HeldPlaces(Problem& problem) : problem_(problem)
    {
        for (ParameterBlock& block : problem.blocks())
        {
            isFree_.push_back(block.isFree);
            if (block.kind == ParameterBlock::PLACE)
                block.isFree.assign(block.isFree.size(), false);
        }
    }
    ~HeldPlaces()
    {
        for (size_t i = 0; i < isFree_.size(); i++)
            problem_.blocks()[i].isFree = isFree_[i];
    }
    HeldPlaces(const HeldPlaces&) = delete;
    HeldPlaces& operator=(const HeldPlaces&) = delete;

private:
    Problem& problem_;
    std::vector<std::vector<bool> > isFree_;
};

bool arePlacesFree(const Problem& problem)
{
    return std::any_of(problem.blocks().begin(), problem.blocks().end(), [](const ParameterBlock& block)
    {
        return block.kind == ParameterBlock::PLACE && std::count(block.isFree.begin(), block.isFree.end(), true) > 0;
    });
}

//! Whether a window is where another minimum may be.
bool haveWindowsTurned(const Rig& before, const Rig& after)
{
    for (int c = 0; c < before.count(); c++)
        if (before.owns(c) && angleBetweenPlaces(before.cameras[c].window(), after.cameras[c].window()) > SAME_ANGLE)
            return true;
    return false;
}

//! In variances; what is left out is at the cut.
double truncatedSquares(const Problem& problem, double variance)
{
    int left = 0;
    for (const Image& image : problem.images())
        left += (int)image.rootWeights.size() - image.usedCount();
    return problem.squaredError()/variance + CUT*CUT*left;
}

FitOutcome searchFromStart(Problem& problem, const SceneOutliers& outliers, JointFit& fit)
{
    useWhatTells(problem, problem.scene().points(), fit);
    const FitOutcome outcome = approachAndRun(problem, outliers, fit);
    const FitOutcome other = outcome.isUsable() ? runByPointsOfOneMinimum(problem, outliers, fit) : outcome;
    return outcome.isUsable() ? runWithWhatIsDecided(problem, outliers, fit, other.converged() ? other : outcome) : outcome;
}

} // namespace

FitOutcome searchBundle(Problem& problem, const SceneOutliers& outliers, JointFit& fit, JointFit& another)
{
    const double MOST = 0.9;            // of the equations: few are easily fitted
    const bool mayBeElsewhere = problem.scene().lengthCount() > 0 && areRaysParallel(problem);
    const Snapshot start(problem);
    const FitOutcome outcome = searchFromStart(problem, outliers, fit);
    if (!mayBeElsewhere)
        return outcome;
    const Snapshot found(problem);
    const double variance = varianceOf(problem), equations = problem.equationCount();
    start.restore(problem);
    FitOutcome other(FitOutcome::MAX_ITERATIONS);
    if (placeAtOneDistance(problem))
        other = searchFromStart(problem, outliers, another);
    if (other.converged() && (!outcome.converged() || (varianceOf(problem) < variance && problem.equationCount() > MOST*equations)))
        return other;
    found.restore(problem);
    return outcome;
}

FitOutcome searchRobustBundle(Problem& problem, const SceneOutliers& outliers, JointFit& fit, JointFit& another)
{
    const Snapshot start(problem);
    const Rig rig = problem.rig();
    const FitOutcome outcome = approachAndRun(problem, outliers, fit);
    if (!arePlacesFree(problem) || (outcome.converged() && !haveWindowsTurned(rig, problem.rig())))
        return outcome;
    const Snapshot found(problem);
    const double variance = varianceOf(problem);
    start.restore(problem);
    FitOutcome other;
    {
        const HeldPlaces held(problem);
        other = approachAndRun(problem, outliers, another);
    }
    if (other.isUsable())
        other = run(problem, another);
    const double least = std::min(variance, varianceOf(problem)), squares = truncatedSquares(problem, least);
    const Snapshot ofOther(problem);
    found.restore(problem);
    if (!other.converged() || (outcome.converged() && truncatedSquares(problem, least) <= squares))
        return outcome;
    ofOther.restore(problem);
    return other;
}

}} // namespace
