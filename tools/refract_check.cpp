// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The manual: what --help prints first.
static const char MANUAL[] = R"(Checks whether anything has changed since the calibration, and what, from one new pair or a few images of
a board, or of any scene.

  refract_check calib.yml --size=6x5 --square=39 --direct=new/direct.png --glass=new/glass.png
  refract_check calib.yml --size=6x5 --square=39 --glass='new/*.png'                          no image without the window
  refract_check calib.yml ... --direct='d1/*' --glass='g1/*' --direct2='d2/*' --glass2='g2/*'      a stereo rig
  refract_check calib.yml --scene='left/*.png' --scene2='right/*.png' --depth=450,1150                   the same without a board

One image each of --direct and --glass are a pair; among several, those with the same name. The target must not have moved
between them, not even by a tenth of a pixel: in air, such a shift looks like a tilt of the window (--placement-std).
Tried, each alone: a window tilted, its distance, thickness, index, wedge; the medium before it; a camera's focus, principal
point, R and T; the square of the board; a motion of all boards between direct and glass; images turned, mirrored, exchanged, or
of different moments. What explains the images best is named with its value and +-; what does so about as well follows after "or".
The noise comes from the calibration's residuals, the calibration's own error from the covariance in calib.yml.
A new pane is wedge-shaped in another way than the old one, which looks like a tilt: with --new-pane, that is part of the +-.
If nothing changed, it says that something did with the probability --false-alarm.

--scene, --scene2, ... are images, quoted globs or videos of all cameras, in which refract_match finds points; --depth is z of the scene in
the frame of camera 1. No scene shows a turn of the whole rig, or another scale; in air it hardly shows a window's tilt.

  refract_check calib.yml ... --history=rig7.json              every month: keeps this check, and draws the control charts of all

The charts (rig7.html, or --history-page) show drifts that no single check does: an EWMA of each parameter and T^2 of all, whose limits
take into account that the calibration's own error is the same in all checks. --false-alarm (then 1/370) is for all charts and the
check together. The images of each check must be new ones (one that was stored anew is known by where it shows the target), and the
calibration the same. An edited or deleted record is told. Two checks at once wait for each other.

--outer-index=seawater:T=8,S=35 says the scene's medium now, where it is not that of the calibration.

Exit code: 0 unchanged, 2 something changed (with --history, or a chart is beyond its limit), 1 could not tell: bad images, or images
that would not show a tilt of --detect degrees, or in a scene a turn of a camera, with a probability of 95 % (not with --history, which says
what drift would be found).)";

#include "assess/new_pane.hpp"
#include "assess/rig_check.hpp"
#include "calibrate/window_face.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/starting_model.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/colour.hpp"
#include "console/file_output.hpp"
#include "console/json.hpp"
#include "console/lines.hpp"
#include "console/outputs.hpp"
#include "console/table.hpp"
#include "calibrate/calibration_images.hpp"
#include "history/history_lock.hpp"
#include "history/history_page.hpp"
#include "measure/measurement.hpp"
#include "match/depth_range.hpp"
#include "match/scene_check.hpp"
#include "match/scene_matches.hpp"
#include "report/plot.hpp"
#include <algorithm>
#include <filesystem>
#include <iostream>

using namespace cv::refract;
using namespace tools;

namespace {

const size_t SCREEN = 80;               // columns
const double CERTAIN = 0.95;            // probability with which --detect degrees must show
const double OF_ONE_CHECK = 0.01, OF_CHARTS = 1./370.;          // false alarms
const double SHARE_OF_CHECK = 0.05;     // of the false alarms of a history: the check by itself, which knows more causes than the charts

struct Options
{
    std::string calibration, imageSize, summary, unit;
    RigSources images;
    TargetOptions target;
    PerCamera<std::string> scene;
    std::string depth;
    double falseAlarm = 0., detect = 0.1, sigma = 0.;
    bool newPane = false, fixedTarget = false;
    PaneStd pane = {0., 0.001, 0.};
    double wedgeMinutes = 1.;
    double placement = -1.;         //!< negative: that of the calibration
    ConditionsOptions conditions;
    std::string history, page, time, serial;
    double drift = 0.02;

