// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refractiveUndistortImage and drawRefractiveFrameAxes.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
const Matx33d K(500, 0, 320, 0, 500, 240, 0, 0, 1);

Ptr<RefractiveCamera> camera() { return RefractiveCamera::create(K, D, paper::pane()); }

} // namespace

TEST_CASE("An undistorted image shows a plane as the pinhole would", "[undistort_image]")
{
    // A bright dot on the plane, seen through the window, must appear where the pinhole has it.
    const Ptr<RefractiveCamera> c = camera();
    const std::vector<Point3d> dots = { { 0, 0, 600 }, { 200, -100, 600 }, { -250, 150, 600 } };
    std::vector<Point2d> raw;
    refractiveProjectPoints(dots, Vec3d(), Vec3d(), c, raw);
    const Matx33d newK(450, 0, 300, 0, 455, 250, 0, 0, 1);
    for (size_t i = 0; i < dots.size(); i++)
    {
        Mat image = Mat::zeros(480, 640, CV_8U), corrected;
        for (int y = 0; y < image.rows; y++)
            for (int x = 0; x < image.cols; x++)
                image.at<uchar>(y, x) = saturate_cast<uchar>(255*std::exp(-(std::pow(x - raw[i].x, 2) + std::pow(y - raw[i].y, 2))/18));
        refractiveUndistortImage(image, corrected, c, 600., newK);
        REQUIRE(corrected.size() == image.size());
        const Moments m = moments(corrected);
        CHECK(m.m10/m.m00 == Approx(450*dots[i].x/600 + 300).margin(0.05));
        CHECK(m.m01/m.m00 == Approx(455*dots[i].y/600 + 250).margin(0.05));
    }
}

TEST_CASE("An undistorted image: types, overloads, in place, without window cv::undistort", "[undistort_image]")
{
    CAPTURE(seed());
    Random random;
    Mat noise(480, 640, CV_32FC3);
    for (float& v : Mat_<float>(noise.reshape(1)))
        v = (float)random.uniform(0, 255);
    GaussianBlur(noise, noise, Size(), 3);
    const Ptr<RefractiveCamera> c = camera();
    Mat map1, map2;
    initRefractiveUndistortRectifyMap(c, 600., noArray(), noArray(), noise.size(), CV_16SC2, map1, map2);
    for (int type : { CV_8UC1, CV_8UC3, CV_16UC3, CV_16SC3, CV_32FC3, CV_64FC3 })
    {
        Mat image, expected, corrected, plane;
        noise.convertTo(image, type);
        if (type == CV_8UC1)
            extractChannel(image, image, 0);
        remap(image, expected, map1, map2, INTER_LINEAR, BORDER_CONSTANT);
        refractiveUndistortImage(image, corrected, K, D, paper::pane(), 600.);
        CAPTURE(type);
        CHECK(corrected.type() == image.type());
        CHECK(norm(corrected, expected, NORM_INF) == 0);
        refractiveUndistortImage(image, plane, c, Vec4d(0, 0, 1, 600), K);
        CHECK(norm(plane, expected, NORM_INF) == 0);
        refractiveUndistortImage(image, plane, K, D, paper::pane(), std::vector<double>(1, 600.));
        CHECK(norm(plane, expected, NORM_INF) == 0);
        refractiveUndistortImage(image, image, c, 600.);
        CHECK(norm(image, expected, NORM_INF) == 0);
    }
    Mat ours, theirs;
    refractiveUndistortImage(noise, ours, K, D, GlassWindow(), INF);
    undistort(noise, theirs, K, D);
    CHECK(norm(ours, theirs, NORM_L1)/ours.total() < 0.5);      // both round the places to 1/32 px
    for (int depth : { CV_8S, CV_32S })         // not of cv::remap
        CHECK_THAT(thrown([&] { refractiveUndistortImage(Mat::zeros(480, 640, depth), ours, c, 600); }),
                   Contains("src is " + typeToString(depth)));
    CHECK_THAT(thrown([&] { refractiveUndistortImage(noise, ours, c, -3.); }), Contains("depth is -3"));
    CHECK_THAT(thrown([&] { refractiveUndistortImage(noise, ours, c, noArray()); }), Contains("depth is empty"));
}

