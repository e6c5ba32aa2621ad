// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/colmap_model.hpp"
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "formats/colmap_fields.hpp"
#include "formats/lens_maker.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unordered_map>


namespace tools {

namespace {

namespace fs = std::filesystem;

const char* const SENSORS[] = {"CAMERA", "IMU"};
const int SENSOR_COUNT = 2;

//! COLMAP's names of camera models, by number.
const std::vector<const char*>& modelNames()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        size_t count;
        for (int id = 0; !colmapModelName(id, count).empty(); id++)
            list.push_back(colmapModelName(id, count));
        return list;
    }();
    static const std::vector<const char*> words = [] {
        std::vector<const char*> list;
        for (const std::string& name : names)
            list.push_back(name.c_str());
        return list;
    }();
    return words;
}

void numbers(ColmapFields& io, cv::Vec3d& v)
{
    for (double& x : v.val)
        io.number(x);
}

void numbers(ColmapFields& io, ColmapPose& pose)
{
    for (double& x : pose.q.val)
        io.number(x);
    numbers(io, pose.t);
}

// ---- each kind of record, read or written

void record(ColmapFields& io, ColmapCamera& camera)
{
    const std::vector<const char*>& names = modelNames();
    int model = (int)names.size();
    for (int i = 0; i < (int)names.size() && !camera.model.empty(); i++)
        model = camera.model == names[i] ? i : model;
    io.number(camera.id);
    io.kind(model, names.data(), (int)names.size());
    if (model < 0 || model >= (int)names.size())
        throw Failure("its camera model " + std::to_string(model) + " is none of COLMAP's that are known here");
    camera.model = names[model];
    io.number(camera.width);
    io.number(camera.height);
    size_t count = 0;
    colmapModelName(model, count);
    camera.parameters.resize(count);
    for (double& p : camera.parameters)
        io.number(p);
    io.endLine();
}

void record(ColmapFields& io, ColmapImage& image)
{
    io.number(image.id);
    numbers(io, image.cam_from_world);
    io.number(image.camera);
    io.word(image.name);
    io.endLine();
    image.pixels.resize(io.list(image.pixels.size(), 3, 24));
    for (ColmapPixel& pixel : image.pixels)
    {
        io.number(pixel.x);
        io.number(pixel.y);
        io.number(pixel.point);
    }
    io.endLine();
}

void record(ColmapFields& io, ColmapPoint& point)
{
    io.number(point.id);
    numbers(io, point.X);
    for (uint8_t& c : point.color.val)
        io.number(c);
    io.number(point.error);
    point.track.resize(io.list(point.track.size(), 2, 8));
    for (ColmapSight& sight : point.track)
    {
        io.number(sight.image);
        io.number(sight.pixel);
    }
    io.endLine();
}

void record(ColmapFields& io, ColmapRig& rig)
{
    io.number(rig.id);
    rig.sensors.resize(io.shortList((uint32_t)rig.sensors.size(), 8));
    for (size_t i = 0; i < rig.sensors.size(); i++)
    {
        ColmapSensor& sensor = rig.sensors[i];
        io.kind(sensor.type, SENSORS, SENSOR_COUNT);
        io.number(sensor.id);
        if (i > 0)
            io.number(sensor.isPlaced);
        if (sensor.isPlaced)
            numbers(io, sensor.sensor_from_rig);
    }
    io.endLine();
}

