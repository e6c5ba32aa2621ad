// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/summary.hpp"
#include "assess/advice.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/json.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int DIGITS = 6;       // more are rounding errors, which need not be the same every time

Json listOf(const Vec3d& v) { return Json::array({v[0], v[1], v[2]}); }

//! What was estimated has a standard deviation, what was given none.
Json estimate(double value, double std)
{
    Json result = {{"value", value}};
    if (std > 0)
        result.set("std", std);
    return result;
}

Json estimates(const std::vector<double>& values, const std::vector<double>& std)
{
    Json list = Json::array();
    for (size_t i = 0; i < values.size(); i++)
        list.append(estimate(values[i], std[i]));
    return list;
}

Json parameters(const std::vector<EstimatedParameter>& list)
{
    Json result = Json::object();
    for (const EstimatedParameter& p : list)
        result.set(p.name, estimate(p.value, p.std));
    return result;
}

//! null: there is none.
Json otherMinimumJson(const RigCalibration& c, int camera)
{
    const std::optional<SecondSolution> other = secondSolution(c, camera);
    if (!other)
        return nullptr;
    return {{other->of == "normal" ? "normal" : "center", listOf(other->normal)}, {"rms_px", other->rms},
            {"standard_deviations_worse", other->excess}, {"excluded", other->isExcluded()}};
}

//! Where the window is.
void addPlace(const RigCalibration& c, int camera, Json& json)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const WindowStd std = windowStd(c.fit, camera);
    if (const std::optional<RoundWindow> round = roundWindowOf(c, camera))
    {
        json.set("center", listOf(window.center));
        json.set("center_std", std.center);
        json.set("radius", estimate(window.radius, std.radius));
        json.set("offset", estimate(round->offset, round->offsetStd));
        json.set("moves_points", {{"px", round->px}, {"length", round->length}, {"z", round->depth}, {"needless", round->isNeedless()}});
        if (window.shape == WINDOW_TUBE)
        {
            json.set("axis", listOf(window.axis));
            json.set("axis_std_deg", std.axisDeg);
        }
        return;
    }
    json.set("normal", listOf(window.normal));
    json.set("normal_std_deg", std.normalDeg);
    json.set("tilt_deg", tiltDegrees(window));
    json.set("tilt_std_deg", tiltStdDegrees(c.fit, camera));
    json.set("distance", !hasDifferentMedia(window) && !(std.distance > 0.) ? Json() : estimate(window.distance, std.distance));
    if (window.shape == WINDOW_BENT)
    {
        json.set("curvature", estimate(window.curvature, std.curvature));
        json.set("bow_mm_per_m", estimate(bowOf(window.curvature, c.unit), bowOf(std.curvature, c.unit)));
    }
}

Json cameraJson(const RigCalibration& c, int camera)
{
    const GlassWindow window = c.fit.rig.cameras[camera]->window();
    const WindowStd std = windowStd(c.fit, camera);
    const LensSource& lens = c.lensSources[camera];
    const Rms glass = rmsOf(c, camera, true), direct = rmsOf(c, camera, false);
    Json windowJson = {
        {"shape", nameOfShape(window)},
        {"thickness", estimates(window.thickness, std.thickness)},
        {"index", estimates(window.index, std.index)},
        {"inner_index", window.innerIndex},
        {"outer_index", estimate(window.outerIndex, std.outerIndex)},
        {"second_solution", otherMinimumJson(c, camera)}};
    addPlace(c, camera, windowJson);
    return {
        {"window", windowJson},
        {"lens", {
            {"model", c.fit.rig.cameras[camera]->lensModel()},
            {"parameters", std::vector<double>(c.fit.rig.cameras[camera]->lensParameters())},
            {"source", lens.kind == LensSource::FROM_FILE ? "file" : lens.kind == LensSource::FROM_DIRECT ? "direct images"
                                                                                                     : "glass images"},
            {"refined", (c.options.flags & GLASS_FREE_INTRINSICS) != 0 && !isSplined(*c.fit.rig.cameras[camera])}}},
        {"rms_px", {{"glass", glass.px}, {"direct", direct.px}}},
        {"views", {{"glass", glass.views}, {"direct", direct.views}, {"pairs", c.data.countPairs(camera)}}},
        {"corners", {{"glass", glass.points}, {"direct", direct.points}}},
        {"coverage", coverage(c, camera)},
        {"baselines_px", {{"glass_ignored", c.baselines.glassIgnored[camera]},
                          {"glass_ignored_board_fixed", c.baselines.shift[camera]},
                          {"pinhole_through_glass", c.baselines.throughGlass[camera]}}}};
}

Json viewsJson(const RigCalibration& c)
{
    Json views = Json::array();
    for (int i : c.fit.views)
    {
        Json rms = Json::object();
        for (int camera = 0; camera < c.data.cameraCount; camera++)
            for (bool glass : {true, false})
            {
                const Rms image = rmsOf(c, camera, glass, i);
                if (image.points)
                    rms.set((glass ? "glass" : "direct") + std::to_string(camera + 1), image.px);
            }
        views.append({{"name", c.data.views[i].stem}, {"rms_px", rms}});
    }
    return views;
}

Json droppedJson(const RigCalibration& c)
{
    Json list = Json::array();
    for (const Rejected& d : rejectedOf(c))
        list.append({{"view", d.view}, {"image", (d.glass ? "glass" : "direct") + std::to_string(d.camera + 1)},
                     {"points", d.points}, {"whole_image", d.image}, {"why", d.why}});
    return list;
}

