// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Are the pairs what the caller says they are?

The fit of swapped or unpaired images ends somewhere, with a normal that means nothing. What gives it away, whatever the noise
and the window:

    contradiction = RMS residual of the pairs / RMS of what they have to explain, refracted minus direct.
        A window of which a constant is wrong by a tenth leaves less than a tenth of it; one of the wrong direction, or two
        positions of a board, leave most of it.
    excess = RMS residual of the pairs / RMS residual of the same images, each with a pose of its own.
        Noise, a lens that is not quite right or wrong corners show in both.

Both are needed: where the window hardly displaces anything, noise alone is a large contradiction. Two more fits then say what it
is: one with the images exchanged, and one with the window's constants free. If the latter explains the pairs they are pairs, and
a grossly wrong thickness or index is the caller's to see in the residuals. */

#include "calibrate/pair_check.hpp"
#include "calibrate/calibration_error.hpp"
#include "calibrate/failure.hpp"
#include "calibrate/near_task.hpp"
#include "arrays/views.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

//! Above it the pairs are worth a second look, which takes time.
const double SUSPICIOUS_CONTRADICTION = 0.1;
const double LARGEST_CONTRADICTION = 0.25, LARGEST_EXCESS = 5;
//! The swapped arrangement must fit better by this factor.
const double CLEARLY_BETTER = 0.5;

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

//! Of a fit that explains most pairs; infinite if there is none.
double plausibleRms(Rig rig, RigTask task)
{
    const double infinity = std::numeric_limits<double>::infinity();
    task.wantsCovariance = false;
    RigFit fit;
    if (!fitRig(rig, task, fit).converged())
        return infinity;
    const std::vector<Pair> pairs = pairsOf(task.views), used = usedOf(pairs, fit);
    const bool isPlausible = 2*used.size() >= pairs.size() && residualOf(used, task.views, fit) <
                             LARGEST_CONTRADICTION*displacementOf(used, task.views, fit);
    return isPlausible ? fit.rms : infinity;
}

//! With direct and refracted images exchanged.
double swappedRms(const Rig& start, RigTask task)
{
    for (CameraViews& camera : task.views.cameras)
    {
        std::swap(camera.direct, camera.refracted);
        std::swap(camera.directCovariances, camera.refractedCovariances);
    }
    return plausibleRms(start, task);
}

//! With the constants free that the window's effect depends on most: one layer in place of several, which would be tied.
double otherWindowRms(Rig start, RigTask task)
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
    return plausibleRms(start, task);
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
        const double rms = swappedRms(start, task);
        if (std::isfinite(rms))
            throwSwapped(rms, format("%d of %d pairs agree with no window", (int)(pairs.size() - used.size()),
                                     (int)pairs.size()).c_str());
        return;
    }
    const double residual = residualOf(used, task.views, fit), displacement = displacementOf(used, task.views, fit);
    if (!(residual > SUSPICIOUS_CONTRADICTION*displacement))
        return;
    const double apart = residualApart(used, task.views, fit, start, fitted);
    if (!(residual > LARGEST_EXCESS*apart))
        return;
    const double swapped = swappedRms(start, task);
    if (swapped < CLEARLY_BETTER*fit.rms)
        throwSwapped(swapped, format("to %.3g px", fit.rms).c_str());
    if (residual > LARGEST_CONTRADICTION*displacement && !std::isfinite(otherWindowRms(start, task)))
        throwContradicting(residual, apart);
}

//! Pairs that are none may leave a fit without answer: says so if they do.
void explainRefusal(const Rig& start, RigTask task)
{
    if (pairsOf(task.views).empty())
        return;
    const double swapped = swappedRms(start, task);
    if (std::isfinite(swapped))
        throwSwapped(swapped, "not at all");
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
