// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Are the pairs what the caller says they are?

Swapped images are fitted well by a window that leans the other way, but for what the window does along its normal, which makes the
targets larger. So where what the fit leaves of the displacements, refracted minus direct, has a scale beyond its noise, the swapped
images are fitted, too. They are named if they are clearly the more likely ones.

The fit of unpaired images ends somewhere, with a normal that means nothing. What gives it away, whatever the noise and the window:

    contradiction = RMS residual of the pairs / RMS of what they have to explain, refracted minus direct.
        A window of which a constant is wrong by a tenth leaves less than a tenth of it; one of the wrong direction, or two
        positions of a board, leave most of it.
    excess = RMS residual of the pairs / RMS residual of the same images, each with a pose of its own.
        Noise, a lens that is not quite right or wrong corners show in both.

Both are needed: where the window hardly displaces anything, noise alone is a large contradiction. One more fit then says what it
is, with the window's constants free. If it explains the pairs they are pairs, and a grossly wrong thickness or index is the
caller's to see in the residuals. */

#include "calibrate/pair_check.hpp"
#include "calibrate/calibration_error.hpp"
#include "calibrate/failure.hpp"
#include "calibrate/near_task.hpp"
#include "arrays/views.hpp"
#include "window/place.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

const double LARGEST_CONTRADICTION = 0.25, LARGEST_EXCESS = 5;
//! Of another fit that explains all: noise.
const double USUAL_EXCESS = 1.5;

//! A sum of squares of distances in pixels.
struct Squares
{
    double sum = 0, count = 0;
    void add(double squares, double points) { sum += squares; count += points; }
    double rms() const { return count > 0 ? std::sqrt(sum/count) : 0; }
};

struct Pair { int view, camera; };

//! Views of a target that some camera saw both ways.
std::vector<Pair> pairsOf(const RigViews& views)
{
    std::vector<Pair> pairs;
    for (int c = 0; c < (int)views.cameras.size(); c++)
        for (int view = 0; view < views.count(); view++)
            if (countWhole(views.cameras[c].direct[view]) > 0 && countWhole(views.cameras[c].refracted[view]) > 0)
                pairs.push_back({ view, c });
    return pairs;
}

//! The pairs of which both images were used.
std::vector<Pair> usedOf(const std::vector<Pair>& pairs, const RigFit& fit)
{
    std::vector<Pair> used;
    for (const Pair& p : pairs)
        if (fit.imageStatus.at<uchar>(p.view, 2*p.camera) == GLASS_IMAGE_USED &&
            fit.imageStatus.at<uchar>(p.view, 2*p.camera + 1) == GLASS_IMAGE_USED)
            used.push_back(p);
    return used;
}

//! The points of one image that were used, the others NaN.
std::vector<Point2d> inliersOf(const std::vector<Point2d>& pixels, const Mat& mask)
{
    std::vector<Point2d> inliers(pixels);
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    for (size_t i = 0; i < pixels.size(); i++)
        if (!mask.at<uchar>((int)i))
            inliers[i] = Point2d(NaN, NaN);
    return inliers;
}

//! Both images of one pair, as far as they were used.
struct PairImages
{
    PairImages(const Pair& p, const RigViews& views, const RigFit& fit)
    {
        const int column = fit.imageStatus.cols*p.view + 2*p.camera;
        image[0] = inliersOf(views.cameras[p.camera].direct[p.view], fit.inliers[column]);
        image[1] = inliersOf(views.cameras[p.camera].refracted[p.view], fit.inliers[column + 1]);
    }
    std::vector<Point2d> image[2];
};

double residualOf(const std::vector<Pair>& pairs, const RigViews& views, const RigFit& fit)
{
    Squares residual;
    for (const Pair& p : pairs)
    {
        const PairImages images(p, views, fit);
        for (int k = 0; k < 2; k++)
        {
            const double rms = fit.perViewErrors.at<double>(p.view, 2*p.camera + k), count = countWhole(images.image[k]);
            if (count > 0)
                residual.add(rms*rms*count, count);
        }
    }
    return residual.rms();
}

