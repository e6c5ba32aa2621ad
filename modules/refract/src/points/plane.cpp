// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/plane.hpp"
#include "arrays/arrays.hpp"
#include "arrays/moderate.hpp"
#include "math/missing.hpp"
#include "points/point_kernels.hpp"

namespace cv { namespace refract {

Vec4d planeOfDepth(double depth, const char* name)
{
    if (!(depth > 0))
        CV_Error_(Error::StsOutOfRange, ("%s is %g; it must be positive", name, depth));
    return Vec4d(0, 0, 1, depth);
}

void checkPlane(const Vec4d& p, const char* name)
{
    const double length = cv::norm(Vec3d(p[0], p[1], p[2]));
    if (!(length > 0) || !std::isfinite(length) || std::isnan(p[3]))
        CV_Error_(Error::StsBadArg, ("%s is (%g, %g, %g, %g); (a, b, c) must be finite and not zero",
                                     name, p[0], p[1], p[2], p[3]));
}

//! The same plane with numbers of which products do not leave the range of double; they are the given ones if those are such.
static Vec4d moderatePlane(const Vec4d& p)
{
    const double largest = std::max(std::abs(p[0]), std::max(std::abs(p[1]), std::abs(p[2])));
    const bool isModerate = largest <= MODERATE && largest >= 1/MODERATE;
    return isModerate || !(largest > 0) || !std::isfinite(largest) ? p : p*std::scalbn(1., -std::ilogb(largest));
}

//! One lane of meetPlane: the answer, or why there is none. m is 1/s of the ray's point.
static uchar meetPlaneOne(const Layers& layers, const Vec3d& abc, double planeD, const Rays& rays, int i, Vec3d& X, double& m)
{
    const Vec3d d = rays.direction(i), offset = rays.offsetOf(i);
    const double along = abc.dot(d), tau = rays.tau[i];
    m = along/(planeD - tau*abc.dot(layers.normal()) - abc.dot(offset));
    X = d + m*tau*layers.normal() + m*offset;
    return std::isnan(planeD) ? REFRACT_NOT_FINITE : along == 0 ? REFRACT_PARALLEL_RAYS :
           !(m >= 0) || std::signbit(m) || std::isinf(m) ? REFRACT_NO_INTERSECTION :
           layers.refracts() && !isBeyondAlong(layers.lastSurface(), X[0], X[1], X[2], m, d[0], d[1], d[2]) ? REFRACT_BEHIND_WINDOW :
           REFRACT_OK;
}

void meetPlane(const Layers& layers, int n, const Vec3d& abc, const double* planeD, const Rays& rays,
               double* x, double* y, double* z, double* mu, uchar* status)
{
    const bool allMeet = rays.hasOffset ?
        pointKernels().meetPlaneOffAxis(layers.stack(), layers.lastSurface(), rays.offsets(), abc.val, planeD, n, rays.tau, rays.dx,
                                        rays.dy, rays.dz, x, y, z, mu) :
        pointKernels().meetPlane(layers.stack(), layers.lastSurface(), abc.val, planeD, n, rays.tau, rays.dx, rays.dy, rays.dz, x, y,
                                 z, mu);
    if (allMeet)
        return;
    answerMissing(n, x, status, [&](int i)
    {
        Vec3d X;
        double m;
        const uchar found = meetPlaneOne(layers, abc, planeD[i], rays, i, X, m);
        x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
        if (mu)
            mu[i] = m;
        return found;
    });
}

void refractivePointsOnPlane(InputArray imagePoints, OutputArray points3D,
                             const Ptr<RefractiveCamera>& camera, const Vec4d& plane, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(imagePoints, 2, "imagePoints");
    if (!std::isfinite(plane[3]))
        CV_Error_(Error::StsBadArg, ("plane[3] is %g; it must be finite", plane[3]));
    const Vec4d moderate = moderatePlane(plane);
    checkPlane(moderate, "plane");
    const Vec3d abc(moderate[0], moderate[1], moderate[2]);
    PointWriter out(points3D, in.size(), 3, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        Rays rays;
        double u[BLOCK], v[BLOCK];
        double x[BLOCK], y[BLOCK], z[BLOCK], mu[BLOCK], planeD[BLOCK];
        uchar st[BLOCK];
        std::fill(planeD, planeD + n, moderate[3]);
        in.load(begin, n, u, v, NULL, st);
        cam.unproject(n, u, v, rays, st);
        out.prepare(begin, n);
        meetPlane(cam.layers(), n, abc, planeD, rays, x, y, z, mu, st);
        for (int i = 0; i < n; i++)
        {
            x[i] /= mu[i]; y[i] /= mu[i]; z[i] /= mu[i];
            if (st[i] == REFRACT_OK && !(std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i])))
                st[i] = REFRACT_PARALLEL_RAYS;      // or so nearly that they meet beyond the largest number
        }
        out.store(begin, n, x, y, z, st);
        outStatus.store(begin, n, st);
    });
}

void refractivePointsOnPlane(InputArray imagePoints, OutputArray points3D,
                             InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                             const Vec4d& plane, OutputArray status)
{
    refractivePointsOnPlane(imagePoints, points3D, RefractiveCamera::create(cameraMatrix, distCoeffs, window),
                            plane, status);
}

}} // namespace
