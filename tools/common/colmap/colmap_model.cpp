// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/colmap_model.hpp"
#include "console/byte_order_mark.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "colmap/colmap_fields.hpp"
#include "formats/colmap_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unordered_map>

namespace tools {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> SENSORS = {"CAMERA", "IMU"};

void pose(ColmapFields& io, ColmapPose& p)
{
    io.numbers(p.q[0], p.q[1], p.q[2], p.q[3], p.t[0], p.t[1], p.t[2]);
}

// ---- each kind of record, read or written

void record(ColmapFields& io, ColmapCamera& camera)
{
    static const std::vector<std::string> models = colmapModels();
    int model = (int)(std::find(models.begin(), models.end(), camera.model) - models.begin());
    io.number(camera.id);
    io.kind(model, models, "camera model");
    camera.model = models[model];
    camera.parameters.resize(colmapParameterCount(camera.model));
    io.numbers(camera.width, camera.height);
    for (double& p : camera.parameters)
        io.number(p);
    io.endLine();
}

void record(ColmapFields& io, ColmapImage& image)
{
    io.number(image.id);
    pose(io, image.cam_from_world);
    io.number(image.camera);
    io.restOfLine(image.name);
    io.endLine();
    image.pixels.resize(io.list(image.pixels.size(), 3, 24));
    for (ColmapPixel& pixel : image.pixels)
        io.numbers(pixel.x, pixel.y, pixel.point);
    io.endLine();
}

void record(ColmapFields& io, ColmapPoint& point)
{
    io.numbers(point.id, point.X[0], point.X[1], point.X[2], point.color[0], point.color[1], point.color[2], point.error);
    point.track.resize(io.list(point.track.size(), 2, 8));
    for (ColmapSight& sight : point.track)
        io.numbers(sight.image, sight.pixel);
    io.endLine();
}

void record(ColmapFields& io, ColmapRig& rig)
{
    io.number(rig.id);
    rig.sensors.resize(io.shortList((uint32_t)rig.sensors.size(), 8));
    for (size_t i = 0; i < rig.sensors.size(); i++)
    {
        ColmapSensor& sensor = rig.sensors[i];
        io.kind(sensor.type, SENSORS, "sensor");
        io.number(sensor.id);
        if (i > 0)
            io.number(sensor.isPlaced);
        if (sensor.isPlaced)
            pose(io, sensor.sensor_from_rig);
    }
    io.endLine();
}

void record(ColmapFields& io, ColmapFrame& frame)
{
    io.numbers(frame.id, frame.rig);
    pose(io, frame.rig_from_world);
    frame.data.resize(io.shortList((uint32_t)frame.data.size(), 16));
    for (ColmapData& data : frame.data)
    {
        io.kind(data.type, SENSORS, "sensor");
        io.numbers(data.sensor, data.id);
    }
    io.endLine();
}

template<typename T> void records(ColmapFields& io, std::vector<T>& list)
{
    const uint64_t count = io.records(list.size());
    for (uint64_t done = 0; io.more(done, count); done++)
    {
        if (io.isReading())
            list.emplace_back();
        record(io, list[done]);
    }
}

template<typename T> void readFile(const std::string& path, bool isBinary, std::vector<T>& list)
{
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw Failure("there is no '" + path + "' that can be read: a COLMAP model is cameras, images and points3D, all .bin or all .txt");
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!isBinary)
        bytes = withoutByteOrderMark(bytes);
    ColmapFields io(bytes, isBinary, ColmapFields::READ);
    try
    {
        records(io, list);
    }
    catch (const Failure& e)
    {
        throw Failure("'" + path + "' looks like COLMAP's, but " + io.where() + e.what());
    }
}

template<typename T> void writeFile(const std::string& path, bool isBinary, const std::string& comment, const std::vector<T>& list)
{
    std::string bytes = isBinary || comment.empty() ? "" : "# " + comment + "\n";
    ColmapFields io(bytes, isBinary, ColmapFields::WRITE);
    records(io, const_cast<std::vector<T>&>(list));         // a writer changes nothing
    writeText(path, bytes);
}

// ---- whether files belong together

template<typename T> std::unordered_map<uint64_t, const T*> byId(const std::vector<T>& list, const std::string& folder, const char* what)
{
    std::unordered_map<uint64_t, const T*> all;
    for (const T& entry : list)
        if (!all.insert({entry.id, &entry}).second)
            throw Failure("'" + folder + "' has two " + what + " with the id " + std::to_string(entry.id));
    return all;
}

