// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calibration_images.hpp"
#include "console/sha256.hpp"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

namespace tools {

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

/** Whether one shows what the other does so many whole pixels beside it: cropped or rolled. Where half of the pixels do, one of the probes
does, but for one time in 2^PROBES. @param pixels, others in the order of x */
bool areSameBeside(const std::vector<cv::Point2d>& pixels, const std::vector<cv::Point2d>& others, double tolerance)
{
    const size_t PROBES = 8;
    std::vector<cv::Point2d> probes;
    for (size_t i = 0; i < std::min(PROBES, pixels.size()); i++)
        probes.push_back(pixels[i*pixels.size()/std::min(PROBES, pixels.size())]);
    for (const cv::Point2d& probe : probes)
        for (const cv::Point2d& other : others)
        {
            const cv::Point2d whole(std::round(other.x - probe.x), std::round(other.y - probe.y));
            if (cv::norm(other - probe - whole) < tolerance && countSame(moved(probes, whole), others, tolerance) >= probes.size()/2
                && areSame(moved(pixels, whole), others, tolerance))
                return true;
        }
    return false;
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

bool areOfOneImage(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second, double tolerance)
{
    return areSame(seenOf(first), seenOf(second), tolerance);
}

} // namespace tools
