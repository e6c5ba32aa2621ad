// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calibration_images.hpp"
#include "console/sha256.hpp"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>

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
