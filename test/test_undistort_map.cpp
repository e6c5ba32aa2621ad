// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// initRefractiveUndistortRectifyMap.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const Matx33d K(500, 0, 160, 0, 505, 120, 0, 0, 1), newK(480, 0, 155, 0, 482, 118, 0, 0, 1);
const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
const Size SIZE(320, 240);

GlassWindow pane() { return GlassWindow(Vec3d(-0.25, 0.1, 1), 20, 1.54, 50); }

Mat mapOf(const GlassWindow& window, InputArray depth, InputArray R = noArray(), InputArray newCameraMatrix = newK)
{
    Mat map1, map2;
    initRefractiveUndistortRectifyMap(K, D, window, depth, R, newCameraMatrix, SIZE, CV_32FC2, map1, map2);
    CHECK(map2.empty());
    return map1;
}

} // namespace

TEST_CASE("The map is the raw image of what each new pixel sees on the plane", "[undistort_map]")
{
    Matx33d R;
    Rodrigues(Vec3d(0.05, -0.08, 0.02), R);
    const Vec4d tilted(0.2, -0.1, 1, 700), plane = GENERATE(Vec4d(0, 0, 1, 500), Vec4d(0.2, -0.1, 1, 700));
    CAPTURE(plane);
    std::vector<Vec3d> points;
    std::vector<Vec2d> raw;
    for (int y = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x++)
        {
            const Vec3d d = R.t()*(newK.inv()*Vec3d(x, y, 1));
            points.push_back(plane[3]/d.dot(Vec3d(plane[0], plane[1], plane[2]))*d);
        }
    refractiveProjectPoints(points, Vec3d(), Vec3d(), K, D, pane(), raw);
    const Mat map = plane == tilted ? mapOf(pane(), plane, R) : mapOf(pane(), std::vector<double>{ 500 }, R);
    REQUIRE(map.size() == SIZE);
    CHECK(largestDifference(map, Mat(raw).reshape(2, SIZE.height)) < 5e-5);     // rounding to float32
    // Undistorting the map's raw pixels leads back to the new ones.
    std::vector<Vec2d> back;
    std::vector<double> depths;
    for (const Vec3d& X : points)
        depths.push_back(X[2]);
    refractiveUndistortPoints(raw, back, K, D, pane(), depths, R, newK);
    for (int y = 0, i = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x++, i++)
            REQUIRE(norm(back[i] - Vec2d(x, y)) < 1e-8);
}

TEST_CASE("Without window: cv::initUndistortRectifyMap, in every map type", "[undistort_map]")
{
    Matx33d R;
    Rodrigues(Vec3d(0.05, -0.08, 0.02), R);
    for (int type : { CV_32FC1, CV_32FC2, CV_16SC2 })
    {
        CAPTURE(typeToString(type));
        Mat ours1, ours2, theirs1, theirs2;
        initRefractiveUndistortRectifyMap(K, D, GlassWindow(), noArray(), R, newK, SIZE, type, ours1, ours2);
        initUndistortRectifyMap(K, D, R, newK, SIZE, type, theirs1, theirs2);
        REQUIRE(ours1.type() == theirs1.type());
        REQUIRE(ours2.type() == theirs2.type());
        if (type == CV_16SC2)
        {
            Mat ours, theirs, none;
            convertMaps(ours1, ours2, ours, none, CV_32FC2);
            convertMaps(theirs1, theirs2, theirs, none, CV_32FC2);
            CHECK(largestDifference(ours, theirs) <= 1./32);    // a tie between two thirty-seconds may fall either way
            continue;
        }
        CHECK(largestDifference(ours1, theirs1) < 5e-5);
        if (type == CV_32FC1)
            CHECK(largestDifference(ours2, theirs2) < 5e-5);
    }
}

TEST_CASE("The three map types say the same", "[undistort_map]")
{
    const std::vector<double> depth = { 400 };
    const Mat map = mapOf(pane(), depth);
    Mat x, y, fixed1, fixed2, merged, converted, none;
    initRefractiveUndistortRectifyMap(K, D, pane(), depth, noArray(), newK, SIZE, CV_32FC1, x, y);
    merge(std::vector<Mat>{ x, y }, merged);
    CHECK(largestDifference(map, merged) == 0);
    initRefractiveUndistortRectifyMap(K, D, pane(), depth, noArray(), newK, SIZE, CV_16SC2, fixed1, fixed2);
    convertMaps(fixed1, fixed2, converted, none, CV_32FC2);
    CHECK(largestDifference(map, converted) < 0.51/32);
    Mat camera1, camera2;
    initRefractiveUndistortRectifyMap(RefractiveCamera::create(K, D, pane()), depth, noArray(), newK, SIZE, CV_32FC2,
                                      camera1, camera2);
    CHECK(largestDifference(map, camera1) == 0);
}

