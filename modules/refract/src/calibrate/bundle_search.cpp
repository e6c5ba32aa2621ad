// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Lengths and halves of pixels leave minima beside the right one. A point in a wrong one drags the cameras along, until all fit badly
and none is left alone. So cameras come near by points of which no other minimum is nearly as low, and all points go to their least one
whenever the cameras have moved. */

#include "calibrate/bundle_search.hpp"
#include "adjust/other_points.hpp"
#include "adjust/ray_midpoints.hpp"

namespace cv { namespace refract {

namespace {

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
        problem.setPoints(points_, Masks());
    }

private:
    std::vector<Point3d> points_;
    double pixelSigma_;
    std::vector<Eigen::VectorXd> values_;
    std::vector<std::vector<bool> > isHeld_;
};

double varianceOf(const Problem& problem) { return problem.squaredError()/std::max(problem.freedom(), 1); }

int countFinite(const std::vector<Point3d>& points)
{
    return (int)std::count_if(points.begin(), points.end(), [](const Point3d& point) { return std::isfinite(point.x); });
}

/** Points of which another minimum is nearly as low have no say for a while; then all are where the rest has them least.
@param fit what is done without them
@return how many points the others are; 0: there are no such points, or the others do not determine what is free */
template<class Fit>
int decideByPointsOfOneMinimum(Problem& problem, const SceneOutliers& outliers, Fit fit)
{
    const std::vector<Point3d> some = pointsOfOneMinimum(problem), all = problem.scene().points();
    const int count = countFinite(some);
    if (count == countFinite(all))
        return 0;
    problem.setPoints(some, Masks());
    const bool isEnough = count > 0 && outliers.checkWhatIsLeft().converged();
    if (isEnough)
        fit();
    std::vector<Point3d> now = isEnough ? startPoints(problem, problem.scene().points()) : all;
    for (size_t i = 0; i < now.size(); i++)
        now[i] = std::isfinite(now[i].x) ? now[i] : all[i];
    problem.setPoints(startPoints(problem, now), Masks());
    moveToLeastMinima(problem);
    return isEnough ? count : 0;
}

//! From where the start is.
FitOutcome approach(Problem& problem, const SceneOutliers& outliers, RobustFit& fit)
{
    for (int used = 0, before = -1; used > before; )
    {
        before = used;
        used = decideByPointsOfOneMinimum(problem, outliers, [&]() { fit.approach(); });
    }
    FitOutcome outcome = fit.approach();
    for (int round = 0; round < ROUNDS && outcome.isUsable() && moveToLeastMinima(problem); round++)
        outcome = fit.approach();
    return outcome;
}

FitOutcome run(Problem& problem, RobustFit& fit)
{
    FitOutcome outcome = fit.run();
    for (int round = 0; round < ROUNDS && outcome.isUsable() && moveToLeastMinima(problem); round++)
        outcome = fit.run();
    return outcome;
}

/** What hardly tells a minimum from another may have chosen the wrong one, and the cameras follow. Without it, they may not.
@return converged if that was better */
FitOutcome runByPointsOfOneMinimum(Problem& problem, const SceneOutliers& outliers, RobustFit& fit)
{
    const Snapshot before(problem);
    const double variance = varianceOf(problem);
    FitOutcome outcome(FitOutcome::MAX_ITERATIONS);
    if (decideByPointsOfOneMinimum(problem, outliers, [&]() { fit.run(); }))
        outcome = run(problem, fit);
    if (!outcome.converged() || !(varianceOf(problem) < variance))
    {
        before.restore(problem);
        outcome.status = FitOutcome::MAX_ITERATIONS;
    }
    return outcome;
}

} // namespace

FitOutcome searchBundle(Problem& problem, const SceneOutliers& outliers, bool isRobust, RobustFit& fit)
{
    // Normals, R and T, poses and points first: while they are far off, distances and lenses would run away along what makes up
    // for them, into other minima.
    holdMediaAndLenses(problem, true);
    FitOutcome outcome = approach(problem, outliers, fit);
    holdMediaAndLenses(problem, false);
    if (outcome.isUsable())
        outcome = run(problem, fit);
    if (!outcome.isUsable() || isRobust)        // outliers leave points out too
        return outcome;
    const FitOutcome other = runByPointsOfOneMinimum(problem, outliers, fit);
    return other.converged() ? other : outcome;
}

}} // namespace
