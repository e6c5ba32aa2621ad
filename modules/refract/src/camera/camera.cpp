// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "camera/camera.hpp"
#include "arrays/arrays.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

Camera::Camera(const Ptr<Lens>& lens, const GlassWindow& window) : lens_(lens), window_(window), layers_(window) {}

void Camera::project(int n, const double* x, const double* y, const double* z, const double* w,
                     double* u, double* v, uchar* status) const
{
    double dx[BLOCK], dy[BLOCK], dz[BLOCK];
    CV_DbgAssert(n <= BLOCK);
    layers_.solveIn(n, x, y, z, w, dx, dy, dz, status);
    lens_->project(n, dx, dy, dz, u, v, status);
}

void Camera::unproject(int n, const double* u, const double* v, Rays& rays, uchar* status) const
{
    double wx[BLOCK], wy[BLOCK], wz[BLOCK];
    CV_DbgAssert(n <= BLOCK);
    lens_->unproject(n, u, v, wx, wy, wz, status);
    layers_.traceOut(n, wx, wy, wz, rays, status);
}

uchar Camera::unproject(const Point2d& pixel, Vec3d& origin, Vec3d& direction) const
{
    Rays rays;
    uchar status = REFRACT_OK;
    unproject(1, &pixel.x, &pixel.y, rays, &status);
    origin = rays.origin(0, layers_.normal());
    direction = rays.direction(0);
    return status;
}

void Camera::projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                             const Columns& byPoint, const Columns& byParameters, uchar* status) const
{
    double dx[BLOCK], dy[BLOCK], dz[BLOCK], ratio[BLOCK], D[6*BLOCK];
    CV_DbgAssert(n <= BLOCK);
    const Columns byDirection = { D, 3, BLOCK };
    layers_.solveIn(n, x, y, z, NULL, dx, dy, dz, status, ratio);
    lens_->projectJacobian(n, dx, dy, dz, u, v, byDirection, byParameters, status);
    layers_.chain(2, n, x, y, z, dx, dy, dz, ratio, byDirection, byPoint, byParameters.from(lensCount()));
}

uchar Camera::projectJacobian(const Vec3d& X, Vec2d& pixel, double* dPoint, double* dParameters) const
{
    uchar status = REFRACT_OK;
    const Columns byPoint = { dPoint, 3, 1 }, byParameters = { dParameters, parameterCount(), 1 };
    projectJacobian(1, &X[0], &X[1], &X[2], &pixel[0], &pixel[1], byPoint, byParameters, &status);
    return status;
}

std::vector<double> Camera::parameters() const
{
    std::vector<double> p = lens_->parameters();
    const std::vector<double> w = windowParameters(window_);
    p.insert(p.end(), w.begin(), w.end());
    return p;
}

std::vector<String> Camera::parameterNames() const
{
    std::vector<String> names = lens_->parameterNames();
    const std::vector<String> ofWindow = windowParameterNames(layers_.at());
    names.insert(names.end(), ofWindow.begin(), ofWindow.end());
    return names;
}

void Camera::setParameters(const std::vector<double>& p)
{
    CV_Assert((int)p.size() == parameterCount());
    const double* w = p.data() + lensCount();
    setWindow(withParameters(window_, w));
    lens_ = lens_->withParameters(std::vector<double>(p.data(), w));
}

void Camera::setImageSize(Size size)
{
    if (size.width < 0 || size.height < 0 || (size.width == 0) != (size.height == 0))
        CV_Error_(Error::StsBadSize, ("size is %dx%d; it must be positive, or 0x0 where unknown", size.width, size.height));
    size_ = size;
}

void Camera::setWindow(const GlassWindow& window)
{
    layers_ = Layers(window);
    window_ = window;
}

Mat Camera::lensParameters() const
{
    std::vector<double> all = lens_->parameters();
    return Mat((int)all.size(), 1, CV_64F, all.data()).clone();     // OpenCV 5 makes a row of a std::vector
}

void Camera::setLensParameters(InputArray parameters)
{
    const std::vector<double> p = readNumbers(parameters, "parameters");
    if ((int)p.size() != lensCount())
        CV_Error_(Error::StsBadSize, ("parameters has %d values; %s has %d", (int)p.size(),
                                      lens_->model().c_str(), lensCount()));
    if (!(p[0] > 0) || !(p[1] > 0))
        CV_Error_(Error::StsBadArg, ("parameters has focal lengths (%g, %g); they must be positive", p[0], p[1]));
    lens_ = lens_->withParameters(p);
}

Camera& cameraOf(const Ptr<RefractiveCamera>& camera, const char* name)
{
    if (!camera)
        CV_Error_(Error::StsNullPtr, ("%s is empty; make one with RefractiveCamera::create", name));
    return static_cast<Camera&>(*camera);
}

RefractiveCamera::RefractiveCamera() {}
RefractiveCamera::RefractiveCamera(const RefractiveCamera&) {}
RefractiveCamera& RefractiveCamera::operator=(const RefractiveCamera&) { return *this; }
RefractiveCamera::~RefractiveCamera() {}

}} // namespace
