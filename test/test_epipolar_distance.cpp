// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Two cameras before a scene, and matches of random points of it.
struct MatchedPair
{
    Ptr<RefractiveCamera> camera1, camera2;
    Vec3d rvec, T;
    std::vector<Point2d> pixels1, pixels2;
};

MatchedPair matchedPair(const LensKind& lens, WindowKind kind, Random& random, int count)
{
    MatchedPair pair;
    pair.camera1 = makeCamera(lens, makeWindow(kind, random, 15));
    pair.camera2 = makeCamera(lens, makeWindow(kind, random, 15));
    pair.rvec = Vec3d(random.uniform(-0.05, 0.05), random.uniform(0.15, 0.3), random.uniform(-0.1, 0.1));
    pair.T = Vec3d(random.uniform(-220, -150), random.uniform(-20, 20), random.uniform(-10, 40));
    std::vector<Point3d> points;
    for (int i = 0; i < count; i++)
        points.push_back(Point3d(random.uniform(-70, 70), random.uniform(-70, 70), random.uniform(550, 800)));
    std::vector<uchar> status1, status2;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), pair.camera1, pair.pixels1, status1);
    refractiveProjectPoints(points, pair.rvec, pair.T, pair.camera2, pair.pixels2, status2);
    REQUIRE(countNonZero(status1) + countNonZero(status2) == 0);
    return pair;
}

//! By dense sampling: the distance of p from each curve, unsigned.
std::vector<double> byPolylines(const MatchedPair& m, int whichImage, const Vec2d& range)
{
    std::vector<std::vector<Point2d> > lines;
    computeRefractiveEpilines(whichImage == 1 ? m.pixels1 : m.pixels2, whichImage, m.camera1, m.camera2, m.rvec, m.T, range,
                              lines, 1e-7);
    std::vector<double> distances;
    for (size_t i = 0; i < lines.size(); i++)
    {
        const Point2d p = whichImage == 1 ? m.pixels2[i] : m.pixels1[i];
        double least = INF;
        for (size_t j = 1; j < lines[i].size(); j++)
        {
            const Point2d a = lines[i][j - 1], ab = lines[i][j] - a, ap = p - a;
            const double t = std::min(1., std::max(0., ap.dot(ab)/ab.dot(ab)));
            least = std::min(least, norm(ap - t*ab));
        }
        distances.push_back(least);
    }
    return distances;
}

} // namespace

TEST_CASE("Perfect matches have no distance, whatever lens and window", "[epipolar]")
{
    double largest = 0;
    for (WindowKind kind : allWindows())
        for (const LensKind& lens : allLenses())
            for (int which : { 1, 2 })
            {
                Random random(5000 + kind);
                CAPTURE(name(kind), lens.name, which, seed());
                const MatchedPair m = matchedPair(lens, kind, random, 100);
                std::vector<double> distances;
                std::vector<uchar> status;
                refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, status, which);
                REQUIRE(countNonZero(status) == 0);
                for (double d : distances)
                    largest = std::max(largest, std::abs(d));
                CHECK(largest < 1e-8);
            }
    printNumber("refractiveEpipolarDistance of perfect matches", largest, "px");
}

TEST_CASE("The distance is the one from a dense polyline, near and far off", "[epipolar][slow]")
{
    for (double off : { 1., 50., 300. })
    {
        double largest = 0;
        for (WindowKind kind : allWindows())
            for (const char* lens : { "the paper's", "5 coefficients", "fisheye" })
                for (int which : { 1, 2 })
                {
                    Random random(5100 + kind);
                    CAPTURE(name(kind), lens, which, off, seed());
                    MatchedPair m = matchedPair(lensNamed(lens), kind, random, 6);
                    for (Point2d& p : which == 1 ? m.pixels2 : m.pixels1)
                        p += Point2d(random.normal(off), random.normal(off));
                    const Vec2d range(250, 5000);
                    std::vector<double> distances;
                    std::vector<uchar> status;
                    refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, status, which,
                                               range);
                    const std::vector<double> expected = byPolylines(m, which, range);
                    for (size_t i = 0; i < expected.size(); i++)
                    {
                        CAPTURE(i, distances[i], expected[i], (int)status[i]);
                        if (expected[i] == INF)
                            CHECK(std::isnan(distances[i]));
                        else
                        {
                            largest = std::max(largest, std::abs(std::abs(distances[i]) - expected[i]));
                            CHECK(std::abs(std::abs(distances[i]) - expected[i]) < 1e-6 + 1e-6*off);
                        }
                    }
                }
        printNumber("refractiveEpipolarDistance " + std::to_string((int)off) + " px off, against polylines", largest, "px");
    }
}

