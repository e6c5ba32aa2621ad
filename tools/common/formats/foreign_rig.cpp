// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/foreign_rig.hpp"
#include "camera/storage.hpp"
#include "console/byte_order_mark.hpp"
#include "console/images.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include "formats/foreign_file.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace tools {

using cv::Mat;
using cv::format;
using cv::refract::RefractiveCamera;

namespace {

bool begins(const ForeignFile& file, const char* with) { return file.bytes.compare(0, std::strlen(with), with) == 0; }

//! What cv::FileStorage has read.
Json treeOf(const cv::FileNode& node, int depth)
{
    const int DEEPEST = 20;
    if (node.isInt() || node.isReal())
        return (double)node;
    if (node.isString())
        return (std::string)node;
    if (depth > DEEPEST || (!node.isMap() && !node.isSeq()))
        return nullptr;
    Json json = node.isMap() ? Json::object() : Json::array();
    for (const cv::FileNode& item : node)
        node.isMap() ? json.set(item.name(), treeOf(item, depth + 1)) : json.append(treeOf(item, depth + 1));
    return json;
}

Json readXml(const ForeignFile& file)
{
    try
    {
        return treeOf(cv::refract::openStorage(file.name).root(), 0);
    }
    catch (const cv::Exception& e)
    {
        throw Json::Error(e.err);
    }
}

//! NaN and Infinity, which JSON has none of but Python writes, become null, as others have it; in names, which are none here, too.
Json readJson(const ForeignFile& file)
{
    std::string text = file.bytes;
    for (const std::string word : {"-Infinity", "Infinity", "NaN"})
        for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at))
            text.replace(at, word.size(), "null");
    std::istringstream in(text);
    return Json::read(in);
}

//! What tells the files of a format, and how they become a rig, or else a tree of names and values.
struct Format
{
    const char* name;
    bool (*is)(const ForeignFile& file);
    ForeignRig (*rigOf)(const ForeignFile& file);
    Json (*treeOf)(const ForeignFile& file);
    bool isOurs;                //!< so are refract's own files, which the module reads
};

// Whatever is text at last may be YAML.
const Format FORMATS[] = {
    {"OpenLPT's camera", isOpenLpt, readOpenLpt, nullptr, false},
    {"COLMAP's cameras.txt", isColmapText, readColmapText, nullptr, false},
    {"COLMAP's cameras.bin", isColmapBinary, readColmapBinary, nullptr, false},
    {"OpenPTV's .ori", isOpenPtv, readOpenPtv, nullptr, false},
    {"NumPy's archive", [](const ForeignFile& f) { return begins(f, "PK\x03\x04"); }, nullptr, readNpz, false},
    {"MATLAB's file", [](const ForeignFile& f) { return begins(f, "MATLAB 5.0 MAT-file") || begins(f, "MATLAB 7.3"); }, nullptr,
     readMat, false},
    {"XML", [](const ForeignFile& f) { return begins(f, "<?xml"); }, nullptr, readXml, true},
    {"JSON", [](const ForeignFile& f) { return f.firstLine().compare(0, 1, "{") == 0; }, nullptr, readJson, true},
    {"YAML", [](const ForeignFile& f) { return f.bytes.find('\0') == std::string::npos; }, nullptr, readYaml, true}};

//! What the module reads by itself: a matrix as cv::FileStorage writes it, or what only refract writes.
bool isOwn(const Json& file)
{
    const auto isMatrix = [](const Json& map, const char* name) { return map.has(name) && map.at(name).has("dt"); };
    return file.has("camera1") || file.has("lens_model")
        || (isMatrix(file, "camera_matrix") && (file.has("distortion_coefficients") || numbersOf(file.at("camera_matrix")).size() != 9));
}

//! "word:" or "word: value"
bool hasKey(const std::string& line)
{
    const size_t end = line.find_first_of(": \t");
    return end > 0 && end != std::string::npos && line[end] == ':' && (end + 1 == line.size() || std::strchr(" \t\r", line[end + 1]));
}

