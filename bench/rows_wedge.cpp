// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What faces that are not parallel cost: beside the same calls through parallel ones.
#include "rows.hpp"

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const double WEDGE[] = { 6e-4, -4e-4 };       // radians: two and a half arc minutes

struct Results
{
    std::vector<Point2d> pixels;
    std::vector<Point3d> origins, directions;
    std::vector<uchar> status;
    Mat jacobian;
};

struct Wedge
{
    Wedge(double outerIndex, int count) : scene(FIVE, outerIndex), points(scene, count), exactly(scene.parts<long double>())
    {
        GlassWindow window = scene.window;
        window.wedge.push_back(Vec2d(WEDGE[0], WEDGE[1]));
        camera = RefractiveCamera::create(scene.K, scene.D, window);
    }
    Scene scene;
    Points points;
    reference::Camera<long double> exactly;
    Ptr<RefractiveCamera> camera;
    Results ours, peers;
    Vec3d rvec = Vec3d(0, 0, 0), tvec = Vec3d(0, 0, 0);
};

typedef std::shared_ptr<Wedge> Data;

//! Vector Snell, face by face; the outer one is turned by the wedge.
reference::Ray<long double> trace(const Wedge& a, const Pixel& pixel)
{
    const reference::Camera<long double>& c = a.exactly;
    const Point& n = c.normal;
    const long double angle = std::hypot((long double)WEDGE[0], (long double)WEDGE[1]), length = std::sqrt(1 - n[0]*n[0]);
    const Point e1 = { (1 - n[0]*n[0])/length, -n[0]*n[1]/length, -n[0]*n[2]/length };
    const Point e2 = { n[1]*e1[2] - n[2]*e1[1], n[2]*e1[0] - n[0]*e1[2], n[0]*e1[1] - n[1]*e1[0] };
    const long double cosine = std::cos(angle), sine = std::sin(angle)/angle;
    const Point outer = reference::add(reference::add({ cosine*n[0], cosine*n[1], cosine*n[2] }, sine*WEDGE[0], e1), sine*WEDGE[1], e2);
    Point d = c.lens.unproject(pixel), point = { 0, 0, 0 };
    long double height = 0;
    for (size_t k = 0; k < c.height.size(); k++)
    {
        const Point& m = k + 1 < c.height.size() ? n : outer;
        height += c.height[k];
        point = reference::add(point, (height*reference::dot(m, n) - reference::dot(m, point))/reference::dot(m, d), d);
        d = reference::refracted(d, c.index[k]/c.index[k + 1], m);
    }
    return { point, d };
}

//! Pixels between where two rays meet the plane of a depth, as a pinhole sees it.
double apart(const Wedge& a, const reference::Ray<long double>& one, const reference::Ray<long double>& other, double depth)
{
    return (double)(a.exactly.lens.fx*reference::apart(one, other, (long double)depth));
}

Row row(const Data& a, const std::string& key, const std::string& work, double bytes)
{
    Row r = { key, work, "parallel faces", { 2.5, 2.5 }, (int)a->points.pixels.size(), {}, {}, {}, {}, bytes, "px", 1e-9, {}, {}, {} };
    r.successes = [=] { return countOk(a->ours.status); };
    return r;
}

Row undistortRow(const Data& a)
{
    Row r = row(a, "wedge_undistort", "undistort through a wedge", 41);
    const auto undistort = [=](const Ptr<RefractiveCamera>& camera, Results& to)
    { refractiveUndistortPoints(a->points.pixels, to.pixels, camera, a->points.depths, noArray(), noArray(), to.status); };
    r.ours = [=] { undistort(a->camera, a->ours); };
    r.peer = [=] { undistort(a->scene.camera, a->peers); };
    r.error = [=]
    {
        return worst(a->ours.status, [&](int i)
        {
            const double z = a->points.depths[i];
            const reference::Ray<long double> found = { exact(Point3d(a->ours.pixels[i].x*z, a->ours.pixels[i].y*z, z)), { 0, 0, 1 } };
            return apart(*a, found, trace(*a, exact(a->points.pixels[i])), z);
        });
    };
    return r;
}

Row unprojectRow(const Data& a)
{
    Row r = row(a, "wedge_unproject", "unproject through a wedge", 65);
    const auto unproject = [=](const Ptr<RefractiveCamera>& camera, Results& to)
    { refractiveUnprojectPoints(a->points.pixels, to.origins, to.directions, camera, to.status); };
    r.ours = [=] { unproject(a->camera, a->ours); };
    r.peer = [=] { unproject(a->scene.camera, a->peers); };
    r.error = [=]
    {
        return worst(a->ours.status, [&](int i) { return apart(*a, { exact(a->ours.origins[i]), exact(a->ours.directions[i]) },
                                                  trace(*a, exact(a->points.pixels[i])), a->points.depths[i]); });
    };
    return r;
}

Row projectRow(const Data& a, const std::string& key, const std::string& work, bool jacobian)
{
    Row r = row(a, key, work, jacobian ? 24 + 16 + 1 + 2*8*(6 + 9 + 10) : 41);
    const auto project = [=](const Ptr<RefractiveCamera>& camera, Results& to)
    {
        if (jacobian)
            refractiveProjectPoints(a->points.points, a->rvec, a->tvec, camera, to.pixels, to.status, to.jacobian);
        else
            refractiveProjectPoints(a->points.points, a->rvec, a->tvec, camera, to.pixels, to.status);
    };
    r.ours = [=] { project(a->camera, a->ours); };
    r.peer = [=] { project(a->scene.camera, a->peers); };
    r.error = [=]
    {
        return worst(a->ours.status, [&](int i)
        {
            const Point3d& X = a->points.points[i];
            return apart(*a, { exact(X), { 0, 0, 1 } }, trace(*a, exact(a->ours.pixels[i])), X.z);
        });
    };
    return r;
}

} // namespace

void addWedgeRows(std::vector<Row>& rows, int count)
{
    const Data air = std::make_shared<Wedge>(1, count), water = std::make_shared<Wedge>(1.333, count);
    rows.push_back(undistortRow(air));
    rows.push_back(unprojectRow(air));
    rows.push_back(projectRow(air, "wedge_project", "project through a wedge, air", false));
    rows.push_back(projectRow(water, "wedge_project_water", "project through a wedge, water", false));
    rows.push_back(projectRow(std::make_shared<Wedge>(1, std::min(count, 10000)), "wedge_jacobian", "project through a wedge with jacobian",
                              true));
}

} // namespace bench