    bool hasHistory() const { return !history.empty(); }
    bool isOfScene() const { return !scene[0].empty(); }
    //! Of the check by itself.
    double falseAlarmOfCheck() const { return hasHistory() ? SHARE_OF_CHECK*falseAlarm : falseAlarm; }
    std::string pageFile() const
    {
        return !page.empty() || !hasHistory() ? page : std::filesystem::path(history).replace_extension(".html").string();
    }
};

void addOptions(OptionParser& parser, Options& o)
{
    parser.add("calib.yml", o.calibration, "what refract_calib wrote").required();
    o.target.addTo(parser, true);
    parser.add("--unit", o.unit, "unit of --square; what refract_calib had, or nothing")
        .check(isMember(unitNames()));
    o.images.addTo(parser, "new images through the window: glob, corners.vnl or points.csv", "new images without the window");
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        Option option = parser.add("--scene" + cameraSuffix(c), o.scene[c], c ? "the same of camera " + cameraSuffix(c)
                                   : "new images of any scene, in place of those of a target: image, glob or video");
        if (c > 1)
            option.hide();
    }
    parser.add("--depth", o.depth, "with --scene: NEAR,FAR, z in the frame of camera 1 (default: the calibrated volume, and half as far "
        "again)").needs(parser.get("--scene"));
    for (const char* ofTarget : {"--glass", "--size", "--square"})      // requireOneKind asks for them
        parser.get(ofTarget).required(false);
    parser.add("--image-size", o.imageSize, "WxH; needed for corners.vnl, otherwise checked");
    parser.add("--false-alarm", o.falseAlarm, "probability of a change that is none (default: 0.01; with --history 1/370, of all "
        "charts together)").check(between(1e-9, 0.5));
    parser.add("--detect", o.detect, "tilt that must show, degrees").check(moreThanZero()).captureDefault();
    parser.add("--pixel-sigma", o.sigma, "standard deviation of a pixel coordinate (default: that of the calibration's "
        "residuals)").check(moreThanZero());
    parser.add("--placement-std", o.placement, "by how much all targets, or the camera's mount, moved between the direct and the glass "
        "images, along each axis, one standard deviation: in air, that looks like a tilt (default: what calib.yml was made with, or "
        "0.02 mm)").check(notNegative());
    Option newPane = parser.addFlag("--new-pane", o.newPane, "the panes are not those of the calibration, but others of their kind");
    parser.add("--wedge-std", o.wedgeMinutes, "with --new-pane: the angle between the faces of a pane, one standard deviation, arc "
        "minutes").check(notNegative()).captureDefault().needs(newPane);
    parser.add("--thickness-std", o.pane.thickness, "with --new-pane: how much panes differ in thickness, one standard deviation")
        .check(notNegative()).captureDefault().needs(newPane);
    parser.add("--index-std", o.pane.index, "the same of their index").check(notNegative()).captureDefault().needs(newPane);
    o.conditions.addTo(parser);
    parser.add("--summary", o.summary, "JSON file with the result");
    Option history = parser.add("--history", o.history, "JSON file that keeps all checks of this calibration; begun if it is not "
        "there").excludes(newPane);
    parser.add("--history-page", o.page, "HTML page to write, with the control charts (default: --history with .html; needs gnuplot)")
        .needs(history);
    parser.add("--time", o.time, "when the images were taken, as 2026-11-26T08:30:00Z (default: now)").needs(history);
    parser.addFlag("--fixed-target", o.fixedTarget, "the target stands where it stood at the checks before: its images may look alike")
        .needs(history);
    parser.add("--serial", o.serial, "serial number of the window that stands on it: must be that of calib.yml");
    parser.add("--drift", o.drift, "degrees a month: says within how many checks such a drift of a window is found, of a dome's "
        "centre as seen from a radius away")
        .check(moreThanZero()).captureDefault().needs(history);
}

CheckInput inputOf(const Options& o, const Calibration& calibration)
{
    const CheckInput input = checkInputOf(calibration, o.calibration, o.sigma);
    if (!o.newPane)
        return input;
    PaneStd pane = o.pane;
    pane.wedge = o.wedgeMinutes*ARC_MINUTE;
    return withNewPanes(input, pane);
}

//! What is known of boards between direct and glass images, where nobody says.
double usualPlacementOf(const Calibration& calibration)
{
    return calibration.placementStd >= 0. ? calibration.placementStd
                                          : USUAL_PLACEMENT_MM/millimetresIn(calibration.unit.empty() ? "mm" : calibration.unit);
}

