// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/findings.hpp"
#include "assess/round_window.hpp"
#include "calibrate/window_face.hpp"
#include "measure/f_distribution.hpp"
#include "calibrate/estimated_parameters.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

// Where a finding begins. They only choose words; no number depends on them.
const double WEAK_NORMAL_DEG = 0.1;
const double WEAK_CENTRE = 0.01;            // of a dome's radius
const double WEAK_RELATIVE = 0.1;           // of thickness or distance
const double WEAK_INDEX = 0.01;
const double TELLING_RATIO = 1.5;           // of the normal's deviation to that of the noise alone
const double TIED = 0.95;                   // correlation
const double MISFIT_RATIO = 1.5;            // RMS through the window / RMS direct
const double OUTLYING_VIEW = 2.5;           // times the median RMS of the views
const double INFLUENTIAL = 3.;              // standard deviations that one view may turn the normal
const double LOW_COVERAGE = 0.5;
const double NARROW_RANGE = 1.2;            // farthest / nearest
const int ENOUGH_WITHOUT_PAIRS = 5;         // images through the window
const size_t FLAT_IMAGES_TO_JUDGE = 2;      // a pose fits itself to one
const double HELD_OUT_CHANCE = 1e-3;        // that true +- look so wrong on held-out boards

//! "camera 2: " where there are several.
std::string of(const RigCalibration& c, int camera)
{
    return c.data.cameraCount == 1 ? "" : format("camera %d: ", camera + 1);
}

bool equalMedia(const GlassWindow& window) { return window.innerIndex == window.outerIndex; }

//! What a weak point puts in doubt; the first is told first.
enum Doubt { THE_STATED_ERROR, THE_FIT, THE_DATA, A_PARAMETER, AN_IMAGE };

//! Findings, and their weak points by what these put in doubt.
struct Collected : Findings
{
    std::multimap<Doubt, std::string> doubts;

    void add(Doubt doubt, const std::string& sentence) { doubts.emplace(doubt, sentence); }
};

/** Why a limit cannot be judged; empty: it can. The pose of a flat target fits itself to its image: of one image nothing is left that
could contradict it. A target with depth contradicts itself where the window is wrong.
@param camera -1: all together */
std::string whyNotJudged(const RigCalibration& c, int camera)
{
    size_t images = 0;
    bool solid = false;
    for (int i : c.fit.views)
    {
        const View& view = c.data.views[i];
        images += camera < 0 ? view.hasGlass() : view.hasGlass(camera);
        solid = solid || isSolid(view.objectPoints);
    }
    return solid || images >= FLAT_IMAGES_TO_JUDGE ? "" : "cannot be judged on one image through the window";
}

void checkLimits(const RigCalibration& c, const Assessment& a, Findings& f)
{
    const Limits& limits = c.limits;
    const std::string notJudged = whyNotJudged(c, -1);
    if (limits.rms > 0)
        f.limits.push_back({format("--max-rms=%g", limits.rms), "RMS over all corners", limits.rms, c.fit.rms, "px", notJudged});
    for (int k = 0; k < c.data.cameraCount && limits.normalStdDeg > 0; k++)
        f.limits.push_back({format("--max-normal-std=%g", limits.normalStdDeg), of(c, k) + "standard deviation of the normal",
                            limits.normalStdDeg, windowStd(c.fit, k).normalDeg[0], "deg",
                            c.fit.rig.ownsWindow(k) ? whyNotJudged(c, k) : notJudged});
    for (size_t i = 0; i < limits.errors.size(); i++)
    {
        const ErrorLimit& limit = limits.errors[i];
        f.limits.push_back({format("--max-error-at=%g:%g", limit.range, limit.error),
                            format("expected error of the worst point at z = %g %s", limit.range, c.unit.c_str()), limit.error,
                            a.limits[i].worst(), c.unit, notJudged});
    }
}

//! The covariance of all parameters, were some of them (and the targets' errors) known.
Mat conditional(const Fit& fit, const std::vector<int>& known)
{
    if (known.empty())
        return fit.covariance;
    std::vector<int> all(fit.covariance.rows);
    std::iota(all.begin(), all.end(), 0);
    const Mat of = partOf(fit.withTargets, all, known), among = partOf(fit.withTargets, known, known);
    return fit.covariance - of*among.inv(DECOMP_SVD)*of.t();
}

