// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "opencv2/imgproc.hpp"
#include <climits>

/* What calib3d does with images: one corrected, and the axes of a frame drawn into one. */

namespace cv { namespace refract {

namespace {

//! cv::remap counts pixels in 16 bits.
bool isLarge(Size size) { return std::max(size.width, size.height) >= SHRT_MAX; }

//! A part of the corrected image, from the part of the raw one that it shows; in smaller parts where that is too large.
void undistortPart(const Mat& image, Mat& corrected, const Ptr<RefractiveCamera>& camera, InputArray depth, const Matx33d& newK,
                   const Rect& part)
{
    const Matx33d toPart(1, 0, -part.x, 0, 1, -part.y, 0, 0, 1);
    Mat map1, map2;
    initRefractiveUndistortRectifyMap(camera, depth, noArray(), toPart*newK, part.size(), CV_32FC2, map1, map2);
    const int NEIGHBOURS = 2;       // of a pixel that remap looks at, and what float32 rounds
    const Vec2f NONE(-1, -1);
    Rect seen;
    for (const Vec2f& p : Mat_<Vec2f>(map1))
        if (p != NONE && p[0] > -NEIGHBOURS && p[1] > -NEIGHBOURS && p[0] < image.cols + NEIGHBOURS && p[1] < image.rows + NEIGHBOURS)
            seen |= Rect(cvFloor(p[0]) - NEIGHBOURS, cvFloor(p[1]) - NEIGHBOURS, 2*NEIGHBOURS + 1, 2*NEIGHBOURS + 1);
    seen &= Rect(Point(), image.size());
    if (seen.empty())
        return;
    if (isLarge(seen.size()))
    {
        const bool isWide = part.width >= part.height;
        const int half = (isWide ? part.width : part.height)/2;
        Rect first = part, second = part;
        (isWide ? first.width : first.height) = half;
        (isWide ? second.x : second.y) += half;
        (isWide ? second.width : second.height) -= half;
        undistortPart(image, corrected, camera, depth, newK, first);
        undistortPart(image, corrected, camera, depth, newK, second);
        return;
    }
    const Ptr<RefractiveCamera> cropped = camera->clone();
    Mat lens = cropped->lensParameters();
    lens.at<double>(2) -= seen.x;
    lens.at<double>(3) -= seen.y;
    cropped->setLensParameters(lens);
    cropped->setImageSize(seen.size());
    initRefractiveUndistortRectifyMap(cropped, depth, noArray(), toPart*newK, part.size(), CV_16SC2, map1, map2);
    Mat result = corrected(part);
    remap(image(seen), result, map1, map2, INTER_LINEAR, BORDER_CONSTANT);
}

} // namespace

void refractiveUndistortImage(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, InputArray depth,
                              InputArray newCameraMatrix)
{
    CV_INSTRUMENT_REGION();

    const Mat image = src.getMat();
    Mat corrected;      // not dst, which may be src
    if (image.empty())
    {
        dst.release();
        return;
    }
    if (image.dims > 2)
        CV_Error_(Error::StsBadSize, ("src has %d dimensions; it must be an image", image.dims));
    if (image.depth() == CV_8S || image.depth() == CV_32S || image.depth() > CV_64F)
        CV_Error_(Error::StsUnsupportedFormat, ("src is %s; it must be CV_8U, CV_16U, CV_16S, CV_32F or CV_64F",
                                                typeToString(image.type()).c_str()));
    if (isLarge(image.size()))
    {
        const int PART = 2048;
        const Matx33d newK = newCameraMatrix.empty() ? Matx33d(cameraOf(camera).cameraMatrix().ptr<double>())
                                                     : readProjection(newCameraMatrix, "newCameraMatrix");
        corrected = Mat::zeros(image.size(), image.type());
        for (int y = 0; y < image.rows; y += PART)
            for (int x = 0; x < image.cols; x += PART)
                undistortPart(image, corrected, camera, depth, newK, Rect(x, y, PART, PART) & Rect(Point(), image.size()));
    }
    else
    {
        Mat map1, map2;
        initRefractiveUndistortRectifyMap(camera, depth, noArray(), newCameraMatrix, image.size(), CV_16SC2, map1, map2);
        remap(image, corrected, map1, map2, INTER_LINEAR, BORDER_CONSTANT);
    }
    corrected.copyTo(dst);
}

void refractiveUndistortImage(InputArray src, OutputArray dst, InputArray cameraMatrix, InputArray distCoeffs,
                              const GlassWindow& window, InputArray depth, InputArray newCameraMatrix)
{
    refractiveUndistortImage(src, dst, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, newCameraMatrix);
}

void drawRefractiveFrameAxes(InputOutputArray image, const Ptr<RefractiveCamera>& camera, InputArray rvec, InputArray tvec,
                             float length, int thickness)
{
    CV_INSTRUMENT_REGION();

    const int PIECES = 32;              // of an axis, which is a curve
    const double VISIBLE = 1e6;         // px; cv::line counts in whole numbers
    const int MOST_THICKNESS = SHRT_MAX;
    const int channels = image.channels();
    if (image.empty() || (channels != 1 && channels != 3 && channels != 4))
        CV_Error_(Error::StsBadArg, ("image is %dx%d with %d channels; it must not be empty and have 1, 3 or 4", image.cols(),
                                     image.rows(), channels));
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsOutOfRange, ("length is %g; it must be positive", length));
    if (thickness < 1 || thickness > MOST_THICKNESS)
        CV_Error_(Error::StsOutOfRange, ("thickness is %d; it must be 1 to %d", thickness, MOST_THICKNESS));
    const Scalar colours[] = { Scalar(0, 0, 255), Scalar(0, 255, 0), Scalar(255, 0, 0) };
    for (int axis = 0; axis < 3; axis++)
    {
        std::vector<Vec3d> points(PIECES + 1);
        for (int i = 0; i <= PIECES; i++)
            points[i][axis] = (double)length*i/PIECES;
        std::vector<Point2d> pixels;
        refractiveProjectPoints(points, rvec, tvec, camera, pixels);
        const auto isVisible = [=](const Point2d& p) { return std::abs(p.x) < VISIBLE && std::abs(p.y) < VISIBLE; };   // not NaN
        for (int i = 0; i < PIECES; i++)
            if (isVisible(pixels[i]) && isVisible(pixels[i + 1]))
                line(image, pixels[i], pixels[i + 1], colours[axis], thickness);
    }
}

void drawRefractiveFrameAxes(InputOutputArray image, InputArray cameraMatrix, InputArray distCoeffs, const GlassWindow& window,
                             InputArray rvec, InputArray tvec, float length, int thickness)
{
    drawRefractiveFrameAxes(image, RefractiveCamera::create(cameraMatrix, distCoeffs, window), rvec, tvec, length, thickness);
}

}} // namespace
