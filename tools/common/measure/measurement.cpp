// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/measurement.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include "math/dense.hpp"
#include "measure/rig_vector.hpp"
#include "measure/target_pose.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

Vec3d deviations(const MatrixXd& covariance)
{
    return Vec3d(std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2)));
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

namespace {

bool isSeenAt(const Measurement& m, size_t i)
{
    const auto views = std::count_if(m.pixels.begin(), m.pixels.end(), [i](const auto& image) { return seen(image[i]); });
    return views >= (m.pixels.size() == 1 ? 1 : 2);
}

} // namespace

int Measurement::seenPoints() const
{
    int count = 0;
    for (size_t i = 0; i < points.size(); i++)
        count += isSeenAt(*this, i);
    return count;
}

int Measurement::contradicting() const
{
    int count = 0;
    for (size_t i = 0; i < points.size(); i++)
        count += status[i] == INCONSISTENT || (status[i] != 0 && status[i] != OUTSIDE_IMAGE && isSeenAt(*this, i));
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
        Ts.push_back(Mat(calibration.extrinsics[c].t));
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
    const MatrixXd B = refract::SingularValues(Eigen::RowVector3d(plane[0], plane[1], plane[2])).V.rightCols(2);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const MatrixXd A = d.byParameters.middleRows(2*i, 2);
        const MatrixXd byPixel = refract::product(B, refract::inverse(refract::product(d.byPose.block(2*i, 3, 2, 3), B)));
        const MatrixXd ofPixel = pixelSigma*pixelSigma*MatrixXd::Identity(2, 2) + refract::timesTranspose(refract::product(A, C), A);
        result.sigma.push_back(deviations(refract::timesTranspose(refract::product(byPixel, ofPixel), byPixel)));
    }
    return result;
}

Measurement measureTarget(const Calibration& calibration, const std::vector<Point3d>& objectPoints,
                          const std::vector<Point2d>& pixels, double pixelSigma)
{
    const TargetPose pose = poseOfTarget(calibration, objectPoints, pixels);
    Measurement result;
    if (!(pose.residual <= pixelSigma))
        result.noise = pose.residual;
    if (pose.residual > pixelSigma)
        pixelSigma = pose.residual;
    const MatrixXd C = covarianceOfCamera1(calibration, pose.byParameters.cols());
    const MatrixXd ofPose = pixelSigma*pixelSigma*pose.byNoise
                            + refract::timesTranspose(refract::product(pose.byParameters, C), pose.byParameters);
    const Matx33d R = pose.rotation();
    result.pixels = {pixels};
    for (const Point3d& point : objectPoints)
    {
        const MatrixXd byPose = pose.differentiatePoint(point);
        result.points.push_back(Point3d(R*Vec3d(point) + pose.tvec));
        result.sigma.push_back(deviations(refract::timesTranspose(refract::product(byPose, ofPose), byPose)));
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
