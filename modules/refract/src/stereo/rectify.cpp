// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/virtual_centres.hpp"
#include "points/shown_region.hpp"

/* As cv::stereoRectify, for pinholes at virtual centres. Two cameras without windows whose lens it knows are its own case, as far as
its answer is one: it takes lenses beyond their fold, and points behind the new cameras as if they were in front. */

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

//! Where a pinhole shows what the middle of a raw image sees on the plane z = depth of the rectified frame, at focal length 1.
Point2d middleOf(const Camera& camera, Size imageSize, const Matx33d& R, const Vec3d& T, const Vec3d& centre, double depth, int number)
{
    Vec3d from, d;
    const uchar status = camera.unproject(Point2d((imageSize.width - 1)/2., (imageSize.height - 1)/2.), from, d);
    const Vec3d origin = R*(from - T), direction = R*d;
    const double s = (depth - origin[2])/direction[2];
    if (status != REFRACT_OK || !(direction[2] > 0 && s > 0))
        CV_Error_(Error::StsBadArg, ("R, T: camera%d looks along the baseline, or away from the scene", number));
    const Vec3d X = origin + s*direction - centre;
    return Point2d(X[0]/X[2], X[1]/X[2]);
}

//! What both raw images show in the new ones, at focal length 1.
struct NewImages
{
    Point2d middle[2];
    ShownRegion regions[2];

    NewImages(const StereoPair& pair, const VirtualPair& v, Size imageSize, double depth)
        : middle{ middleOf(pair.camera1, imageSize, v.R1, Vec3d(), v.centre1, depth, 1),
                  middleOf(pair.camera2, imageSize, v.R2, pair.T, v.centre2, depth, 2) },
          regions{ { rectifiedView(pair.camera1, v.R1, Vec3d(), v.centre1, depth), imageSize },
                   { rectifiedView(pair.camera2, v.R2, pair.T, v.centre2, depth), imageSize } }
    {}

private:
    static PinholeView rectifiedView(const Camera& camera, const Matx33d& R, const Vec3d& T, const Vec3d& centre, double depth)
    {
        const Vec3d normal = R.t()*Vec3d(0, 0, 1);
        return { camera, R.t(), R.t()*centre + T, Vec4d(normal[0], normal[1], normal[2], depth + normal.dot(T)) };
    }
};

//! By which a focal length does what alpha says. @param shown in the middle of each new image, at focal length 1
double scaleOf(const NewImages& images, const Point2d* shown, double focal, const RectifyOptions& options)
{
    const Size size = options.newImageSize;
    const Point2d centre((size.width - 1)/2., (size.height - 1)/2.);
    const double alpha = std::min(options.alpha, 1.);
    double most = 0, least = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 2; c++)
    {
        const ShownRegion& region = images.regions[c];
        Rect2d inner, outer;
        if (!region.findInner(size, inner))
            CV_Error_(Error::StsBadArg, ("alpha is %g: no point on a border of the image of camera%d can be shown by a pinhole "
                                         "camera; its lens is too wide, or imageSize %dx%d is wrong. Use a negative alpha",
                                         options.alpha, c + 1, options.imageSize.width, options.imageSize.height));
        if (alpha > 0 && !region.findOuter(outer))
            CV_Error_(Error::StsBadArg, ("alpha is %g: pixels of camera%d are 89 degrees or more from the axis of its new image, and "
                                         "no pinhole camera shows them all. Use alpha 0 or a negative one", options.alpha, c + 1));
        const double covers = alpha < 1 ? scaleToImage(inner - shown[c], Vec2d::all(focal), centre, size, true) : 0;
        const double fits = alpha > 0 ? scaleToImage(outer - shown[c], Vec2d::all(focal), centre, size, false) : 0;
        if (!(std::isfinite(covers) && std::isfinite(fits)))
            CV_Error_(Error::StsBadArg, ("alpha is %g: no focal length fits, as the middle of new image %d is outside what camera%d sees: "
                                         "the cameras look in too different directions%s", options.alpha, c + 1, c + 1,
                                         options.flags & RECTIFY_ZERO_DISPARITY ? "; with flags 0 each image has its own" : ""));
        most = std::max(most, covers);
        least = std::min(least, fits);
    }
    return most*(1 - alpha) + (alpha > 0 ? least*alpha : 0);
}