double displacementOf(const std::vector<Pair>& pairs, const RigViews& views, const RigFit& fit)
{
    Squares displacement;
    for (const Pair& p : pairs)
    {
        const PairImages images(p, views, fit);
        for (size_t i = 0; i < images.image[0].size(); i++)
            if (isWhole(images.image[0][i]) && isWhole(images.image[1][i]))
                displacement.add(norm(images.image[0][i] - images.image[1][i])*
                                 norm(images.image[0][i] - images.image[1][i]), 1);
    }
    return displacement.rms();
}

//! Of all images, each with a pose of its own and the best of the cameras, with or without window.
double residualApart(const std::vector<Pair>& pairs, const RigViews& views, const RigFit& fit, const Rig& start,
                     const Rig& fitted)
{
    Squares residual;
    for (const Pair& p : pairs)
    {
        const PairImages images(p, views, fit);
        const Camera cameras[] = { withWindow(fitted.cameras[p.camera]), fitted.cameras[p.camera], start.cameras[p.camera] };
        for (const std::vector<Point2d>& image : images.image)
        {
            double least = std::numeric_limits<double>::infinity();
            for (const Camera& camera : cameras)
            {
                double rms;
                if (solvePose(camera, views.object[p.view], image, Pose(), rms).found)
                    least = std::min(least, rms);
            }
            const double count = countWhole(image), freedom = 2*count - 6;
            if (std::isfinite(least) && freedom > 0)
                residual.add(least*least*count*2*count/freedom, count);
        }
    }
    return residual.rms();
}

//! Where the camera sees a point of its frame; NaN: nowhere.
Point2d pixelOf(const Camera& camera, const Vec3d& X)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    Point2d pixel;
    uchar status = REFRACT_OK;
    camera.project(1, &X[0], &X[1], &X[2], nullptr, &pixel.x, &pixel.y, &status);
    return status == REFRACT_OK ? pixel : Point2d(NaN, NaN);
}

//! How pixels move from or to their middle: sums of a regression.
struct ScaleFit
{
    double along = 0, size = 0, squares = 0, freedom = -1;
    void add(const std::vector<Point2d>& place, const std::vector<Point2d>& motion)
    {
        const Scalar middle = mean(place), common = mean(motion);
        for (size_t i = 0; i < place.size(); i++)
        {
            const Vec2d x(place[i].x - middle[0], place[i].y - middle[1]), e(motion[i].x - common[0], motion[i].y - common[1]);
            along += e.dot(x);
            size += x.dot(x);
            squares += e.dot(e);
        }
        freedom += 2*(double)place.size() - 2;
    }
    //! False: no more than the rest of the motion makes it.
    bool isClear() const
    {
        const double CLEAR = 3;         // standard deviations
        return !(along*along*freedom <= CLEAR*CLEAR*(squares*size - along*along));
    }
};

/** What the fit leaves of the displacements makes the targets larger or smaller. Errors of lens and target, which both images
share, play no part. */
bool leavesScale(const std::vector<Pair>& pairs, const RigViews& views, const Rig& rig, const RigFit& fit)
{
    ScaleFit scale;
    for (const Pair& p : pairs)
    {
        const PairImages images(p, views, fit);
        const Camera &camera = rig.cameras[p.camera], bare = withWindow(camera);
        if (hasCenter(camera.layers().at().shape))
            return true;        // swapped, they mirror its center, which leaves other than a scale
        const RigidTransform inCamera = transformOf(rig.extrinsics[p.camera])*transformOf(fit.poses[p.view]);
        std::vector<Point2d> place, left;
        for (size_t i = 0; i < images.image[0].size(); i++)
        {
            const Point2d from = images.image[0][i], to = images.image[1][i];
            const Vec3d X = inCamera.R*Vec3d(views.object[p.view][i]) + inCamera.t;
            const Point2d e = to - from - (pixelOf(camera, X) - pixelOf(bare, X));
            if (!isWhole(e))
                continue;
            place.push_back(from);
            left.push_back(e);
        }
        if (!place.empty())
            scale.add(place, left);
    }
    return scale.isClear();
}

