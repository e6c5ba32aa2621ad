// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Starts of the windows. */

#include "start/window_start.hpp"
#include "adjust/minimize.hpp"
#include "start/normal_from_pairs.hpp"
#include "window/wedge.hpp"

namespace cv { namespace refract {

namespace {

// The first search needs the rough shape of the cost only.
const int SEARCH_VIEWS = 8, SEARCH_FITS = 4;
const double SAME_DISTANCE = 0.01;     // as SAME_ANGLE: part of the distance to the target

//! The given normal first, then tilts from the optical axis.
std::vector<Vec3d> candidateNormals(const Vec3d& given)
{
    std::vector<Vec3d> normals(1, given);
    normals.push_back(Vec3d(0, 0, 1));
    for (double tilt : { 0.2, 0.45 })
        for (int i = 0; i < 8; i++)
        {
            const double azimuth = i*CV_PI/4;
            normals.push_back(Vec3d(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt)));
        }
    return normals;
}

GlassWindow turned(GlassWindow window, const Vec3d& normal)
{
    window.normal = normal;
    return window;
}

//! What the camera saw through the window: every view, or so many of them evenly.
RigViews searchViews(const PixelViews& refracted, const std::vector<std::vector<Point3d> >& object, int atMost)
{
    std::vector<int> good;
    for (int i = 0; i < (int)refracted.size(); i++)
        if (countSeen(refracted[i]) >= 4)
            good.push_back(i);
    RigViews views;
    views.cameras.resize(1);
    const int count = std::min(atMost, (int)good.size());
    for (int i = 0; i < count; i++)
    {
        const int view = good[i*good.size()/count];
        views.object.push_back(object[view]);
        views.cameras[0].refracted.push_back(refracted[view]);
    }
    views.cameras[0].direct.resize(count);
    return views;
}

//! A window, the best poses behind it, and what they leave.
struct Candidate
{
    GlassWindow window;
    std::vector<Pose> poses;
    double cost;        //!< sum of squared residuals; infinite if a view has no pose
    bool operator<(const Candidate& other) const { return cost < other.cost; }
};

//! The best poses behind this window, started from others.
Candidate placeViews(const Camera& camera, const GlassWindow& window, const RigViews& views,
                     const std::vector<Pose>& starts)
{
    Candidate candidate = { window, starts, 0 };
    const Camera behind = withWindow(camera, window);
    for (int i = 0; i < views.count(); i++)
    {
        const std::vector<Point2d>& pixels = views.cameras[0].refracted[i];
        double rms;
        candidate.poses[i] = solvePose(behind, views.object[i], pixels, starts[i], rms);
        if (!candidate.poses[i].found)
            candidate.cost = std::numeric_limits<double>::infinity();
        else
            candidate.cost += rms*rms*countSeen(pixels);
    }
    return candidate;
}

//! All candidate normals that have poses: the given one first, the others by their cost.
std::vector<Candidate> tryNormals(const Camera& camera, const RigViews& views)
{
    std::vector<Candidate> candidates;
    std::vector<Pose> starts(views.count());
    for (const Vec3d& normal : candidateNormals(camera.layers().normal()))
    {
        const Candidate candidate = placeViews(camera, turned(camera.window(), normal), views, starts);
        if (!std::isfinite(candidate.cost))
            continue;
        candidates.push_back(candidate);
        starts = candidate.poses;
    }
    if (!candidates.empty())
        std::stable_sort(candidates.begin() + 1, candidates.end());
    return candidates;
}

//! The minimum that the candidate leads to.
Candidate fitWindow(const Camera& camera, const RigViews& views, const Candidate& start, int flags)
{
    const Rig rig = { { withWindow(camera, start.window) }, { 0 }, { Pose() } };
    Problem problem(rig, views, start.poses, std::vector<PosePrior>(), std::vector<CameraPrior>(),
                       flags & GLASS_FREE_DISTANCE);
    if (!minimize(problem, TermCriteria(TermCriteria::COUNT | TermCriteria::EPS, 100, 1e-6)).isUsable())
        return { start.window, start.poses, std::numeric_limits<double>::infinity() };
    Candidate fitted = { problem.camera(0).window(), start.poses, problem.squaredError() };
    for (int view = 0; view < views.count(); view++)
        fitted.poses[view] = problem.pose(view);
    return fitted;
}

bool areSame(const Candidate& a, const Candidate& b)
{
    return angleBetween(a.window.normal, b.window.normal) < SAME_ANGLE &&
           std::abs(a.window.distance - b.window.distance) < SAME_DISTANCE*norm(a.poses[0].tvec);
}

//! Fits all; of those that end in one minimum the best, the best first.
std::vector<Candidate> distinctMinima(const Camera& camera, const RigViews& views, const std::vector<Candidate>& starts,
                                      int flags)
{
    std::vector<Candidate> fitted, minima;
    for (const Candidate& start : starts)
        fitted.push_back(fitWindow(camera, views, start, flags));
    std::stable_sort(fitted.begin(), fitted.end());
    for (const Candidate& candidate : fitted)
        if (std::none_of(minima.begin(), minima.end(), [&](const Candidate& m) { return areSame(m, candidate); }))
            minima.push_back(candidate);
    return minima;
}

OtherMinimum secondOf(const std::vector<Candidate>& minima, const RigViews& views)
{
    OtherMinimum other;
    int points = 0;
    for (const std::vector<Point2d>& view : views.cameras[0].refracted)
        points += countSeen(view);
    const int freedom = 2*points - 6*views.count() - 2;
    for (size_t i = 1; i < minima.size() && std::isnan(other.excess) && freedom > 0; i++)
        if (angleBetween(minima[i].window.normal, minima[0].window.normal) > SAME_ANGLE)
        {
            other.normal = minima[i].window.normal;
            other.distance = minima[i].window.distance;
            other.excess = excessOf(minima[i].cost, minima[0].cost, freedom);
        }
    return other;
}

//! The window of one camera from images through it alone.
GlassWindow searchWindow(const Camera& camera, const PixelViews& refracted,
                         const std::vector<std::vector<Point3d> >& object, int flags, OtherMinimum& other)
{
    const RigViews some = searchViews(refracted, object, SEARCH_VIEWS);
    std::vector<Candidate> minima = tryNormals(camera, some);
    if (some.count() == 0 || minima.empty())
        return camera.window();
    minima.resize(std::min(minima.size(), (size_t)SEARCH_FITS + 1));
    minima = distinctMinima(camera, some, minima, flags);

    // Some views may have their least cost in another minimum than all have.
    const RigViews all = searchViews(refracted, object, (int)refracted.size());
    if (all.count() > some.count())
    {
        std::vector<Candidate> starts;
        for (const Candidate& minimum : minima)
        {
            const Candidate placed = placeViews(camera, minimum.window, all, std::vector<Pose>(all.count()));
            if (std::isfinite(placed.cost))
                starts.push_back(placed);
        }
        if (!starts.empty())
            minima = distinctMinima(camera, all, starts, flags);
    }
    other = secondOf(minima, all);
    return minima[0].window;
}

/** What a camera would see without the window, where it has no direct image but the pose is known without. Not if R and T are free
and no direct image tells them: the normal would make up for their error. */
PixelViews withPredicted(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses, int flags)
{
    PixelViews direct = views.cameras[c].direct;
    if (c > 0 && (flags & GLASS_FREE_EXTRINSICS) && !seesAnything(direct))
        return direct;
    const TransformWithDerivatives toCamera(rig.extrinsics[c]);
    for (int view = 0; view < views.count(); view++)
    {
        if (!poses[view].found || !direct[view].empty())
            continue;
        const TransformWithDerivatives toCamera1(poses[view]);
        for (const Point3d& point : views.object[view])
        {
            const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(point)));
            Point2d pixel;
            uchar status = REFRACT_OK;
            rig.cameras[c].lens().project(1, &X[0], &X[1], &X[2], &pixel.x, &pixel.y, &status);
            const double missing = std::numeric_limits<double>::quiet_NaN();
            direct[view].push_back(status == REFRACT_OK ? pixel : Point2d(missing, missing));
        }
    }
    return direct;
}

