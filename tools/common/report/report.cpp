// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/summary.hpp"
#include "assess/advice.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "report/figures.hpp"
#include "report/report_template.hpp"
#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

std::vector<Json> rowsOf(const std::vector<SummaryRow>& rows)
{
    std::vector<Json> list;
    for (const SummaryRow& row : rows)
    {
        list.push_back({{"name", row.name}, {"cells", pageList(row.cells)}});
    }
    return list;
}

//! What the calibration is worth, on boards that it has not seen.
std::string headline(const RigCalibration& c)
{
    const HeldOut& h = c.heldOut;
    if (!h.folds)
        return format("All %zu corners fit within %.3f px RMS; that is no proof, as nothing was held out.", c.residuals.size(),
                      c.fit.rms);
    if (std::isnan(h.px))
        return format("No board could be held out: without it the other images do not determine the calibration. The %zu corners of "
                      "the fit itself lie within %.3f px RMS, which is no proof.", c.residuals.size(), c.fit.rms);
    std::string text = format("Boards that took no part in it are seen within %.3f px RMS", h.px);
    if (!std::isnan(h.lengthRms))
        text += format("; the distances between their corners, measured in 3-D, are right within %.3g %s RMS", h.lengthRms,
                       c.unit.c_str());
    if (c.nearFar.done && !std::isnan(c.nearFar.windowNearToFar + c.nearFar.pinholeNearToFar))
        text += format(". Calibrated on the near boards alone it predicts the far ones within %.3f px, a pinhole calibrated "
                       "through the glass within %.3f px", c.nearFar.windowNearToFar, c.nearFar.pinholeNearToFar);
    return text + ".";
}

//! Which time it is: pages of the same input are the same, so it is none of their making.
std::string timeText(const RigCalibration& c)
{
    const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::string time = timeOfFiles(c.inputs);             // 2026-11-26T04:31:57Z
    return (epoch && *epoch ? "Time as set by SOURCE_DATE_EPOCH: " : "Newest of its images and files: ") + time.substr(0, 10) + " "
        + time.substr(11, 8) + " UTC";
}

/** The first page on paper has room for so many sentences and rows; the pages after it have all.
@param name of the list in the template; it also gets has_NAME and more_NAME */
void setOnFirstPage(Json& page, const std::string& name, const std::vector<std::string>& sentences, size_t room)
{
    const size_t shown = std::min(room, sentences.size());
    page.set(name, pageList({sentences.begin(), sentences.begin() + shown}));
    page.set("has_" + name, shown > 0);
    page.set("has_more_" + name, sentences.size() > shown);
    page.set("more_" + name, std::to_string(sentences.size() - shown));
}

//! For a picture, and for what is no reason of the verdict.
bool hasRoom(const Findings& f)
{
    const size_t FEW = 4;
    return f.contradictions.size() + f.weak.size() + f.limits.size() <= FEW;
}

void setFirstPage(Json& page, const RigCalibration& c, const Assessment& a, const Findings& f)
{
    const size_t CONTRADICTIONS = 3, WEAK = 5, GIVEN = 14, CANNOT_TELL = 4;
    setOnFirstPage(page, "first_page_contradictions", f.contradictions, CONTRADICTIONS);
    setOnFirstPage(page, "first_page_weak", f.weak, WEAK);
    setOnFirstPage(page, "first_page_cannot_tell", f.cannotTell, hasRoom(f) ? CANNOT_TELL : 0);
    std::vector<SummaryRow> given = givenRows(c);
    page.set("has_more_given", given.size() > GIVEN);
    given.resize(std::min(GIVEN, given.size()));
    page.set("first_page_given", rowsOf(given));
    page.set("next_step", nextStep(c, a, f));
}

//! Where a window is, and what that does.
std::string windowSentence(const RigCalibration& c, int k)
{
    const GlassWindow window = c.fit.rig.cameras[k]->window();
    const std::string which = format("%sThe %s", k ? " " : "", nameOfShape(window)) + ofCamera(k, c.data.cameraCount);
    if (const std::optional<RoundWindow> round = roundWindowOf(c, k))
        return which + (round->shape == "dome" ? " has its centre " : " has its axis ") + round->offsetWords(c.unit)
            + (round->shape == "dome" ? "; in its centre it would not refract." : ".");
    const double tilt = tiltDegrees(window);
    return which + format(" is tilted by %.2f°, known to ±%.2g°.", tilt, tiltStdDegrees(c.fit, k));
}

//! "a camera behind a flat window", "2 cameras behind 2 flat windows", "3 cameras in a dome".
std::string subjectOf(const RigCalibration& c)
{
    const GlassWindow window = c.fit.rig.cameras[0]->window();
    int windows = 0;
    for (int k = 0; k < c.data.cameraCount; k++)
        windows += c.fit.rig.ownsWindow(k);
    const std::string shape = (window.shape == WINDOW_FLAT ? "flat " : "") + std::string(nameOfShape(window));
    return (c.data.cameraCount == 1 ? std::string("a camera") : format("%d cameras", c.data.cameraCount))
        + (isRound(window) ? " in " : " behind ") + (windows == 1 ? "a " + shape : format("%d ", windows) + shape + "s");
}

