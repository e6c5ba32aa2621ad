// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The manual: what --help prints first.
static const char MANUAL[] = R"(Calibrates a sheet of laser light behind windows, and measures with it and one camera.

  refract_laser calib.yml 'boards/*.png' --size=6x5 --square=39 --sheet-out=sheet.yml       the sheet, from boards with the line on them
  refract_laser calib.yml 'scan/*.png' --sheet=sheet.yml --out=points.csv --cloud=cloud.ply       points on the line of each image

The sheet: take ten or more images of a board with the line across it, through the window, at several distances and tilts. The pose of
each board is that of its corners, so the line must leave enough of them alone. The sheet is a plane in the scene's medium, in the frame
of camera 1, or, with --emitter, that of a laser behind a window of its own, which bends it. Edges of the board are lines too: the line is
the one that lies on the same sheet in most images.

--emitter=FILE: camera_matrix, distortion_coefficients, glass_window of the laser (as of a camera in calib.yml; its z is the way of the
light, any focal length does), rvec and tvec (camera 1 -> emitter), line (u of its sheet), and how well that is known: rotation_std_deg,
position_std, glass_window_std (normal_deg, distance, thickness, index, outer_index). The images and these numbers together are fitted.

--laser says the line's colour: its excess over the two other colours is looked at, which white and black do not have. With
--laser-off='GLOB', images of the same names without the laser, the difference is looked at.

points.csv: image,id,u1,v1,x,y,z,sx,sy,sz,status, one row a point of the line, about one a column of the image (a row, where the line
runs down the image). Where the line ends, jumps or gets much darker, a pixel shows two surfaces: points there are left out, and counted.
s* is one standard deviation, from the line's own noise, the sheet's covariance and that of calib.yml; nan where there is no answer.
status: 0 fine; 1 to 8 why there is no answer (RefractiveStatus; 7: the ray lies in the sheet).

--outer-index=seawater:T=8,S=35 says the scene's medium now, where it is not that of calib.yml. The sheet must have been calibrated in it,
too, as its own light bends with the medium.

Exit code: 0 done; 1 could not do it: no line, too few boards, lines that do not determine a sheet; 2 done, but the limit --max-rms is not
met, or the boards contradict the sheet.)";

#include "laser/laser_output.hpp"
#include "console/numbers.hpp"
#include "laser/sheet_fit.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "report/plot.hpp"
#include "stereo/cloud_file.hpp"
#include "target/detected_images.hpp"
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>

using namespace cv::refract;
using namespace tools;
namespace fs = std::filesystem;

namespace {

const double FIRST_SCALE = 1.5;         // px, of a line of which nothing is known
const double SAME_SCALE = 1.2;          // ratio below which lines need not be looked for again
const double CONTRADICTED = 2.;         // error of held-out boards over stated

struct Options
{
    std::string calibration, images, off, laser = "green", emitter, sheet, sheetOut, out, cloud, pictures, profile, depth, unit;
    TargetOptions target;
    double maxRms = 0.;
    bool noWindow = false;
    ConditionsOptions conditions;