//! Turns a direction from one camera's frame to another's.
Matx33d rotationBetween(const Rig& rig, int from, int to)
{
    return TransformWithDerivatives(rig.extrinsics[to]).rotation.R*TransformWithDerivatives(rig.extrinsics[from]).rotation.R.t();
}

//! The normal that the pairs of all cameras behind the window tell best, in the owner's frame; false if none does.
bool normalOfPairs(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses, int flags,
                   Vec3d& normal)
{
    double least = std::numeric_limits<double>::infinity();
    for (int c = owner; c < rig.count(); c++)
    {
        if (rig.owner[c] != owner || !seesAnything(views.cameras[c].refracted))
            continue;
        const PixelViews direct = withPredicted(rig, c, views, poses, flags);
        const NormalEstimate estimate = (flags & GLASS_ROBUST ? normalFromInlierPairs : normalFromPairs)(
            rig.cameras[c], direct, views.cameras[c].refracted);
        if (!estimate.undetermined.empty() || !(estimate.normal[2] > 0))
            continue;
        const double variance = trace(estimate.covariance);     // NaN if two pairs leave no residual to scale it by
        const double rank = std::isnan(variance) ? DBL_MAX : variance;
        if (rank < least)
        {
            least = rank;
            normal = rotationBetween(rig, c, owner)*estimate.normal;
        }
    }
    return least < std::numeric_limits<double>::infinity();
}