//! Of a target or of a scene, as the options say it together.
void requireOneKind(const Options& o)
{
    const auto require = [](bool isGiven, const char* option) {
        if (!isGiven)
            throw Failure(std::string(option) + " is required, or --scene with images of all cameras; see --help");
    };
    if (!o.isOfScene())
    {
        require(!o.images.glass[0].empty(), "--glass");
        require(!o.target.size.empty(), "--size");
        require(o.target.square > 0., "--square");
        return;
    }
    if (o.images.cameraCount() > 0 || o.target.given() || o.placement > 0.)
        throw Failure("--scene is without a target: leave --direct, --glass, --size, --square and --placement-std out");
}

//! The targets may have moved between the new images of pairs, independently of what happened when the calibration was made.
void addPlacement(double placement, const std::vector<View>& views, CheckInput& input)
{
    RigData data;
    data.cameraCount = (int)input.rig.cameras.size();
    data.views = views;
    GivenStd std;
    std.placement = placement;
    const cv::Mat covariance = targetCovarianceOf(data, input.rig, std);
    if (!covariance.empty())
        input = withTargetColumns(input, covariance);
}

CheckResult checkViews(const Options& o, const std::vector<View>& views, const Calibration& calibration, CheckInput& input)
{
    addPlacement(o.placement, views, input);
    return checkRig(input, views, o.falseAlarmOfCheck(), calibration.unit);
}

CheckResult checkMatches(const Options& o, const SceneMatches& matches, const Calibration& calibration, CheckInput& input)
{
    input.sigma = matches.good.matches.usualStd();          // the noise of features, which is not that of a target's points
    return checkScene(input, observationsOf(input.rig, matches.good.matches), o.falseAlarmOfCheck(), calibration.unit);
}

//! If there is one image for each camera, they are one view, whatever their names.
void nameSingles(RigImages& sets)
{
    const std::vector<const DetectedImages*> all = sets.all();
    if (std::any_of(all.begin(), all.end(), [](const DetectedImages* set) { return set->files.size() > 1 || set->images.size() > 1; }))
        return;
    const std::string name = stemOf(sets.glass[0].images[0].path);
    for (PerCamera<DetectedImages>* images : {&sets.direct, &sets.glass})
        for (DetectedImages& set : *images)
            for (DetectedImage& image : set.images)
                image.stem = name;
}

//! Direct images that have no glass image of their name are of no use here, and those are rarely meant.
void requirePairs(const Options& o, const RigImages& sets, const Command& command)
{
    for (int c = 0; c < MAX_CAMERAS; c++)
    {
        const std::string number = cameraSuffix(c);
        std::string alone;
        int count = 0;
        for (const DetectedImage& image : sets.direct[c].images)
            if (!sets.glass[c].find(image.stem))
                alone += (count++ ? ", '" : "'") + image.stem + "'";
        if (!count)
            continue;
        if (count == (int)sets.direct[c].images.size())
            throw Failure("no image of --direct" + number + "='" + o.images.direct[c] + "' has the name of one of --glass" + number
                          + "='" + o.images.glass[c] + "' in which the target was found: the two images of a pair need equal names "
                          "(without folder and extension), or give one image each");
        command.warn("not used, as there is no image of that name in --glass" + number + ": " + alone);
    }
}

void warnNotFound(const RigImages& sets, const Command& command)
{
    for (const DetectedImages* set : sets.all())
        for (const std::string& path : set->withoutTarget)
            command.warn("the target was not found in '" + path + "'");
}

//! What the images are of, and their files.
struct NewImages
{
    std::vector<View> views;
    std::vector<std::string> files;
    std::vector<CalibrationImage> shown;
};

NewImages readViews(const Options& o, const Calibration& calibration, const Target& target, const Command& command)
{
    const int count = (int)calibration.cameras.size(), given = o.images.cameraCount();
    if (given > count)
        throw Failure(format("'%s' has %d camera%s: leave --glass%d out", o.calibration.c_str(), count, count == 1 ? "" : "s", given));
    PerCamera<cv::Size> sizes;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        sizes[c] = o.imageSize.empty() ? calibration.cameras[c].camera->imageSize() : parseSize(o.imageSize, "--image-size");
    RigImages sets = readRigImages(o.images, &target, sizes, command.quiet());
    nameSingles(sets);
    requirePairs(o, sets, command);
    warnNotFound(sets, command);
    NewImages result;
    for (const DetectedImages* set : sets.all())
        result.files.insert(result.files.end(), set->files.begin(), set->files.end());
    for (const UsedImage& image : usedImages(sets))
        result.shown.push_back(image.image);
    for (const View& view : groupIntoViews(&target, sets, false).views)
        if (view.hasGlass())
            result.views.push_back(view);
    return result;
}

