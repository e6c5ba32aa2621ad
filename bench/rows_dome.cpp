// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What a dome costs: beside OpenCV's calls without a window.
#include "rows.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

struct Dome
{
    Dome(double outerIndex, int count)
        : scene(FIVE, outerIndex), points(scene, count), exactly(scene.parts<long double>()),
          window(GlassWindow::dome(Vec3d(3, -2, -9), 60, 8, 1.5168, outerIndex)),
          camera(RefractiveCamera::create(scene.K, scene.D, window)) {}
    Scene scene;
    Points points;              //!< pixels, depths; the points are those of the scene's own window, and as good
    reference::Camera<long double> exactly;     //!< its lens
    GlassWindow window;
    Ptr<RefractiveCamera> camera;
    std::vector<Point2d> pixels, peerPixels;
    std::vector<Point3d> origins, directions;
    std::vector<uchar> status;
    Mat jacobian, peerJacobian;
    Vec3d rvec = Vec3d(0, 0, 0), tvec = Vec3d(0, 0, 0);
};

typedef std::shared_ptr<Dome> Data;

//! Vector Snell, sphere by sphere.
reference::Ray<long double> trace(const Dome& a, const Pixel& pixel)
{
    const GlassWindow& w = a.window;
    const Point center = { w.center[0], w.center[1], w.center[2] };
    Point d = a.exactly.lens.unproject(pixel), point = { 0, 0, 0 };
    long double radius = w.radius, medium = w.innerIndex;
    for (size_t k = 0; k <= w.index.size(); k++)
    {
        const long double next = k < w.index.size() ? w.index[k] : w.outerIndex, ratio = medium/next;
        const Point off = reference::add(point, -1.L, center);
        const long double ahead = reference::dot(off, d);
        point = reference::add(point, -ahead + std::sqrt(ahead*ahead - reference::dot(off, off) + radius*radius), d);
        const Point from = reference::add(point, -1.L, center), m = { from[0]/radius, from[1]/radius, from[2]/radius };
        d = reference::refracted(d, ratio, m);
        medium = next;
        radius += k < w.index.size() ? w.thickness[k] : 0;
    }
    return { point, d };
}

//! Pixels between where two rays meet the plane of a depth, as a pinhole sees it.
double apart(const Dome& a, const reference::Ray<long double>& one, const reference::Ray<long double>& other, double depth)
{
    return (double)(a.exactly.lens.fx*reference::apart(one, other, (long double)depth));
}

Row row(const Data& a, const std::string& key, const std::string& work, const std::string& peer, double target, double bytes)
{
    Row r = { key, work, peer, { target, target }, (int)a->points.pixels.size(), {}, {}, {}, {}, bytes, "px", 1e-9, {}, {}, {} };
    r.successes = [=] { return countOk(a->status); };
    return r;
}

Row unprojectRow(const Data& a)
{
    Row r = row(a, "dome_unproject", "unproject through a dome", "cv::undistortPoints", 0.35, 65);
    r.ours = [=] { refractiveUnprojectPoints(a->points.pixels, a->origins, a->directions, a->camera, a->status); };
    r.peer = [=] { undistortPoints(a->points.pixels, a->peerPixels, a->scene.K, a->scene.D); };
    r.error = [=]
    {
        return worst(a->status, [&](int i) { return apart(*a, { exact(a->origins[i]), exact(a->directions[i]) },
                                                  trace(*a, exact(a->points.pixels[i])), a->points.depths[i]); });
    };
    return r;
}

Row projectRow(const Data& a, const std::string& key, const std::string& work, bool jacobian)
{
    Row r = row(a, key, work, jacobian ? "cv::projectPoints with jacobian" : "cv::projectPoints", 1,
                jacobian ? 24 + 16 + 1 + 2*8*(6 + 9 + 8) : 41);
    r.ours = [=]
    {
        if (jacobian)
            refractiveProjectPoints(a->points.points, a->rvec, a->tvec, a->camera, a->pixels, a->status, a->jacobian);
        else
            refractiveProjectPoints(a->points.points, a->rvec, a->tvec, a->camera, a->pixels, a->status);
    };
    r.peer = [=]
    {
        if (jacobian)
            projectPoints(a->points.points, a->rvec, a->tvec, a->scene.K, a->scene.D, a->peerPixels, a->peerJacobian);
        else
            projectPoints(a->points.points, a->rvec, a->tvec, a->scene.K, a->scene.D, a->peerPixels);
    };
    r.error = [=]
    {
        return worst(a->status, [&](int i)
        {
            const Point3d& X = a->points.points[i];
            return apart(*a, { exact(X), { 0, 0, 1 } }, trace(*a, exact(a->pixels[i])), X.z);
        });
    };
    return r;
}

} // namespace

void addDomeRows(std::vector<Row>& rows, int count)
{
    const Data air = std::make_shared<Dome>(1, count), water = std::make_shared<Dome>(1.333, count);
    rows.push_back(unprojectRow(water));
    rows.push_back(projectRow(air, "dome_project", "project through a dome, air", false));
    rows.push_back(projectRow(water, "dome_project_water", "project through a dome, water", false));
    rows.push_back(projectRow(std::make_shared<Dome>(1.333, std::min(count, 10000)), "dome_jacobian",
                              "project through a dome with jacobian", true));
}

} // namespace bench
