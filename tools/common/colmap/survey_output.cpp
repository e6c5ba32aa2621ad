// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/survey_output.hpp"
#include "bundle/bundle_output.hpp"
#include "bundle/mistaken_matches.hpp"
#include "console/csv.hpp"
#include "console/json.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "math/rotation.hpp"
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <sstream>

using namespace cv;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

Vec3d medianStd(const std::vector<Vec3d>& stds)
{
    Vec3d medians;
    for (int k = 0; k < 3; k++)
    {
        std::vector<double> of;
        for (const Vec3d& std : stds)
            if (!std::isnan(std[k]))
                of.push_back(std[k]);
        medians[k] = median(of);
    }
    return medians;
}

void putVector(std::ostream& csv, const Vec3d& v) { putNumbers(csv, {v[0], v[1], v[2]}); }

Vec3d stdsOf(const Matx33d& covariance)
{
    return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

//! Scene with its origin -> camera 1.
RigidTransform placed(const SurveyResult& result, int view)
{
    const RigidTransform pose = result.adjustment.poseOf(view);
    return {pose.R, pose.t - pose.R*result.start.origin};
}

//! Of its translation: T of the fit less R of the origin, which turns with the pose.
Matx33d placedCovariance(const SurveyResult& result, int view)
{
    const refract::Rotation rotation(result.adjustment.rvecs[view].val);
    Matx<double, 3, 6> J;
    hconcat(rotation.derivativeOf(-result.start.origin), Matx33d::eye(), J);
    return J*Matx66d(result.adjustment.viewCovariances[view].ptr<double>())*J.t();
}

std::vector<std::string> withoutAnswer(const SurveyResult& result)
{
    std::vector<std::string> ids;
    for (size_t i = 0; i < result.survey.model.points.size(); i++)
        if (result.adjustment.bundle.status[i])
            ids.push_back(std::to_string(result.survey.model.points[i].id));
    return ids;
}

//! Of the places of camera 1.
Vec3d medianPlaceStd(const SurveyAdjustment& adjustment)
{
    std::vector<Vec3d> stds;
    for (size_t view = 0; view < adjustment.rvecs.size(); view++)
        stds.push_back(stdsOf(adjustment.centreCovariance((int)view)));
    return medianStd(stds);
}

//! The calibration's rig in the model's place: one, and a frame of each view.
void addRig(const SurveyResult& result, ColmapModel& model)
{
    const RigModel& rig = result.adjustment.bundle.fit.rig;
    ColmapRig own;
    own.id = 1;
    for (size_t c = 0; c < rig.cameras.size(); c++)
        own.sensors.push_back({COLMAP_CAMERA, (uint32_t)c + 1, (uint8_t)(c > 0), colmapPoseOf(rig.extrinsics[c])});
    model.rigs = {own};
    model.frames.clear();
    std::vector<int> frameOf(result.survey.views.size(), -1);
    for (size_t view = 0; view < result.survey.views.size(); view++)
        if (result.adjustment.hasPose((int)view))
        {
            frameOf[view] = (int)model.frames.size();
            model.frames.push_back({(uint32_t)view + 1, 1, colmapPoseOf(result.adjustment.poseOf((int)view)), {}});
        }
    for (size_t i = 0; i < result.survey.viewOf.size(); i++)
        if (result.survey.viewOf[i] >= 0)
            model.frames[frameOf[result.survey.viewOf[i]]].data.push_back({COLMAP_CAMERA, (uint32_t)result.survey.cameraOf[i] + 1,
                                                                  model.images[i].id});
}

//! Which pixel of which image is of which point, of what is used and known well enough to be told by a model without +-.
void addSights(const SurveyResult& result, ColmapModel& model)
{
    for (size_t k = 0; k < result.adjustment.used.size(); k++)
    {
        const int index = result.survey.observations[k][2];
        if (!result.adjustment.used[k] || result.adjustment.isVague[index])
            continue;
        ColmapImage& image = model.images[result.survey.sources[k][0]];
        ColmapPoint& point = model.points[index];
        image.pixels[result.survey.sources[k][1]].point = point.id;
        point.track.push_back({image.id, (uint32_t)result.survey.sources[k][1]});
        point.error += result.adjustment.errors[k];
    }
    for (ColmapPoint& point : model.points)
        if (!point.track.empty())
            point.error /= (double)point.track.size();
}

//! Points that nothing shows, images without a pose.
void leaveOut(const SurveyResult& result, ColmapModel& model)
{
    const auto isUnseen = [](const ColmapPoint& point) { return point.track.empty(); };
    model.points.erase(std::remove_if(model.points.begin(), model.points.end(), isUnseen), model.points.end());
    size_t kept = 0;
    for (size_t i = 0; i < model.images.size(); i++)
        if (result.survey.viewOf[i] >= 0 && kept++ != i)
            model.images[kept - 1] = std::move(model.images[i]);
    model.images.resize(kept);
}

const double VAGUE = 0.1;       // of a scale that the window alone tells: what it is told beforehand has no say up to here

} // namespace

