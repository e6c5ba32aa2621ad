// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/scene_file.hpp"
#include "calibrate/rig_model.hpp"
#include "camera/storage.hpp"
#include "console/failure.hpp"
#include "console/keys.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <algorithm>
#include <cmath>
#include <map>

namespace tools {

using cv::FileNode;
using cv::FileStorage;
using cv::Point2d;
using cv::Vec3d;
using cv::refract::GlassWindow;
using std::make_shared;

namespace {

const double SMALLEST = 1e-9, LARGEST = 1e9;        // lengths, in any unit

using SurfacePtr = std::shared_ptr<const Surface>;

Vec3d readColor(const Keys& keys)
{
    const Vec3d color = keys.vector("color", Vec3d(1, 1, 1));
    for (int i = 0; i < 3; i++)
        if (!(color[i] >= 0 && color[i] <= 1))
            throw Failure(keys.name() + ": 'color' must be red, green and blue from 0 to 1");
    return color;
}

//! Unit vector.
Vec3d readDirection(const Keys& keys, const std::string& key)
{
    const Vec3d direction = keys.vector(key);
    const double length = cv::norm(direction);
    if (!(length > 0 && std::isfinite(length)))
        throw Failure(keys.name() + ": '" + key + "' must not be 0");
    return direction*(1/length);
}

SurfacePtr readPlane(const Keys& keys)
{
    keys.allowOnly({"shape", "color", "point", "normal", "right", "half_size"});
    const Vec3d point = keys.vector("point"), normal = readDirection(keys, "normal");
    if (keys.has("right") != keys.has("half_size"))
        throw Failure(keys.name() + ": 'right' and 'half_size' make a rectangle together; leave both out for an endless plane");
    if (!keys.has("right"))
        return make_shared<Plane>(point, normal, readColor(keys));
    const Vec3d right = readDirection(keys, "right");
    const std::vector<double> half = keys.numbers("half_size", 2);
    if (!(half[0] > 0 && half[1] > 0))
        throw Failure(keys.name() + ": 'half_size' must be two numbers more than 0");
    if (cv::norm(right.cross(normal)) < 1e-6)
        throw Failure(keys.name() + ": 'right' must not be along 'normal'");
    return make_shared<Plane>(point, normal, right, cv::Size2d(half[0], half[1]), readColor(keys));
}

SurfacePtr readSphere(const Keys& keys)
{
    keys.allowOnly({"shape", "color", "center", "radius"});
    return make_shared<Sphere>(keys.vector("center"), keys.number("radius", SMALLEST, LARGEST), readColor(keys));
}

SurfacePtr readSurface(const Keys& keys)
{
    const std::string shape = keys.text("shape", "");
    if (shape == "plane")
        return readPlane(keys);
    if (shape == "sphere")
        return readSphere(keys);
    throw Failure(keys.name() + ": 'shape' must be plane or sphere");
}

TextureOptions readTexture(const FileNode& node, const std::string& filename)
{
    const Keys keys(node, "'" + filename + "': texture");
    keys.allowOnly({"size", "contrast", "octaves"});
    TextureOptions texture;
    texture.size = keys.number("size", SMALLEST, LARGEST);
    texture.contrast = keys.number("contrast", 0, 1, texture.contrast);
    texture.octaves = (int)keys.number("octaves", 1, 32, texture.octaves);
    return texture;
}

} // namespace

//! Throws Failure that names the file and the key.
static TexturedScene readSurfaces(const FileNode& scene, const FileNode& texture, const std::string& filename)
{
    TexturedScene result;
    if (!scene.isSeq() || scene.size() == 0)
        throw Failure("'" + filename + "': 'scene' must be a list of shapes, as in - { shape: sphere, ... }");
    if (texture.empty())
        throw Failure("'" + filename + "': a 'scene' needs a 'texture: { size: ... }', the size of its coarsest grains");
    result.texture = readTexture(texture, filename);
    for (const FileNode& node : scene)
        result.surfaces.push_back(readSurface(Keys(node, "'" + filename + "': scene, shape "
                                                         + std::to_string(result.surfaces.size() + 1))));
    return result;
}

namespace {

Exposure readExposure(const FileNode& node)
{
    const Keys keys(node, "exposure");
    keys.allowOnly({"dark", "light", "background", "blur", "noise", "vignetting"});
    Exposure e;
    e.dark = keys.number("dark", 0, 255, e.dark);
    e.light = keys.number("light", 0, 255, e.light);
    e.background = keys.number("background", 0, 255, e.background);
    e.blur = keys.number("blur", 0, 2, e.blur);
    e.noise = keys.number("noise", 0, 100, e.noise);
    e.vignetting = keys.number("vignetting", 0, 1, e.vignetting);
    return e;
}

std::vector<Point2d> projectPoints(const std::vector<cv::Point3d>& points, const BoardPose& pose,
                                   const cv::Ptr<cv::refract::RefractiveCamera>& camera)
{
    std::vector<Point2d> pixels;
    cv::refract::refractiveProjectPoints(points, pose.rvec, pose.tvec, camera, pixels);
    return pixels;
}

//! Draws poses that every camera sees, with and without its window.
class RandomPoses
{
public:
    RandomPoses(const Keys& keys, const Target& target, const Calibration& rig, uint64_t seed)
        : target_(target), rig_(rig), rng_(seed), distance_(keys.numbers("distance", 2)),
          tilt_(keys.numbers("tilt_deg", 2)), roll_(keys.number("roll_deg", 0, 180, 0)),
          margin_(keys.number("margin", 0, 1e5, 20)),
          seenBy_((int)keys.number("seen_by", 1, (double)rig.cameras.size(), (double)rig.cameras.size()))
    {
        if (!(distance_[0] > 0 && distance_[1] >= distance_[0] && tilt_[0] >= 0 && tilt_[1] >= tilt_[0] && tilt_[1] < 90))
            throw Failure(keys.name() + ": distance must be [near, far] with 0 < near <= far, tilt_deg [least, most] "
                          "with 0 <= least <= most < 90");
    }

