// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/virtual_centres.hpp"
#include "points/map.hpp"

/* As cv::stereoRectify, for pinholes at virtual centres. Two cameras without windows whose lens it knows are its own case. */

namespace cv { namespace refract {

namespace {

//! What the caller of refractiveStereoRectify wants of the new images.
struct RectifyOptions
{
    Size imageSize, newImageSize;
    int flags;
    double alpha;
};

//! The intrinsic part of the new images: one focal length, a principal point each.
struct NewCameras
{
    double focal;
    Point2d principal[2];
};

//! The pixels of a raw image's border, COUNT a side.
struct Border
{
    enum { COUNT = 9 };
    explicit Border(Size size)
    {
        for (int k = 0; k < COUNT; k++)
        {
            const double x = (size.width - 1)*k/(COUNT - 1.), y = (size.height - 1)*k/(COUNT - 1.);
            sides[0].push_back(Point2d(0, y));
            sides[1].push_back(Point2d(size.width - 1, y));
            sides[2].push_back(Point2d(x, 0));
            sides[3].push_back(Point2d(x, size.height - 1));
        }
    }
    std::vector<Point2d> sides[4];      //!< left, right, top, bottom
};

//! Where a pinhole shows what a camera's pixels see on the plane z = depth of the rectified frame, at focal length 1.
std::vector<Point2d> normalized(const Camera& camera, const std::vector<Point2d>& pixels, const Matx33d& R, const Vec3d& T,
                                const Vec3d& centre, double depth)
{
    std::vector<Point2d> result;
    for (const Point2d& pixel : pixels)
    {
        Vec3d from, d;
        const uchar status = camera.unproject(pixel, from, d);
        const Vec3d origin = R*(from - T), direction = R*d;
        const double s = (depth - origin[2])/direction[2];
        if (status != REFRACT_OK || !(direction[2] > 0 && s > 0))
            continue;
        const Vec3d X = origin + s*direction - centre;
        result.push_back(Point2d(X[0]/X[2], X[1]/X[2]));
    }
    return result;
}

//! The borders and middles of both raw images in the new ones, at focal length 1.
struct NewBorders
{
    Point2d middle[2];

    NewBorders(const StereoPair& pair, const VirtualPair& v, Size imageSize, double depth)
    {
        const Border border(imageSize);
        const std::vector<Point2d> centre = { Point2d((imageSize.width - 1)/2., (imageSize.height - 1)/2.) };
        for (int c = 0; c < 2; c++)
        {
            const auto shown = [&](const std::vector<Point2d>& pixels)
            { return c == 0 ? normalized(pair.camera1, pixels, v.R1, Vec3d(), v.centre1, depth)
                            : normalized(pair.camera2, pixels, v.R2, pair.T, v.centre2, depth); };
            const std::vector<Point2d> found = shown(centre);
            if (found.empty())
                CV_Error_(Error::StsBadArg, ("R, T: camera%d looks along the baseline, or away from the scene", c + 1));
            middle[c] = found[0];
            for (int i = 0; i < 4; i++)
                sides[c][i] = shown(border.sides[i]);
        }
    }

    //! False: no point on a side can be shown by a pinhole camera.
    bool isComplete(int c) const
    { return std::none_of(sides[c], sides[c] + 4, [](const std::vector<Point2d>& side) { return side.empty(); }); }

    //! Inside of all sides.
    Rect2d inner(int c) const
    {
        const Point2d tl(most(c, 0, true, 1), most(c, 2, false, 1)), br(most(c, 1, true, -1), most(c, 3, false, -1));
        return Rect2d(tl.x, tl.y, br.x - tl.x, br.y - tl.y);
    }

    //! Round all sides.
    Rect2d outer(int c) const
    {
        Point2d tl(DBL_MAX, DBL_MAX), br(-DBL_MAX, -DBL_MAX);
        for (const std::vector<Point2d>& side : sides[c])
            for (const Point2d& p : side)
            {
                tl = Point2d(std::min(tl.x, p.x), std::min(tl.y, p.y));
                br = Point2d(std::max(br.x, p.x), std::max(br.y, p.y));
            }
        return Rect2d(tl.x, tl.y, br.x - tl.x, br.y - tl.y);
    }

private:
    double most(int c, int side, bool isX, int sign) const
    {
        double result = -DBL_MAX;
        for (const Point2d& p : sides[c][side])
            result = std::max(result, sign*(isX ? p.x : p.y));
        return sign*result;
    }