/** The larger principal deviation of the normal, were it known how wedge-shaped the pane is and how the boards moved: a wedge or a motion
of all boards looks like a tilt, and more images help little against them. */
double normalStdOfNoise(const RigCalibration& c, int camera)
{
    const ParameterColumns at = columnsOf(c.fit.rig, camera);
    std::vector<int> known;
    for (int i = at.wedge; i < at.curvature; i++)
        known.push_back(i);
    for (int i = c.fit.covariance.rows + 1; i < c.fit.withTargets.rows; i++)
        known.push_back(i);
    return normalStdDeg(conditional(c.fit, known), c.fit.rig, camera)[0];
}

//! What its faces are taken to be.
std::string shapeWords(const RigCalibration& c)
{
    switch (c.fit.rig.cameras[0]->window().shape)
    {
    case WINDOW_DOME: return "spherical";
    case WINDOW_TUBE: return "cylindrical";
    case WINDOW_BENT: return "flat or bent like a sphere";
    default: return "flat";
    }
}

void checkTilt(const RigCalibration& c, int camera, Collected& f)
{
    const double std = windowStd(c.fit, camera).normalDeg[0], ofNoise = normalStdOfNoise(c, camera);
    const bool pairs = c.data.countPairs(camera) > 0;
    if (ofNoise > WEAK_NORMAL_DEG)
    {
        f.add(A_PARAMETER, of(c, camera) + format("the window's tilt is uncertain by %.2g deg: ", std)
                         + (pairs ? "take more pairs, with the board all over the image"
                            : !c.data.hasDirect() ? "take more images, near and far, tilted to all sides, with the board all over the image"
                            : "take pairs (the board not moved between an image without and one with the window)"));
        if (!pairs)
            f.cannotTell.push_back(of(c, camera) + "much about the tilt: no image without the window shows the board in the same "
                                   "place, so tilt and board poses are correlated. Pairs are worth 30 to 90 times more than "
                                   "such glass-only views");
    }
    else if (std > TELLING_RATIO*ofNoise)
        f.cannotTell.push_back(of(c, camera) + format("the window's tilt better than to %.2g deg: a wedge between its faces%s looks like "
                               "a tilt (were it known, %.2g deg). Points hardly suffer from that", std,
                               pairs && c.options.std.placement > 0. ? ", or a motion of all boards between direct and glass," : "",
                               ofNoise));
}

//! Of a dome or tube.
void checkCentre(const RigCalibration& c, int camera, Collected& f)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const RoundWindow round = *roundWindowOf(c, camera);
    const std::string middle = round.shape == "dome" ? "centre" : "axis";
    const double std = placeStd(c.fit.covariance, c.fit.rig, camera);
    if (round.isNeedless())
        f.cannotTell.push_back(of(c, camera) + round.needless(c.unit));
    else if (std > WEAK_CENTRE*window.radius)
        f.add(A_PARAMETER, of(c, camera) + format("the %s's %s is uncertain by %.2g %s: ", round.shape.c_str(), middle.c_str(), std,
                                                  c.unit.c_str())
              + (c.data.countPairs(camera) ? "take more pairs, with the board all over the image"
                 : "take pairs (the board not moved between an image without and one with the " + round.shape + ")"));
    if (c.options.flags & GLASS_FREE_RADIUS && windowStd(c.fit, camera).radius > WEAK_RELATIVE*window.radius)
        f.add(A_PARAMETER, of(c, camera) + format("the radius is weakly determined: %.4g +- %.2g %s; give that of the drawing by --radius",
                                                  window.radius, windowStd(c.fit, camera).radius, c.unit.c_str()));
}

