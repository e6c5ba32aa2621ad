// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/calibration_images.hpp"
#include "console/sha256.hpp"
#include <cmath>
#include <filesystem>
#include <limits>

namespace tools {

//! Two images of a board that was held anew, even if it was not moved, differ by more: a hundredth of a pixel and on, of noise.
static const double SAME_PIXEL = 1e-4;

std::vector<UsedImage> usedImages(const RigImages& sets)
{
    std::vector<UsedImage> used;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (const DetectedImages* set : {&sets.direct[c], &sets.glass[c]})
        {
            const bool isFile = !(set->files.size() == 1 && isPointFile(set->files[0]));
            for (const DetectedImage& image : set->images)
                used.push_back({isFile ? image.path : "", {image.stem, c, "", meanOfSeen(image.points)}});
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

const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, int camera, const std::vector<cv::Point2d>& pixels)
{
    const cv::Point2d mean = meanOfSeen(pixels);
    for (const CalibrationImage& image : images)
        if (image.camera == camera && cv::norm(image.mean - mean) < SAME_PIXEL)     // false for NaN
            return &image;
    return nullptr;
}

} // namespace tools
