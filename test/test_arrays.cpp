// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Types and shapes of arrays: what calib3d takes, this module takes; what it cannot take it refuses by name.
#include "arrays/arrays.hpp"
#include "arrays/extrinsics.hpp"
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

const int N = 300;      // more than two blocks

Ptr<RefractiveCamera> camera()
{
    return RefractiveCamera::create(Matx33d(1000, 0, 640, 0, 1010, 480, 0, 0, 1),
                                    std::vector<double>{ -0.28, 0.09, 7e-4, -4e-4 },
                                    GlassWindow(Vec3d(-0.25, 0.1, 1), 20, 1.54, 50));
}

//! Points that float32 holds exactly, so that both depths must give the same.
std::vector<Point3f> someObjects()
{
    Random random;
    std::vector<Point3f> points;
    for (int i = 0; i < N; i++)
        points.push_back(Point3f((float)random.uniform(-99, 99), (float)random.uniform(-99, 99), (float)random.uniform(400, 900)));
    points[7].y = (float)NaN;
    points[250].z = -5;
    return points;
}

std::vector<Point2f> somePixels()
{
    Random random;
    std::vector<Point2f> pixels;
    for (int i = 0; i < N; i++)
        pixels.push_back(Point2f((float)random.uniform(0, 1280), (float)random.uniform(0, 960)));
    pixels[9].x = (float)NaN;
    return pixels;
}

//! Every form in which the same points can come, beside vector<Point_<float>>.
struct Forms
{
    template<typename P> explicit Forms(const std::vector<P>& points)
    {
        const int channels = (int)(sizeof(P)/sizeof(float));
        const Mat column32 = Mat(points).reshape(channels);
        for (int depth : { CV_32F, CV_64F })
        {
            Mat column;
            column32.convertTo(column, depth);
            add("Nx1", column);
            add("1xN", column.reshape(channels, 1));
            const Mat rows = column.reshape(1);
            add(channels == 2 ? "Nx2" : "Nx3", rows);
            add(channels == 2 ? "2xN" : "3xN", rows.t());
            Mat wide(N, channels + 3, depth, Scalar(1e9));
            rows.copyTo(wide.colRange(2, 2 + channels));
            add("columns of a wider matrix", wide.colRange(2, 2 + channels));
            Mat strided(2*N, 1, CV_MAKETYPE(depth, channels), Scalar::all(1e9));
            const Mat every(N, 1, strided.type(), strided.data, 2*strided.step[0]);
            column.copyTo(every);
            add("every second point", every);
            owners_.push_back(strided);
            Mat two(N, 2, CV_MAKETYPE(depth, channels), Scalar::all(1e9));
            column.copyTo(two.col(1));
            add("a column of points", two.col(1));
        }
    }

    void add(const char* name, const Mat& m) { all.push_back({ name, m }); }

    struct Form { const char* name; Mat points; };
    std::vector<Form> all;

private:
    std::vector<Mat> owners_;
};

} // namespace

TEST_CASE("Object points in every type and shape", "[arrays]")
{
    const std::vector<Point3f> points = someObjects();
    Mat expected;
    std::vector<uchar> expectedStatus, status;
    std::vector<Point3d> exact(points.begin(), points.end());
    refractiveProjectPoints(exact, Vec3d(0.1, 0, 0), Vec3d(1, 2, 3), camera(), expected, expectedStatus);
    REQUIRE(expected.type() == CV_64FC2);
    REQUIRE(expected.size() == Size(1, N));
    CHECK(expectedStatus[7] == REFRACT_NOT_FINITE);
    CHECK(expectedStatus[250] != REFRACT_OK);
    CHECK(std::count(expectedStatus.begin(), expectedStatus.end(), REFRACT_OK) == N - 2);
    Mat expected32;
    expected.convertTo(expected32, CV_32F);
    for (const auto& form : Forms(points).all)
    {
        CAPTURE(form.name, typeToString(form.points.type()));
        Mat out;
        refractiveProjectPoints(form.points, Vec3d(0.1, 0, 0), Vec3d(1, 2, 3), camera(), out, status);
        CHECK(out.type() == CV_MAKETYPE(form.points.depth(), 2));
        CHECK(out.size() == Size(1, N));
        CHECK(largestDifference(out, form.points.depth() == CV_32F ? expected32 : expected) == 0);
        CHECK(status == expectedStatus);
    }
}

