// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/measurement.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_derivatives.hpp"
#include "calibrate/rig_model.hpp"
#include "console/failure.hpp"
#include <opencv2/calib3d.hpp>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

//! Of lens and window of camera 1, also out of that of a rig; zero where the file has none.
MatrixXd covarianceOfCamera1(const Calibration& calibration, Eigen::Index parameters)
{
    if (calibration.covariance.empty())
        return MatrixXd::Zero(parameters, parameters);
    return toEigen(calibration.covariance).topLeftCorner(parameters, parameters);
}

Vec3d deviations(const MatrixXd& covariance)
{
    return Vec3d(std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2)));
}

//! Standard deviation of a pixel coordinate from what a pose leaves.
double residualSigma(const std::vector<Point2d>& seenPixels, const std::vector<Point2d>& predicted)
{
    double squares = 0;
    for (size_t i = 0; i < seenPixels.size(); i++)
        squares += std::pow(norm(seenPixels[i] - predicted[i]), 2);
    return std::sqrt(squares/std::max(1., 2.*seenPixels.size() - 6));
}

} // namespace

int Measurement::answers() const
{
    return (int)std::count_if(points.begin(), points.end(), [](const Point3d& p) { return p.x == p.x; });
}

int Measurement::inconsistent() const
{
    return (int)std::count(status.begin(), status.end(), INCONSISTENT);
}

int Measurement::seenPoints() const
{
    int count = 0;
    for (size_t i = 0; i < points.size(); i++)
    {
        const auto views = std::count_if(pixels.begin(), pixels.end(), [i](const auto& image) { return seen(image[i]); });
        count += views >= (pixels.size() == 1 ? 1 : 2);
    }
    return count;
}

RigPixels glassPixels(const View& view, int cameraCount)
{
    RigPixels pixels(view.glass.begin(), view.glass.begin() + cameraCount);
    for (std::vector<Point2d>& image : pixels)
        image.resize(view.objectPoints.size(), Point2d(NOT_KNOWN, NOT_KNOWN));
    return pixels;
}

Measurement measureRig(const Calibration& calibration, const RigPixels& pixels, double pixelSigma)
{
    Measurement result;
    result.pixels = pixels;
    std::vector<Ptr<refract::RefractiveCamera>> cameras;
    std::vector<Mat> Rs, Ts;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        cameras.push_back(calibration.cameras[c].camera);
        Rs.push_back(Mat(calibration.extrinsics[c].R));
        Ts.push_back(Mat(calibration.extrinsics[c].T));
    }
    Mat covariance;
    refract::triangulateRefractive(cameras, Rs, Ts, pixels, result.points, result.status, refract::TRIANGULATE_OPTIMAL,
                                   pixelSigma > 0 ? pixelSigma : 1., calibration.covariance, covariance);
    // 9 is INCONSISTENT in the files of the tools, and a pixel that is not there was never finite.
    for (uchar& status : result.status)
        if (status == refract::REFRACT_TOO_FEW_VIEWS)
            status = refract::REFRACT_NOT_FINITE;
    result.sigma.assign(result.points.size(), Vec3d::all(NOT_KNOWN));
    if (pixelSigma > 0)
        for (size_t i = 0; i < result.points.size(); i++)
        {
            const double* c = covariance.ptr<double>((int)i);
            result.sigma[i] = Vec3d(std::sqrt(c[0]), std::sqrt(c[4]), std::sqrt(c[8]));
        }
    return result;
}

/* A point on a plane, X = X0 + B s with a 2-column basis B, is where its projection is the pixel:
    ds = (P B)^-1 (du - A dp)      P: pixel by point, A: pixel by lens and window */
