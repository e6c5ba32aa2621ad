// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/acceptance_output.hpp"
#include "accept/board_points.hpp"
#include "calibrate/calibration_images.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/outputs.hpp"
#include "console/sha256.hpp"
#include "console/table.hpp"
#include "report/plot.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>

static const char MANUAL[] = R"(Tests a calibrated rig by calibrated lengths that it measures through its windows: the error of
indication of each, its uncertainty U, and whether it is within what is permitted; with a certificate to sign.

  refract_accept calib.yml --points=points.csv --lengths=lengths.csv --max-error=0.1               points of refract_measure
  refract_accept calib.yml LEFT RIGHT --size=6x5 --square=39 --lengths=... --max-error=0.05+L/2000  images of a certified board

Decision (ISO 14253-1): a length passes if |error| + U <= limit, fails if |error| - U > limit, else it is undecided.

points.csv: what refract_measure wrote, or any points in the frame of camera 1 (the centres of spheres): [image,]id,x,y,z, and where
they are known u1,v1,u2,v2,... (raw pixels), sx,sy,sz (one standard deviation) and status.
lengths.csv: name,image1,id1,image2,id2,length,U. U as the certificate of the standard says (expanded, k = 2). Where both images are
empty, the length is one of each image that shows both points.

U of an error (coverage 95.45 %; k is 2 for many degrees of freedom, after Welch and Satterthwaite): the noise of each point's pixels,
the covariance of the calibration, which both points share, and the certified length. --verbose and the certificate have the budget
as the GUM writes it.

Refused: images that calibrated (by their pixels, and by SHA-256 where there are files), lengths without U, points that are not there
or have a status other than 0, names or pairs that stand twice, points of another calibration. Lengths that reach out of the calibrated
volume are marked. What the test lacks of VDI/VDE 2634 part 1 (seven lines, five lengths on each, the longest two thirds of the volume's
diagonal) is said. Lines are found from where the lengths are.

--dcc: PTB's digital calibration certificate, version 3.3.0. The same input gives the same bytes: the date is that of --date, of
SOURCE_DATE_EPOCH, or of the newest file that was read.

Exit code: 0 all lengths pass, 1 could not do it, 2 at least one fails or is undecided.)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

struct Options
{
    std::string calibration, points, lengths, maxError, plane, volume, unit;
    std::vector<std::string> boards, images;            //!< of each camera; files whose points are in --points
    TargetOptions target;
    ConditionsOptions conditions;
    std::string certificate, dcc, summary;
    CertificateLabel label;
    double pixelSigma = 0.;
    bool noWindow = false, verbose = false;
};

void addOptions(OptionParser& parser, Options& o)
{
    parser.add("calib.yml", o.calibration, "what refract_calib wrote").required();
    parser.add("IMAGE", o.boards, "of camera 1, of camera 2, ...: boards, in place of --points");
    parser.add("--points", o.points, "measured points, as refract_measure writes them");
    parser.add("--lengths", o.lengths, "certified lengths: name,image1,id1,image2,id2,length,U").required();
    parser.add("--max-error", o.maxError, "maximum permissible error: a length, or A+L/K of the tested length L").required();
    parser.add("--plane", o.plane, "a,b,c,d: one camera saw the points, on a x + b y + c z = d in its frame");
    parser.add("--images", o.images, "images (quoted globs) of the points of --points: whether one calibrated is told by SHA-256, too");
    parser.add("--volume", o.volume, "xmin,xmax,ymin,ymax,zmin,zmax in the frame of camera 1 (default: where it was calibrated)");
    o.target.addTo(parser, false);
    o.conditions.addTo(parser);
    parser.add("--unit", o.unit, "unit of lengths, where calib.yml does not say it").check(isMember(unitNames()));
    parser.addFlag("--no-window", o.noWindow, "calib.yml has no glass_window, and there is none");
    parser.add("--pixel-sigma", o.pixelSigma, "standard deviation of a pixel coordinate (default: that of the calibration's "
               "residuals)").check(moreThanZero());
    parser.add("--certificate", o.certificate, "HTML page to print and sign");
    parser.add("--dcc", o.dcc, "digital calibration certificate to write, XML");
    parser.add("--summary", o.summary, "JSON file with all that is said, and more");
    parser.addFlag("--verbose", o.verbose, "all lengths and budgets");
    parser.add("--number", o.label.number, "of the certificate (default: made of what was read)");
    parser.add("--date", o.label.date, "of the test, year-month-day");
    parser.add("--serial", o.label.serial, "of cameras and windows (default: window_serial of calib.yml)");
    parser.add("--customer", o.label.customer, "for whom");
    parser.add("--laboratory", o.label.laboratory, "where");
    parser.add("--operator", o.label.person, "who tested");
    parser.add("--country", o.label.country, "of the laboratory, two letters (ISO 3166-1), for --dcc");
    parser.add("--standard", o.label.standard, "standard of length: kind, serial number, certificate");
    parser.add("--environment", o.label.environment, "what was measured in: temperatures, medium");
}

