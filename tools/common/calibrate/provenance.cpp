// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/provenance.hpp"
#include "console/failure.hpp"
#include "console/sha256.hpp"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>

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

namespace {

//! Of older files, by the mean of the pixels: two images of a board, even if it was not moved, differ by more.
const double SAME_MEAN = 1e-4;

const size_t FEWEST = 2;                // pixels; one may be near to another by chance

//! How many of the pixels are where one of the others is. @param others in the order of x
size_t countSame(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& others, double tolerance)
{
    const auto left = [](const cv::Point2d& a, const cv::Point2d& b) { return a.x < b.x; };
    size_t count = 0;
    for (const cv::Point2d& pixel : pixels)
        for (auto other = std::lower_bound(others.begin(), others.end(), pixel - cv::Point2d(tolerance, 0.), left);
             other != others.end() && other->x < pixel.x + tolerance; ++other)
            if (cv::norm(*other - pixel) < tolerance)
            {
                count++;
                break;
            }
    return count;
}

//! In the order of x.
std::vector<cv::Point2d> seenOf(const std::vector<cv::Point2d>& pixels)
{
    std::vector<cv::Point2d> some;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(some), [](const cv::Point2d& p) { return seen(p); });
    std::sort(some.begin(), some.end(), [](const cv::Point2d& a, const cv::Point2d& b) { return a.x < b.x; });
    return some;
}

//! @param pixels, others in the order of x
bool areSame(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& others, double tolerance)
{
    const size_t half = std::min(pixels.size(), others.size())/2;
    return countSame(pixels, others, tolerance) >= std::max(FEWEST, half + 1);
}

std::vector<cv::Point2d> moved(std::vector<cv::Point2d> pixels, const cv::Point2d& by)
{
    for (cv::Point2d& pixel : pixels)
        pixel += by;
    return pixels;
}

/** How far beside the pixels of one image those of another are, all by as much: of one that was cropped, rolled or resampled. Where half of
the pixels are, one of the probes is, but for one time in 2^PROBES. @param pixels, others in the order of x */
std::optional<cv::Point2d> shiftBetween(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& others, double tolerance)
{
    const size_t PROBES = 8;
    std::vector<cv::Point2d> probes;
    for (size_t i = 0; i < std::min(PROBES, pixels.size()); i++)
        probes.push_back(pixels[i*pixels.size()/std::min(PROBES, pixels.size())]);
    std::optional<cv::Point2d> best;
    size_t most = 0;
    for (const cv::Point2d& probe : probes)
        for (const cv::Point2d& other : others)
        {
            const cv::Point2d shift = other - probe;
            if (countSame(moved(probes, shift), others, tolerance) < probes.size()/2)
                continue;
            const size_t count = countSame(moved(pixels, shift), others, tolerance);
            if (count > most)
            {
                most = count;
                best = shift;
            }
        }
    return best && areSame(moved(pixels, *best), others, tolerance) ? best : std::nullopt;
}

//! A board that was held anew is hardly ever a whole number of pixels beside where it was.
bool areSameBeside(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& others, double tolerance)
{
    const std::optional<cv::Point2d> shift = shiftBetween(pixels, others, tolerance);
    const cv::Point2d whole = shift ? cv::Point2d(std::round(shift->x), std::round(shift->y)) : cv::Point2d();
    return shift && cv::norm(*shift - whole) < tolerance && areSame(moved(pixels, whole), others, tolerance);
}

} // namespace

double sameImageTolerance(double pixelSigma)
{
    const double MOST = 0.5, SIGMAS = 3.;
    return pixelSigma > 0 ? std::min(MOST, std::max(USUAL_TOLERANCE, SIGMAS*pixelSigma)) : USUAL_TOLERANCE;
}

std::vector<UsedImage> usedImages(const RigImages& sets)
{
    std::vector<UsedImage> used;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (const DetectedImages* set : {&sets.direct[c], &sets.glass[c]})
        {
            const bool isFile = !(set->files.size() == 1 && isPointFile(set->files[0]));
            for (const DetectedImage& image : set->images)
                used.push_back({isFile ? image.path : "", {image.stem, c, "", meanOfSeen(image.points), seenOf(image.points)}});
        }
    return used;
}

std::vector<CalibrationImage> withHashes(const std::vector<UsedImage>& used)
{
    std::vector<CalibrationImage> images;
    for (const UsedImage& one : used)
    {
        if (!(one.image.mean == one.image.mean))
            continue;
        images.push_back(one.image);
        if (std::filesystem::is_regular_file(one.path))         // a frame of a video is none
            images.back().sha256 = sha256OfFile(one.path);
    }
    return images;
}

cv::Point2d meanOfSeen(const std::vector<cv::Point2d>& pixels)
{
    cv::Point2d sum;
    int count = 0;
    for (const cv::Point2d& pixel : pixels)
        if (seen(pixel))
        {
            sum += pixel;
            count++;
        }
    const double none = std::numeric_limits<double>::quiet_NaN();
    return count ? sum/count : cv::Point2d(none, none);
}

const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, const std::string& sha256)
{
    for (const CalibrationImage& image : images)
        if (!image.sha256.empty() && image.sha256 == sha256)
            return &image;
    return nullptr;
}

const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, int camera, const std::vector<cv::Point2d>& pixels,
                                  double tolerance)
{
    const cv::Point2d mean = meanOfSeen(pixels);
    const std::vector<cv::Point2d> sorted = seenOf(pixels);
    for (const CalibrationImage& image : images)
        if (image.camera == camera && (image.pixels.empty() ? cv::norm(image.mean - mean) < SAME_MEAN       // false for NaN
                                       : areSame(image.pixels, sorted, tolerance)
                                         || areSameBeside(image.pixels, sorted, std::min(tolerance, USUAL_TOLERANCE))))
            return &image;
    return nullptr;
}

std::vector<std::string> movedAlike(const std::vector<CalibrationImage>& images, const std::vector<CalibrationImage>& shown,
                                    double tolerance)
{
    struct Move { const CalibrationImage *from, *to; cv::Point2d by; };
    const double near = std::min(tolerance, USUAL_TOLERANCE);
    std::vector<Move> moves;
    for (const CalibrationImage& to : shown)
        for (const CalibrationImage& from : images)
            if (from.camera == to.camera && !from.pixels.empty())
                if (const auto by = shiftBetween(from.pixels, seenOf(to.pixels), near))
                    moves.push_back({&from, &to, *by});
    std::vector<std::string> names;
    for (const Move& a : moves)
        if (std::any_of(moves.begin(), moves.end(), [&](const Move& b) {
                return a.from != b.from && a.to != b.to && a.from->camera == b.from->camera && cv::norm(a.by - b.by) < near; })
            && std::find(names.begin(), names.end(), a.to->name) == names.end())
            names.push_back(a.to->name);
    return names;
}

bool areOfOneImage(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second, double tolerance)
{
    return areSame(seenOf(first), seenOf(second), tolerance);
}

} // namespace tools
