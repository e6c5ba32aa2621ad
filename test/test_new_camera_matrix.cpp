// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// getOptimalNewRefractiveCameraMatrix: the new camera matrix that keeps the view.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const Size SIZE(1280, 960), NEW(900, 700);
const double BOW = 0.05;        // px: what a border may bow between the places where it was asked

std::vector<Ptr<RefractiveCamera> > someCameras()
{
    const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
    return { RefractiveCamera::create(PLAIN_K, D, paper::pane()),
             RefractiveCamera::create(PLAIN_K, D, GlassWindow(Vec3d(0.1, -0.05, 1), 12, 1.5, 40, 1.333)),
             RefractiveCamera::createFisheye(PLAIN_K, std::vector<double>{ 0.02, -0.01, 0, 0 }, paper::pane()) };
}

bool isInside(const Vec2d& p, Size size)
{
    return p[0] >= -BOW && p[1] >= -BOW && p[0] <= size.width - 1 + BOW && p[1] <= size.height - 1 + BOW;
}

std::vector<Vec2d> border()
{
    std::vector<Vec2d> pixels;
    for (int x = 0; x < SIZE.width; x++)
        for (int y : { 0, SIZE.height - 1 })
            pixels.push_back(Vec2d(x, y));
    for (int y = 0; y < SIZE.height; y++)
        for (int x : { 0, SIZE.width - 1 })
            pixels.push_back(Vec2d(x, y));
    return pixels;
}

//! How many pixels of a rectangle of the new image have none of the raw one.
int invalid(const Ptr<RefractiveCamera>& camera, const Mat& K, const Rect& where)
{
    Mat map, none;
    initRefractiveUndistortRectifyMap(camera, 600., noArray(), K, NEW, CV_32FC2, map, none);
    int count = 0;
    for (const Vec2f& p : Mat_<Vec2f>(map(where)))
        count += !isInside(p, SIZE);
    return count;
}

} // namespace

TEST_CASE("alpha 0 leaves no invalid pixel of a plane's image, alpha 1 loses no raw one", "[new_camera_matrix]")
{
    for (const Ptr<RefractiveCamera>& camera : someCameras())
        for (bool isCentred : { false, true })
        {
            CAPTURE(camera->lensModel(), isCentred);
            Rect roi0, roi1;
            const Mat all = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0, NEW, &roi0, isCentred);
            const Mat whole = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 1, NEW, &roi1, isCentred);
            const Mat between = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0.5, NEW, nullptr, isCentred);
            REQUIRE(all.size() == Size(3, 3));
            REQUIRE(all.type() == CV_64FC1);
            CHECK(norm(between, 0.5*(all + whole), NORM_INF) < 1e-9*norm(all));
            CHECK(all.at<double>(0, 0) > whole.at<double>(0, 0));

            CHECK(invalid(camera, all, Rect(Point(), NEW)) == 0);
            CHECK(roi0 == Rect(Point(), NEW));
            // No larger than need be: a little wider, and something is missing.
            Mat wider = all.clone();
            wider.at<double>(0, 0) *= 0.99;
            wider.at<double>(1, 1) *= 0.99;
            CHECK(invalid(camera, wider, Rect(Point(), NEW)) > 0);

            std::vector<Vec2d> shown;
            refractiveUndistortPoints(border(), shown, camera, 600., noArray(), whole);
            int outside = 0;
            Vec2d low(1e9, 1e9), high(-1e9, -1e9);
            for (const Vec2d& p : shown)
            {
                outside += !isInside(p, NEW);
                for (int c = 0; c < 2; c++)
                {
                    low[c] = std::min(low[c], p[c]);
                    high[c] = std::max(high[c], p[c]);
                }
            }
            CHECK(outside == 0);
            if (!isCentred)     // it fits on all sides
                CHECK(norm(low) + norm(high - Vec2d(NEW.width - 1, NEW.height - 1)) < 4*BOW);
            CHECK(roi1.area() > 0);
            CHECK(roi1.area() < NEW.area());
            CHECK(invalid(camera, whole, roi1) == 0);
            if (isCentred)
                for (const Mat& K : { all, whole })
                {
                    CHECK(K.at<double>(0, 2) == (NEW.width - 1)/2.);
                    CHECK(K.at<double>(1, 2) == (NEW.height - 1)/2.);
                    CHECK(K.at<double>(0, 0)/K.at<double>(1, 1) == Approx(1));
                }
        }
}

TEST_CASE("The new camera matrix: overloads, planes, and cv::getOptimalNewCameraMatrix without window", "[new_camera_matrix]")
{
    const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, D, paper::pane());
    Rect a, b;
    const Mat K = getOptimalNewRefractiveCameraMatrix(camera, 600., SIZE, 0.3, Size(), &a);
    const std::vector<double> number(1, 600.);
    for (const Mat& same : { getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, paper::pane(), 600., SIZE, 0.3, SIZE, &b),
                             getOptimalNewRefractiveCameraMatrix(camera, number, SIZE, 0.3),
                             getOptimalNewRefractiveCameraMatrix(camera, Vec4d(0, 0, 2, 1200), SIZE, 0.3),
                             getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, paper::pane(), number, SIZE, 0.3) })
        CHECK(norm(K, same, NORM_INF) < 1e-9);
    CHECK(a == b);
    CHECK(norm(K, getOptimalNewRefractiveCameraMatrix(camera, 300., SIZE, 0.3), NORM_INF) > 1);     // the depth counts
    for (bool isCentred : { false, true })
    {
        const Mat theirs = getOptimalNewCameraMatrix(PLAIN_K, D, SIZE, 0.3, NEW, &b, isCentred);
        CHECK(norm(getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, GlassWindow(), INF, SIZE, 0.3, NEW, &a, isCentred), theirs) == 0);
        CHECK(a == b);
        // A pane of no thickness takes the module's own way: the same but for where each counts the borders.
        const GlassWindow nothing(Vec3d(0, 0, 1), 0, 1.5);
        const Mat ours = getOptimalNewRefractiveCameraMatrix(PLAIN_K, D, nothing, 600., SIZE, 0.3, NEW, &a, isCentred);
        CHECK(norm(ours, theirs, NORM_INF) < 0.005*norm(theirs, NORM_INF));
    }
}

TEST_CASE("Bad arguments of the new camera matrix are named", "[new_camera_matrix]")
{
    const Ptr<RefractiveCamera> camera = someCameras()[0];
    const auto why = [&](double depth, Size size, double alpha, Size newSize)
    { return thrown([&] { getOptimalNewRefractiveCameraMatrix(camera, depth, size, alpha, newSize); }); };
    CHECK(why(600, SIZE, 0, NEW) == "");
    CHECK_THAT(why(-1, SIZE, 0, NEW), Contains("depth is -1"));
    CHECK_THAT(why(600, Size(0, 5), 0, NEW), Contains("imageSize is 0x5"));
    CHECK_THAT(why(600, SIZE, 0, Size(5, -1)), Contains("newImageSize is 5x-1"));
    CHECK_THAT(why(600, SIZE, 1.5, NEW), Contains("alpha is 1.5"));
    CHECK_THAT(why(600, SIZE, NaN, NEW), Contains("alpha is nan"));
    CHECK_THAT(why(30, SIZE, 0, NEW), Contains("a border of the image"));       // within the window
    CHECK_THAT(thrown([&] { getOptimalNewRefractiveCameraMatrix(camera, noArray(), SIZE, 0); }), Contains("depth is empty"));
}
