// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/consistency.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/numbers.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/rig_vector.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

// Of residuals, in standard deviations: what noise may do, what it cannot, and what cannot even be used.
const double USUAL = 3., FEW = 5., GROSS = 20.;
const double CERTAIN = 4.;              // of the noise that points show
const double MEDIAN = 0.6745;           // of |N(0, 1)|
const double GROSS_PIXELS = 2.;         // no corner that was found is farther off
const double NOISIER = 3.;              // images may be so much noisier than those of the calibration
const size_t TELLING = 8;               // points, fewer of which do not tell noise from a wrong match

/* Of the root mean square of `freedom` numbers with deviation 1: where it lies with the probability of a normal number's
`deviations` (Wilson and Hilferty's cube root; of a single number exactly). */
double rmsAt(double deviations, int dof)
{
    if (dof == 1)
        return deviations > 0 ? deviations : MEDIAN;
    const double variance = 2./(9.*dof);
    return std::pow(1. - variance + deviations*std::sqrt(variance), 1.5);
}

//! What is left over of the pixels of a point.
struct ConsistencyResidual
{
    double pixels, expected;        //!< RMS per degree of freedom; expected: one standard deviation; NaN where there is no point
    int dof;                        //!< coordinates - 3
    MatrixXd byPoint;               //!< 2 rows of each camera that sees it
    Eigen::VectorXd left;           //!< px, of each degree of freedom
    MatrixXd byParameters;          //!< what each parameter of the calibration does to them, a row each; none: it has no covariance
};

class ConsistencyResiduals
{
public:
    ConsistencyResiduals(const Calibration& calibration, const Measurement& m, double pixelSigma)
        : m_(m), sigma_(pixelSigma), cameras_(calibration.cameras.size())
    {
        const RigModel rig = modelOf(calibration);
        for (size_t c = 0; c < cameras_.size(); c++)
        {
            Camera& camera = cameras_[c];
            const Vec3d rvec = rotationVector(calibration.extrinsics[c].R);
            camera.R = toEigen(Mat(calibration.extrinsics[c].R));
            refract::refractiveProjectPoints(m.points, rvec, calibration.extrinsics[c].t, calibration.cameras[c].camera, camera.predicted);
            camera.derivatives = differentiatePoints(calibration.cameras[c].camera, m.points, rvec, calibration.extrinsics[c].t);
            camera.column = columnsOf(rig, (int)c).lens;
            camera.place = extrinsicsColumn(rig, (int)c);
        }
        if (!calibration.covariance.empty())
            covariance_ = toEigen(calibration.covariance);
    }

    ConsistencyResidual operator()(size_t i) const
    {
        std::vector<size_t> views;
        for (size_t c = 0; c < cameras_.size(); c++)
            if (seen(m_.pixels[c][i]))
                views.push_back(c);
        const int rows = 2*(int)views.size(), dof = rows - 3;
        MatrixXd J(rows, 3);
        Eigen::VectorXd e(rows);
        for (size_t k = 0; k < views.size(); k++)
        {
            const Camera& camera = cameras_[views[k]];
            const Point2d error = m_.pixels[views[k]][i] - camera.predicted[i];
            J.middleRows(2*k, 2) = refract::product(camera.derivatives.byPose.block(2*i, 3, 2, 3), camera.R);
            e.segment(2*k, 2) << error.x, error.y;
        }
        if (dof < 1 || !J.allFinite() || !e.allFinite())
            return {NOT_KNOWN, NOT_KNOWN, dof, J, {}, {}};
        const MatrixXd over = refract::QR(J).Q().rightCols(dof);
        const Eigen::VectorXd w = refract::transposeTimesVector(over, e);
        const MatrixXd byParameters = byParametersOf(i, views, over), S = covarianceOf(byParameters, dof);
        const double expected = std::sqrt(S.trace()/dof);
        if (!(sigma_ > 0))
            return {std::sqrt(w.squaredNorm()/dof), expected, dof, J, w, byParameters};
        return {std::sqrt(w.dot(refract::LDLT(S).solve(w))/dof)*expected, expected, dof, J, w, byParameters};
    }

private:
    struct Camera
    {
        MatrixXd R;
        std::vector<Point2d> predicted;
        PointDerivatives derivatives;
        int column, place;              //!< of its parameters; of R and T, if it is not the first
    };