NewCameras place(const StereoPair& pair, const VirtualPair& v, const NewImages& images, const RectifyOptions& options)
{
    const int row = 1 - v.axis;
    const Size size = options.newImageSize;
    const double ratio = row == 1 ? (double)size.height/options.imageSize.height : (double)size.width/options.imageSize.width;
    NewCameras result = { 0, { Point2d(), Point2d() } };
    for (const Camera* camera : { &pair.camera1, &pair.camera2 })   // straight ahead as large as in the raw images
        result.focal += 0.5*ratio*camera->cameraMatrix().at<double>(row, row)*paraxialMagnification(*camera);
    const Point2d mean = 0.5*(images.middle[0] + images.middle[1]), centre((size.width - 1)/2., (size.height - 1)/2.);
    Point2d shown[2];           // in the middle of each new image, at focal length 1
    for (int c = 0; c < 2; c++)
        shown[c] = Point2d(v.axis == 0 && !(options.flags & RECTIFY_ZERO_DISPARITY) ? images.middle[c].x : mean.x,
                           v.axis == 1 && !(options.flags & RECTIFY_ZERO_DISPARITY) ? images.middle[c].y : mean.y);
    if (options.alpha >= 0)
        result.focal *= scaleOf(images, shown, result.focal, options);
    for (int c = 0; c < 2; c++)
        result.principal[c] = centre - result.focal*shown[c];
    return result;
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

//! What refractiveStereoRectify returns.
struct Rectification
{
    Mat R1, R2, P[2], Q;
    Rect roi[2];
};

Rectification rectifyVirtual(const StereoPair& pair, const VirtualPair& v, const NewImages& images, const RectifyOptions& options,
                             bool wantsRois)
{
    const NewCameras cameras = place(pair, v, images, options);
    Rectification result = { Mat(v.R1, true), Mat(v.R2, true), { projectionMatrix(cameras.focal, cameras.principal[0], v.centre1),
                             projectionMatrix(cameras.focal, cameras.principal[1], v.centre2) }, disparityToPoint(cameras, v), {} };
    Rect2d inner;
    for (int c = 0; c < 2 && wantsRois; c++)
        if (images.regions[c].findInner(options.newImageSize, inner))
            result.roi[c] = pixelsWithin(inner, Vec2d::all(cameras.focal), cameras.principal[c], options.newImageSize);
    return result;
}

//! calib3d's own answer; false if it is none: it shows something else than alpha says, or a border of a raw image is behind.
bool rectifyPlain(const StereoPair& pair, const NewImages& images, const RectifyOptions& options, Rectification& result)
{
    const double SLACK = 0.01;      // of the image; calib3d looks at 9x9 places
    const Size size = options.newImageSize;
    const Camera* const cameras[] = { &pair.camera1, &pair.camera2 };
    if (!images.regions[0].hasWholeBorder() || !images.regions[1].hasWholeBorder())
        return false;
    stereoRectify(cameras[0]->cameraMatrix(), cameras[0]->distCoeffs(), cameras[1]->cameraMatrix(), cameras[1]->distCoeffs(),
                  options.imageSize, pair.R, pair.T, result.R1, result.R2, result.P[0], result.P[1], result.Q, options.flags,
                  options.alpha, size, &result.roi[0], &result.roi[1]);
    for (int c = 0; c < 2; c++)
    {
        const double focal = result.P[c].at<double>(0, 0), slack = SLACK*std::max(size.width, size.height)/focal;
        const Point2d principal(result.P[c].at<double>(0, 2), result.P[c].at<double>(1, 2));
        const auto placesOf = [&](const Rect& pixels)
        { return Rect2d((pixels.x - principal.x)/focal, (pixels.y - principal.y)/focal, (pixels.width - 1)/focal,
                        (pixels.height - 1)/focal); };
        const auto isWithin = [&](const Rect2d& r, const Rect2d& in)
        { return r.x > in.x - slack && r.y > in.y - slack && r.br().x < in.br().x + slack && r.br().y < in.br().y + slack; };
        const Rect2d whole = placesOf(Rect(Point(), size));
        Rect2d inner, outer;
        if (!(focal > 0) || !images.regions[c].findInner(size, inner) ||
            (options.alpha == 0 && !isWithin(whole, inner)) ||
            (!result.roi[c].empty() && !isWithin(placesOf(result.roi[c]), inner)) ||
            (options.alpha >= 1 && !(images.regions[c].findOuter(outer) && isWithin(outer, whole))))
            return false;
    }
    return true;
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
    const NewImages images(pair, v, imageSize, depth);
    Rectification result;
    const bool arePlain = isPlainOpenCV(pair.camera1) && isPlainOpenCV(pair.camera2);
    if (!arePlain || !rectifyPlain(pair, images, options, result))
        result = rectifyVirtual(pair, v, images, options, validPixROI1 || validPixROI2);
    result.R1.copyTo(R1);
    result.R2.copyTo(R2);
    result.P[0].copyTo(P1);
    result.P[1].copyTo(P2);
    if (Q.needed())
        result.Q.copyTo(Q);
    Rect* const rois[] = { validPixROI1, validPixROI2 };
    for (int c = 0; c < 2; c++)
        if (rois[c])
            *rois[c] = result.roi[c];
    const double focal = result.P[0].at<double>(0, 0);
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