TEST_CASE("Of pixels anywhere in the image the distance is seldom not the least", "[epipolar][slow]")
{
    int count = 0, other = 0;
    for (WindowKind kind : allWindows())
        for (const char* lens : { "the paper's", "5 coefficients", "fisheye" })
        {
            Random random(5150 + kind);
            MatchedPair m = matchedPair(lensNamed(lens), kind, random, 40);
            for (Point2d& p : m.pixels2)
                p = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
            const Vec2d range(250, 5000);
            std::vector<double> distances;
            refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, noArray(), 1, range);
            const std::vector<double> expected = byPolylines(m, 1, range);
            for (size_t i = 0; i < expected.size(); i++)
                if (expected[i] < INF)
                {
                    count++;
                    other += !(std::abs(std::abs(distances[i]) - expected[i]) < 1e-3*(1 + expected[i]));
                }
        }
    std::cout << "[numbers] refractiveEpipolarDistance of pixels anywhere: " << other << " of " << count
              << " are more than a thousandth off" << std::endl;
    CAPTURE(seed());
    REQUIRE(count > 500);
    CHECK(other < count/50);
}

TEST_CASE("The distance's derivative against differences", "[epipolar]")
{
    double largest = 0;
    for (WindowKind kind : { NO_WINDOW, PANE_IN_AIR, AIR_GLASS_WATER, WATER_GLASS_AIR })
        for (const char* lens : { "the paper's", "fisheye" })
            for (int which : { 1, 2 })
                for (const Vec2d& range : { Vec2d(0, INF), Vec2d(700, 710), Vec2d(300, 400) })   // mostly its ends
                {
                    Random random(5200 + kind);
                    MatchedPair m = matchedPair(lensNamed(lens), kind, random, 10);
                    for (Point2d& p : which == 1 ? m.pixels2 : m.pixels1)
                        p += Point2d(random.normal(2), random.normal(2));
                    std::vector<double> distances, depths;
                    std::vector<uchar> status;
                    Mat jacobian;
                    refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, status, which,
                                               range, depths, jacobian);
                    REQUIRE(jacobian.size() == Size(10, 10));
                    REQUIRE(countNonZero(status) == 0);
                    const double steps[] = { 1e-3, 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3 };
                    for (int c = 0; c < 10; c++)
                    {
                        std::vector<double> ends[2];
                        for (int side = 0; side < 2; side++)
                        {
                            MatchedPair n = m;
                            const double h = side ? steps[c] : -steps[c];
                            for (int i = 0; i < 10 && c < 4; i++)
                            {
                                Point2d& p = c < 2 ? n.pixels1[i] : n.pixels2[i];
                                (c % 2 ? p.y : p.x) += h;
                            }
                            if (c >= 4)
                                (c < 7 ? n.rvec[c - 4] : n.T[c - 7]) += h;
                            refractiveEpipolarDistance(n.pixels1, n.pixels2, n.camera1, n.camera2, n.rvec, n.T, ends[side],
                                                       noArray(), which, range);
                        }
                        for (int i = 0; i < 10; i++)
                        {
                            const double difference = (ends[1][i] - ends[0][i])/(2*steps[c]), J = jacobian.at<double>(i, c);
                            CAPTURE(name(kind), lens, which, range, i, c, J, difference, distances[i], depths[i], seed());
                            const double off = std::abs(J - difference)/(1 + std::abs(difference));
                            largest = std::max(largest, off);
                            CHECK(off < 2e-4);
                        }
                    }
                }
    printNumber("refractiveEpipolarDistance's jacobian, largest difference", largest, "");
}