    MatrixXd byParametersOf(size_t i, const std::vector<size_t>& views, const MatrixXd& over) const
    {
        if (!covariance_.size())
            return {};
        MatrixXd A = MatrixXd::Zero(over.rows(), covariance_.rows());
        for (size_t k = 0; k < views.size(); k++)
        {
            const Camera& camera = cameras_[views[k]];
            const PointDerivatives& d = camera.derivatives;
            A.block(2*k, camera.column, 2, d.byParameters.cols()) = d.byParameters.middleRows(2*i, 2);
            if (views[k] > 0)
                A.block(2*k, camera.place, 2, 6) = d.byPose.middleRows(2*i, 2);
        }
        return refract::transposeTimes(A, over);
    }
    MatrixXd covarianceOf(const MatrixXd& byParameters, int dof) const
    {
        const MatrixXd S = sigma_*sigma_*MatrixXd::Identity(dof, dof);
        if (!byParameters.size())
            return S;
        return S + refract::product(refract::transposeTimes(byParameters, covariance_), byParameters);
    }

    const Measurement& m_;
    double sigma_;
    std::vector<Camera> cameras_;
    MatrixXd covariance_;
};

/* How many times as large as expected the residuals of a view are, by their median, which a few wrong points do not move. 1 if
that may be chance: of the noise of so few points, or of the calibration's error, which is one for all points of the view. */
double timesNoisier(const std::vector<ConsistencyResidual>& residuals, double pixelSigma)
{
    std::vector<double> ratios;
    double pixelNoise = 0;          // share of the variance
    int dof = 0;
    for (const ConsistencyResidual& residual : residuals)
        if (residual.expected > 0)
        {
            ratios.push_back(residual.pixels/residual.expected/rmsAt(0, residual.dof));    // 1 is in their middle
            dof += residual.dof;
            pixelNoise += std::pow(pixelSigma/residual.expected, 2);
        }
    if (ratios.empty())
        return 1.;
    pixelNoise /= ratios.size();
    const double byNoise = 1 + 4.7/std::sqrt((double)dof);                // four standard deviations of the median's estimate
    const double byCalibration = USUAL/MEDIAN;
    const double byChance = std::sqrt(pixelNoise*byNoise*byNoise + (1 - pixelNoise)*byCalibration*byCalibration);
    const double times = median(ratios);
    return times > byChance ? times : 1.;
}

//! The squares of what no change of parameters takes from it. @param H a row for each number of left
double squaresBeside(MatrixXd H, const Eigen::VectorXd& left)
{
    const double TIED = 1e-10;              // parameters that do the same are as good as one
    for (Eigen::Index k = 0; k < H.cols(); k++)
    {
        const double length = H.col(k).norm();
        if (length > 0)
            H.col(k) /= length;
    }
    const MatrixXd N = refract::transposeTimes(H, H) + TIED*MatrixXd::Identity(H.cols(), H.cols());
    const Eigen::VectorXd b = refract::transposeTimesVector(H, left);
    return std::max(0., left.squaredNorm() - b.dot(refract::LDLT(N).solve(b)));
}

void forget(Measurement& m, size_t i)
{
    m.points[i] = Point3d(NOT_KNOWN, NOT_KNOWN, NOT_KNOWN);
    m.sigma[i] = Vec3d::all(NOT_KNOWN);
}

} // namespace

