// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "kernels.hpp"
#include "plane.hpp"

/* Raw pixels -> pixels of the pinhole camera without window (refractiveUndistortPoints), and back for whole images
(initRefractiveUndistortRectifyMap). */

namespace cv { namespace refract {

//! Points (x, y, z) -> P R (x, y, z), dehomogenised.
static void pinhole(const Matx33d& R, const Matx33d& P, int n, const double* x, const double* y, const double* z,
                    double* u, double* v, uchar* status)
{
    const Matx33d M = P*R;
    if (kernels().pinhole(M.val, R.val + 6, n, x, y, z, u, v))
        return;
    for (int i = 0; i < n; ++i)
        if (status[i] == REFRACT_OK && std::isnan(u[i]) && !(R.row(2).t().dot(Vec3d(x[i], y[i], z[i])) > 0))
            status[i] = REFRACT_BEHIND_CAMERA;
}

void refractiveUndistortPoints(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera,
                               InputArray depth, InputArray R_, InputArray P_, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    const PointReader in(src, 2, "src");
    const Matx33d R = readRotation(R_, "R"), P = readProjection(P_, "P");
    const DepthReader depths(depth, "depth");
    if (depths.size() != 1 && depths.size() != in.size())
        CV_Error_(Error::StsUnmatchedSizes, ("depth has %d values; it must have 1 or one per point (%d)", depths.size(),
                                             in.size()));
    PointWriter out(dst, in.size(), 2, in.depth());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double u[BLOCK], v[BLOCK], tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK];
        double x[BLOCK], y[BLOCK], z[BLOCK], mu[BLOCK], planeD[BLOCK];
        uchar st[BLOCK];
        depths.load(begin, n, planeD);
        in.load(begin, n, u, v, NULL, st);
        cam.unproject(n, u, v, tau, dx, dy, dz, st);
        meetPlane(cam.layers(), n, Vec3d(0, 0, 1), planeD, tau, dx, dy, dz, x, y, z, mu, st);
        pinhole(R, P, n, x, y, z, u, v, st);
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

//! The scene of the map: one number z, four numbers of a plane, nothing = infinitely far.
static Vec4d scenePlane(InputArray depth)
{
    const double infinity = std::numeric_limits<double>::infinity();
    const DepthReader d(depth, "depth");
    if (d.size() == 1)
        return planeOfDepth(d.at(0), "depth");
    if (d.size() != 4)
        CV_Error_(Error::StsBadSize, ("depth has %d values; it must have 1 (z) or 4 (a plane), or be empty", d.size()));
    const Vec4d plane(d.at(0), d.at(1), d.at(2), d.at(3));
    checkPlane(plane, "depth");
    return plane[3] == -infinity ? -plane : plane;
}

/* One row of the new image: pixel -> direction -> homogeneous point on the plane -> raw pixel. */
static void mapBlock(const Camera& cam, const Matx33d& newToCamera, const Vec4d& plane, int column, int row, int n,
                     double* u, double* v, uchar* status)
{
    double x[BLOCK], y[BLOCK], z[BLOCK], w[BLOCK];
    for (int i = 0; i < n; ++i)
    {
        const Vec3d X = newToCamera*Vec3d(column + i, row, 1);
        x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
        w[i] = (plane[0]*x[i] + plane[1]*y[i] + plane[2]*z[i])/plane[3];
        status[i] = w[i] >= 0 && std::isfinite(w[i]) ? REFRACT_OK : REFRACT_NO_INTERSECTION;
    }
    cam.project(n, x, y, z, w, u, v, status);
}

//! Stores one run of a row in the formats of cv::initUndistortRectifyMap.
static void storeMap(Mat& map1, Mat& map2, int row, int column, int n, const double* u, const double* v,
                     const uchar* status)
{
    const int BITS = 5, SIZE = 1 << BITS;   // INTER_BITS, INTER_TAB_SIZE of imgproc
    for (int i = 0, c = column; i < n; ++i, ++c)
    {
        const double a = status[i] == REFRACT_OK ? u[i] : -1, b = status[i] == REFRACT_OK ? v[i] : -1;
        if (map1.type() == CV_32FC1)
        {
            map1.at<float>(row, c) = (float)a;
            map2.at<float>(row, c) = (float)b;
        }
        else if (map1.type() == CV_32FC2)
            map1.at<Vec2f>(row, c) = Vec2f((float)a, (float)b);
        else
        {
            const int ia = saturate_cast<int>(a*SIZE), ib = saturate_cast<int>(b*SIZE);
            map1.at<Vec2s>(row, c) = Vec2s(saturate_cast<short>(ia >> BITS), saturate_cast<short>(ib >> BITS));
            map2.at<ushort>(row, c) = (ushort)((ib & (SIZE - 1))*SIZE + (ia & (SIZE - 1)));
        }
    }
}

void initRefractiveUndistortRectifyMap(const Ptr<RefractiveCamera>& camera, InputArray depth, InputArray R_,
                                       InputArray newCameraMatrix, Size size, int m1type,
                                       OutputArray map1_, OutputArray map2_)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    if (m1type <= 0)
        m1type = CV_16SC2;
    if (m1type != CV_16SC2 && m1type != CV_32FC1 && m1type != CV_32FC2)
        CV_Error_(Error::StsUnsupportedFormat, ("m1type is %s; it must be CV_16SC2, CV_32FC1 or CV_32FC2",
                                                typeToString(m1type).c_str()));
    if (size.width < 0 || size.height < 0)
        CV_Error_(Error::StsBadSize, ("size is %dx%d; it must not be negative", size.width, size.height));
    const Vec4d plane = scenePlane(depth);
    const Matx33d R = readRotation(R_, "R");
    const Matx33d K = newCameraMatrix.empty() ? Matx33d(cam.cameraMatrix().ptr<double>())
                                              : readProjection(newCameraMatrix, "newCameraMatrix");
    if (determinant(K) == 0)
        CV_Error(Error::StsBadArg, "newCameraMatrix is singular");
    const Matx33d newToCamera = R.t()*K.inv();

    map1_.create(size, m1type);
    Mat map1 = map1_.getMat(), map2;
    if (m1type == CV_32FC2)
        map2_.release();
    else
    {
        map2_.create(size, m1type == CV_32FC1 ? CV_32FC1 : CV_16UC1);
        map2 = map2_.getMat();
    }
    parallel_for_(Range(0, size.height), [&](const Range& rows)
    {
        double u[BLOCK], v[BLOCK];
        uchar st[BLOCK];
        for (int row = rows.start; row < rows.end; ++row)
            for (int column = 0; column < size.width; column += BLOCK)
            {
                const int n = std::min(BLOCK, size.width - column);
                mapBlock(cam, newToCamera, plane, column, row, n, u, v, st);
                storeMap(map1, map2, row, column, n, u, v, st);
            }
    });
}

void initRefractiveUndistortRectifyMap(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                                       InputArray depth, InputArray R, InputArray newCameraMatrix, Size size,
                                       int m1type, OutputArray map1, OutputArray map2)
{
    initRefractiveUndistortRectifyMap(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R,
                                      newCameraMatrix, size, m1type, map1, map2);
}

}} // namespace