/** No cameras: the module is to read it, and to say what it thinks of it.
@param name receives whose file it looks like, before anything is thrown */
ForeignRig readAs(const Format& format, const ForeignFile& file, std::string& name)
{
    if (format.rigOf)
        return format.rigOf(file);
    const bool isStorage = format.isOurs && (begins(file, "%YAML") || begins(file, "<?xml") || begins(file, "{"));
    Json tree;
    try
    {
        tree = format.treeOf(file);
    }
    catch (const Json::Error&)
    {
        // Any text may look like YAML, and cv::FileStorage's JSON has .Nan; but a text that is cut short was one.
        const size_t last = file.bytes.find_last_not_of(" \t\r\n");
        const bool isOne = name == "JSON" ? file.bytes[last] != '}' : !isStorage && hasKey(file.firstLine());
        if (format.isOurs && !isOne)
            return {};
        throw;
    }
    if (format.isOurs && isOwn(tree))
        return {};
    const ForeignRig rig = readKeyedCameras(tree, name);
    if (!rig.cameras.empty() || isStorage || !tree.isObject())
        return rig;
    for (const std::string& key : tree.names())
        if (!format.isOurs && tree.at(key).isText())
            throw Failure("'" + key + "' is an object of a class: save it as a struct, p = toStruct(" + key + "); save(file, 'p', '-v7')");
    throw Failure("there is no camera in it: camera_matrix and distortion_coefficients, or K and D, are missing");
}

std::optional<ForeignRig> readOne(const ForeignFile& file)
{
    if (file.bytes.find("glass_window") != std::string::npos)       // refract's own word: nothing to look for in a large file
        return {};
    const auto format = std::find_if(std::begin(FORMATS), std::end(FORMATS), [&](const Format& f) { return f.is(file); });
    if (format == std::end(FORMATS))
        return {};
    std::string name = format->name;
    try
    {
        ForeignRig rig = readAs(*format, file, name);
        rig.format = name;
        return rig.cameras.empty() ? std::optional<ForeignRig>() : rig;
    }
    catch (const std::runtime_error& e)         // Failure, or Json::Error
    {
        throw Failure("'" + file.name + "' looks like " + name + ", but " + e.what());
    }
}

//! The place of the first camera is the frame of all.
void relateToFirst(ForeignRig& rig)
{
    const double EDITED = 1e-3;
    const Mat R = rig.Rs[0].clone(), T = rig.Ts[0].clone();
    for (size_t c = 0; c < rig.Rs.size(); c++)
    {
        const std::string camera = "camera " + std::to_string(c + 1);
        if (!checkRange(rig.Rs[c]) || !checkRange(rig.Ts[c]) || !(norm(rig.Rs[c]*rig.Rs[c].t(), Mat::eye(3, 3, CV_64F)) < EDITED))
            throw Failure("of " + rig.format + " the place of " + camera + " is no rotation and translation: was the file edited?");
        rig.Rs[c] = rig.Rs[c]*R.t();
        rig.Ts[c] = rig.Ts[c] - rig.Rs[c]*T;
        if (determinant(rig.Rs[c]) < 0)
            throw Failure("of " + rig.format + " " + camera + " has a mirrored frame, and the first has none: is its y axis turned?");
    }
    rig.Rs[0] = Mat::eye(3, 3, CV_64F);
    rig.Ts[0] = Mat::zeros(3, 1, CV_64F);
}