TEST_CASE("Pixels in every type and shape, in every function", "[arrays]")
{
    const std::vector<Point2f> pixels = somePixels();
    const std::vector<Point2d> exact(pixels.begin(), pixels.end());
    const Ptr<RefractiveCamera> c = camera();
    const auto run = [&](InputArray in)
    {
        std::vector<Mat> out(6);
        std::vector<Mat> lines;
        refractiveUnprojectPoints(in, out[0], out[1], c);
        refractiveUndistortPoints(in, out[2], c, std::vector<double>{ 700 });
        refractivePointsOnPlane(in, out[3], c, Vec4d(0, 0, 1, 700));
        triangulateRefractive(c, c, Matx33d::eye(), Vec3d(-100, 0, 0), in, in, out[4]);
        computeRefractiveEpilines(in, 1, c, c, Matx33d::eye(), Vec3d(-100, 0, 0), Vec2d(300, 900), lines);
        CHECK(lines.size() == (size_t)N);
        CHECK(lines[9].empty());
        out[5] = lines[0];
        return out;
    };
    const std::vector<Mat> expected = run(exact);
    for (const auto& form : Forms(pixels).all)
    {
        CAPTURE(form.name, typeToString(form.points.type()));
        const std::vector<Mat> out = run(form.points);
        for (size_t k = 0; k < out.size(); k++)
        {
            CAPTURE(k);
            CHECK(out[k].depth() == form.points.depth());
            CHECK(out[k].channels() == expected[k].channels());
            Mat rounded;
            expected[k].convertTo(rounded, form.points.depth());
            CHECK(largestDifference(out[k], rounded) == 0);
        }
    }
}

TEST_CASE("Outputs of a fixed type keep it", "[arrays]")
{
    const std::vector<Point2f> pixels32 = somePixels();
    const std::vector<Point2d> pixels64(pixels32.begin(), pixels32.end());
    const Ptr<RefractiveCamera> c = camera();
    std::vector<Point3f> points32;
    std::vector<Point3d> points64;
    refractivePointsOnPlane(pixels64, points32, c, Vec4d(0, 0, 1, 700));
    refractivePointsOnPlane(pixels32, points64, c, Vec4d(0, 0, 1, 700));
    REQUIRE(points32.size() == (size_t)N);
    REQUIRE(points64.size() == (size_t)N);
    CHECK(points32[3] == Point3f(points64[3]));
    CHECK(std::isnan(points32[9].x));

    std::vector<Vec2f> undistorted;
    refractiveUndistortPoints(pixels64, undistorted, c, 700.);
    CHECK(undistorted.size() == (size_t)N);
    std::vector<std::vector<Point2f>> lines;
    computeRefractiveEpilines(pixels64, 1, c, c, Matx33d::eye(), Vec3d(-100, 0, 0), Vec2d(300, 900), lines);
    REQUIRE(lines.size() == (size_t)N);
    CHECK(lines[0].size() >= 2);
    CHECK(lines[9].empty());

    Mat row(1, N, CV_64FC2);       // of the right size, lying down
    const uchar* data = row.data;
    refractiveUndistortPoints(pixels64, row, c, 700.);
    CHECK(row.data == data);
    CHECK((float)row.at<Vec2d>(3)[0] == undistorted[3][0]);
    Mat inPlace = Mat(pixels64, true);
    refractiveUndistortPoints(inPlace, inPlace, c, 700.);
    CHECK(largestDifference(inPlace, row) == 0);

    // Integers cannot hold NaN.
    std::vector<Point> integers;
    CHECK(thrown([&] { refractiveUndistortPoints(pixels64, integers, c, 700.); }) != "");
    Mat_<uchar> bytes;
    CHECK(thrown([&] { refractiveUndistortPoints(pixels64, bytes, c, 700.); }) != "");
    std::vector<Point3f> three;
    CHECK(thrown([&] { refractiveUndistortPoints(pixels64, three, c, 700.); }) != "");
}

TEST_CASE("Outputs into a column of a larger matrix", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    const std::vector<Point2d> pixels = { { 100, 200 }, { 300, 400 } };
    std::vector<Point2d> expected;
    refractiveUndistortPoints(pixels, expected, c, 700.);
    Mat big(2, 3, CV_64FC2, Scalar::all(-1)), column = big.col(1);
    refractiveUndistortPoints(pixels, column, c, 700.);
    CHECK(largestDifference(big.col(1), expected) == 0);
    CHECK(big.at<Vec2d>(0, 0) == Vec2d(-1, -1));
    CHECK(big.at<Vec2d>(1, 2) == Vec2d(-1, -1));
}

