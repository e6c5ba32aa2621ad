// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which images a report shows, and how their points are told apart.
#include "report/figures.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <algorithm>

using namespace cv;
using namespace tools;

namespace {

//! Views "000", "001", ... of two points each, 0.1 px off but for the last, which is ten times as far off.
RigCalibration calibrationOf(int views, const std::string& path)
{
    RigCalibration c;
    for (int i = 0; i < views; i++)
    {
        const std::string stem = format("%03d", i);
        const std::vector<Point2d> points = {{20, 20}, {60, 40}};
        View view;
        view.stem = stem;
        view.objectPoints.resize(2);
        view.glass[0] = points;
        c.data.views.push_back(view);
        c.photos.push_back({path, stem, 0, true, points});
        for (const Point2d& p : points)
            c.residuals.push_back({0, i, true, p, Point2d(i + 1 < views ? 0.1 : 1., 0)});
    }
    c.fit.rms = 0.2;
    return c;
}

Mat decoded(const Thumbnail& thumbnail)
{
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<uchar> bytes;
    unsigned bits = 0;
    int count = 0;
    for (size_t i = thumbnail.uri.find(',') + 1; i < thumbnail.uri.size() && thumbnail.uri[i] != '='; i++)
    {
        bits = bits << 6 | (unsigned)digits.find(thumbnail.uri[i]);
        count += 6;
        if (count >= 8)
            bytes.push_back((uchar)(bits >> (count -= 8)));
    }
    return imdecode(bytes, IMREAD_COLOR);
}

} // namespace

TEST_CASE("Of very many images a report shows those to look at first, in their order", "[thumbnails]")
{
    CHECK(photosToShow(calibrationOf(40, "")).size() == 40);
    RigCalibration c = calibrationOf(300, "");
    c.photos[7].points.clear();                                         // not found
    c.data.views[150].glass[0][1] = Point2d(NAN, NAN);                  // left out
    c.residuals.erase(c.residuals.begin() + 301);
    const std::vector<Photo> shown = photosToShow(c);
    CHECK(shown.size() < 150);
    CHECK(std::is_sorted(shown.begin(), shown.end(), [](const Photo& a, const Photo& b) { return a.stem < b.stem; }));
    for (const char* stem : {"007", "150", "299"})
    {
        CAPTURE(stem);
        CHECK(std::any_of(shown.begin(), shown.end(), [&](const Photo& p) { return p.stem == stem; }));
    }
}

TEST_CASE("The colour of a point says how far off it is, and one left out is told from those used", "[thumbnails]")
{
    const TemporaryFolder folder;
    imwrite(folder / "grey.png", Mat(80, 100, CV_8U, Scalar(128)));
    RigCalibration c = calibrationOf(2, folder / "grey.png");
    const Vec3b near = decoded(makeThumbnail(c, c.photos[0])).at<Vec3b>(20, 20);
    const Vec3b far = decoded(makeThumbnail(c, c.photos[1])).at<Vec3b>(20, 20);
    CHECK(near[1] > near[2] + 80);                                      // green
    CHECK(far[2] > far[1] + 60);                                        // orange
    CHECK(far[1] > 100);
    CHECK_FALSE(makeThumbnail(c, c.photos[1]).suspect);
    c.data.views[1].glass[0][0] = Point2d(NAN, NAN);
    c.residuals.erase(c.residuals.begin() + 2);
    const Thumbnail spoilt = makeThumbnail(c, c.photos[1]);
    const Vec3b red = decoded(spoilt).at<Vec3b>(20, 20);
    CHECK(red[2] > red[1] + 100);
    CHECK(red[1] < 100);
    CHECK(spoilt.suspect);
    CHECK(photoScale(c).size() == 4);
}
