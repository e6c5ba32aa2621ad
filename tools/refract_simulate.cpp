// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rig_model.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/progress.hpp"
#include "simulate/scene_file.hpp"
#include "simulate/light_source.hpp"
#include "simulate/render.hpp"

#include <opencv2/imgcodecs.hpp>
#include <iostream>
#include <map>
#include <memory>

static const char MANUAL[] = R"(Renders images of a calibration target or a textured scene seen through windows, and the truth.

  refract_simulate RIG.yml --out-dir=DIR

Each pixel's ray is traced through lens and window to the target; edges are anti-aliased; then blur, vignetting, noise
and 8 bits. Writes DIR/SET/STEM.png (several cameras: DIR/SET1, DIR/SET2, ...) and DIR/truth.yml: target, cameras, R and T as
given, and for each image the pose of the target in camera 1 and the exact pixels of its points; and DIR/poses.csv, those
poses as refract_calib --poses takes them.
Of a scene: DIR/SET/scene.png, in colour, and DIR/SET/scene_depth.tiff, float32: z in the frame of the image's camera of
what the pixel's centre sees; NaN where it sees nothing.
In the light of emitters all images are in colour, surfaces of a scene throw shadows, and truth.yml has the lines: for each v of the
emitter the pixel and the point in camera 1.
The same RIG.yml gives the same images.

RIG.yml (cv::FileStorage, lengths in one unit of your choice):

  target: { pattern: chessboard, size: "6x5", square: 39. }   # or circles, acircles, charuco (with
                         # marker: side, dictionary: DICT_4X4_250; aprilgrid: tag_spacing)
  camera1: { image_width, image_height, camera_matrix, distortion_coefficients, lens_model, glass_window }
  camera2: { ... }       # as in calib.yml, up to camera16; one camera: its keys at top level instead
  R, T                   # camera 1 -> camera 2; R3, T3: camera 1 -> camera 3; ...
                         # a window that is not flat: glass_window: { shape: dome, center: [3., 0., 5.], radius: 50., thickness: [5.],
                         # index: [1.49] }, { shape: tube, ..., axis: [0., 1., 0.] }, or { shape: bent, curvature: 1.6e-5, normal ... }
  exposure: { dark: 35., light: 205., background: 110., blur: 0.7, noise: 2., vignetting: 0.2 }
  seed: 1
  channels: [610., 540., 465.]   # wavelengths of red, green and blue, nm: colour images, each colour bent as the window's
                         # materials do; glass_window: { ..., wavelength: 540., materials: [air, N-BK7, water] }
  poses:                 # of the target in camera 1, by name: given, or drawn so that all cameras see all points (with
                         # seen_by: N in the braces, N of them)
    board: [ { rvec: [0., 0., 0.], tvec: [-90., -80., 600.] } ]
    pair: { count: 6, distance: [560., 660.], tilt_deg: [5., 30.], roll_deg: 15., margin: 20. }
  scene:                 # in place of target and poses, or beside them; in the frame of camera 1
    - { shape: plane, point: [0., 0., 1000.], normal: [0., 0., 1.] }      # endless; a rectangle with
                         # right: [1., 0., 0.], half_size: [200., 100.]
    - { shape: sphere, center: [0., 0., 700.], radius: 80., color: [1., 0.8, 0.6] }     # red, green, blue, 0 ... 1
  texture: { size: 60., contrast: 0.8, octaves: 8 }      # of the scene: size of its coarsest grains, each octave halves
                         # it; the finest should be a pixel where the scene is nearest
  emitters:              # lines and fringes of light, by name: a camera that sends light, refracted at its own window
    laser: { camera_matrix, distortion_coefficients, image_width, image_height, glass_window,      # as of a camera
             rvec: [0., -0.4, 0.], tvec: [150., 0., 40.],      # camera 1 -> emitter
             line: 320., width: 4., brightness: 90.,           # u and full width, pixels of the emitter; levels on white
             color: [0., 1., 0.], speckle: 0.1, speckle_size: 0.8 }     # contrast; size of a grain, pixels of the camera
    projector: { ..., brightness: 120., fringes: { periods: [640., 32.], steps: 4, phase: 0. } }     # picture k = 0 ... of
                         # `steps` for each period: (1 + cos(2 pi (u/period - k/steps) + phase))/2; files STEM_1, STEM_2, ...
  sets:                  # what to render; equal poses get equal file names
    direct: { window: 0, poses: [ pair ] }
    glass: { window: 1, poses: [ pair, board ], motion: { rvec: [0., 0., 0.], tvec: [0.02, 0., 0.] } }  # all boards moved by
                         # it in camera 1 (or the mount by its inverse), as they do a little between direct and glass images
    room: { window: 1, scene: 1 }
    scan: { window: 1, scene: 1, emitters: [ laser ] }         # lit by these too)";

