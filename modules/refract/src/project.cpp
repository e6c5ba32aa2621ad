// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "kernels.hpp"
#include "rotation.hpp"

/* Object points -> pixels, and pixels -> rays: the two arrows of Camera over arrays. */

namespace cv { namespace refract {

void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
                             const Ptr<RefractiveCamera>& camera, OutputArray imagePoints, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(objectPoints, 3, "objectPoints");
    const Matx33d R = readRotation(rvec, "rvec");
    const Vec3d t = readVec3(tvec, "tvec");
    PointWriter out(imagePoints, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, x, y, z, st);
        kernels().transform(R.val, t.val, n, x, y, z);
        cam.project(n, x, y, z, NULL, u, v, st);
        out.store(begin, n, u, v, NULL, st);
        outStatus.store(begin, n, st);
    });
}

void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
                             InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                             OutputArray imagePoints, OutputArray status)
{
    refractiveProjectPoints(objectPoints, rvec, tvec, RefractiveCamera::create(cameraMatrix, distCoeffs, window),
                            imagePoints, status);
}

//! One point: pixel and its two rows of the jacobian: rvec, tvec, lens, window.
static uchar projectOne(const Camera& cam, const Vec3d& object, const Matx33d& R, const Matx33d* dR, const Vec3d& t,
                        Vec2d& pixel, Mat rows)
{
    double dPoint[6];
    AutoBuffer<double> dParameters(2*cam.parameterCount());
    const uchar status = cam.projectJacobian(R*object + t, pixel, dPoint, dParameters.data());
    if (status != REFRACT_OK)
    {
        rows.setTo(std::numeric_limits<double>::quiet_NaN());
        return status;
    }
    for (int r = 0; r < 2; ++r)
    {
        double* row = rows.ptr<double>(r);
        const Vec3d D(dPoint + 3*r);
        for (int i = 0; i < 3; ++i)
        {
            row[i] = D.dot(dR[i]*object);
            row[3 + i] = D[i];
        }
        const double* p = dParameters.data() + r*cam.parameterCount();
        std::copy(p, p + cam.parameterCount(), row + 6);
    }
    return status;
}

void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
                             const Ptr<RefractiveCamera>& camera, OutputArray imagePoints, OutputArray status,
                             OutputArray jacobian)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(objectPoints, 3, "objectPoints");
    Matx33d dR[3];
    const Vec3d r = rotationVector(readRotation(rvec, "rvec")), t = readVec3(tvec, "tvec");
    const Matx33d R = rotationMatrix(r, dR);
    PointWriter out(imagePoints, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    Mat J(2*in.size(), 6 + cam.parameterCount(), CV_64F);
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, x, y, z, st);
        for (int i = 0; i < n; ++i)
        {
            Vec2d pixel;
            Mat rows = J.rowRange(2*(begin + i), 2*(begin + i) + 2);
            if (st[i] == REFRACT_OK)
                st[i] = projectOne(cam, Vec3d(x[i], y[i], z[i]), R, dR, t, pixel, rows);
            else
                rows.setTo(std::numeric_limits<double>::quiet_NaN());
            u[i] = pixel[0]; v[i] = pixel[1];
        }
        out.store(begin, n, u, v, NULL, st);
        outStatus.store(begin, n, st);
    });
    if (jacobian.needed())
        J.copyTo(jacobian);
}

void refractiveUnprojectPoints(InputArray imagePoints, OutputArray origins, OutputArray directions,
                               const Ptr<RefractiveCamera>& camera, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(imagePoints, 2, "imagePoints");
    const Vec3d normal = cam.layers().normal();
    PointWriter outOrigins(origins, in.size(), 3, in.depth()), outDirections(directions, in.size(), 3, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double u[BLOCK], v[BLOCK], tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK], ox[BLOCK], oy[BLOCK], oz[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, u, v, NULL, st);
        cam.unproject(n, u, v, tau, dx, dy, dz, st);
        for (int i = 0; i < n; ++i)
        {
            ox[i] = tau[i]*normal[0];
            oy[i] = tau[i]*normal[1];
            oz[i] = tau[i]*normal[2];
        }
        outOrigins.store(begin, n, ox, oy, oz, st);
        outDirections.store(begin, n, dx, dy, dz, st);
        outStatus.store(begin, n, st);
    });
}

void refractiveUnprojectPoints(InputArray imagePoints, OutputArray origins, OutputArray directions,
                               InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                               OutputArray status)
{
    refractiveUnprojectPoints(imagePoints, origins, directions,
                              RefractiveCamera::create(cameraMatrix, distCoeffs, window), status);
}

}} // namespace