//! Verdict in plain words: the class colours the card.
void setVerdict(Json& page, const RigCalibration& c, const Findings& f)
{
    page.set("verdict", f.verdict());
    page.set("verdict_class", f.tone() == Tone::BAD ? "bad" : f.tone() == Tone::GOOD ? "good" : "weak");
    const int FEW = 2;                  // of more cameras a window is told once
    std::string windows;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        if (c.data.cameraCount > FEW && !c.fit.rig.ownsWindow(k))
            continue;
        windows += windowSentence(c, k);
    }
    const GlassWindow window = c.fit.rig.cameras[0]->window();
    page.set("subject", subjectOf(c));
    page.set("place_heading", isRound(window) ? "centre ±, " + c.unit : std::string("normal ±, °"));
    page.set("place_note", isRound(window) ? "The centre is seen from the camera" : "The normal points from the camera to the scene");
    page.set("headline", headline(c));
    page.set("windows", windows);
    std::vector<Json> limits;
    for (const LimitCheck& limit : f.limits)
    {
        limits.push_back({{"mark", limit.met() ? "✓" : "✗"}, {"class", limit.met() ? "met" : "missed"},
                          {"text", limit.sentence()}});
    }
    page.set("limits", limits);
    page.set("time", timeText(c));
    page.set("serial", c.label.serial);
    page.set("has_serial", !c.label.serial.empty());
    std::vector<Json> notes;
    for (const auto& note : c.label.notes)
    {
        notes.push_back({{"key", note.first}, {"text", note.second}});
    }
    page.set("notes", notes);
}

//! Parameters with their standard deviations, and their correlations as coloured cells.
void setParameters(Json& page, const Fit& fit)
{
    const std::vector<EstimatedParameter> window = estimatedWindowParameters(fit);
    std::vector<EstimatedParameter> all = window;
    const std::vector<EstimatedParameter> rig = estimatedRigParameters(fit);
    all.insert(all.end(), rig.begin(), rig.end());
    std::vector<Json> parameters, correlations, heads;
    for (const EstimatedParameter& p : all)
    {
        const int decimals = decimalsOf(p.std);
        parameters.push_back({{"name", p.name}, {"value", rounded(p.value, decimals)}, {"std", rounded(p.std, decimals)}});
    }
    for (const EstimatedParameter& p : window)
    {
        Json entry = Json::object();
        std::vector<Json> cells;
        entry.set("name", p.name);
        for (const EstimatedParameter& q : window)
        {
            const double r = fit.covariance.at<double>(p.column, q.column)/(p.std*q.std);
            cells.push_back({{"value", format("%.2f", std::round(100.*r)/100. + 0.)},           // no minus before 0.00
                             {"colour", format(r < 0 ? "rgba(2,132,199,%.2f)" : "rgba(220,38,38,%.2f)", 0.6*std::abs(r))}});
        }
        entry.set("cells", cells);
        correlations.push_back(entry);
        heads.push_back({{"name", p.name}});
    }
    page.set("parameters", parameters);
    page.set("correlations", correlations);
    page.set("correlation_heads", heads);
    const size_t BESIDE = 7;                // columns that half of the page has place for
    page.set("many_correlations", window.size() > BESIDE);
}

void setTable(Json& page, const std::string& name, const std::vector<SummaryRow>& rows)
{
    page.set(name, rowsOf(rows));
    page.set("has_" + name, !rows.empty());
}

//! Views by cameras: how many points each saw through its window, coloured by their share.
void setSightings(Json& page, const RigCalibration& c)
{
    std::vector<Json> rows;
    std::vector<int> pointsSeenBy(c.data.cameraCount + 1);
    for (int i : c.fit.views)
    {
        const View& view = c.data.views[i];
        std::vector<int> seenBy(view.objectPoints.size());
        std::vector<Json> cells;
        for (int k = 0; k < c.data.cameraCount; k++)
        {
            int count = 0;
            for (size_t p = 0; p < view.glass[k].size(); p++)
                if (seen(view.glass[k][p]))
                {
                    count++;
                    seenBy[p]++;
                }
            const int direct = (int)std::count_if(view.direct[k].begin(), view.direct[k].end(), seen);
            cells.push_back({{"value", (count ? std::to_string(count) : std::string(direct ? "" : "-"))
                                       + (direct ? format("%s%d direct", count ? " + " : "", direct) : "")},
                             {"colour", format("rgba(2,132,199,%.2f)", 0.5*count/(double)view.objectPoints.size())}});
        }
        for (int count : seenBy)
            pointsSeenBy[count]++;
        rows.push_back({{"name", view.stem}, {"cells", cells}});
    }
    std::string note;
    for (int count = 1; count <= c.data.cameraCount; count++)
        if (pointsSeenBy[count])
            note += (note.empty() ? "Points seen through the windows by " : "; by ") + format("%d camera%s: %d", count,
                    count == 1 ? "" : "s", pointsSeenBy[count]);
    page.set("observations", rows);
    page.set("sightings_note", note + ".");
}