//! How far the nearest point that the camera saw of a target is behind the window.
double gapToTargets(const RigCalibration& c, int camera)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    double gap = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < c.fit.views.size(); k++)
    {
        const View& view = c.data.views[c.fit.views[k]];
        Vec3d rvec = c.fit.rvecs[k], tvec = c.fit.tvecs[k];
        poseInImage(c.fit.rig, camera, true, rvec, tvec);
        const Matx33d R = rotationMatrix(rvec);
        const std::vector<Point3d> points = pointsOfTarget(c.fit.rig, view.objectPoints);
        for (size_t i = 0; i < view.glass[camera].size(); i++)
            if (seen(view.glass[camera][i]))
                gap = std::min(gap, window.normal.dot(R*Vec3d(points[i]) + tvec) - window.distance - glassOf(window));
    }
    return gap;
}

void checkDistance(const RigCalibration& c, int camera, Collected& f)
{
    const double AT_TARGET = 0.02;          // part of the distance: a fit that comes to a target stays a little before it
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const double std = windowStd(c.fit, camera).distance;
    const std::string value = format("%.4g +- %.2g %s", window.distance, std, c.unit.c_str());
    if (!(std > 0.) || c.options.std.isDistanceOpen)
        return;
    const bool isFree = c.options.flags & GLASS_FREE_DISTANCE;
    const double gap = gapToTargets(c, camera);
    if (isFree && window.distance == 0.)
        f.add(A_PARAMETER, of(c, camera) + "the distance to the window ended at its bound, " + value + ": the images would have the "
              "window behind the camera. Give it by --distance, and see whether --index, --outer-index and the lens are right");
    else if (isFree && gap < AT_TARGET*window.distance && gap < 0.5*std)
        f.add(A_PARAMETER, of(c, camera) + "the distance to the window ended where a target touches it, " + value
              + ": the images hardly tell it. Give it by --distance, or take strongly tilted boards at the image's border");
    else if (std > WEAK_RELATIVE*window.distance)
        f.add(A_PARAMETER, of(c, camera) + "the distance to the window is weakly determined: " + value + ". Near, strongly tilted boards "
              "at the image's border help");
}

void checkWindow(const RigCalibration& c, int camera, Collected& f)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const WindowStd std = windowStd(c.fit, camera);
    if (isRound(window))
        checkCentre(c, camera, f);
    else
        checkTilt(c, camera, f);
    if (!isRound(window))
        checkDistance(c, camera, f);
    for (size_t i = 0; i < window.thickness.size(); i++)
    {
        if (c.options.flags & GLASS_FREE_THICKNESS && std.thickness[i] > WEAK_RELATIVE*window.thickness[i])
            f.add(A_PARAMETER, of(c, camera) + format("the thickness is weakly determined: %.4g +- %.2g %s; measure it with "
                                                    "a caliper and give it by --thickness", window.thickness[i],
                                                    std.thickness[i], c.unit.c_str()));
        if (c.options.flags & GLASS_FREE_INDEX && std.index[i] > WEAK_INDEX)
            f.add(A_PARAMETER, of(c, camera) + format("the index is weakly determined: %.4g +- %.2g; give the material's value "
                                                    "by --index", window.index[i], std.index[i]));
    }
    const std::optional<SecondSolution> other = secondSolution(c, camera);
    if (other && !other->isExcluded())
        f.add(THE_DATA, of(c, camera) + other->sentence());
    if (equalMedia(window) && !isRound(window))
    {
        const std::string effect = std.distance > 0. ? format("an effect only as far as the faces are not parallel (%.4g +- %.2g %s)",
                                                              window.distance, std.distance, c.unit.c_str())
                                                     : std::string("no effect on the image where faces are parallel");
        f.cannotTell.push_back(of(c, camera) + "the distance from camera to window: with the same medium on both sides it has " + effect
                               + ", and is not needed");
    }
}

