// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/certificate.hpp"
#include "accept/test_points.hpp"
#include "accept/acceptance.hpp"
#include "calibrate/provenance.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/sha256.hpp"
#include "console/table.hpp"
#include "report/plot.hpp"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <set>

static const char MANUAL[] = R"(Tests a calibrated rig by calibrated lengths that it measures through its windows: the error of
indication of each, its uncertainty U, and whether it is within what is permitted; with a certificate to sign.

  refract_accept calib.yml --points=points.csv --lengths=lengths.csv --max-error=0.1               points of refract_measure
  refract_accept calib.yml LEFT RIGHT --size=6x5 --square=39 --lengths=... --max-error=0.05+L/2000  images of a certified board

Decision (ISO 14253-1): a length passes if |error| + U <= limit, fails if |error| - U of the test > limit, else it is undecided. U of the
test is without the calibration of the rig: that is what is tested, and is no excuse.

points.csv: what refract_measure wrote, or any points in the frame of camera 1 (the centres of spheres): [image,]id,x,y,z, and where
they are known u1,v1,u2,v2,... (raw pixels), sx,sy,sz (one standard deviation) and status.
lengths.csv: name,image1,id1,image2,id2,length,U. U as the certificate of the standard says (expanded, k = 2). Where both images are
empty, the length is one of each image that shows both points.

U of an error (coverage 95.45 %; k is 2 for many degrees of freedom, after Welch and Satterthwaite): the noise of each point's pixels,
the covariance of the calibration, which both points share, the certified length, and its temperature. --verbose and the certificate have
the budget as the GUM writes it. The noise of a pixel is that of the calibration's residuals, or what the points' own rays show, if that
is more.

Refused: images that calibrated (by their pixels, stored anew or with points left out; by SHA-256 where there are files), lengths without
U, points that are not there or have a status other than 0, names or pairs that stand twice, points of another calibration, a
--pixel-sigma that the images refute, a test before its calibration or in the future. Lengths that reach out of the volume are marked.
What the test lacks of VDI/VDE 2634 part 1 (seven lines, five lengths on each, the longest two thirds of the volume's
diagonal) is said. Lines are found from where the lengths are.

--dcc: PTB's digital calibration certificate, version 3.3.0. The same input gives the same bytes on one day: the date of the test is that
of --date, of SOURCE_DATE_EPOCH, or of the newest file that was read; that of issue of --issued, SOURCE_DATE_EPOCH, or today.

Exit code: 0 all lengths pass, 1 could not do it, 2 at least one fails or is undecided.)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

const double NOT_STATED = std::numeric_limits<double>::quiet_NaN();