//! Null where the user named the lens, or gave it.
Json lensChoiceJson(const LensChoice& choice)
{
    if (choice.scores.empty())
        return nullptr;
    Json candidates = Json::array();
    for (const LensScore& score : choice.scores)
        candidates.append({{"model", score.model}, {"coefficients", score.coefficients}, {"rms_px", score.px}});
    return {{"model", choice.lens().model}, {"coefficients", choice.lens().coefficients}, {"rms_px", choice.lens().px},
            {"held_out", choice.byImages ? "images" : "parts of the target"},
            {"images", choice.direct ? "direct images" : "glass images"}, {"candidates", candidates},
            {"sentence", choice.sentence()}};
}

Json heldOutJson(const HeldOut& h)
{
    if (!h.folds)
        return nullptr;
    return {{"folds", h.folds}, {"views", h.views}, {"views_without_result", h.failed}, {"rms_px", h.px},
            {"rms_px_pinhole_through_glass", h.pinholePx}, {"rms_px_board_from_direct_image", h.transferPx},
            {"error_over_stated", h.covarianceTest.calibrationRatio()}, {"length_rms", h.lengthRms},
            {"length_mean", h.lengthMean}, {"length_rms_pinhole_through_glass", h.pinholeLengthRms}};
}

Json nearFarJson(const NearFar& n)
{
    if (!n.done)
        return nullptr;
    return {{"near_range", Json::array({n.nearRange[0], n.nearRange[1]})}, {"far_range", Json::array({n.farRange[0], n.farRange[1]})},
            {"window_rms_px", {{"near_to_far", n.windowNearToFar}, {"far_to_near", n.windowFarToNear}}},
            {"pinhole_rms_px", {{"near_to_far", n.pinholeNearToFar}, {"far_to_near", n.pinholeFarToNear}}}};
}

Json limitsJson(const Findings& findings)
{
    Json list = Json::array();
    for (const LimitCheck& limit : findings.limits)
        list.append({{"option", limit.option}, {"what", limit.what}, {"limit", limit.limit}, {"value", limit.value},
                     {"unit", limit.unit}, {"met", limit.met()}, {"not_judged", limit.notJudged}});
    return list;
}

Json qualityJson(const Quality& quality, const std::string& placeKey)
{
    return {{placeKey, quality.placeStd}, {"worst_point_error", quality.worstPoint},
            {"calibration_part", quality.calibrationPart}};
}

Json shotsJson(const std::vector<PlannedImage>& shots, const std::string& placeKey)
{
    Json list = Json::array();
    for (const PlannedImage& image : shots)
        list.append({{"image", image.placement}, {"predicted", qualityJson(image.quality, placeKey)}});
    return list;
}

Json givenJson(const RigCalibration& c)
{
    Json list = Json::array();
    for (const SummaryRow& row : givenRows(c))
        list.append({{"what", row.name}, {"value", row.cells[0]}, {"known_to", row.cells[1]}, {"source", row.cells[2]}});
    return list;
}

void addAssessment(Json& json, const RigCalibration& c, const Assessment& a)
{
    const std::string placeKey = isRound(c.fit.rig.cameras[0]->window()) ? "center_std" : "normal_std_deg";
    Json errors = Json::array(), budget = Json::array();
    for (const ErrorMap& map : a.errors)
        errors.append({{"z", map.range}, {"typical", map.median()}, {"below_95_percent", map.percentile95()}, {"worst", map.worst()},
                       {"share_seen", map.seenShare()},
                       {"worst_of_pixel_noise", map.worstPixelNoise()}});
    for (const BudgetRow& row : a.budget)
        budget.append({{"source", row.source}, {"known_to", row.given}, {"effect", row.effect}, {"share", row.share}});
    json.set("point_error", errors);
    json.set("budget", budget);
    json.set("next_images", {{"now", qualityJson(a.advice.now, placeKey)},
                             {"pairs", shotsJson(a.advice.pairs, placeKey)},
                             {"instead_of_the_first", shotsJson(a.advice.instead, placeKey)}});
}

} // namespace

std::string summaryJson(const RigCalibration& c, const Assessment& assessment, const Findings& findings,
                        const std::string& command)
{
    Json notes = Json::object();
    for (const auto& note : c.label.notes)
        notes.set(note.first, note.second);
    Json json = {
        {"verdict", findings.verdict()},
        {"next_step", nextStep(c, assessment, findings)},
        {"limits", limitsJson(findings)},
        {"window_serial", c.label.serial},
        {"notes", notes},
        {"unit", c.unit},
        {"square", c.square},
        {"lens_choice", lensChoiceJson(c.lens)},
        {"held_out", heldOutJson(c.heldOut)},
        {"not_checked", findings.notChecked.empty() ? Json() : Json(findings.notChecked)},
        {"near_far", nearFarJson(c.nearFar)},
        {"fit", {{"rms_px", c.fit.rms}, {"sigma_px", c.fit.sigma}, {"degrees_of_freedom", c.fit.dof}}}};
    Json cameras = Json::array();
    for (int k = 0; k < c.data.cameraCount; k++)
        cameras.append(cameraJson(c, k));
    json.set("cameras", cameras);
    json.set("rig", parameters(estimatedRigParameters(c.fit)));
    json.set("given", givenJson(c));
    addAssessment(json, c, assessment);
    json.set("views", viewsJson(c));
    json.set("images_without_target", c.withoutTarget);
    json.set("left_out", droppedJson(c));
    json.set("findings", {{"contradictions", findings.contradictions}, {"weak", findings.weak},
                          {"cannot_tell", findings.cannotTell}, {"assumed", findings.assumed}});
    json.set("made_by", {{"command", command}, {"refract_version", REFRACT_VERSION}, {"opencv_version", CV_VERSION},
                         {"time", timeOfFiles(c.inputs)}});
    json.roundTo(DIGITS);
    return json.text(1) + '\n';
}

} // namespace tools