//! Thickness and index of a single layer: what shows at small angles, and how well it is known.
std::string opticalPath(const RigCalibration& c, int camera)
{
    const GlassWindow w = c.fit.rig.cameras[camera]->window();
    const ParameterColumns at = columnsOf(c.fit.rig, camera);
    const double d = w.thickness[0], n = w.index[0], byThickness = 1. - w.outerIndex/n, byIndex = d*w.outerIndex/(n*n);
    const auto cov = [&](int i, int j) { return c.fit.covariance.at<double>(i, j); };
    const double variance = byThickness*byThickness*cov(at.thickness, at.thickness)
        + 2.*byThickness*byIndex*cov(at.thickness, at.index) + byIndex*byIndex*cov(at.index, at.index);
    return of(c, camera) + format("thickness and index apart: only thickness x (1 - %s/index) = ",
                                  w.outerIndex == 1. ? "1" : format("%.4g", w.outerIndex).c_str())
        + plusMinus(d*byThickness, std::sqrt(std::max(0., variance))) + " is determined (thickness alone +- "
        + format("%.2g, index alone +- %.2g); fixing one of them makes the other far better",
                 std::sqrt(cov(at.thickness, at.thickness)), std::sqrt(cov(at.index, at.index)));
}

bool isWedge(const RigCalibration& c, const EstimatedParameter& p)
{
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        const ParameterColumns at = columnsOf(c.fit.rig, k);
        if (p.column >= at.wedge && p.column < at.curvature)
            return true;
    }
    return false;
}

bool isOneOf(const EstimatedParameter& p, int first, int second) { return p.column == first || p.column == second; }

void checkCorrelations(const RigCalibration& c, Findings& f)
{
    const std::vector<EstimatedParameter> free = estimatedWindowParameters(c.fit);
    for (size_t i = 0; i < free.size(); i++)
        for (size_t j = i + 1; j < free.size(); j++)
        {
            const auto isTold = [&](const EstimatedParameter& p) { return p.isNormal || isWedge(c, p); };
            if (isTold(free[i]) && isTold(free[j]))
                continue;       // by the two principal deviations, with the tilt
            const double covariance = c.fit.covariance.at<double>(free[i].column, free[j].column);
            const double r = covariance/(free[i].std*free[j].std);
            if (std::abs(r) <= TIED)
                continue;
            bool told = false;
            for (int k = 0; k < c.data.cameraCount && !told; k++)
            {
                const ParameterColumns at = columnsOf(c.fit.rig, k);
                told = at.layers == 1 && isOneOf(free[i], at.thickness, at.index) && isOneOf(free[j], at.thickness, at.index);
                if (told)
                    f.cannotTell.push_back(opticalPath(c, k));
            }
            if (told)
                continue;
            // The combination of both that is known best.
            const double k = -covariance/(free[j].std*free[j].std);
            f.cannotTell.push_back(format("%s and %s apart (correlation %.4f): only %s %c %.4g x %s = ", free[i].name.c_str(),
                                          free[j].name.c_str(), r, free[i].name.c_str(), k < 0 ? '-' : '+', std::abs(k),
                                          free[j].name.c_str())
                                   + plusMinus(free[i].value + k*free[j].value, free[i].std*std::sqrt(std::max(0., 1. - r*r)))
                                   + format(" is determined (each alone +- %.2g, +- %.2g)", free[i].std, free[j].std));
        }
}

