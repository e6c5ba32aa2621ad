#include "calibrate/calib_file.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"

#include <sys/stat.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>

namespace tools {

using cv::FileNode;
using cv::FileStorage;
using cv::format;
using cv::refract::RefractiveCamera;

namespace {

const double UNIT = 1e-4;       // more than rounding leaves of a normal's length

double readNumber(const FileNode& node, double otherwise)
{
    return node.isReal() || node.isInt() ? (double)node : otherwise;
}

std::vector<double> readList(const FileNode& node)
{
    std::vector<double> numbers;
    if (node.isSeq())
        for (const FileNode& number : node)
            numbers.push_back(readNumber(number, NAN));
    return numbers;
}

void readEstimate(const FileNode& node, CameraCalibration& calibration)
{
    calibration.rms = readNumber(node["rms"], -1.);
    const FileNode window = node["glass_window_std"];
    if (!window.isMap())
        return;
    WindowStd& result = calibration.windowStd;
    result.normalDeg = readList(window["normal_deg"]);
    result.distance = readNumber(window["distance"], 0.);
    result.thickness = readList(window["thickness"]);
    result.index = readList(window["index"]);
    result.outerIndex = readNumber(window["outer_index"], 0.);
}

void writeCamera(FileStorage& fs, const CameraCalibration& calibration)
{
    calibration.camera->write(fs);
    const WindowStd& window = calibration.windowStd;
    if (!window.normalDeg.empty())
    {
        fs << "glass_window_std" << "{" << "normal_deg" << window.normalDeg << "distance" << window.distance
           << "thickness" << window.thickness << "index" << window.index << "outer_index" << window.outerIndex << "}";
    }
    if (calibration.rms >= 0)
        fs << "rms" << calibration.rms;
}

//! An OpenCV matrix or a plain list of numbers; empty if it is neither or not finite.
cv::Mat readMatrix(const FileNode& node)
{
    if (node.isSeq())
        return cv::checkRange(readList(node)) ? cv::Mat(readList(node), true) : cv::Mat();
    if (!node.isMap() || !node["rows"].isInt() || !node["cols"].isInt())
        return cv::Mat();
    // Not node >> matrix: that takes the memory for as many rows and columns as the file claims.
    const int rows = node["rows"], cols = node["cols"];
    const std::vector<double> data = readList(node["data"]);
    if (data.empty() || rows < 0 || cols < 0 || (int64_t)rows*cols != (int64_t)data.size() || !cv::checkRange(data))
        return cv::Mat();
    return cv::Mat(data, true).reshape(1, rows);
}

bool isCameraModel(const std::string& filename)
{
    return std::filesystem::path(filename).extension() == ".cameramodel";
}

void requireDistortion(const FileNode& camera, const std::string& filename)
{
    if (!camera["camera_matrix"].empty() && camera["distortion_coefficients"].empty())
        throw Failure("'" + filename + "' has no distortion_coefficients for its camera_matrix: is it cut short or edited? For "
                      "a lens without distortion write distortion_coefficients: [ 0., 0., 0., 0., 0. ]");
}

CameraCalibration readCamera(const FileNode& node, const std::string& filename, const std::string& name)
{
    CameraCalibration calibration;
    calibration.camera = RefractiveCamera::read(filename, name);
    requireDistortion(node, filename);
    calibration.windowGiven = !node["glass_window"].empty();
    const std::vector<double> normal = readList(node["glass_window"]["normal"]);
    calibration.normalLength = normal.empty() ? 1. : cv::norm(normal);
    readEstimate(node, calibration);
    return calibration;
}

/** Empty where the file has none; else it throws Failure where none can be: cut short or edited, it must not be taken for a
calibration that is exact. */
cv::Mat readCovariance(const FileStorage& fs, const std::string& filename)
{
    const FileNode node = fs["covariance"];
    const cv::Mat C = readMatrix(node);
    double least = 0., most = 0.;
    if (C.rows > 0 && C.rows == C.cols)
        cv::minMaxIdx(C.diag(), &least, &most);
    const double ROUNDING = 1e-12;
    if (!node.empty() && (C.empty() || C.rows != C.cols || least < -ROUNDING*most))
        throw Failure("'" + filename + "': the covariance is none: it must be a square matrix of finite numbers with none "
                      "below 0 on its diagonal. Was the file edited? Calibrate again");
    return C;
}

//! What the residuals told: not below 0, and finite.
double readNotNegative(const FileStorage& fs, const char* key, double otherwise, const std::string& filename)
{
    const FileNode node = fs[key];
    const double number = readNumber(node, NAN);
    if (!node.empty() && !(number >= 0. && std::isfinite(number)))
        throw Failure("'" + filename + "': " + key + " must be a number, and not below 0: was the file edited? Calibrate "
                      "again");
    return node.empty() ? otherwise : number;
}

//! In the order of calibrateGlassRig: lens, normal, distance, thickness, index, innerIndex, outerIndex of each; then R and T.
void requireCovarianceOf(const Calibration& calibration, const std::string& filename)
{
    int count = 6*((int)calibration.cameras.size() - 1);
    for (const CameraCalibration& c : calibration.cameras)
        count += (int)c.camera->parameterNames().size();
    const cv::Mat& C = calibration.covariance;
    if (!C.empty() && C.size() != cv::Size(count, count))
        throw Failure(format("'%s': the covariance is %dx%d, lens and window have %d parameters: was the file edited? Calibrate "
                             "again", filename.c_str(), C.rows, C.cols, count));
}

std::string cameraName(size_t camera) { return "camera" + std::to_string(camera + 1); }

//! What follows R and T of a camera after the first: nothing for the second, then its number.
std::string placeSuffix(size_t camera) { return camera == 1 ? "" : std::to_string(camera + 1); }

//! R and T of a camera after the first.
void readPlace(const FileStorage& fs, const std::string& filename, size_t camera, cv::Matx33d& R, cv::Vec3d& T)
{
    const std::string suffix = placeSuffix(camera);
    const cv::Mat rotation = readMatrix(fs["R" + suffix]), translation = readMatrix(fs["T" + suffix]);
    if (rotation.total() != 9 || translation.total() != 3)
        throw Failure("'" + filename + "' has a " + cameraName(camera) + " but no 3x3 R" + suffix + " and no T" + suffix
                      + " of 3 numbers beside it");
    R = cv::Matx33d(rotation.ptr<double>());
    T = cv::Vec3d(translation.ptr<double>());
    if (cv::norm(R*R.t() - cv::Matx33d::eye()) > 1e-6)
        throw Failure("'" + filename + "': R" + suffix + " is not a rotation");
}

//! Equal numbers share a window; empty where the file does not say.
std::vector<int> readWindows(const FileNode& node, const std::string& filename, size_t cameras)
{
    std::vector<int> windows;
    for (const FileNode& number : node.isSeq() ? node : FileNode())
        if (number.isInt())
            windows.push_back((int)number);
    if (!node.empty() && (!node.isSeq() || node.size() != cameras || windows.size() != cameras))
        throw Failure("'" + filename + format("': window_of_camera must have one whole number for each of %zu cameras", cameras));
    return windows;
}

//! Cameras under keys of their own.
void readCameras(const FileStorage& fs, const std::string& filename, Calibration& calibration)
{
    const size_t MOST = 16;
    if (!fs[cameraName(MOST)].empty())
        throw Failure("'" + filename + "' has more than 16 cameras");
    for (size_t c = 0; c < 2 || (c < MOST && !fs[cameraName(c)].empty()); c++)
    {
        cv::Matx33d R = cv::Matx33d::eye();
        cv::Vec3d T;
        const CameraCalibration camera = readCamera(fs[cameraName(c)], filename, cameraName(c));
        if (c > 0)
            readPlace(fs, filename, c, R, T);
        calibration.add(camera, R, T);
    }
    calibration.windows = readWindows(fs["window_of_camera"], filename, calibration.cameras.size());
}

//! Where a camera's parameters begin in the covariance of its file.
int firstParameter(const std::string& filename, const std::string& name)
{
    int first = 0;
    for (size_t c = 0; cameraName(c) != name && !name.empty(); c++)
        first += (int)RefractiveCamera::read(filename, cameraName(c))->parameterNames().size();
    return first;
}

std::time_t newestOf(const std::vector<std::string>& files)
{
    std::time_t newest = 0;
    struct stat status;
    for (const std::string& file : files)
        if (stat(file.c_str(), &status) == 0)
            newest = std::max(newest, status.st_mtime);
    return newest;
}

Label readLabel(const FileStorage& fs)
{
    Label label;
    if (fs["window_serial"].isString())
        fs["window_serial"] >> label.serial;
    for (const FileNode& note : fs["notes"])
        if (note.isString())
            label.notes.push_back({note.name(), (std::string)note});
    return label;
}

void writeLabel(FileStorage& fs, const Label& label)
{
    if (!label.serial.empty())
        fs << "window_serial" << label.serial;
    if (label.notes.empty())
        return;
    fs << "notes" << "{";
    for (const auto& note : label.notes)
        fs << note.first << note.second;
    fs << "}";
}

} // namespace

void Calibration::add(const CameraCalibration& camera, const cv::Matx33d& R, const cv::Vec3d& T)
{
    cameras.push_back(camera);
    Rs.push_back(R);
    Ts.push_back(T);
}

std::string timeOfFiles(const std::vector<std::string>& inputs)
{
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t time = epoch && *epoch ? (std::time_t)std::strtoll(epoch, nullptr, 10) : newestOf(inputs);
    std::tm parts = {};
    gmtime_r(&time, &parts);
    char text[32];
    std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

std::pair<std::string, std::string> parseNote(const std::string& text)
{
    // Not a std::regex: its matcher calls itself for every letter of the text.
    const size_t equals = text.find('=');
    const std::string key = text.substr(0, equals);
    const auto isPart = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
    if (equals == std::string::npos || key.empty() || std::isdigit((unsigned char)key[0]) || key[0] == '-'
        || !std::all_of(key.begin(), key.end(), isPart))
        throw Failure("--note=" + text + ": give KEY=TEXT with a KEY of letters, digits, _ and -, as in "
                      "--note=customer='Tunnel Ltd'");
    return {key, text.substr(equals + 1)};
}

KnownLens readLens(const std::string& filename, const std::string& name)
{
    KnownLens lens{RefractiveCamera::read(filename, name), cv::Mat()};
    if (isCameraModel(filename))
        return lens;
    const FileStorage fs(filename, FileStorage::READ);
    FileNode node = fs.root();
    const int first = firstParameter(filename, name);
    if (!name.empty())
        node = node[name];
    else if (node["camera_matrix"].empty())
        node = node["camera1"];
    requireDistortion(node, filename);
    const cv::Mat covariance = readCovariance(fs, filename);
    const int count = lens.camera->lensParameters().rows;
    if (covariance.rows == covariance.cols && covariance.rows >= first + (int)lens.camera->parameterNames().size())
        lens.covariance = covariance(cv::Rect(first, first, count, count)).clone();
    return lens;
}

Calibration readCalibration(const std::string& filename)
{
    if (!std::filesystem::is_regular_file(filename))
        throw Failure("there is no calibration file '" + filename + "'");
    Calibration calibration;
    if (isCameraModel(filename))
    {
        calibration.add({RefractiveCamera::read(filename), WindowStd(), -1., false});
        return calibration;
    }
    RefractiveCamera::read(filename);       // refuses what is no such file, in any way
    const FileStorage fs(filename, FileStorage::READ);
    if (fs["camera1"].empty())
        calibration.add(readCamera(fs.root(), filename, ""));
    else
        readCameras(fs, filename, calibration);
    calibration.rms = readNumber(fs["rms"], -1.);
    calibration.covariance = readCovariance(fs, filename);
    requireCovarianceOf(calibration, filename);
    calibration.sigma = readNotNegative(fs, "residual_sigma", -1., filename);
    calibration.freedom = readNotNegative(fs, "degrees_of_freedom", 0., filename);
    if (fs["unit"].isString())
        fs["unit"] >> calibration.unit;
    calibration.square = readNumber(fs["target_square"], 0.);
    calibration.label = readLabel(fs);
    if (fs["calibration_time"].isString())
        fs["calibration_time"] >> calibration.time;
    if (fs["command"].isString())
        fs["command"] >> calibration.command;
    return calibration;
}

void requireWindows(const Calibration& calibration, const std::string& filename, bool noWindow, const std::string& option)
{
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const CameraCalibration& camera = calibration.cameras[c];
        const std::string which = calibration.single() ? "" : format(" for camera %d", (int)c + 1);
        if (!camera.windowGiven && !noWindow)
            throw Failure("'" + filename + "' has no glass_window" + which + ": calibrate through the glass with refract_calib"
                          + (option.empty() ? "" : ", or say " + option + " if there is none"));
        if (camera.windowGiven && noWindow)
            throw Failure("'" + filename + "' has a glass_window" + which + ": leave " + option + " out");
        if (!(std::abs(camera.normalLength - 1.) < UNIT))
            throw Failure("'" + filename + "': the normal" + which + format(" has the length %g in place of 1: was the file "
                          "edited? Calibrate again, or divide its three numbers by that", camera.normalLength));
    }
}

void writeRig(FileStorage& fs, const Calibration& calibration)
{
    if (calibration.single())
    {
        writeCamera(fs, calibration.cameras[0]);
        return;
    }
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        fs << cameraName(c) << "{";
        writeCamera(fs, calibration.cameras[c]);
        fs << "}";
    }
    for (size_t c = 1; c < calibration.cameras.size(); c++)
        fs << "R" + placeSuffix(c) << cv::Mat(calibration.Rs[c]) << "T" + placeSuffix(c) << cv::Mat(calibration.Ts[c]);
    if (!calibration.windows.empty())
        fs << "window_of_camera" << calibration.windows;
    if (calibration.rms >= 0)
        fs << "rms" << calibration.rms;
}

void writeCalibration(const std::string& filename, const Calibration& calibration)
{
    OutputFile file(filename, ".yml");
    FileStorage fs;
    if (!fs.open(file.temporary(), FileStorage::WRITE))
        throw Failure("cannot write '" + filename + "'");
    fs << "command" << calibration.command << "refract_version" << REFRACT_VERSION << "opencv_version" << CV_VERSION
       << "calibration_time" << calibration.time;
    writeLabel(fs, calibration.label);
    if (calibration.square > 0)
        fs << "unit" << calibration.unit << "target_square" << calibration.square;
    writeRig(fs, calibration);
    if (calibration.freedom > 0)
        fs << "residual_sigma" << calibration.sigma << "degrees_of_freedom" << calibration.freedom;
    if (!calibration.covariance.empty())
        fs << "covariance" << calibration.covariance;
    fs.release();
    file.commit();
}

} // namespace tools
