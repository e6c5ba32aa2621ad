#include "calibrate/rig_model.hpp"
#include "console/file_output.hpp"
#include "console/outputs.hpp"
#include "console/progress.hpp"
#include "simulate/scene_file.hpp"

#include <opencv2/imgcodecs.hpp>
#include <iostream>

static const char MANUAL[] = R"(Renders images of a calibration target seen through flat windows, and the truth.

  refract_simulate RIG.yml --out-dir=DIR

Each pixel's ray is traced through lens and window to the target; edges are anti-aliased; then blur, vignetting, noise
and 8 bits. Writes DIR/SET/STEM.png (two cameras: DIR/SET1, DIR/SET2) and DIR/truth.yml: target, cameras, R and T as
given, and for each image the pose of the target in camera 1 and the exact pixels of its points.
The same RIG.yml gives the same images.

RIG.yml (cv::FileStorage, lengths in one unit of your choice):

  target: { pattern: chessboard, size: 6x5, square: 39. }     # or circles, acircles, charuco (with
                         # marker: side, dictionary: DICT_4X4_250)
  camera1: { image_width, image_height, camera_matrix, distortion_coefficients, lens_model, glass_window }
  camera2: { ... }       # as in calib.yml; one camera: its keys at top level instead
  R, T                   # camera 1 -> camera 2
  exposure: { dark: 35., light: 205., background: 110., blur: 0.7, noise: 2., vignetting: 0.2 }
  seed: 1
  poses:                 # of the target in camera 1, by name: given, or drawn so that all cameras see all points
    board: [ { rvec: [0., 0., 0.], tvec: [-90., -80., 600.] } ]
    pair: { count: 6, distance: [560., 660.], tilt_deg: [5., 30.], roll_deg: 15., margin: 20. }
  sets:                  # what to render; equal poses get equal file names
    direct: { window: 0, poses: [ pair ] }
    glass: { window: 1, poses: [ pair, board ] })";

namespace {

using namespace tools;
using cv::FileStorage;
using cv::refract::GlassWindow;

struct Job
{
    std::string path;       // in the output folder
    std::string set, stem;
    int camera;
    bool window;
    BoardPose pose;         // in camera 1
};

std::vector<Job> listJobs(const Scene& scene, const std::string& extension)
{
    std::vector<Job> jobs;
    for (const ImageSet& set : scene.sets)
        for (int camera = 0; camera < (int)scene.cameras.cameras.size(); camera++)
            for (const NamedPose& pose : set.poses)
            {
                const std::string folder = set.name + (scene.cameras.stereo() ? std::to_string(camera + 1) : "");
                jobs.push_back({folder + "/" + pose.stem + "." + extension, set.name, pose.stem, camera, set.window,
                                pose.pose});
            }
    return jobs;
}

cv::Ptr<cv::refract::RefractiveCamera> cameraOf(const Scene& scene, const Job& job)
{
    const auto& camera = scene.cameras.cameras[job.camera].camera;
    cv::Ptr<cv::refract::RefractiveCamera> result =
        copyWithWindow(camera, job.window ? camera->window() : GlassWindow());
    result->setImageSize(camera->imageSize());
    return result;
}

BoardPose poseOf(const Scene& scene, const Job& job)
{
    return job.camera ? inSecondCamera(job.pose, scene.cameras.R, scene.cameras.T) : job.pose;
}

void writeTruth(const std::string& path, const Scene& scene, const Target& target, const std::vector<Job>& jobs,
                const std::string& command)
{
    OutputFile file(path);
    FileStorage fs(file.temporary(), FileStorage::WRITE);
    fs << "command" << command << "target" << "{" << "pattern" << scene.target.pattern << "size" << scene.target.size
       << "square" << scene.target.square;
    if (target.pattern() == Target::CHARUCO)
        fs << "marker" << scene.target.marker << "dictionary" << scene.target.dictionary;
    fs << "}";
    if (scene.cameras.stereo())
    {
        for (int i = 0; i < 2; i++)
        {
            fs << "camera" + std::to_string(i + 1) << "{";
            scene.cameras.cameras[i].camera->write(fs);
            fs << "}";
        }
        fs << "R" << cv::Mat(scene.cameras.R) << "T" << cv::Mat(scene.cameras.T);
    }
    else
        scene.cameras.cameras[0].camera->write(fs);
    fs << "views" << "[";
    for (const Job& job : jobs)
    {
        const std::vector<cv::Point2d> pixels = projectTarget(target, poseOf(scene, job), cameraOf(scene, job));
        fs << "{" << "file" << job.path << "set" << job.set << "stem" << job.stem << "camera" << job.camera + 1
           << "window" << (int)job.window << "rvec" << job.pose.rvec << "tvec" << job.pose.tvec
           << "pixels" << cv::Mat(pixels).reshape(1) << "}";
    }
    fs << "]";
    fs.release();
    file.commit();
}

void renderAll(const std::string& folder, const Scene& scene, const Target& target, const std::vector<Job>& jobs,
               const std::vector<int>& parameters, bool quiet)
{
    Progress progress("rendering", (int)jobs.size(), quiet);
    for (size_t i = 0; i < jobs.size(); i++)
    {
        progress.at(jobs[i].path);
        const cv::Mat image = render(target, poseOf(scene, jobs[i]), cameraOf(scene, jobs[i]), scene.exposure,
                                     scene.seed*1000003 + i + 1);
        writeImage(folder + "/" + jobs[i].path, image, parameters);
        progress.step();
    }
}

//! DIR/truth.yml is a scene too, and may be the one that is read.
void refuseOverwriting(const std::string& rig, const std::string& folder, const std::vector<Job>& jobs)
{
    std::vector<Output> outputs = {{"--out-dir", folder + "/truth.yml", OUTPUT_IN_FOLDER}};
    for (const Job& job : jobs)
        outputs.push_back({"--out-dir", folder + "/" + job.path, OUTPUT_IN_FOLDER});
    checkOutputs(outputs, {rig});
}

} // namespace

int main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        std::string rig, folder, extension = "png";
        int quality = 92;
        command.app.add_option("RIG.yml", rig, "what to render")->required();
        command.app.add_option("--out-dir", folder, "folder to write to, made if it is not there")->required();
        command.app.add_option("--format", extension, "png, jpg or webp")
            ->check(CLI::IsMember({"png", "jpg", "webp"}))->capture_default_str();
        command.app.add_option("--quality", quality, "of jpg and webp, 1 ... 100")
            ->check(CLI::Range(1, 100))->capture_default_str();
        command.parse();

        const Scene scene = readScene(rig);
        const Target target(scene.target);
        const std::vector<Job> jobs = listJobs(scene, extension);
        refuseOverwriting(rig, folder, jobs);
        for (const Job& job : jobs)
            makeFolder(folder + "/" + job.path.substr(0, job.path.find('/')));
        std::vector<int> parameters;
        if (extension != "png")
            parameters = {extension == "jpg" ? (int)cv::IMWRITE_JPEG_QUALITY : (int)cv::IMWRITE_WEBP_QUALITY, quality};
        renderAll(folder, scene, target, jobs, parameters, command.quiet());
        writeTruth(folder + "/truth.yml", scene, target, jobs, command.line());
        if (!command.quiet())
            std::cout << jobs.size() << " images and truth.yml written to " << folder << std::endl;
        return DONE;
    });
}
