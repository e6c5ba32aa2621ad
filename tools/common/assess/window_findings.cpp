// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/collected_findings.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
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

void checkTilt(const RigCalibration& c, int camera, CollectedFindings& f)
{
    const double std = windowStd(c.fit, camera).normalDeg[0], ofNoise = normalStdOfNoise(c, camera);
    const bool pairs = c.data.countPairs(camera) > 0;
    if (ofNoise > WEAK_NORMAL_DEG)
    {
        f.add(A_PARAMETER, prefixOf(c, camera) + format("the window's tilt is uncertain by %.2g deg: ", std)
                         + (pairs ? "take more pairs, with the board all over the image"
                            : !c.data.hasDirect() ? "take more images, near and far, tilted to all sides, with the board all over the image"
                            : "take pairs (the board not moved between an image without and one with the window)"));
        if (!pairs)
            f.cannotTell.push_back(prefixOf(c, camera) + "much about the tilt: no image without the window shows the board in the same "
                                   "place, so tilt and board poses are correlated. Pairs are worth 30 to 90 times more than "
                                   "such glass-only views");
    }
    else if (std > TELLING_RATIO*ofNoise)
        f.cannotTell.push_back(prefixOf(c, camera) + format("the window's tilt better than to %.2g deg: a wedge between its faces%s looks "
                               "like a tilt (were it known, %.2g deg). Points hardly suffer from that", std,
                               pairs && c.options.std.placement > 0. ? ", or a motion of all boards between direct and glass," : "",
                               ofNoise));
}

//! Of a dome or tube.
void checkCentre(const RigCalibration& c, int camera, CollectedFindings& f)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const RoundWindow round = *roundWindowOf(c, camera);
    const std::string middle = round.shape == "dome" ? "centre" : "axis";
    const double std = placeStd(c.fit.covariance, c.fit.rig, camera);
    if (round.isNeedless())
        f.cannotTell.push_back(prefixOf(c, camera) + round.needless(c.unit));
    else if (std > WEAK_CENTRE*window.radius)
        f.add(A_PARAMETER, prefixOf(c, camera) + format("the %s's %s is uncertain by %.2g %s: ", round.shape.c_str(), middle.c_str(), std,
                                                  c.unit.c_str())
              + (c.data.countPairs(camera) ? "take more pairs, with the board all over the image"
                 : "take pairs (the board not moved between an image without and one with the " + round.shape + ")"));
    if (c.options.flags & GLASS_FREE_RADIUS && windowStd(c.fit, camera).radius > WEAK_RELATIVE*window.radius)
        f.add(A_PARAMETER, prefixOf(c, camera) + "the radius is weakly determined: " + plusMinus(window.radius,
              windowStd(c.fit, camera).radius) + " " + c.unit + "; give that of the drawing by --radius");
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

void checkDistance(const RigCalibration& c, int camera, CollectedFindings& f)
{
    const double AT_TARGET = 0.02;          // part of the distance: a fit that comes to a target stays a little before it
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const double std = windowStd(c.fit, camera).distance;
    const std::string value = plusMinus(window.distance, std) + " " + c.unit;
    if (!(std > 0.) || c.options.std.isDistanceOpen)
        return;
    const bool isFree = c.options.flags & GLASS_FREE_DISTANCE;
    const double gap = gapToTargets(c, camera);
    if (isFree && window.distance == 0.)
        f.add(A_PARAMETER, prefixOf(c, camera) + "the distance to the window ended at its bound, " + value + ": the images would have the "
              "window behind the camera. Give it by --distance, and see whether --index, --outer-index and the lens are right");
    else if (isFree && gap < AT_TARGET*window.distance && gap < 0.5*std)
        f.add(A_PARAMETER, prefixOf(c, camera) + "the distance to the window ended where a target touches it, " + value
              + ": the images hardly tell it. Give it by --distance, or take strongly tilted boards at the image's border");
    else if (std > WEAK_RELATIVE*window.distance)
        f.add(A_PARAMETER, prefixOf(c, camera) + "the distance to the window is weakly determined: " + value
              + ". Near, strongly tilted boards at the image's border help");
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
    return prefixOf(c, camera) + format("thickness and index apart: only thickness x (1 - %s/index) = ",
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

bool isLensFree(const RigCalibration& c, int camera)
{
    const ParameterColumns at = columnsOf(c.fit.rig, camera);
    return c.fit.stdDeviations.at<double>(at.lens) > 0.;
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
        text += format(", which is %.3g %s from camera 2", norm(c.fit.rig.extrinsics[1].t), c.unit.c_str());
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

} // namespace

void checkWindow(const RigCalibration& c, int camera, CollectedFindings& f)
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
            f.add(A_PARAMETER, prefixOf(c, camera) + "the thickness is weakly determined: " + plusMinus(window.thickness[i],
                  std.thickness[i]) + " " + c.unit + "; measure it with a caliper and give it by --thickness");
        if (c.options.flags & GLASS_FREE_INDEX && std.index[i] > WEAK_INDEX)
            f.add(A_PARAMETER, prefixOf(c, camera) + "the index is weakly determined: " + plusMinus(window.index[i], std.index[i])
                  + "; give the material's value by --index");
    }
    const std::optional<SecondSolution> other = secondSolution(c, camera);
    if (other && !other->isExcluded())
        f.add(THE_DATA, prefixOf(c, camera) + other->sentence());
    if (!hasDifferentMedia(window) && !isRound(window))
    {
        const std::string effect = std.distance > 0. ? "an effect only as far as the faces are not parallel ("
            + plusMinus(window.distance, std.distance) + " " + c.unit + ")" : "no effect on the image where faces are parallel";
        f.cannotTell.push_back(prefixOf(c, camera) + "the distance from camera to window: with the same medium on both sides it has "
                               + effect + ", and is not needed");
    }
}

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

