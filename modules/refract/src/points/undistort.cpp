// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "math/missing.hpp"
#include "points/point_kernels.hpp"
#include "points/plane.hpp"

/* Raw pixels -> pixels of the pinhole camera without window. The way back, for whole images, is in map.cpp. */

namespace cv { namespace refract {

//! Points (x, y, z) -> H (x, y, z), dehomogenised; axis: of the camera that sees them there.
static void pinhole(const Matx33d& H, const Vec3d& axis, int n, const double* x, const double* y, const double* z,
                    double* u, double* v, uchar* status)
{
    if (!pointKernels().pinhole(H.val, axis.val, n, x, y, z, u, v))
        answerMissing(n, u, status, [&](int i)
                      { return axis.dot(Vec3d(x[i], y[i], z[i])) > 0 ? REFRACT_OK : REFRACT_BEHIND_CAMERA; });
}

void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera,
                               InputArray depth, InputArray R_, InputArray P_, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(src, 2, "src");
    const Matx33d R = readRotation(R_, "R"), H = readProjection(P_, "P")*R;
    const Vec3d axis(R(2, 0), R(2, 1), R(2, 2));
    const DepthReader depths(depth, "depth", in.size(), cam.refracts());
    if (depths.size() != 1 && depths.size() != in.size())
        CV_Error_(Error::StsUnmatchedSizes, ("depth has %d values; it must have 1 or one per point (%d)", depths.size(),
                                             in.size()));
    const Vec3d ahead(0, 0, 1);
    PointWriter out(dst, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double u[BLOCK], v[BLOCK], tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK];
        double x[BLOCK], y[BLOCK], z[BLOCK], planeD[BLOCK];
        uchar st[BLOCK];
        depths.load(begin, n, planeD);
        in.load(begin, n, u, v, NULL, st);
        cam.unproject(n, u, v, tau, dx, dy, dz, st);
        out.prepare(begin, n);
        meetPlane(cam.layers(), n, ahead, planeD, tau, dx, dy, dz, x, y, z, NULL, st);
        pinhole(H, axis, n, x, y, z, u, v, st);
        out.store(begin, n, u, v, NULL, st);
        outStatus.store(begin, n, st);
    });
}

void refractiveUndistortPoints(InputArray src, OutputArray dst,
                               InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                               InputArray depth, InputArray R, InputArray P, OutputArray status)
{
    refractiveUndistortPoints(src, dst, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P, status);
}

}} // namespace