    BoardPose draw(const std::string& stem)
    {
        for (int attempt = 0; attempt < 20000; attempt++)
        {
            const BoardPose pose = any();
            if (isSeen(pose))
                return pose;
        }
        throw Failure(stem + ": no pose found in which enough cameras see the whole target; move the cameras, take a "
                      "smaller target or another distance");
    }

private:
    //! Target turned by the roll and tilted about a random axis in its plane; its centre anywhere in camera 1's view.
    BoardPose any()
    {
        const double degree = CV_PI/180, axis = rng_.uniform(0., 2*CV_PI);
        const double tilt = degree*rng_.uniform(tilt_[0], tilt_[1]), roll = degree*rng_.uniform(-roll_, roll_);
        const cv::Matx33d R = rotationMatrix(tilt*Vec3d(std::cos(axis), std::sin(axis), 0))*rotationMatrix(Vec3d(0, 0, roll));
        const cv::Ptr<cv::refract::RefractiveCamera>& camera = rig_.cameras[0].camera;
        const cv::Matx33d K = camera->cameraMatrix();
        const double z = rng_.uniform(distance_[0], distance_[1]);
        const Vec3d centre(z*(rng_.uniform(0., (double)camera->imageSize().width) - K(0, 2))/K(0, 0),
                           z*(rng_.uniform(0., (double)camera->imageSize().height) - K(1, 2))/K(1, 1), z);
        BoardPose pose;
        pose.rvec = rotationVector(R);
        const Vec3d first(target_.objectPoints().front()), last(target_.objectPoints().back());
        pose.tvec = centre - R*(0.5*(first + last));
        return pose;
    }

    //! The corners first, as a target that is out of view is so by them: most draws end there.
    bool isSeen(const BoardPose& pose) const
    {
        const std::vector<cv::Point3d>& all = target_.objectPoints();
        const int n = target_.count(), columns = target_.size().width;
        return areSeen({all[0], all[columns - 1], all[n - columns], all[n - 1]}, pose) && areSeen(all, pose);
    }

    bool areSeen(const std::vector<cv::Point3d>& points, const BoardPose& pose) const
    {
        int seeing = 0;
        for (size_t c = 0; c < rig_.cameras.size(); c++)
            seeing += areSeenBy(rig_.cameras[c].camera, points, inOtherCamera(pose, rig_.extrinsics[c]));
        return seeing >= seenBy_;
    }