TEST_CASE("An empty new camera matrix is the camera's, a projection matrix' left part is taken", "[undistort_map]")
{
    const std::vector<double> depth = { 400 };
    CHECK(largestDifference(mapOf(pane(), depth, noArray(), noArray()), mapOf(pane(), depth, noArray(), K)) == 0);
    Mat P = Mat::zeros(3, 4, CV_64F);
    Mat(newK).copyTo(P.colRange(0, 3));
    P.at<double>(0, 3) = -99;
    CHECK(largestDifference(mapOf(pane(), depth, noArray(), P), mapOf(pane(), depth, noArray(), newK)) == 0);
}

TEST_CASE("Infinitely far; a plane's sign and scale mean nothing", "[undistort_map]")
{
    const Mat far = mapOf(pane(), std::vector<double>{ INF });
    CHECK(largestDifference(far, mapOf(pane(), Scalar(INF))) == 0);      // as a number comes from Python
    CHECK(largestDifference(far, mapOf(pane(), std::vector<double>{ 1e12 })) < 1e-4);
    CHECK(largestDifference(far, mapOf(GlassWindow(), noArray())) < 5e-5);     // equal media: no change of direction
    const Mat plane = mapOf(pane(), Vec4d(0.2, -0.1, 1, 700));
    CHECK(largestDifference(plane, mapOf(pane(), Vec4d(-0.4, 0.2, -2, -1400))) < 5e-5);
}

TEST_CASE("Pixels with no answer map to (-1, -1)", "[undistort_map]")
{
    const auto countNone = [](const Mat& map)
    {
        int none = 0;
        for (int y = 0; y < map.rows; y++)
            for (int x = 0; x < map.cols; x++)
            {
                const Vec2f p = map.at<Vec2f>(y, x);
                REQUIRE((std::isfinite(p[0]) && std::isfinite(p[1])));
                none += p == Vec2f(-1, -1);
            }
        return none;
    };
    const int all = SIZE.area();
    CHECK(countNone(mapOf(pane(), std::vector<double>{ 400 })) == 0);
    CHECK(countNone(mapOf(pane(), std::vector<double>{ 40 })) == all);                 // before the window
    CHECK(countNone(mapOf(pane(), Vec4d(0, 0, 1, -400))) == all);                      // behind the camera
    CHECK(countNone(mapOf(pane(), std::vector<double>{ 400 }, Vec3d(0, CV_PI, 0))) == all);
    const int half = countNone(mapOf(pane(), Vec4d(1, 0, 0, 100)));                    // a wall on the right
    CHECK(half > all/4);
    CHECK(half < 3*all/4);
    Mat map1, map2;
    initRefractiveUndistortRectifyMap(K, D, pane(), std::vector<double>{ 40 }, noArray(), newK, SIZE, CV_16SC2, map1, map2);
    CHECK(map1.at<Vec2s>(5, 5) == Vec2s(-1, -1));
    CHECK(map2.at<ushort>(5, 5) == 0);
}

TEST_CASE("cv::remap with the map shows the plane as the pinhole would", "[undistort_map]")
{
    // A smooth pattern on the plane, seen through the window, then corrected: what the pinhole sees directly.
    const double depth = 500;
    const auto shade = [](const Vec3d& X) { return (float)(128 + 60*std::sin(X[0]/25) + 60*std::cos(X[1]/30)); };
    std::vector<Vec2d> grid;
    for (int y = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x++)
            grid.push_back(Vec2d(x, y));
    std::vector<Vec3d> seen;
    refractivePointsOnPlane(grid, seen, K, D, pane(), Vec4d(0, 0, 1, depth));
    Mat raw(SIZE, CV_32F), expected(SIZE, CV_32F), corrected;
    for (size_t i = 0; i < grid.size(); i++)
    {
        raw.at<float>((int)i/SIZE.width, (int)i%SIZE.width) = shade(seen[i]);
        expected.at<float>((int)i/SIZE.width, (int)i%SIZE.width) = shade(depth*(newK.inv()*Vec3d(grid[i][0], grid[i][1], 1)));
    }
    remap(raw, corrected, mapOf(pane(), std::vector<double>{ depth }), noArray(), INTER_LINEAR);
    const Rect inner(40, 40, SIZE.width - 80, SIZE.height - 80);
    CHECK(largestDifference(corrected(inner), expected(inner)) < 0.15);    // remap works in thirty-seconds of a pixel
    CHECK(largestDifference(raw(inner), expected(inner)) > 10);
}

