#include "assess/measurement.hpp"
#include "assess/view_derivatives.hpp"

#include <opencv2/calib3d.hpp>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point3d;
using cv::Vec3d;
using cv::refract::RefractiveCamera;
using Eigen::MatrixXd;

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

// Of misfits, in standard deviations: what noise may do, what it cannot, and what cannot even be used.
const double USUAL = 3., FEW = 5., GROSS = 20.;
const double MEDIAN = 0.6745;           // of |N(0, 1)|
const double GROSS_PIXELS = 2.;         // no corner that was found is farther off
const double NOISIER = 3.;              // images may be so much noisier than those of the calibration

struct Derivatives
{
    MatrixXd byPose, byParameters;      //!< of u, v of each point; parameters: lens and window
};

Derivatives differentiate(const cv::Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points, const Vec3d& rvec,
                          const Vec3d& tvec)
{
    Mat ignored, jacobian;
    cv::refract::refractiveProjectPoints(points, rvec, tvec, camera, ignored, cv::noArray(), jacobian);
    const MatrixXd J = toEigen(jacobian);
    return {J.leftCols(6), J.rightCols(J.cols() - 6)};
}

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

//! What is left over of the two pixels of a point.
struct Misfit
{
    double pixels, expected;        //!< expected: one standard deviation; NaN where there is no point
    MatrixXd byPoint;               //!< 4x3, of both pixels
};

class MisfitOf
{
public:
    MisfitOf(const Calibration& calibration, const Measurement& m, double pixelSigma)
        : m_(m), sigma_(pixelSigma), R_(toEigen(Mat(calibration.R)))
    {
        Vec3d rvec;
        cv::Rodrigues(calibration.R, rvec);
        const Vec3d tvecs[] = {Vec3d(), calibration.T}, rvecs[] = {Vec3d(), rvec};
        for (int c = 0; c < 2; ++c)
        {
            cv::refract::refractiveProjectPoints(m.points, rvecs[c], tvecs[c], calibration.cameras[c].camera, predicted_[c]);
            derivatives_[c] = differentiate(calibration.cameras[c].camera, m.points, rvecs[c], tvecs[c]);
        }
        if (!calibration.covariance.empty())
            covariance_ = toEigen(calibration.covariance);
    }

    Misfit operator()(size_t i) const
    {
        const Derivatives &d1 = derivatives_[0], &d2 = derivatives_[1];
        const Point2d e1 = m_.pixels1[i] - predicted_[0][i], e2 = m_.pixels2[i] - predicted_[1][i];
        MatrixXd J(4, 3);
        J << d1.byPose.block(2 * i, 3, 2, 3), d2.byPose.block(2 * i, 3, 2, 3) * R_;
        if (!J.allFinite())
            return {NOT_KNOWN, NOT_KNOWN, J};
        const Eigen::Vector4d over = Eigen::HouseholderQR<MatrixXd>(J).householderQ() * Eigen::Vector4d::UnitW();
        double variance = sigma_ * sigma_;
        if (covariance_.size())
        {
            const Eigen::Index n1 = d1.byParameters.cols(), n2 = d2.byParameters.cols();
            MatrixXd A = MatrixXd::Zero(4, n1 + n2 + 6);
            A.block(0, 0, 2, n1) = d1.byParameters.middleRows(2 * i, 2);
            A.block(2, n1, 2, n2) = d2.byParameters.middleRows(2 * i, 2);
            A.block(2, n1 + n2, 2, 6) = d2.byPose.middleRows(2 * i, 2);
            const Eigen::VectorXd a = A.transpose() * over;
            variance += a.dot(covariance_ * a);
        }
        return {std::abs(over.dot(Eigen::Vector4d(e1.x, e1.y, e2.x, e2.y))), std::sqrt(variance), J};
    }

private:
    const Measurement& m_;
    double sigma_;
    MatrixXd R_, covariance_;
    std::vector<Point2d> predicted_[2];
    Derivatives derivatives_[2];
};

/* How many times as large as expected the misfits of a view are, by their median, which a few wrong points do not move. 1 if
that may be chance: of the noise of so few points, or of the calibration's error, which is one for all points of the view. */
double timesNoisier(const std::vector<Misfit>& misfits, double pixelSigma)
{
    std::vector<double> ratios;
    double ofPixels = 0;            // share of the variance
    for (const Misfit& misfit : misfits)
        if (misfit.expected > 0)
        {
            ratios.push_back(misfit.pixels / misfit.expected);
            ofPixels += std::pow(pixelSigma / misfit.expected, 2);
        }
    if (ratios.empty())
        return 1.;
    ofPixels /= ratios.size();
    const double byNoise = 1 + 4.7 / std::sqrt((double)ratios.size());      // four standard deviations of the median's estimate
    const double byCalibration = USUAL / MEDIAN;
    const double byChance = std::sqrt(ofPixels * byNoise * byNoise + (1 - ofPixels) * byCalibration * byCalibration);
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
    const double times = ratios[ratios.size() / 2] / MEDIAN;
    return times > byChance ? times : 1.;
}