TEST_CASE("The derivative where the other camera's sight ends, against differences", "[epipolar]")
{
    const Matx33d K(800, 0, 320, 0, 800, 240, 0, 0, 1);
    Random random(5250);
    int cut = 0;
    double largest = 0;
    for (double outerIndex : { 1., 1.33 })
        for (int which : { 1, 2 })
            for (int i = 0; i < 10; i++)
            {
                const Ptr<RefractiveCamera> camera1 = RefractiveCamera::create(K, noArray(), GlassWindow(Vec3d(0.2, 0.1, 1), 10, 1.5, 50,
                                                                                                         outerIndex));
                const Ptr<RefractiveCamera> camera2 = RefractiveCamera::create(K, noArray(), GlassWindow(Vec3d(-0.1, 0.1, 1), 10, 1.5, 90,
                                                                                                         outerIndex));
                const Vec3d rvec = random.vector(0.05), T = Vec3d(-200, 0, 0) + random.vector(10);
                const Vec4d pixels(320 + random.uniform(-100, 100), 240 + random.uniform(-100, 100), 320, 240);
                const Vec4d off = which == 1 ? Vec4d(0, 0, -3000, random.uniform(-500, 500)) : Vec4d(3000, random.uniform(-500, 500), 0, 0);
                const auto distanceAt = [&](const Vec4d& p, const Vec3d& r, const Vec3d& t, Mat& jacobian, Mat& depths)
                {
                    std::vector<double> distances;
                    Mat status;
                    refractiveEpipolarDistance(std::vector<Point2d>(1, Point2d(p[0], p[1])), std::vector<Point2d>(1, Point2d(p[2], p[3])),
                                               camera1, camera2, r, t, distances, status, which, Vec2d(0, DBL_MAX), depths, jacobian);
                    REQUIRE(status.at<uchar>(0) == REFRACT_OK);
                    return distances[0];
                };
                Mat jacobian, ignored, depths;
                const double distance = distanceAt(pixels + off, rvec, T, jacobian, depths);
                double image[10];
                for (int c = 0; c < 10; c++)
                {
                    double ends[2];
                    const double step = c < 4 ? 0.3 : c < 7 ? 3e-4 : 0.05;
                    for (int side = 0; side < 2; side++)
                    {
                        Vec4d p = pixels + off;
                        Vec3d r = rvec, t = T;
                        (c < 4 ? p[c] : c < 7 ? r[c - 4] : t[c - 7]) += side ? step : -step;
                        ends[side] = distanceAt(p, r, t, ignored, ignored);
                    }
                    image[c] = (ends[1] - ends[0])/(2*step);
                    const double J = jacobian.at<double>(0, c), wrong = std::abs(J - image[c])/(1 + std::abs(image[c]));
                    CAPTURE(outerIndex, which, i, c, J, image[c], distance, depths.at<double>(0), seed());
                    largest = std::max(largest, wrong);
                    CHECK(wrong < 2e-4);
                }
                const int own = which == 1 ? 2 : 0;
                cut += std::abs(std::hypot(image[own], image[own + 1]) - 1) < 1e-6 && depths.at<double>(0) < 200;
            }
    printNumber("refractiveEpipolarDistance's jacobian at ends of sight, largest difference", largest, "");
    CHECK(cut > 20);
}

