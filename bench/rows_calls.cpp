// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "rows.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <functional>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const Size SIZE((int)WIDTH, (int)HEIGHT);

//! Of some pixels of a map, whose points `pointOf` tells.
double mapError(const Scene& scene, const Mat& map, const std::function<Vec3d(int, int)>& pointOf)
{
    const auto camera = scene.parts<long double>();
    long double worst = 0;
    for (int i : sample(SIZE.area()))
    {
        const int x = i % SIZE.width, y = i/SIZE.width;
        const Vec3d X = pointOf(x, y);
        const Pixel p = camera.project({ X[0], X[1], X[2] });
        const Point2f found = map.at<Point2f>(y, x);
        worst = std::max(worst, std::hypot(found.x - p[0], found.y - p[1]));
    }
    return (double)worst;
}

Row mapRow()
{
    struct Data { Scene scene = Scene(FIVE, 1); Mat map1, map2, peer1, peer2; };
    const auto d = std::make_shared<Data>();
    Row r = { "map", "map of 1280x1024, on a plane", "cv::initUndistortRectifyMap", { 1.2, 1.2 }, SIZE.area(), {}, {}, {}, {}, 8,
              "px", 1e-4, {}, {}, {} };
    const std::vector<double> depth(1, 600.);
    r.ours = [=] { initRefractiveUndistortRectifyMap(d->scene.camera, depth, noArray(), d->scene.K, SIZE, CV_32FC2, d->map1,
                                                     d->map2); };
    r.peer = [=] { initUndistortRectifyMap(d->scene.K, d->scene.D, noArray(), d->scene.K, SIZE, CV_32FC2, d->peer1, d->peer2); };
    r.error = [=] { return mapError(d->scene, d->map1, [&](int x, int y) { return depth[0]*(d->scene.K.inv()*Vec3d(x, y, 1)); }); };
    return r;
}

//! The map of a surface that waves between 500 and 700, seen from beside the centre of projection, as a rectified pair's are.
Row surfaceMapRow()
{
    struct Data { Scene scene = Scene(FIVE, 1); Mat depth = Mat(SIZE, CV_32F), P, map1, map2, peer1, peer2; };
    const auto d = std::make_shared<Data>();
    const Vec3d centre = 7*d->scene.window.normal;
    for (int y = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x++)
            d->depth.at<float>(y, x) = (float)(600 + 100*std::sin(x/150.)*std::cos(y/120.));
    hconcat(Mat(d->scene.K), Mat(-(d->scene.K*centre)), d->P);
    Row r = { "surface_map", "map of 1280x1024, a depth per pixel", "cv::initUndistortRectifyMap", { 2, 2 }, SIZE.area(), {}, {}, {},
              {}, 8, "px", 1e-4, {}, {}, {} };
    r.ours = [=] { initRefractiveStereoRectifyMap(d->scene.camera, d->depth, Matx33d::eye(), d->P, noArray(), SIZE, CV_32FC2, d->map1,
                                                  d->map2); };
    r.peer = [=] { initUndistortRectifyMap(d->scene.K, d->scene.D, noArray(), d->scene.K, SIZE, CV_32FC2, d->peer1, d->peer2); };
    r.error = [=]
    {
        return mapError(d->scene, d->map1, [&](int x, int y)
                        { return centre + (d->depth.at<float>(y, x) - centre[2])*(d->scene.K.inv()*Vec3d(x, y, 1)); });
    };
    return r;
}

struct Calls
{
    explicit Calls(int count) : scene(FIVE, 1), points(scene, count) {}
    Scene scene;
    Points points;
    std::vector<Point2d> pixels, pixels2;
    std::vector<uchar> status;
};

//! One point a call, `count` calls; unit: heap allocations in all of them after the first.
Row oneRow(const std::string& key, const std::string& work, const std::string& peer, const Work& ours, const Work& theirs)
{
    const int CALLS = 100;
    Row r = { key, work, peer, { 2, 2 }, CALLS, {}, {}, {}, {}, 0, "allocations", 0, {}, {}, {} };
    r.ours = [=] { for (int i = 0; i < CALLS; i++) ours(); };
    r.peer = [=] { for (int i = 0; i < CALLS; i++) theirs(); };
    const auto count = [](const Work& calls) { const long before = allocations(); calls(); return (double)(allocations() - before); };
    r.error = [=] { return count(r.ours); };
    r.peerError = [=] { return count(r.peer); };
    return r;
}

