// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/exif.hpp"
#include "console/numbers.hpp"

#include <opencv2/imgcodecs.hpp>
#include <algorithm>
#include <mutex>

namespace tools {

namespace {

std::mutex turnedMutex;             // images are read by several threads
std::vector<std::string> turned;

} // namespace

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

void noteRotatedImage(const std::string& path)
{
    const std::lock_guard<std::mutex> lock(turnedMutex);
    if (std::find(turned.begin(), turned.end(), path) == turned.end())
        turned.push_back(path);
}

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

} // namespace tools
