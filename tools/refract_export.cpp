// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calib_file.hpp"
#include "calibrate/window_face.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "console/table.hpp"
#include "export/export_files.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>

static const char MANUAL[] = R"(Tells other programs of cameras behind windows: those that know none as well as that can be done.

  refract_export calib.yml --to=opencv --depth=400,1200 --out=central.yml
  refract_export calib.yml --to=mrcal --depth=400,1200 --out-dir=DIR       camera1.cameramodel ...
  refract_export calib.yml --to=ros --depth=400,1200 --out-dir=DIR         camera1.yaml ... (sensor_msgs/CameraInfo)
  refract_export calib.yml --to=colmap --depth=400,1200 [--points=points.csv] --out-dir=DIR
  refract_export calib.yml --to=calibmar --out-dir=DIR                     camera1.yaml ..., with the windows: exact
  refract_export calib.yml --to=colmap-underwater [--points=points.csv] --out-dir=DIR      the model, with the windows: exact
  refract_export calib.yml --to=openptv --out-dir=DIR                      cam1.tif.ori, cam1.tif.addpar ..., ptv.par: exact

No camera without a window sees what one behind a window sees, but for one depth. What is written is the central camera (place,
direction, lens) that comes nearest for scenes between the two depths z of --depth, in the frame of each camera and the unit of
calib.yml. How far off it is stands in the files and in the table: in pixels, and as a length at the point. Exit code 2 if a
camera's largest error is above --max-error pixels: give a smaller range, or measure with refract_measure, which is exact.

--points, what refract_measure wrote: COLMAP's model gets the points, each with the pixels where the central cameras would have
seen it. These are exact, whatever the table says. --image-extension=.png makes the names of its images those of files.

Calibmar and COLMAP's fork for cameras under water know flat windows and domes of one layer without a wedge, and get them as they are;
others are refused.
OpenPTV knows flat panes of one layer, the same for all cameras, and distortion about the middle of the image. Its world begins behind the
window of camera 1, with that camera's axes, y up and z back; its pixels are 0.01 mm.)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

struct Options
{
    std::string calibration, target, depth, out, folder, points, extension;
    int coefficients = -1;
    double maxError = 0;        // px; 0: none
};

void addOptions(OptionParser& parser, Options& options)
{
    parser.add("calib.yml", options.calibration, "what refract_calib wrote, of any number of cameras").required();
    parser.add("--to", options.target, "whom to tell").required()
        .check(isMember({"opencv", "mrcal", "colmap", "ros", "calibmar", "colmap-underwater", "openptv"}));
    parser.add("--depth", options.depth, "NEAR,FAR: z of the scene in the frame of each camera (not for those that know windows)");
    parser.addFormerName("--range", "--depth");
    parser.add("--out", options.out, "file to write, .yml, .xml or .json (--to=opencv)");
    parser.add("--out-dir", options.folder, "folder to write to, made if it is not there (the others)");
    parser.add("--points", options.points, "points.csv of refract_measure (--to=colmap and colmap-underwater)");
    parser.add("--image-extension", options.extension, "what the names of COLMAP's images end in, such as .png (default: nothing, as "
               "points.csv does not say)").needs(parser.get("--points"));
    parser.add("--coefficients", options.coefficients, "of OpenCV's lens model, 4, 5, 8, 12 or 14, or 0 for the fisheye "
               "model (default: 8 if they help, else 5 or 4; 0 for fisheye lenses; --to=mrcal leaves the lens of a camera without a "
               "window as it is)");
    parser.add("--max-error", options.maxError, "px: exit code 2 if a camera is further off").check(moreThanZero());
}

//! Whether the other program knows windows.
bool isExact(const Options& options)
{
    return options.target == "calibmar" || options.target == "colmap-underwater" || options.target == "openptv";
}

void checkCombination(const Options& options, const std::string& settings)
{
    const bool isFile = options.target == "opencv";
    if ((isFile ? options.out : options.folder).empty() || !(isFile ? options.folder : options.out).empty())
        throw Failure("--to=" + options.target + (isFile ? " writes one file: give --out=FILE, and no --out-dir"
                                                         : " writes several files: give --out-dir=DIR, and no --out"));
    if (!options.points.empty() && options.target.compare(0, 6, "colmap") != 0)
        throw Failure("--points: only COLMAP's model has points; give --to=colmap, or leave it out");
    if (options.depth.empty() != isExact(options))
        throw Failure("--to=" + options.target + (isExact(options) ? " is exact at all depths: leave --depth out"
                                                                   : " is good for a range of depths: give --depth=NEAR,FAR"));
    if (isExact(options) && (options.coefficients >= 0 || options.maxError > 0))
        throw Failure("--to=" + options.target + " is exact: leave --coefficients and --max-error out");
    if (isFile)
        checkOutputs({{"--out", options.out, OUTPUT_CALIBRATION}}, {options.calibration, settings});
}

//! OpenCV's lens models that the other program knows, by their coefficients; 0: fisheye.
std::vector<int> modelsOf(const std::string& target)
{
    static const std::map<std::string, std::vector<int>> known = {
        {"opencv", {0, 4, 5, 8, 12, 14}}, {"mrcal", {4, 5, 8, 12}}, {"colmap", {0, 4, 8}}, {"ros", {0, 5, 8}}};
    return known.at(target);
}

