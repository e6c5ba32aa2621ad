// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_output.hpp"
#include "bundle/matches.hpp"
#include "bundle/bundle_findings.hpp"
#include "bundle/mistaken_matches.hpp"
#include "bundle/moments.hpp"
#include "calibrate/units.hpp"
#include "colmap/survey_output.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/view_names.hpp"
#include "formats/point_table.hpp"
#include "match/moved_rig.hpp"
#include "match/scene_matches.hpp"
#include "match/wand_matches.hpp"

#include <cmath>
#include <iostream>
#include <numeric>
#include <sstream>

static const char MANUAL[] = R"(Calibrates a rig behind its windows without a target, from points that several cameras saw: the ends of a
wand that is waved, particles, any matches. Cameras, windows, R, T and points are one fit.

  refract_bundle start.yml --points=matches.csv --lengths=lengths.csv --out=calib.yml       a rig that was never calibrated
  refract_bundle start.yml --wand=200,0.1 'left/*.png' 'right/*.png' --out=calib.yml                 the same, of images of a wand
  refract_bundle calib.yml --points=matches.csv --out=better.yml                            one that was: what it knows has its say
  refract_bundle calib.yml --points=matches.csv --turned=0.3 --out=again.yml                a camera was touched meanwhile
  refract_bundle calib.yml --points=matches.csv --free=normal --out=new.yml                 its windows were taken out meanwhile
  refract_bundle calib.yml --colmap=sparse/0 --lengths=lengths.csv --out=again.yml --colmap-out=refracted     images of a rig that moves

start.yml: what refract_calib wrote, or lenses, windows and R, T written by hand, within some degrees and per cent
(doc/howto_bundle.md has one). The cameras do not move. If start.yml has no glass_window, the options say it, of all cameras, as those of
refract_calib: --window=dome --radius=50 --thickness=5 --index=PMMA --outer-index=water. A dome's centre is then at the camera, where it
is enough to start from, unless --center says otherwise; a tube needs --axis, roughly; --bow-std lets flat windows be bent.

matches.csv: [image,]id,u1,v1,u2,v2,..., one row a point, its raw pixel in each camera; an empty cell where a camera did not see
it. The same id with another image is another point: of a wand, image is the moment. What refract_measure or refract_match wrote will
do, and so will tables of OpenLPT, DLTdv, Argus, DeepLabCut and OpenPTV (doc/formats.md). std1,std2,... (of all cameras, or none) say how
well each pixel is known; without, all are alike.

lengths.csv: [image,]id1,id2,length,std, distances between points, with one standard deviation; without image a row is of all images
that show both points. Rows with equal length and std are one object: its error is one, however many moments there are.

--wand=LENGTH[,STD] IMAGES: in place of both tables a quoted glob, numbered images or a video of each camera, of a stick with a ball
at each end, LENGTH between their centres (STD: 0.1 % of it). Images of one moment have equal names but for the camera's part; where that
is not clear, --view-pattern says where the moment stands. Balls are round, 4 pixels wide or more, brighter than what is behind them or
darker, and move; what stands still, as lamps and their images in the pane, does not count. The two balls are those whose rays meet and
that are LENGTH apart; a moment where a ball is hidden, or where several fit, is left out and counted. --points-out has their pixels (a is
the larger ball), and --points reads it.

Three kinds of parameters. What --free names starts at the values of start.yml and follows from the matches alone. What has a
variance in start.yml (what refract_calib wrote has a covariance) is estimated within that; where it has none, thickness, index,
distance and wedge are known as well as in refract_calib (--thickness-std and its kin). The rest is exact. Default of --free:
normal,extrinsics (of domes and tubes center,extrinsics; with center goes a tube's axis) for a start without a covariance; nothing for
one with.

Scale: of --lengths; without, of T in start.yml, if it is not free.

calib.yml: as refract_calib writes it, for all tools. points.csv (--points-out): as refract_measure writes it; status 9: a wrong match,
left out; 1: fewer than two cameras saw it. Of a point that two cameras saw, a wrong match along the epipolar curve cannot be seen.

--colmap: what COLMAP reconstructed with pinholes, text or binary, of raw images of a calibrated camera or rig that moved through a scene.
It gives observations, and poses and points to start from; its lenses count nothing. --images='port/*' --images='starboard/*', one for
each camera of calib.yml, say by names which images are whose (not needed for one camera, nor where the model has a rig of as many). The
scale: of --lengths (id1,id2 are POINT3D_ID), of --positions (image,x,y,z,std: where camera 1 was; the results are then in this frame), of
the rig's base line, or of the window alone; its +- says how well. --colmap-out: the model with its refined poses and points, raw pixels,
and for cameras the nearest pinholes, for refract_undistort --colmap. --points-out: id,x,y,z,sx,sy,sz,images,angle_deg,status of each point;
those whose rays are nearly parallel have their large +-. --poses-out: the same of each view. --memory: GB that these +- may take; above it
those of points are for known cameras and views, and too small, and views have none (nan).

Exit code: 0 done, 1 could not do it, 2 done and written, but a limit is not met, or what start.yml says is contradicted; also if what two
cameras saw is exchanged, where the adjustment may come to no end, and nothing is written.)";

