// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/length_scale.hpp"
#include "measure/joint_error.hpp"
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

//! The sum of the ratios, and how it changes with each point of a view.
struct RatiosOfView
{
    double sum = 0.;
    int count = 0;
    std::vector<Vec3d> byPoint;
};

RatiosOfView ratiosOf(const View& view, const Measurement& measured)
{
    RatiosOfView ratios;
    ratios.byPoint.resize(measured.points.size());
    for (const auto& pair : view.neighbours)
    {
        if (measured.status[pair.first] != refract::REFRACT_OK || measured.status[pair.second] != refract::REFRACT_OK)
            continue;
        const Vec3d along = measured.points[pair.second] - measured.points[pair.first];
        const double length = norm(view.objectPoints[pair.second] - view.objectPoints[pair.first]);
        const Vec3d by = along*(1./(norm(along)*length));
        ratios.sum += norm(along)/length;
        ratios.count++;
        ratios.byPoint[pair.second] += by;
        ratios.byPoint[pair.first] -= by;
    }
    return ratios;
}

} // namespace

double LengthScale::deviations() const
{
    return sigma > 0. ? std::abs(ratio - 1.)/sigma : 0.;
}

LengthScale lengthScaleOf(const Calibration& calibration, const std::vector<View>& views, const std::vector<Measurement>& results,
                          double pixelSigma, double targetSigma, const std::optional<Vec4d>& plane)
{
    double sum = 0., ofNoise = 0.;
    int count = 0;
    Eigen::RowVectorXd byCalibration;
    for (size_t k = 0; k < results.size(); k++)
    {
        const RatiosOfView ratios = ratiosOf(views[k], results[k]);
        if (ratios.count == 0)
            continue;
        sum += ratios.sum;
        count += ratios.count;
        const JointError joint = jointErrorOf(calibration, results[k].points, results[k].pixels, plane);
        for (size_t i = 0; i < ratios.byPoint.size(); i++)
        {
            if (results[k].status[i] != refract::REFRACT_OK)
                continue;
            const Eigen::RowVector3d by(ratios.byPoint[i][0], ratios.byPoint[i][1], ratios.byPoint[i][2]);
            ofNoise += by*joint.noise[i]*by.transpose();
            if (byCalibration.size() == 0)
                byCalibration = Eigen::RowVectorXd::Zero(joint.byCalibration[i].cols());
            byCalibration += by*joint.byCalibration[i];
        }
    }
    if (count == 0)
        return {1., std::numeric_limits<double>::quiet_NaN()};
    double variance = pixelSigma*pixelSigma*ofNoise/((double)count*count) + targetSigma*targetSigma;
    if (calibration.covariance.empty())
        variance = std::numeric_limits<double>::quiet_NaN();
    else
        variance += (byCalibration*toEigen(calibration.covariance)*byCalibration.transpose())(0)/((double)count*count);
    return {sum/count, std::sqrt(variance)};
}

} // namespace tools
