// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_output.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "history/drift.hpp"
#include "measure/measurement.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

using namespace cv::refract;

namespace tools {

namespace {

// Of an unmoved target's images no two have the same noise; a hundredth of a pixel is kept of each.
const double IDENTICAL = 0.008;

//! Waits for another check of this history; its file, FILE.lock, goes with the last of them. Throws Failure if the other takes too long.
std::unique_ptr<FileLock> lockOf(const std::string& history)
{
    const int SECONDS = 300, TRIES_A_SECOND = 10;
    for (int i = 0; i < SECONDS*TRIES_A_SECOND; i++)
    {
        if (std::unique_ptr<FileLock> lock = FileLock::tryOnce(history + ".lock", history))
            return lock;
        std::this_thread::sleep_for(std::chrono::milliseconds(1000/TRIES_A_SECOND));
    }
    throw Failure("another check has kept '" + history + "' for " + std::to_string(SECONDS/60) + " minutes: wait for it, or end it");
}

//! How many times as many images would show the tilt, or 0 if no number would.
int imagesNeeded(const WindowCheck& window, const CheckResult& result, double degrees)
{
    for (int n = 2; n <= 10000; n++)
        if (powerOf(window, result, degrees, 1./n) >= CERTAIN_POWER)
            return n;
    return 0;
}

//! The least tilt that would show, to one digit.
double tiltThatShows(const WindowCheck& window, const CheckResult& result)
{
    const double CEILING = 90.;
    for (double decade = 1e-4; decade < CEILING; decade *= 10.)
        for (int digit = 1; digit < 10; digit++)
            if (powerOf(window, result, digit*decade) >= CERTAIN_POWER)
                return digit*decade;
    return 0.;
}

//! --detect of a centre, as a length.
std::string detected(const WindowCheck& window, const CheckOptions& o)
{
    return format("%.3g (%g deg, as seen from a radius away)", o.detect*window.lengthPerDegree, o.detect);
}

//! Empty, or why a scene does not tell.
std::string whyNotOfScene(const CheckResult& result, const CheckOptions& o)
{
    if (result.changed)
        return "";
    const std::string more = "give images of more, and more textured, things, near and far, in the corners too, at more moments";
    if (result.turns.empty())
        return "the images do not tell how the cameras stand to each other: " + more;
    for (const TurnCheck& turn : result.turns)
        if (powerOf(turn, result, o.detect) < CERTAIN_POWER && !o.hasHistory())
            return format("camera %d: these images would show a turn by %g deg with a probability of only %.0f %%, so 'unchanged' cannot "
                          "be said; ", turn.camera + 1, o.detect, 100.*powerOf(turn, result, o.detect)) + more + ", or ask for a larger "
                "--detect";
    return "";
}

const size_t SCREEN = 80;               // columns

Json jsonOf(const NamedChange& change)
{
    Json value = Json::array(), std = Json::array(), unit = Json::array(), axes = Json::array();
    for (const ChangedValue& changed : change.values)
    {
        value.append(changed.value);
        std.append(changed.std);
        unit.append(changed.unit);
        for (const ValueAboutAxis& about : changed.aboutAxes)
            axes.append({{"axis", about.axis}, {"value", about.value}, {"std", about.std}});
    }
    return {{"name", change.name}, {"camera", change.camera >= 0 ? Json(change.camera + 1) : Json()}, {"value", value}, {"std", std},
            {"unit", unit}, {"about_axes", axes}, {"p", change.probability}, {"text", change.sentence}};
}

//! What is not to be told is nan, which is null in the file.
Json jsonOf(const WindowCheck& w, double power)
{
    Json json = {{"camera", w.camera + 1}, {"moved", w.moved}};
    if (w.lengthPerDegree > 0.)
    {
        json.set("center_moved_by", w.lengthPerDegree*w.tiltDeg);
        json.set("center_std", Json::array({w.lengthPerDegree*w.stdDeg[0], w.lengthPerDegree*w.stdDeg[1]}));
        json.set("center", Json::array({w.center[0], w.center[1], w.center[2]}));
    }
    else
    {
        json.set("tilt_deg", w.tiltDeg);
        json.set("tilt_std_deg", Json::array({w.stdDeg[0], w.stdDeg[1]}));
        json.set("normal", Json::array({w.normal[0], w.normal[1], w.normal[2]}));
    }
    json.set("probability_if_unchanged", w.probability);
    json.set("detection_probability", power);
    return json;
}

void printLines(const std::string& text)
{
    for (const std::string& line : brokenInto(text, SCREEN, "", LongWords::WHOLE))
        std::cout << line << '\n';
}

void printCause(const CheckResult& result)
{
    if (result.changes.empty())
        printLines("No single change explains the new images: were camera, window, board or the order of the images others?");
    else
        printLines(causesIn(result) + (!result.explained ? "." : result.changes.size() == 1 ? "; nothing else" : ""));
    if (!result.changes.empty() && !result.explained)
        printLines("This does not explain all: more than one thing changed, or one that is not in the list (--help). "
                   + format("What is left is %.3g px, the noise %.3g px.", result.sigmaSeen, result.sigma));
    std::cout << '\n';
}

void printTurns(const CheckResult& result, const CheckOptions& o)
{
    Table table({"", "+- deg (worst axis)", "chance if unchanged", format("would show %g deg", o.detect)}, SCREEN);
    for (const TurnCheck& turn : result.turns)
        table.add({turn.name.substr(0, turn.name.rfind(" changed")), format("%.2g", turn.stdDeg), format("%.2g", turn.probability),
                   format("%.1f %%", 100.*powerOf(turn, result, o.detect))});
    if (!result.turns.empty())
        table.print(std::cout);
    std::cout << '\n';
}

//! Of how many matches, and what these cannot tell.
void printScene(const SceneMatches& matches, bool isPair)
{
    std::cout << '\n';
    printLines(format("%d matches of %d moment%s; %d more left out as no point explains them, about %.0f wrong ones among the "
                      "rest.", matches.good.size(), matches.moments, matches.moments == 1 ? "" : "s", matches.leftOut, matches.wrongLeft));
    printLines(std::string("No scene shows a turn of the whole rig, or another scale")
               + (isPair ? ", or which of two cameras turned about the line between them." : "."));
}

} // namespace

KeptCheck::KeptCheck(const CheckOptions& options, const Calibration& calibration)
    : options_(options), calibration_(calibration), lock_(lockOf(options.history)), history_(readHistory(options.history))
{
    Plot::checkAvailable("--history");
    requireSameRig(history_, options.history, calibration, options.calibration);
    covariance_ = toEigen(withWedges(checkInputOf(calibration, options.calibration, options.sigma)).covariance);
    if (!options.date.empty())
        requirePast(options.date, "--date");
    time_ = options.date.empty() ? timeOfNow() : parseTime(options.date, "--date");
}

void KeptCheck::requireNewImages(const CheckImages& images)
{
    const double tolerance = options_.fixedTarget ? IDENTICAL : sameImageTolerance(pixelSigmaOf(calibration_));
    record_ = recordOf({{}, VectorXd(), MatrixXd(), MatrixXd()}, images.files, time_, history_, images.shown);
    requireNotCalibrated(record_, calibration_, tolerance);
    requireNew(history_, options_.history, record_, tolerance);
}

void KeptCheck::add(const CheckResult& check, const CheckInput& input, const CheckImages& images, const std::string& verdict)
{
    record_ = recordOf(check.charted, images.files, time_, history_, images.shown);
    record_.verdict = verdict;
    record_.sigma = check.sigma;
    record_.dof = check.dof;
    if (options_.conditions.isSaid())     // the day's index is no error of the calibration
        for (int c = 0; c < (int)input.rig.cameras.size(); c++)
            record_.byParameters.col(columnsOf(withWedges(input).rig, c).outerIndex).setZero();
    history_.checks.push_back(record_);
    result_ = chartHistory(history_, covariance_, (1. - SHARE_OF_CHECK)*options_.falseAlarm);
}

void KeptCheck::write(const std::string& verdict, bool isGood, const std::string& unseen) const
{
    const std::string page = historyPage(history_, result_, covariance_,
                                         {options_.calibration, options_.falseAlarm, verdict, isGood, unseen});
    writeText(options_.pageFile(), page);
    writeHistory(options_.history, history_);
}

void KeptCheck::print() const
{
    const std::vector<std::string> beyond = result_.chartsBeyond(history_);
    std::cout << format("\nHistory of %zu check%s since %s: ", history_.checks.size(), history_.checks.size() == 1 ? "" : "s",
                        history_.checks[0].time.substr(0, 10).c_str())
              << (beyond.empty() ? "all charts are within their limits" : "beyond the limit: " + listed(beyond)) << '\n';
    if (!result_.causes.empty())
        std::cout << "What explains all checks best: " << causesIn(result_, history_) << '\n';
    std::cout << "Charts: " << options_.pageFile() << '\n';
}

Json KeptCheck::json() const
{
    return {{"checks", history_.checks.size()}, {"broken", history_.broken}, {"alarm", isAlarm()},
            {"beyond", result_.chartsBeyond(history_)},
            {"causes", causesIn(result_, history_)}, {"t2", result_.points.back().t2}, {"t2_limit", result_.points.back().limitT2},
            {"ewma_limit", result_.points.back().limit}};
}

std::string whyNot(const CheckResult& result, const CheckOptions& o, const CheckInput& input)
{
    if (o.isOfScene())
        return whyNotOfScene(result, o);
    if (result.changed)
        return "";
    for (const WindowCheck& window : result.windows)
    {
        const double power = powerOf(window, result, o.detect);
        if (power >= CERTAIN_POWER || o.hasHistory())
            continue;
        const int times = imagesNeeded(window, result, o.detect);
        const bool pairs = o.images.anyDirect(), commonMotion = pairs && o.placement > 0;    // which more pairs share
        const std::string noisy = result.sigma > input.sigma ? format("the new images are noisier than the calibration's (%.3g px, "
            "there %.3g px: check focus, light, motion); ", result.sigma, input.sigma) : "";
        const double shown = tiltThatShows(window, result);
        const std::string more = commonMotion ? format("more pairs do not help, as all boards or the camera's mount may have moved by %.2g "
            "between direct and glass images: give a smaller --placement-std if they stood better, or ", o.placement)
                                              : !times ? "" : format("take about %d times as many %s%s, or ", times,
            pairs ? "pairs" : "images",
            pairs ? " (a nearer board or one with more corners also helps)" : " or, far better, a pair without and with the window");
        const std::string change = window.lengthPerDegree > 0. ? "a motion of the centre by " + detected(window, o)
                                                               : format("a tilt of %g deg", o.detect);
        return noisy + format("camera %d: these images would show %s with a probability of only %.0f %%, so 'unchanged' "
                              "cannot be said; ", window.camera + 1, change.c_str(), 100.*power) + more
            + (shown > 0. ? format("ask for --detect=%g", shown) : std::string("ask for a larger --detect"));
    }
    if (result.windows.empty())
        return "the images do not tell where any window is: take a pair without and with the window, or more images";
    return "";
}

std::string verdictOf(const CheckResult& result, const std::string& why)
{
    const bool windows = std::any_of(result.windows.begin(), result.windows.end(), [](const WindowCheck& w) { return w.moved; });
    return !why.empty() ? CANNOT_TELL : !result.changed ? "unchanged" : windows ? "moved" : "changed";
}

std::string unseenBy(const CheckResult& result)
{
    std::string text;
    for (const UnseenError& error : result.unseen)
        text += (text.empty() ? "" : ", ") + error.of + (error.isOfTarget ? " (and with it all lengths)" : "")
                + (text.empty() ? " wrong" : "")
                + (std::isfinite(error.least) ? format(" by up to %.2g", error.least) + (error.unit.empty() ? "" : " " + error.unit)
                                              : std::string(" by any amount"));
    return text.empty() ? "" : "Not shown, if the calibration had it already: " + text + ".";
}

Json checkJson(const CheckResult& result, const CheckOptions& o, const CheckInput& input, const std::string& verdict,
               const std::string& why)
{
    Json windows = Json::array(), changes = Json::array();
    for (const WindowCheck& w : result.windows)
        windows.append(jsonOf(w, powerOf(w, result, o.detect)));
    for (const NamedChange& change : result.changes)
        changes.append(jsonOf(change));
    Json turns = Json::array();
    for (const TurnCheck& turn : result.turns)
        turns.append({{"camera", turn.camera + 1}, {"name", turn.name}, {"std_deg", turn.stdDeg},
                      {"probability_if_unchanged", turn.probability}, {"detection_probability", powerOf(turn, result, o.detect)}});
    Json unseen = Json::array();
    for (const UnseenError& error : result.unseen)      // of infinity, which the file has as null, no error shows
        unseen.append({{"of", error.of}, {"least_shown", error.least}, {"unit", error.unit}});
    std::vector<int> mayHaveTurned;
    for (int camera : result.mayHaveTurned)
        mayHaveTurned.push_back(camera + 1);
    return {
        {"verdict", verdict}, {"why", why}, {"windows", windows}, {"turns", turns}, {"changes", changes},
        {"may_have_turned", mayHaveTurned}, {"unseen", unseen}, {"explained", result.explained},
        {"false_alarm", o.falseAlarm}, {"detect_deg", o.detect}, {"sigma_px", input.sigma}, {"sigma_seen_px", result.sigmaSeen}};
}

void printCheck(const CheckResult& result, const CheckOptions& o, const CheckInput& input, const CheckImages& images)
{
    if (result.changed)
        printCause(result);
    if (o.isOfScene())
        printTurns(result, o);
    const bool anyCentre = std::any_of(result.windows.begin(), result.windows.end(), [](const auto& w) { return w.lengthPerDegree > 0.; });
    Table table({"", anyCentre ? "moved" : "tilt, deg", "+- (two principal)", "chance if unchanged", format("would show %g deg", o.detect),
                 ""}, SCREEN);
    for (const WindowCheck& w : result.windows)
    {
        const bool isCentre = w.lengthPerDegree > 0.;
        const double factor = isCentre ? w.lengthPerDegree : 1.;
        table.add({format("%s of camera %d", isCentre ? nameOfShape(input.rig.cameras[w.camera]->window()) : "window", w.camera + 1),
                   w.tiltDeg == w.tiltDeg ? format("%.4f", factor*w.tiltDeg) : "-",
                   format("%.2g, %.2g", factor*w.stdDeg[0], factor*w.stdDeg[1]), format("%.2g", w.probability),
                   format("%.1f %%", 100.*powerOf(w, result, o.detect)),
                   w.moved ? "moved" : result.changed ? "not the cause" : "no sign of it"});
    }
    if (!result.windows.empty())
        table.print(std::cout);
    std::cout << '\n';
    const std::string known = o.isOfScene() ? "" : format(", %.4f px in the calibration", input.sigma);
    printLines(format("Noise of a pixel coordinate: %.4f px here", result.sigmaSeen) + known
               + format(". False alarms: %g%s.", o.falseAlarm, o.hasHistory() ? ", of the charts and this check together" : ""));
    if (o.isOfScene())
        printScene(images.scene, input.rig.cameras.size() == 2);
    else
        printLines(unseenBy(result));
}

} // namespace tools