Measurement measureOnPlane(const Calibration& calibration, const std::vector<Point2d>& pixels, const Vec4d& plane,
                           double pixelSigma)
{
    const auto& camera = calibration.cameras[0].camera;
    Measurement result;
    result.pixels = {pixels};
    refract::refractivePointsOnPlane(pixels, result.points, camera, plane, result.status);
    const PointDerivatives d = differentiatePoints(camera, result.points, Vec3d(), Vec3d());
    const MatrixXd C = covarianceOfCamera1(calibration, d.byParameters.cols());
    const MatrixXd B = Eigen::JacobiSVD<MatrixXd>(Eigen::RowVector3d(plane[0], plane[1], plane[2]),
                                                  Eigen::ComputeFullV).matrixV().rightCols(2);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const MatrixXd A = d.byParameters.middleRows(2*i, 2);
        const MatrixXd byPixel = B*(d.byPose.block(2*i, 3, 2, 3)*B).inverse();
        const MatrixXd ofPixel = pixelSigma*pixelSigma*MatrixXd::Identity(2, 2) + A*C*A.transpose();
        result.sigma.push_back(deviations(byPixel*ofPixel*byPixel.transpose()));
    }
    return result;
}

/* The pose of least squares: dpose = K^+ (du - A dp), K: pixels by pose. */
Measurement measureTarget(const Calibration& calibration, const std::vector<Point3d>& objectPoints,
                          const std::vector<Point2d>& pixels, double pixelSigma)
{
    const auto& camera = calibration.cameras[0].camera;
    Vec3d rvec, tvec;
    if (!refract::refractiveSolvePnP(objectPoints, pixels, camera, rvec, tvec))
        throw Failure("no pose of the target explains its points: check --size and --square");
    std::vector<Point3d> seenPoints;
    std::vector<Point2d> seenPixels, predicted;
    for (size_t i = 0; i < pixels.size(); i++)
        if (seen(pixels[i]))
        {
            seenPoints.push_back(objectPoints[i]);
            seenPixels.push_back(pixels[i]);
        }
    Measurement result;
    refract::refractiveProjectPoints(seenPoints, rvec, tvec, camera, predicted);
    const double residual = residualSigma(seenPixels, predicted);
    if (!(residual <= pixelSigma))
        result.noise = residual;
    if (residual > pixelSigma)
        pixelSigma = residual;
    const PointDerivatives d = differentiatePoints(camera, seenPoints, rvec, tvec);
    const MatrixXd inverse = (d.byPose.transpose()*d.byPose).inverse();
    const MatrixXd byParameters = inverse*d.byPose.transpose()*d.byParameters;
    const MatrixXd ofPose = pixelSigma*pixelSigma*inverse
        + byParameters*covarianceOfCamera1(calibration, byParameters.cols())*byParameters.transpose();

    Matx33d R;
    Mat jacobian;                               // 3x9: by rvec, of R row by row
    Rodrigues(rvec, R, jacobian);
    const MatrixXd dR = toEigen(jacobian);
    result.pixels = {pixels};
    for (const Point3d& point : objectPoints)
    {
        const Vec3d X(point);
        result.points.push_back(Point3d(R*X + tvec));
        MatrixXd byPose(3, 6);
        byPose.rightCols(3).setIdentity();
        for (int row = 0; row < 3; row++)
            byPose.block(row, 0, 1, 3) = (dR.middleCols(3*row, 3)*Eigen::Vector3d(X[0], X[1], X[2])).transpose();
        result.sigma.push_back(deviations(byPose*ofPose*byPose.transpose()));
        result.status.push_back(refract::REFRACT_OK);
    }
    return result;
}

Calibration withoutWindows(const Calibration& calibration)
{
    Calibration bare = calibration;
    bare.covariance.release();      // it speaks of windows
    for (CameraCalibration& c : bare.cameras)
        c.camera = copyWithWindow(c.camera, refract::GlassWindow());
    return bare;
}

double pixelSigmaOf(const Calibration& calibration)
{
    if (calibration.sigma >= 0)
        return calibration.sigma;
    const double rms = calibration.rms >= 0 ? calibration.rms : calibration.cameras[0].rms;
    return rms >= 0 ? rms/std::sqrt(2.) : NOT_KNOWN;
}

} // namespace tools
