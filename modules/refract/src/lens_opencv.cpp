// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens.hpp"
#include "monotone.hpp"

/* OpenCV's lens model (calib3d's documentation), x = X/Z, y = Y/Z, s = r^2 = x^2 + y^2:

    x'' = x N(s)/D(s) + 2 p1 x y + p2 (s + 2 x^2) + s1 s + s2 s^2
    y'' = y N(s)/D(s) + p1 (s + 2 y^2) + 2 p2 x y + s3 s + s4 s^2
    N = 1 + k1 s + k2 s^2 + k3 s^3,  D = 1 + k4 s + k5 s^2 + k6 s^3

then, with tau_x, tau_y, the homography of a tilted sensor, then fx, fy, cx, cy.

Domain: Z > 0; r below the first maximum (or pole) of the radial part r N/D; the Jacobian's determinant positive. Beyond
it the model folds back onto the image and pixels have no meaning. */

namespace cv { namespace refract {

namespace {

//! Positions in OpenCV's order of coefficients.
enum { K1, K2, P1, P2, K3, K4, K5, K6, S1, S2, S3, S4, TAUX, TAUY, COUNT };

class OpenCVLens : public Lens
{
public:
    OpenCVLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs, const String& model);

    void project(int n, const double* x, const double* y, const double* z,
                 double* u, double* v, uchar* status) const CV_OVERRIDE;
    void unproject(int n, const double* u, const double* v,
                   double* x, double* y, double* z, uchar* status) const CV_OVERRIDE;
    uchar projectJacobian(const Vec3d& direction, Vec2d& pixel, double* dDirection, double* dParameters) const CV_OVERRIDE;

    String model() const CV_OVERRIDE { return model_; }
    Mat cameraMatrix() const CV_OVERRIDE { return Mat(Matx33d(fx_, 0, cx_, 0, fy_, cy_, 0, 0, 1), true); }
    Mat distCoeffs() const CV_OVERRIDE { return given_ ? Mat(given_, 1, CV_64F, (void*)k_).clone() : Mat(); }
    std::vector<double> parameters() const CV_OVERRIDE;
    Ptr<Lens> withParameters(const std::vector<double>& parameters) const CV_OVERRIDE;

private:
    //! (x, y) -> distorted, before tilt, and its 2x2 Jacobian.
    void distort(double x, double y, double& xd, double& yd, Matx22d& J) const;
    double radial(double r, double& slope) const;
    bool inside(double s, const Matx22d& J) const { return s < sMax_ && J(0, 0)*J(1, 1) - J(0, 1)*J(1, 0) > 0; }
    uchar undistort(double xd, double yd, double& x, double& y) const;

