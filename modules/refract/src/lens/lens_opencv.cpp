// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/opencv_model.hpp"
#include "lens/kernel_lens.hpp"
#include "lens/models.hpp"
#include "math/monotone.hpp"

/* OpenCV's lens model (calib3d's documentation), x = X/Z, y = Y/Z, s = r^2 = x^2 + y^2:

    x'' = x N(s)/D(s) + 2 p1 x y + p2 (s + 2 x^2) + s1 s + s2 s^2
    y'' = y N(s)/D(s) + p1 (s + 2 y^2) + 2 p2 x y + s3 s + s4 s^2
    N = 1 + k1 s + k2 s^2 + k3 s^3,  D = 1 + k4 s + k5 s^2 + k6 s^3

then, with tau_x, tau_y, the homography of a tilted sensor, then fx, fy, cx, cy.

Domain: Z > 0; r below the first maximum (or pole) of the radial part r N/D; the Jacobian's determinant positive. Beyond
it the model folds back onto the image and pixels have no meaning. */

namespace cv { namespace refract {

namespace {

class OpenCVLens : public KernelLens<OpenCVModel>
{
public:
    OpenCVLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs, const String& model);

    int parameterCount() const CV_OVERRIDE { return 4 + m_.given; }
    std::vector<String> parameterNames() const CV_OVERRIDE
    {
        static const char* const NAMES[] = { "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3",
                                             "s4", "tauX", "tauY" };
        return std::vector<String>(NAMES, NAMES + parameterCount());
    }

    String model() const CV_OVERRIDE { return model_; }
    Mat cameraMatrix() const CV_OVERRIDE { return Mat(Matx33d(m_.fx, 0, m_.cx, 0, m_.fy, m_.cy, 0, 0, 1), true); }
    Mat distCoeffs() const CV_OVERRIDE { return m_.given ? Mat(m_.given, 1, CV_64F, (void*)m_.k).clone() : Mat(); }
    std::vector<double> parameters() const CV_OVERRIDE;
    Ptr<Lens> withParameters(const std::vector<double>& parameters) const CV_OVERRIDE;

private:
    uchar projectOne(double x, double y, double z, double& u, double& v) const CV_OVERRIDE;
    uchar unprojectOne(double u, double v, double& x, double& y, double& z) const CV_OVERRIDE;
    double radial(double r, double& slope) const;
    void fitStart() const CV_OVERRIDE;
    //! Of an undistorting Newton step, up to this distance from the axis: the error that it leaves over its square.
    double curvature(double r) const;
    double startError(double r) const;      //!< of the kernel's search, at this distance from the axis
    bool inside(double x, double y, const Distorted<double>& d) const { return x*x + y*y < m_.sMax && d.determinant() > 0; }
    uchar undistort(double xd, double yd, double& x, double& y) const;

