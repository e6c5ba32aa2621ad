// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/map.hpp"
#include "points/plane.hpp"

/* The camera matrix of the corrected image: as cv::getOptimalNewCameraMatrix, from where the borders of the raw image are in it. */

namespace cv { namespace refract {

namespace {

//! Where a pinhole at the centre of projection shows what the borders of a raw image see of a plane, at focal length 1.
class ShownBorders
{
public:
    ShownBorders(const Camera& camera, const Vec4d& plane, Size size)
    {
        const double right = size.width - 1, bottom = size.height - 1;
        addSide(camera, plane, Vec2d(0, 0), Vec2d(0, bottom));
        addSide(camera, plane, Vec2d(right, 0), Vec2d(right, bottom));
        addSide(camera, plane, Vec2d(0, 0), Vec2d(right, 0));
        addSide(camera, plane, Vec2d(0, bottom), Vec2d(right, bottom));
        for (const std::vector<Point2d>& side : sides_)
            if (side.empty())
                CV_Error_(Error::StsBadArg, ("no point of the plane on a border of the image can be shown by a pinhole camera; the lens is "
                                             "too wide, imageSize %dx%d is wrong, or depth is within the window", size.width,
                                             size.height));
    }

    //! Inside of all sides.
    Rect2d inner() const
    {
        return between(Point2d(end(sides_[0], false, true), end(sides_[2], true, true)),
                       Point2d(end(sides_[1], false, false), end(sides_[3], true, false)));
    }

    //! Round all sides.
    Rect2d outer() const
    {
        Point2d tl(DBL_MAX, DBL_MAX), br(-DBL_MAX, -DBL_MAX);
        for (const std::vector<Point2d>& side : sides_)
        {
            tl = Point2d(std::min(tl.x, end(side, false, false)), std::min(tl.y, end(side, true, false)));
            br = Point2d(std::max(br.x, end(side, false, true)), std::max(br.y, end(side, true, true)));
        }
        return between(tl, br);
    }

private:
    static Rect2d between(const Point2d& tl, const Point2d& br) { return Rect2d(tl.x, tl.y, br.x - tl.x, br.y - tl.y); }

    //! The largest or smallest x or y of a side.
    static double end(const std::vector<Point2d>& side, bool isY, bool isLargest)
    {
        const auto coordinate = [=](const Point2d& p) { return isY ? p.y : p.x; };
        double result = coordinate(side[0]);
        for (const Point2d& p : side)
            result = isLargest ? std::max(result, coordinate(p)) : std::min(result, coordinate(p));
        return result;
    }

    void addSide(const Camera& camera, const Vec4d& plane, const Vec2d& from, const Vec2d& to)
    {
        Rays rays;
        double u[BLOCK], v[BLOCK], x[BLOCK], y[BLOCK], z[BLOCK], planeD[BLOCK];
        uchar status[BLOCK];
        for (int i = 0; i < BLOCK; i++)
        {
            const Vec2d pixel = from + (to - from)*(i/(BLOCK - 1.));
            u[i] = pixel[0];
            v[i] = pixel[1];
        }
        std::fill(status, status + BLOCK, (uchar)REFRACT_OK);
        std::fill(planeD, planeD + BLOCK, plane[3]);
        camera.unproject(BLOCK, u, v, rays, status);
        meetPlane(camera.layers(), BLOCK, Vec3d(plane.val), planeD, rays, x, y, z, NULL, status);
        std::vector<Point2d> side;
        for (int i = 0; i < BLOCK; i++)
            if (status[i] == REFRACT_OK && z[i] > 0)
                side.push_back(Point2d(x[i]/z[i], y[i]/z[i]));
        sides_.push_back(side);
    }

