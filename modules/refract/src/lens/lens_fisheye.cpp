// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/fisheye_model.hpp"
#include "lens/kernel_lens.hpp"
#include "lens/models.hpp"
#include "math/monotone.hpp"

/* cv::fisheye's model (@cite KannalaBrandt2006), theta = angle to the z axis:

    theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
    u = fx (x + alpha y) + cx,  v = fy y + cy,  (x, y) = theta_d (X, Y)/|(X, Y)|

Domain: theta below the first maximum of theta_d, at most pi. The model goes on beyond 90 degrees, where cv::fisheye
itself does not. */

namespace cv { namespace refract {

namespace {

class FisheyeLens : public KernelLens<FisheyeModel>
{
public:
    FisheyeLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs);

    int parameterCount() const CV_OVERRIDE { return 8; }
    std::vector<String> parameterNames() const CV_OVERRIDE { return { "fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4" }; }

    String model() const CV_OVERRIDE { return "fisheye"; }
    Mat cameraMatrix() const CV_OVERRIDE { return Mat(K_, true); }
    Mat distCoeffs() const CV_OVERRIDE { return Mat(4, 1, CV_64F, (void*)m_.k).clone(); }
    std::vector<double> parameters() const CV_OVERRIDE;
    Ptr<Lens> withParameters(const std::vector<double>& parameters) const CV_OVERRIDE;

private:
    double bend(double theta, double& slope) const;     //!< theta -> theta_d
    void fitStart() const CV_OVERRIDE;
    //! The kernel knows all pixels that there are.
    uchar projectOne(double, double, double, double&, double&) const CV_OVERRIDE { return REFRACT_OUTSIDE_LENS_MODEL; }
    uchar unprojectOne(double u, double v, double& x, double& y, double& z) const CV_OVERRIDE;

    Matx33d K_;
};

FisheyeLens::FisheyeLens(const Matx33d& K, const std::vector<double>& distCoeffs)
    : KernelLens<FisheyeModel>(fisheyeKernels), K_(K)
{
    m_.fx = K(0, 0); m_.fy = K(1, 1); m_.cx = K(0, 2); m_.cy = K(1, 2);
    m_.alpha = K(0, 1)/K(0, 0);
    double* k = m_.k;
    std::fill(k, k + 4, 0.);
    std::copy(distCoeffs.begin(), distCoeffs.end(), k);
    const double slopeTerms[] = { 1, 3*k[0], 5*k[1], 7*k[2], 9*k[3] };
    m_.thetaMax = std::min(CV_PI, std::sqrt(firstPositiveRoot(slopeTerms, 5)));
}

void FisheyeLens::fitStart() const
{
    // As for OpenCV's model.
    const auto bendFunction = [this](double theta, double& slope) { return bend(theta, slope); };
    const double corner = std::max(0.2, 1.1*std::hypot(m_.cx/m_.fx, m_.cy/m_.fy));
    const double theta = invertMonotone(bendFunction, corner, m_.thetaMax);
    fitInverse(bendFunction, std::isfinite(theta) ? theta : 0.95*m_.thetaMax, TERMS, m_.inverse);
}

double FisheyeLens::bend(double theta, double& slope) const
{
    double factor;
    bendFactor(m_, theta*theta, factor, slope);
    return theta*factor;
}

uchar FisheyeLens::unprojectOne(double u, double v, double& x, double& y, double& z) const
{
    const double yd = (v - m_.cy)/m_.fy, xd = (u - m_.cx)/m_.fx - m_.alpha*yd, target = std::sqrt(xd*xd + yd*yd);
    const double theta = invertMonotone([this](double t, double& slope) { return bend(t, slope); }, target, m_.thetaMax);
    const double scale = target > 0 ? std::sin(theta)/target : 1;
    x = xd*scale;
    y = yd*scale;
    z = std::cos(theta);
    return std::isfinite(theta) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

std::vector<double> FisheyeLens::parameters() const
{
    std::vector<double> p = { m_.fx, m_.fy, m_.cx, m_.cy };
    p.insert(p.end(), m_.k, m_.k + 4);
    return p;
}

Ptr<Lens> FisheyeLens::withParameters(const std::vector<double>& p) const
{
    return makePtr<FisheyeLens>(Matx33d(p[0], m_.alpha*p[0], p[2], 0, p[1], p[3], 0, 0, 1),
                                std::vector<double>(p.begin() + 4, p.end()));
}

} // namespace

Ptr<Lens> makeFisheyeLens(const LensSpec& spec) { return makePtr<FisheyeLens>(spec.cameraMatrix, spec.distCoeffs); }

}} // namespace
