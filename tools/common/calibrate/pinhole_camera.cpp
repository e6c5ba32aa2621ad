#include "calibrate/pinhole_camera.hpp"
#include "target/target.hpp"
#include <opencv2/calib3d.hpp>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int MIN_POINTS = 4;       // of a view that is to have a pose

//! Keeps what was seen; calib3d knows no NaN and wants float.
void seenPoints(const std::vector<Point3d>& object, const std::vector<Point2d>& pixels,
                std::vector<Point3f>& seenObject, std::vector<Point2f>& seenPixels)
{
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            seenObject.push_back(object[i]);
            seenPixels.push_back(pixels[i]);
        }
}

void roundTo(double step, Mat& numbers)
{
    for (auto it = numbers.begin<double>(); it != numbers.end<double>(); it++)
        *it = std::round(*it/step)*step;
}

int calibrateCameraFlags(int coefficients)
{
    switch (coefficients)
    {
    case 0: return CALIB_FIX_K1 | CALIB_FIX_K2 | CALIB_FIX_K3 | CALIB_ZERO_TANGENT_DIST;
    case 4: return CALIB_FIX_K3;
    case 5: return 0;
    case 8: return CALIB_RATIONAL_MODEL;
    case 12: return CALIB_RATIONAL_MODEL | CALIB_THIN_PRISM_MODEL;
    default: return CALIB_RATIONAL_MODEL | CALIB_THIN_PRISM_MODEL | CALIB_TILTED_MODEL;
    }
}

} // namespace

Ptr<RefractiveCamera> calibratePinhole(const std::vector<Point3d>& objectPoints,
                                       const std::vector<std::vector<Point2d>>& views, Size imageSize,
                                       int coefficients, double& rms)
{
    std::vector<std::vector<Point3f>> object;
    std::vector<std::vector<Point2f>> image;
    for (const std::vector<Point2d>& view : views)
    {
        std::vector<Point3f> o;
        std::vector<Point2f> i;
        seenPoints(objectPoints, view, o, i);
        if ((int)o.size() < MIN_POINTS)
            continue;
        object.push_back(o);
        image.push_back(i);
    }
    Mat cameraMatrix, distCoeffs, rvecs, tvecs;
    rms = calibrateCamera(object, image, imageSize, cameraMatrix, distCoeffs, rvecs, tvecs,
                          calibrateCameraFlags(coefficients), TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 200, 1e-13));
    distCoeffs = distCoeffs.reshape(1, 1).colRange(0, coefficients).clone();
    // LAPACK need not sum in the same order twice; its last digits, far below what images tell, would show in all that follows.
    roundTo(1e-5, cameraMatrix);
    roundTo(1e-6, distCoeffs);
    Ptr<RefractiveCamera> camera = RefractiveCamera::create(cameraMatrix, distCoeffs);
    camera->setImageSize(imageSize);
    return camera;
}

} // namespace tools