//! Of each camera, by the points that it sees.
static std::vector<NearestPinhole> pinholesOf(const Survey& survey, const SurveyAdjustment& adjustment)
{
    const RigModel& rig = adjustment.bundle.fit.rig;
    std::vector<std::vector<Point3d>> seen(rig.cameras.size());
    for (size_t i = 0; i < survey.observations.size(); i++)
    {
        const Vec3i& o = survey.observations[i];
        if (adjustment.used[i])
            seen[o[1]].push_back(Point3d((rig.extrinsics[o[1]]*adjustment.poseOf(o[0])).apply(Vec3d(adjustment.bundle.points[o[2]]))));
    }
    std::vector<NearestPinhole> pinholes;
    for (size_t c = 0; c < seen.size(); c++)
        pinholes.push_back(nearestPinhole(rig.cameras[c], seen[c]));
    return pinholes;
}

//! "the window alone, +- 2.1 %"
static std::string scaleText(const SurveyStart& start, const SurveyAdjustment& adjustment)
{
    return start.scale + (std::isfinite(adjustment.scaleStd) ? format(", +- %.2g %%", 100.*adjustment.scaleStd) : "");
}

std::string originText(const SurveyStart& start)
{
    return format("%.12g, %.12g, %.12g", start.origin[0], start.origin[1], start.origin[2]);
}

std::string surveyPointsCsv(const SurveyResult& result)
{
    std::ostringstream csv;
    csv.precision(12);
    csv << "id,x,y,z,sx,sy,sz,images,angle_deg,status\n";
    for (size_t i = 0; i < result.survey.model.points.size(); i++)
    {
        csv << result.survey.model.points[i].id;
        putVector(csv, Vec3d(result.adjustment.bundle.points[i]) + result.start.origin);
        putVector(csv, result.adjustment.bundle.sigma[i]);
        csv << ',' << result.adjustment.images[i] << ',';
        std::isnan(result.adjustment.angles[i]) ? csv << "nan" : csv << format("%.4g", result.adjustment.angles[i]);
        csv << ',' << (int)result.adjustment.bundle.status[i] << '\n';
    }
    return csv.str();
}

std::string surveyPosesCsv(const SurveyResult& result)
{
    std::ostringstream csv;
    csv.precision(12);
    csv << "view,rx_deg,ry_deg,rz_deg,tx,ty,tz,srx_deg,sry_deg,srz_deg,stx,sty,stz,cx,cy,cz,scx,scy,scz\n";
    for (size_t view = 0; view < result.survey.views.size(); view++)
    {
        const RigidTransform pose = placed(result, (int)view);
        const Matx66d covariance(result.adjustment.viewCovariances[view].ptr<double>());
        csv << cellOf(result.survey.views[view]);
        putVector(csv, result.adjustment.rvecs[view]*DEGREES);
        putVector(csv, pose.t);
        putVector(csv, stdsOf(covariance.get_minor<3, 3>(0, 0))*DEGREES);
        putVector(csv, stdsOf(placedCovariance(result, (int)view)));
        putVector(csv, pose.inverse(Vec3d()));
        putVector(csv, stdsOf(result.adjustment.centreCovariance((int)view)));
        csv << '\n';
    }
    return csv.str();
}

ColmapModel refractedModel(SurveyResult& result)
{
    const SurveyAdjustment& adjustment = result.adjustment;
    ColmapModel model = std::move(result.survey.model);
    model.cameras.clear();
    for (size_t c = 0; c < result.pinholes.size(); c++)
        model.cameras.push_back(colmapCameraOf(*result.pinholes[c].camera, (uint32_t)c + 1));
    addRig(result, model);
    for (size_t i = 0; i < model.images.size(); i++)
    {
        if (result.survey.viewOf[i] < 0)
            continue;
        const int camera = result.survey.cameraOf[i];
        model.images[i].camera = (uint32_t)camera + 1;
        model.images[i].cam_from_world = colmapPoseOf(adjustment.bundle.fit.rig.extrinsics[camera]
                                                      *adjustment.poseOf(result.survey.viewOf[i]));
        for (ColmapPixel& pixel : model.images[i].pixels)
            pixel.point = NO_COLMAP_POINT;
    }
    for (size_t i = 0; i < model.points.size(); i++)
    {
        model.points[i].X = adjustment.bundle.points[i];
        model.points[i].track.clear();
        model.points[i].error = 0.;
    }
    addSights(result, model);
    leaveOut(result, model);
    return model;
}