    std::vector<std::vector<Point2d> > sides_;      //!< left, right, top, bottom
};

//! The pinhole that shows a rectangle (of focal length 1) in a whole image.
Matx33d showing(const Rect2d& r, Size size)
{
    const double fx = (size.width - 1)/r.width, fy = (size.height - 1)/r.height;
    return Matx33d(fx, 0, -fx*r.x, 0, fy, -fy*r.y, 0, 0, 1);
}

//! By how much K must grow, its principal point in the middle, until a rectangle covers the image or, if not, just fits.
double scaleTo(const Rect2d& r, const Matx33d& K, Size size, bool covers)
{
    const double x = 0.5*(size.width - 1)/K(0, 0), y = 0.5*(size.height - 1)/K(1, 1);
    const double ratios[] = { -x/r.x, -y/r.y, x/(r.x + r.width), y/(r.y + r.height) };
    return covers ? *std::max_element(ratios, ratios + 4) : *std::min_element(ratios, ratios + 4);
}

Matx33d optimal(const ShownBorders& borders, const Camera& camera, Size size, double alpha, bool isCentred)
{
    const Rect2d inner = borders.inner(), outer = borders.outer();
    Matx33d K = (1 - alpha)*showing(inner, size) + alpha*showing(outer, size);
    if (isCentred)
    {
        K = Matx33d(camera.cameraMatrix().ptr<double>());
        const double scale = (1 - alpha)*scaleTo(inner, K, size, true) + alpha*scaleTo(outer, K, size, false);
        K = Matx33d(scale*K(0, 0), 0, 0.5*(size.width - 1), 0, scale*K(1, 1), 0.5*(size.height - 1), 0, 0, 1);
    }
    if (!(K(0, 0) > 0 && K(1, 1) > 0 && std::isfinite(K(0, 0) + K(1, 1))))
        CV_Error_(Error::StsBadArg, ("alpha is %g: no focal length fits; the image of the plane does not contain the principal "
                                     "point, or is curved so much that it contains no rectangle", alpha));
    return K;
}

Rect validPixels(const Rect2d& inner, const Matx33d& K, Size size)
{
    const double NOT_BELOW = 1e-9;      // px; the border itself is valid, whatever was rounded
    const Point tl(cvCeil(K(0, 0)*inner.x + K(0, 2) - NOT_BELOW), cvCeil(K(1, 1)*inner.y + K(1, 2) - NOT_BELOW));
    const Point br(cvFloor(K(0, 0)*(inner.x + inner.width) + K(0, 2) + NOT_BELOW),
                   cvFloor(K(1, 1)*(inner.y + inner.height) + K(1, 2) + NOT_BELOW));
    return Rect(tl, br + Point(1, 1)) & Rect(Point(), size);
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
    if (isPlainOpenCV(camera))
        return getOptimalNewCameraMatrix(camera.cameraMatrix(), camera.distCoeffs(), imageSize, alpha, size, validPixROI,
                                         isCentred);
    const ShownBorders borders(camera, plane, imageSize);
    const Matx33d K = optimal(borders, camera, size, alpha, isCentred);
    if (validPixROI)
        *validPixROI = validPixels(borders.inner(), K, size);
    return Mat(K, true);
}

} // namespace

Mat getOptimalNewRefractiveCameraMatrix(const Ptr<RefractiveCamera>& camera, double depth, Size imageSize, double alpha,
                                        Size newImageSize, Rect* validPixROI, bool centerPrincipalPoint)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    return newCameraMatrix(cam, scenePlane(depth, cam.refracts(), "depth"), imageSize, alpha, newImageSize, validPixROI,
                           centerPrincipalPoint);
}

Mat getOptimalNewRefractiveCameraMatrix(const Ptr<RefractiveCamera>& camera, InputArray depth, Size imageSize, double alpha,
                                        Size newImageSize, Rect* validPixROI, bool centerPrincipalPoint)
{
    CV_INSTRUMENT_REGION();

    const Camera& cam = cameraOf(camera);
    return newCameraMatrix(cam, scenePlane(depth, cam.refracts(), "depth"), imageSize, alpha, newImageSize, validPixROI,
                           centerPrincipalPoint);
}

Mat getOptimalNewRefractiveCameraMatrix(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, double depth,
                                        Size imageSize, double alpha, Size newImageSize, Rect* validPixROI,
                                        bool centerPrincipalPoint)
{
    return getOptimalNewRefractiveCameraMatrix(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, imageSize, alpha,
                                               newImageSize, validPixROI, centerPrincipalPoint);
}

Mat getOptimalNewRefractiveCameraMatrix(InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window, InputArray depth,
                                        Size imageSize, double alpha, Size newImageSize, Rect* validPixROI,
                                        bool centerPrincipalPoint)
{
    return getOptimalNewRefractiveCameraMatrix(RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, imageSize, alpha,
                                               newImageSize, validPixROI, centerPrincipalPoint);
}

}} // namespace
