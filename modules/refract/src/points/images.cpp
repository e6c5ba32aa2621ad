// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "opencv2/imgproc.hpp"

/* What calib3d does with images: one corrected, and the axes of a frame drawn into one. */

namespace cv { namespace refract {

template<typename Depth>
static void undistortImage(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, const Depth& depth,
                           InputArray newCameraMatrix)
{
    const Mat image = src.getMat();
    Mat map1, map2, corrected;
    if (image.empty())
    {
        dst.release();
        return;
    }
    if (image.dims > 2)
        CV_Error_(Error::StsBadSize, ("src has %d dimensions; it must be an image", image.dims));
    initRefractiveUndistortRectifyMap(camera, depth, noArray(), newCameraMatrix, image.size(), CV_16SC2, map1, map2);
    remap(image, corrected, map1, map2, INTER_LINEAR, BORDER_CONSTANT);     // not into dst, which may be src
    corrected.copyTo(dst);
}

void refractiveUndistortImage(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, double depth,
                              InputArray newCameraMatrix)
{
    CV_INSTRUMENT_REGION();

    undistortImage(src, dst, camera, depth, newCameraMatrix);
}

void refractiveUndistortImage(InputArray src, OutputArray dst, const Ptr<RefractiveCamera>& camera, InputArray depth,
                              InputArray newCameraMatrix)
{
    CV_INSTRUMENT_REGION();

    undistortImage(src, dst, camera, depth, newCameraMatrix);
}

void refractiveUndistortImage(InputArray src, OutputArray dst, InputArray cameraMatrix, InputArray distCoeffs,
                              const GlassWindow& window, double depth, InputArray newCameraMatrix)
{
    refractiveUndistortImage(src, dst, RefractiveCamera::create(cameraMatrix, distCoeffs, window), depth, newCameraMatrix);
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
    const int channels = image.channels();
    if (image.empty() || (channels != 1 && channels != 3 && channels != 4))
        CV_Error_(Error::StsBadArg, ("image is %dx%d with %d channels; it must not be empty and have 1, 3 or 4", image.cols(),
                                     image.rows(), channels));
    if (!(length > 0) || !std::isfinite(length))
        CV_Error_(Error::StsOutOfRange, ("length is %g; it must be positive", length));
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
