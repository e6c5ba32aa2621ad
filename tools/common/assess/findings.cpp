// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/findings.hpp"
#include "assess/collected_findings.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/window_face.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

Assessment assess(const RigCalibration& c)
{
    Calibration calibration = calibrationOf(c.fit.rig);
    calibration.covariance = c.fit.covariance;
    Assessment result;
    const Vec3d depth = workingDepth(c, 0);
    for (double z : {0.5*depth[0], depth[0], depth[1], depth[2], 1.5*depth[2], 2.*depth[2]})
        result.errors.push_back(mapErrors(calibration, z, c.fit.sigma, ERROR_MAP_COLUMNS));
    for (const ErrorLimit& limit : c.limits.errors)
        result.limits.push_back(mapErrors(calibration, limit.range, c.fit.sigma, ERROR_MAP_COLUMNS));
    result.budget = uncertaintyBudget(c);
    result.advice = adviseImages(c);
    result.contradictions = testGivenValues(c.data, c.options, c.fit);
    return result;
}

namespace {

// Where a finding begins. They only choose words; no number depends on them.
const double MISFIT_RATIO = 1.5;            // RMS through the window / RMS direct
const double OUTLYING_VIEW = 2.5;           // times the median RMS of the views
const double INFLUENTIAL = 3.;              // standard deviations that one view may turn the normal
const double LOW_COVERAGE = 0.5;
const double NARROW_RANGE = 1.2;            // farthest / nearest
const double MANY_LEFT_OUT = 0.2;           // of a camera's points
const int ENOUGH_WITHOUT_PAIRS = 5;         // images through the window
const size_t FLAT_IMAGES_TO_JUDGE = 2;      // a pose fits itself to one
const double HELD_OUT_CHANCE = 1e-3;        // that true +- look so wrong on held-out boards

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
        f.limits.push_back({format("--max-normal-std=%g", limits.normalStdDeg), prefixOf(c, k) + "standard deviation of the normal",
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

void checkFit(const RigCalibration& c, int camera, CollectedFindings& f)
{
    const Rms glass = rmsOf(c, camera, true), direct = rmsOf(c, camera, false);
    // What the direct images reach without the window; in the joint fit a wrong window drags them along.
    const LensSource& lens = c.lensSources[camera];
    const double alone = lens.kind == LensSource::FROM_DIRECT ? std::min(lens.rms, direct.px) : direct.px;
    if (c.data.countPairs(camera) && std::max(glass.px, direct.px) > MISFIT_RATIO*alone)
        f.add(THE_FIT, prefixOf(c, camera) + format("direct images and images through the window do not agree (%.3f and %.3f px "
                         "together, direct alone %.3f px): check thickness and index, whether the board moved within a pair, "
                         "and whether the window is %s", direct.px, glass.px, alone, shapeWords(c).c_str()));
    const double through = c.baselines.throughGlass[camera];
    if (glass.px > MISFIT_RATIO*through)
        f.add(THE_FIT, prefixOf(c, camera) + format("a pinhole camera calibrated through the window fits these images better "
                         "(%.3f px) than lens and window together (%.3f px): the lens or the given values may be wrong",
                         through, glass.px));
    else if (glass.px > 0.8*through)
        f.cannotTell.push_back(prefixOf(c, camera) + format("from the residuals alone that the window is needed: a pinhole camera "
                               "calibrated on these same images fits them about as well (%.3f px). It does so only near the "
                               "poses it was calibrated on", through));
    const int pairs = c.data.countPairs(camera);
    if (pairs < ENOUGH_PAIRS && glass.views < ENOUGH_WITHOUT_PAIRS)
    {
        const int count = pairs ? pairs : glass.views;
        f.add(THE_DATA, prefixOf(c, camera) + format("only %d %s%s%s: take at least %d pairs", count, pairs ? "pair" : "image",
                                               count == 1 ? "" : "s", pairs ? "" : " through the window and no pair", ENOUGH_PAIRS));
    }
    const double covered = coverage(c, camera);
    if (covered < LOW_COVERAGE)
        f.add(THE_DATA, prefixOf(c, camera) + format("the board covers only %.0f %% of the image through the window: show it in the "
                                                "corners too", 100.*covered));
    const Vec3d depth = workingDepth(c, camera);
    if (depth[2] < NARROW_RANGE*depth[0])
        f.add(THE_DATA, prefixOf(c, camera) + format("all boards are at nearly the same depth (%.4g to %.4g %s): vary it", depth[0],
                                                depth[2], c.unit.c_str()));
}

//! -1: none is called so.
int indexOfView(const RigCalibration& c, const std::string& stem)
{
    const std::vector<View>& views = c.data.views;
    const auto found = std::find_if(views.begin(), views.end(), [&](const View& view) { return view.stem == stem; });
    return found == views.end() ? -1 : (int)(found - views.begin());
}

/** A robust fit goes with the majority. What is left out of a few images is dirt; where it is much, images may be of another camera or
window, and what fits the others is not what all were taken for. */
void checkLeftOut(const RigCalibration& c, int camera, CollectedFindings& f)
{
    for (bool glass : {true, false})
    {
        const int kept = rmsOf(c, camera, glass).points;
        int leftOut = 0;
        std::vector<std::string> images;
        for (const Rejected& rejected : rejectedOf(c))
            if (rejected.camera == camera && rejected.glass == glass)
            {
                leftOut += rejected.points;
                if (rejected.image || rejected.points > rmsOf(c, camera, glass, indexOfView(c, rejected.view)).points)
                    images.push_back(rejected.view);
            }
        if (leftOut > MANY_LEFT_OUT*(kept + leftOut))
            f.add(THE_FIT, prefixOf(c, camera) + format("%.0f %% of the points %s do not fit the others and were left out",
                      100.*leftOut/(kept + leftOut), glass ? "through the window" : "of direct images")
                  + (images.empty() ? "" : ", most of those of " + listed(images))
                  + ": are these images of this camera and window, and sharp?");
    }
}

//! One board joins two cameras wherever they are, so that nothing in it shows whether its images are of one moment. Known poses do.
void checkLink(const RigCalibration& c, int camera, CollectedFindings& f)
{
    if (c.options.flags & GLASS_USE_POSES)
        return;
    const auto isCommon = [&](int i) {
        const View& view = c.data.views[i];
        const bool glass = view.hasGlass(camera) && view.countGlass() > 1, direct = view.hasDirect(camera) && view.countDirect() > 1;
        return glass || direct; };
    const std::vector<int>& views = c.fit.views;
    const auto first = std::find_if(views.begin(), views.end(), isCommon);
    if (c.data.cameraCount > 1 && std::count_if(views.begin(), views.end(), isCommon) == 1)
        f.add(THE_STATED_ERROR, prefixOf(c, camera) + "of all views only '" + c.data.views[*first].stem + "' is of other cameras, too: if "
              "these images are not of one moment, nothing shows it; take more with all cameras at once, of equal names");
}

void checkViews(const RigCalibration& c, int camera, CollectedFindings& f)
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
                f.add(AN_IMAGE, prefixOf(c, camera) + format("view '%s' (%s) fits badly: %.3f px, the median view has %.3f px; look at "
                                 "the image, leave it out if corners are wrong", c.data.views[view.second].stem.c_str(),
                                 glass ? "through the window" : "direct", view.first, median));
    }
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const double sigma = placeStd(c.fit.covariance, c.fit.rig, camera);
    for (const Influence& influence : c.influences)
        if (influence.change[camera] > INFLUENTIAL*sigma)
            f.add(AN_IMAGE, prefixOf(c, camera) + format("view '%s' alone %s by %.3f %s, %.1f standard deviations",
                             c.data.views[influence.view].stem.c_str(), isRound(window) ? "moves the centre" : "turns the normal",
                             influence.change[camera], placeUnit(window, c.unit).c_str(), influence.change[camera]/sigma));
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
void checkHeldOut(const RigCalibration& c, CollectedFindings& f)
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

//! "camera 1: x", "camera 2: x" and so on of all cameras become "x"; of several "cameras 1, 2: x".
void mergeCameras(const RigCalibration& c, std::vector<std::string>& sentences)
{
    std::vector<std::string> merged;
    for (size_t i = 0; i < sentences.size(); i++)
    {
        int camera = 0;
        while (camera < c.data.cameraCount && sentences[i].compare(0, prefixOf(c, camera).size(), prefixOf(c, camera)) != 0)
            camera++;
        if (camera == c.data.cameraCount || c.data.cameraCount == 1)
        {
            merged.push_back(sentences[i]);
            continue;
        }
        const std::string rest = sentences[i].substr(prefixOf(c, camera).size());
        std::vector<int> twins = {camera};
        for (int other = camera + 1; other < c.data.cameraCount; other++)
        {
            const auto twin = std::find(sentences.begin() + i, sentences.end(), prefixOf(c, other) + rest);
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

std::string prefixOf(const RigCalibration& c, int camera)
{
    return c.data.cameraCount == 1 ? "" : format("camera %d: ", camera + 1);
}

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
    CollectedFindings findings;
    for (const std::string& notice : calibration.notices)
        findings.add(THE_FIT, notice);
    checkLimits(calibration, assessment, findings);
    for (int c = 0; c < calibration.data.cameraCount; c++)
    {
        if (calibration.fit.rig.ownsWindow(c))
            checkWindow(calibration, c, findings);
        checkFit(calibration, c, findings);
        checkLeftOut(calibration, c, findings);
        checkLink(calibration, c, findings);
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