TEST_CASE("Outputs into columns of larger matrices, of many points, hold what vectors do", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    const std::vector<Point2f> pixels = somePixels();
    const std::vector<Point3f> objects = someObjects();
    for (int depth : { CV_32F, CV_64F })
    {
        Mat whole, wholeStatus, points, J, pixelsOf;
        Mat in;
        Mat(pixels).convertTo(in, depth);
        refractivePointsOnPlane(in, whole, c, Vec4d(0, 0, 1, 600), wholeStatus);
        Mat wide(N, 3, CV_MAKETYPE(depth, 3), Scalar::all(-1)), wideStatus(N, 2, CV_8U, Scalar(99));
        Mat column = wide.col(1), status = wideStatus.col(1);
        refractivePointsOnPlane(in, column, c, Vec4d(0, 0, 1, 600), status);
        CAPTURE(depth);
        CHECK(largestDifference(wide.col(1), whole) == 0);
        CHECK(norm(wideStatus.col(1), wholeStatus, NORM_INF) == 0);
        CHECK(countNonZero(wideStatus.col(0) != 99) == 0);
        CHECK(countNonZero(wide.col(0).clone().reshape(1) != -1) == 0);
        CHECK(countNonZero(wide.col(2).clone().reshape(1) != -1) == 0);
    }
    Mat image, status, J;
    refractiveProjectPoints(objects, Vec3d(), Vec3d(), c, image, status, J);
    Mat wideJ(2*N, J.cols + 2, CV_64F, Scalar(-1)), view = wideJ.colRange(1, 1 + J.cols);
    refractiveProjectPoints(objects, Vec3d(), Vec3d(), c, image, status, view);
    CHECK(largestDifference(wideJ.colRange(1, 1 + J.cols).clone(), J) == 0);
    CHECK(countNonZero(wideJ.col(0) != -1) + countNonZero(wideJ.col(J.cols + 1) != -1) == 0);
}

TEST_CASE("Depths of any type of numbers", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    const std::vector<Point2d> pixels = { { 100, 200 }, { 300, 400 }, { 500, 100 } };
    const Mat_<double> depth = (Mat_<double>(3, 1) << 600, 0, 800);
    Mat expected, status;
    refractiveUndistortPoints(pixels, expected, c, depth, noArray(), noArray(), status);
    for (int type : { CV_16U, CV_16S, CV_32S, CV_32F })
    {
        Mat whole, found, foundStatus;
        depth.convertTo(whole, type);
        refractiveUndistortPoints(pixels, found, c, whole, noArray(), noArray(), foundStatus);
        CAPTURE(type);
        CHECK(largestDifference(found, expected) == 0);
        CHECK(norm(status, foundStatus, NORM_INF) == 0);
        CHECK(foundStatus.at<uchar>(1) != REFRACT_OK);
    }
}

TEST_CASE("Rotations of a rig: matrices of either kind, or vectors", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    const std::vector<Ptr<RefractiveCamera> > cameras(2, c);
    const Vec3d turn(0, 0.1, 0), move(-50, 0, 0);
    const std::vector<Vec3d> rvecs = { Vec3d(), turn }, Ts = { Vec3d(), move };
    const Matx33d R = readRotation(turn, "R");
    const std::vector<Matx33d> fixed = { Matx33d::eye(), R };
    const std::vector<Mat> mats = { Mat::eye(3, 3, CV_64F), Mat(R) };
    std::vector<std::vector<Point2d> > pixels(2);
    const std::vector<Point3d> points = { { 10, 20, 600 }, { -30, 5, 700 } };
    refractiveProjectPoints(points, Vec3d(), Vec3d(), c, pixels[0]);
    refractiveProjectPoints(points, turn, move, c, pixels[1]);
    for (const _InputArray& Rs : { _InputArray(rvecs), _InputArray(fixed), _InputArray(mats) })
    {
        std::vector<Point3d> found;
        triangulateRefractive(cameras, Rs, Ts, pixels, found);
        for (size_t i = 0; i < points.size(); i++)
            CHECK(norm(found[i] - points[i]) < 1e-6);
    }
    // As results, too.
    std::vector<RigidTransform> extrinsics = readExtrinsics(fixed, Ts, 2);
    std::vector<Matx33d> written(2);
    std::vector<Mat> asMat;
    writeExtrinsics(extrinsics, written, noArray());
    writeExtrinsics(extrinsics, asMat, noArray());
    for (int i = 0; i < 2; i++)
        CHECK(norm(written[i] - Matx33d(asMat[i])) == 0);
    written.resize(1);
    CHECK_THAT(thrown([&] { writeExtrinsics(extrinsics, written, noArray()); }), Contains("std::vector<Matx33d> of 2"));
}