    bool areSeenBy(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const std::vector<cv::Point3d>& points,
                   const BoardPose& pose) const
    {
        for (const GlassWindow& window : {camera->window(), GlassWindow()})
            for (const Point2d& p : projectPoints(points, pose, copyWithWindow(camera, window)))
                if (!(p.x >= margin_ && p.y >= margin_ && p.x <= camera->imageSize().width - 1 - margin_
                      && p.y <= camera->imageSize().height - 1 - margin_))
                    return false;
        return true;
    }

    const Target& target_;
    const Calibration& rig_;
    cv::RNG rng_;
    std::vector<double> distance_, tilt_;
    double roll_, margin_;
    int seenBy_;
};

using PosesByName = std::map<std::string, std::vector<NamedPose>>;

BoardPose readPose(const Keys& keys)
{
    keys.allowOnly({"rvec", "tvec"});
    const auto r = keys.numbers("rvec", 3), t = keys.numbers("tvec", 3);
    return {Vec3d(r.data()), Vec3d(t.data())};
}

std::vector<NamedPose> readPoses(const FileNode& node, const Target& target, const Calibration& rig, uint64_t seed)
{
    const std::string name = node.name();
    std::vector<NamedPose> poses;
    if (node.isSeq())
    {
        for (const FileNode& item : node)
        {
            const Keys keys(item, "poses: " + name);
            poses.push_back({name + std::to_string(poses.size() + 1), readPose(keys)});
        }
        return poses;
    }
    const Keys keys(node, "poses: " + name);
    keys.allowOnly({"count", "distance", "tilt_deg", "roll_deg", "margin", "seen_by"});
    const int count = (int)keys.number("count", 1, 10000);
    RandomPoses random(keys, target, rig, seed);
    const int digits = (int)std::to_string(count).size();
    for (int i = 1; i <= count; i++)
    {
        const std::string stem = name + cv::format("%0*d", digits, i);
        poses.push_back({stem, random.draw(stem)});
    }
    return poses;
}

//! The target and all its poses; none of both if the file has no target.
PosesByName readTarget(const FileStorage& fs, Scene& scene, const std::string& filename)
{
    PosesByName poses;
    if (fs["target"].empty())
    {
        if (!fs["poses"].empty())
            throw Failure("'" + filename + "': the 'poses' are of a 'target', which it has not");
        return poses;
    }
    const Keys target(fs["target"], "target");
    target.allowOnly({"pattern", "size", "square", "marker", "tag_spacing", "dictionary"});
    scene.target.pattern = target.text("pattern", "chessboard");
    scene.target.size = target.text("size", "");
    scene.target.square = target.number("square", 1e-9, 1e9);
    scene.target.marker = target.number("marker", 0, 1e9, 0);
    scene.target.tagSpacing = target.number("tag_spacing", 0, 1, 0);
    scene.target.dictionary = target.text("dictionary", scene.target.dictionary);

    const Target points(scene.target);
    uint64_t seed = scene.seed;     // of each kind of pose, so that one more at the end leaves the others as they were
    for (const FileNode& node : fs["poses"])
        poses[node.name()] = readPoses(node, points, scene.cameras, ++seed*0x9E3779B97F4A7C15ull);
    return poses;
}

//! Those of the file that a set names.
std::vector<LightSource> sourcesOf(const FileNode& names, const Scene& scene, const Keys& keys)
{
    std::vector<LightSource> sources;
    if (!names.empty() && !names.isSeq())
        throw Failure(keys.name() + ": 'emitters' must be a list of names of emitters");
    for (const FileNode& name : names)
    {
        const auto found = std::find_if(scene.sources.begin(), scene.sources.end(), [&](const LightSource& source) {
            return source.name == (std::string)name; });
        if (found == scene.sources.end())
            throw Failure(keys.name() + ": there is no emitter called '" + (std::string)name + "'");
        sources.push_back(*found);
    }
    if (sources.size() > 1 && std::any_of(sources.begin(), sources.end(), [](const LightSource& source) { return !source.isLine(); }))
        throw Failure(keys.name() + ": fringes are a set of their own, without other emitters");
    return sources;
}

ImageSet readSet(const FileNode& node, const Scene& scene, const PosesByName& poses)
{
    ImageSet set;
    set.name = node.name();
    const Keys keys(node, "sets: " + set.name);
    keys.allowOnly({"window", "scene", "motion", "poses", "emitters"});
    set.window = keys.number("window", 0, 1, 1) != 0;
    set.scene = keys.number("scene", 0, 1, 0) != 0;
    if (keys.has("motion"))
    {
        const Keys motion(node["motion"], keys.name() + ", motion");
        const BoardPose pose = readPose(motion);
        set.motion = transformOf(pose.rvec, pose.tvec);
    }
    const bool posesNamed = node["poses"].isSeq() && node["poses"].size() > 0;
    if (set.name.find('/') != std::string::npos || (set.scene ? keys.has("poses") : !posesNamed))
        throw Failure(keys.name() + ": either 'poses' must be a list of names of poses, or 'scene' 1; and the set's name a "
                      "folder's");
    set.sources = sourcesOf(node["emitters"], scene, keys);
    if (set.scene && scene.surfaces.surfaces.empty())
        throw Failure(keys.name() + ": 'scene: 1' renders the 'scene' of the file, which has none");
    for (const FileNode& name : node["poses"])
    {
        const auto found = poses.find((std::string)name);
        if (found == poses.end())
            throw Failure(keys.name() + ": there are no poses called '" + (std::string)name + "'");
        set.poses.insert(set.poses.end(), found->second.begin(), found->second.end());
    }
    return set;
}

void requireWindowsOf(const Scene& scene, const std::string& filename)
{
    const bool needed = std::any_of(scene.sets.begin(), scene.sets.end(), [](const ImageSet& set) { return set.window; });
    for (const CameraCalibration& c : scene.cameras.cameras)
        if (needed && !c.windowGiven)
            throw Failure("'" + filename + "': sets with 'window: 1' need a glass_window of each camera");
}

} // namespace

std::vector<Point2d> projectTarget(const Target& target, const BoardPose& pose,
                                   const cv::Ptr<cv::refract::RefractiveCamera>& camera)
{
    return projectPoints(target.objectPoints(), pose, camera);
}

Scene readScene(const std::string& filename)
{
    Scene scene;
    scene.cameras = readCalibration(filename);
    for (const CameraCalibration& c : scene.cameras.cameras)
        if (c.camera->imageSize().empty())
            throw Failure("'" + filename + "': image_width and image_height of each camera are needed");
    const FileStorage fs = cv::refract::openStorage(filename);
    const size_t SHORTEST = 4;
    requireNoMisspelling(fs.root(), {"target", "exposure", "channels", "emitters", "texture", "seed", "poses", "sets", "scene"}, filename,
                         SHORTEST);
    if (fs["target"].empty() && fs["scene"].empty())
        throw Failure("'" + filename + "' has no 'target' and no 'scene', so there is nothing to render (see refract_simulate "
                      "--help)");
    scene.exposure = readExposure(fs["exposure"]);
    scene.seed = (uint64_t)Keys(fs.root(), filename).number("seed", 0, 2147483647, 1);
    scene.coloured = !fs["channels"].empty();
    if (scene.coloured)
    {
        scene.wavelengths = channelsOf(Keys(fs.root(), filename).numbers("channels", 3), "'" + filename + "': channels");
        for (const CameraCalibration& c : scene.cameras.cameras)
            camerasInColours(c.camera, scene.wavelengths, filename);        // refuses a window of unknown materials
    }
    if (!fs["scene"].empty())
        scene.surfaces = readSurfaces(fs["scene"], fs["texture"], filename);
    scene.surfaces.seed = scene.seed;
    scene.sources = readLightSources(fs["emitters"], filename);
    const PosesByName poses = readTarget(fs, scene, filename);
    for (const FileNode& node : fs["sets"])
        scene.sets.push_back(readSet(node, scene, poses));
    requireWindowsOf(scene, filename);
    if (scene.sets.empty())
        throw Failure("'" + filename + "': 'sets' names no images to render (see refract_simulate --help)");
    return scene;
}

} // namespace tools