//! All files of a numbered name, each of one camera.
std::optional<ForeignRig> readNumbered(const std::string& pattern)
{
    ForeignRig rig;
    for (const std::string& name : numberedFiles(pattern))
    {
        const std::optional<ForeignRig> one = readOne(contentsOf(name));
        if (!one)
            return {};
        if (one->cameras.size() != 1)
            throw Failure("'" + name + "' has several cameras: a numbered name is that of files of one");
        rig.format = one->format;
        rig.cameras.push_back(one->cameras[0]);
        rig.Rs.insert(rig.Rs.end(), one->Rs.begin(), one->Rs.end());
        rig.Ts.insert(rig.Ts.end(), one->Ts.begin(), one->Ts.end());
    }
    if (rig.Rs.size() != rig.cameras.size())
        rig.Rs = rig.Ts = {};
    return rig.cameras.empty() ? std::optional<ForeignRig>() : rig;
}

} // namespace

void ForeignRig::add(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Matx33d& cam_from_world, const cv::Vec3d& translation)
{
    cameras.push_back(camera);
    Rs.push_back(Mat(cam_from_world, true));
    Ts.push_back(Mat(translation, true));
}

ForeignFile contentsOf(const std::string& name)
{
    const size_t MOST = 64 << 20;           // a file of cameras is small
    ForeignFile file{name, ""};
    std::error_code error;
    if (!std::filesystem::is_regular_file(name, error) || std::filesystem::file_size(name, error) > MOST)
        return file;
    std::ifstream in(name, std::ios::binary);
    file.bytes = withoutByteOrderMark({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()});
    return file;
}

cv::Ptr<RefractiveCamera> makeCamera(const std::string& model, const cv::Matx33d& cameraMatrix, std::vector<double> coefficients,
                                     const cv::Size& size)
{
    const std::vector<size_t> places = model == "fisheye" ? std::vector<size_t>{0, 4} : std::vector<size_t>{0, 4, 5, 8, 12, 14};
    while (!coefficients.empty() && coefficients.back() == 0. && coefficients.size() > places.back())
        coefficients.pop_back();
    const auto fitting = std::lower_bound(places.begin(), places.end(), coefficients.size());
    if (fitting == places.end())
        throw Failure(format("its lens has %zu coefficients, more than OpenCV's model has", coefficients.size()));
    coefficients.resize(*fitting, 0.);
    return possible("lens", [&] {
        const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::createByName(model, cameraMatrix, coefficients);
        camera->setImageSize(size);
        return camera;
    });
}

cv::Size imageSizeOf(double width, double height)
{
    const int LARGEST = 1 << 20;
    if (!(width >= 1 && width <= LARGEST && height >= 1 && height <= LARGEST))
        throw Failure(format("its image size is %gx%g", width, height));
    return cv::Size((int)width, (int)height);
}

std::vector<std::string> ForeignFile::lines() const
{
    std::vector<std::string> lines;
    std::istringstream in(bytes);
    for (std::string line; takeLine(in, line); )
        if (line.find_first_not_of(" \t\r") != std::string::npos && line[line.find_first_not_of(" \t\r")] != '#')
            lines.push_back(line);
    return lines;
}

std::string ForeignFile::firstLine() const
{
    const std::vector<std::string> beginning = ForeignFile{name, bytes.substr(0, 4096)}.lines();
    return beginning.empty() ? "" : beginning[0];
}

std::vector<double> leadingNumbers(const std::string& text, bool* whole)
{
    std::vector<double> numbers;
    size_t at = 0;
    const char BETWEEN[] = " ,;\t\r\n";
    for (double number; (at = text.find_first_not_of(BETWEEN, at)) != std::string::npos; numbers.push_back(number))
    {
        const size_t end = std::min(text.find_first_of(BETWEEN, at), text.size());
        if (!parseNumber(text.substr(at, end - at), number))
            break;
        at = end;
    }
    if (whole)
        *whole = at == std::string::npos;
    return numbers;
}

std::optional<ForeignRig> readForeignRig(const std::string& filename)
{
    std::optional<ForeignRig> rig = filename.find("%d") != std::string::npos ? readNumbered(filename) : readOne(contentsOf(filename));
    if (rig && !rig->Rs.empty())
        relateToFirst(*rig);
    return rig;
}

} // namespace tools
