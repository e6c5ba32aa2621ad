// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/measured_causes.hpp"
#include "measure/consistency.hpp"
#include "measure/measured_doubts.hpp"
#include "measure/measured_views.hpp"
#include "measure/measurement.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/csv.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "console/view_names.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

static const char MANUAL[] = R"(Measures the points of a target, in the frame of camera 1, from images through the window.

  refract_measure calib.yml IMAGE1 IMAGE2 --size=6x5 --square=39 --out=points.csv     two cameras or more: triangulation
  refract_measure calib.yml IMAGE --plane=0,0,1,600 --size=... --square=...           one camera: points on a plane
  refract_measure calib.yml IMAGE --size=... --square=...                             one camera: pose of the target
  refract_measure calib.yml IMAGE1 IMAGE2 --target=points.csv                         a target of dots, as in refract_calib
  refract_measure calib.yml --points=pixels.csv --out=points.csv                      points that are no target

IMAGE may be a quoted glob ('measure1/*.png'), a corners.vnl or a points.csv (view,x,y,z,u,v; then no target need be said);
images of different cameras belong together when their file stems are equal; '' stands for a camera that took none. Images
without target or without partner are skipped, and named on stderr.

--points: a table with the heading id,u1,v1,u2,v2,..., one row a point, its raw pixel in each camera; an empty cell where a
camera did not see it. With --plane the u1,v1 will do. Each id may stand once, or once in each image of a column image: then it is called
IMAGE/id. OpenLPT's frame,cam_id,pt_idx,x,y is such a table, too.

points.csv: image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status, one row a point (rigs of more cameras go on with u3,v3,... after v2);
image is the file's stem (of camera 1), id counts within the target or is that of --points; s* is one standard deviation, from
the pixel noise that the calibration found and from the calibration's own covariance, which calib.yml holds; nan where there is
no answer. status: 0 fine; 1 to 8 why there is no answer (RefractiveStatus; 1 also where fewer than two cameras saw the point);
9 the pixels contradict each other by more than 5 standard deviations of noise and calibration: the
point has the s* of that misfit, and far beyond it is nan; of a pose that its points contradict, all s* are nan. Look for
swapped images, images of two moments, a moved camera. 11: a pixel of the point lies outside of its image, so there is no answer.

--outer-index=seawater:T=8,S=35 says the scene's medium now, where it is not that of the calibration: the window is the calibrated
one, and what is not known of the index (--outer-index-std) is in sx, sy, sz.

The table compares the distances between neighbouring points with --square, which must be in the unit of the calibration.

Exit code: 0 done, 1 could not do it, 2 done and written, but not to be trusted: more than half of the points have status 9 or
11, or the distances between neighbouring points contradict --square: triangulated ones by five standard deviations, those on a plane
by 20 %, on average. Then a target tells the cause: images exchanged, turned, mirrored or of two moments, a moved camera or window,
another focus, medium or square; what fits as well follows after "or".)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

struct Options
{
    MeasuredFiles files;
    std::string plane, out;
    std::vector<std::string> compareWith;
    TargetOptions target;
    double pixelSigma = 0.;
    bool compare = false, noWindow = false;
    std::string unit;
    ConditionsOptions conditions;

    bool triangulates() const { return plane.empty() && (files.images.size() > 1 || !files.points.empty()); }
    //! From the pose of a target of known shape, the distances come out as they went in; other points have no known ones.
    bool lengthsMeasured() const { return target.given() && (triangulates() || !plane.empty()); }
};

//! On which the points lie; none: no plane is given.
std::optional<cv::Vec4d> planeOf(const Options& options)
{
    return options.plane.empty() ? std::nullopt : std::optional<cv::Vec4d>(parsePlane(options.plane));
}

double pixelSigma(const Options& options, const Calibration& calibration)
{
    return options.pixelSigma > 0 ? options.pixelSigma : pixelSigmaOf(calibration);
}

Measurement measureAnyPixels(const Options& options, const Calibration& calibration, const MeasuredView& view)
{
    const double sigma = pixelSigma(options, calibration);
    if (options.triangulates())
        return measureRig(calibration, glassPixels(view, (int)calibration.cameras.size()), sigma);
    if (options.plane.empty())
        return measureTarget(calibration, view.objectPoints, view.glass[0], sigma);
    return measureOnPlane(calibration, view.glass[0], *planeOf(options), sigma);
}