TEST_CASE("Signs, depths and ends of the curve", "[epipolar]")
{
    Random random(5300);
    const MatchedPair m = matchedPair(lensNamed("the paper's"), PANE_IN_AIR, random, 30);
    std::vector<double> distances, depths;
    std::vector<uchar> status;
    Mat jacobian;
    CAPTURE(seed());

    SECTION("growing depth runs to the right here: below is positive")
    {
        std::vector<Point2d> lower = m.pixels2;
        for (Point2d& p : lower)
            p.y += 3;
        std::vector<std::vector<Point2d> > lines;
        computeRefractiveEpilines(m.pixels1, 1, m.camera1, m.camera2, m.rvec, m.T, Vec2d(500, 900), lines);
        refractiveEpipolarDistance(m.pixels1, lower, m.camera1, m.camera2, m.rvec, m.T, distances);
        for (size_t i = 0; i < distances.size(); i++)
        {
            const bool right = lines[i].back().x > lines[i].front().x;
            CHECK((right ? distances[i] : -distances[i]) > 2);
        }
    }
    SECTION("the depth of the nearest point is that of the match")
    {
        std::vector<Point3d> points;
        triangulateRefractive(m.camera1, m.camera2, m.rvec, m.T, m.pixels1, m.pixels2, points);
        refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, status, 1,
                                   Vec2d(0, DBL_MAX), depths, jacobian);
        for (size_t i = 0; i < depths.size(); i++)
            CHECK(depths[i] == Approx(points[i].z).epsilon(1e-4));
    }
    SECTION("beyond the range the distance is that of the end")
    {
        refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, distances, status, 1,
                                   Vec2d(300, 400), depths, jacobian);
        Mat ends;
        refractivePointsOnPlane(m.pixels1, ends, m.camera1, Vec4d(0, 0, 1, 400));
        std::vector<Point2d> pixels;
        refractiveProjectPoints(ends, m.rvec, m.T, m.camera2, pixels);
        for (size_t i = 0; i < depths.size(); i++)
        {
            CHECK(depths[i] == 400);
            CHECK(std::abs(distances[i]) == Approx(norm(pixels[i] - m.pixels2[i])).epsilon(1e-9));
        }
    }
    SECTION("a scene at infinity")
    {
        std::vector<Point2d> far = m.pixels2;
        std::vector<std::vector<Point2d> > lines;
        computeRefractiveEpilines(m.pixels1, 1, m.camera1, m.camera2, m.rvec, m.T, Vec2d(500, INF), lines);
        for (size_t i = 0; i < far.size(); i++)
            far[i] = lines[i].back();
        refractiveEpipolarDistance(m.pixels1, far, m.camera1, m.camera2, m.rvec, m.T, distances);
        for (double d : distances)
            CHECK(std::abs(d) < 1e-6);
    }
}