TEST_CASE("An image that is too large for cv::remap is undistorted in parts", "[undistort_image]")
{
    CAPTURE(seed());
    Random random(3);
    for (const Size& size : { Size(40000, 60), Size(50, 36000), Size(32767, 20) })
        for (double zoom : { 1., 0.2 })     // small: a part of the new image shows all of the raw one
        {
            const Point2d middle(0.5*(size.width - 1), 0.5*(size.height - 1));
            const double f = std::max(size.width, size.height);
            const GlassWindow window(size.width > size.height ? Vec3d(0.05, 0, 1) : Vec3d(0, 0.05, 1), 10, 1.5, 10, 1.333);
            const Matx33d large(f, 0, middle.x, 0, f, middle.y, 0, 0, 1), newK(zoom*f, 0, middle.x, 0, zoom*f, middle.y, 0, 0, 1);
            const Ptr<RefractiveCamera> c = RefractiveCamera::create(large, std::vector<double>{ -0.05, 0.01, 0, 0 }, window);
            Mat image(size, CV_8U), corrected, map, none;
            for (uchar& v : Mat_<uchar>(image))
                v = (uchar)random.below(256);
            GaussianBlur(image, image, Size(), 2);
            refractiveUndistortImage(image, corrected, c, 900., newK);
            REQUIRE(corrected.size() == size);
            initRefractiveUndistortRectifyMap(c, 900., noArray(), newK, size, CV_32FC2, map, none);
            const auto at = [&](double x, double y)     // far outside of a lens no int holds them
            {
                return x >= 0 && x < size.width && y >= 0 && y < size.height ? image.at<uchar>((int)y, (int)x) : 0.;
            };
            double worst = 0;
            for (int y = 0; y < size.height; y++)
                for (int x = 0; x < size.width; x++)
                {
                    const Vec2f p = map.at<Vec2f>(y, x);
                    const double column = std::floor(p[0]), row = std::floor(p[1]);
                    const double a = p[0] - column, b = p[1] - row;
                    const double expected = (1 - b)*((1 - a)*at(column, row) + a*at(column + 1, row)) +
                                            b*((1 - a)*at(column, row + 1) + a*at(column + 1, row + 1));
                    worst = std::max(worst, std::abs(expected - corrected.at<uchar>(y, x)));
                }
            CAPTURE(size, zoom);
            CHECK(countNonZero(corrected) > 0);
            CHECK(worst < 12);      // remap's thirty-seconds of a pixel; at a border to black
        }
}

TEST_CASE("Axes are drawn where the window shows them", "[frame_axes]")
{
    // Before water, which moves what it shows by tens of pixels.
    const GlassWindow window(Vec3d(-0.2483, 0.0961, 1), 20, 1.5437, 50, 1.333);
    const Ptr<RefractiveCamera> c = RefractiveCamera::create(K, D, window);
    const Vec3d rvec(0.4, -0.5, 0.1), tvec(-90, 70, 500);
    const std::vector<Point3d> ends = { { 100, 0, 0 }, { 0, 100, 0 }, { 0, 0, 100 }, { 50, 0, 0 } };
    std::vector<Point2d> pixels, bare;
    refractiveProjectPoints(ends, rvec, tvec, c, pixels);
    projectPoints(ends, rvec, tvec, K, D, bare);
    Mat image = Mat::zeros(480, 640, CV_8UC3), same = image.clone();
    drawRefractiveFrameAxes(image, c, rvec, tvec, 100, 1);
    drawRefractiveFrameAxes(same, K, D, window, rvec, tvec, 100, 1);
    CHECK(norm(image, same, NORM_INF) == 0);
    const Vec3b red(0, 0, 255), green(0, 255, 0), blue(255, 0, 0);
    const Vec3b expected[] = { red, green, blue, red };
    for (int i = 0; i < 4; i++)
    {
        CAPTURE(i);
        CHECK(image.at<Vec3b>(Point(pixels[i])) == expected[i]);
        REQUIRE(norm(pixels[i] - bare[i]) > 5);
        CHECK(image.at<Vec3b>(Point(bare[i])) != expected[i]);      // the glass counts
    }

    // Without window: cv::drawFrameAxes, but for the ends of the pieces of a line.
    Mat ours = Mat::zeros(480, 640, CV_8UC3), theirs = ours.clone(), far;
    drawRefractiveFrameAxes(ours, K, D, GlassWindow(), rvec, tvec, 100, 3);
    drawFrameAxes(theirs, K, D, rvec, tvec, 100, 3);
    Mat difference, grown;
    dilate(theirs, grown, Mat(), Point(-1, -1), 2);
    subtract(ours, grown, difference);
    CHECK(norm(difference, NORM_INF) == 0);
    dilate(ours, grown, Mat(), Point(-1, -1), 2);
    subtract(theirs, grown, difference);
    CHECK(norm(difference, NORM_INF) == 0);

    // What has no image is left out, what has one is drawn.
    Mat behind = Mat::zeros(480, 640, CV_8U), partly = Mat::zeros(480, 640, CV_8UC4);
    drawRefractiveFrameAxes(behind, c, rvec, Vec3d(0, 0, -600), 100);
    CHECK(countNonZero(behind) == 0);
    drawRefractiveFrameAxes(partly, c, Vec3d(0, CV_PI, 0), Vec3d(0, 0, 120), 1000);      // z runs into the camera
    CHECK(norm(partly, NORM_INF) == 255);
}

TEST_CASE("Bad arguments of drawRefractiveFrameAxes are named", "[frame_axes]")
{
    Mat image = Mat::zeros(48, 64, CV_8UC3), two = Mat::zeros(48, 64, CV_8UC2), none;
    const Vec3d zero, ahead(0, 0, 600);
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(image, camera(), zero, ahead, 0); }), Contains("length is 0"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(image, camera(), zero, ahead, (float)NaN); }), Contains("length is nan"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(image, camera(), zero, ahead, 5, 0); }), Contains("thickness is 0"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(image, camera(), zero, ahead, 5, 40000); }), Contains("thickness is 40000"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(two, camera(), zero, ahead, 5); }), Contains("2 channels"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(none, camera(), zero, ahead, 5); }), Contains("image is 0x0"));
    CHECK_THAT(thrown([&] { drawRefractiveFrameAxes(image, camera(), zero, Vec2d(), 5); }), Contains("tvec"));
}