void checkFit(const RigCalibration& c, int camera, Collected& f)
{
    const Rms glass = rmsOf(c, camera, true), direct = rmsOf(c, camera, false);
    // What the direct images reach without the window; in the joint fit a wrong window drags them along.
    const LensSource& lens = c.lensSources[camera];
    const double alone = lens.kind == LensSource::FROM_DIRECT ? std::min(lens.rms, direct.px) : direct.px;
    if (c.data.countPairs(camera) && std::max(glass.px, direct.px) > MISFIT_RATIO*alone)
        f.add(THE_FIT, of(c, camera) + format("direct images and images through the window do not agree (%.3f and %.3f px "
                         "together, direct alone %.3f px): check thickness and index, whether the board moved within a pair, "
                         "and whether the window is %s", direct.px, glass.px, alone, shapeWords(c).c_str()));
    const double through = c.baselines.throughGlass[camera];
    if (glass.px > MISFIT_RATIO*through)
        f.add(THE_FIT, of(c, camera) + format("a pinhole camera calibrated through the window fits these images better "
                         "(%.3f px) than lens and window together (%.3f px): the lens or the given values may be wrong",
                         through, glass.px));
    else if (glass.px > 0.8*through)
        f.cannotTell.push_back(of(c, camera) + format("from the residuals alone that the window is needed: a pinhole camera "
                               "calibrated on these same images fits them about as well (%.3f px). It does so only near the "
                               "poses it was calibrated on", through));
    const int pairs = c.data.countPairs(camera);
    if (pairs < ENOUGH_PAIRS && glass.views < ENOUGH_WITHOUT_PAIRS)
    {
        const int count = pairs ? pairs : glass.views;
        f.add(THE_DATA, of(c, camera) + format("only %d %s%s%s: take at least %d pairs", count, pairs ? "pair" : "image",
                                               count == 1 ? "" : "s", pairs ? "" : " through the window and no pair", ENOUGH_PAIRS));
    }
    const double covered = coverage(c, camera);
    if (covered < LOW_COVERAGE)
        f.add(THE_DATA, of(c, camera) + format("the board covers only %.0f %% of the image through the window: show it in the "
                                                "corners too", 100.*covered));
    const Vec3d depth = workingDepth(c, camera);
    if (depth[2] < NARROW_RANGE*depth[0])
        f.add(THE_DATA, of(c, camera) + format("all boards are at nearly the same depth (%.4g to %.4g %s): vary it", depth[0],
                                                depth[2], c.unit.c_str()));
}

void checkViews(const RigCalibration& c, int camera, Collected& f)
{
    for (bool glass : {true, false})
    {
        std::vector<std::pair<double, int>> views;
        for (int i : c.fit.views)
        {
            const Rms rms = rmsOf(c, camera, glass, i);
            if (rms.points)
                views.push_back({rms.px, i});
        }
        if (views.size() < 3)
            continue;
        std::sort(views.begin(), views.end());
        const double median = views[views.size()/2].first;
        for (const auto& view : views)
            if (view.first > OUTLYING_VIEW*median)
                f.add(AN_IMAGE, of(c, camera) + format("view '%s' (%s) fits badly: %.3f px, the median view has %.3f px; look at "
                                 "the image, leave it out if corners are wrong", c.data.views[view.second].stem.c_str(),
                                 glass ? "through the window" : "direct", view.first, median));
    }
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const double sigma = placeStd(c.fit.covariance, c.fit.rig, camera);
    for (const Influence& influence : c.influences)
        if (influence.change[camera] > INFLUENTIAL*sigma)
            f.add(AN_IMAGE, of(c, camera) + format("view '%s' alone %s by %.3f %s, %.1f standard deviations",
                             c.data.views[influence.view].stem.c_str(), isRound(window) ? "moves the centre" : "turns the normal",
                             influence.change[camera], placeUnit(window, c.unit).c_str(), influence.change[camera]/sigma));
}

bool isLensFree(const RigCalibration& c, int camera)
{
    const ParameterColumns at = columnsOf(c.fit.rig, camera);
    return c.fit.stdDeviations.at<double>(at.lens) > 0.;
}

std::string whyNotChecked(const RigCalibration& c)
{
    const HeldOut& h = c.heldOut;
    if (h.covarianceTest.directions)
        return "";
    if (!c.crossValidated)
        return "with --no-cross-validation all boards took part";
    if (!h.folds)
        return "there are too few images through the window to hold any out";
    if (h.failed == h.views || !(h.covarianceTest.expectedSquares > 0))
        return "without the boards held out the others do not determine the calibration";
    return "on the held-out boards the calibration's stated error is below the noise of the pixels, so they cannot show "
           "whether it is true";
}

//! The errors on held-out boards against the stated ones.
void checkHeldOut(const RigCalibration& c, Collected& f)
{
    const HeldOutTest& m = c.heldOut.covarianceTest;
    f.notChecked = whyNotChecked(c);
    if (!f.notChecked.empty())
    {
        f.cannotTell.push_back("whether the stated +- is true: " + f.notChecked);
        return;
    }
    const double perDirection = m.chiSquare/m.directions;
    // The folds share most of their images: as if there were only one.
    const int pairsOfDirections = std::max(1, m.directions/c.heldOut.folds/2);
    if (upperTailF(pairsOfDirections, c.fit.dof, perDirection) < HELD_OUT_CHANCE)
        f.add(THE_STATED_ERROR, format("the errors on held-out boards are %.1f times as large as the calibration's +- says: the stated "
                                "uncertainties are too small. A given value, the lens model or the target may be wrong, or "
                                "the window not %s", std::sqrt(perDirection), shapeWords(c).c_str()));
}

