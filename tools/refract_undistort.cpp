// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_output.hpp"
#include "calibrate/calib_file.hpp"
#include "calibrate/light.hpp"
#include "calibrate/rig_data.hpp"
#include "colmap/pinhole_images.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/frames.hpp"
#include "console/images.hpp"
#include "console/progress.hpp"

#include <opencv2/imgproc.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>

static const char MANUAL[] = R"(Turns images taken through the window into those that a pinhole camera without window would take.

  refract_undistort calib.yml IMAGE... --depth=600 --out-dir=DIR
  refract_undistort calib.yml IMAGE... --plane=0,0,1,600 --out-dir=DIR
  refract_undistort again.yml --colmap=refracted --image-dir=images --out-dir=dense

The correction depends on where the scene is: exact for points on the plane z = depth (or a x + b y + c z = d, in the
camera's frame); --depth=inf for scenes far away. The new images have the old names, size and camera matrix; pixels that
the old image does not show are black, and transparent where the image has an alpha channel. Depth and channels stay; pixels
are taken as they are stored, whatever the EXIF data say of the camera's orientation.

--channels corrects each colour of a colour image for its own wavelength, as a window in front of water bends blue more than red;
calib.yml must say what the window is made of (refract_calib --index=N-BK7 --outer-index=water). Without it, all colours are
corrected as that of the calibration.

--colmap: the model that refract_bundle --colmap-out wrote, with the calibration of the same run. Each image is corrected at the depth of
the points that it shows, interpolated between them; what is left by wrong depth is said, from points that take no part. DIR/images,
DIR/sparse (PINHOLE cameras) and DIR/stereo are what COLMAP's dense stereo, OpenMVS and others take.

IMAGE may be a quoted glob, numbered images (left%04d.png) or a video (.avi, .mp4, .mkv ...); frames of a video become
frame000001.png and so on.)";

namespace {

using namespace tools;
namespace fs = std::filesystem;

struct Options
{
    std::string calibration, folder, depth, plane, channels, colmap, imageFolder, summary;
    std::vector<std::string> sources;
    int camera = 1;
    bool noWindow = false;
};

//! What initRefractiveUndistortRectifyMap calls depth: one number, a plane, or nothing for infinitely far.
std::vector<double> depthOf(const Options& options)
{
    if (options.depth.empty() == options.plane.empty())
        throw Failure("give either --depth=Z or --plane=a,b,c,d: the correction depends on where the scene is");
    if (options.depth == "inf")
        return {std::numeric_limits<double>::infinity()};
    if (!options.plane.empty())
    {
        const cv::Vec4d plane = parsePlane(options.plane);
        return std::vector<double>(plane.val, plane.val + 4);
    }
    const std::vector<double> numbers = parseNumbers(options.depth, "--depth");
    if (numbers.size() != 1 || numbers[0] <= 0)
        throw Failure("--depth=" + options.depth + ": one distance, more than 0, is needed (or inf)");
    return {numbers[0]};
}

//! One image to correct.
struct Job
{
    size_t source;          // of all that were named
    int frame;
    std::string output;
};

//! A file keeps its name; what a video shows gets one.
std::string outputName(const Frames& frames, int i)
{
    return frames.isVideo() ? frames.stem(i) + ".png" : fs::path(frames.files()[i]).filename().string();
}

std::vector<Job> listJobs(const Options& options, const std::vector<Frames>& sources)
{
    std::map<std::string, std::string> inputOf;
    std::vector<Job> jobs;
    for (size_t k = 0; k < sources.size(); k++)
        for (int i = 0; i < sources[k].size(); i++)
        {
            const std::string output = (fs::path(options.folder)/outputName(sources[k], i)).string(), name = sources[k].name(i);
            std::string& input = inputOf[output];
            if (input == name && !sources[k].isVideo())       // named twice
                continue;
            if (!input.empty())
                throw Failure("'" + name + "' and '" + input + "' have the same name: correct them one by one");
            input = name;
            jobs.push_back({k, i, output});
        }
    return jobs;
}

void refuseOverwriting(const Options& options, const std::string& settings, const std::vector<Frames>& sources,
                       const std::vector<Job>& jobs)
{
    std::vector<Output> outputs;
    std::vector<std::string> inputs = {options.calibration, settings};
    for (const Frames& frames : sources)
        for (const std::string& path : frames.paths())
            inputs.push_back(path);
    for (const Job& job : jobs)
        outputs.push_back({"--out-dir", job.output, OUTPUT_IN_FOLDER});
    checkOutputs(outputs, inputs);
}

class Corrector
{
public:
    //! @param cameras one for all channels, or one for each
    Corrector(const std::vector<cv::Ptr<cv::refract::RefractiveCamera>>& cameras, const std::vector<double>& depth)
        : cameras_(cameras), depth_(depth) {}