void check(const ColmapModel& model, const std::string& folder)
{
    const auto fail = [&](const std::string& what) {
        throw Failure("'" + folder + "': " + what + ": its files do not belong together, write them again"); };
    if (model.images.empty() || model.points.empty())
        throw Failure("'" + folder + "' is a model without " + (model.images.empty() ? "images" : "points")
                      + ": nothing was reconstructed; look at what COLMAP said");
    const auto cameras = byId(model.cameras, folder, "cameras");
    const auto images = byId(model.images, folder, "images");
    const auto points = byId(model.points, folder, "points");
    for (const ColmapImage& image : model.images)
    {
        if (!cameras.count(image.camera))
            fail("image '" + image.name + "' is of camera " + std::to_string(image.camera) + ", which is not there");
        for (const ColmapPixel& pixel : image.pixels)
            if (pixel.point != NO_COLMAP_POINT && (!points.count(pixel.point) || !std::isfinite(pixel.x) || !std::isfinite(pixel.y)))
                fail("image '" + image.name + "' shows point " + std::to_string(pixel.point) + ", which is not there, or has no pixel");
    }
    for (const ColmapPoint& point : model.points)
    {
        if (!std::isfinite(point.X[0] + point.X[1] + point.X[2]))
            fail("point " + std::to_string(point.id) + " is not finite");
        for (const ColmapSight& sight : point.track)
        {
            const auto image = images.find(sight.image);
            if (image == images.end() || sight.pixel >= image->second->pixels.size()
                || image->second->pixels[sight.pixel].point != point.id)
                fail("point " + std::to_string(point.id) + " is said to be seen in image " + std::to_string(sight.image)
                     + ", which does not show it");
        }
    }
}

const size_t WITHOUT_RIGS = 3;      // files

//! What an earlier model left, of which readers would take part, or all of it.
void removeStale(const ColmapModel& model, const std::string& folder)
{
    for (const std::string& file : colmapFilesOf(folder, !model.isBinary))
        fs::remove(file);
    const std::vector<std::string> files = colmapFilesOf(folder, model.isBinary);
    for (size_t i = WITHOUT_RIGS; i < files.size() && model.rigs.empty(); i++)
        fs::remove(files[i]);
}

} // namespace

bool isPose(const ColmapPose& pose)
{
    const double length = cv::norm(pose.q);
    return std::isfinite(length + pose.t[0] + pose.t[1] + pose.t[2]) && std::abs(length - 1.) < 1e-3;
}

std::vector<std::string> colmapFilesOf(const std::string& folder, bool isBinary)
{
    std::vector<std::string> files;
    for (const char* stem : {"cameras", "images", "points3D", "rigs", "frames"})
        files.push_back((fs::path(folder)/stem).string() + (isBinary ? ".bin" : ".txt"));
    return files;
}

ColmapModel readColmapModel(const std::string& folder)
{
    ColmapModel model;
    model.isBinary = fs::exists(colmapFilesOf(folder, true)[0]);
    const std::vector<std::string> files = colmapFilesOf(folder, model.isBinary);
    if (!fs::exists(files[0]))
        throw Failure("'" + folder + "' has no cameras.bin and no cameras.txt: give the folder of a COLMAP model, such as sparse/0");
    readFile(files[0], model.isBinary, model.cameras);
    readFile(files[1], model.isBinary, model.images);
    readFile(files[2], model.isBinary, model.points);
    if (fs::exists(files[3]) && fs::exists(files[4]))
    {
        readFile(files[3], model.isBinary, model.rigs);
        readFile(files[4], model.isBinary, model.frames);
    }
    check(model, folder);
    return model;
}

void writeColmapModel(const ColmapModel& model, const std::string& folder, const std::string& comment)
{
    const std::vector<std::string> files = colmapFilesOf(folder, model.isBinary);
    makeFolder(folder);
    writeFile(files[0], model.isBinary, comment, model.cameras);
    writeFile(files[1], model.isBinary, comment, model.images);
    writeFile(files[2], model.isBinary, comment, model.points);
    if (!model.rigs.empty())
    {
        writeFile(files[3], model.isBinary, comment, model.rigs);
        writeFile(files[4], model.isBinary, comment, model.frames);
    }
    removeStale(model, folder);
}

ColmapCamera colmapCameraOf(const cv::refract::RefractiveCamera& camera, uint32_t id)
{
    const cv::Mat lens = camera.lensParameters();       // fx fy cx cy k1 k2 p1 p2 [k3 k4 k5 k6], or fisheye's k1 ... k4
    ColmapCamera result;
    result.id = id;
    result.model = camera.lensModel() == "fisheye" ? "OPENCV_FISHEYE" : lens.total() > 8 ? "FULL_OPENCV" : "OPENCV";
    result.width = (uint64_t)camera.imageSize().width;
    result.height = (uint64_t)camera.imageSize().height;
    result.parameters.assign(lens.ptr<double>(), lens.ptr<double>() + lens.total());
    result.parameters.resize(colmapParameterCount(result.model), 0.);
    for (int i : {2, 3})
        result.parameters[i] += COLMAP_CORNER;
    return result;
}

} // namespace tools