    std::vector<Point2d> sides[2][4];
};

//! By which a rectangle (focal length 1) round the principal point must grow until it covers the image or, if not, just fits.
double scaleTo(const Rect2d& r, double focal, const Point2d& principal, Size size, bool covers)
{
    const double ratios[] = { -principal.x/(focal*r.x), -principal.y/(focal*r.y),
                              (size.width - 1 - principal.x)/(focal*(r.x + r.width)),
                              (size.height - 1 - principal.y)/(focal*(r.y + r.height)) };
    return covers ? *std::max_element(ratios, ratios + 4) : *std::min_element(ratios, ratios + 4);
}

NewCameras place(const StereoPair& pair, const VirtualPair& v, const NewBorders& borders, const RectifyOptions& options)
{
    const int row = 1 - v.axis;
    const Size size = options.newImageSize;
    const double ratio = row == 1 ? (double)size.height/options.imageSize.height : (double)size.width/options.imageSize.width;
    NewCameras result = { 0, { Point2d(), Point2d() } };
    for (const Camera* camera : { &pair.camera1, &pair.camera2 })   // straight ahead as large as in the raw images
        result.focal += 0.5*ratio*camera->cameraMatrix().at<double>(row, row)*paraxialMagnification(*camera);
    Point2d* p = result.principal;
    for (int c = 0; c < 2; c++)
        p[c] = Point2d((size.width - 1)/2., (size.height - 1)/2.) - result.focal*borders.middle[c];     // stays in the middle
    const Point2d mean = 0.5*(p[0] + p[1]);
    for (int c = 0; c < 2; c++)
        p[c] = Point2d(v.axis == 0 && !(options.flags & RECTIFY_ZERO_DISPARITY) ? p[c].x : mean.x,
                       v.axis == 1 && !(options.flags & RECTIFY_ZERO_DISPARITY) ? p[c].y : mean.y);
    if (options.alpha >= 0)
    {
        double covers = 0, fits = DBL_MAX;
        for (int c = 0; c < 2; c++)
        {
            if (!borders.isComplete(c))
                CV_Error_(Error::StsBadArg, ("alpha is %g: no point on a border of the image of camera%d can be shown by a pinhole "
                                             "camera; its lens is too wide, or imageSize %dx%d is wrong. Use a negative alpha",
                                             options.alpha, c + 1, options.imageSize.width, options.imageSize.height));
            covers = std::max(covers, scaleTo(borders.inner(c), result.focal, p[c], size, true));
            fits = std::min(fits, scaleTo(borders.outer(c), result.focal, p[c], size, false));
        }
        const double alpha = std::min(options.alpha, 1.), scale = covers*(1 - alpha) + fits*alpha;
        if (!(scale > 0 && std::isfinite(scale)))
            CV_Error_(Error::StsBadArg, ("alpha is %g: no focal length fits, as a principal point, (%g, %g) or (%g, %g), is outside "
                                         "the images; with flags 0 each image has its own", options.alpha, p[0].x, p[0].y,
                                         p[1].x, p[1].y));
        result.focal *= scale;
    }
    return result;
}

Rect validPixels(const Rect2d& inner, double focal, const Point2d& principal, Size size)
{
    const Rect r(cvCeil(focal*inner.x + principal.x), cvCeil(focal*inner.y + principal.y), cvFloor(focal*inner.width),
                 cvFloor(focal*inner.height));
    return r & Rect(Point(), size);
}

Mat projectionMatrix(double focal, const Point2d& principal, const Vec3d& centre)
{
    const Matx33d K(focal, 0, principal.x, 0, focal, principal.y, 0, 0, 1);
    Mat P(3, 4, CV_64F);
    Mat(K).copyTo(P.colRange(0, 3));
    Mat(-(K*centre)).copyTo(P.col(3));
    return P;
}

//! (x, y, disparity, 1) -> rectified frame, homogeneous.
Mat disparityToPoint(const NewCameras& n, const VirtualPair& v)
{
    const double base = v.centre2[v.axis] - v.centre1[v.axis];
    const Point2d shift = n.principal[0] - n.principal[1];
    const Vec4d w(0, 0, 1/base, -(v.axis == 0 ? shift.x : shift.y)/base);
    Mat Q = (Mat_<double>(4, 4) << 1, 0, 0, -n.principal[0].x, 0, 1, 0, -n.principal[0].y, 0, 0, 0, n.focal, 0, 0, 0, 0);
    for (int c = 0; c < 4; c++)
    {
        for (int r = 0; r < 3; r++)
            Q.at<double>(r, c) += v.centre1[r]*w[c];
        Q.at<double>(3, c) = w[c];
    }
    return Q;
}

Size checkedSize(Size size, const char* name)
{
    if (size.width < 1 || size.height < 1)
        CV_Error_(Error::StsBadSize, ("%s is %dx%d; it must not be empty", name, size.width, size.height));
    return size;
}

//! RMS and the largest, in pixels.
Vec2d sizeOf(const std::vector<double>& differences, double focal)
{
    double sum = 0, most = 0;
    int count = 0;
    for (double e : differences)
        if (!std::isnan(e))
        {
            sum += e*e;
            most = std::max(most, std::abs(e));
            count++;
        }
    return focal*Vec2d(std::sqrt(sum/count), most);
}

} // namespace

Vec2d refractiveStereoRectify(const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                              InputArray R, InputArray T, Size imageSize, const Vec2d& depthRange,
                              OutputArray R1, OutputArray R2, OutputArray P1, OutputArray P2, OutputArray Q,
                              int flags, double alpha, Size newImageSize, Rect* validPixROI1, Rect* validPixROI2)
{
    CV_INSTRUMENT_REGION();

    const StereoPair pair(cameraOf(camera1, "camera1"), cameraOf(camera2, "camera2"), R, T);
    checkedSize(imageSize, "imageSize");
    const Vec2d range = readDepthRange(depthRange, false);
    if (flags & ~RECTIFY_ZERO_DISPARITY)
        CV_Error_(Error::StsBadFlag, ("flags is %d; it must be RECTIFY_ZERO_DISPARITY or 0", flags));
    if (std::isnan(alpha))
        CV_Error(Error::StsBadArg, "alpha is nan; it must be a number");
    const RectifyOptions options = { imageSize, newImageSize == Size() ? imageSize : checkedSize(newImageSize, "newImageSize"), flags,
                                     alpha };
    const RowSamples samples(pair, imageSize, range);
    const double depth = 2/(1/range[0] + 1/range[1]);     // the middle of the disparities
    const VirtualPair v(pair, bestVirtualCentres(pair, samples, depth));
    double focal;
    if (isPlainOpenCV(pair.camera1) && isPlainOpenCV(pair.camera2))
    {
        Mat p1;
        stereoRectify(camera1->cameraMatrix(), camera1->distCoeffs(), camera2->cameraMatrix(), camera2->distCoeffs(), imageSize,
                      pair.R, pair.T, R1, R2, p1, P2, Q, flags, alpha, newImageSize, validPixROI1, validPixROI2);
        focal = p1.at<double>(0, 0);
        p1.copyTo(P1);
    }
    else
    {
        const NewBorders borders(pair, v, imageSize, depth);
        const NewCameras cameras = place(pair, v, borders, options);
        focal = cameras.focal;
        Mat(v.R1).copyTo(R1);
        Mat(v.R2).copyTo(R2);
        projectionMatrix(focal, cameras.principal[0], v.centre1).copyTo(P1);
        projectionMatrix(focal, cameras.principal[1], v.centre2).copyTo(P2);
        if (Q.needed())
            disparityToPoint(cameras, v).copyTo(Q);
        Rect* const rois[] = { validPixROI1, validPixROI2 };
        for (int c = 0; c < 2; c++)
            if (rois[c])
                *rois[c] = borders.isComplete(c) ? validPixels(borders.inner(c), focal, cameras.principal[c], options.newImageSize)
                                                 : Rect();
    }
    return sizeOf(samples.differences(v, depth), focal);
}

Vec2d refractiveStereoRectify(InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
                              InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
                              InputArray R, InputArray T, Size imageSize, const Vec2d& depthRange,
                              OutputArray R1, OutputArray R2, OutputArray P1, OutputArray P2, OutputArray Q,
                              int flags, double alpha, Size newImageSize, Rect* validPixROI1, Rect* validPixROI2)
{
    return refractiveStereoRectify(RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                                   RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2), R, T, imageSize, depthRange,
                                   R1, R2, P1, P2, Q, flags, alpha, newImageSize, validPixROI1, validPixROI2);
}

}} // namespace