//! Points of a scene in all its images.
struct SceneImages
{
    SceneMatches matches;
    std::vector<std::string> files;
};

SceneImages readScene(const Options& o, const Calibration& calibration, const Command& command)
{
    std::vector<std::string> sources(o.scene.begin(), o.scene.end());
    while (!sources.empty() && sources.back().empty())
        sources.pop_back();
    for (size_t c = 0; c < sources.size(); c++)
        if (sources[c].empty())
            throw Failure("there is no --scene" + cameraSuffix((int)c) + ": give images of each camera, in the calibration's order");
    std::vector<Frames> cameras = framesOf(sources, calibration, o.calibration);
    SceneImages result;
    for (const Frames& frames : cameras)
        if (frames.isVideo())
            result.files.push_back(frames.source());
        else
            result.files.insert(result.files.end(), frames.files().begin(), frames.files().end());
    SceneOptions options;
    options.depth = o.depth.empty() ? calibratedDepthRange(calibration, o.calibration) : givenDepthRange(o.depth, calibration);
    result.matches = matchScene(calibration, cameras, options, command.quiet());
    return result;
}

//! How many times as many images would show the tilt, or 0 if no number would.
int imagesNeeded(const WindowCheck& window, const CheckResult& result, double degrees)
{
    for (int n = 2; n <= 10000; n++)
        if (powerOf(window, result, degrees, 1./n) >= CERTAIN)
            return n;
    return 0;
}

//! The least tilt that would show, to one digit.
double tiltThatShows(const WindowCheck& window, const CheckResult& result)
{
    const double CEILING = 90.;
    for (double decade = 1e-4; decade < CEILING; decade *= 10.)
        for (int digit = 1; digit < 10; digit++)
            if (powerOf(window, result, digit*decade) >= CERTAIN)
                return digit*decade;
    return 0.;
}

//! --detect of a centre, as a length.
std::string detected(const WindowCheck& window, const Options& o)
{
    return format("%.3g (%g deg, as seen from a radius away)", o.detect*window.lengthPerDegree, o.detect);
}

//! Empty, or why a scene does not tell.
std::string whyNotOfScene(const CheckResult& result, const Options& o)
{
    if (result.changed)
        return "";
    const std::string more = "give images of more, and more textured, things, near and far, in the corners too, at more moments";
    if (result.turns.empty())
        return "the images do not tell how the cameras stand to each other: " + more;
    for (const TurnCheck& turn : result.turns)
        if (powerOf(turn, result, o.detect) < CERTAIN && !o.hasHistory())
            return format("camera %d: these images would show a turn by %g deg with a probability of only %.0f %%, so 'unchanged' cannot "
                          "be said; ", turn.camera + 1, o.detect, 100.*powerOf(turn, result, o.detect)) + more + ", or ask for a larger "
                "--detect";
    return "";
}