//! What a tape measure can tell.
std::string scaleInWords(const RigCalibration& c)
{
    double width = 0.;
    for (int i : c.fit.views)
    {
        const std::vector<Point3d>& points = c.data.views[i].objectPoints;
        for (const Point3d& X : points)
            width = std::max(width, norm(X - points[0]));
    }
    const Vec3d depth = workingDepth(c, 0);
    std::string text = format("the target is %.3g %s across, %.3g to %.3g %s from camera 1", width, c.unit.c_str(), depth[0], depth[2],
                              c.unit.c_str());
    if (c.data.cameraCount > 1)
        text += format(", which is %.3g %s from camera 2", norm(c.fit.rig.extrinsics[1].T), c.unit.c_str());
    return text;
}

std::string listOf(const std::vector<double>& values)
{
    std::string text;
    for (double value : values)
        text += (text.empty() ? "" : ", ") + format("%.6g", value);
    return text;
}

std::string shapeAssumed(const GlassWindow& window)
{
    switch (window.shape)
    {
    case WINDOW_DOME: return ", a dome of spheres about one centre";
    case WINDOW_TUBE: return ", a tube of cylinders about one axis";
    case WINDOW_BENT: return ", a window bent like a sphere";
    default: return window.wedge.empty() ? ", a flat window with parallel surfaces" : ", a flat window";
    }
}

void checkAssumptions(const RigCalibration& c, Findings& f)
{
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.lensSources[k].kind == LensSource::FROM_FILE && !isLensFree(c, k))
            f.assumed.push_back(of(c, k) + "the lens of the file, taken as exact, as the file states no covariance");
    if (c.options.std.scale == 0.)
        f.assumed.push_back((c.square > 0 ? format("the square of %g", c.square) : std::string("the coordinates of the points in"))
                            + " " + c.unit + ": all lengths are in proportion to it, and no image shows it. A tape measure does: "
                            + scaleInWords(c));
    if (c.options.flags & GLASS_USE_POSES)
        f.assumed.push_back("the poses of the target, within their given standard deviations");
    const GlassWindow& window = c.options.window;
    if (!window.thickness.empty() && !(c.options.flags & GLASS_FREE_THICKNESS) && c.options.std.thickness == 0.)
        f.assumed.push_back("the thickness, " + listOf(window.thickness) + " " + c.unit
                            + (equalMedia(window) ? "" : " (an error in it is largely taken up by the distance, as the media on its "
                               "two sides differ)"));
    if (!window.index.empty() && !(c.options.flags & GLASS_FREE_INDEX) && !c.options.std.ofIndices())
        f.assumed.push_back("the index, " + listOf(window.index));
    std::vector<GivenIndex> indices = c.options.layers;
    indices.insert(indices.end(), {c.options.inner, c.options.outer});
    for (const GivenIndex& index : indices)
        if (index.isNamed() && std::find(f.assumed.begin(), f.assumed.end(), index.sentence()) == f.assumed.end())
            f.assumed.push_back(index.sentence());
    if (isRound(window) && !(c.options.flags & GLASS_FREE_RADIUS) && c.options.std.radius == 0.)
        f.assumed.push_back("the radius, " + listOf({window.radius}) + " " + c.unit);
    if (!equalMedia(window) && !isRound(window) && !(c.options.flags & GLASS_FREE_DISTANCE) && c.options.std.distance == 0.)
        f.assumed.push_back("the distance, " + listOf({window.distance}) + " " + c.unit);
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.data.countPairs(k) && c.options.std.placement == 0.)
            f.assumed.push_back(of(c, k) + "that neither board nor camera moved between the two images of a pair, also not "
                                "all the same way, which no residual shows");
    if (!c.outliers.fault.empty())
        f.assumed.push_back("that no point is wrong: they could not be looked for, as " + c.outliers.fault);
    f.assumed.push_back(std::string(c.square > 0 ? "a flat board with even spacing" : "a rigid target that is as its coordinates say")
                        + shapeAssumed(c.fit.rig.cameras[0]->window())
                        + ", and independent corner noise");
}

