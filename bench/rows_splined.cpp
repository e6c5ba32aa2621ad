// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A splined lens behind a pane in air beside mrcal's projection without one.
#include "rows.hpp"

#ifdef HAVE_MRCAL
extern "C" {        // mrcal 2.2 does not say so itself
#include <mrcal/mrcal.h>
}
#endif

using namespace cv;
using namespace cv::refract;

namespace bench {

#ifdef HAVE_MRCAL

namespace {

const char LENS[] = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=110";

struct SplinedData
{
    explicit SplinedData(int count)
    {
        RNG random(20240607);
        intrinsics = { 2000, 2001, 1999.5, 1499.5 };
        for (int i = 0; i < 2*30*20; i++)
            intrinsics.push_back(random.uniform(-1e-3, 1e-3));
        mrcal_lensmodel_from_name(&lens, LENS);
        camera = RefractiveCamera::createMrcal(LENS, intrinsics, GlassWindow(Vec3d(0.1, -0.2, 1), 20, 1.52));
        for (int i = 0; i < count; i++)
            points.push_back(random.uniform(400., 1500.)*Point3d(random.uniform(-0.8, 0.8), random.uniform(-0.5, 0.5), 1));
        refractiveProjectPoints(points, rvec, tvec, camera, pixels, status);
        peerPixels.resize(count);
        peerDirections.resize(count);
    }

    //! Largest distance of a point from its pixel's ray, as an angle times the focal length.
    double worstMiss() const
    {
        std::vector<Point3d> origins, directions;
        refractiveUnprojectPoints(pixels, origins, directions, camera);
        double worst = 0;
        for (int i : sample((int)points.size()))
        {
            const Point3d away = points[i] - origins[i];
            worst = std::max(worst, 2000*norm(away.cross(directions[i]))/norm(away));
        }
        return worst;
    }

    mrcal_lensmodel_t lens;
    std::vector<double> intrinsics;
    Ptr<RefractiveCamera> camera;
    std::vector<Point3d> points, origins, directions, peerDirections;
    std::vector<Point2d> pixels, peerPixels;
    std::vector<uchar> status;
    Vec3d rvec, tvec;
};

} // namespace

void addSplinedRows(std::vector<Row>& rows, int count)
{
    const std::shared_ptr<SplinedData> a = std::make_shared<SplinedData>(count);
    Row project = { "splined_project", "splined lens, project", "mrcal_project, no window", { 0.5, 0.5 }, count, {}, {}, {}, {}, 41,
                    "px", 1e-9, {}, {}, {} };
    project.ours = [=] { refractiveProjectPoints(a->points, a->rvec, a->tvec, a->camera, a->pixels, a->status); };
    project.peer = [=] { mrcal_project((mrcal_point2_t*)a->peerPixels.data(), nullptr, nullptr,
                                       (const mrcal_point3_t*)a->points.data(), count, &a->lens, a->intrinsics.data()); };
    project.error = [=] { return a->worstMiss(); };
    project.successes = [=] { return countOk(a->status); };
    rows.push_back(project);
    Row unproject = { "splined_unproject", "splined lens, unproject", "mrcal_unproject, no window", { 0, 0 }, count, {}, {}, {}, {},
                      65, "px", 1e-9, {}, {}, {} };
    unproject.ours = [=] { refractiveUnprojectPoints(a->pixels, a->origins, a->directions, a->camera, a->status); };
    unproject.peer = [=] { mrcal_unproject((mrcal_point3_t*)a->peerDirections.data(), (const mrcal_point2_t*)a->pixels.data(),
                                           count, &a->lens, a->intrinsics.data()); };
    unproject.error = [=] { return a->worstMiss(); };
    unproject.successes = [=] { return countOk(a->status); };
    rows.push_back(unproject);
}

#else

void addSplinedRows(std::vector<Row>&, int) {}

#endif

} // namespace bench
