// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/summary.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int CAMERAS_ABREAST = 2;      // as many as a terminal of 100 columns takes
const double FAR_WORSE = 5.;        // the worst point against 95 % of all

std::string estimateOr(double value, double std, const char* otherwise)
{
    return std > 0 ? plusMinus(value, std) : format("%.6g (%s)", value, otherwise);
}

std::string px(double value) { return std::isnan(value) ? "-" : format("%.3f", value); }

std::string viewsAndCorners(const Rms& rms) { return format("%d / %d", rms.views, rms.points); }

std::string lensOf(const RigCalibration& c, int camera)
{
    const LensSource& source = c.lensSources[camera];
    const RefractiveCamera& lens = *c.fit.rig.cameras[camera];
    const bool chosen = source.kind != LensSource::FROM_FILE && !c.lens.scores.empty();
    std::string text = format("%s, %d coefficients, ", lens.lensModel().c_str(),
                              chosen ? c.lens.lens().coefficients : (int)lens.distCoeffs().total());
    text += source.kind == LensSource::FROM_FILE ? std::string("given") : format("%d views, %.3f px", source.views, source.rms);
    if (!(c.options.flags & GLASS_FREE_INTRINSICS))
        return text;
    return text + (isSplined(lens) ? ", as it is: splines are not refined" : ", refined");
}

std::string worstViews(const RigCalibration& c, int camera)
{
    std::vector<std::pair<double, int>> views;
    for (int i : c.fit.views)
    {
        const Rms rms = rmsOf(c, camera, true, i);
        if (rms.points)
            views.push_back({rms.px, i});
    }
    std::sort(views.rbegin(), views.rend());
    std::string text;
    for (size_t k = 0; k < std::min<size_t>(3, views.size()); k++)
        text += (k ? ", " : "") + c.data.views[views[k].second].stem + format(" %.3f", views[k].first);
    return text;
}

SummaryRow row(const RigCalibration& c, const std::string& name, const std::function<std::string(int)>& cell)
{
    SummaryRow result{name, {}};
    for (int k = 0; k < c.data.cameraCount; k++)
        result.cells.push_back(cell(k));
    return result;
}

void printSentences(std::ostream& out, const char* heading, const std::vector<std::string>& sentences)
{
    if (sentences.empty())
        return;
    out << '\n' << heading << '\n';
    for (const std::string& sentence : sentences)
        out << "  - " << sentence << '\n';
}

void printRows(std::ostream& out, const std::string& title, const std::vector<std::string>& heading,
               const std::vector<SummaryRow>& rows)
{
    if (rows.empty())
        return;
    if (!title.empty())
        out << '\n' << title << '\n';
    Table table(heading);
    for (const SummaryRow& row : rows)
    {
        std::vector<std::string> cells{row.name};
        cells.insert(cells.end(), row.cells.begin(), row.cells.end());
        table.add(cells);
    }
    table.print(out);
}

//! The heading of as many cameras as stand side by side.
std::vector<std::string> camerasFrom(const RigCalibration& c, int first)
{
    std::vector<std::string> heading = {""};
    for (int k = first; k < std::min(first + CAMERAS_ABREAST, c.data.cameraCount); k++)
        heading.push_back(c.data.cameraCount == 1 ? "camera" : format("camera %d", k + 1));
    return heading;
}

std::vector<SummaryRow> columnsFrom(const std::vector<SummaryRow>& rows, int first)
{
    std::vector<SummaryRow> part;
    for (const SummaryRow& row : rows)
        part.push_back({row.name, std::vector<std::string>(row.cells.begin() + first,
                        row.cells.begin() + std::min(row.cells.size(), (size_t)(first + CAMERAS_ABREAST)))});
    return part;
}

} // namespace

//! Of which colour of light the calibration is; empty: nobody said.
static std::string lightText(const RigOptions& options)
{
    const std::string channel = options.channel == BRIGHTNESS ? "" : nameOf(options.channel) + " channel";
    if (!options.hasMaterials())
        return channel;
    return format("%g nm", options.window.wavelength) + (channel.empty() ? "" : ", " + channel);
}