//! What would fail at the end, after all the work.
void checkOptions(const Options& o, const std::string& settings)
{
    if (o.points.empty() == o.boards.empty())
        throw Failure("give --points=points.csv, or images of a certified board");
    if (!o.boards.empty() && !o.target.given())
        throw Failure("which board is in the images? Give --size and --square");
    if (!o.points.empty() && o.target.given())
        throw Failure("--points are measured already: leave --size and --square out");
    if (!o.boards.empty() && !o.plane.empty())
        throw Failure("--plane is for points that one camera saw: measure the board with refract_measure, and give --points");
    if (!o.label.date.empty())
        requireDate(o.label.date, "--date");
    const bool isCountry = o.label.country.size() == 2 && std::all_of(o.label.country.begin(), o.label.country.end(),
                                                                      [](char c) { return c >= 'A' && c <= 'Z'; });
    if (!o.label.country.empty() && !isCountry)
        throw Failure("--country=" + o.label.country + ": give two capital letters, as in --country=DE");
    if (!o.certificate.empty())
        Plot::checkAvailable();
    std::vector<std::string> inputs = {o.calibration, o.points, o.lengths, settings};
    inputs.insert(inputs.end(), o.boards.begin(), o.boards.end());
    inputs.insert(inputs.end(), o.images.begin(), o.images.end());
    checkOutputs({{"--certificate", o.certificate, OUTPUT_TEXT}, {"--dcc", o.dcc, OUTPUT_TEXT}, {"--summary", o.summary, OUTPUT_TEXT}},
                 inputs);
}

std::optional<cv::Vec4d> planeOf(const Options& o, const Calibration& calibration)
{
    if (!o.plane.empty())
        return parsePlane(o.plane);
    if (calibration.single())
        throw Failure("'" + o.calibration + "' has one camera: its points must lie on a plane; give --plane=a,b,c,d, as refract_measure "
                      "had it. Points from the pose of a target test nothing: their distances come out as they went in");
    return std::nullopt;
}

std::optional<CalibratedVolume> volumeOf(const Options& o, const Calibration& calibration)
{
    if (o.volume.empty())
        return calibration.provenance.volume;
    const std::vector<double> v = parseNumbers(o.volume, "--volume");
    if (v.size() != 6 || !(v[0] < v[1] && v[2] < v[3] && v[4] < v[5]))
        throw Failure("--volume=" + o.volume + ": give xmin,xmax,ymin,ymax,zmin,zmax, each pair growing");
    return CalibratedVolume{{v[0], v[2], v[4]}, {v[1], v[3], v[5]}};
}