//! The camera that saw most through the window; -1 if none saw anything.
int bestObserver(const Rig& rig, int owner, const RigViews& views)
{
    int best = -1, most = 0;
    for (int c = owner; c < rig.count(); c++)
    {
        int seen = 0;
        for (const std::vector<Point2d>& pixels : views.cameras[c].refracted)
            seen += countSeen(pixels);
        if (rig.owner[c] != owner || seen <= most)
            continue;
        most = seen;
        best = c;
    }
    return best;
}

//! The window of one owner.
GlassWindow startWindow(const Rig& rig, int owner, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        OtherMinimum& other)
{
    GlassWindow window = rig.cameras[owner].window();
    if (normalOfPairs(rig, owner, views, poses, flags, window.normal) || (flags & GLASS_FREE_INTRINSICS))
        return window;
    const int best = bestObserver(rig, owner, views);
    if (best < 0)
        return window;
    const GlassWindow seenByBest = transferred(window, rig.extrinsics[owner], rig.extrinsics[best]);
    if (!(seenByBest.normal[2] > 0))
        return window;
    const double givenDistance = window.distance;
    window = transferred(searchWindow(withWindow(rig.cameras[best], seenByBest), views.cameras[best].refracted,
                                      views.object, flags, other), rig.extrinsics[best], rig.extrinsics[owner]);
    if (!(flags & GLASS_FREE_DISTANCE))
        window.distance = givenDistance;
    GlassWindow second = window;
    second.normal = other.normal;
    second.distance = other.distance;
    second = transferred(second, rig.extrinsics[best], rig.extrinsics[owner]);
    other.normal = second.normal;
    other.distance = second.distance;
    return window;
}

//! The window of an owner as another camera sees it; the distance is negative beyond it.
WindowTransfer seenFrom(const Rig& rig, int c)
{
    const GlassWindow window = rig.cameras[rig.owner[c]].window();
    return WindowTransfer(window.normal, window.distance, TransformWithDerivatives(rig.extrinsics[rig.owner[c]]),
                          TransformWithDerivatives(rig.extrinsics[c]));
}

double distanceFrom(const Rig& rig, int c) { return seenFrom(rig, c).distance; }

} // namespace

double excessOf(double cost, double best, int freedom)
{
    return std::sqrt((cost - best)*freedom/std::max(best, DBL_MIN));
}

double angleBetween(const Vec3d& a, const Vec3d& b) { return std::atan2(norm(a.cross(b)), a.dot(b)); }

GlassWindow transferred(GlassWindow window, const Pose& from, const Pose& to)
{
    const TransformWithDerivatives a(from), b(to);
    const WindowTransfer transfer(window.normal, window.distance, a, b);
    if (!window.wedge.empty() && !(from.rvec == to.rvec && from.tvec == to.tvec))       // else given values stay to the last bit
    {
        const Matx33d R = b.rotation.R*a.rotation.R.t();
        const std::vector<double> given = window.thickness;
        window = windowInFrame(window, R, b.T - R*a.T);
        for (size_t i = 0; i < given.size(); i++)       // the fit refuses faces that meet before the camera
            window.thickness[i] = std::max(window.thickness[i], 1e-3*given[i]);
    }
    window.normal = transfer.normal;
    window.distance = std::max(transfer.distance, 0.);      // the fit refuses a window that is behind the camera
    return window;
}

