// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// C++ calls of the module for overhead.py: the same arrays, outputs allocated anew as Python's are; each returns seconds.
#include <opencv2/refract.hpp>

using namespace cv;
using namespace cv::refract;

static Ptr<RefractiveCamera> camera(double x)
{
    const Matx33d K(2438, 0, 644, 0, 2438, 500, 0, 0, 1);
    return RefractiveCamera::create(K, Vec<double, 5>(-0.4082, 0.4359, 0, 0, 0),
                                    GlassWindow(Vec3d(x, 0.1, 1), 20, 1.5437, 50));
}

//! n points of `channels` numbers, `step` bytes apart, wrapped without a copy.
static Mat points(double* data, int n, int channels, size_t step)
{
    return Mat(n, channels, CV_64F, data, step);
}

extern "C" double project(double* data, int n, size_t step)
{
    const Ptr<RefractiveCamera> cam = camera(-0.25);
    Mat pixels, status;
    TickMeter meter;
    meter.start();
    refractiveProjectPoints(points(data, n, 3, step), Vec3d(), Vec3d(), cam, pixels, status);
    meter.stop();
    return meter.getTimeSec();
}

extern "C" double undistort(double* data, int n, size_t step)
{
    const Ptr<RefractiveCamera> cam = camera(-0.25);
    Mat ideal, status;
    TickMeter meter;
    meter.start();
    refractiveUndistortPoints(points(data, n, 2, step), ideal, cam, 600., noArray(), noArray(), status);
    meter.stop();
    return meter.getTimeSec();
}

extern "C" double unproject(double* data, int n, size_t step)
{
    const Ptr<RefractiveCamera> cam = camera(-0.25);
    Mat origins, directions, status;
    TickMeter meter;
    meter.start();
    refractiveUnprojectPoints(points(data, n, 2, step), origins, directions, cam, status);
    meter.stop();
    return meter.getTimeSec();
}

extern "C" double triangulate(double* data1, double* data2, int n, size_t step)
{
    const Ptr<RefractiveCamera> camera1 = camera(-0.25), camera2 = camera(0.18);
    Mat points3D, status;
    TickMeter meter;
    meter.start();
    triangulateRefractive(camera1, camera2, Vec3d(0.01, 0.3, 0), Vec3d(-180, 2, 25), points(data1, n, 2, step),
                          points(data2, n, 2, step), points3D, status);
    meter.stop();
    return meter.getTimeSec();
}
