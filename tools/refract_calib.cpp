// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The manual: what --help prints first.
static const char MANUAL[] = R"(Calibrates the windows in front of one camera, a stereo pair or a rig of up to 16 cameras.

  refract_calib --pattern=chessboard --size=6x5 --square=39
      --direct='direct/*.png' --glass='glass/*.png' --thickness=20 --index=1.5437 --out=calib.yml --report=report.html

Direct images show the target without the window, glass images through it. Where two have the same name (without folder
and extension) the target must not have moved between them: such pairs determine the window best. Take four of them, and 12
or more direct images in all: these serve the lens, unless --camera gives it, in one fit with the window, so that the lens's
uncertainty is in every +-. Two cameras or more say --direct, --glass and --camera once for each, in the cameras' order, or with their
numbers: --glass='left/*' --glass='right/*' is --glass='left/*' --glass2='right/*', and --camera3 is that of camera 3, whatever the
others have. The same name means the same moment in all cameras, with or without what all names of one camera begin or end with
(left01, right01); where that is not clear, --view-pattern='*_cam*_{}' says where the moment stands.
Each camera looks through its own window, unless --shared-window (all through one) or --window-of-camera=1,1,2,2 (cameras 1 and 2
through one, 3 and 4 through another) says otherwise.

Where an image glob stands, an mrcal corners.vnl or a points.csv may stand instead (then --image-size is needed). points.csv,
for any target, flat or not, each view its own: view,x,y,z,u,v, one row an observed point, `view` in place of the file's stem;
what several cameras see is matched by view and x, y, z. If all inputs are such files, --size and --square are not needed.

--target=points.csv: a target of dots on one level or several, as PIV and PTV have them: id,x,y,z of each dot, or OpenPTV's list. Its
dots are found in images, bright or dark, if 40 % of them are seen; or in tables of points with these names, of any program
(doc/formats.md), given for each camera as --glass=t.csv --glass=t.csv: camera 2 is u2,v2 of it.

--poses=poses.csv: the target's poses in camera 1 are known: view,rx_deg,ry_deg,rz_deg,tx,ty,tz,sigma_deg,sigma, one row a view:
rotation vector, translation, and their standard deviations about and along each axis (none: exact). Lengths in --unit, or in
that of the name (tx_mm); the rotation may also be rx_rad,... or the matrix r11,r12,...,r33.

It prints ten lines: the verdict and its reasons, the error of a measured point at three ranges, what to do next. The tables of
--verbose, --summary (for machines) and --report (to keep; its first page prints on one sheet) have the rest: what the +- is made
of, what the next images should show. Judge the result by the held-out boards (calibrated on the others in turn), not by the
residuals of the fit.

--pane-points=markers.csv: what is known of where a flat window is, by markers on its face towards the camera, or by floats on the water's
surface: id,x,y,z[,sx,sy,sz] in the frame of the camera (its centre the origin, z ahead), as refract_measure writes them with the
cameras' calibration without the window. They tell normal and distance together; what all of them share is in --normal-std and
--distance-std (default: 1 mm, how well the centre of a camera is known).

--watch waits while cameras fill the folders of all --direct and --glass (--watch=FOLDER: only that one), says after each
image whether the board was found, how sharp and how well exposed it is, which image its name still waits for, and what the next one
should show. Copies and files that cannot be read are named and left out. Then it calibrates: after --watch-count images or
--watch-pairs pairs, when --max-error-at and --max-normal-std are met by what came so far, when the best next pair would gain less than
--watch-gain percent, or when no image has come for --watch-quiet seconds.

A window is flat unless --window says dome or tube, with --radius of its inner face: --window=dome --radius=50 --thickness=5 --index=PMMA
--outer-index=water. Its centre is estimated in place of a flat window's normal; --center says where to start, in the camera's frame (x to
the right, y down, z ahead), if the camera is not near the middle. A tube needs --axis, roughly. --bow-std lets a flat window be bent.

