// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/foreign_rig.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/lines.hpp"
#include "console/numbers.hpp"
#include "formats/foreign_file.hpp"
#include "formats/keyed_cameras.hpp"
#include "formats/notations.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace tools {

using cv::FileNode;
using cv::FileStorage;
using cv::Mat;

namespace {

bool begins(const ForeignFile& file, const char* with) { return file.bytes.compare(0, std::strlen(with), with) == 0; }

//! What cv::FileStorage has read.
Json treeOf(const FileNode& node, int depth)
{
    const int DEEPEST = 20;
    if (node.isInt() || node.isReal())
        return (double)node;
    if (node.isString())
        return (std::string)node;
    if (depth > DEEPEST || (!node.isMap() && !node.isSeq()))
        return nullptr;
    Json json = node.isMap() ? Json::object() : Json::array();
    for (const FileNode& item : node)
        node.isMap() ? json.set(item.name(), treeOf(item, depth + 1)) : json.append(treeOf(item, depth + 1));
    return json;
}

Json readXml(const ForeignFile& file)
{
    try
    {
        const FileStorage fs(file.name, FileStorage::READ);
        return treeOf(fs.root(), 0);
    }
    catch (const cv::Exception& e)
    {
        throw Json::Error(e.err);
    }
}

//! NaN and Infinity, which JSON has none of but Python writes, become null, as others have it.
std::string withoutNaN(const std::string& text)
{
    std::string result;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); i++)
    {
        if (quoted && text[i] == '\\' && i + 1 < text.size())
            result += text[i++];            // with what it escapes
        else if (text[i] == '"')
            quoted = !quoted;
        size_t length = 0;
        for (const char* const word : {"NaN", "Infinity", "-Infinity"})
            if (!quoted && text.compare(i, std::strlen(word), word) == 0)
                length = std::strlen(word);
        result += length ? "null" : std::string(1, text[i]);
        i += length ? length - 1 : 0;
    }
    return result;
}

Json readJson(const ForeignFile& file)
{
    std::istringstream in(withoutNaN(file.bytes));
    return Json::read(in);
}

/* Files of names and values: what tells them, and how they become a tree. Whatever is text at last may be YAML. */
struct Notation
{
    const char* name;
    bool (*is)(const ForeignFile& file);
    Json (*read)(const ForeignFile& file);
    bool isOurs;                //!< the notations of refract's own files, which the module reads
};

bool isText(const ForeignFile& file) { return file.bytes.find('\0') == std::string::npos; }

const Notation NOTATIONS[] = {
    {"NumPy's archive", [](const ForeignFile& f) { return begins(f, "PK\x03\x04"); },
     [](const ForeignFile& f) { return readNpz(f.bytes); }, false},
    {"MATLAB's file", [](const ForeignFile& f) { return begins(f, "MATLAB 5.0 MAT-file"); },
     [](const ForeignFile& f) { return readMat(f.bytes); },
     false},
    {"XML", [](const ForeignFile& f) { return begins(f, "<?xml"); }, readXml, true},
    {"JSON", [](const ForeignFile& f) { return !f.firstLine().empty() && f.firstLine()[0] == '{'; }, readJson, true},
    {"YAML", isText, [](const ForeignFile& f) { return readYaml(f.bytes); }, true}};

//! Files of lines or bytes.
struct Format
{
    const char* name;
    bool (*is)(const ForeignFile& file);
    ForeignRig (*read)(const ForeignFile& file);
};

ForeignRig refuseHdf(const ForeignFile&) { throw Failure("files of version 7.3 are not read: save it with save -v7"); }

const Format FORMATS[] = {
    {"MATLAB's file", [](const ForeignFile& f) { return begins(f, "MATLAB 7.3"); }, refuseHdf},
    {"OpenLPT's camera", isOpenLpt, readOpenLpt},
    {"COLMAP's cameras.txt", isColmapText, readColmapText},
    {"COLMAP's cameras.bin", isColmapBinary, readColmapBinary},
    {"OpenPTV's .ori", isOpenPtv, readOpenPtv}};

//! What the module reads by itself: a matrix as cv::FileStorage writes it, or what only refract writes.
bool isOwn(const Json& file)
{
    const auto isMatrix = [](const Json& map, const char* name) { return map.has(name) && map.at(name).has("dt"); };
    return file.has("camera1") || file.has("lens_model")
        || (isMatrix(file, "camera_matrix") && (file.has("distortion_coefficients") || numbersOf(file.at("camera_matrix")).size() != 9));
}

[[noreturn]] void refuse(const ForeignFile& file, const std::string& format, const std::string& what)
{
    throw Failure("'" + file.name + "' looks like " + format + ", but " + what);
}

//! "word:" or "word: value"
bool hasKey(const std::string& line)
{
    const size_t end = line.find_first_of(": \t");
    return end > 0 && end != std::string::npos && line[end] == ':' && (end + 1 == line.size() || std::strchr(" \t\r", line[end + 1]));
}