struct Options
{
    std::string calibration, points, lengths, maxError, plane, volume, unit;
    std::vector<std::string> boards, images;            //!< of each camera; files whose points are in --points
    TargetOptions target;
    ConditionsOptions conditions;
    std::string certificate, dcc, summary;
    CertificateLabel label;
    double pixelSigma = 0.;
    StandardTemperature standard = {NOT_STATED, 0.5, NOT_STATED, NOT_STATED, 20.};
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
    parser.add("--temperature", o.standard.temperature, "of the standard at the test, degrees C: its lengths are corrected from "
               "--reference-temperature (default: not stated, and they are taken as certified)");
    parser.add("--temperature-std", o.standard.std, "of --temperature, K, one standard deviation").check(notNegative()).captureDefault();
    parser.add("--expansion", o.standard.expansion, "of the standard, 1e-6 per K: steel 11.5, aluminium 23, float glass 9");
    parser.add("--expansion-std", o.standard.expansionStd, "of --expansion, 1e-6 per K (default: a tenth of it)").check(notNegative());
    parser.add("--reference-temperature", o.standard.reference, "of the standard's certificate, degrees C").captureDefault();
    o.label.addTo(parser);
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
    o.label.check();
    if (o.standard.isStated() != (o.standard.expansion == o.standard.expansion))
        throw Failure("--temperature and --expansion belong together: the standard's expansion (1e-6 per K) says what its temperature "
                      "does");
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

TestVolume volumeOf(const Options& o, const Calibration& calibration)
{
    TestVolume volume(calibration.provenance.volume);
    if (o.volume.empty())
        return volume;
    const std::vector<double> v = parseNumbers(o.volume, "--volume");
    if (v.size() != 6 || !(v[0] < v[1] && v[2] < v[3] && v[4] < v[5]))
        throw Failure("--volume=" + o.volume + ": give xmin,xmax,ymin,ymax,zmin,zmax, each pair growing");
    volume.box = CalibratedVolume{{v[0], v[2], v[4]}, {v[1], v[3], v[5]}};
    volume.isStated = true;
    return volume;
}

//! In 1/K, the expansion's deviation as is usual where it is not said.
StandardTemperature temperatureOf(const Options& o)
{
    const double PPM = 1e-6, USUAL = 0.1;
    StandardTemperature standard = o.standard;
    standard.expansionStd = PPM*(standard.expansionStd == standard.expansionStd ? standard.expansionStd
                                                                               : USUAL*std::abs(standard.expansion));
    standard.expansion *= PPM;
    return standard;
}

std::string textOf(const StandardTemperature& standard)
{
    return !standard.isStated() ? "" : format("%.2f +- %.2g C, expansion (%.3g +- %.2g)e-6/K, certified at %.4g C", standard.temperature,
                                              standard.std, 1e6*standard.expansion, 1e6*standard.expansionStd, standard.reference);
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
    std::set<std::string> images;
    for (const CalibratedLength& length : lengths)
        for (size_t end : length.ends)
            images.insert(points.points[end].image);
    return {images.begin(), images.end()};
}

//! What sx, sy, sz say beside the pixels, and what that means for --pixel-sigma.
std::vector<std::string> remarksOf(const PointErrors::Stated& stated, const Options& o)
{
    std::vector<std::string> remarks;
    if (stated.more)
        remarks.push_back("sx, sy, sz of some points say more than their pixels do, and are taken"
                          + std::string(o.pixelSigma > 0 ? ": --pixel-sigma is not used for these" : ""));
    if (stated.lessThanPixels)
        remarks.push_back("sx, sy, sz of some points say less than their pixels and the calibration do, and are not used");
    if (stated.lessThanCalibration)
        remarks.push_back("sx, sy, sz are smaller than the calibration's part of them, which was added");
    return remarks;
}

std::vector<std::string> remarksOfVolume(const TestVolume& volume, const std::optional<CalibratedVolume>& calibrated)
{
    if (!volume.isStated)
        return {};
    std::string text = "The volume is stated (--volume): " + volume.numbers();
    if (!calibrated)
        return {text + "; where the rig was calibrated is not known"};
    text += "; calibrated was " + TestVolume(calibrated).numbers();
    const bool isWithin = calibrated->contains(volume.box->least) && calibrated->contains(volume.box->most);
    return {text + (isWithin ? "" : ", and outside of that the calibration extrapolates")};
}

std::vector<std::string> remarksOfMissing(const CertificateLabel& label, const StandardTemperature& standard)
{
    std::string text;
    std::vector<std::string> missing = label.missing();
    if (!standard.isStated())
        missing.push_back("temperature of the standard (its lengths are taken as certified)");
    for (const std::string& name : missing)
        text += (text.empty() ? "Not stated: " : ", ") + name;
    return text.empty() ? std::vector<std::string>() : std::vector<std::string>{text};
}

std::vector<std::string> noticesOf(const Options& o, const Calibration& calibration, const TestPoints& points, const PointErrors& errors,
                                   bool imagesChecked, const std::vector<std::string>& images)
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
    const std::vector<std::string> sameNames = points.havePixels ? std::vector<std::string>() : namesThatCalibrated(images, calibration);
    if (!sameNames.empty())
        notices.push_back("Images of these names calibrated, and may be the same: " + listed(sameNames));
    if (!points.haveSigma)
        notices.push_back("The points have no sx, sy, sz: their noise is taken to be that of a pixel in the calibration");
    if (!points.havePixels)
        notices.push_back("The points have no pixels: each counts as seen by all cameras in whose images it is");
    for (const std::string& remark : remarksOf(errors.stated(), o))
        notices.push_back(remark);
    return notices;
}

