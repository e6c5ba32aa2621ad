// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/pinhole_images.hpp"
#include "colmap/scene_depth.hpp"
#include "colmap/survey.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "console/json.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "formats/colmap_cameras.hpp"
#include "math/quantile.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <unordered_map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const size_t FEW = 20;                  // points of an image that wrong depth is told by
const double NaN = std::numeric_limits<double>::quiet_NaN(), INFINITE = std::numeric_limits<double>::infinity();

std::string joined(const std::string& folder, const std::string& name) { return (std::filesystem::path(folder)/name).string(); }

//! A model's image, which is read and written by its name: below the folder it stays. Throws Failure.
std::string imageIn(const std::string& folder, const ColmapImage& image)
{
    const std::filesystem::path name(image.name);
    if (name.empty() || name.has_root_path() || std::find(name.begin(), name.end(), "..") != name.end())
        throw Failure("image '" + image.name + "' of the model is not named from the folder of the images on: give it a name without '..' "
                      "that does not begin with '/'");
    return joined(folder, image.name);
}

void makeFolderOf(const std::string& file) { makeFolder(std::filesystem::path(file).parent_path().string()); }

//! What an image shows of the points.
struct Seen
{
    std::vector<int> pixels;            //!< of the image's list
    std::vector<Point2d> raw, pinhole;  //!< where it was seen, where the pinhole sees the point
    std::vector<Point3d> inCamera;
    std::vector<double> depths;         //!< z of these
};

//! A camera of the calibration and its pinhole.
struct Pinhole
{
    Ptr<RefractiveCamera> camera;
    Matx33d K;
};

//! By the model's points.
class Scene
{
public:
    explicit Scene(const ColmapModel& model)
    {
        for (const ColmapPoint& point : model.points)
            points_[point.id] = point.X;
    }
    Seen seenIn(const ColmapImage& image) const
    {
        const RigidTransform pose = transformOf(image.cam_from_world);
        Seen seen;
        for (size_t k = 0; k < image.pixels.size(); k++)
        {
            const auto point = points_.find(image.pixels[k].point);
            const Vec3d X = point == points_.end() ? Vec3d() : pose.apply(point->second);
            if (!(X[2] > 0))
                continue;
            seen.pixels.push_back((int)k);
            seen.raw.push_back({image.pixels[k].x - COLMAP_CORNER, image.pixels[k].y - COLMAP_CORNER});
            seen.pinhole.push_back({X[0]/X[2], X[1]/X[2]});
            seen.inCamera.push_back(Point3d(X));
            seen.depths.push_back(X[2]);
        }
        return seen;
    }
private:
    std::unordered_map<uint64_t, Vec3d> points_;
};

int cameraOf(const ColmapImage& image, const Calibration& calibration)
{
    const int count = (int)calibration.cameras.size();
    if (count == 1)
        return 0;
    if (image.camera < 1 || (int)image.camera > count)
        throw Failure(format("image '%s' is of camera %u of the model, and the calibration has %d: give what refract_bundle --colmap-out "
                             "wrote with this calibration", image.name.c_str(), image.camera, count));
    return (int)image.camera - 1;
}

//! px: how far the camera sees a point of the image from where it was seen; infinite: it does not see it.
void addDistances(const Seen& seen, const Ptr<RefractiveCamera>& camera, std::vector<double>& distances)
{
    if (seen.raw.empty())
        return;
    std::vector<Point2d> pixels;
    refractiveProjectPoints(seen.inCamera, Vec3d(), Vec3d(), camera, pixels);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const double distance = norm(pixels[i] - seen.raw[i]);
        distances.push_back(std::isfinite(distance) ? distance : INFINITE);
    }
}

/** A bent model, one in another unit, and another calibration see the points elsewhere than the model says of itself. Without that nothing
would tell: its images are wrong, or black. */
void requireSameCameras(const ColmapModel& model, const Calibration& calibration, const Scene& scene)
{
    const double TIMES = 3., LEAST = 0.5;           // of the model's own errors; px
    std::vector<double> distances, own;
    for (const ColmapImage& image : model.images)
        addDistances(scene.seenIn(image), calibration.cameras[cameraOf(image, calibration)].camera, distances);
    for (const ColmapPoint& point : model.points)
        own.push_back(point.error);
    if (distances.empty())
        throw Failure("no image of the model shows a point of it that is in front of the camera");
    const double off = median(distances), stated = median(own);
    if (!(off < TIMES*std::max(stated, LEAST)))
        throw Failure("half of the model's points " + (std::isfinite(off) ? format("are more than %.3g px off where this calibration sees "
                      "them, by its own errors %.2g px", off, stated)
                                               : std::string("cannot be seen through the window of this calibration"))
                      + ": give what one run of refract_bundle wrote, --out and --colmap-out");
}

