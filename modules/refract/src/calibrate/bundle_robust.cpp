// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Two rays of wrong matches often come within the noise of each other: one equation checks them. So a point that has an outlier
stays only if more than half of its observations are inliers, and at least three; one without outliers needs two. */

#include "calibrate/bundle_robust.hpp"
#include "calibrate/bundle_information.hpp"
#include "calibrate/bundle_start.hpp"
#include "math/robust_scale.hpp"
#include <set>

namespace cv { namespace refract {

namespace {

const Point3d NOWHERE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                      std::numeric_limits<double>::quiet_NaN());

bool isEnough(int inliers, int observations)
{
    return inliers == observations ? inliers >= 2 : inliers >= 3 && 2*inliers > observations;
}

//! Observations of each point: those that are used, and all.
struct PointCounts
{
    PointCounts(const RigProblem& rig, const Masks& used, int points) : inliers(points, 0), observations(points, 0)
    {
        for (size_t i = 0; i < used.size(); i++)
            for (size_t row = 0; row < used[i].size(); row++)
            {
                const int point = rig.images()[i].points.index[row];
                observations[point]++;
                inliers[point] += used[i][row] != 0;
            }
    }
    bool areEnough(int point) const { return isEnough(inliers[point], observations[point]); }
    std::vector<int> inliers, observations;
};

} // namespace

double BundleFitProblem::rootWeight(double ratio) const
{
    const double CAUCHY = 2.385;    // 95 % as efficient as squares on clean data; never 0, so that no point is lost on the way
    return 1/std::sqrt(1 + std::pow(ratio/CAUCHY, 2));
}

bool BundleFitProblem::tellsScale() const
{
    std::set<int> cameras, views;
    for (const RigImage& image : rig().images())
        if (image.usedCount() > 0)
        {
            cameras.insert(image.camera);
            views.insert(image.view);
        }
    return bundle_.lengthCount() > 0 || (isRigKnown_ && cameras.size() > 1) || (arePosesKnown_ && views.size() > 1);
}

void BundleFitProblem::checkWhatIsLeft() const
{
    if (!tellsScale())
        CV_Error(Error::StsBadArg, "lengths has none between two points that are seen in two images or more, by rays "
                                   "that meet beyond the windows; nothing else tells the scale");
    if (bundle_.freedom() <= 0)
        CV_Error_(Error::StsBadArg, ("points that are seen in two images or more give %d equations, with lengths and poses; %d "
                                     "fewer than are needed; take more points, or points that more images see",
                                     bundle_.equationCount(), 1 - bundle_.freedom()));
}

void BundleFitProblem::setInliers(Masks& inliers)
{
    std::vector<Point3d> points = bundle_.points();
    const PointCounts counts(rig(), inliers, (int)points.size());
    for (int point = 0; point < (int)points.size(); point++)
        if (!counts.areEnough(point))
            points[point] = NOWHERE;
    for (size_t i = 0; i < inliers.size(); i++)
        for (size_t row = 0; row < inliers[i].size(); row++)
            if (!std::isfinite(points[rig().images()[i].points.index[row]].x))
                inliers[i][row] = 0;
    bundle_.setPoints(points, inliers);
    checkWhatIsLeft();
}

/** Points that are not in use, where their rays come closest; while that is not near all of them, the observation that is
farthest off is left out. */
bool BundleFitProblem::bringBack(Masks& inliers, double scale)
{
    const int ROUNDS = 10;
    std::vector<Point3d> points = bundle_.points();
    const int count = (int)points.size();
    Masks trial = inliers;
    for (size_t i = 0; i < trial.size(); i++)
        for (size_t row = 0; row < trial[i].size(); row++)
            trial[i][row] = !std::isfinite(points[rig().images()[i].points.index[row]].x);
    bool found = false;
    for (int round = 0; round < ROUNDS; round++)
    {
        const PointCounts counts(rig(), trial, count);
        const std::vector<Point3d> meetings = rayMeetings(rig(), count, trial);
        rig().setObjectPoints(meetings);
        struct Worst { double error; int image, row; };
        std::vector<Worst> worst(count, Worst{ -1, -1, -1 });
        for (int i = 0; i < (int)trial.size(); i++)
        {
            const RigImage& image = rig().images()[i];
            if (std::none_of(trial[i].begin(), trial[i].end(), [](uchar t) { return t != 0; }))
                continue;
            const std::vector<double> errors = rig().pixelErrors(image, rig().pose(image.view));
            for (int row = 0; row < (int)errors.size(); row++)
                if (trial[i][row] && errors[row] > worst[image.points.index[row]].error)
                    worst[image.points.index[row]] = { errors[row], i, row };
        }
        for (int point = 0; point < count; point++)
        {
            if (worst[point].image < 0 || std::isfinite(points[point].x) || !counts.areEnough(point))
                continue;
            if (!std::isfinite(meetings[point].x) || !(worst[point].error < CUT*scale))
            {
                trial[worst[point].image][worst[point].row] = 0;
                continue;
            }
            points[point] = meetings[point];
            found = true;
        }
        // What has come back is decided.
        for (size_t i = 0; i < trial.size(); i++)
            for (size_t row = 0; row < trial[i].size(); row++)
                if (trial[i][row] && std::isfinite(points[rig().images()[i].points.index[row]].x))
                {
                    inliers[i][row] = 1;
                    trial[i][row] = 0;
                }
    }
    if (!found)
        return false;
    bundle_.setPoints(points, inliers);
    return true;
}

std::vector<std::pair<int, int> > BundleFitProblem::tiedPoints() const
{
    std::vector<std::pair<int, int> > tied;
    for (const Cluster& cluster : bundle_.clusters())
        for (const KnownLength& length : cluster.lengths)
            tied.push_back({ cluster.points[length.a], cluster.points[length.b] });
    return tied;
}

std::vector<std::vector<DeletionResidual> > BundleFitProblem::deletionResiduals(const Masks& inliers)
{
    std::vector<std::vector<DeletionResidual> > all(inliers.size());
    Masks hasImage;
    bundle_.evaluateAll(hasImage);
    const std::vector<std::vector<Matx22d> > predictions = ReducedBundle(bundle_, false).predictions();
    for (int i = 0; i < (int)inliers.size(); i++)
    {
        const Eigen::VectorXd& residuals = bundle_.state(i).derivatives.residuals;
        for (int row = 0; row < (int)inliers[i].size(); row++)
        {
            DeletionResidual residual(Vec2d(residuals[2*row], residuals[2*row + 1]), predictions[i][row], inliers[i][row] != 0);
            residual.dimensions = hasImage[i][row] ? residual.dimensions : 0;
            all[i].push_back(residual);
        }
    }
    return all;
}

String BundleFitProblem::minorityFault(int fitting, int seen) const
{
    return format("only %d of %d observations fit; are the points matched, and is the start near enough?", fitting, seen);
}

}} // namespace