    bool calibrates() const { return !sheetOut.empty(); }
};

void addOptions(OptionParser& parser, Options& o)
{
    parser.add("calib.yml", o.calibration, "what refract_calib wrote").required();
    parser.add("IMAGES", o.images, "images with the line: a quoted glob").required();
    o.target.addTo(parser, false);
    parser.addFlag("--partial", o.target.partial, "a chessboard that may be partly out of view; --size counts all its corners");
    parser.add("--unit", o.unit, "unit of --square; what refract_calib had, or nothing").check(isMember(unitNames()));
    parser.add("--laser", o.laser, "colour of the line; any: the brightest line").check(isMember(laserColourNames()))
        .captureDefault();
    parser.add("--laser-off", o.off, "images of the same names without the laser: a quoted glob");
    Option sheetOut = parser.add("--sheet-out", o.sheetOut, "calibrate the sheet, and write it (.yml, .xml, .json)");
    parser.add("--emitter", o.emitter, "of a laser behind its own window: what is known of it, a file").needs(sheetOut);
    Option sheet = parser.add("--sheet", o.sheet, "measure with this sheet").excludes(sheetOut);
    parser.add("--max-rms", o.maxRms, "limit: RMS distance of held-out lines from the sheet").check(moreThanZero()).needs(sheetOut);
    parser.add("--out", o.out, "points.csv to write").needs(sheet);
    parser.add("--cloud", o.cloud, "PLY file to write: the points of all images, with colours and +-").needs(sheet);
    parser.add("--profile", o.profile, "SVG file to write: x and z of the points (needs gnuplot)").needs(sheet);
    parser.add("--depth", o.depth, "NEAR,FAR: z of the scene; other points are left out").needs(sheet);
    o.conditions.addTo(parser);
    parser.addFlag("--no-window", o.noWindow, "calib.yml has no glass_window, and there is none");
    parser.add("--picture-dir", o.pictures, "folder for pictures of the lines that were found");
}

//! An image, and what of it is the laser.
class LaserImages
{
public:
    LaserImages(const Options& o, LaserColour colour) : colour_(colour)
    {
        if (o.off.empty())
            return;
        for (const std::string& path : expandGlob(o.off))
            off_[stemOf(path)] = path;
    }