//! All that was read.
std::vector<std::string> filesOf(const Options& o, const TestData& data)
{
    std::vector<std::string> files = {o.calibration, o.points, o.lengths};
    files.insert(files.end(), data.files.begin(), data.files.end());
    return files;
}

void addInput(const std::string& what, const std::string& path, std::vector<CertificateInput>& inputs)
{
    if (!path.empty())
        inputs.push_back({what, fs::path(path).filename().string(), sha256OfFile(path)});
}

Certificate certificateOf(const Options& o, const Calibration& calibration, const Acceptance& acceptance, const PointErrors& errors,
                          const TestData& data, const std::vector<std::string>& hashes, const CertificateLabel& label,
                          const Command& command)
{
    Certificate c;
    c.label = label;
    c.whereAll = !o.dcc.empty() ? "the DCC" : o.summary.empty() ? "" : fs::path(o.summary).filename().string();
    c.temperature = textOf(temperatureOf(o));
    c.command = command.line();
    c.calibrationTime = calibration.time;
    c.calibrationVerdict = calibration.verdict;
    c.acceptance = &acceptance;
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
        const TestVolume volume = volumeOf(o, calibration);
        const std::string unit = unitOf(o, calibration);
        const TestData data = readData(o, calibration, o.pixelSigma > 0 ? o.pixelSigma : pixelSigmaOf(calibration), command.quiet());
        const CertificateLabel label = o.label.completed(calibration, o.calibration, filesOf(o, data));
        const std::vector<std::string> hashes = requireNoneCalibrated(data.files, calibration);
        std::vector<std::string> untested;
        std::vector<CalibratedLength> lengths = readLengths(o.lengths, data.points, untested);
        const std::vector<std::string> images = imagesOf(data.points, lengths);
        const bool byPixels = requireOtherImages(data.points, images, calibration);
        const bool isOwnBoard = areOfBoard(lengths, calibration.square);
        for (CalibratedLength& length : lengths)
            if (o.standard.isStated())
                length = temperatureOf(o).applied(length);
        const PixelNoise noise = pixelNoiseOf(calibration, data.points, o.pixelSigma);
        const PointErrors errors(calibration, data.points, noise.sigma, plane);
        Acceptance acceptance = testLengths(data.points, errors, lengths, limit, volume);
        acceptance.unit = unit;
        acceptance.imagesChecked = byPixels || (!hashes.empty() && !calibration.provenance.images.empty());
        acceptance.notices = noticesOf(o, calibration, data.points, errors, acceptance.imagesChecked, images);
        acceptance.add(noise.remarks);
        if (!untested.empty())
            acceptance.add({remarkOfUntested(untested)});
        if (isOwnBoard)
            acceptance.add({format("The lengths are those of a board with the square that calibrated (%.6g): if it is that board, the "
                                   "scale is not tested; take another standard", calibration.square)});
        acceptance.add(remarksOfVolume(volume, calibration.provenance.volume));
        if (o.conditions.isSaid())
            acceptance.add({"The " + o.conditions.notice(asCalibrated)});
        acceptance.add(remarksOfMissing(label, o.standard));
        const Certificate certificate = certificateOf(o, calibration, acceptance, errors, data, hashes, label, command);
        writeOutputs(o, certificate);
        if (!command.quiet())
            printAcceptance(std::cout, acceptance, o.certificate);
        if (o.verbose)
            printTables(std::cout, acceptance, certificate.budgets);
        return acceptance.decision() == Decision::PASS ? DONE : LIMIT_NOT_MET;
    });
}