Measurement measure(const Options& options, const Calibration& calibration, const MeasuredView& view)
{
    Measurement m = measureAnyPixels(options, calibration, view);
    forgetOutside(calibration, m);
    return m;
}

std::vector<Measurement> measureAll(const Options& options, const Calibration& calibration, const std::vector<MeasuredView>& measured)
{
    std::vector<Measurement> results;
    for (const MeasuredView& view : measured)
        results.push_back(measure(options, calibration, view));
    return results;
}

void checkMeasurements(const Options& options, const Calibration& calibration, std::vector<Measurement>& results)
{
    for (Measurement& m : results)
        if (options.triangulates())
            checkConsistency(calibration, pixelSigma(options, calibration), m);
        else if (options.plane.empty())
            checkPose(pixelSigma(options, calibration), m);
}

//! What would explain a contradiction, if a target's shape is known; or empty.
std::string causeOf(const Options& options, const Calibration& calibration, const std::vector<MeasuredView>& measured)
{
    const std::vector<View> views(measured.begin(), measured.end());
    return options.files.points.empty() ? causesOf(calibration, views, pixelSigma(options, calibration)) : "";
}

//! What sx, sy and sz leave out.
void sayUncovered(const Options& options, const Calibration& calibration, const Command& command)
{
    if (!(pixelSigma(options, calibration) > 0))
        command.warn("'" + options.files.calibration + "' does not say how large the noise of a pixel is, so sx, sy, sz are not known: "
                     "calibrate with refract_calib, or give --pixel-sigma");
    else if (calibration.covariance.empty())
        command.warn("'" + options.files.calibration + "' has no covariance: sx, sy, sz cover the noise of the pixels, and take the "
                     "calibration as exact");
}

std::string csvOf(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& measurements, size_t cameras)
{
    cameras = std::max(cameras, (size_t)2);
    PointsCsv csv(cameras);
    for (size_t k = 0; k < measured.size(); k++)
        for (size_t i = 0; i < measured[k].ids.size(); i++)
        {
            const Measurement& m = measurements[k];
            std::vector<double> seen(2*cameras, std::numeric_limits<double>::quiet_NaN());
            for (size_t c = 0; c < std::min(cameras, m.pixels.size()); c++)
            {
                seen[2*c] = m.pixels[c][i].x;
                seen[2*c + 1] = m.pixels[c][i].y;
            }
            csv.add(measured[k].stem, measured[k].ids[i], seen, m.points[i], m.sigma[i], m.status[i]);
        }
    return csv.text();
}

//! Points without those that another measurement has no answer for.
std::vector<cv::Point3d> inBoth(std::vector<cv::Point3d> points, const std::vector<cv::Point3d>& others)
{
    for (size_t i = 0; i < points.size(); i++)
        if (std::isnan(others[i].z))
            points[i] = others[i];
    return points;
}

//! @param shown whose lengths are compared, so that a wrong point that these leave out is not in the others' errors
std::vector<std::string> rowOf(const std::string& name, const std::vector<MeasuredView>& measured,
                               const std::vector<Measurement>& results, const std::vector<Measurement>& shown, bool lengthsMeasured)
{
    double squares = 0, sum = 0, largest = 0, near = std::numeric_limits<double>::infinity(), far = -near, depthSigma = 0;
    int lengths = 0, answers = 0, points = 0;
    for (size_t k = 0; k < results.size(); k++)
    {
        const Measurement& m = results[k];
        for (const double error : lengthErrors(measured[k], inBoth(m.points, shown[k].points)))
        {
            squares += error*error;
            sum += error;
            largest = std::max(largest, std::abs(error));
            lengths++;
        }
        for (size_t i = 0; i < m.points.size(); i++)
            if (m.points[i].z == m.points[i].z)
            {
                near = std::min(near, m.points[i].z);
                far = std::max(far, m.points[i].z);
                depthSigma += m.sigma[i][2];
            }
        answers += m.answers();
        points += (int)m.points.size();
    }
    const auto digits = [](double value, int least, double of, bool sign = false) {       // more than of millimetres, of metres
        return rounded(value, of > 0. ? std::max(least, decimalsOf(of)) : least, sign); };
    const double rms = std::sqrt(squares/std::max(lengths, 1)), meanSigma = depthSigma/std::max(answers, 1);
    std::vector<std::string> row = {name, format("%d of %d", answers, points),
                                    answers ? digits(near, 1, far/100) + " ... " + digits(far, 1, far/100) : "-",
                                    !answers ? "-" : std::isnan(depthSigma) ? "unknown" : digits(meanSigma, 4, meanSigma)};
    if (lengthsMeasured && lengths)
        row.insert(row.end(), {digits(rms, 4, rms), digits(sum/lengths, 4, rms, true), digits(largest, 4, rms)});
    else if (lengthsMeasured)
        row.insert(row.end(), {"-", "-", "-"});
    return row;
}

