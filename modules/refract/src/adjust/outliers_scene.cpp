// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Two rays of wrong matches often come within the noise of each other: one equation checks them. So a point that has an outlier
stays only if more than half of its observations are inliers, and two equations at least check them, as of three rays; one
without outliers needs three coordinates. */

#include "adjust/outliers.hpp"
#include "adjust/inner.hpp"
#include "adjust/ray_midpoints.hpp"
#include "math/robust_scale.hpp"
#include <set>

namespace cv { namespace refract {

namespace {

const Point3d NOWHERE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                      std::numeric_limits<double>::quiet_NaN());

//! Observations of each point: those that are used, and all.
struct PointCounts
{
    PointCounts(const Problem& problem, const Masks& used, int points)
        : inliers(points, 0), observations(points, 0), coordinates(points, 0)
    {
        for (size_t i = 0; i < used.size(); i++)
            for (size_t row = 0; row < used[i].size(); row++)
            {
                const int point = problem.images()[i].points.index[row];
                observations[point]++;
                inliers[point] += used[i][row] != 0;
                coordinates[point] += used[i][row] ? problem.images()[i].points.rowsOf(row) : 0;
            }
    }
    bool areEnough(int point) const
    {
        return inliers[point] == observations[point] ? coordinates[point] >= 3
                                                     : coordinates[point] >= 5 && 2*inliers[point] > observations[point];
    }
    std::vector<int> inliers, observations;
    std::vector<int> coordinates;       //!< of the inliers
};

} // namespace

double SceneOutliers::rootWeight(double ratio) const
{
    const double CAUCHY = 2.385;    // 95 % as efficient as squares on clean data; never 0, so that no point is lost on the way
    return 1/std::sqrt(1 + std::pow(ratio/CAUCHY, 2));
}

bool SceneOutliers::tellsScale() const
{
    std::set<int> cameras, views;
    for (const Image& image : problem_.images())
        if (image.usedCount() > 0)
        {
            cameras.insert(image.camera);
            views.insert(image.view);
        }
    return (scale_.areLengthsKnown && problem_.scene().lengthCount() > 0) || (scale_.isRigKnown && cameras.size() > 1) ||
           (scale_.arePosesKnown && views.size() > 1);
}

FitOutcome SceneOutliers::checkWhatIsLeft() const
{
    FitOutcome outcome;
    outcome.count = problem_.equationCount();
    outcome.expected = problem_.unknownCount() + 1;
    if (!tellsScale())
        outcome.status = FitOutcome::NO_SCALE;
    else if (outcome.count < outcome.expected)
        outcome.status = FitOutcome::TOO_FEW_EQUATIONS;
    return outcome;
}

FitOutcome SceneOutliers::setInliers(Masks& inliers)
{
    std::vector<Point3d> points = problem_.scene().points();
    const PointCounts counts(problem_, inliers, (int)points.size());
    for (int point = 0; point < (int)points.size(); point++)
        if (!counts.areEnough(point))
            points[point] = NOWHERE;
    for (size_t i = 0; i < inliers.size(); i++)
        for (size_t row = 0; row < inliers[i].size(); row++)
            if (!std::isfinite(points[problem_.images()[i].points.index[row]].x))
                inliers[i][row] = 0;
    problem_.setPoints(points, inliers);
    return checkWhatIsLeft();
}

namespace {

//! Whether pixels and lengths agree where both together have the points.
bool isConsistent(const Problem& problem, int cluster, const Masks& inliers, double scale, const std::vector<std::vector<double> >& errors)
{
    for (const Observation& o : problem.observationsOf(cluster))
        if (inliers[o.image][o.row] && !(errors[o.image][o.row] < CUT*scale))
            return false;
    const Cluster& points = problem.scene().clusters()[cluster];
    return points.lengths.empty() || points.squaredLengthError(1) < CUT*CUT*(double)points.lengths.size();
}

} // namespace

/** Rays of wrong matches meet where no length has a point, and the cameras of a fit would follow the length. So points come back only
where images and lengths agree, the cameras staying.
@param before inliers without these points
@return whether one comes back */
bool SceneOutliers::bringBackWhatLengthsAllow(const std::vector<Point3d>& points, const Masks& before, double scale, Masks& inliers)
{
    problem_.setPoints(points, inliers);
    optimizeClusters(problem_);
    std::vector<Point3d> kept = problem_.scene().points();
    problem_.placePoints(kept);
    const std::vector<std::vector<double> > errors = problem_.pixelErrors();
    bool isAny = false;
    for (int i = 0; i < (int)problem_.scene().clusters().size(); i++)
    {
        const bool isGood = isConsistent(problem_, i, inliers, scale, errors);
        for (const Observation& o : problem_.observationsOf(i))
        {
            uchar& isInlier = inliers[o.image][o.row];
            if (!isInlier || before[o.image][o.row])
                continue;
            isAny = isAny || isGood;
            isInlier = isGood;
            if (!isGood)
                kept[problem_.images()[o.image].points.index[o.row]] = NOWHERE;
        }
    }
    problem_.setPoints(kept, inliers);
    return isAny;
}

/** Points that are not in use, where their rays come closest; while that is not near all of them, the observation that is
farthest off is left out. */
bool SceneOutliers::bringBack(Masks& inliers, double scale, std::vector<uchar>& returned)
{
    const int ROUNDS = 10;
    std::vector<Point3d> points = problem_.scene().points();
    const int count = (int)points.size();
    returned.resize(count, 0);
    std::vector<uchar> wasUsed(count);
    for (int point = 0; point < count; point++)
        wasUsed[point] = problem_.scene().isUsed(point);
    const Masks before = inliers;
    Masks trial = inliers;
    for (size_t i = 0; i < trial.size(); i++)
        for (size_t row = 0; row < trial[i].size(); row++)
        {
            const int point = problem_.images()[i].points.index[row];
            trial[i][row] = !std::isfinite(points[point].x) && !returned[point];
        }
    bool found = false;
    for (int round = 0; round < ROUNDS; round++)
    {
        const PointCounts counts(problem_, trial, count);
        const std::vector<Point3d> midpoints = rayMidpoints(problem_, count, trial);
        problem_.placePoints(midpoints);
        struct Worst { double error; int image, row; };
        std::vector<Worst> worst(count, Worst{ -1, -1, -1 });
        for (int i = 0; i < (int)trial.size(); i++)
        {
            const Image& image = problem_.images()[i];
            if (std::none_of(trial[i].begin(), trial[i].end(), [](uchar t) { return t != 0; }))
                continue;
            const std::vector<double> errors = problem_.pixelErrors(image);
            for (int row = 0; row < (int)errors.size(); row++)
                if (trial[i][row] && errors[row] > worst[image.points.index[row]].error)
                    worst[image.points.index[row]] = { errors[row], i, row };
        }
        for (int point = 0; point < count; point++)
        {
            if (worst[point].image < 0 || std::isfinite(points[point].x) || !counts.areEnough(point))
                continue;
            if (!std::isfinite(midpoints[point].x) || !(worst[point].error < CUT*scale))
            {
                trial[worst[point].image][worst[point].row] = 0;
                continue;
            }
            points[point] = midpoints[point];
            found = true;
        }
        // What has come back is decided.
        for (size_t i = 0; i < trial.size(); i++)
            for (size_t row = 0; row < trial[i].size(); row++)
                if (trial[i][row] && std::isfinite(points[problem_.images()[i].points.index[row]].x))
                {
                    inliers[i][row] = 1;
                    trial[i][row] = 0;
                }
    }
    if (!found || !bringBackWhatLengthsAllow(points, before, scale, inliers))
        return false;
    for (int point = 0; point < count; point++)
        returned[point] = returned[point] || (!wasUsed[point] && problem_.scene().isUsed(point));
    return true;
}

Masks SceneOutliers::candidates() const
{
    Masks all;
    for (const Image& image : problem_.images())
    {
        all.push_back(std::vector<uchar>());
        for (int point : image.points.index)
            all.back().push_back(problem_.scene().isUsed(point));
    }
    return all;
}

}} // namespace