static std::vector<std::string> imagesLeftOut(const Survey& survey, bool withReasons)
{
    std::vector<std::string> texts;
    for (const LeftOutImage& image : survey.leftOut)
        texts.push_back(image.name + (withReasons ? " (" + image.reason + ")" : ""));
    return texts;
}

std::string surveyJson(const SurveyResult& result, const std::string& command)
{
    Json json = adjustmentJson(result.adjustment.bundle, result.findings, command, result.unit);
    json.set("scale_std", result.adjustment.scaleStd);
    json.set("points_in_known_views", result.adjustment.arePointsAlone);
    json.set("colmap_origin", std::vector<double>(result.start.origin.val, result.start.origin.val + 3));
    json.set("images", result.survey.imageCount());
    json.set("images_left_out", imagesLeftOut(result.survey, false));
    json.set("views", result.survey.views.size());
    json.set("left_out", withoutAnswer(result));
    json.set("points_with_large_std", result.adjustment.largeErrors);
    const Vec3d ofPoints = medianStd(result.adjustment.bundle.sigma), ofPlaces = medianPlaceStd(result.adjustment);
    json.set("median_point_std", std::vector<double>(ofPoints.val, ofPoints.val + 3));
    json.set("median_position_std", std::vector<double>(ofPlaces.val, ofPlaces.val + 3));
    Json pinholes = Json::array();
    for (const NearestPinhole& pinhole : result.pinholes)
        pinholes.append({{"rms", pinhole.rms}, {"max", pinhole.max}});
    json.set("nearest_pinholes_px", pinholes);
    return json.text(2) + "\n";
}

void printSurvey(std::ostream& out, const SurveyResult& result)
{
    const SurveyAdjustment& adjustment = result.adjustment;
    const Fit& fit = adjustment.bundle.fit;
    out << result.findings.verdict()
        << format(": %.3g px RMS, noise %.3g px a coordinate, %.0f degrees of freedom\n", fit.rms, fit.sigma, fit.dof);
    out << fittedLine("scale: ", {result.findings.scale}) << "\n";
    if (norm(result.start.origin) > 0)
        out << "the model for COLMAP is less the origin " << originText(result.start) << "\n";
    printCorrections(out, result.findings, result.unit);
    const Vec3d places = medianPlaceStd(adjustment), points = medianStd(adjustment.bundle.sigma);
    out << format("%d images, x, y, z +- ", result.survey.imageCount())
        << (adjustment.arePointsAlone ? "not found (--memory)\n"
                                      : format("%.2g, %.2g, %.2g (median)\n", places[0], places[1], places[2]));
    out << format("%d of %zu points, x, y, z +- %.2g, %.2g, %.2g (median)", adjustment.bundle.answers(), adjustment.bundle.points.size(),
                  points[0], points[1], points[2])
        << (adjustment.arePointsAlone ? " if views were known" : "")
        << (adjustment.largeErrors ? format("; %d hardly known", adjustment.largeErrors) : "") << "\n";
    const std::vector<std::string> lost = withoutAnswer(result);
    if (adjustment.bundle.usedPixels < adjustment.bundle.seenPixels)
        out << fittedLine(format("pixels left out: %d of %d", adjustment.bundle.seenPixels - adjustment.bundle.usedPixels,
                                 adjustment.bundle.seenPixels) + (lost.empty() ? "" : "; points: "), lost) << "\n";
    if (!result.survey.leftOut.empty())
        out << fittedLine("images left out: ", imagesLeftOut(result.survey, true)) << "\n";
    const auto isBetter = [](const NearestPinhole& a, const NearestPinhole& b) { return a.rms < b.rms; };
    const auto worst = std::max_element(result.pinholes.begin(), result.pinholes.end(), isBetter);
    out << format("a pinhole in place of the window is off by %.2g px RMS, %.2g px at most\n", worst->rms, worst->max);
    if (!result.findings.weak.empty())
        out << fittedLine("hardly determined: ", result.findings.weak) << "\n";
}

static const double NO_MEMORY = 1e-9;           // GB: no +- of views are needed