TEST_CASE("Empty in, empty out", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    for (const Mat& none : { Mat(), Mat(0, 1, CV_32FC2), Mat(std::vector<Point2d>()) })
    {
        Mat a(5, 5, CV_8U), b(5, 5, CV_8U), status(5, 5, CV_8U), jacobian(5, 5, CV_64F);
        std::vector<Mat> lines(3);
        refractiveUnprojectPoints(none, a, b, c, status);
        CHECK((a.empty() && b.empty() && status.empty()));
        a.create(5, 5, CV_8U);
        refractiveUndistortPoints(none, a, c, noArray(), noArray(), noArray(), status);
        CHECK((a.empty() && status.empty()));
        a.create(5, 5, CV_8U);
        refractivePointsOnPlane(none, a, c, Vec4d(0, 0, 1, 5), status);
        CHECK((a.empty() && status.empty()));
        a.create(5, 5, CV_8U);
        triangulateRefractive(c, c, Matx33d::eye(), Vec3d(1, 0, 0), none, none, a, status);
        CHECK((a.empty() && status.empty()));
        computeRefractiveEpilines(none, 1, c, c, Matx33d::eye(), Vec3d(1, 0, 0), Vec2d(1, 2), lines, 0.01, status);
        CHECK((lines.empty() && status.empty()));
        a.create(5, 5, CV_8U);
        refractiveProjectPoints(none, Vec3d(), Vec3d(), c, a, status, jacobian);
        CHECK((a.empty() && status.empty() && jacobian.empty()));
    }
    std::vector<Point2f> out(3);
    refractiveProjectPoints(std::vector<Point3f>(), Vec3d(), Vec3d(), c, out);
    CHECK(out.empty());
    Mat a(5, 5, CV_8U), b(5, 5, CV_8U), status(5, 5, CV_8U), e(5, 5, CV_8U);
    refractiveUndistortPoints(Mat(), a, c, 700., noArray(), noArray(), status);
    CHECK((a.empty() && status.empty()));
    a.create(5, 5, CV_8U);
    refractiveDistortPoints(Mat(), a, c, 700., noArray(), noArray(), status);
    CHECK((a.empty() && status.empty()));
    a.create(5, 5, CV_8U);
    refractiveUndistortImage(Mat(), a, c, 700.);
    CHECK(a.empty());
    a.create(5, 5, CV_8U);
    initRefractiveUndistortRectifyMap(c, 700., noArray(), noArray(), Size(), CV_16SC2, a, b);
    CHECK((a.empty() && b.empty()));
    a.create(5, 5, CV_8U);
    refractiveEpipolarDistance(Mat(), Mat(), c, c, Matx33d::eye(), Vec3d(1, 0, 0), a, status, 1, Vec2d(0, INF), b, e);
    CHECK((a.empty() && status.empty() && b.empty() && e.empty()));
    a.create(5, 5, CV_8U);
    triangulateRefractive(c, c, Matx33d::eye(), Vec3d(1, 0, 0), Mat(), Mat(), a, status, 0, 1., noArray(), b, e);
    CHECK((a.empty() && status.empty() && b.empty() && e.empty()));
    a.create(5, 5, CV_8U);
    b.create(5, 5, CV_8U);
    const Matx34d P1(500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0), P2(500, 0, 320, -50000, 0, 500, 240, 0, 0, 0, 1, 0);
    refractiveRectifiedDepth(Mat(), P1, P2, Size(640, 480), a, b);
    CHECK((a.empty() && b.empty()));
    // Bad arguments are bad with no points, too.
    CHECK_THAT(thrown([&] { refractivePointsOnPlane(Mat(), out, c, Vec4d(0, 0, 0, 5)); }), Contains("plane"));
}

