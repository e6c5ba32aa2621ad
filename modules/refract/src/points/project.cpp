// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "points/point_kernels.hpp"
#include "math/rotation.hpp"

/* Object points -> pixels, and pixels -> rays: the two arrows of Camera over arrays. */

namespace cv { namespace refract {

const double EIGHTH = 0.125;

/** Where R X + t is too large for a number, it is taken of an eighth of X and t, which is seen in the same pixel.
@param x, y, z X
@param X, Y, Z R X + t
@return which points those are */
static std::vector<int> takeEighths(const Matx33d& R, const Vec3d& t, int n, const double* x, const double* y, const double* z,
                                    double* X, double* Y, double* Z)
{
    std::vector<int> tooLarge;
    for (int i = 0; i < n; i++)
    {
        if (std::isfinite(X[i]) && std::isfinite(Y[i]) && std::isfinite(Z[i]))
            continue;
        const Vec3d moved = R*(EIGHTH*Vec3d(x[i], y[i], z[i])) + EIGHTH*t;
        tooLarge.push_back(i);
        X[i] = moved[0]; Y[i] = moved[1]; Z[i] = moved[2];
    }
    return tooLarge;
}

//! Object points some of which are extreme in the camera's frame (moderate.hpp).
static void projectExtreme(const Camera& cam, const Matx33d& R, const Vec3d& t, int n, const double* x, const double* y, const double* z,
                           double* u, double* v, uchar* status)
{
    double X[BLOCK], Y[BLOCK], Z[BLOCK];
    std::copy(x, x + n, X); std::copy(y, y + n, Y); std::copy(z, z + n, Z);
    pointKernels().transform(R.val, t.val, n, X, Y, Z);
    takeEighths(R, t, n, x, y, z, X, Y, Z);
    cam.project(n, X, Y, Z, NULL, u, v, status);
}

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
        out.prepare(begin, n);
        if (pointKernels().transform(R.val, t.val, n, x, y, z))
            cam.projectModerate(n, x, y, z, NULL, u, v, st);
        else
        {
            in.load(begin, n, x, y, z, st);
            projectExtreme(cam, R, t, n, x, y, z, u, v, st);
        }
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

//! The columns of a block's jacobian, computed side by side, as the rows u, v of each point; NaN where there is no answer.
static void storeRows(const Columns& columns, int n, const uchar* status, int begin, Mat& J)
{
    for (int i = 0; i < n; i++)
        for (int r = 0; r < 2; r++)
        {
            double* const rows = J.ptr<double>(2*(begin + i) + r);
            if (status[i] == REFRACT_OK)
                for (int c = 0; c < columns.perRow; c++)
                    rows[c] = columns.at(r, c)[i];
            else
                std::fill(rows, rows + columns.perRow, std::numeric_limits<double>::quiet_NaN());
        }
}

void refractiveProjectPoints(InputArray objectPoints, InputArray rvec, InputArray tvec,
                             const Ptr<RefractiveCamera>& camera, OutputArray imagePoints, OutputArray status,
                             OutputArray jacobian)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(objectPoints, 3, "objectPoints");
    Matx33d dR[3];
    const Vec3d r = readRotationVector(rvec, "rvec"), t = readVec3(tvec, "tvec");
    const Matx33d R = rotationMatrix(r, dR);
    const int count = 6 + cam.parameterCount();
    PointWriter out(imagePoints, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    Mat J;
    if (jacobian.needed())
    {
        jacobian.create(2*in.size(), count, CV_64F);
        J = jacobian.getMat();
    }
    const int SMALL = 32;       // so many points' derivatives stay in the first-level cache
    forEachBlock(in.size(), 10*POINT_COST, [&](int blockBegin, int blockSize)
    {
        AutoBuffer<double, 2*64*SMALL> buffer(2*count*SMALL);
        const Columns columns = { buffer.data(), count, SMALL }, byPoint = columns.from(3);
        double x[SMALL], y[SMALL], z[SMALL], X[SMALL], Y[SMALL], Z[SMALL], u[SMALL], v[SMALL];
        uchar st[SMALL];
        for (int begin = blockBegin; begin < blockBegin + blockSize; begin += SMALL)
        {
            const int n = std::min(SMALL, blockBegin + blockSize - begin);
            in.load(begin, n, x, y, z, st);
            std::copy(x, x + n, X); std::copy(y, y + n, Y); std::copy(z, z + n, Z);
            std::vector<int> tooLarge;
            if (!pointKernels().transform(R.val, t.val, n, X, Y, Z))
                tooLarge = takeEighths(R, t, n, x, y, z, X, Y, Z);
            cam.projectJacobian(n, X, Y, Z, u, v, byPoint, columns.from(6), st);
            for (int i : tooLarge)
            {
                x[i] *= EIGHTH; y[i] *= EIGHTH; z[i] *= EIGHTH;
            }
            for (int k = 0; k < 3; k++)
                pointKernels().chainLinear(dR[k].val, n, x, y, z, byPoint, columns.from(k));
            for (int i : tooLarge)
                for (int c = 0; c < 6; c++)
                    byPoint.at(c/3, c % 3)[i] *= EIGHTH;
            if (!J.empty())
                storeRows(columns, n, st, begin, J);
            out.store(begin, n, u, v, NULL, st);
            outStatus.store(begin, n, st);
        }
    });
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
        Rays rays;
        double u[BLOCK], v[BLOCK], ox[BLOCK], oy[BLOCK], oz[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, u, v, NULL, st);
        outOrigins.prepare(begin, n);
        cam.unproject(n, u, v, rays, st);
        outDirections.prepare(begin, n);
        pointKernels().multiples(normal.val, n, rays.tau, ox, oy, oz);
        for (int i = 0; i < n && rays.hasOffset; i++)
        {
            const Vec3d offset = rays.offsetOf(i);
            ox[i] += offset[0]; oy[i] += offset[1]; oz[i] += offset[2];
        }
        outOrigins.store(begin, n, ox, oy, oz, st);
        outDirections.store(begin, n, rays.dx, rays.dy, rays.dz, st);
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
