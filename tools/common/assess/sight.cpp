// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/sight.hpp"
#include "assess/eigen_matrix.hpp"
#include "console/failure.hpp"
#include <Eigen/QR>
#include <Eigen/SVD>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Poses are found in the first of: direct images, glass images; of camera 1, of camera 2, ...
bool startPose(const RigModel& rig, const Moment& m, Sight& sight)
{
    for (bool glass : {false, true})
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<Point2d>& pixels = glass ? m.glass[c] : m.direct[c];
            const Ptr<RefractiveCamera> camera = glass ? rig.cameras[c] : copyWithWindow(rig.cameras[c], GlassWindow());
            if (pixels.empty() || !refractiveSolvePnP(m.objectPoints, pixels, camera, sight.rvec, sight.tvec))
                continue;
            poseInCamera1(rig, c, sight.rvec, sight.tvec);
            return true;
        }
    return false;
}

//! Gauss-Newton on the pose alone.
ViewDerivatives atBestPose(const RigModel& rig, Sight& sight)
{
    const int ITERATIONS = 4;       // from a pose that one of the images alone fits best
    ViewDerivatives view = differentiateView(rig, sight.objectPoints, sight.rvec, sight.tvec, sight.images);
    for (int i = 0; i < ITERATIONS; i++)
    {
        const VectorXd step = view.byPose.colPivHouseholderQr().solve(sight.pixels - view.predicted);
        for (int k = 0; k < 3; k++)
        {
            sight.rvec[k] += step[k];
            sight.tvec[k] += step[3 + k];
        }
        view = differentiateView(rig, sight.objectPoints, sight.rvec, sight.tvec, sight.images);
    }
    return view;
}

//! H, H H^T = covariance, without the directions that have no variance.
MatrixXd rootOf(const MatrixXd& covariance)
{
    const VectorXd deviations = covariance.diagonal().cwiseMax(0.).cwiseSqrt();
    const VectorXd inverse = (deviations.array() > 0.).select(deviations.cwiseInverse(), 0.);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> correlation(inverse.asDiagonal()*covariance*inverse.asDiagonal());
    return deviations.asDiagonal()*correlation.eigenvectors()*correlation.eigenvalues().cwiseMax(0.).cwiseSqrt().asDiagonal();
}

} // namespace

Sight sightOf(const RigModel& rig, const Moment& m)
{
    Sight sight;
    sight.objectPoints = m.objectPoints;
    if (!startPose(rig, m, sight))
        throw Failure("no pose of the target explains its points in view '" + m.stem + "': check --size and --square");
    std::vector<double> pixels;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (bool glass : {false, true})
        {
            const std::vector<Point2d>& points = glass ? m.glass[c] : m.direct[c];
            ImageOfView image{c, glass, {}};
            for (size_t i = 0; i < points.size(); i++)
                if (seen(points[i]))
                {
                    image.points.push_back((int)i);
                    pixels.insert(pixels.end(), {points[i].x, points[i].y});
                }
            if (!image.points.empty())
                sight.images.push_back(image);
        }
    sight.pixels = Eigen::Map<VectorXd>(pixels.data(), pixels.size());
    return sight;
}

void Misfit::add(const Misfit& other)
{
    squares += other.squares;
    expectedSquares += other.expectedSquares;
    chiSquare += other.chiSquare;
    directions += other.directions;
}

double Misfit::ratio() const
{
    return expectedSquares > 0. ? std::sqrt(squares/expectedSquares) : std::numeric_limits<double>::quiet_NaN();
}

double Misfit::calibrationRatio() const
{
    return directions ? std::sqrt(chiSquare/directions) : std::numeric_limits<double>::quiet_NaN();
}

Misfit misfitOf(const RigModel& rig, const Mat& covariance, double sigma, const std::vector<Moment>& moments)
{
    const MatrixXd H = rootOf(toEigen(covariance));
    MatrixXd AH(0, H.cols());
    VectorXd r(0);
    for (const Moment& moment : moments)
    {
        Sight sight = sightOf(rig, moment);
        const ViewDerivatives view = atBestPose(rig, sight);
        const WithoutPose project(view.byPose);
        const MatrixXd part = project(view.byParameters*H);
        const Eigen::Index rows = r.size();
        AH.conservativeResize(rows + part.rows(), Eigen::NoChange);
        AH.bottomRows(part.rows()) = part;
        r.conservativeResize(rows + part.rows());
        r.tail(part.rows()) = project(sight.pixels - view.predicted);
    }
    const Eigen::BDCSVD<MatrixXd> svd(AH, Eigen::ComputeThinU);
    Misfit misfit;
    misfit.squares = r.squaredNorm();
    misfit.expectedSquares = sigma*sigma*(double)r.size() + svd.singularValues().squaredNorm();
    for (int i = 0; i < svd.singularValues().size() && svd.singularValues()[i] > sigma; i++)
    {
        const double variance = sigma*sigma + std::pow(svd.singularValues()[i], 2);
        misfit.chiSquare += std::pow(svd.matrixU().col(i).dot(r), 2)/variance;
        misfit.directions++;
    }
    return misfit;
}

} // namespace tools