    cv::Mat signal(const cv::Mat& image, const std::string& path) const
    {
        if (colour_ != LASER_ANY && image.channels() == 1)
            throw Failure("'" + path + "' is a grey image, which has no colours: give --laser=any");
        if (off_.empty())
            return laserSignal(image, colour_);
        const auto off = off_.find(stemOf(path));
        if (off == off_.end())
            throw Failure("no image of --laser-off has the name of '" + path + "'");
        const cv::Mat without = readImage(off->second);
        const std::string both = "'" + off->second + "' and '" + path + "' differ in ";
        if (without.size() != image.size())
            throw Failure(both + "size (" + sizeText(without.size()) + ", " + sizeText(image.size()) + "): take both with the same camera");
        if (without.channels() != image.channels())
            throw Failure(both + "colour (one is grey): take both alike, or give --laser=any and both as grey images");
        if (without.depth() != image.depth())
            throw Failure(both + format("bits of a value (%d, %d): take both alike", 8*(int)without.elemSize1(), 8*(int)image.elemSize1()));
        return laserSignal(image, colour_, without);
    }

private:
    LaserColour colour_;
    std::map<std::string, std::string> off_;
};

std::vector<BoardImage> findBoards(const Calibration& calibration, const Target& target, const DetectedImages& set,
                                   const LaserImages& laser, double scale, Progress& progress)
{
    std::vector<BoardImage> boards(set.images.size());
    inParallel((int)boards.size(), [&](int i) {
        const DetectedImage& image = set.images[i];
        boards[i] = findLinesOnBoard(image.stem, calibration, target, image.points, laser.signal(readImage(image.path), image.path), scale);
        progress.step();
    });
    return boards;
}

double scaleOf(const std::vector<BoardImage>& boards, const SheetFit& fit, const DetectedImages& set, const LaserImages& laser)
{
    std::vector<double> scales;
    for (const LineOnBoard& line : fit.lines)
    {
        const std::string& path = set.images[line.image].path;
        std::vector<cv::Point2d> pixels;
        for (int i : line.points)
            pixels.push_back(boards[line.image].points[i].ridge.pixel);
        scales.push_back(scaleOfLine(laser.signal(readImage(path), path), pixels));
    }
    return median(scales);
}

void drawLine(const Options& o, const cv::Mat& image, const std::string& stem, const std::vector<RidgePoint>& line)
{
    cv::Mat picture;
    image.convertTo(picture, CV_8U, image.depth() == CV_16U ? 1./256. : 1.);
    if (picture.channels() == 1)
        cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
    for (const RidgePoint& p : line)
        cv::circle(picture, cv::Point(cvRound(4*p.pixel.x), cvRound(4*p.pixel.y)), 4, cv::Scalar(0, 0, 255), -1, cv::LINE_AA, 2);
    makeFolder(o.pictures);
    writeImage((fs::path(o.pictures)/(stem + ".png")).string(), picture);
}

std::vector<RidgePoint> ridgesOf(const BoardImage& board, const LineOnBoard& line)
{
    std::vector<RidgePoint> ridges;
    for (int i : line.points)
        ridges.push_back(board.points[i].ridge);
    return ridges;
}

//! What the images say against what was given of the emitter.
void warnOfEmitter(const Options& o, const SheetFit& fit, const Command& command)
{
    const double SURE = 4., BETTER = 10.;
    if (fit.moved > SURE)
        command.warn(format("the lines contradict '%s' by %.1f of its standard deviations: check its numbers", o.emitter.c_str(),
                            fit.moved));
    if (fit.planeExcess < -BETTER)
        command.warn(format("a plane explains the lines better than the sheet of '%s' (chi-square smaller by %.0f): check its window",
                            o.emitter.c_str(), -fit.planeExcess));
}

int calibrateSheet(const Options& o, const Calibration& calibration, const Command& command)
{
    if (!o.target.given())
        throw Failure("a sheet is calibrated with a board: give --size and --square");
    const Target target(o.target);
    if (target.pattern() == Target::APRILGRID)
        throw Failure("--pattern=aprilgrid leaves too little white for a line of light: take a chessboard, ChArUco or dots");
    requireSameUnit(calibration, target.square(), o.unit);
    const std::unique_ptr<const EmitterPrior> emitter(o.emitter.empty() ? nullptr : new EmitterPrior(o.emitter));
    const DetectedImages set = readDetectedImages(o.images, &target, calibration.cameras[0].camera->imageSize(), command.quiet(),
                                                  calibration.channel);
    for (const std::string& path : set.withoutTarget)
        command.warn("skipped, as the target was not found: " + path);
    const LaserColour colour = laserColourOf(o.laser);
    const LaserImages laser(o, colour);
    Progress progress("looking for lines", 2*(int)set.images.size(), command.quiet());
    const double sigma = pixelSigmaOf(calibration);
    std::vector<BoardImage> boards = findBoards(calibration, target, set, laser, FIRST_SCALE, progress);
    SheetFit fit = fitSheet(boards, calibration, sigma > 0. ? sigma : 0., FIRST_SCALE, emitter.get());
    const double scale = scaleOf(boards, fit, set, laser);
    if (std::max(scale/FIRST_SCALE, FIRST_SCALE/scale) > SAME_SCALE)
    {
        boards = findBoards(calibration, target, set, laser, scale, progress);
        fit = fitSheet(boards, calibration, sigma > 0. ? sigma : 0., scale, emitter.get());
    }
    Sheet& sheet = fit.sheet;
    sheet.colour = colour;
    sheet.unit = calibration.unit;
    sheet.command = command.line();
    std::vector<std::string> inputs = set.files;
    inputs.push_back(o.calibration);
    sheet.time = timeOfFiles(inputs);
    for (int m : fit.without)
        command.warn("'" + boards[m].name + "' is left out: no line of its board lies on the sheet of the others");
    for (int m : fit.disagreeing)
        command.warn("'" + boards[m].name + "' is left out: its line contradicts those of the other boards; is it an edge of the board?");
    if (fit.poseNoise > SheetFit::LARGE_POSE_NOISE)
        command.warn(format("the boards disagree by %.1f times what their corners' noise explains: look at the lines (--picture-dir), and "
                            "leave out images in which it is an edge of the board", fit.poseNoise));
    if (emitter)
        warnOfEmitter(o, fit, command);
    const std::string bend = bendNotice(fit, sheet.unit);
    if (!bend.empty())
        command.warn(bend);
    if (!o.pictures.empty())
        for (const LineOnBoard& line : fit.lines)
            drawLine(o, readImage(set.images[line.image].path), boards[line.image].name, ridgesOf(boards[line.image], line));
    writeSheet(o.sheetOut, sheet, calibration);
    if (!command.quiet())
        printSheet(fit, boards, sheet);
    const bool overLimit = o.maxRms > 0. && !(fit.heldOutRms() <= o.maxRms), contradicted = fit.heldOutRatio() > CONTRADICTED;
    if (overLimit)
        command.warn(format("limit not met: held-out boards are %.3g%s from the sheet, more than --max-rms=%g", fit.heldOutRms(),
                            unitAfter(sheet.unit).c_str(), o.maxRms));
    if (contradicted)
        command.warn(format("held-out boards are %.1f times as far from the sheet as the +- says: some boards moved, are not flat, or "
                            "lens, window or sheet are not those of the calibration", fit.heldOutRatio()));
    return overLimit || contradicted ? LIMIT_NOT_MET : DONE;
}

cv::Vec2d depthOf(const Options& o)
{
    return o.depth.empty() ? cv::Vec2d(0., std::numeric_limits<double>::infinity()) : parseDepthRange(o.depth, "--depth");
}

void addToCloud(const Scan& scan, const cv::Mat& image, Cloud& cloud)
{
    cv::Mat shown;
    image.convertTo(shown, CV_8U, image.depth() == CV_16U ? 1./256. : 1.);
    for (size_t i = 0; i < scan.line.points.size(); i++)
    {
        if (scan.measured.status[i] != REFRACT_OK)
            continue;
        const cv::Point at(cvRound(scan.line.points[i].pixel.x), cvRound(scan.line.points[i].pixel.y));
        const cv::Vec3b bgr = shown.channels() == 3 ? shown.at<cv::Vec3b>(at) : cv::Vec3b::all(shown.at<uchar>(at));
        const cv::Point3d& X = scan.measured.points[i];
        cloud.push_back({cv::Vec3f((float)X.x, (float)X.y, (float)X.z), cv::Vec3f(scan.measured.sigma[i]),
                         cv::Vec3b(bgr[2], bgr[1], bgr[0])});
    }
}

std::string profileOf(const std::vector<Scan>& scans, const std::string& unit)
{
    Plot plot(900, 400);
    std::vector<std::vector<cv::Point2d>> profiles;
    for (const Scan& scan : scans)
    {
        profiles.emplace_back();
        for (const cv::Point3d& X : scan.measured.points)
            profiles.back().emplace_back(X.x, X.z);
    }
    plot.paths("profile", profiles);
    plot << "set grid\nset yrange [] reverse\nset xlabel " << Plot::quoted("x", unit) << "\nset ylabel "
         << Plot::quoted("z", unit) << "\n"
         << "plot $profile using 1:2 with points pt 7 ps 0.25 notitle\n";
    return plot.svg();
}

//! Looks for the line at all depths. @return why there is none at those asked for
std::string whyNoLine(const Options& o, const Calibration& calibration, const Sheet& sheet, const cv::Mat& signal,
                      const std::string& path, ElsewhereLine& all)
{
    ElsewhereLine elsewhere;
    if (!o.depth.empty())
    {
        const ScanLine line = findScanLine(signal, calibration, sheet, cv::Vec2d(0., std::numeric_limits<double>::infinity()));
        const Measurement measured = measureOnSheet(calibration, sheet, line.points);
        elsewhere.add(measured);
        all.add(measured);
    }
    return elsewhere.points ? "'" + path + "': " + elsewhere.text(o.depth) : "no line was found in '" + path + "'";
}

int measureWithSheet(const Options& o, const Calibration& calibration, const Command& command)
{
    const Sheet sheet = readSheet(o.sheet, calibration);
    const cv::Vec2d depth = depthOf(o);
    const LaserImages laser(o, sheet.colour);
    const std::vector<std::string> paths = expandGlob(o.images);
    std::vector<Scan> scans;
    Cloud cloud;
    int points = 0, ambiguous = 0, mixed = 0;
    double sigma = 0.;
    ElsewhereLine elsewhere;
    Progress progress("measuring", (int)paths.size(), command.quiet());
    for (const std::string& path : paths)
    {
        const cv::Mat image = readImage(path);
        requireSize(image, path, calibration.cameras[0].camera->imageSize());
        Scan scan;
        scan.name = stemOf(path);
        const cv::Mat signal = laser.signal(image, path);
        scan.line = findScanLine(signal, calibration, sheet, depth);
        scan.measured = measureOnSheet(calibration, sheet, scan.line.points);
        if (scan.line.points.empty())
            command.warn(!scan.line.mixed ? whyNoLine(o, calibration, sheet, signal, path, elsewhere)
                         : "of the line in '" + path + "' all points are near its ends or steps, where two surfaces are seen");
        for (size_t i = 0; i < scan.line.points.size(); i++)
            if (scan.measured.status[i] == REFRACT_OK)
            {
                points++;
                sigma += cv::norm(scan.measured.sigma[i], cv::NORM_L2SQR);
            }
        ambiguous += scan.line.ambiguous;
        mixed += scan.line.mixed;
        if (!o.pictures.empty())
            drawLine(o, image, scan.name, scan.line.points);
        if (!o.cloud.empty())
            addToCloud(scan, image, cloud);
        scans.push_back(scan);
        progress.step();
    }
    if (!points && elsewhere.points)
        throw Failure(elsewhere.text(o.depth) + ": give the depths of the scene, in the unit of calib.yml");
    if (!points)
        throw Failure("no point of a line could be measured: is the line in the images, and of the colour of the sheet's calibration?");
    if (!o.out.empty())
        writeText(o.out, csvOf(scans));
    if (!o.cloud.empty())
        writeCloud(o.cloud, cloud, calibration.unit);
    if (!o.profile.empty())
        writeText(o.profile, profileOf(scans, calibration.unit));
    if (!command.quiet())
        std::cout << format("%d points in %zu image%s, +- %.3g%s (RMS of one standard deviation, 3-D)\n", points, paths.size(),
                            paths.size() == 1 ? "" : "s", std::sqrt(sigma/points), unitAfter(calibration.unit).c_str())
                  << (mixed ? format("%d points left out, where the line ends, jumps or gets much darker\n", mixed) : std::string())
                  << (ambiguous ? format("%d columns left out, where two lines are about as strong\n", ambiguous) : std::string());
    return DONE;
}

void checkOptions(const Options& o, const std::string& settings)
{
    if (o.sheet.empty() == o.sheetOut.empty())
        throw Failure("give --sheet-out=FILE to calibrate the sheet, or --sheet=FILE to measure with it");
    if (!o.profile.empty())
        Plot::checkAvailable();
    checkOutputs({{"--sheet-out", o.sheetOut, OUTPUT_CALIBRATION}, {"--out", o.out, OUTPUT_TEXT}, {"--cloud", o.cloud, OUTPUT_TEXT},
                  {"--profile", o.profile, OUTPUT_TEXT}},
                 {o.calibration, o.images, o.off, o.emitter, o.sheet, settings});
}

} // namespace

int refract_laser_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        checkOptions(options, command.settings());
        const Calibration asCalibrated = readCalibration(options.calibration, options.noWindow, command);
        const Calibration calibration = options.conditions.appliedTo(asCalibrated, options.calibration);
        if (options.conditions.isSaid() && !command.quiet())
            std::cout << options.conditions.notice(asCalibrated) << '\n';
        return options.calibrates() ? calibrateSheet(options, calibration, command) : measureWithSheet(options, calibration, command);
    });
}