void addOnePointRows(std::vector<Row>& rows)
{
    const auto d = std::make_shared<Calls>(1);
    const Vec3d zero(0, 0, 0);
    const Work undistort = [=] { undistortPoints(d->points.pixels, d->pixels2, d->scene.K, d->scene.D, noArray(), d->scene.K); };
    const Work project = [=] { projectPoints(d->points.points, zero, zero, d->scene.K, d->scene.D, d->pixels2); };
    rows.push_back(oneRow("one_undistort", "undistort one point a call", "cv::undistortPoints", [=]
        { refractiveUndistortPoints(d->points.pixels, d->pixels, d->scene.camera, d->points.depths, noArray(), d->scene.K,
                                    d->status); }, undistort));
    rows.push_back(oneRow("one_project", "project one point a call", "cv::projectPoints", [=]
        { refractiveProjectPoints(d->points.points, zero, zero, d->scene.camera, d->pixels, d->status); }, project));
    Row plain = oneRow("one_plain", "the same from K, D and window", "cv::projectPoints", [=]
        { refractiveProjectPoints(d->points.points, zero, zero, d->scene.K, d->scene.D, d->scene.window, d->pixels, d->status); },
        project);
    plain.tolerance = DBL_MAX;      // it makes a camera each time
    rows.push_back(plain);
    Row fitted = oneRow("one_plain_undistort", "undistort one point from K, D and window", "cv::undistortPoints", [=]
        { refractiveUndistortPoints(d->points.pixels, d->pixels, d->scene.K, d->scene.D, d->scene.window, d->points.depths, noArray(),
                                    d->scene.K, d->status); }, undistort);
    fitted.tolerance = DBL_MAX;     // and fits the inverse of its lens
    rows.push_back(fitted);
}

//! The same work in float32 against float64, and by two threads against one.
void addOwnRatios(std::vector<Row>& rows, int count)
{
    struct Floats { std::vector<Point3f> points; std::vector<Point2f> pixels, pixelsOut; };
    const auto d = std::make_shared<Calls>(count);
    const auto f = std::make_shared<Floats>();
    f->points.assign(d->points.points.begin(), d->points.points.end());
    f->pixels.assign(d->points.pixels.begin(), d->points.pixels.end());
    const Vec3d zero(0, 0, 0);
    const Work project = [=] { refractiveProjectPoints(d->points.points, zero, zero, d->scene.camera, d->pixels, d->status); };
    const Work undistort = [=] { refractiveUndistortPoints(d->points.pixels, d->pixels, d->scene.camera, d->points.depths,
                                                           noArray(), d->scene.K, d->status); };
    Row r = { "float_project", "project, float32", "float64", { 1, 1 }, count, {}, project, {}, {}, 0, "", 0, {}, {}, {} };
    r.successes = [=] { return countOk(d->status); };
    r.ours = [=] { refractiveProjectPoints(f->points, zero, zero, d->scene.camera, f->pixelsOut, d->status); };
    rows.push_back(r);
    r.key = "float_undistort";
    r.work = "undistort, float32";
    r.ours = [=] { refractiveUndistortPoints(f->pixels, f->pixelsOut, d->scene.camera, d->points.depths, noArray(), d->scene.K,
                                             d->status); };
    r.peer = undistort;
    rows.push_back(r);
    const auto threads = [](int n, const Work& work)
    {
        return [=]
        {
            if (getNumThreads() != n)       // the pool is made anew: once in a series of runs
                setNumThreads(n);
            pin(n);
            work();
            pin(1);
        };
    };
    r.key = "threads";
    r.work = "undistort by two threads";
    r.peerName = "one thread";
    r.target[0] = r.target[1] = 1/1.8;
    r.threads = true;
    r.ours = threads(2, undistort);
    r.peer = threads(1, undistort);
    rows.push_back(r);
}

} // namespace

void addCallRows(std::vector<Row>& rows, int count)
{
    rows.push_back(mapRow());
    rows.push_back(surfaceMapRow());
    addOwnRatios(rows, count);
    addOnePointRows(rows);
}

} // namespace bench