//! To compare with: without windows they are welcome too.
std::vector<Calibration> readOthers(const Options& options, const Calibration& calibration)
{
    std::vector<Calibration> others;
    for (const std::string& file : options.compareWith)
    {
        others.push_back(readCalibration(file));
        if (others.back().cameras.size() != calibration.cameras.size())
            throw Failure("'" + file + "' has another number of cameras than '" + options.files.calibration + "'");
    }
    return others;
}

void printTable(const Options& options, const Calibration& calibration, const std::vector<Calibration>& others,
                const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results)
{
    const bool lengthsMeasured = options.lengthsMeasured()
        && std::any_of(measured.begin(), measured.end(), [](const MeasuredView& s) { return !s.neighbours.empty(); });
    std::vector<std::string> heading = {"", "points", "depth z", "mean sz"};
    if (lengthsMeasured)
        heading.insert(heading.end(), {"length RMS error", "mean error", "largest"});
    Table table(heading, 80);
    if (options.compare)
        table.add(rowOf("glass ignored", measured, measureAll(options, withoutWindows(calibration), measured), results,
                        lengthsMeasured));
    for (size_t i = 0; i < others.size(); i++)
        table.add(rowOf(stemOf(options.compareWith[i]), measured, measureAll(options, others[i], measured), results,
                        lengthsMeasured));
    const bool alone = !options.compare && options.compareWith.empty();
    table.add(rowOf(alone ? "measured" : "with the window", measured, results, results, lengthsMeasured));
    std::cout << measured.size() << (measured.size() == 1 ? " view" : " views")
              << (calibration.channel == BRIGHTNESS || !options.files.points.empty() ? std::string()
                  : ", the " + nameOf(calibration.channel) + " channel of colour images, as calibrated")
              << (lengthsMeasured ? "; distances between neighbouring points, measured minus true:\n\n"
              : options.triangulates() || !options.plane.empty() ? ":\n\n" : "; points from the pose of the target:\n\n");
    table.print(std::cout);
}

void addOptions(OptionParser& parser, Options& options)
{
    parser.add("calib.yml", options.files.calibration, "what refract_calib wrote").required();
    parser.add("IMAGE", options.files.images, "of camera 1, of camera 2, ...");
    addViewPattern(parser, options.files.viewPattern);
    parser.add("--points", options.files.points, "image points that are no target, in place of images: id,u1,v1,u2,v2,...");
    options.target.addTo(parser, false);
    options.target.addDotsTo(parser);
    addYFrom(parser, options.files.origin.yFrom);
    parser.add("--unit", options.unit, "unit of --square; what refract_calib had, or nothing")
        .check(isMember(unitNames()));
    options.conditions.addTo(parser);
    parser.add("--plane", options.plane, "a,b,c,d: the target lies on a x + b y + c z = d in the camera's frame");
    parser.add("--out", options.out, "points.csv to write");
    parser.addFlag("--no-window", options.noWindow, "calib.yml has no glass_window, and there is none");
    parser.add("--pixel-sigma", options.pixelSigma, "standard deviation of a pixel coordinate (default: that "
               "of the calibration's residuals)").check(moreThanZero());
    parser.addFlag("--compare", options.compare, "show also what comes out if the glass is ignored");
    parser.add("--compare-with", options.compareWith, "show also what another calibration gives");
}