namespace {

using namespace tools;
using cv::FileStorage;
using cv::refract::GlassWindow;

struct Job
{
    std::string path;       // in the output folder
    std::string set, stem;
    int camera;
    const ImageSet* settings;
    int picture;            // of fringes
    bool ofScene;           // or of the target
    BoardPose pose;         // of the target in camera 1, before the set's motion
    std::string depthPath;  // of a textured scene; of fringes all have the same
    cv::Mat depth;

    bool window() const { return settings->window; }
    bool isOfScene() const { return ofScene; }
    bool hasDepth() const { return ofScene && picture == 0; }
};

std::vector<Job> listJobs(const Scene& scene, const std::string& extension)
{
    std::vector<Job> jobs;
    for (const ImageSet& set : scene.sets)
        for (int camera = 0; camera < (int)scene.cameras.cameras.size(); camera++)
        {
            const std::string folder = set.name + (scene.cameras.single() ? "" : std::to_string(camera + 1)) + "/";
            const int pictures = set.pictures(), digits = (int)std::to_string(pictures).size();
            for (int k = 0; k < pictures; k++)
            {
                const std::string end = (pictures > 1 ? cv::format("_%0*d.", digits, k + 1) : ".") + extension;
                if (set.scene)
                    jobs.push_back({folder + "scene" + end, set.name, "scene", camera, &set, k, true, {}, folder + "scene_depth.tiff", {}});
                for (const NamedPose& pose : set.poses)
                    jobs.push_back({folder + pose.stem + end, set.name, pose.stem, camera, &set, k, false, pose.pose, "", {}});
            }
        }
    return jobs;
}

cv::Ptr<cv::refract::RefractiveCamera> cameraOf(const Scene& scene, const Job& job)
{
    const auto& camera = scene.cameras.cameras[job.camera].camera;
    cv::Ptr<cv::refract::RefractiveCamera> result =
        copyWithWindow(camera, job.window() ? camera->window() : GlassWindow());
    result->setImageSize(camera->imageSize());
    return result;
}

//! In camera 1.
BoardPose movedPose(const Job& job) { return inOtherCamera(job.pose, job.settings->motion); }

BoardPose poseOf(const Scene& scene, const Job& job)
{
    return inOtherCamera(movedPose(job), scene.cameras.extrinsics[job.camera]);
}

//! The camera in the light of each channel; empty: all see the same.
std::vector<cv::Ptr<cv::refract::RefractiveCamera>> coloursOf(const Scene& scene, const Job& job)
{
    return scene.coloured ? camerasInColours(cameraOf(scene, job), scene.wavelengths, "RIG.yml")
                          : std::vector<cv::Ptr<cv::refract::RefractiveCamera>>();
}

Viewpoint viewOf(const Scene& scene, const Job& job)
{
    return {cameraOf(scene, job), scene.cameras.extrinsics[job.camera].R, scene.cameras.extrinsics[job.camera].t, coloursOf(scene, job)};
}

cv::Mat imageOf(const Scene& scene, const Target* target, const Job& job, uint64_t seed)
{
    const Illumination light = {job.settings->sources, job.picture, job.window(), seed};
    if (job.isOfScene())
        return renderScene(scene.surfaces, viewOf(scene, job), scene.exposure, seed, &light);
    return render(*target, movedPose(job), viewOf(scene, job), scene.exposure, seed, &light);
}

//! Before anything is written, as a camera that sees nothing is a mistake in the file.
void traceDepths(const std::string& rig, const Scene& scene, std::vector<Job>& jobs)
{
    for (Job& job : jobs)
    {
        if (!job.hasDepth())
            continue;
        job.depth = depthOfScene(scene.surfaces, viewOf(scene, job));
        if (cv::countNonZero(job.depth == job.depth) == 0)
            throw Failure("'" + rig + "': set '" + job.set + "': camera " + std::to_string(job.camera + 1) + " sees nothing of "
                          "the 'scene'; move its shapes into view, beyond the window, or turn the camera");
    }
}

void writeTarget(FileStorage& fs, const TargetOptions& options, const Target& target)
{
    fs << "target" << "{" << "pattern" << options.pattern << "size" << options.size << "square" << options.square;
    if (target.pattern() == Target::CHARUCO)
        fs << "marker" << options.marker << "dictionary" << options.dictionary;
    if (target.pattern() == Target::APRILGRID)
        fs << "tag_spacing" << target.tagSpacing();
    fs << "}";
}

//! Where the sheets of light are: the pixel and the point of each of the emitter's v.
void writeLines(FileStorage& fs, const Scene& scene, const Target* target, const Job& job)
{
    if (job.settings->sources.empty() || !job.settings->sources[0].isLine())
        return;
    fs << "lines" << "[";
    for (const LightSource& source : job.settings->sources)
    {
        const TrueLine line = job.isOfScene() ? trueLine(source, job.window(), scene.surfaces, viewOf(scene, job))
            : trueLine(source, job.window(), *target, movedPose(job), viewOf(scene, job));
        fs << "{" << "emitter" << source.name << "pixels" << cv::Mat(line.pixels).reshape(1) << "points" << cv::Mat(line.points).reshape(1)
           << "}";
    }
    fs << "]";
}

//! The list of all views of the target, or of all of the scene.
void writeViews(FileStorage& fs, const Scene& scene, const Target* target, const std::vector<Job>& jobs)
{
    fs << (target ? "views" : "scene_views") << "[";
    for (const Job& job : jobs)
    {
        if (job.isOfScene() == (target != nullptr))
            continue;
        fs << "{" << "file" << job.path << "set" << job.set << "stem" << job.stem << "camera" << job.camera + 1
           << "window" << (int)job.window();
        if (job.isOfScene())
            fs << "depth" << job.depthPath;
        else
        {
            const std::vector<cv::Point2d> pixels = projectTarget(*target, poseOf(scene, job), cameraOf(scene, job));
            fs << "rvec" << movedPose(job).rvec << "tvec" << movedPose(job).tvec << "pixels" << cv::Mat(pixels).reshape(1);
        }
        writeLines(fs, scene, target, job);
        fs << "}";
    }
    fs << "]";
}

void writeEmitters(FileStorage& fs, const Scene& scene)
{
    if (scene.sources.empty())
        return;
    fs << "emitters" << "{";
    for (const LightSource& source : scene.sources)
    {
        fs << source.name << "{";
        writeEmitter(fs, source.emitter);
        fs << "}";
    }
    fs << "}";
}

void writeTruth(const std::string& path, const Scene& scene, const Target* target, const std::vector<Job>& jobs,
                const std::string& command)
{
    writeStorage(path, ".yml", [&](FileStorage& fs)
    {
        fs << "command" << command;
        if (target)
            writeTarget(fs, scene.target, *target);
        writeCameras(fs, calibrationOf(modelOf(scene.cameras)));
        writeEmitters(fs, scene);
        if (target)
            writeViews(fs, scene, target, jobs);
        if (!scene.surfaces.surfaces.empty())
            writeViews(fs, scene, nullptr, jobs);
    });
}

//! The poses of the target as refract_calib takes them, each once.
void writePoses(const std::string& path, const std::vector<Job>& jobs)
{
    std::map<std::string, BoardPose> poses;
    for (const Job& job : jobs)
        if (!job.isOfScene())
            poses[job.stem] = job.pose;
    std::string text = "view,rx_deg,ry_deg,rz_deg,tx,ty,tz\n";
    for (const auto& entry : poses)
    {
        const cv::Vec3d r = entry.second.rvec*(180./CV_PI), t = entry.second.tvec;
        text += entry.first + cv::format(",%.15g,%.15g,%.15g,%.15g,%.15g,%.15g\n", r[0], r[1], r[2], t[0], t[1], t[2]);
    }
    writeText(path, text);
}

void renderAll(const std::string& folder, const Scene& scene, const Target* target, const std::vector<Job>& jobs,
               const std::vector<int>& parameters, bool quiet)
{
    Progress progress("rendering", (int)jobs.size(), quiet);
    for (size_t i = 0; i < jobs.size(); i++)
    {
        const Job& job = jobs[i];
        progress.at(job.path);
        writeImage(folder + "/" + job.path, imageOf(scene, target, job, scene.seed*1000003 + i + 1), parameters);
        if (job.hasDepth())
            writeImage(folder + "/" + job.depthPath, job.depth);
        progress.step();
    }
}

//! DIR/truth.yml is a scene too, and may be the one that is read.
void refuseOverwriting(const std::vector<std::string>& files, const Scene& scene, const std::string& folder,
                       const std::vector<Job>& jobs)
{
    std::vector<Output> outputs = {{"--out-dir", folder + "/truth.yml", OUTPUT_IN_FOLDER}};
    if (scene.target.given())
        outputs.push_back({"--out-dir", folder + "/poses.csv", OUTPUT_IN_FOLDER});
    for (const Job& job : jobs)
    {
        outputs.push_back({"--out-dir", folder + "/" + job.path, OUTPUT_IN_FOLDER});
        if (job.hasDepth())
            outputs.push_back({"--out-dir", folder + "/" + job.depthPath, OUTPUT_IN_FOLDER});
    }
    checkOutputs(outputs, files);
}

} // namespace