void setPhotos(Json& page, const RigCalibration& c, const std::vector<Photo>& photos, Progress& progress)
{
    std::vector<Json> list, scale;
    for (const Photo& photo : photos)
    {
        const Thumbnail thumbnail = makeThumbnail(c, photo);
        list.push_back({{"uri", thumbnail.uri}, {"caption", thumbnail.caption}, {"class", thumbnail.suspect ? "suspect" : ""}});
        progress.step();
    }
    for (const PhotoScale& step : photoScale(c))
    {
        scale.push_back({{"colour", step.colour}, {"name", step.name}});
    }
    page.set("photos", list);
    page.set("photo_scale", scale);
    page.set("has_photos", !photos.empty());
    page.set("photo_count", std::to_string(photos.size()));
    const size_t hidden = c.photos.size() - photos.size();
    page.set("has_hidden_photos", hidden > 0);
    page.set("hidden_photos", format("%zu more images are not shown: all their points were used, and lie nearer.", hidden));
}

} // namespace

std::string makeReport(const RigCalibration& c, const Assessment& assessment, const Findings& findings,
                       const std::string& commandLine, bool quiet)
{
    Json page = Json::object();
    setVerdict(page, c, findings);
    setFirstPage(page, c, assessment, findings);
    page.set("given", rowsOf(givenRows(c)));
    page.set("contradictions", pageList(findings.contradictions));
    page.set("weak", pageList(findings.weak));
    page.set("cannot_tell", pageList(findings.cannotTell));
    page.set("assumed", pageList(findings.assumed));
    page.set("without_target", pageList(c.withoutTarget));
    page.set("has_without_target", !c.withoutTarget.empty());

    std::vector<std::string> rejected;
    for (const Rejected& d : rejectedOf(c))
        rejected.push_back(d.sentence());
    page.set("rejected", pageList(rejected));
    page.set("has_rejected", !rejected.empty());
    page.set("stereo", c.data.cameraCount > 1);
    page.set("fold_cameras", c.data.cameraCount > 2);
    page.set("few_cameras", c.data.cameraCount <= 2);
    page.set("window_rows", rowsOf(windowRows(c)));
    page.set("fit_rows", rowsOf(fitRows(c)));
    page.set("has_lens_choice", !c.lens.scores.empty());
    if (!c.lens.scores.empty())
        page.set("lens_choice", c.lens.sentence());
    setTable(page, "held_out", heldOutRows(c));
    setTable(page, "point_errors", pointErrorRows(c, assessment));
    setTable(page, "budget", budgetRows(assessment));
    setTable(page, "advice", assessment.advice.pairs.empty() ? std::vector<SummaryRow>() : adviceRows(assessment.advice));
    page.set("point_error_note", pointErrorNote(c, assessment));
    page.set("unit", c.unit);
    setParameters(page, c.fit);

    const bool isRig = c.data.cameraCount > 1;
    const std::vector<Photo> photos = photosToShow(c);
    Progress progress("drawing the report", (c.influences.empty() ? 5 : 6)*c.data.cameraCount + (isRig ? 2 : 0)
                                             + (int)(assessment.errors.size() + photos.size()) + 1, quiet);
    std::vector<Json> onFirstPage, after;
    (hasRoom(findings) ? onFirstPage : after).push_back(errorOverRange(c, assessment, progress));
    addErrorMaps(after, c, assessment, progress);
    page.set("first_page_figures", onFirstPage);
    page.set("error_figures", after);
    if (isRig)
    {
        page.set("rig_figures", rigFigures(c, progress));
        setSightings(page, c);
    }
    std::vector<Json> cameras, heads;
    for (int k = 0; k < c.data.cameraCount; k++)
    {
        const std::string name = c.data.cameraCount == 1 ? "Camera" : format("Camera %d", k + 1);
        cameras.push_back({{"name", name}, {"figures", figuresOf(c, k, progress)}});
        heads.push_back({{"name", name}});
    }
    page.set("cameras", cameras);
    setPhotos(page, c, photos, progress);
    page.set("camera_heads", heads);

    page.set("command", commandLine);
    page.set("version", REFRACT_VERSION);
    page.set("opencv_version", CV_VERSION);

    return renderPage("the report", REPORT_TEMPLATE, page);
}

} // namespace tools