    bool radialOnly_;
    String model_;
};

Matx33d tiltMatrix(double tauX, double tauY)
{
    const double cX = std::cos(tauX), sX = std::sin(tauX), cY = std::cos(tauY), sY = std::sin(tauY);
    const Matx33d R = Matx33d(cY, 0, -sY, 0, 1, 0, sY, 0, cY)*Matx33d(1, 0, 0, 0, cX, sX, 0, -sX, cX);
    return Matx33d(R(2, 2), 0, -R(0, 2), 0, R(2, 2), -R(1, 2), 0, 0, 1)*R;
}

//! Derivatives of tiltMatrix by tauX and tauY: the product rule on the same matrices.
void tiltDerivatives(double tauX, double tauY, Matx33d dTilt[2])
{
    const double cX = std::cos(tauX), sX = std::sin(tauX), cY = std::cos(tauY), sY = std::sin(tauY);
    const Matx33d RX(1, 0, 0, 0, cX, sX, 0, -sX, cX), RY(cY, 0, -sY, 0, 1, 0, sY, 0, cY), R = RY*RX;
    const Matx33d dRX(0, 0, 0, 0, -sX, cX, 0, -cX, -sX), dRY(-sY, 0, -cY, 0, 0, 0, cY, 0, -sY);
    const Matx33d P(R(2, 2), 0, -R(0, 2), 0, R(2, 2), -R(1, 2), 0, 0, 1);
    for (int i = 0; i < 2; i++)
    {
        const Matx33d dR = i == 0 ? RY*dRX : dRY*RX;
        dTilt[i] = Matx33d(dR(2, 2), 0, -dR(0, 2), 0, dR(2, 2), -dR(1, 2), 0, 0, 0)*R + P*dR;
    }
}

//! Radius^2 up to which r N(r^2)/D(r^2) grows: first root of N D + 2 s (N' D - N D'), or of D.
double monotoneRange(const double* k)
{
    const double N[4] = { 1, k[K1], k[K2], k[K3] }, D[4] = { 1, k[K4], k[K5], k[K6] };
    double slope[7] = {};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            slope[i + j] += N[i]*D[j]*(1 + 2*(i - j));
    return std::min(firstPositiveRoot(slope, 7), firstPositiveRoot(D, 4));
}

OpenCVLens::OpenCVLens(const Matx33d& K, const std::vector<double>& distCoeffs, const String& model)
    : KernelLens<OpenCVModel>(openCVKernels), model_(model)
{
    m_.fx = K(0, 0); m_.fy = K(1, 1); m_.cx = K(0, 2); m_.cy = K(1, 2);
    double* k = m_.k;
    std::fill(k, k + DIST_COEFFS, 0.);
    std::copy(distCoeffs.begin(), distCoeffs.end(), k);
    m_.given = (int)distCoeffs.size();
    m_.sMax = monotoneRange(k);
    m_.rational = k[K4] != 0 || k[K5] != 0 || k[K6] != 0;
    m_.tilted = k[TAUX] != 0 || k[TAUY] != 0;
    m_.prism = k[S1] != 0 || k[S2] != 0 || k[S3] != 0 || k[S4] != 0;
    radialOnly_ = k[P1] == 0 && k[P2] == 0 && !m_.prism;
    const Matx33d tilt = tiltMatrix(k[TAUX], k[TAUY]);
    Matx33d untilt = tilt.inv()*Matx33d(1/m_.fx, 0, 0, 0, 1/m_.fy, 0, 0, 0, 1);
    untilt(0, 2) = untilt(1, 2) = 0;    // the tilt leaves the principal point where it is, not just almost
    std::copy(tilt.val, tilt.val + 9, m_.tilt);
    std::copy(untilt.val, untilt.val + 9, m_.untilt);
    Matx33d dTilt[2];
    tiltDerivatives(k[TAUX], k[TAUY], dTilt);
    for (int i = 0; i < 2; i++)
        std::copy(dTilt[i].val, dTilt[i].val + 9, m_.dTilt[i]);
}

void OpenCVLens::fitStart() const
{
    // Exact over the image, whose corner lies about as far from the principal point as the origin does.
    const auto radialFunction = [this](double r, double& slope) { return radial(r, slope); };
    const double corner = std::max(0.2, 1.1*std::hypot(m_.cx/m_.fx, m_.cy/m_.fy));
    double r = invertMonotone(radialFunction, corner, std::sqrt(m_.sMax));
    if (!std::isfinite(r))
        r = 0.95*std::sqrt(m_.sMax);
    fitInverse(radialFunction, r, TERMS, m_.inverse);
    fitInverse(radialFunction, r, ROUGH_TERMS, m_.rough);
    const double image = r/1.1, NOTHING = 2e-14;      // 2e-11 px for a focal length of 1000
    const int MOST = 3;
    m_.sNear = image*image;
    m_.near2 = NOTHING/curvature(image);
    for (m_.shifts = 0; m_.shifts < MOST && std::pow(startError(image), 2) > m_.near2; m_.shifts++) {}
}

double OpenCVLens::curvature(double r) const
{
    const double h = 1e-4*r;
    double worst = 0;
    for (double angle = 0.125*CV_PI; angle < 2*CV_PI; angle += 0.25*CV_PI)
        for (double part : { 0.5, 1. })
        {
            const double x = part*r*std::cos(angle), y = part*r*std::sin(angle);
            const Distorted<double> d = distort(m_, x, y), dx = distort(m_, x + h, y), dy = distort(m_, x, y + h);
            const double change = std::hypot(std::hypot(dx.xx - d.xx, dx.yx - d.yx), std::hypot(dx.xy - d.xy, dx.yy - d.yy))
                                + std::hypot(std::hypot(dy.xx - d.xx, dy.yx - d.yx), std::hypot(dy.xy - d.xy, dy.yy - d.yy));
            const double inverse = std::hypot(std::hypot(d.xx, d.xy), std::hypot(d.yx, d.yy))/d.determinant();
            worst = std::max(worst, 0.5*inverse*change/h);
        }
    return worst;
}

double OpenCVLens::startError(double r) const
{
    double worst = 0;
    for (double angle = 0.125*CV_PI; angle < 2*CV_PI; angle += 0.25*CV_PI)
    {
        const double x = r*std::cos(angle), y = r*std::sin(angle);
        const Distorted<double> d = distort(m_, x, y);
        double foundX, foundY;
        guess(m_, d.x, d.y, foundX, foundY);
        for (int k = 1; k <= m_.shifts; k++)
            shift(m_, k, d.x, d.y, foundX, foundY);
        worst = std::max(worst, std::hypot(foundX - x, foundY - y));
    }
    return worst;
}

double OpenCVLens::radial(double r, double& slope) const
{
    const Radial<double> f(m_, r*r);
    slope = f.F + r*r*f.slope(m_);
    return r*f.F;
}

uchar OpenCVLens::projectOne(double X, double Y, double Z, double& u, double& v) const
{
    const double x = X/Z, y = Y/Z;
    Distorted<double> d = distort(m_, x, y);
    const bool isInside = inside(x, y, d);
    const double w = m_.tilted ? homography(m_.tilt, d.x, d.y) : 1;
    u = m_.fx*d.x + m_.cx;
    v = m_.fy*d.y + m_.cy;
    const bool hasPixel = isInside && w > 0 && std::isfinite(u) && std::isfinite(v);       // huge coefficients overflow
    return !(Z > 0) ? REFRACT_BEHIND_CAMERA : hasPixel ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

/* The radial part alone has exactly one solution, by a safeguarded one-dimensional Newton; from there Newton in the
plane takes in what is not radial, with steps cut so that it stays inside the domain. */
uchar OpenCVLens::undistort(double xd, double yd, double& x, double& y) const
{
    const double target = std::sqrt(xd*xd + yd*yd), rMax = std::sqrt(m_.sMax);
    double r = invertMonotone([this](double radius, double& slope) { return radial(radius, slope); }, target, rMax);
    if (!std::isfinite(r))
    {
        if (radialOnly_)
            return REFRACT_OUTSIDE_LENS_MODEL;
        r = std::isfinite(rMax) ? 0.999*rMax : target;
    }
    const double scale = target > 0 ? r/target : 1;
    x = xd*scale; y = yd*scale;
    if (radialOnly_)
        return REFRACT_OK;

    double best = DBL_MAX;
    const double floor = 4*DBL_EPSILON*(1 + target);
    for (int i = 0; i < 50; i++)
    {
        const Distorted<double> d = distort(m_, x, y);
        const double ex = d.x - xd, ey = d.y - yd, error = std::abs(ex) + std::abs(ey);
        // What a rounding of x and y alone moves the distorted point by: much next to a pole.
        const double rounding = DBL_EPSILON*(std::abs(d.xx) + std::abs(d.xy) + std::abs(d.yx) + std::abs(d.yy))*std::hypot(x, y);
        if (error <= floor || (error >= best && error <= std::max(1e3*floor, 400*rounding)))     // rounding has taken over
            return inside(x, y, d) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
        best = std::min(best, error);
        const double determinant = d.determinant();
        double stepX = -(d.yy*ex - d.xy*ey)/determinant, stepY = -(d.xx*ey - d.yx*ex)/determinant;
        for (int cut = 0; cut < 60 && !inside(x + stepX, y + stepY, distort(m_, x + stepX, y + stepY)); cut++)
        {
            stepX *= 0.5; stepY *= 0.5;
        }
        x += stepX; y += stepY;
    }
    return REFRACT_OUTSIDE_LENS_MODEL;      // Newton is stuck at the edge of the domain: no direction leads here
}

uchar OpenCVLens::unprojectOne(double u, double v, double& x, double& y, double& z) const
{
    double xd = u - m_.cx, yd = v - m_.cy;
    if (!(homography(m_.untilt, xd, yd) > 0))
        return REFRACT_OUTSIDE_LENS_MODEL;      // behind the tilted sensor
    const uchar status = undistort(xd, yd, x, y);
    z = 1/std::sqrt(1 + x*x + y*y);
    x *= z;
    y *= z;
    return status;
}

std::vector<double> OpenCVLens::parameters() const
{
    std::vector<double> p = { m_.fx, m_.fy, m_.cx, m_.cy };
    p.insert(p.end(), m_.k, m_.k + m_.given);
    return p;
}

Ptr<Lens> OpenCVLens::withParameters(const std::vector<double>& p) const
{
    return makePtr<OpenCVLens>(Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1),
                               std::vector<double>(p.begin() + 4, p.end()), model_);
}

} // namespace

Ptr<Lens> makeOpenCVLens(const LensSpec& spec)
{
    spec.requireNoSkew();
    return makePtr<OpenCVLens>(spec.cameraMatrix, spec.distCoeffs, spec.model);
}

}} // namespace
