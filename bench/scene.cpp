// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "scene.hpp"

using namespace cv;
using namespace cv::refract;

namespace bench {

Scene::Scene(LensKind lens, double outerIndex, bool second)
    : kind(lens), K(2438.07, 0, 643.98, 0, 2438.08, 500.01, 0, 0, 1),
      D({ -0.4082, 0.4359, 3e-4, -2e-4, 0.1 }),
      window(second ? Vec3d(0.18, 0.03, 1) : Vec3d(-0.25, 0.09, 1), 20, 1.5437, 50, outerIndex)
{
    if (kind == FOURTEEN)
    {
        K = Matx33d(1200, 0, 640.25, 0, 1195, 512.5, 0, 0, 1);
        D = { 0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001, 1e-3, -2e-4, -8e-4, 1e-4, 0.03, -0.02 };
    }
    if (kind == FISHEYE)
    {
        K = Matx33d(700, 0, 640, 0, 705, 512, 0, 0, 1);
        D = { -0.02, 0.004, -0.001, 0.0001 };
    }
    camera = kind == FISHEYE ? RefractiveCamera::createFisheye(K, D, window) : RefractiveCamera::create(K, D, window);
}

Points::Points(const Scene& scene, int count, unsigned seed) : pixels(count), depths(count), points(count)
{
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> x(0, WIDTH - 1), y(0, HEIGHT - 1), z(NEAREST, FARTHEST);
    for (int i = 0; i < count; i++)
    {
        pixels[i] = Point2d(x(engine), y(engine));
        depths[i] = z(engine);
    }
    std::vector<Point2d> ideal;
    refractiveUndistortPoints(pixels, ideal, scene.camera, depths);
    for (int i = 0; i < count; i++)
        points[i] = Point3d(ideal[i].x*depths[i], ideal[i].y*depths[i], depths[i]);
}

} // namespace bench
