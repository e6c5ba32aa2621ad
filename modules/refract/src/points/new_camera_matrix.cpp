// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/shown_region.hpp"

/* The camera matrix of the corrected image: as cv::getOptimalNewCameraMatrix, from what of a plane the raw image shows. Also without
a window: calib3d asks for 9x9 places and takes lenses beyond their fold (doc/upstream.md). */

namespace cv { namespace refract {

namespace {

//! The pinhole that shows a rectangle (of focal length 1) in a whole image.
Matx33d showing(const Rect2d& r, Size size)
{
    const double fx = (size.width - 1)/r.width, fy = (size.height - 1)/r.height;
    return Matx33d(fx, 0, -fx*r.x, 0, fy, -fy*r.y, 0, 0, 1);
}

Vec2d focalOf(const Matx33d& K) { return Vec2d(K(0, 0), K(1, 1)); }

//! inner: all of it is shown; outer: round all that is shown.
Matx33d optimal(const Rect2d& inner, const Rect2d& outer, const Camera& camera, Size size, double alpha, bool isCentred)
{
    Matx33d K = (1 - alpha)*showing(inner, size) + alpha*showing(outer, size);
    if (isCentred)
    {
        const Point2d middle(0.5*(size.width - 1), 0.5*(size.height - 1));
        K = Matx33d(camera.cameraMatrix().ptr<double>());
        const double covers = alpha < 1 ? scaleToImage(inner, focalOf(K), middle, size, true) : 0;
        const double fits = alpha > 0 ? scaleToImage(outer, focalOf(K), middle, size, false) : 0;
        const double scale = (1 - alpha)*covers + alpha*fits;
        K = Matx33d(scale*K(0, 0), 0, middle.x, 0, scale*K(1, 1), middle.y, 0, 0, 1);
    }
    if (!(K(0, 0) > 0 && K(1, 1) > 0 && std::isfinite(K(0, 0) + K(1, 1))))
        CV_Error_(Error::StsBadArg, ("alpha is %g: no focal length fits; the image of the plane does not contain the principal "
                                     "point", alpha));
    return K;
}

Mat newCameraMatrix(const Camera& camera, const Vec4d& plane, Size imageSize, double alpha, Size newImageSize, Rect* validPixROI,
                    bool isCentred)
{
    if (imageSize.width < 2 || imageSize.height < 2)
        CV_Error_(Error::StsBadSize, ("imageSize is %dx%d; it must be at least 2x2", imageSize.width, imageSize.height));
    const Size size = newImageSize == Size() ? imageSize : newImageSize;
    if (size.width < 2 || size.height < 2)
        CV_Error_(Error::StsBadSize, ("newImageSize is %dx%d; it must be at least 2x2", size.width, size.height));
    if (!(alpha >= 0 && alpha <= 1))
        CV_Error_(Error::StsOutOfRange, ("alpha is %g; it must be between 0 and 1", alpha));
    const ShownRegion region({ camera, Matx33d::eye(), Vec3d(), plane }, imageSize);
    Rect2d inner;
    if (!region.findInner(size, inner))
        CV_Error_(Error::StsBadArg, ("no point of the plane on a border of the image can be shown by a pinhole camera; the lens is "
                                     "too wide, imageSize %dx%d is wrong, or depth is within the window", imageSize.width,
                                     imageSize.height));
    Rect2d outer = inner;
    if (alpha > 0 && !region.findOuter(outer))
        CV_Error_(Error::StsBadArg, ("alpha is %g; it must be 0: raw pixels are 89 degrees or more from the axis of the new image, and "
                                     "no pinhole camera shows them all", alpha));
    const Matx33d K = optimal(inner, outer, camera, size, alpha, isCentred);
    if (validPixROI)
        *validPixROI = pixelsWithin(inner, focalOf(K), Point2d(K(0, 2), K(1, 2)), size);
    return Mat(K, true);
}

} // namespace

Mat getOptimalNewRefractiveCameraMatrix(const Ptr<RefractiveCamera>& camera, InputArray depth, Size imageSize, double alpha,
                                        Size newImageSize, Rect* validPixROI, bool centerPrincipalPoint)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    return newCameraMatrix(cam, scenePlane(depth, cam.refracts(), "depth"), imageSize, alpha, newImageSize, validPixROI,
                           centerPrincipalPoint);
}

Mat getOptimalNewRefractiveCameraMatrix(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, InputArray depth,
                                        Size imageSize, double alpha, Size newImageSize, Rect* validPixROI,
                                        bool centerPrincipalPoint)
{
    return getOptimalNewRefractiveCameraMatrix(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, imageSize, alpha,
                                               newImageSize, validPixROI, centerPrincipalPoint);
}

}} // namespace