//! Empty, or why the images do not tell.
std::string whyNot(const CheckResult& result, const Options& o, const CheckInput& input)
{
    if (o.isOfScene())
        return whyNotOfScene(result, o);
    if (result.changed)
        return "";
    for (const WindowCheck& window : result.windows)
    {
        const double power = powerOf(window, result, o.detect);
        if (power >= CERTAIN || o.hasHistory())
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
    return !why.empty() ? "cannot tell" : !result.changed ? "unchanged" : windows ? "moved" : "changed";
}

Json jsonOf(const NamedChange& change)
{
    Json value = Json::array(), std = Json::array(), unit = Json::array();
    for (const ChangedValue& changed : change.values)
    {
        value.append(changed.value);
        std.append(changed.std);
        unit.append(changed.unit);
    }
    return {{"name", change.name}, {"camera", change.camera >= 0 ? Json(change.camera + 1) : Json()}, {"value", value}, {"std", std},
            {"unit", unit}, {"p", change.probability}, {"text", change.sentence}};
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

Json jsonOf(const CheckResult& result, const Options& o, const CheckInput& input, const std::string& verdict, const std::string& why)
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
    return {
        {"verdict", verdict}, {"why", why}, {"windows", windows}, {"turns", turns}, {"changes", changes}, {"explained", result.explained},
        {"false_alarm", o.falseAlarm}, {"detect_deg", o.detect}, {"sigma_px", input.sigma}, {"sigma_seen_px", result.sigmaSeen}};
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

void printTurns(const CheckResult& result, const Options& o)
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
void printScene(const SceneMatches& matches)
{
    std::cout << '\n';
    printLines(format("%d matches of %d moment%s; %d more left out as no point explains them, about %.0f wrong ones among the "
                      "rest.", matches.good.size(), matches.moments, matches.moments == 1 ? "" : "s", matches.leftOut, matches.wrongLeft));
    printLines("No scene shows a turn of the whole rig, or another scale.");
}

void print(const CheckResult& result, const Options& o, const CheckInput& input)
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
}

//! A check among all others of its calibration.
class KeptCheck
{
public:
    //! @param calibration as it was read
    KeptCheck(const Options& o, const Calibration& calibration)
        : o_(o), calibration_(calibration), lock_(o.history), history_(readHistory(o.history))
    {
        Plot::checkAvailable("--history");
        requireSameRig(history_, o.history, calibration, o.calibration);
        covariance_ = toEigen(withWedges(checkInputOf(calibration, o.calibration, o.sigma)).covariance);
        if (!o.time.empty())
            requirePast(o.time, "--time");
        time_ = o.time.empty() ? timeOfNow() : parseTime(o.time, "--time");
    }

    void requireNewImages(const NewImages& images)
    {
        const double tolerance = o_.fixedTarget ? IDENTICAL : sameImageTolerance(pixelSigmaOf(calibration_));
        record_ = recordOf({{}, VectorXd(), MatrixXd(), MatrixXd()}, images.files, time_, history_, images.shown);
        requireNotCalibrated(record_, calibration_, tolerance);
        requireNew(history_, o_.history, record_, tolerance);
    }

    //! What of the history is not as it was written.
    const std::vector<std::string>& broken() const { return history_.broken; }

    //! @param input of the check
    void add(const CheckResult& check, const CheckInput& input, const NewImages& images, const std::string& verdict)
    {
        record_ = recordOf(check.charted, images.files, time_, history_, images.shown);
        record_.verdict = verdict;
        record_.sigma = check.sigma;
        record_.dof = check.dof;
        if (o_.conditions.isSaid())     // the day's index is no error of the calibration
            for (int c = 0; c < (int)input.rig.cameras.size(); c++)
                record_.byParameters.col(columnsOf(withWedges(input).rig, c).outerIndex).setZero();
        history_.checks.push_back(record_);
        std::map<std::string, double> drifts;
        for (const WindowCheck& window : check.windows)
            drifts[window.chart] = o_.drift*(window.lengthPerDegree > 0. ? window.lengthPerDegree : 1.);
        result_ = chartHistory(history_, covariance_, (1. - SHARE_OF_CHECK)*o_.falseAlarm, drifts);
    }

    bool isAlarm() const { return result_.isAlarm(); }

    //! @param verdict of all
    void write(const std::string& verdict, bool isGood) const
    {
        const std::string page = historyPage(history_, result_, covariance_, {o_.calibration, o_.falseAlarm, verdict, isGood});
        writeText(o_.pageFile(), page);
        writeHistory(o_.history, history_);
    }

    void print() const
    {
        const std::vector<std::string> beyond = result_.chartsBeyond(history_);
        std::cout << format("\nHistory of %zu check%s since %s: ", history_.checks.size(), history_.checks.size() == 1 ? "" : "s",
                            history_.checks[0].time.substr(0, 10).c_str())
                  << (beyond.empty() ? "all charts are within their limits" : "beyond the limit: " + listed(beyond)) << '\n';
        if (!result_.causes.empty())
            std::cout << "What explains all checks best: " << causesIn(result_, history_) << '\n';
        if (!result_.mainTrend(history_).empty())
            std::cout << "Trend of " << result_.mainTrend(history_) << '\n';
        for (const FoundDrift& found : result_.found)
            std::cout << foundText(found, history_, result_.interval) << '\n';
        std::cout << "Charts: " << o_.pageFile() << '\n';
    }

    Json json() const
    {
        Json found = Json::array();
        for (const FoundDrift& f : result_.found)
            found.append({{"name", history_.changes[f.change].name}, {"drift_deg_per_month", o_.drift}, {"drift_per_month", f.perMonth},
                          {"checks", f.checks}});
        return {{"checks", history_.checks.size()}, {"broken", history_.broken}, {"alarm", isAlarm()},
                {"beyond", result_.chartsBeyond(history_)},
                {"causes", causesIn(result_, history_)}, {"t2", result_.points.back().t2}, {"t2_limit", result_.points.back().limitT2},
                {"ewma_limit", result_.points.back().limit}, {"found", found}};
    }

private:
    // Of an unmoved target's images no two have the same noise; a hundredth of a pixel is kept of each.
    static constexpr double IDENTICAL = 0.008;

    const Options& o_;
    const Calibration& calibration_;
    HistoryLock lock_;
    CheckHistory history_;
    MatrixXd covariance_;
    std::string time_;
    CheckRecord record_;
    HistoryResult result_;
};

void requireSerial(const Options& o, const Calibration& calibration)
{
    if (!o.serial.empty() && o.serial != calibration.label.serial)
        throw Failure("--serial=" + o.serial + ": '" + o.calibration + "' is of "
                      + (calibration.label.serial.empty() ? "a window without serial number"
                                                          : "the window '" + calibration.label.serial + "'")
                      + "; give the calibration of this one");
}

} // namespace