//! Nothing: the module is to read it, and to say what it thinks of it.
std::optional<ForeignRig> readNotation(const ForeignFile& file, const Notation& notation)
{
    std::string format = notation.name;
    const bool isStorage = notation.isOurs && (begins(file, "%YAML") || begins(file, "<?xml") || begins(file, "{"));
    try
    {
        const Json tree = notation.read(file);
        if (notation.isOurs && isOwn(tree))
            return {};
        ForeignRig rig = readKeyedCameras(tree, format);
        if (!rig.cameras.empty())
            return rig;
        if (isStorage || !tree.isObject())
            return {};
        for (const std::string& name : tree.names())
            if (!notation.isOurs && tree.at(name).isText())
                throw Failure("'" + name + "' is an object of a class: save it as a struct, p = toStruct(" + name
                              + "); save(file, 'p', '-v7')");
    }
    catch (const Failure& e)
    {
        refuse(file, format, e.what());
    }
    catch (const Json::Error& e)
    {
        // Any text may look like YAML, and cv::FileStorage's JSON has .Nan; but a text that is cut short was one.
        const size_t last = file.bytes.find_last_not_of(" \t\r\n");
        const bool isOne = format == "JSON" ? file.bytes[last] != '}' : !isStorage && hasKey(file.firstLine());
        if (format == notation.name && notation.isOurs && !isOne)
            return {};
        refuse(file, format, e.what());
    }
    refuse(file, format, "there is no camera in it: camera_matrix and distortion_coefficients, or K and D, are missing");
}

std::optional<ForeignRig> readOne(const ForeignFile& file)
{
    if (file.bytes.find("glass_window") != std::string::npos)       // refract's own word: nothing to look for in a large file
        return {};
    for (const Format& format : FORMATS)
        if (format.is(file))
            try
            {
                ForeignRig rig = format.read(file);
                rig.format = format.name;
                return rig;
            }
            catch (const Failure& e)
            {
                refuse(file, format.name, e.what());
            }
    for (const Notation& notation : NOTATIONS)
        if (notation.is(file))
            return readNotation(file, notation);
    return {};
}

ForeignFile contentsOf(const std::string& name)
{
    const size_t MOST = 64 << 20;           // a file of cameras is small
    ForeignFile file{name, ""};
    std::error_code error;
    if (!std::filesystem::is_regular_file(name, error) || std::filesystem::file_size(name, error) > MOST)
        return file;
    std::ifstream in(name, std::ios::binary);
    file.bytes.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    if (begins(file, "\xEF\xBB\xBF"))
        file.bytes.erase(0, 3);
    return file;
}

//! The place of the first camera is the frame of all.
void relateToFirst(ForeignRig& rig)
{
    if (rig.Rs.size() != rig.cameras.size())
    {
        rig.Rs.clear();
        rig.Ts.clear();
    }
    if (rig.Rs.empty())
        return;
    const double EDITED = 1e-3;
    const Mat R = rig.Rs[0].clone(), T = rig.Ts[0].clone();
    for (size_t c = 0; c < rig.Rs.size(); c++)
    {
        if (!checkRange(rig.Rs[c]) || !checkRange(rig.Ts[c]) || !(norm(rig.Rs[c]*rig.Rs[c].t(), Mat::eye(3, 3, CV_64F)) < EDITED))
            throw Failure("of " + rig.format + " the place of camera " + std::to_string(c + 1) + " is no rotation and translation: was the "
                          "file edited?");
        rig.Rs[c] = rig.Rs[c]*R.t();
        rig.Ts[c] = rig.Ts[c] - rig.Rs[c]*T;
        if (determinant(rig.Rs[c]) < 0)
            throw Failure("of " + rig.format + " camera " + std::to_string(c + 1) + " has a mirrored frame, and the first has none: is "
                          "its y axis turned?");
    }
    rig.Rs[0] = Mat::eye(3, 3, CV_64F);
    rig.Ts[0] = Mat::zeros(3, 1, CV_64F);
}

//! All files of a numbered name, each of one camera.
std::optional<ForeignRig> readNumbered(const std::string& pattern)
{
    std::optional<ForeignRig> rig;
    for (const std::string& name : numberedFiles(pattern))
    {
        const std::optional<ForeignRig> one = readOne(contentsOf(name));
        if (!one)
            return {};
        if (one->cameras.size() != 1)
            throw Failure("'" + name + "' has several cameras: a numbered name is that of files of one");
        if (!rig)
            rig = ForeignRig();
        rig->format = one->format;
        rig->cameras.push_back(one->cameras[0]);
        rig->Rs.insert(rig->Rs.end(), one->Rs.begin(), one->Rs.end());
        rig->Ts.insert(rig->Ts.end(), one->Ts.begin(), one->Ts.end());
    }
    return rig;
}

} // namespace

void ForeignRig::add(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const cv::Matx33d& cam_from_world, const cv::Vec3d& translation)
{
    cameras.push_back(camera);
    Rs.push_back(Mat(cam_from_world, true));
    Ts.push_back(Mat(translation, true));
}

std::string ForeignFile::firstLine() const
{
    std::istringstream in(bytes.substr(0, 4096));
    for (std::string line; takeLine(in, line); )
        if (line.find_first_not_of(" \t\r") != std::string::npos && line[line.find_first_not_of(" \t\r")] != '#')
            return line;
    return "";
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
    if (!rig)
        return {};
    relateToFirst(*rig);
    return rig;
}

} // namespace tools
