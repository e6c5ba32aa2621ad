#include "findings.hpp"
#include "table.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

// Where a finding begins. They only choose words; no number depends on them.
const double WEAK_NORMAL_DEG = 0.1;
const double WEAK_RELATIVE = 0.1;           // of thickness or distance
const double WEAK_INDEX = 0.01;
const double TIED = 0.95;                   // correlation
const double MISFIT_RATIO = 1.5;            // RMS through the window / RMS direct
const double OUTLYING_VIEW = 2.5;           // times the median RMS of the views
const double INFLUENTIAL = 3.;              // standard deviations that one view may turn the normal
const double LOW_COVERAGE = 0.5;
const double NARROW_RANGE = 1.2;            // farthest / nearest
const int FEW_VIEWS = 5;

//! "camera 2: " where there are two.
std::string of(const RigCalibration& c, int camera)
{
    return c.data.cameraCount == 1 ? "" : format("camera %d: ", camera + 1);
}

bool equalMedia(const GlassWindow& window) { return window.innerIndex == window.outerIndex; }

//! The camera that the window's parameters belong to: with one shared window, the first.
bool ownsWindow(const RigCalibration& c, int camera)
{
    return camera == 0 || !(c.options.flags & GLASS_SHARED_WINDOW);
}

void judgeLimits(const RigCalibration& c, Findings& f)
{
    if (c.maxRms > 0 && !(c.fit.rms <= c.maxRms))
        f.limitsNotMet.push_back(format("RMS %.3f px is above --max-rms=%g px", c.fit.rms, c.maxRms));
    for (int k = 0; k < c.data.cameraCount && c.maxNormalStdDeg > 0; k++)
    {
        const double std = windowStd(c.fit, k).normalDeg[0];
        if (!(std <= c.maxNormalStdDeg))
            f.limitsNotMet.push_back(of(c, k) + format("the normal is uncertain by %.3f deg, above --max-normal-std=%g deg",
                                                       std, c.maxNormalStdDeg));
    }
}

void judgeWindow(const RigCalibration& c, int camera, Findings& f)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const WindowStd std = windowStd(c.fit, camera);
    if (std.normalDeg[0] > WEAK_NORMAL_DEG)
        f.weak.push_back(of(c, camera) + format("the window's tilt is uncertain by %.2g deg: ", std.normalDeg[0])
                         + (c.data.countPairs(camera) ? "take more pairs, with the board all over the image"
                            : "take pairs (the board not moved between an image without and one with the window)"));
    if (std.distance > WEAK_RELATIVE * window.distance)
        f.weak.push_back(of(c, camera) + format("the distance to the window is weakly determined: %.4g +- %.2g. Near, "
                                                "strongly tilted boards at the image's border help",
                                                window.distance, std.distance));
    for (size_t i = 0; i < window.thickness.size(); i++)
    {
        if (std.thickness[i] > WEAK_RELATIVE * window.thickness[i])
            f.weak.push_back(of(c, camera) + format("the thickness is weakly determined: %.4g +- %.2g; measure it with a "
                                                    "caliper and give it by --thickness", window.thickness[i],
                                                    std.thickness[i]));
        if (std.index[i] > WEAK_INDEX)
            f.weak.push_back(of(c, camera) + format("the index is weakly determined: %.4g +- %.2g; give the material's value "
                                                    "by --index", window.index[i], std.index[i]));
    }
    if (equalMedia(window))
        f.cannotTell.push_back(of(c, camera) + "the distance from camera to window: with the same medium on both sides it "
                               "has exactly no effect on the image (and is not needed)");
    else if (!window.thickness.empty() && !(c.options.flags & GLASS_FREE_THICKNESS))
        f.assumed.push_back(of(c, camera) + "the layers' thickness as given; with another medium outside, an error in it is "
                            "largely taken up by the distance");
    if (c.data.countPairs(camera) == 0)
        f.cannotTell.push_back(of(c, camera) + "much about the tilt: no image without the window shows the board in the same "
                               "place, so tilt and board poses are partly exchangeable. Pairs are worth 30 to 90 times more "
                               "than such glass-only views");
}

void judgeCorrelations(const RigCalibration& c, Findings& f)
{
    const std::vector<FreeParameter> free = freeWindowParameters(c.fit, c.options.flags);
    for (size_t i = 0; i < free.size(); i++)
        for (size_t j = i + 1; j < free.size(); j++)
        {
            if (free[i].isNormal && free[j].isNormal)       // told by the two principal deviations
                continue;
            const double r = c.fit.covariance.at<double>(free[i].column, free[j].column) / (free[i].std * free[j].std);
            if (std::abs(r) > TIED)
                f.cannotTell.push_back(format("%s and %s apart: their correlation is %.4f, a change of one is nearly made up "
                                              "by the other", free[i].name.c_str(), free[j].name.c_str(), r));
        }
    if ((c.options.flags & GLASS_FREE_THICKNESS) && (c.options.flags & GLASS_FREE_INDEX))
        f.cannotTell.push_back("thickness and index well apart: at small angles only thickness x (1 - 1/index) shows; fixing "
                               "one of them makes the other far better");
}