std::string unitOf(const Options& o, const Calibration& calibration)
{
    if (!o.unit.empty() && !calibration.unit.empty() && o.unit != calibration.unit)
        throw Failure("--unit=" + o.unit + ": '" + o.calibration + "' is in " + calibration.unit + ", and so are its points");
    const std::string unit = calibration.unit.empty() ? o.unit : calibration.unit;
    if (unit.empty() && !o.dcc.empty())
        throw Failure("--dcc: '" + o.calibration + "' does not say the unit of its lengths: give --unit");
    return unit;
}

struct TestData
{
    TestPoints points;
    std::vector<std::string> files;         //!< images, as far as they are known
};

TestData readData(const Options& o, const Calibration& calibration, double pixelSigma, bool quiet)
{
    TestData data;
    for (const std::string& source : o.images)
    {
        const std::vector<std::string> files = matchingFiles(source);
        if (files.empty())
            throw Failure("--images='" + source + "' matches no file");
        data.files.insert(data.files.end(), files.begin(), files.end());
    }
    if (!o.points.empty())
    {
        data.points = readTestPoints(o.points, calibration.cameras.size());
        return data;
    }
    const Target target(o.target);
    requireSameUnit(calibration, target.square(), o.unit);
    if (o.boards.size() > calibration.cameras.size())
        throw Failure(format("'%s' has %zu cameras, but there are images of %zu", o.calibration.c_str(), calibration.cameras.size(),
                             o.boards.size()));
    BoardPoints boards = measureBoards(calibration, o.boards, target, pixelSigma, quiet);
    data.points = boards.points;
    data.files.insert(data.files.end(), boards.files.begin(), boards.files.end());
    return data;
}

//! Throws Failure if one calibrated. @return their hashes
std::vector<std::string> requireNoneCalibrated(const std::vector<std::string>& files, const Calibration& calibration)
{
    std::vector<std::string> hashes, used;
    for (const std::string& file : files)
    {
        hashes.push_back(sha256OfFile(file));
        if (findImage(calibration.provenance.images, hashes.back()))
            used.push_back(file);
    }
    if (!used.empty())
        throw Failure("these images calibrated, so that they prove nothing: " + listed(used) + ". Take others, with the length standard "
                      "where nothing was calibrated");
    return hashes;
}

std::vector<std::string> imagesOf(const TestPoints& points, const std::vector<CalibratedLength>& lengths)
{
    std::vector<std::string> images;
    for (const CalibratedLength& length : lengths)
        for (size_t end : length.ends)
            if (std::find(images.begin(), images.end(), points.points[end].image) == images.end())
                images.push_back(points.points[end].image);
    return images;
}

std::vector<std::string> noticesOf(const Options& o, const Calibration& calibration, const TestPoints& points, const PointErrors& errors,
                                   bool imagesChecked)
{
    const std::string file = "'" + o.calibration + "'";
    std::vector<std::string> notices;
    if (!calibration.contradictions.empty())
        notices.push_back(file + " was marked as not usable when it was made: " + calibration.contradictions[0]);
    if (calibration.covariance.empty())
        notices.push_back(file + " has no covariance: U takes the calibration as exact");
    if (!imagesChecked)
        notices.push_back("Whether images of the test calibrated, too, was not checked: "
                          + (calibration.provenance.images.empty() ? file + " does not name its images"
                             : std::string("the points have no pixels; give --images")));
    if (!points.haveSigma)
        notices.push_back("The points have no sx, sy, sz: their noise is taken to be that of a pixel in the calibration");
    if (!points.havePixels)
        notices.push_back("The points have no pixels: each counts as seen by all cameras in whose images it is");
    if (errors.added())
        notices.push_back("sx, sy, sz are smaller than the calibration's part of them, which was added");
    return notices;
}

void addInput(const std::string& what, const std::string& path, std::vector<CertificateInput>& inputs)
{
    if (!path.empty())
        inputs.push_back({what, fs::path(path).filename().string(), sha256OfFile(path)});
}