//! What has no answer starts where it did.
static void startAt(const SurveyAdjustment& found, SurveyStart& start)
{
    for (size_t i = 0; i < start.points.size(); i++)
        if (std::isfinite(found.bundle.points[i].x))
            start.points[i] = found.bundle.points[i];
    for (int view = 0; view < (int)start.rvecs.size(); view++)
        if (found.hasPose(view))
        {
            start.rvecs[view] = found.rvecs[view];
            start.tvecs[view] = found.tvecs[view];
        }
}

//! @param pixels all that are seen; the survey of the result keeps those that are adjusted
static MeasuredBundle measuredBundle(const SurveyOptions& options, const BundleStart& start, const std::vector<Point2d>& pixels, bool quiet,
                                     SurveyResult& result)
{
    MeasuredBundle measured;
    measured.measures = {result.start.lengths, result.start.positions};
    measured.lengthsPath = options.lengths;
    measured.positionsPath = options.positions;
    measured.points.resize(1);
    for (const Vec3i& observation : result.survey.observations)
        measured.points[0].push_back(observation[2]);
    const auto from = std::make_shared<SurveyStart>(result.start);
    measured.adjust = [&, quiet, from](const Measures& measures, const std::vector<std::vector<uchar>>* only) {
        from->lengths = measures.lengths;
        from->positions = measures.positions;
        result.survey.pixels = pixels;
        for (size_t i = 0; only && i < pixels.size(); i++)
            if (!(*only)[0][i])
                result.survey.pixels[i] = Point2d(NAN, NAN);
        const SurveyAdjustment found = adjustSurvey(result.survey, start, *from, !only && options.robust, NO_MEMORY, quiet);
        if (!only)
            startAt(found, *from);              // what comes after is near it
        return found.bundle;
    };
    return measured;
}

static std::string wrongOf(const SurveyOptions& options, const BundleStart& start, bool quiet, SurveyResult& result)
{
    SurveyOptions robustly = options;
    robustly.robust = true;
    const std::vector<Point2d> pixels = result.survey.pixels;
    const MeasuredBundle measured = measuredBundle(robustly, start, pixels, quiet, result);
    const auto adjustRobustly = [&](const BundleStart& from) {
        return adjustSurvey(result.survey, from, result.start, true, NO_MEMORY, quiet).bundle; };
    const std::string mistake =
        wrongMatches(start, result.start.lengths, adjustRobustly, result.start.isScaleOfWindow ? nullptr : &measured,
                     result.adjustment.bundle.fit.sigma, options.pixelSigma,
                     [&](int point) { return "point " + std::to_string(result.survey.model.points[point].id); });
    result.survey.pixels = pixels;
    return mistake;
}

SurveyResult adjustColmap(const SurveyOptions& options, const BundleStart& start, const std::string& unit, bool quiet)
{
    SurveyResult result;
    result.unit = unit;
    result.survey = surveyOf(readColmapModel(options.model), start.rig, options.images, options.model);
    result.start = startSurvey(result.survey, start, options.lengths, options.positions, options.model, quiet);
    const auto adjusted = [&](const BundleStart& from) {
        return adjustSurvey(result.survey, from, result.start, options.robust, options.memory, quiet); };
    result.adjustment = adjusted(start);
    for (int view = 0; view < (int)result.survey.views.size(); view++)
        if (!result.adjustment.hasPose(view))
            result.survey.leaveOut(view);
    const auto bundle = [&](const BundleStart& from) { return adjusted(from).bundle; };
    const std::vector<Point2d> pixels = result.survey.pixels;
    const MeasuredBundle measured = measuredBundle(options, start, pixels, quiet, result);
    result.findings = findingsOf(start, result.start.lengths, result.adjustment.bundle, bundle, options.pixelSigma, options.maxRms,
                                 result.start.isScaleOfWindow ? nullptr : &measured);
    result.survey.pixels = pixels;
    const std::string mistake = options.robust ? "" : wrongOf(options, start, quiet, result);
    if (mistake.empty())
        checkPlaces(start, bundle, result.findings);
    else
        result.findings.contradictions = {mistake};
    result.findings.scale = scaleText(result.start, result.adjustment);
    if (result.start.isScaleOfWindow && !(result.adjustment.scaleStd <= VAGUE))
        result.findings.weak.insert(result.findings.weak.begin(), "the scale, which the window alone tells: give --lengths or --positions");
    result.pinholes = pinholesOf(result.survey, result.adjustment);
    return result;
}

} // namespace tools
