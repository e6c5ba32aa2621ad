// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "camera/camera.hpp"
#include "arrays/array_kernels.hpp"
#include "arrays/arrays.hpp"
#include "arrays/moderate.hpp"
#include "window/parameters.hpp"

namespace cv { namespace refract {

namespace {

/** Instead of points whose coordinates are extreme (moderate.hpp) others in the same directions, which are seen in the same
pixels: what is as far away as that is infinitely far for any window. Nearer, only windows without a length do not tell the two apart,
unless w says how far a point is. */
struct ModeratePoints
{
    //! @param w, areNear of which points too near are replaced, too
    ModeratePoints(int n, const double* x_, const double* y_, const double* z_, const double* w_, bool areNear)
    {
        const int HALF = 100;           // of the exponent of MODERATE
        for (int i = 0; i < n; i++)
        {
            const double sum = std::abs(x_[i]) + std::abs(y_[i]) + std::abs(z_[i]);
            const double largest = std::max(std::abs(x_[i]), std::max(std::abs(y_[i]), std::abs(z_[i])));
            const bool isFar = sum > MODERATE && std::isfinite(largest), isNear = sum < 1/MODERATE && largest > 0 && (w_ || areNear);
            factor[i] = isFar ? std::scalbn(1., HALF - std::ilogb(largest)) : isNear ? std::scalbn(1., -HALF - std::ilogb(largest)) : 1;
            x[i] = factor[i]*x_[i];
            y[i] = factor[i]*y_[i];
            z[i] = factor[i]*z_[i];
            w[i] = w_ ? factor[i]*w_[i] : 1;
        }
    }
    double x[BLOCK], y[BLOCK], z[BLOCK], w[BLOCK], factor[BLOCK];
};

//! All lengths of a scene may be multiplied, and no pixel moves.
bool hasNoLength(const Layers& layers)
{
    return !layers.refracts() || (layers.lastSurface().distance == 0 && layers.lastSurface().curvature == 0);
}

} // namespace

Camera::Camera(const Ptr<Lens>& lens, const GlassWindow& window) : lens_(lens), window_(window), layers_(window) {}

void Camera::project(int n, const double* x, const double* y, const double* z, const double* w,
                     double* u, double* v, uchar* status) const
{
    CV_DbgAssert(n <= BLOCK);
    if (arrayKernels().areModerate(n, x, y, z))
        return projectModerate(n, x, y, z, w, u, v, status);
    const ModeratePoints p(n, x, y, z, w, hasNoLength(layers_));
    projectModerate(n, p.x, p.y, p.z, w ? p.w : NULL, u, v, status);
}

void Camera::projectModerate(int n, const double* x, const double* y, const double* z, const double* w,
                             double* u, double* v, uchar* status) const
{
    double dx[BLOCK], dy[BLOCK], dz[BLOCK];
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
    CV_DbgAssert(n <= BLOCK);
    if (arrayKernels().areModerate(n, x, y, z))
        return projectModerateJacobian(n, x, y, z, u, v, byPoint, byParameters, status);
    const ModeratePoints p(n, x, y, z, NULL, hasNoLength(layers_));
    projectModerateJacobian(n, p.x, p.y, p.z, u, v, byPoint, byParameters, status);
    for (int row = 0; row < 2; row++)
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < n; i++)
                byPoint.at(row, c)[i] *= p.factor[i];
}

void Camera::projectModerateJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                                     const Columns& byPoint, const Columns& byParameters, uchar* status) const
{
    double dx[BLOCK], dy[BLOCK], dz[BLOCK], ratio[BLOCK], D[6*BLOCK];
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