TEST_CASE("Epipolar distances: no answer, types, errors", "[epipolar]")
{
    Random random(5400);
    MatchedPair m = matchedPair(lensNamed("5 coefficients"), AIR_GLASS_WATER, random, 70);
    std::vector<double> all, distances;
    std::vector<uchar> status;
    CAPTURE(seed());
    refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, all);
    const auto run = [&](InputArray p1, InputArray p2, const Vec2d& range = Vec2d(0, INF))
    { refractiveEpipolarDistance(p1, p2, m.camera1, m.camera2, m.rvec, m.T, distances, status, 1, range); };

    SECTION("a bad match is its own problem")
    {
        std::vector<Point2d> p1 = m.pixels1, p2 = m.pixels2;
        p1[3].x = NaN;
        p2[65].y = INF;
        p1[10] = Point2d(1e6, 0);
        run(p1, p2);
        CHECK((status[3] == REFRACT_NOT_FINITE && std::isnan(distances[3])));
        CHECK((status[65] == REFRACT_NOT_FINITE && std::isnan(distances[65])));
        CHECK((status[10] == REFRACT_OUTSIDE_LENS_MODEL && std::isnan(distances[10])));
        for (int i : { 0, 2, 4, 11, 64, 66 })
            CHECK(distances[i] == Approx(all[i]).margin(1e-9));
    }
    SECTION("a range behind the window")
    {
        run(m.pixels1, m.pixels2, Vec2d(0.1, 1));
        CHECK(std::count(status.begin(), status.end(), REFRACT_BEHIND_WINDOW) == 70);
    }
    SECTION("float32, rows and columns, overload, nothing")
    {
        const std::vector<Point2f> f1(m.pixels1.begin(), m.pixels1.end()), f2(m.pixels2.begin(), m.pixels2.end());
        Mat out;
        refractiveEpipolarDistance(f1, f2, m.camera1, m.camera2, m.rvec, m.T, out);
        CHECK(out.type() == CV_32F);
        CHECK(out.size() == Size(1, 70));
        CHECK(largestDifference(out, all) < 1e-3);
        Mat padded(70, 5, CV_64F, Scalar(7)), strided = padded.colRange(1, 3);
        Mat(m.pixels1).reshape(1).copyTo(strided);
        refractiveEpipolarDistance(strided, m.pixels2, m.camera1->cameraMatrix(), m.camera1->distCoeffs(), m.camera1->window(),
                                   m.camera2->cameraMatrix(), m.camera2->distCoeffs(), m.camera2->window(), m.rvec, m.T, out);
        CHECK(largestDifference(out, all) == 0);
        // An array of the caller's keeps its shape and its place.
        Mat wide(70, 5, CV_64F, Scalar(7)), column = wide.col(3), row(1, 70, CV_64F), depths(1, 70, CV_64F), rowStatus(1, 70, CV_8U);
        Mat jacobian;
        refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, row, rowStatus, 1, Vec2d(0, INF), depths,
                                   jacobian);
        CHECK((row.size() == Size(70, 1) && depths.size() == Size(70, 1) && rowStatus.size() == Size(70, 1)));
        CHECK(largestDifference(row, all) < 1e-6);      // derivatives are wanted, too: a little nearer to the nearest point
        refractiveEpipolarDistance(m.pixels1, m.pixels2, m.camera1, m.camera2, m.rvec, m.T, column);
        CHECK(largestDifference(wide.col(3).clone(), all) == 0);
        run(std::vector<Point2d>(), std::vector<Point2d>());
        CHECK((distances.empty() && status.empty()));
    }
    SECTION("many: no thread sees another's")
    {
        std::vector<Point2d> p1, p2;
        for (int i = 0; i < 40000; i++)
        {
            p1.push_back(m.pixels1[i % 70]);
            p2.push_back(m.pixels2[i % 70]);
        }
        run(p1, p2);
        double worst = 0;
        for (int i = 0; i < 40000; i++)
            worst = std::max(worst, std::abs(distances[i] - all[i % 70]));
        CHECK(worst < 1e-9);
    }
    SECTION("one centre of projection: a curve that is a point")
    {
        const Ptr<RefractiveCamera> bare = paperCamera(GlassWindow());
        refractiveEpipolarDistance(std::vector<Point2d>(1, Point2d(600, 500)), std::vector<Point2d>(1, Point2d(603, 504)), bare,
                                   bare, Vec3d(), Vec3d(), distances, status);
        CHECK(std::abs(distances[0]) == Approx(5));
    }
    SECTION("DBL_MAX is infinity")
    {
        Mat a, b, depthsA, depthsB, jacobian, st;
        const std::vector<Point2d> far(1, Point2d(600, 500)), beyond(1, Point2d(5000, 500));
        for (const std::vector<Point2d>& other : { far, beyond, std::vector<Point2d>(1, Point2d(-5000, 500)) })
        {
            refractiveEpipolarDistance(far, other, m.camera1, m.camera2, m.rvec, m.T, a, st, 1, Vec2d(0, DBL_MAX), depthsA, jacobian);
            refractiveEpipolarDistance(far, other, m.camera1, m.camera2, m.rvec, m.T, b, st, 1, Vec2d(0, INF), depthsB, jacobian);
            CHECK(largestDifference(a, b) == 0);
            CHECK((std::isnan(depthsA.at<double>(0)) || depthsA.at<double>(0) == depthsB.at<double>(0)));
            CHECK(depthsA.at<double>(0) != DBL_MAX);
        }
        std::vector<std::vector<Point2d> > lines, same;
        computeRefractiveEpilines(far, 1, m.camera1, m.camera2, m.rvec, m.T, Vec2d(300, DBL_MAX), lines);
        computeRefractiveEpilines(far, 1, m.camera1, m.camera2, m.rvec, m.T, Vec2d(300, INF), same);
        CHECK(lines == same);
    }
    SECTION("errors")
    {
        const auto why = [&](InputArray p2, int which, const Vec2d& range)
        { return thrown([&] { refractiveEpipolarDistance(m.pixels1, p2, m.camera1, m.camera2, m.rvec, m.T, distances, status, which,
                                                         range); }); };
        CHECK_THAT(why(m.pixels2, 3, Vec2d(0, 1)), Catch::Contains("whichImage is 3"));
        CHECK_THAT(why(m.pixels2, 1, Vec2d(5, 5)), Catch::Contains("depthRange is (5, 5)"));
        CHECK_THAT(why(m.pixels2, 1, Vec2d(NaN, 5)), Catch::Contains("depthRange is (nan, 5)"));
        CHECK_THAT(why(std::vector<Point2d>(3), 1, Vec2d(0, 1)), Catch::Contains("points1 has 70 points, points2 3"));
    }
}