ShownNoise::ShownNoise(const Calibration& calibration, const Measurement& m)
{
    const ConsistencyResiduals residualOf(calibration, m, 0.);
    std::vector<ConsistencyResidual> all;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        const ConsistencyResidual residual = residualOf(i);
        if (!(residual.pixels == residual.pixels))
            continue;
        parts_.push_back({residual.dof, std::pow(residual.pixels, 2), std::pow(residual.expected, 2)});
        dof_ += residual.dof;
        all.push_back(residual);
    }
    const int parameters = calibration.covariance.rows;
    if (dof_ < 2*parameters || all.empty())
        return;
    MatrixXd H(dof_, parameters);
    Eigen::VectorXd left(dof_);
    Eigen::Index row = 0;
    for (const ConsistencyResidual& residual : all)
    {
        left.segment(row, residual.dof) = residual.left;
        if (parameters)
            H.middleRows(row, residual.dof) = residual.byParameters.transpose();
        row += residual.dof;
    }
    besideCalibration_ = parameters ? squaresBeside(H, left) : left.squaredNorm();
    dofBesideCalibration_ = dof_ - parameters;
}

double ShownNoise::sigma() const
{
    double sum = 0.;
    for (const Part& part : parts_)
        sum += part.dof*(part.square - part.ofCalibration);
    return dof_ ? std::sqrt(std::max(0., sum)/dof_) : NOT_KNOWN;
}

bool ShownNoise::isMoreThan(double pixelSigma) const
{
    double sum = 0.;
    for (const Part& part : parts_)
        sum += part.dof*part.square/(pixelSigma*pixelSigma + USUAL*USUAL*part.ofCalibration);
    return dof_ && std::sqrt(sum/dof_) > rmsAt(CERTAIN, dof_);
}

bool ShownNoise::refutes(double pixelSigma) const
{
    return isMoreThan(pixelSigma) || (dofBesideCalibration_ && std::sqrt(besideCalibration_/dofBesideCalibration_)
                                                                   > pixelSigma*rmsAt(CERTAIN, dofBesideCalibration_));
}

void checkConsistency(const Calibration& calibration, double pixelSigma, Measurement& m)
{
    const bool known = pixelSigma > 0;
    const ConsistencyResiduals residualOf(calibration, m, known ? pixelSigma : 0.);
    std::vector<ConsistencyResidual> residuals;
    for (size_t i = 0; i < m.points.size(); i++)
        residuals.push_back(residualOf(i));
    const double times = known && m.points.size() >= TELLING ? timesNoisier(residuals, pixelSigma) : 1.;
    if (times > 1)
        m.noise = times*pixelSigma;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        const double residual = residuals[i].pixels, expected = known ? residuals[i].expected : 0.;
        const auto farOff = [&](double deviations) { return rmsAt(deviations, residuals[i].dof)*expected; };
        if (!(residual == residual))
            continue;
        const double limit = known ? std::min(times, NOISIER)*farOff(FEW) : GROSS_PIXELS;
        if (known)
        {
            const double beyond = std::max(0., residual*residual - std::pow(times*farOff(USUAL), 2));
            const double more = (times*times - 1)*pixelSigma*pixelSigma + beyond;
            const MatrixXd& J = residuals[i].byPoint;
            const MatrixXd C = more*refract::inverse(refract::transposeTimes(J, J));
            for (int k = 0; k < 3; k++)
                m.sigma[i][k] = std::sqrt(m.sigma[i][k]*m.sigma[i][k] + C(k, k));
        }
        if (residual > limit)
        {
            m.status[i] = INCONSISTENT;
            m.worstResidual = std::max(m.worstResidual, residual);
            if (residual > std::max(GROSS_PIXELS, farOff(GROSS)))
                forget(m, i);
        }
    }
}

void checkPose(double pixelSigma, Measurement& m)
{
    if (!(m.noise > (pixelSigma > 0 ? FEW*pixelSigma : GROSS_PIXELS)))
        return;
    std::fill(m.status.begin(), m.status.end(), INCONSISTENT);
    std::fill(m.sigma.begin(), m.sigma.end(), Vec3d::all(NOT_KNOWN));     // residuals do not tell what a wrong model does
    m.worstResidual = m.noise;
}

} // namespace tools
