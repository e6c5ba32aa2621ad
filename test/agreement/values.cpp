// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A hundred values from the module's calls, one "name value" a line; values.py prints the same. All input is made by
// exact arithmetic or decimal literals, so that both programs start from the same bits.
#include <opencv2/refract.hpp>
#include <cstdio>

using namespace cv;
using namespace cv::refract;

static const Matx33d K(2438.5, 0, 644.25, 0, 2440.125, 500.5, 0, 0, 1);
static const Vec<double, 5> D(-0.408, 0.436, 0.001, -0.0005, 0.03);
static const Vec3d ZERO(0, 0, 0), R(0.01, 0.3, 0.02), T(-180, 2, 25);

static void print(const char* name, const double* values, int count)
{
    for (int i = 0; i < count; i++)
        std::printf("%s[%d] %.17g\n", name, i, values[i]);
}

//! The first `count` numbers of an array, in memory order.
static void print(const char* name, const Mat& values, int count)
{
    const Mat doubles = values.clone();
    CV_Assert(doubles.depth() == CV_64F && (int)(doubles.total()*doubles.channels()) >= count);
    print(name, doubles.ptr<double>(), count);
}

static GlassWindow pane(double x)
{
    return GlassWindow(Vec3d(x, 0.1, 1), 20, 1.5437, 50);
}

//! Two layers into water.
static GlassWindow port()
{
    GlassWindow window(Vec3d(0.18, -0.05, 1), 12, 1.49, 30, 1.333);
    window.thickness.push_back(8);
    window.index.push_back(1.52);
    return window;
}

static Mat scene()
{
    Mat points(8, 1, CV_64FC3);
    for (int i = 0; i < 8; i++)
        points.at<Vec3d>(i) = Vec3d(20.*i - 70, 13.*((3*i) % 8) - 45, 560 + 9.*i);
    return points;
}

static void printGeometry(const Mat& points)
{
    const Ptr<RefractiveCamera> camera1 = RefractiveCamera::create(K, D, pane(-0.25));
    const Ptr<RefractiveCamera> camera2 = RefractiveCamera::create(K, D, pane(0.18));
    const Ptr<RefractiveCamera> inWater = RefractiveCamera::create(K, D, port());
    Mat pixels1, pixels2, wet, origins, directions, ideal, onPlane, points3D, shifted;
    refractiveProjectPoints(points, ZERO, ZERO, camera1, pixels1);
    refractiveProjectPoints(points, R, T, camera2, pixels2);
    refractiveProjectPoints(points, ZERO, ZERO, inWater, wet);
    print("project.air", pixels1, 10);
    print("project.water", wet, 10);

    refractiveUnprojectPoints(wet, origins, directions, inWater);
    print("unproject.origin", origins, 9);
    print("unproject.direction", directions, 9);

    refractiveUndistortPoints(pixels1, ideal, camera1, 600., noArray(), K);
    print("undistort", ideal, 10);
    refractivePointsOnPlane(pixels1, onPlane, camera1, Vec4d(0.1, -0.05, 1, 600));
    print("plane", onPlane, 9);

    std::vector<Mat> lines;
    computeRefractiveEpilines(pixels1, 1, camera1, camera2, R, T, Vec2d(300, 1500), lines);
    for (int i = 0; i < 2; i++)
    {
        print(i == 0 ? "epiline.near" : "epiline2.near", lines[i].rowRange(0, 1), 2);
        print(i == 0 ? "epiline.far" : "epiline2.far", lines[i].rowRange(lines[i].rows - 1, lines[i].rows), 2);
    }

    add(pixels2, Scalar(0.25, -0.5), shifted);      // the rays miss each other
    triangulateRefractive(camera1, camera2, R, T, pixels1, shifted, points3D);
    print("triangulate.optimal", points3D, 9);
    triangulateRefractive(camera1, camera2, R, T, pixels1, shifted, points3D, noArray(), TRIANGULATE_MIDPOINT);
    print("triangulate.midpoint", points3D, 9);
}

//! Pixels that are off by up to 0.1 px, in a pattern.
static Mat observed(const Mat& board, const Vec3d& rvec, const Vec3d& tvec, const GlassWindow& window, int pattern)
{
    Mat pixels;
    refractiveProjectPoints(board, rvec, tvec, K, D, window, pixels);
    for (int i = 0; i < pixels.rows; i++)
        pixels.at<Vec2d>(i) += Vec2d(((37*i + 11*pattern) % 17 - 8)/80., ((23*i + 5*pattern) % 19 - 9)/90.);
    return pixels;
}

static void printCalibration()
{
    Mat board(30, 1, CV_64FC3);
    for (int i = 0; i < 30; i++)
        board.at<Vec3d>(i) = Vec3d(39.*(i % 6) - 97.5, 39.*(i/6) - 78, 0);
    std::vector<Mat> boards, direct, refracted;
    for (int view = 0; view < 4; view++)
    {
        const Vec3d rvec(0.3 - 0.15*view, 0.25*(view % 3) - 0.2, 0.1*view), tvec(10*(view % 2), 8*view - 15, 590 + 10*view);
        boards.push_back(board);
        direct.push_back(observed(board, rvec, tvec, GlassWindow(), 2*view));
        refracted.push_back(observed(board, rvec, tvec, pane(-0.25), 2*view + 1));
    }
    Mat normal, center;
    double rms = calibrateGlassNormal(direct, refracted, K, D, normal, center);
    print("calibrateGlassNormal.rms", &rms, 1);
    print("calibrateGlassNormal.normal", normal, 3);
    print("calibrateGlassNormal.center", center, 2);

    GlassWindow window = pane(0);
    std::vector<Mat> rvecs, tvecs;
    rms = calibrateGlass(boards, direct, refracted, K, D, window, rvecs, tvecs, GLASS_FREE_THICKNESS,
                         TermCriteria(TermCriteria::COUNT, 50, 0));
    print("calibrateGlass.rms", &rms, 1);
    print("calibrateGlass.normal", window.normal.val, 3);
    print("calibrateGlass.thickness", window.thickness.data(), 1);
    print("calibrateGlass.rvec", rvecs[3], 3);
    print("calibrateGlass.tvec", tvecs[3], 3);
}

int main()
{
    printGeometry(scene());
    printCalibration();
    return 0;
}