void checkAssumptions(const RigCalibration& c, Findings& f)
{
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.lensSources[k].kind == LensSource::FROM_FILE && !isLensFree(c, k))
            f.assumed.push_back(prefixOf(c, k) + "the lens of the file, taken as exact, as the file states no covariance");
    if (c.options.std.scale == 0.)
        f.assumed.push_back((c.square > 0 ? format("the square of %g", c.square) : std::string("the coordinates of the points in"))
                            + " " + c.unit + ": all lengths are in proportion to it, and no image shows it. A tape measure does: "
                            + scaleInWords(c));
    if (c.options.flags & GLASS_USE_POSES)
        f.assumed.push_back("the poses of the target, within their given standard deviations");
    const GlassWindow& window = c.options.window;
    if (!window.thickness.empty() && !(c.options.flags & GLASS_FREE_THICKNESS) && c.options.std.thickness == 0.)
        f.assumed.push_back("the thickness, " + listOf(window.thickness) + " " + c.unit
                            + (hasDifferentMedia(window) ? " (an error in it is largely taken up by the distance, as the media on its two "
                               "sides differ)" : ""));
    if (!window.index.empty() && !(c.options.flags & GLASS_FREE_INDEX) && !c.options.std.ofIndices())
        f.assumed.push_back("the index, " + listOf(window.index));
    std::vector<GivenIndex> indices = c.options.layers;
    indices.insert(indices.end(), {c.options.inner, c.options.outer});
    for (const GivenIndex& index : indices)
        if (index.isNamed() && std::find(f.assumed.begin(), f.assumed.end(), index.sentence()) == f.assumed.end())
            f.assumed.push_back(index.sentence());
    if (isRound(window) && !(c.options.flags & GLASS_FREE_RADIUS) && c.options.std.radius == 0.)
        f.assumed.push_back("the radius, " + listOf({window.radius}) + " " + c.unit);
    if (hasDifferentMedia(window) && !isRound(window) && !(c.options.flags & GLASS_FREE_DISTANCE) && c.options.std.distance == 0.
        && !c.options.areMarkersGiven())
        f.assumed.push_back("the distance, " + listOf({window.distance}) + " " + c.unit);
    for (int k = 0; k < c.data.cameraCount; k++)
        if (c.data.countPairs(k) && c.options.std.placement == 0.)
            f.assumed.push_back(prefixOf(c, k) + "that neither board nor camera moved between the two images of a pair, also not "
                                "all the same way, which no residual shows");
    if (!c.outliers.fault.empty())
        f.assumed.push_back("that no point is wrong: they could not be looked for, as " + c.outliers.fault);
    f.assumed.push_back(std::string(c.square > 0 ? "a flat board with even spacing" : "a rigid target that is as its coordinates say")
                        + shapeAssumed(c.fit.rig.cameras[0]->window())
                        + ", and independent corner noise");
}

} // namespace tools
