// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/rectified_view.hpp"
#include "stereo/virtual_centres.hpp"

namespace cv { namespace refract {

//! What the view is to show, if not a depth for each pixel.
static Vec4d planeOf(InputArray depth, Size size, bool isNeeded, const char* name)
{
    if (depth.total() > 4)
        CV_Error_(Error::StsBadSize, ("%s is %dx%d %s; it must be one number (z), four (a plane), or one channel of the "
                                      "rectified image's size %dx%d", name, depth.cols(), depth.rows(),
                                      typeToString(depth.type()).c_str(), size.width, size.height));
    return scenePlane(depth, isNeeded, name);
}

/* A pinhole is on the axis of the camera's window, where rays may meet it, or at the centre of projection if there is none:
refractiveStereoRectify puts it nowhere else. P of one camera with the T of another is off by about the base line. */
static void checkPinhole(const Camera& camera, const Vec3d& centre, const Vec3d& T, const char* name)
{
    const double PRINTED = 1e-4, ROUNDING = 1e-9;       // relative; in any unit
    const Vec3d normal = camera.layers().normal();
    const double along = centre.dot(normal);
    const double off = norm(camera.refracts() ? centre - along*normal : centre);
    const double slack = PRINTED*(norm(T) + (camera.refracts() ? norm(centre) : 0)) + ROUNDING;
    if (off > slack)
        CV_Error_(Error::StsBadArg, ("%s and T (%g, %g, %g) do not belong together: the pinhole is %g off the axis of this camera's "
                                     "window. T is that of camera 1 -> this camera, and empty for camera 1", name, T[0],
                                     T[1], T[2], off));
    if (!camera.refracts())
        return;
    const Vec2d range = virtualCentreRange(camera) + slack*Vec2d(-1, 1);
    if (!(range[0] <= along && along <= range[1]))
        CV_Error_(Error::StsBadArg, ("%s and T (%g, %g, %g) do not belong together: the pinhole is at %g along the axis of this "
                                     "camera's window; its rays meet the axis between %g and %g", name, T[0], T[1], T[2], along,
                                     range[0], range[1]));
}

RectifiedView::RectifiedView(const Camera& camera, InputArray R, InputArray P, InputArray T, InputArray depth, Size size,
                             const Names& names)
    : R_(readRotation(R, names.R)), projection_(P, names.P), T_(T.empty() ? Vec3d() : readVec3(T, "T")), shift_(0),
      pinhole_({ camera, Matx33d(), Vec3d(), Vec4d() })
{
    pinhole_.newToCamera = R_.t()*projection_.inverseK;
    pinhole_.centre = R_.t()*projection_.centre + T_;
    checkPinhole(camera, pinhole_.centre, T_, names.P);
    const bool isImage = !depth.empty() && depth.size() == size && depth.channels() == 1 && size.area() > 1;
    see(isImage ? Vec4d(0, 0, 1, 0) : planeOf(depth, size, camera.refracts(), names.depth));
    if (!isImage)
        return;
    depths_ = depth.getMat();
    if (depths_.depth() != CV_32F && depths_.depth() != CV_64F)
        depths_.convertTo(depths_, CV_64F);
}

void RectifiedView::see(const Vec4d& plane)
{
    const Vec3d normal = R_.t()*Vec3d(plane[0], plane[1], plane[2]);
    shift_ = normal.dot(T_);
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
    // A pixel that has no part in the answer may be NaN.
    const auto mix = [](double first, double second, double part) { return part == 0 ? first : (1 - part)*first + part*second; };
    const T* p = depths.ptr<T>(row) + column;
    const T* q = depths.ptr<T>(row + below) + column;
    const double a = x - column;
    return mix(mix(p[0], p[right], a), mix(q[0], q[right], a), y - row);
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