FitOutcome transferToOthers(Rig& rig)
{
    for (int c = 0; c < rig.count(); c++)
    {
        if (rig.owns(c))
            continue;
        const GlassWindow window = transferred(rig.cameras[rig.owner[c]].window(), rig.extrinsics[rig.owner[c]], rig.extrinsics[c]);
        if (!(window.normal[2] > 0))
        {
            FitOutcome outcome(FitOutcome::LOOKS_AWAY);
            outcome.camera = c;
            outcome.point = Point3d(window.normal);
            return outcome;
        }
        rig.cameras[c].setWindow(window);
    }
    return FitOutcome();
}

void giveToNearest(Rig& rig)
{
    const std::vector<int> given = rig.owner;
    for (int owner = 0; owner < rig.count(); owner++)
    {
        if (given[owner] != owner)
            continue;
        int nearest = owner;
        for (int c = owner + 1; c < rig.count(); c++)
            if (given[c] == owner && seenFrom(rig, c).normal[2] > 0 && distanceFrom(rig, c) < distanceFrom(rig, nearest))
                nearest = c;
        if (nearest == owner)
            continue;
        const double least = distanceFrom(rig, nearest);
        GlassWindow window = rig.cameras[owner].window();
        if (least < 0)
            window.distance += window.distance - least;     // the nearest is where the first was thought to be
        rig.cameras[nearest].setWindow(transferred(window, rig.extrinsics[owner], rig.extrinsics[nearest]));
        for (int c = 0; c < rig.count(); c++)
            if (given[c] == owner)
                rig.owner[c] = nearest;
    }
}

FitOutcome startWindows(Rig& rig, const RigViews& views, const std::vector<Pose>& poses, int flags,
                        std::vector<OtherMinimum>& others)
{
    others.assign(rig.count(), OtherMinimum());
    for (int c = 0; c < rig.count(); c++)
        if (rig.owns(c))
            rig.cameras[c].setWindow(startWindow(rig, c, views, poses, flags, others[c]));
    if (flags & GLASS_FREE_DISTANCE)
        giveToNearest(rig);
    return transferToOthers(rig);
}

bool setDistances(Rig& rig, double distance)
{
    for (int c = 0; c < rig.count(); c++)
        if (rig.owns(c))
        {
            GlassWindow window = rig.cameras[c].window();
            window.distance = distance;
            rig.cameras[c].setWindow(window);
        }
    return transferToOthers(rig).converged();
}

bool setNormal(Rig& rig, int owner, const Vec3d& normal)
{
    rig.cameras[owner].setWindow(turned(rig.cameras[owner].window(), normal));
    return transferToOthers(rig).converged();
}

static bool showsWhatWasSeen(const Rig& rig, int c, const RigViews& views, const std::vector<Pose>& poses)
{
    const TransformWithDerivatives toCamera(rig.extrinsics[c]);
    for (int view = 0; view < views.count(); view++)
    {
        const std::vector<Point2d>& pixels = views.cameras[c].refracted[view];
        const TransformWithDerivatives toCamera1(poses[view]);
        for (size_t i = 0; i < pixels.size() && poses[view].found; i++)
        {
            const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(views.object[view][i])));
            double u, v;
            uchar status = REFRACT_OK;
            rig.cameras[c].project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
            if (status != REFRACT_OK && !std::isnan(pixels[i].x))
                return false;
        }
    }
    return true;
}

FitOutcome keepGivenNormals(const Rig& given, const RigViews& views, const std::vector<Pose>& poses, Rig& rig)
{
    for (int c = 0; c < rig.count(); c++)
        if (!showsWhatWasSeen(rig, c, views, poses))
            rig.cameras[rig.owner[c]].setWindow(turned(rig.cameras[rig.owner[c]].window(),
                                                       given.cameras[rig.owner[c]].window().normal));
    return transferToOthers(rig);
}

}} // namespace
