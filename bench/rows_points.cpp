// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "rows.hpp"

#include <opencv2/calib3d.hpp>

#ifdef HAVE_MRCAL
extern "C" {        // mrcal 2.2 does not say so itself
#include <mrcal/mrcal.h>
}
#endif

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

//! What the rows of one camera share: its points, and where results go.
struct Arrays
{
    Arrays(LensKind lens, double outerIndex, int count)
        : scene(lens, outerIndex), points(scene, count), scalar(scene.parts<double>()), exactly(scene.parts<long double>()) {}
    Scene scene;
    Points points;
    reference::Camera<double> scalar;
    reference::Camera<long double> exactly;
    std::vector<Point2d> pixels, peerPixels;
    std::vector<Point3d> origins, directions;
    std::vector<uchar> status;
    Mat jacobian, peerJacobian;
    Vec3d rvec = Vec3d(0, 0, 0), tvec = Vec3d(0, 0, 0);
};

typedef std::shared_ptr<Arrays> Data;

double worstPixel(const Data& a, const std::vector<Point2d>& found, const std::function<Pixel(int)>& expected)
{
    long double worst = 0;
    for (int i : sample((int)found.size()))
    {
        const Pixel p = expected(i);
        worst = std::max(worst, std::hypot(found[i].x - p[0], found[i].y - p[1]));
        if (a->status.size() == found.size() && a->status[i])
            return NAN;
    }
    return (double)worst;
}

//! The scene point of pixel i at its depth, by the reference.
Point atDepth(const Data& a, int i)
{
    const reference::Ray<long double> ray = a->exactly.unproject(exact(a->points.pixels[i]));
    return reference::add(ray.origin, (a->points.depths[i] - ray.origin[2])/ray.direction[2], ray.direction);
}

template<typename T>
reference::Vec2<T> pinhole(const reference::Lens<T>& lens, const reference::Vec3<T>& X)
{
    return { lens.fx*X[0]/X[2] + lens.cx, lens.fy*X[1]/X[2] + lens.cy };
}

Work mrcal(const Data& a, bool project)
{
#ifdef HAVE_MRCAL
    if (a->scene.kind != FIVE)
        return Work();
    return [=]
    {
        mrcal_lensmodel_t lens;
        mrcal_lensmodel_from_name(&lens, "LENSMODEL_OPENCV5");
        double intrinsics[9] = { a->scene.K(0, 0), a->scene.K(1, 1), a->scene.K(0, 2), a->scene.K(1, 2) };
        std::copy(a->scene.D.begin(), a->scene.D.end(), intrinsics + 4);
        const int n = (int)a->points.points.size();
        a->peerPixels.resize(n);
        a->directions.resize(n);
        if (project)
            mrcal_project((mrcal_point2_t*)a->peerPixels.data(), nullptr, nullptr,
                          (const mrcal_point3_t*)a->points.points.data(), n, &lens, intrinsics);
        else
            mrcal_unproject((mrcal_point3_t*)a->directions.data(), (const mrcal_point2_t*)a->points.pixels.data(), n,
                            &lens, intrinsics);
    };
#else
    (void)a; (void)project;
    return Work();
#endif
}

void undistortByOpenCV(const Data& a)
{
    const Scene& s = a->scene;
    if (s.kind == FISHEYE)
        fisheye::undistortPoints(a->points.pixels, a->peerPixels, s.K, s.D, noArray(), s.K);
    else
        undistortPoints(a->points.pixels, a->peerPixels, s.K, s.D, noArray(), s.K);
}

//! cv::undistortPoints' own error: of the lens alone, as it knows no window.
double opencvUndistortError(const Data& a)
{
    a->status.clear();
    return worstPixel(a, a->peerPixels, [&](int i)
        { return pinhole(a->exactly.lens, a->exactly.lens.unproject(exact(a->points.pixels[i]))); });
}

Row undistortRow(const Data& a, const std::string& key, const std::string& work)
{
    const int n = (int)a->points.pixels.size();
    Row r = { key, work, a->scene.kind == FISHEYE ? "cv::fisheye::undistortPoints" : "cv::undistortPoints",
              { 1/6., 1/4. }, n, {}, {}, {}, {}, 41, "px", 1e-9, {}, {}, {} };
    r.ours = [=] { refractiveUndistortPoints(a->points.pixels, a->pixels, a->scene.camera, a->points.depths, noArray(),
                                             a->scene.K, a->status); };
    r.peer = [=] { undistortByOpenCV(a); };
    r.mrcal = mrcal(a, false);
    r.scalar = [=]
    {
        a->peerPixels.resize(n);
        for (int i = 0; i < n; i++)
        {
            const auto ray = a->scalar.unproject({ a->points.pixels[i].x, a->points.pixels[i].y });
            const auto X = reference::add(ray.origin, (a->points.depths[i] - ray.origin[2])/ray.direction[2], ray.direction);
            const auto p = pinhole(a->scalar.lens, X);
            a->peerPixels[i] = Point2d(p[0], p[1]);
        }
    };
    r.error = [=] { return worstPixel(a, a->pixels, [&](int i) { return pinhole(a->exactly.lens, atDepth(a, i)); }); };
    r.peerError = [=] { undistortByOpenCV(a); return opencvUndistortError(a); };
    r.successes = [=] { return countOk(a->status); };
    return r;
}