//! Where a flat window is.
static std::vector<SummaryRow> normalRows(const RigCalibration& c)
{
    const auto window = [&c](int k) { return c.fit.rig.cameras[k]->window(); };
    const auto deviation = [&c](int k) { return windowStd(c.fit, k); };
    std::vector<SummaryRow> rows;
    rows.push_back(row(c, "normal", [&](int k) {
        const Vec3d n = window(k).normal;
        return format("(%.5f, %.5f, %.5f)", n[0], n[1], n[2]);
    }));
    rows.push_back(row(c, "tilt against the optical axis, deg",
                       [&](int k) { return plusMinus(tiltDegrees(window(k)), tiltStdDegrees(c.fit, k)); }));
    rows.push_back(row(c, "normal +- (two principal), deg", [&](int k) {
        const std::vector<double> std = deviation(k).normalDeg;
        return format("%.2g, %.2g", std[0], std[1]);
    }));
    rows.push_back(row(c, "distance, " + c.unit, [&](int k) {
        const GlassWindow w = window(k);
        const double std = deviation(k).distance;
        return !hasDifferentMedia(w) && !(std > 0.) ? std::string("no effect") : estimateOr(w.distance, std, "given");
    }));
    const double toBow = bowOf(1., c.unit);
    if (window(0).shape == WINDOW_BENT)
        rows.push_back(row(c, "bow, mm of sag per m",
                           [&](int k) { return estimateOr(toBow*window(k).curvature, toBow*deviation(k).curvature, "given"); }));
    return rows;
}

//! Where a dome or tube is.
static std::vector<SummaryRow> centreRows(const RigCalibration& c)
{
    const auto window = [&c](int k) { return c.fit.rig.cameras[k]->window(); };
    const auto deviation = [&c](int k) { return windowStd(c.fit, k); };
    const bool isTube = window(0).shape == WINDOW_TUBE;
    std::vector<SummaryRow> rows;
    rows.push_back(row(c, isTube ? "point of the axis, " + c.unit : "centre, " + c.unit, [&](int k) {
        const Vec3d x = window(k).center;
        return format("(%.4g, %.4g, %.4g)", x[0], x[1], x[2]);
    }));
    rows.push_back(row(c, "  +- (x, y, z), " + c.unit, [&](int k) {
        const std::vector<double> std = deviation(k).center;
        return format("%.2g, %.2g, %.2g", std[0], std[1], std[2]);
    }));
    if (isTube)
        rows.push_back(row(c, "axis; +- (two principal), deg", [&](int k) {
            const Vec3d a = window(k).axis;
            const std::vector<double> std = deviation(k).axisDeg;
            return format("(%.4f, %.4f, %.4f); %.2g, %.2g", a[0], a[1], a[2], std[0], std[1]);
        }));
    rows.push_back(row(c, std::string("camera off the ") + (isTube ? "axis, " : "centre, ") + c.unit, [&](int k) {
        const RoundWindow round = *roundWindowOf(c, k);
        return plusMinus(round.offset, round.offsetStd);
    }));
    rows.push_back(row(c, "  moves points by up to, px (" + c.unit + ")", [&](int k) {
        const RoundWindow round = *roundWindowOf(c, k);
        return format("%.3g (%.3g at z = %.4g)", round.px, round.length, round.depth);
    }));
    rows.push_back(row(c, "radius of the inner face, " + c.unit, [&](int k) {
        return estimateOr(window(k).radius, deviation(k).radius, "given"); }));
    return rows;
}

std::vector<SummaryRow> windowRows(const RigCalibration& c)
{
    const auto window = [&c](int k) { return c.fit.rig.cameras[k]->window(); };
    const auto deviation = [&c](int k) { return windowStd(c.fit, k); };
    const GlassWindow first = window(0);
    std::vector<SummaryRow> rows = isRound(first) ? centreRows(c) : normalRows(c);
    for (size_t i = 0; i < first.thickness.size(); i++)
    {
        const std::string layer = first.thickness.size() == 1 ? "" : format(" of layer %zu", i + 1);
        rows.push_back(row(c, "thickness" + layer + ", " + c.unit,
                           [&](int k) { return estimateOr(window(k).thickness[i], deviation(k).thickness[i], "given"); }));
        rows.push_back(row(c, "index" + layer,
                           [&](int k) { return estimateOr(window(k).index[i], deviation(k).index[i], "given"); }));
        const double toMinutes = 1./ARC_MINUTE;
        for (size_t axis = 0; axis < 2 && !first.wedge.empty(); axis++)
            rows.push_back(row(c, std::string("wedge ") + "xy"[axis] + layer + ", arc minutes", [&](int k) {
                return estimateOr(toMinutes*window(k).wedge[i][(int)axis], toMinutes*deviation(k).wedge[2*i + axis], "given");
            }));
    }
    rows.push_back(row(c, "index of the scene's medium",
                       [&](int k) { return estimateOr(window(k).outerIndex, deviation(k).outerIndex, "given"); }));
    bool hasOther = false;
    for (int k = 0; k < c.data.cameraCount; k++)
        hasOther = hasOther || secondSolution(c, k);
    if (hasOther)
        rows.push_back(row(c, std::string("second solution: ") + placeName(first) + "; RMS, px", [&](int k) {
            const std::optional<SecondSolution> other = secondSolution(c, k);
            return other ? format("(%.4f, %.4f, %.4f); %.4f", other->normal[0], other->normal[1], other->normal[2], other->rms)
                         : std::string("-");
        }));
    rows.push_back(row(c, "lens", [&](int k) { return lensOf(c, k); }));
    const std::string light = lightText(c.options);
    if (!light.empty())
        rows.push_back(row(c, "light", [&](int) { return light; }));
    return rows;
}

