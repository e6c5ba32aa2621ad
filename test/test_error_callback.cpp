// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Calls that succeed raise no OpenCV error inside, which a program with an error callback would be told of.
#include "calibration_scenes.hpp"
#include "temporary_file.hpp"

#include <opencv2/core/utility.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Counts errors, and says where, while it lives.
class Watch
{
public:
    Watch() { redirectError(&Watch::onError, this); }
    ~Watch() { redirectError(nullptr); }
    int count = 0;
    std::string last;
private:
    static int onError(int, const char* function, const char* text, const char*, int, void* self)
    {
        static_cast<Watch*>(self)->count++;
        static_cast<Watch*>(self)->last = std::string(function) + ": " + text;
        return 0;
    }
};

} // namespace

TEST_CASE("Successful calls raise no error inside", "[error_callback]")
{
    const std::vector<double> D = { -0.28, 0.09, 7e-4, -4e-4 };
    const Ptr<RefractiveCamera> one = RefractiveCamera::create(PLAIN_K, D, paper::pane());
    const Ptr<RefractiveCamera> two = RefractiveCamera::create(PLAIN_K, D, GlassWindow(Vec3d(0.1, 0, 1), 12, 1.5, 40, 1.333));
    const Vec3d R(0, 0.2, 0), T(-120, 0, 20);
    const Size size(1280, 960);
    std::vector<Point3d> points;
    for (int i = 0; i < 100; i++)
        points.push_back(Point3d(20*(i % 10) - 90, 20*(i/10) - 90, 600 + i % 7));
    points.push_back(Point3d(0, 0, 5));         // inside the window
    points.push_back(Point3d(NaN, 0, 5));
    Random random(40);
    const CalibrationScene boards = makeScene(paperCamera(paper::pane()), 5, random, 0.1);
    GlassWindow straight = paper::pane();
    straight.normal = Vec3d(0, 0, 1);
    const TemporaryFile file(".yml");
    Watch watch;
    std::vector<Point2d> pixels1, pixels2, out;
    std::vector<Point3d> found, directions;
    std::vector<uchar> status;
    std::vector<std::vector<Point2d> > lines;
    Mat a, b, c, d, map1, map2;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), one, pixels1, status);
    refractiveProjectPoints(points, R, T, two, pixels2, status, a);
    refractiveUnprojectPoints(pixels1, found, directions, one, status);
    refractiveUndistortPoints(pixels1, out, PLAIN_K, D, paper::pane(), 600., noArray(), noArray(), status);
    refractiveDistortPoints(out, pixels2, PLAIN_K, D, paper::pane(), 600., noArray(), noArray(), status);
    refractiveProjectPoints(points, R, T, two, pixels2, status);
    refractivePointsOnPlane(pixels1, found, one, Vec4d(0, 0, 1, 600), status);
    computeRefractiveEpilines(pixels1, 1, one, two, R, T, Vec2d(300, INF), lines, 0.01, status);
    refractiveEpipolarDistance(pixels1, pixels2, one, two, R, T, a, b, 1, Vec2d(0, INF), c, d);
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
        triangulateRefractive(one, two, R, T, pixels1, pixels2, a, status, flags, 0.1, noArray(), b, c);
    triangulateRefractive(one, two, R, Vec3d(), pixels1, pixels1, a, status);       // parallel rays and worse
    initRefractiveUndistortRectifyMap(one, 600., noArray(), noArray(), size, CV_16SC2, map1, map2);
    initRefractiveUndistortRectifyMap(one, 10., noArray(), noArray(), Size(64, 48), CV_16SC2, map1, map2);      // inside the window
    const Mat K = getOptimalNewRefractiveCameraMatrix(one, 600., size, 0.5);
    Mat image = Mat::zeros(size, CV_8UC3);
    refractiveUndistortImage(image, image, one, 600., K);
    drawRefractiveFrameAxes(image, one, Vec3d(), Vec3d(0, 0, 600), 100);
    Mat R1, R2, P1, P2, Q, depth1, depth2, cloud, covariance;
    refractiveStereoRectify(one, two, R, T, size, Vec2d(400, 2000), R1, R2, P1, P2, Q);
    initRefractiveStereoRectifyMap(one, 700., R1, P1, noArray(), size, CV_16SC2, map1, map2);
    initRefractiveStereoRectifyMap(two, 700., R2, P2, T, size, CV_16SC2, map1, map2);
    Mat disparity(size, CV_32F, Scalar(P2.at<double>(0, 3) < 0 ? 150 : -150));
    disparity.rowRange(0, 20) = NaN;
    refractiveRectifiedDepth(disparity, P1, P2, size, depth1, depth2);
    const Mat some = disparity.clone();
    refractiveReprojectImageTo3D(some, cloud, one, two, R, T, R1, R2, P1, P2, depth1, depth2, false, -1, noArray(), 0.1, noArray(),
                                 covariance);
    Vec3d rvec, tvec;
    CHECK(refractiveSolvePnP(std::vector<Point3d>(points.begin(), points.begin() + 100),
                             std::vector<Point2d>(pixels1.begin(), pixels1.begin() + 100), one, rvec, tvec));
#ifndef REFRACT_WITHOUT_CERES
    CHECK(calibrateGlass(boards.object, boards.direct, boards.refracted, paperCamera(straight), noArray(), noArray()) < 0.2);
#endif
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs, Ts;
    writeRig(file.path, { one, two }, std::vector<Vec3d>{ Vec3d(), R }, std::vector<Vec3d>{ Vec3d(), T });
    readRig(file.path, cameras, Rs, Ts);
    CHECK(cameras.size() == 2);
    CAPTURE(watch.last);
    CHECK(watch.count == 0);
    CHECK_THROWS_AS(refractiveUndistortPoints(pixels1, out, one, -1.), cv::Exception);      // the watch works
    CHECK(watch.count == 1);
}
