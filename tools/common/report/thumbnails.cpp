// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "report/figures.hpp"
#include "console/table.hpp"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const int WIDTH = 360;
const int QUALITY = 75;
const size_t MOST_PHOTOS = 120;         // a page of 3 MB
const Scalar NO_RESIDUAL = Scalar::all(255), LEFT_OUT(40, 40, 255);
// Blue, green, red; each for one RMS more.
const Scalar STEPS[] = {{80, 220, 60}, {70, 235, 200}, {30, 215, 255}, {20, 130, 255}};
const int STEP_COUNT = sizeof(STEPS)/sizeof(STEPS[0]);

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

//! What came of one point of an image.
struct PointFate
{
    bool used = false;
    double px = NONE;           //!< from where the calibration puts it; of images that took part
};

std::vector<PointFate> fatesOf(const RigCalibration& c, const Photo& photo)
{
    std::vector<PointFate> fates(photo.points.size());
    const auto mark = [&](const Point2d& pixel, double px) {
        const auto found = std::find(photo.points.begin(), photo.points.end(), pixel);
        if (found == photo.points.end())
            return;
        PointFate& fate = fates[found - photo.points.begin()];
        fate.used = true;
        if (px == px)
            fate.px = px;
    };
    for (const View& view : c.data.views)
        if (view.stem == photo.stem)
            for (const Point2d& p : (photo.glass ? view.glass : view.direct)[photo.camera])
                if (seen(p))
                    mark(p, NONE);
    for (const Residual& r : c.residuals)
        if (r.camera == photo.camera && r.glass == photo.glass && c.data.views[r.view].stem == photo.stem)
            mark(r.pixel, norm(r.error));
    return fates;
}

Scalar colourOf(const PointFate& fate, double rms)
{
    return fate.px == fate.px ? STEPS[std::min(STEP_COUNT - 1, (int)(fate.px/std::max(rms, 1e-12)))] : NO_RESIDUAL;
}

void drawPoint(Mat& picture, const Point2d& at, const PointFate& fate, double rms)
{
    if (fate.used)
        circle(picture, at, 3, colourOf(fate, rms), FILLED, LINE_AA);
    else
        drawMarker(picture, at, LEFT_OUT, MARKER_TILTED_CROSS, 11, 2, LINE_AA);
}

//! How much a person should look at it: infinite without target or with points left out, else the RMS in pixels.
double concernOf(const RigCalibration& c, const Photo& photo)
{
    double sum = 0.;
    int count = 0;
    const std::vector<PointFate> fates = fatesOf(c, photo);
    for (size_t i = 0; i < fates.size(); i++)
    {
        if (!seen(photo.points[i]))
            continue;
        if (!fates[i].used)
            return std::numeric_limits<double>::infinity();
        count++;
        sum += fates[i].px == fates[i].px ? fates[i].px*fates[i].px : 0.;
    }
    return count ? std::sqrt(sum/count) : std::numeric_limits<double>::infinity();
}

} // namespace

std::vector<PhotoScale> photoScale(const RigCalibration& c)
{
    std::vector<PhotoScale> scale;
    for (int i = 0; i < STEP_COUNT; i++)
        scale.push_back({format("rgb(%.0f,%.0f,%.0f)", STEPS[i][2], STEPS[i][1], STEPS[i][0]),
                         i + 1 < STEP_COUNT ? format("up to %.2g px", (i + 1)*c.fit.rms) : std::string("farther")});
    return scale;
}

std::vector<Photo> photosToShow(const RigCalibration& c)
{
    if (c.photos.size() <= MOST_PHOTOS)
        return c.photos;
    std::vector<std::pair<double, size_t>> byConcern;
    for (size_t i = 0; i < c.photos.size(); i++)
        byConcern.push_back({-concernOf(c, c.photos[i]), i});
    std::sort(byConcern.begin(), byConcern.end());
    std::vector<size_t> chosen;
    for (size_t k = 0; k < MOST_PHOTOS; k++)
        chosen.push_back(byConcern[k].second);
    std::sort(chosen.begin(), chosen.end());
    std::vector<Photo> shown;
    for (size_t i : chosen)
        shown.push_back(c.photos[i]);
    return shown;
}

Thumbnail makeThumbnail(const RigCalibration& c, const Photo& photo)
{
    const Mat grey = readGrey(photo.path);
    const double scale = std::min(1., (double)WIDTH/grey.cols);
    Mat small, picture;
    resize(grey, small, Size(), scale, scale, INTER_AREA);
    cvtColor(small, picture, COLOR_GRAY2BGR);
    const std::vector<PointFate> fates = fatesOf(c, photo);
    int found = 0, leftOut = 0;
    for (size_t i = 0; i < fates.size(); i++)
    {
        const Point2d& p = photo.points[i];
        if (!seen(p))
            continue;
        found++;
        leftOut += !fates[i].used;
        drawPoint(picture, (p + Point2d(0.5, 0.5))*scale - Point2d(0.5, 0.5), fates[i], c.fit.rms);
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