std::vector<SummaryRow> fitRows(const RigCalibration& c)
{
    std::vector<SummaryRow> rows;
    rows.push_back(row(c, "RMS through the window, px", [&](int k) { return px(rmsOf(c, k, true).px); }));
    rows.push_back(row(c, "  the same, glass ignored, px", [&](int k) { return px(c.baselines.glassIgnored[k]); }));
    rows.push_back(row(c, "  the same, board where it is, px", [&](int k) { return px(c.baselines.shift[k]); }));
    rows.push_back(row(c, "  the same, pinhole through glass, px", [&](int k) { return px(c.baselines.throughGlass[k]); }));
    rows.push_back(row(c, "RMS direct, px", [&](int k) { return px(rmsOf(c, k, false).px); }));
    rows.push_back(row(c, "views / corners through the window", [&](int k) { return viewsAndCorners(rmsOf(c, k, true)); }));
    rows.push_back(row(c, "views / corners direct", [&](int k) { return viewsAndCorners(rmsOf(c, k, false)); }));
    rows.push_back(row(c, "pairs of direct and glass", [&](int k) { return format("%d", c.data.countPairs(k)); }));
    rows.push_back(row(c, "worst views, px", [&](int k) { return worstViews(c, k); }));
    return rows;
}

std::vector<SummaryRow> heldOutRows(const RigCalibration& c)
{
    const HeldOut& h = c.heldOut;
    const NearFar& n = c.nearFar;
    std::vector<SummaryRow> rows;
    const auto add = [&rows](const std::string& name, const std::string& window, const std::string& pinhole) {
        rows.push_back({name, {window, pinhole}});
    };
    if (h.folds)
        add("RMS through the window, px", px(h.px), px(h.pinholePx));
    if (n.done)
    {
        add("  calibrated near, tested far, px", px(n.windowNearToFar), px(n.pinholeNearToFar));
        add("  calibrated far, tested near, px", px(n.windowFarToNear), px(n.pinholeFarToNear));
    }
    if (!std::isnan(h.transferPx))
        add("  board where its direct image is, px", px(h.transferPx), "-");
    if (h.folds)
        add("  error over stated (1: as stated)",
            h.covarianceTest.directions ? format("%.2f", h.covarianceTest.calibrationRatio()) : std::string("not known"), "-");
    if (!std::isnan(h.lengthRms))
        add("lengths between corners, RMS, " + c.unit, format("%.3g", h.lengthRms),
            std::isnan(h.pinholeLengthRms) ? "-" : format("%.3g", h.pinholeLengthRms));
    return rows;
}

std::vector<SummaryRow> pointErrorRows(const RigCalibration& c, const Assessment& a)
{
    std::vector<SummaryRow> rows;
    for (const ErrorMap& map : a.errors)
        rows.push_back({format("z = %.4g %s", map.range, c.unit.c_str()),
                        map.seen() ? std::vector<std::string>{format("%.3g", map.median()), format("%.3g", map.percentile95()),
                                                              format("%.3g", map.worst()), format("%.3g", map.worstPixelNoise()),
                                                              format("%.0f %%", 100.*map.seenShare())}
                                   : std::vector<std::string>{"-", "-", "-", "-", "0 %"}});
    return rows;
}

std::string pointErrorNote(const RigCalibration& c, const Assessment& a)
{
    const int cameras = c.data.cameraCount;
    std::string note = cameras == 1 ? "Seen: the share of the image whose rays meet the plane at that z."
                                    : std::string("Seen: the share of camera 1's image that ")
                                      + (cameras == 2 ? "camera 2" : "another camera") + " sees too at that z.";
    if (std::any_of(a.errors.begin(), a.errors.end(), [](const ErrorMap& map) { return !map.seen(); }))
        note += cameras == 1 ? " 0 %: that z lies within or before the window."
                : cameras == 2 ? " 0 %: no point there is in both images." : " 0 %: no point there is in two images.";
    if (std::any_of(a.errors.begin(), a.errors.end(), [](const ErrorMap& map) { return map.worst() > FAR_WORSE*map.percentile95(); }))
        note += " Where the worst is far above the rest it is a few points at the border of what is seen: leave them out.";
    return note;
}