TEST_CASE("16 bits hold no raw pixel beyond 32767: of an image that has it, it is refused", "[undistort_map]")
{
    const Matx33d far(20000, 0, 20000, 0, 20000, 50, 0, 0, 1), few(500, 0, 500, 0, 500, 5, 0, 0, 1);
    Mat map1, map2;
    for (const GlassWindow& window : { GlassWindow(), GlassWindow(Vec3d(0.05, 0, 1), 10, 1.5, 10) })
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(far, noArray(), window);
        const auto init = [&](const Matx33d& newK, Size size, int type)
        { return thrown([&] { initRefractiveUndistortRectifyMap(camera, 1000., noArray(), newK, size, type, map1, map2); }); };
        CHECK_THAT(init(far, Size(40000, 10), CV_16SC2), Contains("m1type is CV_16SC2") && Contains("new pixel (327") &&
                                                         Contains("(32768"));
        CHECK_THAT(init(few, Size(1000, 10), CV_16SC2), Contains("m1type is CV_16SC2"));
        CHECK(init(far, Size(30000, 10), CV_16SC2) == "");
        CHECK(init(far, Size(40000, 10), CV_32FC1) == "");
        CHECK(map1.at<float>(5, 39990) > 39000);
        // Of an image that does not reach so far, what is beyond it is beyond it.
        camera->setImageSize(Size(30000, 100));
        CHECK(init(far, Size(40000, 10), CV_16SC2) == "");
        CHECK(map1.at<Vec2s>(5, 39990)[0] == 32767);
    }
    const Ptr<RefractiveCamera> high = RefractiveCamera::create(Matx33d(20000, 0, 50, 0, 20000, 20000, 0, 0, 1), noArray());
    CHECK_THAT(thrown([&] { initRefractiveStereoRectifyMap(high, Mat(40000, 10, CV_32F, Scalar(1000)), Matx33d::eye(),
                                                           Matx34d(20000, 0, 50, 0, 0, 20000, 20000, 0, 0, 0, 1, 0), noArray(),
                                                           Size(10, 40000), CV_16SC2, map1, map2); }),
               Contains("m1type is CV_16SC2") && Contains("new pixel (0, 32768)"));
}

TEST_CASE("Bad arguments of the map are named", "[undistort_map]")
{
    Mat a, b;
    const auto init = [&](InputArray depth, InputArray newCameraMatrix, Size size, int type)
    {
        return thrown([&] { initRefractiveUndistortRectifyMap(K, D, pane(), depth, noArray(), newCameraMatrix, size, type, a, b); });
    };
    CHECK(init(Scalar(500), noArray(), SIZE, CV_32FC1) == "");
    CHECK_THAT(init(noArray(), noArray(), SIZE, CV_32FC1), Contains("depth is empty"));
    CHECK_THAT(init(std::vector<double>(3, 1.), noArray(), SIZE, CV_32FC1), Contains("depth") && Contains("3"));
    CHECK_THAT(init(std::vector<double>(1, 0.), noArray(), SIZE, CV_32FC1), Contains("depth") && Contains("0"));
    CHECK_THAT(init(Vec4d(0, 0, 0, 5), noArray(), SIZE, CV_32FC1), Contains("depth") && Contains("(0, 0, 0, 5)"));
    CHECK_THAT(init(Vec4d(0, NaN, 1, 5), noArray(), SIZE, CV_32FC1), Contains("depth") && Contains("nan"));
    CHECK_THAT(init(500., Matx22d::eye(), SIZE, CV_32FC1), Contains("newCameraMatrix") && Contains("2x2"));
    CHECK_THAT(init(500., Matx33d::zeros(), SIZE, CV_32FC1), Contains("newCameraMatrix"));
    CHECK_THAT(init(500., noArray(), Size(-4, 5), CV_32FC1), Contains("size") && Contains("-4"));
    CHECK_THAT(init(500., noArray(), SIZE, CV_8UC3), Contains("m1type") && Contains("8UC3"));
    CHECK(init(500., noArray(), Size(), CV_32FC1) == "");
    CHECK(a.empty());
}