void forget(Measurement& m, size_t i)
{
    m.points[i] = Point3d(NOT_KNOWN, NOT_KNOWN, NOT_KNOWN);
    m.sigma[i] = Vec3d::all(NOT_KNOWN);
}

//! Standard deviation of a pixel coordinate from what a pose leaves.
double residualSigma(const std::vector<Point2d>& seenPixels, const std::vector<Point2d>& predicted)
{
    double squares = 0;
    for (size_t i = 0; i < seenPixels.size(); ++i)
        squares += std::pow(cv::norm(seenPixels[i] - predicted[i]), 2);
    return std::sqrt(squares / std::max(1., 2. * seenPixels.size() - 6));
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
    for (size_t i = 0; i < pixels1.size(); ++i)
        count += seen(pixels1[i]) && (pixels2.empty() || seen(pixels2[i]));
    return count;
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

void judgePartners(const Calibration& calibration, double pixelSigma, Measurement& m)
{
    const bool known = pixelSigma > 0;
    const MisfitOf misfitOf(calibration, m, known ? pixelSigma : 0.);
    std::vector<Misfit> misfits;
    for (size_t i = 0; i < m.points.size(); ++i)
        misfits.push_back(misfitOf(i));
    const double times = known ? timesNoisier(misfits, pixelSigma) : 1.;
    if (times > 1)
        m.noise = times * pixelSigma;
    for (size_t i = 0; i < m.points.size(); ++i)
    {
        const double misfit = misfits[i].pixels, expected = known ? misfits[i].expected : 0.;
        if (!(misfit == misfit))
            continue;
        const double limit = known ? FEW * std::min(times, NOISIER) * expected : GROSS_PIXELS;
        if (known)
        {
            const double beyond = std::max(0., misfit * misfit - std::pow(USUAL * times * expected, 2));
            const double more = (times * times - 1) * pixelSigma * pixelSigma + beyond;
            const MatrixXd& J = misfits[i].byPoint;
            const MatrixXd C = more * (J.transpose() * J).inverse();
            for (int k = 0; k < 3; ++k)
                m.sigma[i][k] = std::sqrt(m.sigma[i][k] * m.sigma[i][k] + C(k, k));
        }
        if (misfit > limit)
        {
            m.status[i] = INCONSISTENT;
            m.worstMisfit = std::max(m.worstMisfit, misfit);
            if (misfit > std::max(GROSS_PIXELS, GROSS * expected))
                forget(m, i);
        }
    }
}

void judgePose(double pixelSigma, Measurement& m)
{
    if (!(m.noise > (pixelSigma > 0 ? FEW * pixelSigma : GROSS_PIXELS)))
        return;
    std::fill(m.status.begin(), m.status.end(), INCONSISTENT);
    std::fill(m.sigma.begin(), m.sigma.end(), Vec3d::all(NOT_KNOWN));     // residuals do not tell what a wrong model does
    m.worstMisfit = m.noise;
}

/* A point on a plane, X = X0 + B s with a 2-column basis B, is where its projection is the pixel:
    ds = (P B)^-1 (du - A dp)      P: pixel by point, A: pixel by lens and window */
Measurement measureOnPlane(const Calibration& calibration, const std::vector<Point2d>& pixels, const cv::Vec4d& plane,
                           double pixelSigma)
{
    const auto& camera = calibration.cameras[0].camera;
    Measurement result;
    result.pixels1 = pixels;
    cv::refract::refractivePointsOnPlane(pixels, result.points, camera, plane, result.status);
    const Derivatives d = differentiate(camera, result.points, Vec3d(), Vec3d());
    const MatrixXd C = covarianceOfCamera1(calibration, d.byParameters.cols());
    const MatrixXd B = Eigen::JacobiSVD<MatrixXd>(Eigen::RowVector3d(plane[0], plane[1], plane[2]),
                                                  Eigen::ComputeFullV).matrixV().rightCols(2);
    for (size_t i = 0; i < pixels.size(); ++i)
    {
        const MatrixXd A = d.byParameters.middleRows(2 * i, 2);
        const MatrixXd byPixel = B * (d.byPose.block(2 * i, 3, 2, 3) * B).inverse();
        const MatrixXd ofPixel = pixelSigma * pixelSigma * MatrixXd::Identity(2, 2) + A * C * A.transpose();
        result.sigma.push_back(deviations(byPixel * ofPixel * byPixel.transpose()));
    }
    return result;
}

/* The pose of least squares: dpose = K^+ (du - A dp), K: pixels by pose. */
Measurement measureTarget(const Calibration& calibration, const Target& target, const std::vector<Point2d>& pixels,
                          double pixelSigma)
{
    const auto& camera = calibration.cameras[0].camera;
    Vec3d rvec, tvec;
    if (!cv::refract::refractiveSolvePnP(target.objectPoints(), pixels, camera, rvec, tvec))
        throw Failure("no pose of the target explains its points: check --size and --square");
    std::vector<Point3d> seenPoints;
    std::vector<Point2d> seenPixels, predicted;
    for (size_t i = 0; i < pixels.size(); ++i)
        if (seen(pixels[i]))
        {
            seenPoints.push_back(target.objectPoints()[i]);
            seenPixels.push_back(pixels[i]);
        }
    Measurement result;
    cv::refract::refractiveProjectPoints(seenPoints, rvec, tvec, camera, predicted);
    const double residual = residualSigma(seenPixels, predicted);
    if (!(residual <= pixelSigma))
        result.noise = residual;
    if (residual > pixelSigma)
        pixelSigma = residual;
    const Derivatives d = differentiate(camera, seenPoints, rvec, tvec);
    const MatrixXd inverse = (d.byPose.transpose() * d.byPose).inverse();
    const MatrixXd byParameters = inverse * d.byPose.transpose() * d.byParameters;
    const MatrixXd ofPose = pixelSigma * pixelSigma * inverse
        + byParameters * covarianceOfCamera1(calibration, byParameters.cols()) * byParameters.transpose();

    cv::Matx33d R;
    Mat jacobian;                               // 3x9: by rvec, of R row by row
    cv::Rodrigues(rvec, R, jacobian);
    const MatrixXd dR = toEigen(jacobian);
    result.pixels1 = pixels;
    for (const Point3d& point : target.objectPoints())
    {
        const Vec3d X(point);
        result.points.push_back(Point3d(R * X + tvec));
        MatrixXd byPose(3, 6);
        byPose.rightCols(3).setIdentity();
        for (int row = 0; row < 3; ++row)
            byPose.block(row, 0, 1, 3) = (dR.middleCols(3 * row, 3) * Eigen::Vector3d(X[0], X[1], X[2])).transpose();
        result.sigma.push_back(deviations(byPose * ofPose * byPose.transpose()));
        result.status.push_back(cv::refract::REFRACT_OK);
    }
    return result;
}

Calibration withoutWindows(const Calibration& calibration)
{
    Calibration bare = calibration;
    bare.covariance.release();      // it speaks of windows
    for (CameraCalibration& c : bare.cameras)
        c.camera = copyWithWindow(c.camera, cv::refract::GlassWindow());
    return bare;
}

double pixelSigmaOf(const Calibration& calibration)
{
    if (calibration.sigma >= 0)
        return calibration.sigma;
    const double rms = calibration.rms >= 0 ? calibration.rms : calibration.cameras[0].rms;
    return rms >= 0 ? rms / std::sqrt(2.) : NOT_KNOWN;
}

//! Measured and true, of each pair of neighbours that was measured.
static std::vector<std::pair<double, double>> lengthsOf(const Target& target, const std::vector<Point3d>& points)
{
    std::vector<std::pair<double, double>> lengths;
    for (const auto& pair : target.neighbours())
    {
        const double measured = cv::norm(points[pair.second] - points[pair.first]);
        if (measured == measured)
            lengths.push_back({measured, cv::norm(target.objectPoints()[pair.second] - target.objectPoints()[pair.first])});
    }
    return lengths;
}

std::vector<double> lengthErrors(const Target& target, const std::vector<Point3d>& points)
{
    std::vector<double> errors;
    for (const auto& length : lengthsOf(target, points))
        errors.push_back(length.first - length.second);
    return errors;
}

std::vector<double> lengthRatios(const Target& target, const std::vector<Point3d>& points)
{
    std::vector<double> ratios;
    for (const auto& length : lengthsOf(target, points))
        ratios.push_back(length.first / length.second);
    return ratios;
}

} // namespace tools