    double fx_, fy_, cx_, cy_;
    double k_[COUNT];
    int given_;
    String model_;
    double sMax_;               //!< square of the radius where the radial part stops growing
    bool radialOnly_, tilted_;
    Matx33d tilt_, untilt_;
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
    for (int i = 0; i < 2; ++i)
    {
        const Matx33d dR = i == 0 ? RY*dRX : dRY*RX;
        dTilt[i] = Matx33d(dR(2, 2), 0, -dR(0, 2), 0, dR(2, 2), -dR(1, 2), 0, 0, 0)*R + P*dR;
    }
}

//! Radius^2 up to which r N(r^2)/D(r^2) grows: first root of N D + 2 s (N' D - N D'), or of D.
double monotoneRange(const double* k)
{
    const double N[4] = { 1, k[K1], k[K2], k[K3] }, D[4] = { 1, k[K4], k[K5], k[K6] };
    std::vector<double> slope(7, 0.);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            slope[i + j] += N[i]*D[j]*(1 + 2*(i - j));
    return std::min(firstPositiveRoot(slope), firstPositiveRoot(std::vector<double>(D, D + 4)));
}

OpenCVLens::OpenCVLens(const Matx33d& K, const std::vector<double>& distCoeffs, const String& model)
    : fx_(K(0, 0)), fy_(K(1, 1)), cx_(K(0, 2)), cy_(K(1, 2)), given_((int)distCoeffs.size()), model_(model)
{
    if (K(0, 1) != 0)
        CV_Error_(Error::StsBadArg, ("cameraMatrix(0, 1) is %g; this lens model has no skew", K(0, 1)));
    std::fill(k_, k_ + COUNT, 0.);
    std::copy(distCoeffs.begin(), distCoeffs.end(), k_);
    sMax_ = monotoneRange(k_);
    tilted_ = k_[TAUX] != 0 || k_[TAUY] != 0;
    radialOnly_ = k_[P1] == 0 && k_[P2] == 0 && k_[S1] == 0 && k_[S2] == 0 && k_[S3] == 0 && k_[S4] == 0;
    tilt_ = tiltMatrix(k_[TAUX], k_[TAUY]);
    untilt_ = tilt_.inv();
}

void OpenCVLens::distort(double x, double y, double& xd, double& yd, Matx22d& J) const
{
    const double* k = k_;
    const double s = x*x + y*y;
    const double N = 1 + s*(k[K1] + s*(k[K2] + s*k[K3])), D = 1/(1 + s*(k[K4] + s*(k[K5] + s*k[K6])));
    const double dN = k[K1] + s*(2*k[K2] + s*3*k[K3]), dD = k[K4] + s*(2*k[K5] + s*3*k[K6]);
    const double F = N*D, F2 = 2*(dN - F*dD)*D;     // F2 = 2 dF/ds
    const double prismX = k[S1] + 2*k[S2]*s, prismY = k[S3] + 2*k[S4]*s;
    xd = x*F + 2*k[P1]*x*y + k[P2]*(s + 2*x*x) + s*(k[S1] + s*k[S2]);
    yd = y*F + k[P1]*(s + 2*y*y) + 2*k[P2]*x*y + s*(k[S3] + s*k[S4]);
    J(0, 0) = F + F2*x*x + 2*k[P1]*y + 6*k[P2]*x + 2*x*prismX;
    J(0, 1) = F2*x*y + 2*k[P1]*x + 2*k[P2]*y + 2*y*prismX;
    J(1, 0) = F2*x*y + 2*k[P1]*x + 2*k[P2]*y + 2*x*prismY;
    J(1, 1) = F + F2*y*y + 6*k[P1]*y + 2*k[P2]*x + 2*y*prismY;
}

double OpenCVLens::radial(double r, double& slope) const
{
    const double* k = k_;
    const double s = r*r, D = 1/(1 + s*(k[K4] + s*(k[K5] + s*k[K6])));
    const double F = (1 + s*(k[K1] + s*(k[K2] + s*k[K3])))*D;
    slope = F + 2*s*D*(k[K1] + s*(2*k[K2] + s*3*k[K3]) - F*(k[K4] + s*(2*k[K5] + s*3*k[K6])));
    return r*F;
}

void OpenCVLens::project(int n, const double* X, const double* Y, const double* Z,
                         double* u, double* v, uchar* status) const
{
    for (int i = 0; i < n; ++i)
    {
        const double x = X[i]/Z[i], y = Y[i]/Z[i];
        double xd, yd;
        Matx22d J;
        distort(x, y, xd, yd, J);
        double w = 1;
        if (tilted_)
        {
            const Vec3d t = tilt_*Vec3d(xd, yd, 1);
            w = t[2];
            xd = t[0]/w; yd = t[1]/w;
        }
        u[i] = fx_*xd + cx_;
        v[i] = fy_*yd + cy_;
        if (status[i] == REFRACT_OK && !(Z[i] > 0))
            status[i] = REFRACT_BEHIND_CAMERA;
        if (status[i] == REFRACT_OK && !(inside(x*x + y*y, J) && w > 0))
            status[i] = REFRACT_OUTSIDE_LENS_MODEL;
    }
}

/* The radial part alone has exactly one solution, by a safeguarded one-dimensional Newton; from there Newton in the
plane takes in what is not radial, with steps cut so that it stays inside the domain. */
uchar OpenCVLens::undistort(double xd, double yd, double& x, double& y) const
{
    const double target = std::sqrt(xd*xd + yd*yd);
    double r = invertMonotone([this](double radius, double& slope) { return radial(radius, slope); }, target, std::sqrt(sMax_));
    if (!std::isfinite(r))
    {
        if (radialOnly_)
            return REFRACT_OUTSIDE_LENS_MODEL;
        r = std::isfinite(sMax_) ? 0.999*std::sqrt(sMax_) : target;
    }
    const double scale = target > 0 ? r/target : 1;
    x = xd*scale; y = yd*scale;
    if (radialOnly_)
        return REFRACT_OK;

    double fx, fy, best = DBL_MAX;
    Matx22d J;
    const double floor = 4*DBL_EPSILON*(1 + target);
    for (int i = 0; i < 50; ++i)
    {
        distort(x, y, fx, fy, J);
        const double ex = fx - xd, ey = fy - yd, error = std::abs(ex) + std::abs(ey);
        if (error <= floor || (error >= best && error <= 1e3*floor))     // rounding has taken over
            return inside(x*x + y*y, J) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
        best = std::min(best, error);
        const double det = J(0, 0)*J(1, 1) - J(0, 1)*J(1, 0);
        double stepX = -(J(1, 1)*ex - J(0, 1)*ey)/det, stepY = -(J(0, 0)*ey - J(1, 0)*ex)/det;
        for (int cut = 0; cut < 60; ++cut, stepX *= 0.5, stepY *= 0.5)
        {
            double a, b;
            const double xn = x + stepX, yn = y + stepY;
            distort(xn, yn, a, b, J);
            if (inside(xn*xn + yn*yn, J))
                break;
        }
        x += stepX; y += stepY;
    }
    return REFRACT_OUTSIDE_LENS_MODEL;      // Newton is stuck at the edge of the domain: no direction leads here
}

void OpenCVLens::unproject(int n, const double* u, const double* v,
                           double* x, double* y, double* z, uchar* status) const
{
    for (int i = 0; i < n; ++i)
    {
        if (status[i] != REFRACT_OK)
            continue;
        double xd = (u[i] - cx_)/fx_, yd = (v[i] - cy_)/fy_;
        if (tilted_)
        {
            const Vec3d t = untilt_*Vec3d(xd, yd, 1);
            if (!(t[2] > 0))
            {
                status[i] = REFRACT_OUTSIDE_LENS_MODEL;
                continue;
            }
            xd = t[0]/t[2]; yd = t[1]/t[2];
        }
        status[i] = undistort(xd, yd, x[i], y[i]);
        z[i] = 1/std::sqrt(1 + x[i]*x[i] + y[i]*y[i]);
        x[i] *= z[i];
        y[i] *= z[i];
    }
}

uchar OpenCVLens::projectJacobian(const Vec3d& d, Vec2d& pixel, double* dDirection, double* dParameters) const
{
    uchar status = REFRACT_OK;
    project(1, &d[0], &d[1], &d[2], &pixel[0], &pixel[1], &status);
    if (status != REFRACT_OK)
        return status;

    const double x = d[0]/d[2], y = d[1]/d[2], s = x*x + y*y;
    double xd, yd;
    Matx22d J, T = Matx22d::eye();      // T: the sensor's tilt
    distort(x, y, xd, yd, J);
    Vec3d t(xd, yd, 1);
    if (tilted_)
    {
        t = tilt_*t;
        for (int r = 0; r < 2; ++r)
            for (int c = 0; c < 2; ++c)
                T(r, c) = (tilt_(r, c) - t[r]/t[2]*tilt_(2, c))/t[2];
    }
    const double f[2] = { fx_, fy_ };
    const Matx22d TJ = T*J;
    for (int r = 0; r < 2; ++r)
    {
        dDirection[3*r] = f[r]*TJ(r, 0)/d[2];
        dDirection[3*r + 1] = f[r]*TJ(r, 1)/d[2];
        dDirection[3*r + 2] = -f[r]*(TJ(r, 0)*x + TJ(r, 1)*y)/d[2];
    }
    if (!dParameters)
        return status;

    const double* k = k_;
    const double D = 1/(1 + s*(k[K4] + s*(k[K5] + s*k[K6])));
    const double F = (1 + s*(k[K1] + s*(k[K2] + s*k[K3])))*D, s2 = s*s, s3 = s2*s;
    const double dDistorted[2][TAUX] = {
        { x*s*D, x*s2*D, 2*x*y, s + 2*x*x, x*s3*D, -x*F*s*D, -x*F*s2*D, -x*F*s3*D, s, s2, 0, 0 },
        { y*s*D, y*s2*D, s + 2*y*y, 2*x*y, y*s3*D, -y*F*s*D, -y*F*s2*D, -y*F*s3*D, 0, 0, s, s2 } };
    Matx33d dTilt[2];
    if (given_ > TAUX)
        tiltDerivatives(k[TAUX], k[TAUY], dTilt);
    const int count = 4 + given_;
    std::fill(dParameters, dParameters + 2*count, 0.);
    for (int r = 0; r < 2; ++r)
    {
        double* row = dParameters + r*count;
        row[r] = t[r]/t[2];
        row[2 + r] = 1;
        for (int c = 0; c < std::min<int>(given_, TAUX); ++c)
            row[4 + c] = f[r]*(T(r, 0)*dDistorted[0][c] + T(r, 1)*dDistorted[1][c]);
        for (int c = TAUX; c < given_; ++c)
        {
            const Vec3d dt = dTilt[c - TAUX]*Vec3d(xd, yd, 1);
            row[4 + c] = f[r]*(dt[r] - t[r]/t[2]*dt[2])/t[2];
        }
    }
    return status;
}

std::vector<double> OpenCVLens::parameters() const
{
    std::vector<double> p = { fx_, fy_, cx_, cy_ };
    p.insert(p.end(), k_, k_ + given_);
    return p;
}

Ptr<Lens> OpenCVLens::withParameters(const std::vector<double>& p) const
{
    return makeOpenCVLens(Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1),
                          std::vector<double>(p.begin() + 4, p.end()), model_);
}

} // namespace

Ptr<Lens> makeOpenCVLens(const Matx33d& cameraMatrix, const std::vector<double>& distCoeffs, const String& model)
{
    return makePtr<OpenCVLens>(cameraMatrix, distCoeffs, model);
}

}} // namespace
