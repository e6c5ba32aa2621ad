// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The search for the minimum of a calibration that has several. */

#include "start/multi_start.hpp"
#include "adjust/inner.hpp"
#include "adjust/linearize.hpp"
#include "adjust/minimize.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

//! So many of the views, evenly.
RigViews someViews(const RigViews& views, int atMost)
{
    const int count = std::min(atMost, views.count());
    std::vector<int> some;
    for (int i = 0; i < count; i++)
        some.push_back(i*views.count()/count);
    return pick(views, some);
}

/** To the least squares. Where only poses are free, each is there by itself.
@param cost there; infinite: some point has no image */
bool fit(Problem& problem, const TermCriteria& criteria, double& cost)
{
    cost = std::numeric_limits<double>::infinity();
    if (FreeSpace(problem).count == 0)
    {
        double squares;
        const bool isPossible = optimizeInner(problem, squares);
        if (isPossible)
            cost = squares;
        return isPossible;
    }
    const FitOutcome outcome = minimize(problem, criteria);
    if (outcome.isUsable())
        cost = problem.squaredError();
    return outcome.converged();
}

Minimum fitFrom(const RigStart& start, const RigViews& views, const TermCriteria& criteria, int flags)
{
    Minimum minimum;
    minimum.rig = start.rig;
    minimum.start = start;
    minimum.poses = start.poses;
    if ((int)start.poses.size() != views.count())
    {
        minimum.poses.assign(views.count(), Pose());
        placeTargets(minimum.rig, views, flags, minimum.poses);
    }
    if (!checkPoses(views, minimum.poses).converged())
        return minimum;
    Problem problem(minimum.rig, views, minimum.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(), flags);
    double cost;
    const bool converged = fit(problem, criteria, cost);
    if (!std::isfinite(cost))       // it is sorted by
        return minimum;
    minimum.rig = problem.rig();
    minimum.poses = problem.poses();
    minimum.cost = cost;
    minimum.freedom = problem.freedom();
    minimum.converged = converged;
    return minimum;
}

void addFits(const std::vector<RigStart>& starts, const RigViews& views, const TermCriteria& criteria, int flags,
             std::vector<Minimum>& minima)
{
    for (const RigStart& start : starts)
        minima.push_back(fitFrom(start, views, criteria, flags));
    std::stable_sort(minima.begin(), minima.end());
}

bool isSameWindow(const Minimum& a, const Minimum& b, int c, double angle)
{
    return isSameWindow(a.rig.cameras[c].window(), b.rig.cameras[c].window(), meanRange(a.poses), angle);
}

bool isSameMinimum(const Minimum& a, const Minimum& b, double angle)
{
    for (int c = 0; c < a.rig.count(); c++)
        if (!isSameWindow(a, b, c, angle))
            return false;
    return true;
}

//! In standard deviations of a pixel.
double excessOver(const Minimum& best, const Minimum& other)
{
    return std::sqrt((other.cost - best.cost)*best.freedom/std::max(best.cost, DBL_MIN));
}

bool isFirstBehind(const Rig& rig, int c)
{
    return std::find(rig.owner.begin(), rig.owner.end(), rig.owner[c]) == rig.owner.begin() + c;
}

} // namespace

bool isSameWindow(const GlassWindow& first, const GlassWindow& second, double range, double angle)
{
    const double SAME_DISTANCE = 0.05;      // part of the distance
    const double NEAREST = 0.02;            // part of the range: of a window that ends on the camera, 5 % are nothing
    return angleBetweenPlaces(first, second) <= angle &&
           std::abs(first.distance - second.distance) <= SAME_DISTANCE*std::max(first.distance, NEAREST*range);
}

RigViews pick(const RigViews& views, const std::vector<int>& which)
{
    RigViews picked;
    picked.variance = views.variance;
    picked.cameras.resize(views.cameras.size());
    for (int view : which)
    {
        picked.object.push_back(views.object[view]);
        for (size_t c = 0; c < views.cameras.size(); c++)
        {
            const CameraViews& from = views.cameras[c];
            CameraViews& to = picked.cameras[c];
            to.direct.push_back(from.direct[view]);
            to.refracted.push_back(from.refracted[view]);
            if (!from.directCovariances.empty())
                to.directCovariances.push_back(from.directCovariances[view]);
            if (!from.refractedCovariances.empty())
                to.refractedCovariances.push_back(from.refractedCovariances[view]);
        }
    }
    return picked;
}

std::vector<Minimum> keptMinima(const std::vector<Minimum>& sorted, const Stage& stage)
{
    std::vector<Minimum> kept;
    for (const Minimum& minimum : sorted)
    {
        const auto isSame = [&](const Minimum& other) { return isSameMinimum(other, minimum, stage.sameAngle); };
        const bool isPlausible = std::isinf(stage.maxExcess) || excessOver(sorted[0], minimum) < stage.maxExcess;
        if (kept.size() < stage.keep && isPlausible && std::none_of(kept.begin(), kept.end(), isSame))
            kept.push_back(minimum);
    }
    return kept;
}

std::vector<Minimum> multiStart(std::vector<RigStart> hypotheses, const std::vector<Stage>& stages, const RigViews& views, int flags)
{
    std::vector<Minimum> minima;
    for (const Stage& stage : stages)
    {
        minima.clear();
        addFits(hypotheses, someViews(views, stage.views), stage.criteria, flags, minima);
        minima = keptMinima(minima, stage);
        hypotheses.assign(minima.begin(), minima.end());
    }
    return minima;
}

std::vector<Minimum> hillClimb(std::vector<Minimum> minima, const Neighbours& neighbours, const RigViews& views, int flags)
{
    const double BETTER = 1e-6;
    const int ROUNDS = 10;      // perfect data have ever smaller rounding errors
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < ROUNDS && minima[0].cost < (1 - BETTER)*before; round++)
    {
        before = minima[0].cost;
        addFits(neighbours(minima[0]), views, FINE, flags, minima);
    }
    return minima;
}

void describeOther(const std::vector<Minimum>& sorted, std::vector<OtherMinimum>& others)
{
    for (const Minimum& minimum : sorted)
    {
        if (!minimum.converged || minimum.freedom <= 0 || isSameMinimum(sorted[0], minimum, SAME_ANGLE))
            continue;
        for (int c = 0; c < minimum.rig.count(); c++)
            if (isFirstBehind(minimum.rig, c) && !isSameWindow(sorted[0], minimum, c, SAME_ANGLE))
            {
                others[c].window = minimum.rig.cameras[c].window();
                others[c].excess = excessOver(sorted[0], minimum);
            }
        return;
    }
}

}} // namespace
