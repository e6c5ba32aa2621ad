#include "assess/consistency.hpp"
#include "assess/eigen_matrix.hpp"
#include "assess/point_derivatives.hpp"
#include <opencv2/calib3d.hpp>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

// Of misfits, in standard deviations: what noise may do, what it cannot, and what cannot even be used.
const double USUAL = 3., FEW = 5., GROSS = 20.;
const double MEDIAN = 0.6745;           // of |N(0, 1)|
const double GROSS_PIXELS = 2.;         // no corner that was found is farther off
const double NOISIER = 3.;              // images may be so much noisier than those of the calibration

//! What is left over of the two pixels of a point.
struct PartnerMisfit
{
    double pixels, expected;        //!< expected: one standard deviation; NaN where there is no point
    MatrixXd byPoint;               //!< 4x3, of both pixels
};

class PartnerMisfits
{
public:
    PartnerMisfits(const Calibration& calibration, const Measurement& m, double pixelSigma)
        : m_(m), sigma_(pixelSigma), R_(toEigen(Mat(calibration.R)))
    {
        Vec3d rvec;
        Rodrigues(calibration.R, rvec);
        const Vec3d tvecs[] = {Vec3d(), calibration.T}, rvecs[] = {Vec3d(), rvec};
        for (int c = 0; c < 2; c++)
        {
            refract::refractiveProjectPoints(m.points, rvecs[c], tvecs[c], calibration.cameras[c].camera, predicted_[c]);
            derivatives_[c] = differentiatePoints(calibration.cameras[c].camera, m.points, rvecs[c], tvecs[c]);
        }
        if (!calibration.covariance.empty())
            covariance_ = toEigen(calibration.covariance);
    }

    PartnerMisfit operator()(size_t i) const
    {
        const PointDerivatives &d1 = derivatives_[0], &d2 = derivatives_[1];
        const Point2d e1 = m_.pixels1[i] - predicted_[0][i], e2 = m_.pixels2[i] - predicted_[1][i];
        MatrixXd J(4, 3);
        J << d1.byPose.block(2*i, 3, 2, 3), d2.byPose.block(2*i, 3, 2, 3)*R_;
        if (!J.allFinite())
            return {NOT_KNOWN, NOT_KNOWN, J};
        const Eigen::Vector4d over = Eigen::HouseholderQR<MatrixXd>(J).householderQ()*Eigen::Vector4d::UnitW();
        double variance = sigma_*sigma_;
        if (covariance_.size())
        {
            const Eigen::Index n1 = d1.byParameters.cols(), n2 = d2.byParameters.cols();
            MatrixXd A = MatrixXd::Zero(4, n1 + n2 + 6);
            A.block(0, 0, 2, n1) = d1.byParameters.middleRows(2*i, 2);
            A.block(2, n1, 2, n2) = d2.byParameters.middleRows(2*i, 2);
            A.block(2, n1 + n2, 2, 6) = d2.byPose.middleRows(2*i, 2);
            const Eigen::VectorXd a = A.transpose()*over;
            variance += a.dot(covariance_*a);
        }
        return {std::abs(over.dot(Eigen::Vector4d(e1.x, e1.y, e2.x, e2.y))), std::sqrt(variance), J};
    }

private:
    const Measurement& m_;
    double sigma_;
    MatrixXd R_, covariance_;
    std::vector<Point2d> predicted_[2];
    PointDerivatives derivatives_[2];
};

/* How many times as large as expected the misfits of a view are, by their median, which a few wrong points do not move. 1 if
that may be chance: of the noise of so few points, or of the calibration's error, which is one for all points of the view. */
double timesNoisier(const std::vector<PartnerMisfit>& misfits, double pixelSigma)
{
    std::vector<double> ratios;
    double ofPixels = 0;            // share of the variance
    for (const PartnerMisfit& misfit : misfits)
        if (misfit.expected > 0)
        {
            ratios.push_back(misfit.pixels/misfit.expected);
            ofPixels += std::pow(pixelSigma/misfit.expected, 2);
        }
    if (ratios.empty())
        return 1.;
    ofPixels /= ratios.size();
    const double byNoise = 1 + 4.7/std::sqrt((double)ratios.size());      // four standard deviations of the median's estimate
    const double byCalibration = USUAL/MEDIAN;
    const double byChance = std::sqrt(ofPixels*byNoise*byNoise + (1 - ofPixels)*byCalibration*byCalibration);
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size()/2, ratios.end());
    const double times = ratios[ratios.size()/2]/MEDIAN;
    return times > byChance ? times : 1.;
}

void forget(Measurement& m, size_t i)
{
    m.points[i] = Point3d(NOT_KNOWN, NOT_KNOWN, NOT_KNOWN);
    m.sigma[i] = Vec3d::all(NOT_KNOWN);
}

} // namespace

void judgePartners(const Calibration& calibration, double pixelSigma, Measurement& m)
{
    const bool known = pixelSigma > 0;
    const PartnerMisfits misfitOf(calibration, m, known ? pixelSigma : 0.);
    std::vector<PartnerMisfit> misfits;
    for (size_t i = 0; i < m.points.size(); i++)
        misfits.push_back(misfitOf(i));
    const double times = known ? timesNoisier(misfits, pixelSigma) : 1.;
    if (times > 1)
        m.noise = times*pixelSigma;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        const double misfit = misfits[i].pixels, expected = known ? misfits[i].expected : 0.;
        if (!(misfit == misfit))
            continue;
        const double limit = known ? FEW*std::min(times, NOISIER)*expected : GROSS_PIXELS;
        if (known)
        {
            const double beyond = std::max(0., misfit*misfit - std::pow(USUAL*times*expected, 2));
            const double more = (times*times - 1)*pixelSigma*pixelSigma + beyond;
            const MatrixXd& J = misfits[i].byPoint;
            const MatrixXd C = more*(J.transpose()*J).inverse();
            for (int k = 0; k < 3; k++)
                m.sigma[i][k] = std::sqrt(m.sigma[i][k]*m.sigma[i][k] + C(k, k));
        }
        if (misfit > limit)
        {
            m.status[i] = INCONSISTENT;
            m.worstMisfit = std::max(m.worstMisfit, misfit);
            if (misfit > std::max(GROSS_PIXELS, GROSS*expected))
                forget(m, i);
        }
    }
}

void judgePose(double pixelSigma, Measurement& m)
{
    if (!(m.noise > (pixelSigma > 0 ? FEW*pixelSigma : GROSS_PIXELS)))
        return;
    std::fill(m.status.begin(), m.status.end(), INCONSISTENT);
    std::fill(m.sigma.begin(), m.sigma.end(), Vec3d::all(NOT_KNOWN));     // residuals do not tell what a wrong model does
    m.worstMisfit = m.noise;
}

} // namespace tools
