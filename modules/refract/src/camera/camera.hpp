// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CAMERA_HPP
#define OPENCV_REFRACT_CAMERA_HPP

#include "window/layers.hpp"
#include "lens/lens.hpp"

namespace cv { namespace refract {

/* Lens + window: the only place where the two meet. The arrows of the data flow:

    pixel --lens--> direction --window--> ray          unproject
    point --window--> direction --lens--> pixel        project, projectJacobian

Lanes with status != REFRACT_OK keep it; their results are not meaningful until the writer turns them to NaN. */
class Camera : public RefractiveCamera
{
public:
    Camera(const Ptr<Lens>& lens, const GlassWindow& window);

    //! Homogeneous camera-frame points (w null: 1; w = 0: infinitely far) -> pixels.
    void project(int n, const double* x, const double* y, const double* z, const double* w,
                 double* u, double* v, uchar* status) const;
    //! The same of points none of which is extreme (moderate.hpp).
    void projectModerate(int n, const double* x, const double* y, const double* z, const double* w,
                         double* u, double* v, uchar* status) const;

    //! Pixels -> rays, at most a block.
    void unproject(int n, const double* u, const double* v, Rays& rays, uchar* status) const;
    //! One pixel; what it gives means nothing where the status is not REFRACT_OK.
    uchar unproject(const Point2d& pixel, Vec3d& origin, Vec3d& direction) const;

    //! Number of lens parameters, of window parameters, and both: the columns of dPixel_dParameters.
    int lensCount() const { return lens_->parameterCount(); }
    int windowCount() const { return layers_.at().count; }
    int parameterCount() const { return lensCount() + windowCount(); }

    /** Finite camera-frame points, at most a block. byPoint 2x3, byParameters 2 x parameterCount(), which may be null. Where
    there is no answer the derivatives mean nothing. */
    void projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                         const Columns& byPoint, const Columns& byParameters, uchar* status) const;

    /** One finite camera-frame point. dPixel_dPoint 2x3, dPixel_dParameters 2 x parameterCount(), row-major; the latter
    may be null. */
    uchar projectJacobian(const Vec3d& point, Vec2d& pixel,
                          double* dPixel_dPoint, double* dPixel_dParameters) const;

    //! False: no window, so that the depth of what is seen plays no part.
    bool refracts() const { return !window_.thickness.empty() || window_.innerIndex != window_.outerIndex; }
    const Lens& lens() const { return *lens_; }
    const Layers& layers() const { return layers_; }
    //! All parameters, in the order of the columns of dPixel_dParameters; setParameters normalises the normal.
    std::vector<double> parameters() const;
    void setParameters(const std::vector<double>& parameters);

    // RefractiveCamera
    Ptr<RefractiveCamera> clone() const CV_OVERRIDE { return makePtr<Camera>(*this); }
    void write(FileStorage& fs) const CV_OVERRIDE;
    Mat cameraMatrix() const CV_OVERRIDE { return lens_->cameraMatrix(); }
    Mat distCoeffs() const CV_OVERRIDE { return lens_->distCoeffs(); }
    String lensModel() const CV_OVERRIDE { return lens_->model(); }
    GlassWindow window() const CV_OVERRIDE { return window_; }
    std::vector<String> parameterNames() const CV_OVERRIDE;
    void setWindow(const GlassWindow& window) CV_OVERRIDE;
    Mat lensParameters() const CV_OVERRIDE;
    void setLensParameters(InputArray parameters) CV_OVERRIDE;
    Size imageSize() const CV_OVERRIDE { return size_; }
    void setImageSize(Size size) CV_OVERRIDE;

private:
    void projectModerateJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                                 const Columns& byPoint, const Columns& byParameters, uchar* status) const;

    Ptr<Lens> lens_;
    GlassWindow window_;
    Layers layers_;
    Size size_;
};

//! The lens of a name and its arrays, which a file calls otherwise than a call does.
Ptr<Lens> readLens(const String& model, InputArray cameraMatrix, InputArray distCoeffs,
                   const char* nameOfMatrix = "cameraMatrix", const char* nameOfCoefficients = "distCoeffs");

//! The implementation behind the public handle, which nobody else derives from; throws if it is empty, naming the argument.
Camera& cameraOf(const Ptr<RefractiveCamera>& camera, const char* name = "camera");

}} // namespace

#endif // OPENCV_REFRACT_CAMERA_HPP
