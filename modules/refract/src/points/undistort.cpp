// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "math/missing.hpp"
#include "points/point_kernels.hpp"
#include "points/map.hpp"
#include "points/plane.hpp"

/* Raw pixels -> pixels of the pinhole camera without window, and back; for whole images in map.cpp. */

namespace cv { namespace refract {

//! Points (x, y, z) -> H (x, y, z), dehomogenised; axis: of the camera that sees them there.
static void pinhole(const Matx33d& H, const Vec3d& axis, int n, const double* x, const double* y, const double* z,
                    double* u, double* v, uchar* status)
{
    if (!pointKernels().pinhole(H.val, axis.val, n, x, y, z, u, v))
        answerMissing(n, u, status, [&](int i)
                      { return axis.dot(Vec3d(x[i], y[i], z[i])) > 0 ? REFRACT_OK : REFRACT_BEHIND_CAMERA; });
}

//! One depth, or one for each point.
static DepthReader depthsOf(InputArray depth, const PointReader& points, const Camera& camera)
{
    const DepthReader depths(depth, "depth", points.size(), camera.refracts());
    if (depths.size() != 1 && depths.size() != points.size())
        CV_Error_(Error::StsUnmatchedSizes, ("depth has %d values; it must have 1 or one per point (%d)", depths.size(),
                                             points.size()));
    return depths;
}

//! The status of points at depths that are not positive, where they have none yet.
static void refuseDepths(const Camera& camera, int n, const double* depth, uchar* status)
{
    for (int i = 0; i < n; i++)
        if (status[i] == REFRACT_OK && depth[i] <= 0)
            status[i] = camera.refracts() ? REFRACT_BEHIND_WINDOW : REFRACT_NO_INTERSECTION;
}

static void undistort(const PointReader& in, OutputArray dst, const Camera& cam, const DepthReader& depths, InputArray R_,
                      InputArray P_, OutputArray status)
{
    const Matx33d R = readRotationOrNone(R_, "R"), H = readProjection(P_, "P")*R;
    const Vec3d axis(R(2, 0), R(2, 1), R(2, 2)), ahead(0, 0, 1);
    PointWriter out(dst, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        Rays rays;
        double u[BLOCK], v[BLOCK];
        double x[BLOCK], y[BLOCK], z[BLOCK], planeD[BLOCK];
        uchar st[BLOCK];
        depths.load(begin, n, planeD);
        in.load(begin, n, u, v, NULL, st);
        cam.unproject(n, u, v, rays, st);
        refuseDepths(cam, n, planeD, st);
        out.prepare(begin, n);
        meetPlane(cam.layers(), n, ahead, planeD, rays, x, y, z, NULL, st);
        pinhole(H, axis, n, x, y, z, u, v, st);
        out.store(begin, n, u, v, NULL, st);
        outStatus.store(begin, n, st);
    });
}

void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, double depth, InputArray R,
                               InputArray P, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    undistort(PointReader(src, 2, "src"), dst, cam, DepthReader(depth, "depth", cam.refracts()), R, P, status);
}

void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, InputArray depth, InputArray R,
                               InputArray P, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(src, 2, "src");
    undistort(in, dst, cam, depthsOf(depth, in, cam), R, P, status);
}

void refractiveUndistortPoints(InputArray src, OutputArray dst,
                               InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                               double depth, InputArray R, InputArray P, OutputArray status)
{
    refractiveUndistortPoints(src, dst, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P, status);
}

void refractiveUndistortPoints(InputArray src, OutputArray dst,
                               InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                               InputArray depth, InputArray R, InputArray P, OutputArray status)
{
    refractiveUndistortPoints(src, dst, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P, status);
}

static void distort(const PointReader& in, OutputArray dst, const Camera& cam, const DepthReader& depths, InputArray R,
                    InputArray P, OutputArray status)
{
    const Matx33d K = readProjection(P, "P");
    const PinholeView view = { cam, readRotationOrNone(R, "R").t()*inverseCameraMatrix(K, "P"), Vec3d(), Vec4d(0, 0, 1, 0) };
    PointWriter out(dst, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        uchar st[BLOCK], given[BLOCK];
        depths.load(begin, n, z);
        in.load(begin, n, x, y, NULL, given);
        refuseDepths(cam, n, z, given);
        out.prepare(begin, n);
        view.toRaw(n, x, y, z, u, v, st);
        for (int i = 0; i < n; i++)
            if (given[i] != REFRACT_OK || std::isnan(z[i]))
                st[i] = std::isnan(z[i]) ? (uchar)REFRACT_NOT_FINITE : given[i];
        out.store(begin, n, u, v, NULL, st);
        outStatus.store(begin, n, st);
    });
}

void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, const Ptr<RefractiveCamera>& camera, double depth,
                             InputArray R, InputArray P, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    distort(PointReader(undistorted, 2, "undistorted"), distorted, cam, DepthReader(depth, "depth", cam.refracts()), R, P, status);
}

void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, const Ptr<RefractiveCamera>& camera, InputArray depth,
                             InputArray R, InputArray P, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(undistorted, 2, "undistorted");
    distort(in, distorted, cam, depthsOf(depth, in, cam), R, P, status);
}

void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, InputArray cameraMatrix, InputArray distCoeffs,
                             const GlassWindow& window, double depth, InputArray R, InputArray P, OutputArray status)
{
    refractiveDistortPoints(undistorted, distorted, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P,
                            status);
}

void refractiveDistortPoints(InputArray undistorted, OutputArray distorted, InputArray cameraMatrix, InputArray distCoeffs,
                             const GlassWindow& window, InputArray depth, InputArray R, InputArray P, OutputArray status)
{
    refractiveDistortPoints(undistorted, distorted, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P,
                            status);
}

}} // namespace