//! Another fit, of the same images or swapped ones.
struct OtherFit
{
    bool isPlausible = false;       //!< it explains most pairs
    RigFit fit;
};

//! @param apart RMS residual of the same images, each with a pose of its own, or 0
OtherFit fitOther(Rig rig, RigTask task, double apart)
{
    OtherFit other;
    task.wantsCovariance = false;
    try
    {
        if (!fitRig(rig, task, other.fit).converged())
            return other;
    }
    catch (const Exception&)        // images that are no pairs lead to windows that cannot be, as a tube behind the camera
    {
        return other;
    }
    const std::vector<Pair> pairs = pairsOf(task.views), used = usedOf(pairs, other.fit);
    const double most = std::max(LARGEST_CONTRADICTION*displacementOf(used, task.views, other.fit), USUAL_EXCESS*apart);
    other.isPlausible = 2*used.size() >= pairs.size() && residualOf(used, task.views, other.fit) < most;
    return other;
}

//! With direct and refracted images exchanged.
OtherFit fitSwapped(const Rig& start, RigTask task, double apart)
{
    for (CameraViews& camera : task.views.cameras)
    {
        std::swap(camera.direct, camera.refracted);
        std::swap(camera.directCovariances, camera.refractedCovariances);
    }
    return fitOther(start, task, apart);
}

//! Of both images of a pair, in variances of a coordinate: squared errors, of points that were not used the largest one.
double costOf(const Pair& p, const RigViews& views, const RigFit& fit, double variance)
{
    const double LARGEST = 16;
    const CameraViews& seen = views.cameras[p.camera];
    double cost = 0, unused = countSeen(seen.direct[p.view]) + countSeen(seen.refracted[p.view]);
    for (int column = 2*p.camera; column < 2*p.camera + 2; column++)
    {
        const double rms = fit.perViewErrors.at<double>(p.view, column);
        const int used = countNonZero(fit.inliers[fit.imageStatus.cols*p.view + column]);
        unused -= used;
        cost += used > 0 ? used*rms*rms/variance : 0;
    }
    return cost + LARGEST*unused;
}

//! More likely than chance makes it, and of more than half of the pairs.
bool isClearlyBetter(const RigFit& other, const std::vector<Pair>& pairs, const RigViews& views, const RigFit& fit)
{
    const double CLEAR = 12;        // of the logarithm of the likelihood: wrong once in 10^5 times
    const double variance = 0.5*std::pow(std::min(other.rms, fit.rms), 2);
    double gain = 0;
    size_t better = 0;
    for (const Pair& p : pairs)
    {
        const double ofPair = 0.5*(costOf(p, views, fit, variance) - costOf(p, views, other, variance));
        gain += ofPair;
        better += ofPair > 0;
    }
    return gain > CLEAR && 2*better > pairs.size();
}

//! With the constants free that the window's effect depends on most: one layer in place of several, which would be tied.
bool hasOtherWindow(Rig start, RigTask task, double apart)
{
    for (Camera& camera : start.cameras)
    {
        GlassWindow window = camera.window();
        const double total = std::accumulate(window.thickness.begin(), window.thickness.end(), 0.);
        if (window.thickness.size() > 1)
        {
            const double optical = std::inner_product(window.thickness.begin(), window.thickness.end(), window.index.begin(), 0.);
            window.thickness.assign(1, total);
            window.index.assign(1, optical/total);
            window.materials.clear();
            if (!window.wedge.empty())
                window.wedge.assign(1, std::accumulate(window.wedge.begin(), window.wedge.end(), Vec2d()));
            camera.setWindow(window);
        }
        task.flags |= window.innerIndex == window.outerIndex ? GLASS_FREE_THICKNESS
                                                             : GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX;
    }
    return fitOther(start, task, apart).isPlausible;
}