Row unprojectRow(const Data& a, const std::string& key, const std::string& work)
{
    Row r = undistortRow(a, key, work);
    r.bytes = 65;
    r.ours = [=] { refractiveUnprojectPoints(a->points.pixels, a->origins, a->directions, a->scene.camera, a->status); };
    r.scalar = [=]
    {
        for (size_t i = 0; i < a->points.pixels.size(); i++)
        {
            const auto ray = a->scalar.unproject({ a->points.pixels[i].x, a->points.pixels[i].y });
            a->origins[i] = Point3d(ray.origin[0], ray.origin[1], ray.origin[2]);
            a->directions[i] = Point3d(ray.direction[0], ray.direction[1], ray.direction[2]);
        }
    };
    r.error = [=]
    {
        long double worst = 0;      // as a pixel at the point's depth
        for (int i : sample(r.count))
        {
            const Point3d &o = a->origins[i], &d = a->directions[i];
            const Point X = reference::add(exact(o), (a->points.depths[i] - o.z)/(long double)d.z, exact(d));
            const Pixel p = pinhole(a->exactly.lens, X), q = pinhole(a->exactly.lens, atDepth(a, i));
            worst = std::max(worst, std::hypot(p[0] - q[0], p[1] - q[1]));
        }
        return (double)worst;
    };
    return r;
}

void projectByOpenCV(const Data& a, OutputArray jacobian = noArray())
{
    const Scene& s = a->scene;
    if (s.kind == FISHEYE)
        fisheye::projectPoints(a->points.points, a->peerPixels, a->rvec, a->tvec, s.K, s.D, 0, jacobian);
    else
        projectPoints(a->points.points, a->rvec, a->tvec, s.K, s.D, a->peerPixels, jacobian);
}

Row projectRow(const Data& a, const std::string& key, const std::string& work, double avx512, double avx2)
{
    const int n = (int)a->points.points.size();
    Row r = { key, work, a->scene.kind == FISHEYE ? "cv::fisheye::projectPoints" : "cv::projectPoints",
              { avx512, avx2 }, n, {}, {}, {}, {}, 41, "px", 1e-9, {}, {}, {} };
    r.ours = [=] { refractiveProjectPoints(a->points.points, a->rvec, a->tvec, a->scene.camera, a->pixels, a->status); };
    r.peer = [=] { projectByOpenCV(a); };
    r.mrcal = mrcal(a, true);
    r.scalar = [=]
    {
        a->peerPixels.resize(n);
        for (int i = 0; i < n; i++)
        {
            const Point3d& X = a->points.points[i];
            const auto p = a->scalar.project({ X.x, X.y, X.z });
            a->peerPixels[i] = Point2d(p[0], p[1]);
        }
    };
    r.error = [=] { return worstPixel(a, a->pixels, [&](int i) { return a->exactly.project(exact(a->points.points[i])); }); };
    r.peerError = [=]
    {
        projectByOpenCV(a);
        a->status.clear();
        return worstPixel(a, a->peerPixels, [&](int i) { return a->exactly.lens.project(exact(a->points.points[i])); });
    };
    r.successes = [=] { return countOk(a->status); };
    return r;
}

//! Largest relative error of the derivatives by the translation, against differences of the reference.
double jacobianError(const Data& a)
{
    const long double step = 1e-4L;
    long double worst = 0;
    for (int i : sample((int)a->points.points.size(), 200))
        for (int c = 0; c < 3; c++)
        {
            Point ends[2] = { exact(a->points.points[i]), exact(a->points.points[i]) };
            ends[0][c] += step;
            ends[1][c] -= step;
            const Pixel p = a->exactly.project(ends[0]), q = a->exactly.project(ends[1]);
            for (int k = 0; k < 2; k++)
                worst = std::max(worst, std::abs((p[k] - q[k])/(2*step) - a->jacobian.at<double>(2*i + k, 3 + c)));
        }
    return (double)worst;
}

Row jacobianRow(const Data& a, const std::string& key, const std::string& work)
{
    Row r = projectRow(a, key, work, 0.5, 0.5);
    r.bytes = 24 + 16 + 1 + 2*8*(6 + 9 + 8);
    r.peerName += " with jacobian";
    r.ours = [=] { refractiveProjectPoints(a->points.points, a->rvec, a->tvec, a->scene.camera, a->pixels, a->status,
                                           a->jacobian); };
    r.peer = [=] { projectByOpenCV(a, a->peerJacobian); };
    r.scalar = r.mrcal = Work();
    r.unit = "px/mm";
    r.error = [=] { return jacobianError(a); };
    r.peerError = nullptr;
    return r;
}

} // namespace

void addPointRows(std::vector<Row>& rows, int count)
{
    const auto data = [&](LensKind lens, double outerIndex) { return std::make_shared<Arrays>(lens, outerIndex, count); };
    const Data air = data(FIVE, 1), water = data(FIVE, 1.333), fourteen = data(FOURTEEN, 1), fish = data(FISHEYE, 1);
    rows.push_back(undistortRow(air, "undistort", "undistort, depth per point"));
    rows.push_back(unprojectRow(air, "unproject", "unproject"));
    rows.push_back(projectRow(air, "project", "project, air", 0.5, 1));
    rows.push_back(projectRow(water, "project_water", "project, water", 2/3., 1.2));
    const Data few = std::make_shared<Arrays>(FIVE, 1, std::min(count, 10000));
    rows.push_back(jacobianRow(few, "jacobian", "project with jacobian"));
    rows.push_back(undistortRow(fourteen, "undistort14", "undistort, 14 coefficients"));
    rows.push_back(unprojectRow(fourteen, "unproject14", "unproject, 14 coefficients"));
    rows.push_back(projectRow(fourteen, "project14", "project, 14 coefficients", 0.5, 1));
    rows.push_back(undistortRow(fish, "undistort_fisheye", "undistort, fisheye"));
    rows.push_back(unprojectRow(fish, "unproject_fisheye", "unproject, fisheye"));
    rows.push_back(projectRow(fish, "project_fisheye", "project, fisheye", 0.5, 1));
}

} // namespace bench