void judgeFit(const RigCalibration& c, int camera, Findings& f)
{
    const Rms glass = rmsOf(c, camera, true), direct = rmsOf(c, camera, false);
    // What the direct images reach without the window; in the joint fit a wrong window drags them along.
    const LensSource& lens = c.lensSources[camera];
    const double alone = lens.kind == LensSource::FROM_DIRECT ? std::min(lens.rms, direct.px) : direct.px;
    if (c.data.countPairs(camera) && std::max(glass.px, direct.px) > MISFIT_RATIO * alone)
        f.weak.push_back(of(c, camera) + format("direct images and images through the window do not agree (%.3f and %.3f px "
                         "together, direct alone %.3f px): check thickness and index, whether the board moved within a pair, "
                         "and whether the window is flat", direct.px, glass.px, alone));
    const double through = c.baselines.throughGlass[camera];
    if (glass.px > MISFIT_RATIO * through)
        f.weak.push_back(of(c, camera) + format("a pinhole camera calibrated through the window fits these images better "
                         "(%.3f px) than lens and window together (%.3f px): the lens or the given values may be wrong",
                         through, glass.px));
    else if (glass.px > 0.8 * through)
        f.cannotTell.push_back(of(c, camera) + format("from the residuals alone that the window is needed: a pinhole camera "
                               "calibrated on these same images fits them about as well (%.3f px). It does so only near the "
                               "poses it was calibrated on", through));
    if (glass.views < FEW_VIEWS)
        f.weak.push_back(of(c, camera) + format("only %d image(s) through the window: take at least %d, better 10", glass.views,
                                                FEW_VIEWS));
    const double covered = coverage(c, camera);
    if (covered < LOW_COVERAGE)
        f.weak.push_back(of(c, camera) + format("the board covers only %.0f %% of the image through the window: show it in the "
                                                "corners too", 100. * covered));
    const Vec3d depth = workingDepth(c, camera);
    if (depth[2] < NARROW_RANGE * depth[0])
        f.weak.push_back(of(c, camera) + format("all boards are at nearly the same depth (%.4g to %.4g): vary it", depth[0],
                                                depth[2]));
}

void judgeViews(const RigCalibration& c, int camera, Findings& f)
{
    for (bool glass : {true, false})
    {
        std::vector<std::pair<double, int>> views;
        for (int i : c.fit.moments)
        {
            const Rms rms = rmsOf(c, camera, glass, i);
            if (rms.points)
                views.push_back({rms.px, i});
        }
        if (views.size() < 3)
            continue;
        std::sort(views.begin(), views.end());
        const double median = views[views.size() / 2].first;
        for (const auto& view : views)
            if (view.first > OUTLYING_VIEW * median)
                f.weak.push_back(of(c, camera) + format("view '%s' (%s) fits badly: %.3f px, the middle view has %.3f px; look at "
                                 "the image, leave it out if corners are wrong", c.data.moments[view.second].stem.c_str(),
                                 glass ? "through the window" : "direct", view.first, median));
    }
    const double sigma = windowStd(c.fit, camera).normalDeg[0];
    for (const Influence& influence : c.influences)
        if (influence.turnDeg[camera] > INFLUENTIAL * sigma)
            f.weak.push_back(of(c, camera) + format("view '%s' alone turns the normal by %.3f deg, %.1f standard deviations",
                             c.data.moments[influence.moment].stem.c_str(), influence.turnDeg[camera],
                             influence.turnDeg[camera] / sigma));
}

void judgeAssumptions(const RigCalibration& c, Findings& f)
{
    const bool freeLens = c.options.flags & GLASS_FREE_INTRINSICS;
    for (int k = 0; k < c.data.cameraCount; k++)
        if (!freeLens)
            f.assumed.push_back(of(c, k) + (c.lensSources[k].kind == LensSource::FROM_FILE
                ? std::string("the lens as in the file; its uncertainty is not in the +-")
                : format("the lens as cv::calibrateCamera found it on %d direct images (%.3f px); its uncertainty is not in "
                         "the +-", c.lensSources[k].views, c.lensSources[k].rms)));
    const GlassWindow& window = c.options.window;
    if (!window.thickness.empty() && !(c.options.flags & GLASS_FREE_THICKNESS))
        f.assumed.push_back("thickness as given");
    if (!window.index.empty() && !(c.options.flags & GLASS_FREE_INDEX))
        f.assumed.push_back("index as given");
    if (!equalMedia(window) && !(c.options.flags & GLASS_FREE_DISTANCE))
        f.assumed.push_back("distance as given");
    f.assumed.push_back("a flat board with even spacing, a flat window with parallel surfaces, and independent corner noise");
}

//! "camera 1: x" and "camera 2: x" become "x".
void mergeCameras(std::vector<std::string>& sentences)
{
    for (size_t i = 0; i < sentences.size(); i++)
    {
        const std::string first = "camera 1: ";
        if (sentences[i].compare(0, first.size(), first) != 0)
            continue;
        const std::string rest = sentences[i].substr(first.size());
        const auto twin = std::find(sentences.begin(), sentences.end(), "camera 2: " + rest);
        if (twin == sentences.end())
            continue;
        sentences.erase(twin);
        sentences[i] = rest;
    }
}

} // namespace

Findings judge(const RigCalibration& calibration)
{
    Findings findings;
    judgeLimits(calibration, findings);
    for (int c = 0; c < calibration.data.cameraCount; c++)
    {
        if (ownsWindow(calibration, c))
            judgeWindow(calibration, c, findings);
        judgeFit(calibration, c, findings);
        judgeViews(calibration, c, findings);
    }
    judgeCorrelations(calibration, findings);
    judgeAssumptions(calibration, findings);
    for (std::vector<std::string>* list : {&findings.weak, &findings.cannotTell, &findings.assumed})
        mergeCameras(*list);
    return findings;
}

} // namespace tools