//! Of the largest image without black corners, at the median depth.
std::vector<Pinhole> pinholesOf(const ColmapModel& model, const Calibration& calibration, const Scene& scene)
{
    std::vector<std::vector<double>> depths(calibration.cameras.size());
    for (const ColmapImage& image : model.images)
        for (double depth : scene.seenIn(image).depths)
            depths[cameraOf(image, calibration)].push_back(depth);
    std::vector<Pinhole> pinholes;
    for (size_t c = 0; c < depths.size(); c++)
    {
        Pinhole pinhole = {calibration.cameras[c].camera, Matx33d::eye()};
        if (!depths[c].empty())
            pinhole.K = Mat(getOptimalNewRefractiveCameraMatrix(pinhole.camera, median(depths[c]), pinhole.camera->imageSize(), 0.));
        pinholes.push_back(pinhole);
    }
    return pinholes;
}

void toPixels(const Matx33d& K, std::vector<Point2d>& points)
{
    for (Point2d& p : points)
        p = {K(0, 0)*p.x + K(0, 2), K(1, 1)*p.y + K(1, 2)};
}

bool isInside(const Point2d& p, Size size) { return p.x >= 0 && p.y >= 0 && p.x <= size.width - 1 && p.y <= size.height - 1; }

/** px: how far points are off that take no part, one half by the other. What is in one cell is in one half: the same point may be there
twice. */
void addErrors(const Seen& seen, const Pinhole& pinhole, Size size, std::vector<double>& errors)
{
    if (seen.depths.size() < FEW)
        return;
    const auto isOdd = [](const Point& cell) { return (cell.x + cell.y) % 2 != 0; };
    for (size_t half = 0; half < 2; half++)
    {
        std::vector<Point2d> of, tested, raw, moved;
        std::vector<double> depths, truths, interpolated;
        for (size_t i = 0; i < seen.depths.size(); i++)
        {
            if (isOdd(depthCellOf(seen.pinhole[i], size)) == (half == 1))
            {
                of.push_back(seen.pinhole[i]);
                depths.push_back(seen.depths[i]);
            }
            else if (isInside(seen.pinhole[i], size))
            {
                tested.push_back(seen.pinhole[i]);
                truths.push_back(seen.depths[i]);
            }
        }
        if (of.empty() || tested.empty())
            continue;
        const Mat_<double> depth = sceneDepth(of, depths, size);
        for (const Point2d& p : tested)
            interpolated.push_back(depth(cvRound(p.y), cvRound(p.x)));
        refractiveDistortPoints(tested, raw, pinhole.camera, Mat(truths), noArray(), pinhole.K);
        refractiveUndistortPoints(raw, moved, pinhole.camera, Mat(interpolated), noArray(), pinhole.K);
        for (size_t i = 0; i < tested.size(); i++)
            if (std::isfinite(moved[i].x))
                errors.push_back(norm(moved[i] - tested[i]));
    }
}

//! As cv::remap takes it.
Mat mapOf(const Seen& seen, const Pinhole& pinhole, Size size)
{
    const Mat_<double> depth = sceneDepth(seen.pinhole, seen.depths, size);
    Mat map(size, CV_32FC2);
    parallel_for_(Range(0, size.height), [&](const Range& rows) {
        std::vector<Point2d> pixels(size.width), raw;
        for (int y = rows.start; y < rows.end; y++)
        {
            for (int x = 0; x < size.width; x++)
                pixels[x] = Point2d(x, y);
            refractiveDistortPoints(pixels, raw, pinhole.camera, depth.row(y).t(), noArray(), pinhole.K);
            for (int x = 0; x < size.width; x++)
                map.at<Vec2f>(y, x) = std::isfinite(raw[x].x) ? Vec2f((float)raw[x].x, (float)raw[x].y) : Vec2f(-1.f, -1.f);
        }
    });
    return map;
}

//! The model's image, with the pixels that the corrected one has of the points.
ColmapImage corrected(const ColmapImage& image, const Seen& seen, const Pinhole& pinhole, int camera)
{
    ColmapImage result = image;
    result.camera = (uint32_t)camera + 1;
    result.pixels.clear();
    std::vector<Point2d> pixels;
    if (!seen.raw.empty())
        refractiveUndistortPoints(seen.raw, pixels, pinhole.camera, Mat(seen.depths).reshape(1, (int)seen.depths.size()), noArray(),
                                  pinhole.K);
    for (size_t i = 0; i < pixels.size(); i++)
        if (std::isfinite(pixels[i].x))
            result.pixels.push_back({pixels[i].x + COLMAP_CORNER, pixels[i].y + COLMAP_CORNER, image.pixels[seen.pixels[i]].point});
    return result;
}