    //! @param name of the image, for a sentence
    cv::Mat correct(const cv::Mat& image, const std::string& name)
    {
        requireSize(image, name, cameras_[0]->imageSize());
        if (cameras_.size() > 1 && image.channels() < (int)cameras_.size())
            throw Failure("'" + name + "' is a grey image: --channels is for colours, leave it out");
        if (maps_.empty() || maps_[0].size() != image.size())
            makeMaps(image.size());
        return remapChannels(image, maps_, cv::INTER_CUBIC);
    }

private:
    void makeMaps(cv::Size size)
    {
        maps_.clear();
        for (const auto& camera : cameras_)
        {
            cv::Mat map, none;
            cv::refract::initRefractiveUndistortRectifyMap(camera, depth_, cv::noArray(), cv::noArray(), size, CV_32FC2, map, none);
            if (cv::countNonZero(map.reshape(1) >= 0.f) == 0)
                throw Failure("the camera sees nothing of that --depth or --plane: it must lie beyond the window, in the unit "
                              "of the calibration, and in front of the camera");
            maps_.push_back(map);
        }
    }

    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras_;
    std::vector<double> depth_;
    std::vector<cv::Mat> maps_;
};

void addOptions(OptionParser& parser, Options& options)
{
    parser.add("calib.yml", options.calibration, "what refract_calib wrote").required();
    const Option images = parser.add("IMAGE", options.sources, "images, quoted globs, numbered images or videos");
    const Option depth = parser.add("--depth", options.depth, "z of the scene in the camera's frame; inf: far away");
    const Option plane = parser.add("--plane", options.plane, "a,b,c,d: the scene lies on a x + b y + c z = d");
    parser.add("--out-dir", options.folder, "folder to write to, made if it is not there").required();
    const Option channels = parser.add("--channels", options.channels, "R,G,B: wavelength of each channel, nm, as 610,540,465 of a usual "
                                       "sensor; each is corrected by itself");
    const Option camera = parser.add("--camera", options.camera, "which camera of the rig took the images")
        .check(isCountUpTo(MAX_CAMERAS)).captureDefault();
    Option colmap = parser.add("--colmap", options.colmap, "folder with the model that refract_bundle --colmap-out wrote");
    for (const Option& other : {images, depth, plane, channels, camera})
        colmap.excludes(other);
    colmap.needs(parser.add("--image-dir", options.imageFolder, "folder of the images that the model names").needs(colmap));
    parser.add("--summary", options.summary, "JSON file with what is said of --colmap").needs(colmap);
    parser.addFlag("--no-window", options.noWindow, "calib.yml has no glass_window, and there is none");
}

int undistortSurvey(const Options& options, const Calibration& calibration, const Command& command)
{
    const ColmapModel model = readColmapModel(options.colmap);
    std::vector<std::string> inputs = {options.calibration, command.settings()};
    for (bool isBinary : {true, false})
        for (const std::string& file : colmapFilesOf(options.colmap, isBinary))
            inputs.push_back(file);
    checkOutputs({{"--summary", options.summary, OUTPUT_TEXT}}, inputs);
    checkPinholeImages(model, inputs, options.imageFolder, options.folder);
    const PinholeImages done = writePinholeImages(model, calibration, options.imageFolder, options.folder, command.quiet());
    if (!options.summary.empty())
        writeText(options.summary, pinholeImagesJson(done, command.line()));
    if (!command.quiet())
        std::cout << cv::format("%d image%s written to %s/images, corrected at the depth of %zu pixels;\n", done.images,
                                done.images == 1 ? "" : "s", options.folder.c_str(), done.points)
                  << (std::isnan(done.rms) ? std::string("too few points in an image to say what wrong depth between them does\n")
                      : cv::format("off by wrong depth between them: %.2g px RMS, 95 %% below %.2g px\n", done.rms, done.most));
    if (!command.quiet() && !done.leftOut.empty())
        std::cout << fittedLine("images left out, which show no point: ", done.leftOut) << "\n";
    return DONE;
}

int undistortImages(const Options& options, const Calibration& calibration, const Command& command)
{
    if (options.sources.empty())
        throw Failure("give the images to correct, or --colmap and --image-dir");
    const std::vector<double> depth = depthOf(options);
    const bool byColour = !options.channels.empty();
    const ChannelWavelengths wavelengths = byColour ? parseChannels(options.channels) : ChannelWavelengths();
    if (options.camera > (int)calibration.cameras.size())
        throw Failure(cv::format("--camera=%d: '%s' has %d camera%s", options.camera, options.calibration.c_str(),
                                 (int)calibration.cameras.size(), calibration.cameras.size() == 1 ? "" : "s"));
    std::vector<Frames> sources;
    for (const std::string& source : options.sources)
        sources.emplace_back(source);
    const std::vector<Job> jobs = listJobs(options, sources);
    refuseOverwriting(options, command.settings(), sources, jobs);
    const auto camera = calibration.cameras[options.camera - 1].camera;
    Corrector corrector(byColour ? camerasInColours(camera, wavelengths, options.calibration) : std::vector{camera}, depth);
    Progress progress("correcting images", (int)jobs.size(), command.quiet());
    for (const Job& job : jobs)
    {
        Frames& frames = sources[job.source];
        progress.at(frames.name(job.frame));
        const cv::Mat corrected = corrector.correct(frames.read(job.frame, true), frames.name(job.frame));
        makeFolder(options.folder);     // now that there is something to write
        writeImage(job.output, corrected);
        progress.step();
    }
    if (!command.quiet())
    {
        const std::string notice = byColour ? "each colour by itself" : oneColourNotice(*camera);
        std::cout << jobs.size() << (jobs.size() == 1 ? " image" : " images") << " written to " << options.folder
                  << (notice.empty() ? "" : ", corrected " + notice) << std::endl;
    }
    return DONE;
}

} // namespace

int refract_undistort_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        if (options.colmap.empty() && !options.sources.empty())
            depthOf(options);           // before any file is read
        const Calibration calibration = readCalibration(options.calibration, options.noWindow, command);
        return options.colmap.empty() ? undistortImages(options, calibration, command) : undistortSurvey(options, calibration, command);
    });
}
