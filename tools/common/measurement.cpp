#include "measurement.hpp"
#include "calibrate_rig.hpp"

#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point3d;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

} // namespace

int Measurement::answers() const
{
    return (int)std::count(status.begin(), status.end(), (uchar)cv::refract::REFRACT_OK);
}

Measurement measureStereo(const Calibration& calibration, const std::vector<Point2d>& pixels1,
                          const std::vector<Point2d>& pixels2, double pixelSigma)
{
    Measurement result;
    result.pixels1 = pixels1;
    result.pixels2 = pixels2;
    Mat covariance;
    cv::refract::triangulateRefractive(calibration.cameras[0].camera, calibration.cameras[1].camera, calibration.R,
        calibration.T, pixels1, pixels2, result.points, result.status, cv::refract::TRIANGULATE_OPTIMAL,
        pixelSigma > 0 ? pixelSigma : 1., calibration.covariance, covariance);
    result.sigma.assign(pixels1.size(), Vec3d::all(NOT_KNOWN));
    if (pixelSigma > 0)
        for (size_t i = 0; i < pixels1.size(); ++i)
        {
            const double* c = covariance.ptr<double>((int)i);
            result.sigma[i] = Vec3d(std::sqrt(c[0]), std::sqrt(c[4]), std::sqrt(c[8]));
        }
    return result;
}

Measurement measureOnPlane(const cv::Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels,
                           const cv::Vec4d& plane, double pixelSigma)
{
    const auto meet = [&](const Point2d& shift, std::vector<uchar>& status) {
        std::vector<Point2d> shifted;
        for (const Point2d& p : pixels)
            shifted.push_back(p + shift);
        std::vector<Point3d> points;
        cv::refract::refractivePointsOnPlane(shifted, points, camera, plane, status);
        return points;
    };
    Measurement result;
    result.pixels1 = pixels;
    result.points = meet(Point2d(0, 0), result.status);

    // Where the point goes as the pixel moves by half a pixel to each side.
    std::vector<uchar> ignored;
    const std::vector<Point3d> right = meet(Point2d(0.5, 0), ignored), left = meet(Point2d(-0.5, 0), ignored),
                               down = meet(Point2d(0, 0.5), ignored), up = meet(Point2d(0, -0.5), ignored);
    for (size_t i = 0; i < pixels.size(); ++i)
    {
        const Vec3d du = right[i] - left[i], dv = down[i] - up[i];
        Vec3d sigma;
        for (int k = 0; k < 3; ++k)
            sigma[k] = pixelSigma * std::hypot(du[k], dv[k]);
        result.sigma.push_back(sigma);
    }
    return result;
}

Measurement measureTarget(const cv::Ptr<RefractiveCamera>& camera, const Target& target,
                          const std::vector<Point2d>& pixels, double pixelSigma)
{
    Vec3d rvec, tvec;
    if (!(cv::refract::refractiveSolvePnP(target.objectPoints(), pixels, camera, rvec, tvec) >= 0))
        throw Failure("no pose of the target explains its points: check --size and --square");
    Mat ignored, jacobian, dRotation;
    cv::refract::refractiveProjectPoints(target.objectPoints(), rvec, tvec, camera, ignored, cv::noArray(), jacobian);
    Mat seenRows;
    for (size_t i = 0; i < pixels.size(); ++i)
        if (seen(pixels[i]))
            seenRows.push_back(jacobian(cv::Range(2 * (int)i, 2 * (int)i + 2), cv::Range(0, 6)));
    const Mat poseCovariance = pixelSigma * pixelSigma * (seenRows.t() * seenRows).inv(cv::DECOMP_SVD);
    cv::Matx33d R;
    cv::Rodrigues(rvec, R, dRotation);          // 3x9: by rvec, of R row by row

    Measurement result;
    result.pixels1 = pixels;
    for (size_t i = 0; i < pixels.size(); ++i)
    {
        const Vec3d X(target.objectPoints()[i]);
        result.points.push_back(Point3d(R * X + tvec));
        Mat dPoint = Mat::zeros(3, 6, CV_64F);
        for (int row = 0; row < 3; ++row)
        {
            dPoint.at<double>(row, 3 + row) = 1.;
            for (int column = 0; column < 3; ++column)
                for (int k = 0; k < 3; ++k)
                    dPoint.at<double>(row, column) += dRotation.at<double>(column, 3 * row + k) * X[k];
        }
        const Mat covariance = dPoint * poseCovariance * dPoint.t();
        result.sigma.push_back(Vec3d(std::sqrt(covariance.at<double>(0, 0)), std::sqrt(covariance.at<double>(1, 1)),
                                     std::sqrt(covariance.at<double>(2, 2))));
        result.status.push_back(cv::refract::REFRACT_OK);
    }
    return result;
}

Calibration withoutWindows(const Calibration& calibration)
{
    Calibration bare = calibration;
    bare.covariance.release();      // it speaks of windows
    for (CameraCalibration& c : bare.cameras)
        c.camera = withWindow(c.camera, cv::refract::GlassWindow());
    return bare;
}

double pixelSigmaOf(const Calibration& calibration)
{
    const double rms = calibration.rms >= 0 ? calibration.rms : calibration.cameras[0].rms;
    return rms >= 0 ? rms / std::sqrt(2.) : NOT_KNOWN;
}

std::vector<double> lengthErrors(const Target& target, const std::vector<Point3d>& points)
{
    std::vector<double> errors;
    for (const auto& pair : target.neighbours())
    {
        const double measured = cv::norm(points[pair.second] - points[pair.first]);
        if (measured == measured)
            errors.push_back(measured - cv::norm(target.objectPoints()[pair.second]
                                                 - target.objectPoints()[pair.first]));
    }
    return errors;
}

} // namespace tools
