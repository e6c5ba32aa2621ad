// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/thumbnails.hpp"
#include "console/table.hpp"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <filesystem>

using namespace cv;

namespace tools {

namespace {

const int WIDTH = 360;
const int QUALITY = 75;
const Scalar USED(80, 220, 60), LEFT_OUT(40, 40, 255);

std::string base64(const std::vector<uchar>& bytes)
{
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3)
    {
        const size_t count = std::min<size_t>(3, bytes.size() - i);
        unsigned block = 0;
        for (size_t k = 0; k < 3; k++)
            block = block << 8 | (k < count ? bytes[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            text += k <= count ? digits[block >> (18 - 6*k) & 63] : '=';
    }
    return text;
}

//! What the calibration was made from, of that image.
std::vector<Point2d> usedPoints(const RigCalibration& c, const Photo& photo)
{
    std::vector<Point2d> used;
    for (const Moment& m : c.data.moments)
        if (m.stem == photo.stem)
            for (const Point2d& p : (photo.glass ? m.glass : m.direct)[photo.camera])
                if (seen(p))
                    used.push_back(p);
    return used;
}

} // namespace

std::vector<Photo> photosOf(const RigViewSets& sets)
{
    std::vector<Photo> photos;
    for (int c = 0; c < MAX_CAMERAS; c++)
        for (bool glass : {false, true})
        {
            const ViewSet& set = (glass ? sets.glass : sets.direct)[c];
            if (set.files.size() == 1 && isPointFile(set.files[0]))
                continue;
            for (const DetectedView& view : set.views)
                photos.push_back({view.path, view.stem, c, glass, view.points});
            for (const std::string& path : set.withoutTarget)
                photos.push_back({path, stemOf(path), c, glass, {}});
        }
    std::stable_sort(photos.begin(), photos.end(), [](const Photo& a, const Photo& b) { return a.stem < b.stem; });
    return photos;
}

Thumbnail makeThumbnail(const RigCalibration& c, const Photo& photo)
{
    const Mat grey = readGrey(photo.path);
    const double scale = std::min(1., (double)WIDTH/grey.cols);
    Mat small, picture;
    resize(grey, small, Size(), scale, scale, INTER_AREA);
    cvtColor(small, picture, COLOR_GRAY2BGR);
    const std::vector<Point2d> used = usedPoints(c, photo);
    int found = 0, leftOut = 0;
    for (const Point2d& p : photo.points)
    {
        if (!seen(p))
            continue;
        const bool isUsed = std::find(used.begin(), used.end(), p) != used.end();
        found++;
        leftOut += !isUsed;
        circle(picture, (p + Point2d(0.5, 0.5))*scale - Point2d(0.5, 0.5), isUsed ? 3 : 5, isUsed ? USED : LEFT_OUT, FILLED,
               LINE_AA);
    }
    std::vector<uchar> bytes;
    imencode(".jpg", picture, bytes, {IMWRITE_JPEG_QUALITY, QUALITY});
    Thumbnail thumbnail;
    thumbnail.uri = "data:image/jpeg;base64," + base64(bytes);
    thumbnail.caption = photo.stem + (c.data.cameraCount == 1 ? ", " : format(", camera %d, ", photo.camera + 1))
        + (photo.glass ? "through the window: " : "direct: ")
        + (found ? format("%d points", found) : std::string("target not found"))
        + (leftOut ? format(", %d left out", leftOut) : "");
    thumbnail.suspect = !found || leftOut;
    return thumbnail;
}

} // namespace tools