int refract_check_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        Options options = parsed(command, addOptions);
        if (!(options.falseAlarm > 0.))
            options.falseAlarm = options.hasHistory() ? OF_CHARTS : OF_ONE_CHECK;
        requireOneKind(options);
        const Calibration asCalibrated = readCalibration(options.calibration);
        requireWindows(asCalibrated, options.calibration, false, "");
        warnOfContradictions(asCalibrated, options.calibration, command);
        requireSameUnit(asCalibrated, options.isOfScene() ? asCalibrated.square : options.target.square, options.unit);
        requireSerial(options, asCalibrated);
        if (options.placement < 0.)
            options.placement = usualPlacementOf(asCalibrated);
        const Calibration calibration = options.conditions.appliedTo(asCalibrated, options.calibration);
        std::vector<std::string> inputs = options.images.all();
        inputs.insert(inputs.end(), {options.calibration, command.settings()});
        inputs.insert(inputs.end(), options.scene.begin(), options.scene.end());
        checkOutputs({{"--summary", options.summary, OUTPUT_TEXT}, {"--history", options.history, OUTPUT_TEXT},
                      {"--history-page", options.pageFile(), OUTPUT_TEXT}}, inputs);
        std::unique_ptr<KeptCheck> kept;
        if (options.hasHistory())
            kept = std::make_unique<KeptCheck>(options, asCalibrated);
        if (kept)
            for (const std::string& sentence : kept->broken())
                command.warn("'" + options.history + "' is not as it was written: " + sentence);
        CheckInput input = inputOf(options, calibration);
        NewImages images;
        SceneImages scene;
        if (options.isOfScene())
        {
            scene = readScene(options, calibration, command);
            images.files = scene.files;
        }
        else
            images = readViews(options, calibration, Target(options.target), command);
        if (kept)
            kept->requireNewImages(images);
        const CheckResult result = options.isOfScene() ? checkMatches(options, scene.matches, calibration, input)
                                                       : checkViews(options, images.views, calibration, input);
        const std::string why = whyNot(result, options, input);
        std::string verdict = verdictOf(result, why);
        bool isAlarm = result.changed;
        if (kept && (result.isMixup || result.charted.changes.empty() || !why.empty()))
        {
            command.warn("this check is not kept in '" + options.history + "': its images "
                         + (result.isMixup ? "are not what they are given for" : "do not tell where the rig is"));
            kept.reset();
        }
        if (kept)
        {
            kept->add(result, input, images, verdict);
            isAlarm |= kept->isAlarm();
            if (isAlarm && !result.changed)
                verdict = "drifted";
            kept->write(verdict, !isAlarm);
        }
        if (!options.summary.empty())
        {
            Json json = jsonOf(result, options, input, verdict, why);
            if (kept)
                json.set("history", kept->json());
            writeText(options.summary, json.text(1) + '\n');
        }
        if (!command.quiet())
        {
            const Tone tone = !why.empty() ? Tone::DOUBTFUL : isAlarm ? Tone::BAD : Tone::GOOD;
            std::cout << toned(std::cout, verdict, tone) << "\n\n";
            if (options.conditions.isSaid())
                std::cout << options.conditions.notice(asCalibrated) << "\n\n";
            print(result, options, input);
            if (options.isOfScene())
                printScene(scene.matches);
            if (kept)
                kept->print();
        }
        if (!why.empty())
            throw Failure(why);
        return isAlarm ? LIMIT_NOT_MET : DONE;
    });
}
