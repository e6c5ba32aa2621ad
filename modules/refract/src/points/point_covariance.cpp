// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/triangulate.hpp"
#include "math/covariance_matrix.hpp"
#include "math/least_squares.hpp"
#include "math/rotation.hpp"
#include <array>

/* Covariance of the maximum-likelihood point: J^+ S J^+^T from the pixels' covariance S, plus G C G^T, G = -J^+ J_parameters,
from the calibration's covariance C. */

namespace cv { namespace refract {

struct PointCovariance::Calibration
{
    std::vector<double> covariance;                 //!< by rows; empty: exact
    std::vector<std::array<Matx33d, 3> > dR;        //!< of each camera, by its rotation vector
    std::vector<int> first;                         //!< column of each camera's first parameter, then of the first extrinsics
    std::vector<Vec3d> pointBy(const PlacedCameras& cameras, const Vec3d& X, const PointImages& images,
                               const std::vector<Vec3d>& byPixel, const std::vector<std::vector<double> >& parameters) const;
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
    if (!c.empty() && c.size() != (size_t)count*count)
        CV_Error_(Error::StsBadSize, ("calibrationCovariance has %d values; it must be %dx%d", (int)c.size(), count, count));
    if (!c.empty())
        checkCovariance(Mat(count, count, CV_64F, const_cast<double*>(c.data())), "calibrationCovariance");
    calibration_->covariance = c;
}

//! The point by each parameter of the calibration, but for the sign.
std::vector<Vec3d> PointCovariance::Calibration::pointBy(const PlacedCameras& cameras, const Vec3d& X, const PointImages& images,
                                                         const std::vector<Vec3d>& byPixel,
                                                         const std::vector<std::vector<double> >& parameters) const
{
    const int count = (int)cameras.size();
    std::vector<Vec3d> columns(first[count] + 6*(count - 1));
    for (int c = 0; c < count; c++)
        for (int k = 0; k < 2; k++)
        {
            const int own = first[c + 1] - first[c];
            const Vec3d& by = byPixel[2*c + k];
            for (int p = 0; p < own; p++)
                columns[first[c] + p] += parameters[c][k*own + p]*by;
            const Vec3d D = cameras[c].place.R*images.byPoint[2*c + k];
            for (int p = 0; p < 3 && c > 0; p++)
            {
                columns[first[count] + 6*(c - 1) + p] += D.dot(dR[c][p]*X)*by;
                columns[first[count] + 6*(c - 1) + 3 + p] += D[p]*by;
            }
        }
    return columns;
}

//! G C G^T, from G's columns and a symmetric C.
static Matx33d carried(const std::vector<Vec3d>& columns, const double* covariance)
{
    Matx33d sum;
    for (size_t i = 0; i < columns.size(); i++, covariance += columns.size())
    {
        Vec3d row;
        for (size_t j = 0; j < columns.size(); j++)
            row += covariance[j]*columns[j];
        sum += row*columns[i].t();
    }
    return sum;
}

void PointCovariance::evaluate(const PixelBlock& block, int i, const double* pixels, double* covariance) const
{
    const bool isUncertain = !calibration_->covariance.empty();
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
    SumOfSquares<3> sum;
    for (size_t row = 0; row < images.errors.size(); row++)
        sum.add(images.errors[row], images.byPoint[row].val);
    const Matx33d inverse = inverseOfPositive(sum.curvature);
    std::vector<Vec3d> byPixel;
    for (const Vec3d& row : images.byPoint)
        byPixel.push_back(inverse*row);
    Matx33d C = carried(byPixel, pixels);
    if (isUncertain)
        C += carried(calibration_->pointBy(cameras_, X, images, byPixel, parameters), calibration_->covariance.data());
    std::copy(C.val, C.val + 9, covariance);
}

}} // namespace