//! "camera 1: x", "camera 2: x" and so on of all cameras become "x"; of several "cameras 1, 2: x".
void mergeCameras(const RigCalibration& c, std::vector<std::string>& sentences)
{
    std::vector<std::string> merged;
    for (size_t i = 0; i < sentences.size(); i++)
    {
        int camera = 0;
        while (camera < c.data.cameraCount && sentences[i].compare(0, of(c, camera).size(), of(c, camera)) != 0)
            camera++;
        if (camera == c.data.cameraCount || c.data.cameraCount == 1)
        {
            merged.push_back(sentences[i]);
            continue;
        }
        const std::string rest = sentences[i].substr(of(c, camera).size());
        std::vector<int> twins = {camera};
        for (int other = camera + 1; other < c.data.cameraCount; other++)
        {
            const auto twin = std::find(sentences.begin() + i, sentences.end(), of(c, other) + rest);
            if (twin == sentences.end())
                continue;
            sentences.erase(twin);
            twins.push_back(other);
        }
        std::string numbers;
        for (int twin : twins)
            numbers += (numbers.empty() ? "" : ", ") + std::to_string(twin + 1);
        merged.push_back((int)twins.size() == c.data.cameraCount ? rest
                         : (twins.size() == 1 ? "camera " : "cameras ") + numbers + ": " + rest);
    }
    sentences = merged;
}

} // namespace

std::string LimitCheck::sentence() const
{
    if (!notJudged.empty())
        return what + " " + notJudged + ", so " + option + " is not met";
    if (std::isnan(value))
        return what + " is not known there (nothing is seen), so " + option + " is not met";
    return what + format(" is %.3g %s, ", value, unit.c_str()) + (met() ? "within " : "above ") + option;
}

bool Findings::pass() const
{
    return contradictions.empty() && std::all_of(limits.begin(), limits.end(), [](const LimitCheck& l) { return l.met(); });
}

Tone Findings::tone() const
{
    return !pass() ? Tone::BAD : weak.empty() && notChecked.empty() ? Tone::GOOD : Tone::DOUBTFUL;
}

std::string Findings::verdict() const
{
    if (!pass())
        return limits.empty() ? "Not usable: the images contradict what was given" : "FAIL";
    std::string text = limits.empty() ? weak.empty() ? "Good" : "" : "PASS";
    if (!weak.empty())
        text += text.empty() ? "Look at the weak points" : "; look at the weak points";
    if (!notChecked.empty())
        text += (weak.empty() ? ", but not checked: " : "; not checked: ") + notChecked;
    return text;
}

Findings findingsOf(const RigCalibration& calibration, const Assessment& assessment)
{
    Collected findings;
    for (const std::string& notice : calibration.notices)
        findings.add(THE_FIT, notice);
    checkLimits(calibration, assessment, findings);
    for (int c = 0; c < calibration.data.cameraCount; c++)
    {
        if (calibration.fit.rig.ownsWindow(c))
            checkWindow(calibration, c, findings);
        checkFit(calibration, c, findings);
        checkViews(calibration, c, findings);
    }
    checkCorrelations(calibration, findings);
    checkHeldOut(calibration, findings);
    for (const Contradiction& contradiction : assessment.contradictions)
        if (contradiction.isSure)
            findings.contradictions.push_back(contradiction.sentence);
        else
            findings.add(THE_STATED_ERROR, contradiction.sentence);
    checkAssumptions(calibration, findings);
    for (const auto& doubt : findings.doubts)
        findings.weak.push_back(doubt.second);
    for (std::vector<std::string>* list : {&findings.weak, &findings.cannotTell, &findings.assumed})
        mergeCameras(calibration, *list);
    return findings;
}

} // namespace tools