void checkCombination(const Options& options, const Calibration& calibration)
{
    const size_t cameras = calibration.cameras.size(), images = options.files.images.size();
    if (options.files.points.empty() == (images == 0))
        throw Failure("give images of the target, or --points=FILE");
    if (!options.files.points.empty() && options.target.given())
        throw Failure("--points are those of no target: leave --size and --square, or --target, out");
    if (!options.files.origin.yFrom.empty() && options.files.points.empty() && options.target.dots.empty())
        throw Failure("--y-from is of tables of pixels: add --points=FILE, or --target=FILE of dots that they are of");
    if (images > cameras)
        throw Failure(format("'%s' has %s camera%s, but there are images of %s: calibrate ", options.files.calibration.c_str(),
                             cameras == 1 ? "one" : std::to_string(cameras).c_str(), cameras == 1 ? "" : "s",
                             images == 2 ? "two" : std::to_string(images).c_str())
                      + (images == 2 ? "the pair (refract_calib --direct2 --glass2), or give one image"
                                     : "them together (refract_calib --glass2 --glass3 ...), or give as many as it has"));
    if (!options.plane.empty() && images > 1)
        throw Failure("--plane is for one camera: leave it out, or give one image");
    if (options.plane.empty() && !options.files.points.empty() && cameras == 1)
        throw Failure("--points of one camera need --plane=a,b,c,d, on which they lie");
    if (images > 0 && options.files.images[0].empty() && !options.triangulates())
        throw Failure("an empty name in place of the images of camera 1: with one camera there must be some");
    if (options.files.points.empty() && !options.target.given())
        for (const std::string& image : options.files.images)
            if (!image.empty() && fs::path(image).extension() != ".csv")
                throw Failure("which target is in '" + image + "'? Give --size and --square, --target=FILE of dots, or --points=FILE "
                              "for other points");
    if (!options.plane.empty())
        parsePlane(options.plane);
}

} // namespace

int refract_measure_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        std::unique_ptr<const Target> target;
        if (options.target.given())
            target = std::make_unique<Target>(options.target);
        const Calibration asCalibrated = readCalibration(options.files.calibration, options.noWindow, command);
        const Calibration calibration = options.conditions.appliedTo(asCalibrated, options.files.calibration);
        if (target)
            requireSameUnit(calibration, target->square(), options.unit);
        checkCombination(options, calibration);
        std::vector<std::string> inputs = {options.files.calibration, options.files.points, options.target.dots, command.settings()};
        inputs.insert(inputs.end(), options.files.images.begin(), options.files.images.end());
        inputs.insert(inputs.end(), options.compareWith.begin(), options.compareWith.end());
        checkOutputs({{"--out", options.out, OUTPUT_TEXT}}, inputs);
        const std::vector<Calibration> others = readOthers(options, calibration);
        const std::vector<MeasuredView> measured = readMeasuredViews(options.files, options.triangulates(), calibration, target.get(),
                                                                     command);
        std::vector<Measurement> results = measureAll(options, calibration, measured);
        checkMeasurements(options, calibration, results);
        const std::string contradiction = contradictionIn(measured, results), outside = outsideImages(calibration, measured, results);
        int answers = 0;
        for (const Measurement& m : results)
            answers += m.answers();
        if (!answers)
        {
            const std::string cause = outside.empty() ? causeOf(options, calibration, measured) : "";
            throw Failure(!outside.empty() ? outside
                          : !contradiction.empty() ? contradiction + (cause.empty() ? "" : ". What explains them: " + cause)
                          : "no point could be measured"
                              + (!cause.empty() ? ". What explains it: " + cause
                                 : options.plane.empty() ? ": are images and calibration of the same cameras?"
                                 : ": is --plane=" + options.plane + " beyond the window, in the camera's frame?"));
        }
        for (const std::string& text : {outside, contradiction})
            if (!text.empty())
                command.warn(text);
        const std::string lengths = options.lengthsMeasured()
            ? wrongLengths(target->square(), calibration, measured, results, pixelSigma(options, calibration), planeOf(options)) : "";
        if (!lengths.empty())
            command.warn(lengths);
        const bool isDoubtful = mostContradict(results) || !lengths.empty();
        const std::string cause = isDoubtful ? causeOf(options, calibration, measured) : "";
        if (!cause.empty())
            command.warn("what explains them: " + cause);
        const std::string noisier = noisierImages(measured, results, pixelSigma(options, calibration));
        if (!noisier.empty())
            command.warn(noisier);
        sayUncovered(options, asCalibrated, command);
        if (!options.out.empty())
            writeText(options.out, csvOf(measured, results, calibration.cameras.size()));
        if (!command.quiet())
        {
            if (options.conditions.isSaid())
                std::cout << options.conditions.notice(asCalibrated) << '\n';
            printTable(options, calibration, others, measured, results);
        }
        return isDoubtful ? LIMIT_NOT_MET : DONE;
    });
}
