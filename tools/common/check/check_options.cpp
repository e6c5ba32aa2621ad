// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "check/check_options.hpp"
#include "calibrate/calib_file.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "formats/point_table.hpp"
#include <filesystem>

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
    const auto require = [](bool isGiven, const char* option) {
        if (!isGiven)
            throw Failure(std::string(option) + " is required, or --scene with images of all cameras; see --help");
    };
    if (!o.isOfScene())
    {
        require(!o.images.glass[0].empty(), "--glass");
        require(o.target.given(), "--size");
        require(!o.target.dots.empty() || o.target.square > 0., "--square");
        return;
    }
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

} // namespace tools
