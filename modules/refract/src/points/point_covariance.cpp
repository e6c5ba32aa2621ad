// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/triangulate.hpp"
#include "math/rotation.hpp"
#include <Eigen/Dense>
#include <array>

/* Covariance of the maximum-likelihood point: J^+ S J^+^T from the pixels' covariance S, plus G C G^T, G = -J^+ J_parameters,
from the calibration's covariance C. */

namespace cv { namespace refract {

struct PointCovariance::Calibration
{
    Eigen::MatrixXd covariance;                     //!< empty: exact
    std::vector<std::array<Matx33d, 3> > dR;        //!< of each camera, by its rotation vector
    std::vector<int> first;                         //!< column of each camera's first parameter, then of the first extrinsics
    Eigen::MatrixXd jacobian(const PlacedCameras& cameras, const Vec3d& X, const PointImages& images,
                             const std::vector<std::vector<double> >& parameters) const;
};

PointCovariance::PointCovariance(const PlacedCameras& cameras, InputArray calibration)
    : cameras_(cameras), calibration_(makePtr<Calibration>())
{
    int count = 0;
    for (const PlacedCamera& camera : cameras)
    {
        calibration_->first.push_back(count);
        count += camera.camera->parameterCount();
        std::array<Matx33d, 3> dR;
        rotationMatrix(rotationVector(camera.place.R), dR.data());
        calibration_->dR.push_back(dR);
    }
    calibration_->first.push_back(count);
    count += 6*((int)cameras.size() - 1);
    const std::vector<double> c = readNumbers(calibration, "calibrationCovariance");
    if (c.empty())
        return;
    if (c.size() != (size_t)count*count)
        CV_Error_(Error::StsBadSize, ("calibrationCovariance has %d values; it must be %dx%d", (int)c.size(), count, count));
    calibration_->covariance = Eigen::Map<const Eigen::MatrixXd>(c.data(), count, count);
}

//! All pixels by all parameters of the calibration.
Eigen::MatrixXd PointCovariance::Calibration::jacobian(const PlacedCameras& cameras, const Vec3d& X, const PointImages& images,
                                                       const std::vector<std::vector<double> >& parameters) const
{
    const int count = (int)cameras.size();
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2*count, covariance.cols());
    for (int c = 0; c < count; c++)
        for (int k = 0; k < 2; k++)
        {
            const int row = 2*c + k, own = first[c + 1] - first[c];
            for (int p = 0; p < own; p++)
                J(row, first[c] + p) = parameters[c][k*own + p];
            const Vec3d D = cameras[c].place.R*Vec3d(images.byPoint(row, 0), images.byPoint(row, 1),
                                                          images.byPoint(row, 2));
            for (int p = 0; p < 3 && c > 0; p++)
            {
                J(row, first[count] + 6*(c - 1) + p) = D.dot(dR[c][p]*X);
                J(row, first[count] + 6*(c - 1) + 3 + p) = D[p];
            }
        }
    return J;
}

void PointCovariance::evaluate(const PixelBlock& block, int i, const double* pixels, double* covariance) const
{
    const int rows = 2*(int)cameras_.size();
    const bool isUncertain = calibration_->covariance.size() > 0;
    const Vec3d X(block.x[i], block.y[i], block.z[i]);
    PointImages images((int)cameras_.size());
    std::vector<std::vector<double> > parameters;
    for (size_t c = 0; c < cameras_.size() && isUncertain; c++)
        parameters.push_back(std::vector<double>(2*cameras_[c].camera->parameterCount()));
    if (projectIntoAll(cameras_, block, i, X, images, isUncertain ? &parameters : NULL) != REFRACT_OK)
    {
        std::fill(covariance, covariance + 9, std::numeric_limits<double>::quiet_NaN());
        return;
    }
    const auto& J = images.byPoint;
    const Eigen::Matrix<double, 3, Eigen::Dynamic> pseudoInverse = (J.transpose()*J).inverse()*J.transpose();
    Eigen::Matrix3d C = pseudoInverse*Eigen::Map<const Eigen::MatrixXd>(pixels, rows, rows)*pseudoInverse.transpose();
    if (isUncertain)
    {
        const Eigen::MatrixXd G = pseudoInverse*calibration_->jacobian(cameras_, X, images, parameters);
        C += G*calibration_->covariance*G.transpose();
    }
    std::copy(C.data(), C.data() + 9, covariance);
}

}} // namespace
