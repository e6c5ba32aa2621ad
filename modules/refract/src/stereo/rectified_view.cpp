// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/rectified_view.hpp"

namespace cv { namespace refract {

//! P = (K, p), both of a 3x4 array.
static Matx34d readP(InputArray P, const char* name)
{
    const std::vector<double> p = readNumbers(P, name);
    if (p.size() != 12 || P.getMat().channels() != 1 || P.getMat().rows != 3)
        CV_Error_(Error::StsBadSize, ("%s has %d values; it must be 3x4, as refractiveStereoRectify gives it", name, (int)p.size()));
    return Matx34d(p.data());
}

RectifiedView::RectifiedView(const Camera& camera, InputArray R, InputArray P, InputArray T, InputArray depth, Size size,
                             const Names& names)
    : R_(readRotation(R, names.R)), pinhole_({ camera, Matx33d(), Vec3d(), Vec4d() })
{
    const Matx34d p = readP(P, names.P);
    K_ = p.get_minor<3, 3>(0, 0);
    const Matx33d inverse = inverseCameraMatrix(K_, names.P);
    centre_ = -(inverse*Vec3d(p(0, 3), p(1, 3), p(2, 3)));
    const Vec3d t = T.empty() ? Vec3d() : readVec3(T, "T");
    pinhole_.newToCamera = R_.t()*inverse;
    pinhole_.centre = R_.t()*centre_ + t;
    Vec4d plane(0, 0, 1, 0);
    if (!depth.empty() && depth.size() == size && (depth.type() == CV_32F || depth.type() == CV_64F) && size.area() > 1)
        depths_ = depth.getMat();
    else
        plane = scenePlane(depth, camera.refracts(), names.depth);
    const Vec3d normal = R_.t()*Vec3d(plane[0], plane[1], plane[2]);
    shift_ = normal.dot(t);
    pinhole_.plane = Vec4d(normal[0], normal[1], normal[2], plane[3] + shift_);
}

void RectifiedView::load(int row, int column, int n, double* planeD) const
{
    if (!hasDepths())
        std::fill(planeD, planeD + n, pinhole_.plane[3]);
    else if (depths_.depth() == CV_32F)
        std::transform(depths_.ptr<float>(row) + column, depths_.ptr<float>(row) + column + n, planeD,
                       [&](float z) { return z + shift_; });
    else
        std::transform(depths_.ptr<double>(row) + column, depths_.ptr<double>(row) + column + n, planeD,
                       [&](double z) { return z + shift_; });
}

//! Between the four pixels round a place.
template<typename T>
static double between(const Mat& depths, double x, double y)
{
    if (!(x >= 0 && y >= 0 && x <= depths.cols - 1 && y <= depths.rows - 1))
        return std::numeric_limits<double>::quiet_NaN();
    const int column = (int)x, row = (int)y, right = column + 1 < depths.cols, below = row + 1 < depths.rows;
    const double a = x - column, b = y - row;
    const T* p = depths.ptr<T>(row) + column;
    const T* q = depths.ptr<T>(row + below) + column;
    return (1 - b)*((1 - a)*p[0] + a*p[right]) + b*((1 - a)*q[0] + a*q[right]);
}

void RectifiedView::interpolate(int n, const double* x, const double* y, double* planeD) const
{
    if (!hasDepths())
        return load(0, 0, n, planeD);
    const bool isSingle = depths_.depth() == CV_32F;
    for (int i = 0; i < n; i++)
        planeD[i] = shift_ + (isSingle ? between<float>(depths_, x[i], y[i]) : between<double>(depths_, x[i], y[i]));
}

void checkRectification(const Matx33d& R1, const Matx33d& R2, const Matx33d& R)
{
    const double difference = norm(R2*R - R1, NORM_INF);
    if (difference > 1e-6)
        CV_Error_(Error::StsBadArg, ("R1, R2 and R do not belong together: R2*R differs from R1 by %g", difference));
}

void initRefractiveStereoRectifyMap(const Ptr<RefractiveCamera>& camera, InputArray depth, InputArray R, InputArray P,
                                    InputArray T, Size size, int m1type, OutputArray map1, OutputArray map2)
{
    CV_INSTRUMENT_REGION();

    const RectifiedView view(cameraOf(camera), R, P, T, depth, size, { "R", "P", "depth" });
    if (!view.hasDepths())
        return mapPlane(view.pinhole(), size, m1type, map1, map2);
    mapSurface(view.pinhole(), [&](int row, int column, int n, double* planeD) { view.load(row, column, n, planeD); },
               size, m1type, map1, map2);
}

void initRefractiveStereoRectifyMap(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                                    InputArray depth, InputArray R, InputArray P, InputArray T, Size size, int m1type,
                                    OutputArray map1, OutputArray map2)
{
    initRefractiveStereoRectifyMap(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, R, P, T, size, m1type,
                                   map1, map2);
}

}} // namespace