Where an index stands, a material may stand: N-BK7, K9, B270, soda-lime, borosilicate, fused-silica, sapphire, PMMA, polycarbonate,
of media also with parameters: water:T=12 (C), seawater:T=12,S=35, air:T=20,P=101325,RH=50 (C, Pa, %). The result then says which
index it took; its standard deviation is what the colours of light and the kinds of the material change it by.

Lengths are in the unit of --square, angles in degrees. Exit code: 0 done, 1 could not do it, 2 done, but a limit (--max-rms,
--max-normal-std, --max-error-at) is not met, which one image through the window never does, or the images contradict a given
value. A PASS that is not the whole truth says so: "PASS; look at the weak points", "PASS, but not checked".

The same input gives the same bytes: outputs carry the time of the newest image (or that of SOURCE_DATE_EPOCH).)";

#include "assess/calibrate_images.hpp"
#include "assess/given_images.hpp"
#include "calibrate/given_window.hpp"
#include "calibrate/lens_choice.hpp"
#include "calibrate/pinhole_camera.hpp"
#include "calibrate/units.hpp"
#include "calibrate/window_face.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/progress.hpp"
#include "console/sha256.hpp"
#include "console/table.hpp"
#include "diagnose/image_mixups.hpp"
#include "formats/point_table.hpp"
#include "report/plot.hpp"
#include "report/summary.hpp"
#include <iostream>
#include <map>
#include <memory>

using namespace cv::refract;
using namespace tools;