void throwSwapped(double rms, const char* given)
{
    const String reason = format("exchanged they fit to %.3g px RMS, as given %s", rms, given);
    raise(CalibrationError(CalibrationError::PAIRS_SWAPPED, "imagePointsDirect and imagePointsRefracted are swapped: " + reason +
                           "; direct is what was seen without the window", reason));
}

void throwContradicting(double residual, double apart)
{
    const String reason = format("the pairs contradict the window: %.3g px RMS, but %.3g px if each image has a pose of its own, "
                                 "whatever the window's thickness or index", residual, apart);
    raise(CalibrationError(CalibrationError::PAIRS_CONTRADICT, reason + ". imagePointsDirect[i] and imagePointsRefracted[i] must show "
                           "the same target that was not moved in between, its points in the same order", reason));
}

void checkPairs(const Rig& start, const Rig& fitted, const RigTask& task, const RigFit& fit)
{
    const std::vector<Pair> pairs = pairsOf(task.views), used = usedOf(pairs, fit);
    if (pairs.empty())
        return;
    // A robust fit leaves out what contradicts; with swapped images that is one image of nearly every pair.
    if (2*used.size() < pairs.size())
    {
        const OtherFit swapped = fitSwapped(start, task, 0);
        if (swapped.isPlausible)
            throwSwapped(swapped.fit.rms, format("%d of %d pairs agree with no window", (int)(pairs.size() - used.size()),
                                                 (int)pairs.size()).c_str());
        return;
    }
    const double residual = residualOf(used, task.views, fit), displacement = displacementOf(used, task.views, fit);
    const double ROUNDING = 1e-6;       // part of the displacement
    if (!(residual > ROUNDING*displacement))
        return;
    const bool isLarge = residual > LARGEST_CONTRADICTION*displacement, leaves = leavesScale(used, task.views, fitted, fit);
    if (!isLarge && !leaves)
        return;
    const double apart = residualApart(used, task.views, fit, start, fitted);
    const bool contradicts = isLarge && residual > LARGEST_EXCESS*apart;
    if (!contradicts && !leaves)
        return;
    const OtherFit swapped = fitSwapped(start, task, apart);
    if (swapped.isPlausible && isClearlyBetter(swapped.fit, pairs, task.views, fit))
        throwSwapped(swapped.fit.rms, format("to %.3g px", fit.rms).c_str());
    if (contradicts && !hasOtherWindow(start, task, apart))
        throwContradicting(residual, apart);
}

//! Pairs that are none may leave a fit without answer: says so if they do.
void explainRefusal(const Rig& start, RigTask task)
{
    if (pairsOf(task.views).empty())
        return;
    const OtherFit swapped = fitSwapped(start, task, 0);
    if (swapped.isPlausible)
        throwSwapped(swapped.fit.rms, "not at all");
    task.wantsCovariance = false;
    task.flags &= ~(GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX);
    Rig fitted = start;
    RigFit fit;
    if (fitRig(fitted, task, fit).converged())
        checkPairs(start, fitted, task, fit);
}

} // namespace

RigFit fitCheckingPairs(Rig& rig, const RigTask& given)
{
    const NearTask moved(given);
    const RigTask& task = moved.task();
    const Rig start = rig;
    RigFit fit;
    FitOutcome outcome = fitRig(rig, task, fit);
    if (!outcome.converged())
        explainRefusal(start, task);
    moved.moveBack(outcome);
    throwUnlessConverged(outcome, FitKind::CALIBRATION);
    checkPairs(start, rig, task, fit);
    moved.moveBack(fit);
    return fit;
}

}} // namespace