namespace {

using namespace tools;

struct Options
{
    std::string start, points, wand, viewPattern, lengths, out, pointsOut, posesOut, colmapOut, summary;
    std::vector<std::string> images;
    BundleOptions bundle;
    PixelOrigin origin;
    SurveyOptions survey;
    double maxRms = 0., pixelSigma = 0.;
    std::vector<std::string> turned;        // degrees
    double tilted = 0.;
    bool robust = true;

    bool isSurvey() const { return !survey.model.empty(); }
};

void addOptions(OptionParser& parser, Options& o)
{
    parser.add("start.yml", o.start, "the rig to start from").required();
    const Option points = parser.add("--points", o.points, "what the cameras saw: [image,]id,u1,v1,u2,v2,...");
    const Option images = parser.add("IMAGES", o.images, "with --wand: of each camera a quoted glob or a video");
    const Option wand = parser.add("--wand", o.wand, "LENGTH[,STD] of a wand with two balls, which IMAGES show").needs(images)
        .excludes(points);
    addViewPattern(parser, o.viewPattern).needs(wand);
    const Option colmap = parser.add("--colmap", o.survey.model, "or a folder with a model of COLMAP, of raw images").excludes(points)
        .excludes(wand);
    addYFrom(parser, o.origin.yFrom).needs(points);
    parser.add("--lengths", o.lengths, "known distances between points: [image,]id1,id2,length,std").excludes(wand);
    parser.add("--free", o.bundle.free, "what the matches alone must tell; none: nothing").delimiter(',')
        .check(isMember(freeNames()));
    parser.add("--turned", o.turned, "of a rig that was calibrated: each camera may have turned about its own centre since, by so many "
        "degrees, one standard deviation; 0,0.3: camera 2 alone").delimiter(',').check(notNegative());
    parser.add("--tilted", o.tilted, "the same of each window").check(moreThanZero());
    o.bundle.window.addTo(parser, "needed where the medium on its other side is another");
    o.bundle.std.addTo(parser, false);
    o.bundle.places.addTo(parser);
    parser.add("--unit", o.bundle.unit, "unit of all lengths (default: that of start.yml, or mm)").check(isMember(unitNames()));
    parser.addFlag("--no-window", o.bundle.noWindow, "start.yml has no glass_window, and there is none");
    parser.addNegation("--no-robust", o.robust, "every match is right; by default wrong ones are left out");
    parser.add("--pixel-sigma", o.pixelSigma, "noise of a pixel coordinate that the matches are known to have: far above it they "
        "contradict the start (default: std1,std2,... of the matches, that of start.yml, or 2 px at most; with --colmap not known)")
        .check(moreThanZero());
    parser.add("--out", o.out, "the calibration to write (.yml, .xml, .json)").required();
    parser.add("--points-out", o.pointsOut, "points.csv to write");
    parser.add("--images", o.survey.images, "names of a camera's images in the model, a glob; once for each camera").oneAtATime()
        .needs(colmap);
    parser.add("--memory", o.survey.memory, "GB that the +- of views and points may take beside the fit (default: what they need); above "
        "it, +- of points are for known cameras and views, which is said").needs(colmap).check(moreThanZero());
    parser.add("--positions", o.survey.positions, "where camera 1 was: image,x,y,z,std").needs(colmap);
    parser.add("--colmap-out", o.colmapOut, "folder for the refined model, made if it is not there").needs(colmap);
    parser.add("--poses-out", o.posesOut, "poses.csv to write: of each view, with +-").needs(colmap);
    parser.add("--summary", o.summary, "JSON file with all that is said, and more");
    parser.add("--max-rms", o.maxRms, "limit: RMS over all pixels, px").check(moreThanZero());
}

//! What --turned and --tilted say comes beside what the calibration knows.
BundleStart startWith(const Options& o, const BundleOptions& bundle, const Calibration& file)
{
    BundleStart start = startOf(file, o.start, bundle);
    MayHaveTurned turned{{}, o.tilted};
    for (const std::string& text : o.turned)
    {
        double degrees = 0.;
        parseNumber(text, degrees);             // a number, as was checked
        turned.cameras.push_back(degrees);
    }
    if (turned.cameras.empty() && !(turned.windows > 0.))
        return start;
    if (turned.cameras.size() > 1 && turned.cameras.size() != start.rig.cameras.size())
        throw Failure(cv::format("--turned has %zu values, and '%s' has %zu cameras: one value for all, or one of each",
                                 turned.cameras.size(), o.start.c_str(), start.rig.cameras.size()));
    if (file.covariance.empty())
        throw Failure("--turned and --tilted are for a rig that was calibrated, and '" + o.start + "' has no covariance: free what is not "
                      "known (--free)");
    start.covariance = covarianceOfMoved({start.rig, start.covariance, 0., 0.}, turned);
    return start;
}

Calibration resultOf(const Options& o, const BundleAdjustment& adjustment, const BundleFindings& findings, const Calibration& start,
                     const std::string& unit, const Command& command)
{
    Calibration file = toFile(adjustment, start);
    file.unit = unit;
    file.verdict = findings.verdict();
    file.contradictions = findings.contradictions;
    file.command = command.line();
    std::vector<std::string> inputs = o.images;
    inputs.insert(inputs.end(), {o.start, o.points, o.lengths, o.survey.positions});
    inputs.insert(inputs.end(), o.bundle.places.files().begin(), o.bundle.places.files().end());
    file.time = timeOfFiles(inputs);
    return file;
}

//! What to free, in the same sentence; of a rig that was calibrated: one of nominal values may be wrong in anything.
void explain(const Options& o, const Calibration& file, const Matches& matches, const GivenLengths& lengths, const BundleStart& start,
             const BundleAdjustment& adjustment, BundleFindings& findings)
{
    if (findings.contradictions.empty() || findings.areMeasuresWrong || file.covariance.empty())
        return;
    BundleOptions options = o.bundle;
    const std::string explanation = explanationOf(start.free, adjustment.fit.sigma, [&](const std::vector<std::string>& free) {
        options.free = free;
        const BundleStart freer = startWith(o, options, file);
        requireScale(freer, o.start, matches, lengths);
        return adjustBundle(freer, matches, lengths, o.robust);
    });
    findings.contradictions.back() += explanation.empty() ? "; no single name of --free explains it" : "; " + explanation + " (--free)";
}

std::string unitOf(const Options& o, const Calibration& file)
{
    return !o.bundle.unit.empty() ? o.bundle.unit : file.unit;
}

int exitCode(const Options& o, const BundleAdjustment& adjustment, const BundleFindings& findings)
{
    if (!findings.limitMet)
        std::cerr << cv::format("refract_bundle: limit not met: %.3g px RMS, the limit is %g.\n", adjustment.fit.rms, o.maxRms);
    for (const std::string& sentence : findings.contradictions)
        std::cerr << "refract_bundle: " << sentence << ".\n";
    return findings.pass() ? DONE : LIMIT_NOT_MET;
}

//! What the cameras saw, and what is known of it.
struct Observations
{
    Matches matches;
    GivenLengths lengths;
    std::string said;               //!< of how it was found, a line; empty: it was given
    Json wand;                      //!< the same in numbers
};

Observations readTables(const Options& o, const Calibration& file)
{
    if (o.points.empty())
        throw Failure("give --points=matches.csv, what the cameras saw, --wand=LENGTH and images, or --colmap=FOLDER of a rig that moved");
    Observations seen;
    seen.matches = readMatches(o.points, file, o.start, o.origin.yFrom);
    if (!o.lengths.empty())
        seen.lengths = readLengths(o.lengths, o.points, seen.matches);
    return seen;
}

Observations findWand(const Options& o, const Calibration& file, const BundleStart& start, bool quiet)
{
    const Wand wand = parseWand(o.wand);
    std::vector<Frames> frames = framesOf(o.images, file, o.start, o.viewPattern);
    const WandMatches found = matchWand(start, o.start, findBalls(file, frames, quiet), wand);
    return {found.matches, found.lengths, textOf(found) + "\n", jsonOf(found)};
}

//! px, of a coordinate; 0: not known.
double knownNoise(const Options& o, const Calibration& file, const Matches& matches)
{
    return o.pixelSigma > 0. ? o.pixelSigma : !matches.stds.empty() ? matches.usualStd() : file.sigma;
}

MeasuredBundle measuredBundle(const Options& o, const Matches& matches, const GivenLengths& lengths, const BundleStart& start)
{
    MeasuredBundle measured;
    measured.measures.lengths = lengths;
    measured.lengthsPath = o.wand.empty() ? o.lengths : "--wand";
    std::vector<int> points(matches.names.size());
    std::iota(points.begin(), points.end(), 0);
    measured.points.assign(matches.cameraCount(), points);
    measured.adjust = [&](const Measures& measures, const std::vector<std::vector<uchar>>* only) {
        Matches seen = matches;
        for (int c = 0; only && c < matches.cameraCount(); c++)
            for (size_t i = 0; i < matches.names.size(); i++)
                if (!(*only)[c][i])
                    seen.pixels[c][i] = cv::Point2d(NAN, NAN);
        return adjustBundle(start, seen, measures.lengths, !only && o.robust);
    };
    return measured;
}

std::string wrongOf(const Options& o, const Matches& matches, const GivenLengths& lengths, const BundleStart& start, double sigma,
                    double knownSigma)
{
    Options robustly = o;
    robustly.robust = true;
    const MeasuredBundle measured = measuredBundle(robustly, matches, lengths, start);
    const auto adjustRobustly = [&](const BundleStart& from) { return adjustBundle(from, matches, lengths, true, ENOUGH_ITERATIONS); };
    return wrongMatches(start, lengths, adjustRobustly, &measured, sigma, knownSigma,
                        [&](int point) { return matches.names[point].text(); });
}

//! What is to be thought of it, and why it is not as the start says: what the images are comes before what that leads to.
BundleFindings examine(const Options& o, const Calibration& file, const Matches& matches, const GivenLengths& lengths,
                       const BundleStart& start, const BundleAdjustment& adjustment)
{
    const double knownSigma = knownNoise(o, file, matches);
    const auto adjust = [&](const BundleStart& from) { return adjustBundle(from, matches, lengths, o.robust); };
    const MeasuredBundle measured = measuredBundle(o, matches, lengths, start);
    BundleFindings findings = findingsOf(start, lengths, adjustment, adjust, knownSigma, o.maxRms, &measured);
    const bool areNoisy = isNoisy(findings.pixelStd, knownSigma);
    const double sigma = adjustment.fit.sigma;
    std::string mistake;
    if (areNoisy && !o.robust)
        mistake = wrongOf(o, matches, lengths, start, sigma, knownSigma);
    if (mistake.empty() && areNoisy)
        mistake = lateCamera(start, matches, lengths, o.robust, sigma);
    // Pixels that fit without the measures are those of the cameras they are given for.
    if (mistake.empty() && !findings.contradictions.empty() && (areNoisy || !findings.areMeasuresWrong))
        mistake = exchangedCameras(start, matches, lengths, o.robust, knownSigma);
    if (!mistake.empty())
    {
        findings.contradictions = {mistake};
        return findings;
    }
    checkPlaces(start, adjust, findings);
    explain(o, file, matches, lengths, start, adjustment, findings);
    return findings;
}

int bundleMatches(const Options& options, const Calibration& file, const Command& command)
{
    Observations seen = options.wand.empty() ? readTables(options, file) : Observations();
    const BundleStart start = startWith(options, options.bundle, file);
    if (!options.wand.empty())
        seen = findWand(options, file, start, command.quiet());
    if (!command.quiet())
        std::cout << seen.said << std::flush;       // what follows may fail
    const Matches& matches = seen.matches;
    const GivenLengths& lengths = seen.lengths;
    requireScale(start, options.start, matches, lengths);
    requireSameMoments(start, matches);
    BundleAdjustment adjustment;
    try
    {
        adjustment = adjustBundle(start, matches, lengths, options.robust);
    }
    catch (const Failure&)
    {
        const double knownSigma = knownNoise(options, file, matches), endless = std::numeric_limits<double>::infinity();
        std::string mistake = options.robust ? "" : wrongOf(options, matches, lengths, start, endless, knownSigma);
        if (mistake.empty())
            mistake = exchangedCameras(start, matches, lengths, options.robust, knownSigma);
        if (mistake.empty())
            throw;
        std::cerr << "refract_bundle: " << mistake << "; as given they have no fit, and nothing is written.\n";
        return LIMIT_NOT_MET;
    }
    const BundleFindings findings = examine(options, file, matches, lengths, start, adjustment);
    const std::string unit = unitOf(options, file);
    writeCalibration(options.out, resultOf(options, adjustment, findings, file, unit, command));
    if (!options.pointsOut.empty())
        writeText(options.pointsOut, pointsCsv(matches, adjustment, stemOf(options.points)));
    if (!options.summary.empty())
    {
        Json json = bundleJson(matches, adjustment, findings, command.line(), unit);
        if (!options.wand.empty())
            json.set("wand", seen.wand);
        writeText(options.summary, json.text(2) + "\n");
    }
    if (!command.quiet())
        printBundle(std::cout, matches, adjustment, findings, unit);
    return exitCode(options, adjustment, findings);
}

int bundleSurvey(const Options& options, const Calibration& file, const Command& command)
{
    SurveyOptions survey = options.survey;
    survey.lengths = options.lengths;
    survey.robust = options.robust;
    survey.pixelSigma = options.pixelSigma;
    survey.maxRms = options.maxRms;
    const BundleStart start = startWith(options, options.bundle, file);
    SurveyResult result = adjustColmap(survey, start, unitOf(options, file), command.quiet());
    writeCalibration(options.out, resultOf(options, result.adjustment.bundle, result.findings, file, result.unit, command));
    if (!options.pointsOut.empty())
        writeText(options.pointsOut, surveyPointsCsv(result));
    if (!options.posesOut.empty())
        writeText(options.posesOut, surveyPosesCsv(result));
    if (!options.summary.empty())
        writeText(options.summary, surveyJson(result, command.line()));
    std::ostringstream said;
    printSurvey(said, result);
    if (!options.colmapOut.empty())
        writeColmapModel(refractedModel(result), options.colmapOut,
                         "refract_bundle: poses and points through windows, nearest pinholes, less " + originText(result.start));
    if (!command.quiet())
        std::cout << said.str();
    return exitCode(options, result.adjustment.bundle, result.findings);
}

void refuseOtherImages(const Options& o)
{
    if (!o.images.empty() && o.wand.empty())
        throw Failure("'" + o.images[0] + "' is one word too many: images are for --wand=LENGTH, which says what they show");
}

//! Before any work.
void refuseOverwriting(const Options& o, const std::string& settings)
{
    std::vector<Output> outputs = {{"--out", o.out, OUTPUT_CALIBRATION}, {"--points-out", o.pointsOut, OUTPUT_TEXT},
                                   {"--poses-out", o.posesOut, OUTPUT_TEXT}, {"--summary", o.summary, OUTPUT_TEXT}};
    std::vector<std::string> inputs = o.images;
    inputs.insert(inputs.end(), {o.start, o.points, o.lengths, o.survey.positions, settings});
    inputs.insert(inputs.end(), o.bundle.places.files().begin(), o.bundle.places.files().end());
    for (bool isBinary : {true, false})
    {
        for (const std::string& file : o.colmapOut.empty() ? std::vector<std::string>() : colmapFilesOf(o.colmapOut, isBinary))
            outputs.push_back({"--colmap-out", file, OUTPUT_IN_FOLDER});
        for (const std::string& file : o.isSurvey() ? colmapFilesOf(o.survey.model, isBinary) : std::vector<std::string>())
            inputs.push_back(file);
    }
    checkOutputs(outputs, inputs);
}

} // namespace

int refract_bundle_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        refuseOtherImages(options);
        refuseOverwriting(options, command.settings());
        const Calibration file = readCalibration(options.start);
        warnOfContradictions(file, options.start, command);
        return options.isSurvey() ? bundleSurvey(options, file, command) : bundleMatches(options, file, command);
    });
}