void record(ColmapFields& io, ColmapFrame& frame)
{
    io.number(frame.id);
    io.number(frame.rig);
    numbers(io, frame.rig_from_world);
    frame.data.resize(io.shortList((uint32_t)frame.data.size(), 16));
    for (ColmapData& data : frame.data)
    {
        io.kind(data.type, SENSORS, SENSOR_COUNT);
        io.number(data.sensor);
        io.number(data.id);
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
    io.end();
}

template<typename T> void read(const std::string& bytes, bool isBinary, std::vector<T>& list)
{
    const std::unique_ptr<ColmapFields> io = colmapReader(bytes, isBinary);
    try
    {
        records(*io, list);
    }
    catch (const Failure& e)
    {
        throw Failure(io->where() + e.what());
    }
}

template<typename T> void readFile(const std::string& path, bool isBinary, std::vector<T>& list)
{
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw Failure("there is no '" + path + "' that can be read: a COLMAP model is cameras, images and points3D, all .bin or all .txt");
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    try
    {
        read(bytes, isBinary, list);
    }
    catch (const Failure& e)
    {
        throw Failure("'" + path + "' looks like COLMAP's, but " + e.what());
    }
}

template<typename T> void writeFile(const std::string& folder, const char* stem, bool isBinary, const std::string& comment,
                                    const std::vector<T>& list)
{
    std::string bytes = isBinary || comment.empty() ? "" : "# " + comment + "\n";
    records(*colmapWriter(bytes, isBinary), const_cast<std::vector<T>&>(list));         // a writer changes nothing
    writeText(folder + "/" + stem + (isBinary ? ".bin" : ".txt"), bytes);
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
    const char REPEAT[] = ": its files do not belong together, write them again";
    if (model.images.empty() || model.points.empty())
        throw Failure("'" + folder + "' is a model without " + (model.images.empty() ? "images" : "points")
                      + ": nothing was reconstructed; look at what COLMAP said");
    const auto cameras = byId(model.cameras, folder, "cameras");
    const auto images = byId(model.images, folder, "images");
    const auto points = byId(model.points, folder, "points");
    for (const ColmapImage& image : model.images)
    {
        if (!cameras.count(image.camera))
            throw Failure("'" + folder + "': image '" + image.name + "' is of camera " + std::to_string(image.camera)
                          + ", which is not there" + REPEAT);
        for (const ColmapPixel& pixel : image.pixels)
            if (pixel.point != NO_COLMAP_POINT && (!points.count(pixel.point) || !std::isfinite(pixel.x) || !std::isfinite(pixel.y)))
                throw Failure("'" + folder + "': image '" + image.name + "' shows point " + std::to_string(pixel.point)
                              + ", which is not there, or has no pixel" + REPEAT);
    }
    for (const ColmapPoint& point : model.points)
    {
        if (!std::isfinite(point.X[0] + point.X[1] + point.X[2]))
            throw Failure("'" + folder + "': point " + std::to_string(point.id) + " is not finite" + REPEAT);
        for (const ColmapSight& sight : point.track)
        {
            const auto image = images.find(sight.image);
            if (image == images.end() || sight.pixel >= image->second->pixels.size()
                || image->second->pixels[sight.pixel].point != point.id)
                throw Failure("'" + folder + "': point " + std::to_string(point.id) + " is said to be seen in image "
                              + std::to_string(sight.image) + ", which does not show it" + REPEAT);
        }
    }
}

std::string fileOf(const std::string& folder, const char* stem, bool isBinary)
{
    return (fs::path(folder)/stem).string() + (isBinary ? ".bin" : ".txt");
}

const char* const STEMS[] = {"cameras", "images", "points3D", "rigs", "frames"};
const size_t WITHOUT_RIGS = 3;

//! What an earlier model left, of which readers would take part, or all of it.
void removeStale(const ColmapModel& model, const std::string& folder)
{
    for (const char* stem : STEMS)
        fs::remove(fileOf(folder, stem, !model.isBinary));
    for (size_t i = WITHOUT_RIGS; i < std::size(STEMS) && model.rigs.empty(); i++)
        fs::remove(fileOf(folder, STEMS[i], model.isBinary));
}

} // namespace

bool isPose(const ColmapPose& pose)
{
    const double length = cv::norm(pose.q);
    return std::isfinite(length + pose.t[0] + pose.t[1] + pose.t[2]) && std::abs(length - 1.) < 1e-3;
}

ColmapModel readColmapModel(const std::string& folder)
{
    ColmapModel model;
    model.isBinary = fs::exists(fileOf(folder, "cameras", true));
    if (!model.isBinary && !fs::exists(fileOf(folder, "cameras", false)))
        throw Failure("'" + folder + "' has no cameras.bin and no cameras.txt: give the folder of a COLMAP model, such as sparse/0");
    readFile(fileOf(folder, "cameras", model.isBinary), model.isBinary, model.cameras);
    readFile(fileOf(folder, "images", model.isBinary), model.isBinary, model.images);
    readFile(fileOf(folder, "points3D", model.isBinary), model.isBinary, model.points);
    if (fs::exists(fileOf(folder, "rigs", model.isBinary)) && fs::exists(fileOf(folder, "frames", model.isBinary)))
    {
        readFile(fileOf(folder, "rigs", model.isBinary), model.isBinary, model.rigs);
        readFile(fileOf(folder, "frames", model.isBinary), model.isBinary, model.frames);
    }
    check(model, folder);
    return model;
}

void writeColmapModel(const ColmapModel& model, const std::string& folder, const std::string& comment)
{
    makeFolder(folder);
    writeFile(folder, STEMS[0], model.isBinary, comment, model.cameras);
    writeFile(folder, STEMS[1], model.isBinary, comment, model.images);
    writeFile(folder, STEMS[2], model.isBinary, comment, model.points);
    if (!model.rigs.empty())
    {
        writeFile(folder, STEMS[3], model.isBinary, comment, model.rigs);
        writeFile(folder, STEMS[4], model.isBinary, comment, model.frames);
    }
    removeStale(model, folder);
}

std::vector<std::string> colmapFilesOf(const std::string& folder, bool isBinary)
{
    std::vector<std::string> files;
    for (const char* stem : STEMS)
        files.push_back(fileOf(folder, stem, isBinary));
    return files;
}

std::vector<ColmapCamera> readColmapCameras(const std::string& bytes)
{
    std::vector<ColmapCamera> cameras;
    read(bytes, true, cameras);
    return cameras;
}

} // namespace tools
