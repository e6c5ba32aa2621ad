// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What domes, tubes and bent panes cost: beside OpenCV's calls without a window.
#include "rows.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

GlassWindow makeCurved(WindowShape shape, double outerIndex)
{
    if (shape == WINDOW_DOME)
        return GlassWindow::dome(Vec3d(3, -2, -9), 60, 8, 1.5168, outerIndex);
    if (shape == WINDOW_TUBE)
        return GlassWindow::tube(Vec3d(3, -2, -9), Vec3d(0.2, 1, -0.1), 60, 8, 1.5168, outerIndex);
    GlassWindow window(Vec3d(0.1, -0.05, 1), 20, 1.5168, 60, outerIndex);
    window.shape = shape;
    window.curvature = 1/50e3;
    return window;
}

struct Curved
{
    Curved(WindowShape shape, double outerIndex, int count)
        : scene(FIVE, outerIndex), points(scene, count), exactly(scene.parts<long double>()), window(makeCurved(shape, outerIndex)),
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

typedef std::shared_ptr<Curved> Data;

//! Vector Snell, sphere by sphere or cylinder by cylinder.
reference::Ray<long double> trace(const Curved& a, const Pixel& pixel)
{
    const GlassWindow& w = a.window;
    const bool isBent = w.shape == WINDOW_BENT;
    const Vec3d axis = w.axis, n = w.normal;
    long double radius = isBent ? 1.L/w.curvature : w.radius, medium = w.innerIndex;
    const long double behind = isBent ? w.distance - radius : 0;
    const Point center = isBent ? Point{ behind*n[0], behind*n[1], behind*n[2] } : Point{ w.center[0], w.center[1], w.center[2] };
    const Point along = { axis[0], axis[1], axis[2] };      // 0 but for a tube
    const auto across = [&](const Point& v) { return reference::add(v, -reference::dot(v, along), along); };
    Point d = a.exactly.lens.unproject(pixel), point = { 0, 0, 0 };
    for (size_t k = 0; k <= w.index.size(); k++)
    {
        const long double next = k < w.index.size() ? w.index[k] : w.outerIndex, ratio = medium/next;
        const Point off = across(reference::add(point, -1.L, center)), flat = across(d);
        const long double square = reference::dot(flat, flat), ahead = reference::dot(off, flat)/square;
        point = reference::add(point, -ahead + std::sqrt(ahead*ahead - (reference::dot(off, off) - radius*radius)/square), d);
        const Point from = across(reference::add(point, -1.L, center)), m = { from[0]/radius, from[1]/radius, from[2]/radius };
        d = reference::refracted(d, ratio, m);
        medium = next;
        radius += k < w.index.size() ? w.thickness[k] : 0;
    }
    return { point, d };
}

//! Pixels between where two rays meet the plane of a depth, as a pinhole sees it.
double apart(const Curved& a, const reference::Ray<long double>& one, const reference::Ray<long double>& other, double depth)
{
    return (double)(a.exactly.lens.fx*reference::apart(one, other, (long double)depth));
}

Row row(const Data& a, const std::string& key, const std::string& work, const std::string& peer, double target, double bytes)
{
    Row r = { key, work, peer, { target, target }, (int)a->points.pixels.size(), {}, {}, {}, {}, bytes, "px", 1e-9, {}, {}, {} };
    r.successes = [=] { return countOk(a->status); };
    return r;
}

//! Two unknowns at faces of any kind, where a dome has one: five times what a pinhole takes is what is asked for.
bool isDome(const Data& a) { return a->window.shape == WINDOW_DOME; }

Row unprojectRow(const Data& a, const std::string& key, const std::string& work)
{
    Row r = row(a, key, work, "cv::undistortPoints", isDome(a) ? 0.35 : 0.5, 65);
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
    Row r = row(a, key, work, jacobian ? "cv::projectPoints with jacobian" : "cv::projectPoints",
                isDome(a) ? 1 : jacobian ? 2 : 5,
                jacobian ? 24 + 16 + 1 + 2*8*(6 + (int)a->camera->parameterNames().size()) : 41);
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

void addCurvedRows(std::vector<Row>& rows, int count)
{
    struct Kind { WindowShape shape; std::string key, name; };
    for (const Kind& kind : { Kind{ WINDOW_DOME, "dome", "a dome" }, Kind{ WINDOW_TUBE, "tube", "a tube" },
                              Kind{ WINDOW_BENT, "bent", "a bent pane" } })
    {
        const Data air = std::make_shared<Curved>(kind.shape, 1, count), water = std::make_shared<Curved>(kind.shape, 1.333, count);
        rows.push_back(unprojectRow(water, kind.key + "_unproject", "unproject through " + kind.name));
        rows.push_back(projectRow(air, kind.key + "_project", "project through " + kind.name + ", air", false));
        rows.push_back(projectRow(water, kind.key + "_project_water", "project through " + kind.name + ", water", false));
        rows.push_back(projectRow(std::make_shared<Curved>(kind.shape, 1.333, std::min(count, 10000)), kind.key + "_jacobian",
                                  "project through " + kind.name + " with jacobian", true));
    }
}

} // namespace bench
