// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/provenance.hpp"
#include "console/failure.hpp"
#include <algorithm>
#include <cctype>
#include <cmath>

using cv::FileNode;
using cv::FileStorage;

namespace tools {

using cv::FileNode;
using cv::FileStorage;

namespace {

const double HUNDREDTHS = 100.;         // of pixels

[[noreturn]] void refuse(const std::string& filename, const std::string& key)
{
    throw Failure("'" + filename + "': " + key + " is not as refract_calib writes it: was the file edited? Calibrate again");
}

//! As many finite numbers, or a refusal.
std::vector<double> numbersOf(const FileNode& node, size_t count, const std::string& filename, const std::string& key)
{
    std::vector<double> numbers;
    if (node.isSeq())
        for (const FileNode& number : node)
            numbers.push_back(number.isReal() || number.isInt() ? (double)number : NAN);
    for (double number : numbers)
        if (!std::isfinite(number))
            refuse(filename, key);
    if (numbers.size() != count)
        refuse(filename, key);
    return numbers;
}

CalibrationImage readImage(const FileNode& node, const std::string& filename)
{
    CalibrationImage image;
    if (!node.isMap() || !node["name"].isString() || !node["camera"].isInt())
        refuse(filename, "calibration_images");
    image.name = (std::string)node["name"];
    image.camera = (int)node["camera"] - 1;
    if (node["sha256"].isString())
        image.sha256 = (std::string)node["sha256"];
    const std::vector<double> mean = numbersOf(node["mean"], 2, filename, "calibration_images");
    image.mean = {mean[0], mean[1]};
    const std::vector<double> hundredths = numbersOf(node["pixels"], 2*(node["pixels"].size()/2), filename, "calibration_images");
    for (size_t i = 0; i < hundredths.size(); i += 2)
        image.pixels.push_back(cv::Point2d(hundredths[i], hundredths[i + 1])/HUNDREDTHS);
    return image;
}

UncertaintySource readSource(const FileNode& node, const std::string& filename)
{
    UncertaintySource source;
    if (!node.isMap() || !node["name"].isString() || node["factor"].empty())
        refuse(filename, "uncertainty_sources");
    source.name = (std::string)node["name"];
    if (node["given"].isString())
        source.given = (std::string)node["given"];
    if (node["std"].isReal() || node["std"].isInt())
        source.std = (double)node["std"];
    node["factor"] >> source.factor;
    if (source.factor.type() != CV_64F || !cv::checkRange(source.factor) || !(source.std >= 0))
        refuse(filename, "uncertainty_sources");
    return source;
}

//! In whole hundredths: short in the file.
std::vector<int> hundredthsOf(const std::vector<cv::Point2d>& pixels)
{
    std::vector<int> numbers;
    for (const cv::Point2d& p : pixels)
        numbers.insert(numbers.end(), {cvRound(HUNDREDTHS*p.x), cvRound(HUNDREDTHS*p.y)});
    return numbers;
}

std::vector<double> listOf(const cv::Point3d& p) { return {p.x, p.y, p.z}; }

} // namespace

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

bool CalibratedVolume::contains(const cv::Point3d& X) const
{
    return X.x >= least.x && X.x <= most.x && X.y >= least.y && X.y <= most.y && X.z >= least.z && X.z <= most.z;
}

Provenance readProvenance(const FileStorage& fs, const std::string& filename)
{
    Provenance provenance;
    if (!fs.isOpened())             // of a .cameramodel nothing is known
        return provenance;
    for (const FileNode& node : fs["calibration_images"])
        provenance.images.push_back(readImage(node, filename));
    for (const FileNode& node : fs["uncertainty_sources"])
        provenance.sources.push_back(readSource(node, filename));
    const FileNode volume = fs["calibrated_volume"];
    if (volume.empty())
        return provenance;
    const std::vector<double> least = numbersOf(volume["least"], 3, filename, "calibrated_volume");
    const std::vector<double> most = numbersOf(volume["most"], 3, filename, "calibrated_volume");
    provenance.volume = CalibratedVolume{{least[0], least[1], least[2]}, {most[0], most[1], most[2]}};
    for (int i = 0; i < 3; i++)
        if (!(provenance.volume->size()[i] >= 0))
            refuse(filename, "calibrated_volume");
    return provenance;
}

void writeProvenance(FileStorage& fs, const Provenance& provenance)
{
    if (provenance.volume)
        fs << "calibrated_volume" << "{" << "least" << listOf(provenance.volume->least) << "most" << listOf(provenance.volume->most) << "}";
    if (!provenance.images.empty())
    {
        fs << "calibration_images" << "[";
        for (const CalibrationImage& image : provenance.images)
        {
            fs << "{" << "name" << image.name << "camera" << image.camera + 1 << "mean" << "[:" << image.mean.x << image.mean.y << "]";
            if (!image.sha256.empty())
                fs << "sha256" << image.sha256;
            if (!image.pixels.empty())
            {
                fs << "pixels" << "[:";
                for (int number : hundredthsOf(image.pixels))
                    fs << number;
                fs << "]";
            }
            fs << "}";
        }
        fs << "]";
    }
    if (provenance.sources.empty())
        return;
    fs << "uncertainty_sources" << "[";
    for (const UncertaintySource& source : provenance.sources)
        fs << "{" << "name" << source.name << "given" << source.given << "std" << source.std << "factor" << source.factor << "}";
    fs << "]";
}

} // namespace tools