std::vector<SummaryRow> budgetRows(const Assessment& a)
{
    std::vector<SummaryRow> rows;
    for (const BudgetRow& row : a.budget)
        rows.push_back({row.source, {row.given, format("%.2g", row.effect), format("%.1f", 100.*row.share)}});
    return rows;
}

std::vector<SummaryRow> adviceRows(const Advice& advice)
{
    std::vector<SummaryRow> rows;
    const auto add = [&rows](const std::string& name, const Quality& quality) {
        std::string normals;
        for (double std : quality.placeStd)
            normals += (normals.empty() ? "" : ", ") + format("%.2g", std);
        rows.push_back({name, {normals, format("%.3g", quality.worstPoint), format("%.3g", quality.calibrationPart)}});
    };
    add("now", advice.now);
    for (size_t i = 0; i < advice.pairs.size(); i++)
        add(format(advice.arePairs ? "pair %zu: " : "image %zu: ", i + 1) + advice.pairs[i].placement, advice.pairs[i].quality);
    for (const PlannedImage& image : advice.instead)
        add("instead: " + image.placement, image.quality);
    return rows;
}

//! The heading of its first column: "normal +-, deg", or of a dome's centre.
static std::string placeHeading(const RigCalibration& c)
{
    const GlassWindow window = c.fit.rig.cameras[0]->window();
    return std::string(placeName(window)) + " +-, " + placeUnit(window, c.unit);
}

void printSummary(std::ostream& out, const RigCalibration& c, const Assessment& assessment, const Findings& findings)
{
    std::vector<std::string> limits;
    for (const LimitCheck& limit : findings.limits)
        limits.push_back(limit.sentence());
    out << toned(out, findings.verdict(), findings.tone()) << '\n';
    printSentences(out, "Limits:", limits);
    out << '\n';
    std::vector<SummaryRow> rows = windowRows(c);
    const std::vector<SummaryRow> fit = fitRows(c);
    rows.insert(rows.end(), fit.begin(), fit.end());
    for (int first = 0; first < c.data.cameraCount; first += CAMERAS_ABREAST)
    {
        out << (first ? "\n" : "");
        printRows(out, "", camerasFrom(c, first), columnsFrom(rows, first));
    }
    printRows(out, "On boards that took no part (held out in turn):", {"", "lens and window", "pinhole through glass"},
              heldOutRows(c));
    printRows(out, "Expected error of a measured point, " + c.unit + " (one standard deviation, 3-D):",
              {"", "half within", "95 % within", "worst", "of pixel noise", "seen"}, pointErrorRows(c, assessment));
    out << pointErrorNote(c, assessment) << '\n';
    printRows(out, "What the +- of a point of the working volume is made of, " + c.unit + " (the rows add up in squares):",
              {"", "known to", "effect", "share, %"}, budgetRows(assessment));
    if (!assessment.advice.pairs.empty())
        printRows(out, "What the next images would bring:",
                  {"", placeHeading(c), "worst point, " + c.unit, "calibration's part, " + c.unit},
                  adviceRows(assessment.advice));
    out << format("\nRMS over all corners of the fit itself %.4f px; noise of a pixel coordinate %.4f px.\n", c.fit.rms, c.fit.sigma);
    if (!c.lens.scores.empty())
        out << "Lens: " << c.lens.sentence() << ".\n";
    printSentences(out, "Images in which the target was not found:", c.withoutTarget);
    std::vector<std::string> rejected;
    for (const Rejected& d : rejectedOf(c))
        rejected.push_back(d.sentence());
    printSentences(out, "Left out:", rejected);
    printSentences(out, "Contradictions:", findings.contradictions);
    printSentences(out, "Weak:", findings.weak);
    printSentences(out, "The data cannot tell:", findings.cannotTell);
    printRows(out, "Given values, and how well they are known:", {"", "value", "one std", "source"}, givenRows(c));
    printSentences(out, "Taken as given:", findings.assumed);
}

Calibration toFile(const RigCalibration& c, const std::string& command)
{
    Calibration file = calibrationOf(c.fit.rig);
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        file.cameras[k].windowStd = windowStd(c.fit, k);
        file.cameras[k].rms = rmsOfCamera(c, k).px;
    }
    file.rms = c.fit.rms;
    file.sigma = c.fit.sigma;
    file.dof = c.fit.dof;
    file.covariance = c.fit.covariance;
    file.unit = c.square > 0 ? c.unit : "";      // else nobody said what the points are in
    file.square = c.square;
    file.placementStd = c.data.countPairs() ? c.options.std.placement.value : -1.;
    file.channel = c.options.channel;
    file.label = c.label;
    file.provenance = {withHashes(c.used), calibratedVolume(c), uncertaintySources(c)};
    file.command = command;
    file.time = timeOfFiles(c.inputs);
    return file;
}

} // namespace tools