//! Tracks that follow from what images show; rigs are COLMAP's to make, one for each camera.
void completeModel(const std::vector<Pinhole>& pinholes, ColmapModel& model)
{
    model.isBinary = true;
    model.rigs.clear();
    model.frames.clear();
    model.cameras.clear();
    for (size_t c = 0; c < pinholes.size(); c++)
    {
        const Matx33d& K = pinholes[c].K;
        const Size size = pinholes[c].camera->imageSize();
        model.cameras.push_back({(uint32_t)c + 1, "PINHOLE", (uint64_t)size.width, (uint64_t)size.height,
                                 {K(0, 0), K(1, 1), K(0, 2) + COLMAP_CORNER, K(1, 2) + COLMAP_CORNER}});
    }
    std::unordered_map<uint64_t, size_t> indexOf;
    for (size_t i = 0; i < model.points.size(); i++)
    {
        indexOf[model.points[i].id] = i;
        model.points[i].track.clear();
    }
    for (const ColmapImage& image : model.images)
        for (size_t k = 0; k < image.pixels.size(); k++)
            model.points[indexOf[image.pixels[k].point]].track.push_back({image.id, (uint32_t)k});
    const auto isUnseen = [](const ColmapPoint& point) { return point.track.empty(); };
    model.points.erase(std::remove_if(model.points.begin(), model.points.end(), isUnseen), model.points.end());
}

//! COLMAP's own choice of partners for each image.
void writeStereo(const std::string& folder, const ColmapModel& model)
{
    std::string match, fusion;
    for (const ColmapImage& image : model.images)
    {
        match += image.name + "\n__auto__, 20\n";
        fusion += image.name + "\n";
    }
    for (const char* of : {"depth_maps", "normal_maps", "consistency_graphs"})
        for (const ColmapImage& image : model.images)
            makeFolderOf(imageIn(joined(folder, of), image));
    writeText(joined(folder, "patch-match.cfg"), match);
    writeText(joined(folder, "fusion.cfg"), fusion);
}

void setErrors(std::vector<double> errors, PinholeImages& result)
{
    result.rms = result.most = NaN;
    if (errors.empty())
        return;
    double squares = 0.;
    for (double error : errors)
        squares += error*error;
    result.rms = std::sqrt(squares/(double)errors.size());
    result.most = quantile(std::move(errors), 0.95);
}

} // namespace

void checkPinholeImages(const ColmapModel& model, const std::vector<std::string>& inputs, const std::string& imageFolder,
                        const std::string& folder)
{
    std::vector<Output> outputs;
    std::vector<std::string> all = inputs;
    for (const ColmapImage& image : model.images)
    {
        if (!std::filesystem::exists(imageIn(imageFolder, image)))
            throw Failure("there is no '" + imageIn(imageFolder, image) + "', an image of the model: --image-dir is the folder that its "
                          "names are from");
        outputs.push_back({"--out-dir", imageIn(joined(folder, "images"), image), OUTPUT_IN_FOLDER});
        all.push_back(imageIn(imageFolder, image));
    }
    for (bool isBinary : {true, false})
        for (const std::string& file : colmapFilesOf(joined(folder, "sparse"), isBinary))
            outputs.push_back({"--out-dir", file, OUTPUT_IN_FOLDER});
    checkOutputs(outputs, all);
}

PinholeImages writePinholeImages(const ColmapModel& model, const Calibration& calibration, const std::string& imageFolder,
                                 const std::string& folder, bool quiet)
{
    const Scene scene(model);
    requireSameCameras(model, calibration, scene);
    const std::vector<Pinhole> pinholes = pinholesOf(model, calibration, scene);
    PinholeImages result;
    std::vector<double> errors;
    ColmapModel dense = model;
    Progress progress("correcting images", (int)model.images.size(), quiet);
    for (ColmapImage& image : dense.images)
    {
        progress.at(image.name);
        const int camera = cameraOf(image, calibration);
        const Pinhole& pinhole = pinholes[camera];
        Seen seen = scene.seenIn(image);
        toPixels(pinhole.K, seen.pinhole);
        if (seen.depths.empty())
        {
            result.leftOut.push_back(image.name);
            progress.step();
            continue;
        }
        const std::string path = imageIn(imageFolder, image);
        const Mat raw = readImage(path, true);
        requireSize(raw, path, pinhole.camera->imageSize());
        addErrors(seen, pinhole, raw.size(), errors);
        const std::string output = imageIn(joined(folder, "images"), image);
        makeFolderOf(output);
        writeImage(output, remapChannels(raw, {mapOf(seen, pinhole, raw.size())}, INTER_CUBIC));
        image = corrected(image, seen, pinhole, camera);
        result.points += image.pixels.size();
        result.images++;
        progress.step();
    }
    const auto isLeftOut = [&](const ColmapImage& image) {
        return std::find(result.leftOut.begin(), result.leftOut.end(), image.name) != result.leftOut.end(); };
    dense.images.erase(std::remove_if(dense.images.begin(), dense.images.end(), isLeftOut), dense.images.end());
    completeModel(pinholes, dense);
    writeColmapModel(dense, joined(folder, "sparse"));
    writeStereo(joined(folder, "stereo"), dense);
    setErrors(errors, result);
    return result;
}

std::string pinholeImagesJson(const PinholeImages& images, const std::string& command)
{
    Json json = {{"command", command}, {"images", images.images}, {"images_left_out", images.leftOut}, {"pixels", images.points},
                 {"wrong_depth_px_rms", images.rms}, {"wrong_depth_px_95", images.most}};
    return json.text(2) + "\n";
}

} // namespace tools
