// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/point_error.hpp"
#include "calibrate/parameter_columns.hpp"
#include "math/dense.hpp"
#include "measure/measurement.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double NOT_SEEN = std::numeric_limits<double>::quiet_NaN();

std::vector<double> sortedAnswers(const std::vector<double>& values)
{
    std::vector<double> answers;
    std::copy_if(values.begin(), values.end(), std::back_inserter(answers), [](double v) { return v == v; });
    std::sort(answers.begin(), answers.end());
    return answers;
}

//! The value below which a share of the answers lies.
double quantile(const std::vector<double>& values, double share)
{
    const std::vector<double> answers = sortedAnswers(values);
    return answers.empty() ? NOT_SEEN : answers[std::min(answers.size() - 1, (size_t)(share*answers.size()))];
}

double largest(const std::vector<double>& values)
{
    const std::vector<double> answers = sortedAnswers(values);
    return answers.empty() ? NOT_SEEN : answers.back();
}

std::vector<double> errorsOf(const Calibration& calibration, const PointsAtRange& seen, double range, double pixelSigma)
{
    const Measurement m = calibration.single() ? measureOnPlane(calibration, seen.pixels[0], Vec4d(0, 0, 1, range), pixelSigma)
                                               : measureRig(calibration, seen.pixels, pixelSigma);
    std::vector<double> errors;
    for (size_t i = 0; i < m.points.size(); i++)
        errors.push_back(m.status[i] == REFRACT_OK ? norm(m.sigma[i]) : NOT_SEEN);
    return errors;
}

//! What a camera tells of all points.
struct CameraDerivatives
{
    PointDerivatives derivatives;
    MatrixXd R;                     //!< camera 1 -> camera
    int column, place;              //!< of its parameters; of R and T, if it is not the first
};

std::vector<CameraDerivatives> differentiateCameras(const Calibration& calibration, const std::vector<Point3d>& points)
{
    const RigModel rig = modelOf(calibration);
    std::vector<CameraDerivatives> cameras;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const RigidTransform& cam_from_cam1 = calibration.extrinsics[c];
        cameras.push_back({differentiatePoints(calibration.cameras[c].camera, points, rotationVector(cam_from_cam1.R), cam_from_cam1.T),
                           toEigen(Mat(cam_from_cam1.R)), columnsOf(rig, (int)c).lens, c ? extrinsicsColumn(rig, (int)c) : 0});
    }
    return cameras;
}

//! Directions in which a point may be: all, or those of a plane.
MatrixXd directionsOf(const std::optional<Vec4d>& plane)
{
    if (!plane)
        return MatrixXd::Identity(3, 3);
    const Eigen::RowVector3d normal((*plane)[0], (*plane)[1], (*plane)[2]);
    return SingularValues(normal).V.rightCols(2);
}

} // namespace

bool ErrorMap::seen() const { return worst() == worst(); }

double ErrorMap::best() const
{
    const std::vector<double> answers = sortedAnswers(total);
    return answers.empty() ? NOT_SEEN : answers.front();
}

double ErrorMap::worst() const { return largest(total); }

double ErrorMap::worstPixelNoise() const { return largest(pixelNoise); }

double ErrorMap::percentile95() const { return quantile(total, 0.95); }

double ErrorMap::median() const { return quantile(total, 0.5); }

double ErrorMap::seenShare() const { return total.empty() ? 0. : (double)sortedAnswers(total).size()/total.size(); }

void ErrorSquares::add(const ErrorMap& map)
{
    for (size_t i = 0; i < map.total.size(); i++)
    {
        if (!(map.total[i] == map.total[i]))
            continue;
        const double noise = map.pixelNoise[i]*map.pixelNoise[i];
        calibration += map.total[i]*map.total[i] - noise;
        pixelNoise += noise;
        count++;
    }
}