Certificate certificateOf(const Options& o, const Calibration& calibration, const Acceptance& acceptance, const PointErrors& errors,
                          const TestData& data, const std::vector<std::string>& hashes, const Command& command)
{
    Certificate c;
    c.label = o.label;
    c.command = command.line();
    c.calibrationTime = calibration.time;
    c.calibrationVerdict = calibration.verdict;
    c.acceptance = &acceptance;
    std::vector<std::string> inputs = {o.calibration, o.points, o.lengths};
    inputs.insert(inputs.end(), data.files.begin(), data.files.end());
    if (c.label.date.empty())
        c.label.date = timeOfFiles(inputs).substr(0, 10);
    if (c.label.serial.empty())
        c.label.serial = calibration.label.serial;
    addInput("calibration", o.calibration, c.inputs);
    addInput("points", o.points, c.inputs);
    addInput("lengths", o.lengths, c.inputs);
    std::string all;
    for (const std::string& hash : hashes)
        all += hash + "\n";
    if (!hashes.empty())
        c.inputs.push_back({format("%zu images", hashes.size()), "a line of SHA-256 for each", sha256Of(all)});

    const LengthResult& decisive = acceptance.decisive();
    c.budgets = {decisive.budget};
    for (int axis = 0; axis < 3; axis++)
        c.budgets.push_back(errors.table(coordinateOf(data.points, decisive.length.ends[0], axis)));
    const LinearQuantity plane = planeDistanceOf(data.points, data.points.points[decisive.length.ends[0]].image);
    if (!plane.weights.empty())
        c.budgets.push_back(errors.table(plane));
    return c;
}

void writeOutputs(const Options& o, const Certificate& certificate)
{
    if (!o.summary.empty())
        writeText(o.summary, certificateJson(certificate));
    if (!o.dcc.empty())
        writeText(o.dcc, certificateDcc(certificate));
    if (!o.certificate.empty())
        writeText(o.certificate, certificateHtml(certificate));
}

} // namespace

int refract_accept_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options o = parsed(command, addOptions);
        checkOptions(o, command.settings());
        const PermissibleError limit(o.maxError);
        const Calibration asCalibrated = readCalibration(o.calibration);
        const Calibration calibration = o.conditions.appliedTo(asCalibrated, o.calibration);
        requireWindows(calibration, o.calibration, o.noWindow);
        const std::optional<cv::Vec4d> plane = planeOf(o, calibration);
        const std::optional<CalibratedVolume> volume = volumeOf(o, calibration);
        const std::string unit = unitOf(o, calibration);
        const double pixelSigma = o.pixelSigma > 0 ? o.pixelSigma : pixelSigmaOf(calibration);
        const TestData data = readData(o, calibration, pixelSigma, command.quiet());
        const std::vector<std::string> hashes = requireNoneCalibrated(data.files, calibration);
        const std::vector<CalibratedLength> lengths = readLengths(o.lengths, data.points);
        const bool byPixels = requireOtherImages(data.points, imagesOf(data.points, lengths), calibration);
        const PointErrors errors(calibration, data.points, pixelSigma, plane);
        Acceptance acceptance = testLengths(data.points, errors, lengths, limit, volume);
        acceptance.unit = unit;
        acceptance.imagesChecked = byPixels || (!hashes.empty() && !calibration.provenance.images.empty());
        acceptance.notices = noticesOf(o, calibration, data.points, errors, acceptance.imagesChecked);
        if (o.conditions.isSaid())
            acceptance.notices.push_back("The " + o.conditions.notice(asCalibrated));
        const Certificate certificate = certificateOf(o, calibration, acceptance, errors, data, hashes, command);
        writeOutputs(o, certificate);
        if (!command.quiet())
            printAcceptance(std::cout, acceptance, o.certificate);
        if (o.verbose)
            printTables(std::cout, acceptance, certificate.budgets);
        return acceptance.decision() == Decision::PASS ? DONE : LIMIT_NOT_MET;
    });
}