TEST_CASE("Wrong types and shapes are refused by name and value", "[arrays]")
{
    const Ptr<RefractiveCamera> c = camera();
    struct Wrong { Mat pixels; const char* value; };
    const Wrong wrongs[] = { { Mat(5, 1, CV_32SC2), "32SC2" }, { Mat(5, 1, CV_8UC2), "8UC2" }, { Mat(5, 1, CV_64FC3), "64FC3" },
                             { Mat(5, 3, CV_64F), "5x3" }, { Mat(4, 5, CV_64FC2), "4x5" }, { Mat(3, 7, CV_32F), "3x7" },
                             { Mat(5, 1, CV_32F), "5x1" } };
    for (const Wrong& wrong : wrongs)
    {
        CAPTURE(wrong.value);
        Mat a, b;
        std::vector<Mat> lines;
        const Mat good(5, 1, CV_64FC2, Scalar::all(100));
        const Matx33d R = Matx33d::eye();
        const Vec3d T(1, 0, 0);
        const auto check = [&](const char* argument, const std::string& text)
        {
            CHECK_THAT(text, Contains(argument) && Contains(wrong.value));
        };
        check("imagePoints", thrown([&] { refractiveUnprojectPoints(wrong.pixels, a, b, c); }));
        check("src", thrown([&] { refractiveUndistortPoints(wrong.pixels, a, c, 700.); }));
        check("imagePoints", thrown([&] { refractivePointsOnPlane(wrong.pixels, a, c, Vec4d(0, 0, 1, 5)); }));
        check("points1", thrown([&] { triangulateRefractive(c, c, R, T, wrong.pixels, good, a); }));
        check("points2", thrown([&] { triangulateRefractive(c, c, R, T, good, wrong.pixels, a); }));
        check("points is", thrown([&] { computeRefractiveEpilines(wrong.pixels, 1, c, c, R, T, Vec2d(1, 2), lines); }));
    }
    Mat out;
    for (const Wrong& wrong : { Wrong{ Mat(5, 1, CV_64FC2), "64FC2" }, Wrong{ Mat(5, 2, CV_64F), "5x2" },
                                Wrong{ Mat(5, 1, CV_32SC3), "32SC3" } })
        CHECK_THAT(thrown([&] { refractiveProjectPoints(wrong.pixels, Vec3d(), Vec3d(), c, out); }),
                   Contains("objectPoints") && Contains(wrong.value));
}

TEST_CASE("Outputs nobody asks for are not made", "[arrays]")
{
    const std::vector<Point2f> pixels = somePixels();
    Mat directions;
    refractiveUnprojectPoints(pixels, noArray(), directions, camera());
    CHECK(directions.total() == (size_t)N);
    std::vector<uchar> status;
    refractiveUnprojectPoints(pixels, noArray(), noArray(), camera(), status);
    CHECK(status.size() == (size_t)N);
}

TEST_CASE("Blocks cover every point once", "[arrays]")
{
    for (int size : { 0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 1000*BLOCK + 17 })
    {
        std::vector<uchar> visits(size);
        forEachBlock(size, [&](int begin, int n)
        {
            for (int i = begin; i < begin + n; i++)
                visits[i]++;
        });
        CAPTURE(size);
        CHECK(std::count(visits.begin(), visits.end(), 1) == size);
    }
}

TEST_CASE("Rotations: matrix, vector, nothing; printed digits are made orthogonal", "[arrays]")
{
    CHECK(norm(readRotationOrNone(noArray(), "R") - Matx33d::eye()) == 0);
    CHECK(norm(readRotationOrNone(Mat(), "R") - Matx33d::eye()) == 0);
    CHECK_THAT(thrown([&] { readRotation(Mat(), "R"); }), Contains("R is empty"));
    const Matx33d quarter(0, -1, 0, 1, 0, 0, 0, 0, 1);
    CHECK(norm(readRotation(Vec3d(0, 0, CV_PI/2), "R") - quarter) < 1e-15);
    CHECK(norm(readRotation(Vec3f(0, 0, (float)CV_PI/2), "R") - quarter) < 1e-7);
    CHECK(norm(readRotation(quarter, "R") - quarter) < 1e-15);
    const Matx33d printed(0.9572, 0.0008, -0.2893, -0.0087, 0.9996, -0.0262, 0.2892, 0.0275, 0.9569);
    const Matx33d R = readRotation(printed, "R");
    CHECK(norm(R*R.t() - Matx33d::eye()) < 1e-14);
    CHECK(norm(R - printed) < 1e-3);
    CHECK_THAT(thrown([&] { readRotation(printed*1.1, "R"); }), Contains("R is not a rotation"));
    CHECK_THAT(thrown([&] { readRotation(Mat::eye(3, 4, CV_64F), "R"); }), Contains("R is 3x4"));
}
