#include "calib_file.hpp"
#include "cli.hpp"
#include "file_output.hpp"

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>

namespace tools {

using cv::FileNode;
using cv::FileStorage;
using cv::refract::RefractiveCamera;

namespace {

double readNumber(const FileNode& node, double otherwise)
{
    return node.isReal() || node.isInt() ? (double)node : otherwise;
}

std::vector<double> readList(const FileNode& node)
{
    std::vector<double> numbers;
    if (node.isSeq())
        node >> numbers;
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
    cv::Mat matrix;
    if (node.isSeq())
        matrix = cv::Mat(readList(node), true);
    else if (node.isMap())
        node >> matrix;
    if (matrix.channels() != 1 || !cv::checkRange(matrix))
        return cv::Mat();
    matrix.convertTo(matrix, CV_64F);
    return matrix;
}

//! R and T of a file of two cameras.
void readRigid(const FileStorage& fs, const std::string& filename, Calibration& calibration)
{
    const cv::Mat R = readMatrix(fs["R"]), T = readMatrix(fs["T"]);
    if (R.total() != 9 || T.total() != 3)
        throw Failure("'" + filename + "' has two cameras but no 3x3 R and no T of 3 numbers beside them");
    calibration.R = cv::Matx33d(R.ptr<double>());
    calibration.T = cv::Vec3d(T.ptr<double>());
    if (cv::norm(calibration.R * calibration.R.t() - cv::Matx33d::eye()) > 1e-6)
        throw Failure("'" + filename + "': R is not a rotation");
}

std::tm utc()
{
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t now = epoch && *epoch ? (std::time_t)std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
    std::tm parts = {};
    gmtime_r(&now, &parts);
    return parts;
}

} // namespace

std::string timeStamp()
{
    char text[32];
    const std::tm parts = utc();
    std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

Calibration readCalibration(const std::string& filename)
{
    if (!std::filesystem::is_regular_file(filename))
        throw Failure("there is no calibration file '" + filename + "'");
    Calibration calibration;
    if (std::filesystem::path(filename).extension() == ".cameramodel")
    {
        calibration.cameras.push_back({RefractiveCamera::read(filename), WindowStd(), -1.});
        return calibration;
    }
    FileStorage fs;
    try
    {
        fs.open(filename, FileStorage::READ);
    }
    catch (const cv::Exception&)
    {
        fs.release();       // OpenCV's text is the name of a parser's function; said below
    }
    if (!fs.isOpened() || !fs.root().isMap())
        throw Failure("'" + filename + "' is not YAML, XML or JSON with a camera in it, or is cut short: write it again");
    if (fs["camera1"].empty())
    {
        calibration.cameras.push_back({RefractiveCamera::read(filename), WindowStd(), -1.});
        readEstimate(fs.root(), calibration.cameras[0]);
    }
    else
    {
        for (const std::string name : {"camera1", "camera2"})
        {
            calibration.cameras.push_back({RefractiveCamera::read(filename, name), WindowStd(), -1.});
            readEstimate(fs[name], calibration.cameras.back());
        }
        readRigid(fs, filename, calibration);
    }
    calibration.rms = readNumber(fs["rms"], -1.);
    calibration.covariance = readMatrix(fs["covariance"]);
    if (fs["command"].isString())
        fs["command"] >> calibration.command;
    return calibration;
}

void writeCalibration(const std::string& filename, const Calibration& calibration)
{
    OutputFile file(filename);
    FileStorage fs;
    if (!fs.open(file.temporary(), FileStorage::WRITE))
        throw Failure("cannot write '" + filename + "'");
    fs << "command" << calibration.command << "refract_version" << REFRACT_VERSION << "opencv_version" << CV_VERSION
       << "calibration_time" << timeStamp();
    if (calibration.stereo())
    {
        for (int i = 0; i < 2; ++i)
        {
            fs << "camera" + std::to_string(i + 1) << "{";
            writeCamera(fs, calibration.cameras[i]);
            fs << "}";
        }
        fs << "R" << cv::Mat(calibration.R) << "T" << cv::Mat(calibration.T);
        if (calibration.rms >= 0)
            fs << "rms" << calibration.rms;
    }
    else
        writeCamera(fs, calibration.cameras.at(0));
    if (!calibration.covariance.empty())
        fs << "covariance" << calibration.covariance;
    fs.release();
    file.commit();
}

} // namespace tools