std::vector<Point2d> gridOver(Size image, int columns, Size& grid)
{
    grid = Size(columns, std::max(2, cvRound((double)columns*image.height/image.width)));
    std::vector<Point2d> pixels;
    for (int row = 0; row < grid.height; row++)
        for (int column = 0; column < grid.width; column++)
            pixels.emplace_back((image.width - 1.)*column/(grid.width - 1), (image.height - 1.)*row/(grid.height - 1));
    return pixels;
}

static PointsAtRange pointsAtRange(const Calibration& calibration, const std::vector<Point2d>& pixels1, double range)
{
    PointsAtRange result;
    result.pixels = {pixels1};
    refractivePointsOnPlane(pixels1, result.points, calibration.cameras[0].camera, Vec4d(0, 0, 1, range));
    const Point2d none(NOT_SEEN, NOT_SEEN);
    for (size_t c = 1; c < calibration.cameras.size(); c++)
    {
        const Ptr<RefractiveCamera>& camera = calibration.cameras[c].camera;
        std::vector<Point2d> pixels;
        refractiveProjectPoints(result.points, Mat(calibration.extrinsics[c].R), calibration.extrinsics[c].T, camera, pixels);
        const Rect2d image(Point2d(-0.5, -0.5), Size2d(camera->imageSize()));
        for (Point2d& pixel : pixels)
            if (!image.contains(pixel))         // false for NaN
                pixel = none;
        result.pixels.push_back(pixels);
    }
    for (size_t i = 0; i < pixels1.size() && !calibration.single(); i++)
        if (std::none_of(result.pixels.begin() + 1, result.pixels.end(), [i](const auto& pixels) { return tools::seen(pixels[i]); }))
        {
            result.points[i] = Point3d(NOT_SEEN, NOT_SEEN, NOT_SEEN);
            result.pixels[0][i] = none;
        }
    return result;
}

ErrorMap mapErrors(const Calibration& calibration, double range, double pixelSigma, int columns)
{
    ErrorMap map;
    map.range = range;
    map.pixels = gridOver(calibration.cameras[0].camera->imageSize(), columns, map.grid);
    const PointsAtRange seen = pointsAtRange(calibration, map.pixels, range);
    Calibration certain = calibration;
    certain.covariance.release();
    map.total = errorsOf(calibration, seen, range, pixelSigma);
    map.pixelNoise = errorsOf(certain, seen, range, pixelSigma);
    return map;
}

JointError jointErrorOf(const Calibration& calibration, const std::vector<Point3d>& points, const RigPixels& pixels,
                        const std::optional<Vec4d>& plane)
{
    const std::vector<CameraDerivatives> cameras = differentiateCameras(calibration, points);
    const int parameters = columnCount(modelOf(calibration));
    const MatrixXd B = directionsOf(plane);
    JointError result;
    for (size_t i = 0; i < points.size(); i++)
    {
        std::vector<size_t> views;
        for (size_t c = 0; c < (plane ? 1 : cameras.size()); c++)
            if (seen(pixels[c][i]))
                views.push_back(c);
        MatrixXd J = MatrixXd::Zero(2*views.size(), B.cols()), A = MatrixXd::Zero(2*views.size(), parameters);
        for (size_t k = 0; k < views.size(); k++)
        {
            const CameraDerivatives& camera = cameras[views[k]];
            const PointDerivatives& d = camera.derivatives;
            J.middleRows(2*k, 2) = product(product(d.byPose.block(2*i, 3, 2, 3), camera.R), B);
            A.block(2*k, camera.column, 2, d.byParameters.cols()) = d.byParameters.middleRows(2*i, 2);
            if (views[k] > 0)
                A.block(2*k, camera.place, 2, 6) = d.byPose.middleRows(2*i, 2);
        }
        const bool determined = J.rows() >= J.cols() && J.allFinite();
        const MatrixXd C = determined ? inverse(transposeTimes(J, J))
                                      : MatrixXd::Constant(B.cols(), B.cols(), std::numeric_limits<double>::quiet_NaN());
        result.noise.push_back(timesTranspose(product(B, C), B));
        result.byCalibration.push_back(-transposeTimes(timesTranspose(J, product(B, C)), A));
    }
    return result;
}

} // namespace tools