namespace {

struct Options
{
    TargetOptions target;
    GivenImages images;
    PerCamera<std::string> camera;
    GivenRigOptions given;
    std::string out, summary, report, pinholeOut, lens = "auto";
    std::string channel;
    bool crossValidation = true, robust = true;
    Limits limits;
    Label label;
    bool verbose = false;
};

template<typename T> std::vector<std::string> namesOf(const std::map<std::string, T>& map)
{
    std::vector<std::string> names;
    for (const auto& entry : map)
        names.push_back(entry.first);
    return names;
}

std::vector<std::string> lensNames()
{
    std::vector<std::string> names = namesOf(pinholeLenses());
    names.insert(names.begin(), "auto");
    return names;
}

ErrorLimit parseErrorLimit(const std::string& text)
{
    const size_t colon = text.find(':');
    ErrorLimit limit;
    if (colon == std::string::npos || !parseNumber(text.substr(0, colon), limit.range) || !(limit.range > 0) ||
        !parseNumber(text.substr(colon + 1), limit.error) || !(limit.error > 0))
        throw Failure("--max-error-at=" + text + ": give RANGE:ERROR, two numbers more than 0, as in --max-error-at=600:0.05");
    return limit;
}

void requireCountOfCameras(const OptionParser& parser, const Options& o)
{
    const int cameras = o.images.sources.cameraCount();
    for (int c = 0; c < cameras; c++)
        if (o.images.sources.glass[c].empty())
            throw Failure(format("--glass%d is given, but no --glass%s: number the cameras 1, 2, 3, ... without a gap", cameras,
                                 cameraSuffix(c).c_str()));
    for (const char* ofSeveral : {"--shared-window", "--window-of-camera"})
        if (cameras == 1 && parser.get(ofSeveral).count() > 0)
            throw Failure(std::string(ofSeveral) + " requires --glass2");
    if (cameras > 1 && o.target.partial)
        throw Failure("--partial excludes --glass2");
}

Options parseOptions(Command& command)
{
    Options o;
    std::vector<std::string> maxErrors, notes;
    OptionParser& parser = command.parser;
    parser.beginGroup("Board");
    o.target.addTo(parser, false);
    parser.addFlag("--partial", o.target.partial, "a chessboard that may be partly out of view, or is cut at its edge: any piece "
        "of it will do; --size counts all corners of the whole board, the outermost found ones are left out");
    o.target.addDotsTo(parser);
    addYFrom(parser, o.images.sources.yFrom).needs(parser.get("--target"));
    parser.beginGroup("Images");
    o.images.sources.addTo(parser, "images through the window: the same", "images without the window: glob, corners.vnl or points.csv; "
        "once for each camera, or by its number (--direct3)");
    parser.addForEach("--camera", o.camera.data(), MAX_CAMERAS, "lens: OpenCV's YAML, XML, JSON, a file of ROS, Kalibr, COLMAP, MATLAB, "
        "NumPy, mrcal, ... (doc/formats.md); once for each camera; default: from --direct", "--glass");
    parser.add("--lens", o.lens, "lens model that the images determine: OpenCV's with that many coefficients, "
               "cv::fisheye's four, or auto: as many as held-out images support").check(isMember(lensNames()))
        .captureDefault();
    parser.add("--channel", o.channel, "of colour images, in which the target is looked for, and for which the calibration is "
        "valid (default: the brightness of all)").check(isMember({"red", "green", "blue"}));
    parser.add("--image-size", o.images.imageSize, "WxH; needed for corners.vnl and points.csv, otherwise checked");
    Option unpaired = parser.addFlag("--unpaired", o.images.unpaired, "equal names are no pairs (a hand-held board)");
    parser.get("--partial").needs(unpaired);
    parser.add("--poses", o.images.poses, "known poses of the target in camera 1: poses.csv").excludes(unpaired);
    parser.addNegation("--no-robust", o.robust, "use all points as they are; by default wrong points and "
        "images (dirt, wrong detections, a board that moved within its pair) are left out, and named");
    parser.beginGroup("Window");
    o.given.window.addTo(parser, "where it is needed and not given, it is estimated");
    parser.add("--free", o.given.free, "what to estimate beside the normal, or the centre").delimiter(',')
        .check(isMember(namesOf(freeFlags())));
    Option shared = parser.addFlag("--shared-window", o.given.sharedWindow, "all cameras look through the same pane");
    parser.add("--window-of-camera", o.given.windowOfCamera, "which window each camera looks through, as 1,1,2,2; equal numbers share "
        "one pane (default: each has its own)").excludes(shared);
    parser.beginGroup("How well known");
    o.given.std.addTo(parser);
    o.given.places.addTo(parser);
    parser.beginGroup("Limits");
    parser.add("--max-rms", o.limits.rms, "limit: RMS over all corners, px").check(moreThanZero());
    parser.add("--max-normal-std", o.limits.normalStdDeg, "limit: uncertainty of the normal (larger principal one), "
        "degrees").check(moreThanZero());
    parser.add("--max-error-at", maxErrors, "limit, repeatable: RANGE:ERROR, the expected error (one standard deviation, "
        "3-D) of the worst point of the image at z = RANGE from camera 1").oneAtATime();
    parser.addNegation("--no-cross-validation", o.crossValidation,
        "do not calibrate again on parts of the views");
    parser.beginGroup("Output");
    parser.add("--out", o.out, "the calibration to write (.yml, .xml, .json)").required();
    parser.add("--summary", o.summary, "JSON file with everything that the table and the report say");
    parser.add("--report", o.report, "HTML page to assess the calibration by, and to keep (needs gnuplot)");
    parser.add("--pinhole-out", o.pinholeOut, "also write the rig that cv::calibrateCamera and cv::stereoCalibrate make of "
        "the images through the window, to compare with (refract_measure --compare-with)");
    parser.add("--unit", o.given.unit, "unit of --square and all lengths").check(isMember(unitNames()))
        .captureDefault();
    parser.add("--serial", o.label.serial, "serial number of the window, carried into all outputs");
    parser.add("--note", notes, "repeatable: KEY=TEXT, carried into all outputs").oneAtATime();
    parser.addFlag("--verbose", o.verbose, "print all tables, in place of ten lines").excludes(parser.get("--quiet"));
    parser.beginGroup("Watch");
    o.images.watch.addTo(parser);
    parser.get("--view-pattern").excludes(parser.get("--watch"));
    parser.add("--watch-gain", o.images.watchGain, "end when the best next pair would take off less than so many percent of the "
        "calibration's part of a point's error").needs(parser.get("--watch")).check(moreThanZero());
    parser.listFirst({"--size", "--square", "--direct", "--glass", "--thickness", "--index", "--out"});
    command.parse();
    requireCountOfCameras(parser, o);
    for (const std::string& text : maxErrors)
        o.limits.errors.push_back(parseErrorLimit(text));
    for (const std::string& text : notes)
    {
        const auto note = parseNote(text);
        for (const auto& other : o.label.notes)
            if (other.first == note.first)
                throw Failure("--note=" + text + ": there is another note '" + note.first + "'");
        o.label.notes.push_back(note);
    }
    const auto isGiven = [](const std::string& file) { return !file.empty(); };
    if (parser.get("--lens").count() > 0
        && std::all_of(o.camera.begin(), o.camera.begin() + o.images.sources.cameraCount(), isGiven))
        throw Failure("--lens=" + o.lens + " is for a lens that the images determine; these are those of --camera: leave one out");
    o.images.sources.channel = channelOf(o.channel);
    return o;
}

//! A lens that was given for two cameras may be a slip, and lenses of one kind differ by more than their +-.
void noticeSharedLens(const Options& o, std::vector<std::string>& notices)
{
    std::map<std::string, int> first;
    for (int k = 0; k < MAX_CAMERAS; k++)
    {
        if (o.camera[k].empty() || isOfRig(o.camera[k]))
            continue;
        const auto known = first.insert({sha256OfFile(o.camera[k]), k});
        if (!known.second)
            notices.push_back(format("--camera%s ('%s') is also that of camera %d: no two lenses are alike; give each its own, or direct "
                                     "images of each", cameraSuffix(k).c_str(), o.camera[k].c_str(), known.first->second + 1));
    }
}

//! All that is known before the images.
RigCalibration prepare(const Options& o, const Target* target)
{
    RigCalibration c;
    if (!o.target.dots.empty())
        c.inputs.push_back(o.target.dots);
    c.square = target ? target->square() : 0.;
    c.options = o.given.of(o.images.sources.cameraCount(), o.images.sources.channel, !o.images.poses.empty(), c.square);
    if (isRound(c.options.window) && o.limits.normalStdDeg > 0.)
        throw Failure("--max-normal-std is of a flat window, and a " + o.given.window.shape() + " has no normal: limit the error of "
                      "points, --max-error-at");
    if (o.lens != "auto")
        c.options.lensCoefficients = pinholeLenses().at(o.lens).coefficients;
    c.inputs.insert(c.inputs.end(), o.given.places.files().begin(), o.given.places.files().end());
    c.limits = o.limits;
    c.label = o.label;
    c.unit = o.given.unit;
    c.crossValidated = o.crossValidation;
    for (int k = 0; k < MAX_CAMERAS; k++)
        if (!o.camera[k].empty())
        {
            // A rig's file may serve for all cameras, and that of a lens for those that have one like it.
            const bool again = k > 0 && o.camera[k] == o.camera[0] && isOfRig(o.camera[k]);
            const KnownLens lens = readLens(o.camera[k], again ? "camera" + cameraSuffix(k) : "");
            c.options.known[k] = lens.camera;
            c.options.knownCovariance[k] = lens.covariance;
            c.inputs.push_back(o.camera[k]);
        }
    return c;
}

//! @param richest coefficients that --lens=auto tries
void calibrateWithLens(const Options& o, int richest, const std::function<void()>& step, RigCalibration& c)
{
    if (o.lens == "auto")
        c.lens = chooseLens(c.data, c.options, o.robust, richest);
    if (!c.lens.scores.empty())
        setLens(c.lens, c.options, richest);
    calibrateImages(c, o.robust, step);
}

RigCalibration calibrate(const Options& o, bool quiet)
{
    std::unique_ptr<const Target> target;
    if (o.target.given())
        target = std::make_unique<Target>(o.target);
    RigCalibration c = prepare(o, target.get());
    o.images.read(target.get(), o.given.window.isDistanceSaid(), quiet, c);
    const std::string liquid = o.given.noticeOfLiquid(c.options.window);
    if (!liquid.empty())
        c.notices.push_back(liquid);
    noticeSharedLens(o, c.notices);
    requireOneMoment({c.data, c.options, c.square, c.notices});
    Progress progress("calibrating", 5, quiet);
    const auto step = [&progress] { progress.step(); };
    const RigOptions given = c.options;
    try
    {
        calibrateWithLens(o, RICHEST_LENS, step, c);
    }
    catch (const LensUndetermined&)
    {
        c.options = given;
        calibrateWithLens(o, POLYNOMIAL_LENS, step, c);
    }
    if (!o.crossValidation)
        return c;
    c.heldOut = holdOut(c.data, c.fit, c.options.flags);
    progress.step();
    c.nearFar = nearAgainstFar(c.data, c.fit, c.options.flags);
    if (!o.report.empty())
        c.influences = leaveOneOut(c.data, c.fit, c.options.flags, quiet);
    return c;
}

//! What would fail at the end, after all the work.
void checkOutputs(const Options& o, const std::string& settings)
{
    if (!o.report.empty())
        Plot::checkAvailable();
    std::vector<std::string> inputs = o.images.sources.all();
    inputs.insert(inputs.end(), o.camera.begin(), o.camera.end());
    inputs.insert(inputs.end(), {o.images.poses, o.target.dots, settings});
    inputs.insert(inputs.end(), o.given.places.files().begin(), o.given.places.files().end());
    tools::checkOutputs({{"--out", o.out, OUTPUT_CALIBRATION}, {"--summary", o.summary, OUTPUT_TEXT},
                         {"--report", o.report, OUTPUT_TEXT}, {"--pinhole-out", o.pinholeOut, OUTPUT_CALIBRATION}},
                        inputs);
}

//! Whoever reads the file must know what was thought of it.
Calibration withFindings(Calibration file, const Findings& findings)
{
    file.verdict = findings.verdict();
    file.contradictions = findings.contradictions;
    file.weakPoints = findings.weak;
    return file;
}

void writePinhole(const std::string& path, const RigCalibration& calibration, const std::string& command)
{
    Calibration pinhole = calibratePinholeRig(calibration.data, allViews(calibration.data),
                                              calibration.options.lensCoefficients);
    pinhole.command = command;
    pinhole.time = timeOfFiles(calibration.inputs);
    writeCalibration(path, pinhole);
}

//! Why it ends with exit code 2, a line each.
void printErrors(const Findings& findings)
{
    for (const LimitCheck& limit : findings.limits)
        if (!limit.met())
            std::cerr << "refract_calib: limit not met: " << limit.sentence() << ".\n";
    for (const std::string& sentence : findings.contradictions)
        std::cerr << "refract_calib: " << sentence << ".\n";
}

} // namespace

int refract_calib_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parseOptions(command);
        checkOutputs(options, command.settings());
        const RigCalibration calibration = calibrate(options, command.quiet());
        const Assessment assessment = assess(calibration);
        const Findings findings = findingsOf(calibration, assessment);
        // In the order of their worth: a full disk takes the report, not the calibration.
        writeCalibration(options.out, withFindings(toFile(calibration, command.line()), findings));
        if (!options.pinholeOut.empty())
            writePinhole(options.pinholeOut, calibration, command.line());
        if (!options.summary.empty())
            writeText(options.summary, summaryJson(calibration, assessment, findings, command.line()));
        if (!options.report.empty())
            writeText(options.report, makeReport(calibration, assessment, findings, command.line(), command.quiet()));
        if (options.verbose)
            printSummary(std::cout, calibration, assessment, findings);
        else if (!command.quiet())
            printDigest(std::cout, calibration, assessment, findings, options.report);
        if (command.quiet() || !errorsFollowOutput())
            printErrors(findings);
        return findings.pass() ? DONE : LIMIT_NOT_MET;
    });
}