//! With the lens model asked for, else the plainest that is nearly as good as the rational one.
CentralCamera bestCentralCamera(const Options& options, const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Vec2d& range,
                                const std::string& name)
{
    const std::vector<int> models = modelsOf(options.target);
    const auto isKnown = [&](int coefficients) { return std::find(models.begin(), models.end(), coefficients) != models.end(); };
    if (options.coefficients >= 0 && !isKnown(options.coefficients))
        throw Failure(format("--coefficients=%d: %s has no such lens model", options.coefficients, options.target.c_str()));
    if (options.coefficients >= 0)
        return fitCentralCamera(camera, range, options.coefficients, name);
    const cv::refract::GlassWindow window = camera->window();
    const bool isMrcals = camera->lensModel().find("LENSMODEL_") == 0;
    if (options.target == "mrcal" && isMrcals && !refracts(window))
        return centralCamera(camera, range);
    if (camera->lensModel() == "fisheye" && isKnown(0))
        return fitCentralCamera(camera, range, 0, name);
    const double NEARLY = 1.1;
    const CentralCamera plain = fitCentralCamera(camera, range, isKnown(5) ? 5 : 4, name);
    const CentralCamera rational = fitCentralCamera(camera, range, 8, name);
    const bool rationalDiverged = std::isnan(rational.error.rms);
    return rationalDiverged || plain.error.rms <= NEARLY*rational.error.rms ? plain : rational;
}

//! With the size of each image.
Calibration readComplete(const Options& options, const Command& command)
{
    const Calibration calibration = readCalibration(options.calibration);
    warnOfContradictions(calibration, options.calibration, command);
    for (size_t c = 0; c < calibration.cameras.size(); c++)
        if (calibration.cameras[c].camera->imageSize().empty())
            throw Failure(format("'%s' does not say image_width and image_height of camera%zu: add them",
                                 options.calibration.c_str(), c + 1));
    return calibration;
}

std::string sourceOf(const Options& options) { return fs::path(options.calibration).filename().string(); }

CentralRig centralRigOf(const Options& options, const cv::Vec2d& range, const Command& command)
{
    const Calibration calibration = readComplete(options, command);
    CentralRig rig = {{}, sourceOf(options), range, calibration.unit};
    Progress progress("fitting central cameras", (int)calibration.cameras.size(), command.quiet());
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const cv::Ptr<cv::refract::RefractiveCamera> camera = calibration.cameras[c].camera;
        const RigidTransform& pose = calibration.extrinsics[c];
        const std::string name = format("camera%d", (int)c + 1);
        progress.at(name);
        const CentralCamera central = bestCentralCamera(options, camera, range, name);
        requireNear(central, name);
        rig.cameras.push_back({name, camera, pose, central, central.pose*pose});
        progress.step();
    }
    return rig;
}

std::vector<MeasuredPoint> pointsOf(const Options& options, size_t cameras)
{
    return options.points.empty() ? std::vector<MeasuredPoint>() : readMeasuredPoints(options.points, (int)cameras);
}

std::vector<ExportFile> exactFiles(const Options& options, const Calibration& calibration)
{
    if (options.target == "openptv")
        return openPtvFiles(calibration);
    if (options.target == "calibmar")
        return calibmarFiles(calibration, sourceOf(options));
    return underwaterColmapFiles(calibration, sourceOf(options), pointsOf(options, calibration.cameras.size()), options.extension);
}

//! @return what was written
std::vector<std::string> writeFolder(const Options& options, const std::string& settings, const std::vector<ExportFile>& files)
{
    std::vector<std::string> written;
    std::vector<Output> outputs;
    for (const ExportFile& file : files)
        outputs.push_back({"--out-dir", options.folder + "/" + file.name, OUTPUT_IN_FOLDER});
    checkOutputs(outputs, {options.calibration, options.points, settings});
    makeFolder(options.folder);
    for (const ExportFile& file : files)
    {
        written.push_back((fs::path(options.folder)/file.name).string());
        writeText(written.back(), file.text);
    }
    return written;
}

std::vector<std::string> write(const Options& options, const std::string& settings, const CentralRig& rig)
{
    if (options.target == "opencv")
    {
        writeOpenCV(options.out, rig);
        return {options.out};
    }
    return writeFolder(options, settings, options.target == "mrcal" ? mrcalFiles(rig) : options.target == "ros" ? rosFiles(rig)
                                          : colmapFiles(rig, pointsOf(options, rig.cameras.size()), options.extension));
}

void printTable(const CentralRig& rig)
{
    const std::string length = rig.unit.empty() ? "length" : rig.unit;
    Table table({"central camera", "rms, px", "max, px", "rms, " + length, "max, " + length,
                 "moved by" + (rig.unit.empty() ? "" : ", " + rig.unit)});
    for (const ExportedCamera& camera : rig.cameras)
    {
        const CentralError& e = camera.central.error;
        table.add({camera.name, format("%.3g", e.rms), format("%.3g", e.max), format("%.3g", e.lengthRms), format("%.3g", e.lengthMax),
                   format("%.4g", cv::norm(camera.central.pose.t))});
    }
    table.print(std::cout);
}

void printWritten(const std::vector<std::string>& files, const Command& command)
{
    if (!command.quiet())
        std::cout << "Written: " << listed(files) << '\n';
}

} // namespace

int refract_export_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        checkCombination(options, command.settings());
        if (isExact(options))
        {
            const std::vector<ExportFile> files = exactFiles(options, readComplete(options, command));
            printWritten(writeFolder(options, command.settings(), files), command);
            return DONE;
        }
        const cv::Vec2d range = parseFiniteDepthRange(options.depth, "--depth");
        const CentralRig rig = centralRigOf(options, range, command);
        const std::vector<std::string> files = write(options, command.settings(), rig);
        if (!command.quiet())
            printTable(rig);
        printWritten(files, command);
        double worst = 0;
        for (const ExportedCamera& camera : rig.cameras)
            worst = camera.central.error.max <= worst ? worst : camera.central.error.max;
        return options.maxError > 0 && !(worst <= options.maxError) ? LIMIT_NOT_MET : DONE;
    });
}
