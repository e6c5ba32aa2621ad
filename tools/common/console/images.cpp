// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/images.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <glob.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>

namespace tools {

namespace fs = std::filesystem;

namespace {

std::mutex turnedMutex;             // images are read by several threads
std::vector<std::string> turned;

std::vector<uchar> readBytes(const std::string& path)
{
    if (!fs::exists(path))
        throw Failure("there is no file '" + path + "'");
    if (!fs::is_regular_file(path))
        throw Failure("'" + path + "' is not a file: name an image");
    std::ifstream in(path, std::ios::binary);
    std::vector<uchar> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in)
        throw Failure("cannot read '" + path + "': check its access rights");
    if (bytes.empty())
        throw Failure("'" + path + "' is empty: take or copy the image again");
    return bytes;
}

/* libjpeg fills what is missing of a cut file with grey and only warns, so the end is looked for here: the marker FF D9
after the first scan (FF DA); before it, segments are skipped by their length, as a thumbnail has an end of its own. */
bool isCutJpeg(const std::vector<uchar>& bytes)
{
    if (bytes.size() < 2 || bytes[0] != 0xFF || bytes[1] != 0xD8)
        return false;
    size_t at = 2;
    while (at + 4 <= bytes.size() && bytes[at] == 0xFF && bytes[at + 1] != 0xDA)
        at += bytes[at + 1] == 0xFF ? 1 : 2 + 256*bytes[at + 2] + bytes[at + 3];
    for (; at + 2 <= bytes.size(); at++)
        if (bytes[at] == 0xFF && bytes[at + 1] == 0xD9)
            return false;
    return true;
}

//! Seen before libpng sees it, which prints words of its own. Chunks are length, name, data, sum; the last is IEND.
bool isCutPng(const std::vector<uchar>& bytes)
{
    static const uchar SIGNATURE[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (bytes.size() < sizeof SIGNATURE || !std::equal(std::begin(SIGNATURE), std::end(SIGNATURE), bytes.begin()))
        return false;
    for (size_t at = sizeof SIGNATURE; at + 12 <= bytes.size(); )
    {
        const size_t length = (size_t)bytes[at] << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
        if (std::string(bytes.begin() + (long)at + 4, bytes.begin() + (long)at + 8) == "IEND")
            return false;
        at += 12 + length;
    }
    return true;
}

//! The first page of several would be taken for all there is.
void requireOnePage(const std::string& path, const std::vector<uchar>& bytes)
{
    const bool isTiff = bytes.size() > 4 && ((bytes[0] == 'I' && bytes[1] == 'I') || (bytes[0] == 'M' && bytes[1] == 'M'));
    const size_t pages = isTiff ? cv::imcount(path, cv::IMREAD_UNCHANGED) : 1;
    if (pages > 1)
        throw Failure("'" + path + "' has " + std::to_string(pages) + " pages: save each as an image of its own");
}

//! The file is read as stored; one warning at the end of the tool names all such files.
void noteRotatedImage(const std::string& path)
{
    const std::lock_guard<std::mutex> lock(turnedMutex);
    if (std::find(turned.begin(), turned.end(), path) == turned.end())
        turned.push_back(path);
}

/** Whether the EXIF data of a JPEG or PNG file rotate the picture: OpenCV's reader decides, with and without them. (A picture that is the
same when rotated counts as not rotated.) */
bool hasExifRotation(const std::vector<unsigned char>& bytes)
{
    const size_t EARLY = 1 << 20;       // bytes; EXIF data are before the picture, but may hold a small one of their own
    const auto end = bytes.begin() + (long)std::min(bytes.size(), EARLY);
    const auto has = [&](const std::string& mark) { return std::search(bytes.begin(), end, mark.begin(), mark.end()) != end; };
    if (!has("Exif") && !has("eXIf"))   // hardly ever is a picture read twice for nothing
        return false;
    // Only the small picture of an eighth is made.
    const cv::Mat turned = cv::imdecode(bytes, cv::IMREAD_REDUCED_GRAYSCALE_8);
    const cv::Mat stored = cv::imdecode(bytes, cv::IMREAD_REDUCED_GRAYSCALE_8 | cv::IMREAD_IGNORE_ORIENTATION);
    return turned.size() != stored.size() || (!stored.empty() && cv::norm(turned, stored, cv::NORM_INF) > 0);
}

/* As the sensor saw it: the orientation in the EXIF data is ignored, which turns with how the camera was held, while
the lens does not. */
cv::Mat decode(const std::string& path, int flags)
{
    const std::vector<uchar> bytes = readBytes(path);
    if (isCutJpeg(bytes) || isCutPng(bytes))
        throw Failure("'" + path + "' is cut short: take or copy the image again");
    cv::Mat image;
    try
    {
        image = cv::imdecode(bytes, flags == cv::IMREAD_UNCHANGED ? flags
                                                                  : flags | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    }
    catch (const cv::Exception&)
    {
        image.release();    // said below
    }
    if (image.empty() && isNamedAsVideo(path))
        throw Failure("'" + path + "' is a video: save the frames wanted as images, as in ffmpeg -i " + path + " -r 1 frame%04d.png");
    if (image.empty())
        throw Failure("'" + path + "' is not an image of a kind that can be read (PNG, JPEG, TIFF, BMP, PGM, PPM are), or is cut "
                      "short: turn it into one of these, or take or copy it again");
    if (hasExifRotation(bytes))
        noteRotatedImage(path);
    requireOnePage(path, bytes);
    return image;
}

} // namespace

std::string takeRotationNotice()
{
    const std::lock_guard<std::mutex> lock(turnedMutex);
    std::vector<std::string> names;
    names.swap(turned);
    if (names.empty())
        return "";
    std::sort(names.begin(), names.end());
    return "the EXIF data of " + listed(names) + (names.size() == 1 ? " asks" : " ask") + " for a turned picture; the pixels are "
           "used as they are stored, since the lens does not turn with the camera";
}

static const char* const CHANNELS[] = {"blue", "green", "red", "brightness"};

std::string nameOf(Channel channel) { return CHANNELS[channel]; }

Channel channelOf(const std::string& name)
{
    return (Channel)(std::find(CHANNELS, CHANNELS + BRIGHTNESS, name) - CHANNELS);
}

cv::Mat greyOf(const cv::Mat& image, Channel channel)
{
    cv::Mat grey = image;
    if (image.channels() == 3 && channel == BRIGHTNESS)
        cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    else if (image.channels() == 3)
        cv::extractChannel(image, grey, channel);
    return grey;
}

cv::Mat remapChannels(const cv::Mat& image, const std::vector<cv::Mat>& maps, int interpolation)
{
    cv::Mat result;
    if (maps.size() == 1)
    {
        cv::remap(image, result, maps[0], cv::noArray(), interpolation);
        return result;
    }
    std::vector<cv::Mat> channels;
    cv::split(image, channels);
    const bool hasAlpha = channels.size() == maps.size() + 1;
    CV_Assert(hasAlpha || channels.size() == maps.size());
    cv::Mat alpha;
    for (size_t i = 0; i < maps.size(); i++)
    {
        cv::Mat ofColour;
        if (hasAlpha)
            cv::remap(channels.back(), ofColour, maps[i], cv::noArray(), interpolation);
        alpha = alpha.empty() ? ofColour : cv::Mat(cv::min(alpha, ofColour));
        cv::remap(channels[i].clone(), channels[i], maps[i], cv::noArray(), interpolation);
    }
    if (hasAlpha)
        channels.back() = alpha;
    cv::merge(channels, result);
    return result;
}

bool isNamedAsVideo(const std::string& path)
{
    static const std::set<std::string> VIDEOS = {".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".mpg", ".mpeg", ".ts", ".wmv",
                                                 ".flv", ".ogv", ".mjpg", ".mjpeg", ".y4m", ".264", ".h264", ".265", ".h265"};
    return VIDEOS.count(inLowerCase(fs::path(path).extension().string())) > 0;
}

std::vector<std::string> matchingFiles(const std::string& pattern)
{
    if (fs::is_regular_file(pattern))
        return {pattern};
    glob_t matches = {};
    const int result = ::glob(pattern.c_str(), GLOB_BRACE | GLOB_TILDE, nullptr, &matches);
    std::vector<std::string> paths(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
    globfree(&matches);
    if (result == GLOB_NOSPACE)
        throw std::bad_alloc();
    return paths;
}

std::vector<std::string> expandGlob(const std::string& pattern)
{
    if (pattern.empty())
        throw Failure("an empty name was given for images: is a variable of the shell not set?");
    if (fs::is_directory(pattern))
        throw Failure("'" + pattern + "' is a folder: say which images in it, as in '" + pattern + "/*.png'");
    const std::vector<std::string> paths = matchingFiles(pattern);
    if (paths.empty() && pattern.find_first_of("*?[{") == std::string::npos)
        throw Failure("there is no file '" + pattern + "': check folder and name");
    if (paths.empty())
        throw Failure("no file matches '" + pattern + "': check the folder, and quote the pattern on the command line");
    return paths;
}

cv::Mat readGrey(const std::string& path, Channel channel)
{
    cv::Mat image = channel == BRIGHTNESS ? decode(path, cv::IMREAD_GRAYSCALE) : greyOf(readImage(path), channel);
    double brightest = 0;
    if (image.depth() != CV_8U)
    {
        cv::minMaxLoc(image, nullptr, &brightest);
        image.convertTo(image, CV_8U, brightest > 0 ? 255./brightest : 1.);
    }
    return image;
}

cv::Mat readImage(const std::string& path, bool withAlpha)
{
    if (withAlpha)
    {
        const cv::Mat image = decode(path, cv::IMREAD_UNCHANGED);
        if (image.channels() != 2)          // grey with alpha, which few formats can be written with
            return image;
    }
    return decode(path, cv::IMREAD_ANYCOLOR);
}

ImageFacts factsOf(const std::string& path)
{
    const cv::Mat image = readImage(path);
    bool coloured = false;
    for (int channel : {BLUE, RED})
    {
        cv::Mat one, green;
        if (image.channels() != 3 || coloured)
            continue;
        cv::extractChannel(image, one, channel);
        cv::extractChannel(image, green, GREEN);
        coloured = cv::norm(one, green, cv::NORM_INF) > 0;
    }
    return {image.size(), coloured};
}

void requireSize(const cv::Mat& image, const std::string& path, cv::Size calibrated)
{
    if (!calibrated.empty() && image.size() != calibrated)
        throw Failure("'" + path + "'" + cv::format(" is %dx%d pixels, the calibration is for %dx%d: use the images of this "
                      "camera, not resized", image.cols, image.rows, calibrated.width, calibrated.height));
}

std::vector<std::string> numberedFiles(const std::string& pattern)
{
    const auto numbered = [&](int number) { return std::string(pattern).replace(pattern.find("%d"), 2, std::to_string(number)); };
    std::vector<std::string> files;
    for (int number = fs::exists(numbered(0)) ? 0 : 1; fs::is_regular_file(numbered(number)); number++)
        files.push_back(numbered(number));
    return files;
}

std::string stemOf(const std::string& path)
{
    return fs::path(path).stem().string();
}

} // namespace tools