int refract_simulate_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        std::string rig, folder, extension = "png";
        int quality = 92;
        command.parser.add("RIG.yml", rig, "what to render").required();
        command.parser.add("--out-dir", folder, "folder to write to, made if it is not there").required();
        command.parser.add("--format", extension, "png, jpg or webp")
            .check(isMember({"png", "jpg", "webp"})).captureDefault();
        command.parser.add("--quality", quality, "of jpg and webp, 1 ... 100")
            .check(isCountUpTo(100)).captureDefault();
        command.parse();

        const Scene scene = readScene(rig);
        std::unique_ptr<const Target> target;
        if (scene.target.given())
            target = std::make_unique<Target>(scene.target);
        std::vector<Job> jobs = listJobs(scene, extension);
        refuseOverwriting({rig, command.settings()}, scene, folder, jobs);
        traceDepths(rig, scene, jobs);
        for (const Job& job : jobs)
            makeFolder(folder + "/" + job.path.substr(0, job.path.find('/')));
        std::vector<int> parameters;
        if (extension != "png")
            parameters = {extension == "jpg" ? (int)cv::IMWRITE_JPEG_QUALITY : (int)cv::IMWRITE_WEBP_QUALITY, quality};
        renderAll(folder, scene, target.get(), jobs, parameters, command.quiet());
        writeTruth(folder + "/truth.yml", scene, target.get(), jobs, command.line());
        if (target)
            writePoses(folder + "/poses.csv", jobs);
        if (!command.quiet())
            std::cout << jobs.size() << " images and truth.yml written to " << folder << std::endl;
        return DONE;
    });
}
