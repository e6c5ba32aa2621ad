// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_images.hpp"
#include "calibrate/calib_file.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/priors.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/table.hpp"
#include "formats/point_table.hpp"
#include "match/depth_range.hpp"
#include "match/scene_matches.hpp"
#include <algorithm>
#include <filesystem>
#include <memory>

using namespace cv::refract;

namespace tools {

namespace {

const double OF_ONE_CHECK = 0.01, OF_CHARTS = 1./370.;          // false alarms

//! What is known of boards between direct and glass images, where nobody says.
double usualPlacementOf(const Calibration& calibration)
{
    return calibration.placementStd >= 0. ? calibration.placementStd
                                          : USUAL_PLACEMENT_MM/millimetresIn(calibration.unit.empty() ? "mm" : calibration.unit);
}

//! Of a target or of a scene, as the options say it together.
void requireOneKind(const CheckOptions& o)
{
    if (!o.isOfScene() && o.images.glass[0].empty())
        throw Failure("--glass is required, or --scene with images of all cameras; see --help");
    if (!o.isOfScene())         // what images without --size are of, whoever reads them asks
        return;
    if (o.images.cameraCount() > 0 || o.target.given() || o.placement > 0.)
        throw Failure("--scene is without a target: leave --direct, --glass, --size, --square and --placement-std out");
}

void requireSerial(const CheckOptions& o, const Calibration& calibration)
{
    if (!o.serial.empty() && o.serial != calibration.label.serial)
        throw Failure("--serial=" + o.serial + ": '" + o.calibration + "' is of "
                      + (calibration.label.serial.empty() ? "a window without serial number"
                                                          : "the window '" + calibration.label.serial + "'")
                      + "; give the calibration of this one");
}

//! The targets may have moved between the new images of pairs, independently of what happened when the calibration was made.
void addPlacement(double placement, const std::vector<View>& views, CheckInput& input)
{
    RigData data;
    data.cameraCount = (int)input.rig.cameras.size();
    data.views = views;
    GivenStd given;
    given.placement = placement;
    const cv::Mat covariance = targetCovarianceOf(data, input.rig, given);
    if (!covariance.empty())
        input = withTargetColumns(input, covariance);
}

CheckResult checkViews(const CheckOptions& o, const std::vector<View>& views, const Calibration& calibration, CheckInput& input)
{
    addPlacement(o.placement, views, input);
    CheckResult result = checkRig(input, views, o.falseAlarmOfCheck(), calibration.unit);
    const bool isOtherBoard = o.target.square > 0. && calibration.square > 0. && o.target.square != calibration.square;
    const auto isShown = [&](const UnseenError& error) { return error.isOfTarget ? isOtherBoard : o.newPane; };
    result.unseen.erase(std::remove_if(result.unseen.begin(), result.unseen.end(), isShown), result.unseen.end());
    return result;
}

CheckResult checkMatches(const CheckOptions& o, const SceneMatches& matches, const Calibration& calibration, CheckInput& input)
{
    input.sigma = matches.good.matches.usualStd();          // the noise of features, which is not that of a target's points
    return checkScene(input, observationsOf(input.rig, matches.good.matches), o.falseAlarmOfCheck(), calibration.unit);
}

//! Direct images that have no glass image of their name are of no use here, and those are rarely meant.
void requirePairs(const CheckOptions& o, const RigImages& sets, const Command& command)
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

CheckImages readViews(const CheckOptions& o, const Calibration& calibration, const Command& command)
{
    const std::unique_ptr<const Target> target(o.target.given() ? new Target(o.target) : nullptr);
    const int count = (int)calibration.cameras.size(), given = o.images.cameraCount();
    if (given > count)
        throw Failure(format("'%s' has %d camera%s: leave --glass%d out", o.calibration.c_str(), count, count == 1 ? "" : "s", given));
    PerCamera<cv::Size> sizes;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        sizes[c] = o.imageSize.empty() ? calibration.cameras[c].camera->imageSize() : parseSize(o.imageSize, "--image-size");
    RigImages sets = readRigImages(o.images, target.get(), sizes, command.quiet());
    sets.nameSingles();
    requirePairs(o, sets, command);
    warnNotFound(sets, command);
    CheckImages result;
    for (const DetectedImages* set : sets.all())
        result.files.insert(result.files.end(), set->files.begin(), set->files.end());
    for (const UsedImage& image : usedImages(sets))
        result.shown.push_back(image.image);
    for (const View& view : groupIntoViews(target.get(), sets, false).views)
        if (view.hasGlass())
            result.views.push_back(view);
    return result;
}

CheckImages readScene(const CheckOptions& o, const Calibration& calibration, const Command& command)
{
    std::vector<std::string> sources(o.scene.begin(), o.scene.end());
    while (!sources.empty() && sources.back().empty())
        sources.pop_back();
    for (size_t c = 0; c < sources.size(); c++)
        if (sources[c].empty())
            throw Failure("there is no --scene" + cameraSuffix((int)c) + ": give images of each camera, in the calibration's order");
    std::vector<Frames> cameras = framesOf(sources, calibration, o.calibration, o.images.viewPattern);
    CheckImages result;
    for (const Frames& frames : cameras)
        for (const std::string& path : frames.paths())
            result.files.push_back(path);
    SceneOptions options;
    options.depth = o.depth.empty() ? calibratedDepthRange(calibration, o.calibration) : givenDepthRange(o.depth, calibration);
    result.scene = matchScene(calibration, cameras, options, command.quiet());
    return result;
}

} // namespace

void CheckOptions::addTo(OptionParser& parser)
{
    parser.add("calib.yml", calibration, "what refract_calib wrote").required();
    target.addTo(parser, true);
    parser.add("--unit", unit, "unit of --square; what refract_calib had, or nothing")
        .check(isMember(unitNames()));
    target.addDotsTo(parser);
    addYFrom(parser, images.yFrom).needs(parser.get("--target"));
    images.addTo(parser, "new images through the window, once for each camera: glob, corners.vnl or points.csv", "new images "
        "without the window: the same");
    parser.addForEach("--scene", scene.data(), MAX_CAMERAS, "new images of any scene, in place of those of a target, once for each "
        "camera: image, glob or video");
    parser.add("--depth", depth, "with --scene: NEAR,FAR, z in the frame of camera 1 (default: the calibrated volume, and half as far "
        "again)").needs(parser.get("--scene"));
    for (const char* ofTarget : {"--glass", "--size", "--square"})      // requireOneKind asks for them
        parser.get(ofTarget).required(false);
    parser.add("--image-size", imageSize, "WxH; needed for corners.vnl, otherwise checked");
    parser.add("--false-alarm", falseAlarm, "probability of a change that is none (default: 0.01; with --history 1/370, of all "
        "charts together)").check(between(1e-9, 0.5));
    parser.add("--detect", detect, "tilt that must show, degrees").check(moreThanZero()).captureDefault();
    parser.add("--pixel-sigma", sigma, "standard deviation of a pixel coordinate (default: that of the calibration's "
        "residuals)").check(moreThanZero());
    parser.add("--placement-std", placement, "by how much all targets, or the camera's mount, moved between the direct and the glass "
        "images, along each axis, one standard deviation: in air, that looks like a tilt (default: what calib.yml was made with, or "
        "0.02 mm)").check(notNegative());
    Option ofPane = parser.addFlag("--new-pane", newPane, "the panes are not those of the calibration, but others of their kind");
    parser.add("--wedge-std", wedgeMinutes, "with --new-pane: the angle between the faces of a pane, one standard deviation, arc "
        "minutes").check(notNegative()).captureDefault().needs(ofPane);
    parser.add("--thickness-std", pane.thickness, "with --new-pane: how much panes differ in thickness, one standard deviation")
        .check(notNegative()).captureDefault().needs(ofPane);
    parser.add("--index-std", pane.index, "the same of their index").check(notNegative()).captureDefault().needs(ofPane);
    conditions.addTo(parser);
    parser.add("--summary", summary, "JSON file with the result");
    Option ofHistory = parser.add("--history", history, "JSON file that keeps all checks of this calibration; begun if it is not "
        "there").excludes(ofPane);
    parser.add("--report", page, "HTML page to write, with the control charts (default: --history with .html; needs gnuplot)")
        .needs(ofHistory);
    parser.add("--date", date, "when the images were taken, as 2026-11-26 or 2026-11-26T08:30:00Z (default: now)").needs(ofHistory);
    parser.addFormerName("--history-page", "--report");
    parser.addFormerName("--time", "--date");
    parser.addFlag("--fixed-target", fixedTarget, "the target stands where it stood at the checks before: its images may look alike")
        .needs(ofHistory);
    parser.add("--serial", serial, "serial number of the window that stands on it: must be that of calib.yml");
}

std::string CheckOptions::pageFile() const
{
    return !page.empty() || !hasHistory() ? page : std::filesystem::path(history).replace_extension(".html").string();
}

std::vector<std::string> CheckOptions::inputs() const
{
    std::vector<std::string> result = images.all();
    result.insert(result.end(), {calibration, target.dots});
    result.insert(result.end(), scene.begin(), scene.end());
    return result;
}

void CheckOptions::complete()
{
    requireOneKind(*this);
    if (!(falseAlarm > 0.))
        falseAlarm = hasHistory() ? OF_CHARTS : OF_ONE_CHECK;
}

void CheckOptions::completeFrom(const Calibration& read)
{
    requireSameUnit(read, isOfScene() ? read.square : target.square, unit);
    requireSerial(*this, read);
    if (placement < 0.)
        placement = usualPlacementOf(read);
}

CheckImages readCheckImages(const CheckOptions& options, const Calibration& calibration, const Command& command)
{
    return options.isOfScene() ? readScene(options, calibration, command) : readViews(options, calibration, command);
}

CheckResult checkImages(const CheckOptions& options, const CheckImages& images, const Calibration& calibration, CheckInput& input)
{
    return options.isOfScene() ? checkMatches(options, images.scene, calibration, input)
                               : checkViews(options, images.views, calibration, input);
}

} // namespace tools
