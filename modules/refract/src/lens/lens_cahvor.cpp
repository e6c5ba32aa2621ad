// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/plane_lens.hpp"
#include "math/monotone.hpp"

/* mrcal's LENSMODEL_CAHVOR and, with a centre that does not move (E = 0), LENSMODEL_CAHVORE_linearity=L (@cite Gennery2006). theta is
the angle to the optical axis o = (sin(alpha) cos(beta), sin(beta), cos(alpha) cos(beta)):

    chi = tan(L theta)/L for L > 0 (CAHVOR: L = 1),  sin(L theta)/L for L < 0,  theta for L = 0
    t = chi (1 + r0 + r1 chi^2 + r2 chi^4)
    (a, b) = (X', Y')/Z',  d' = o + t m,  m = the unit vector across o towards d

With E, the centre moves with the angle: then points, not directions, have images, and there is no such Lens.

Domain: theta below the first maximum (or pole) of t, Z' > 0; theta below 179.8 degrees and t below 1000, whose images tell
nothing of the side and of theta. */

namespace cv { namespace refract {

namespace {

enum { ALPHA, BETA, R0, R1, R2, E0 };        // E0 and the two after it are 0, and no parameters

//! What a direction's image depends on, and how that moves with it.
struct FromAxis
{
    Vec3d across;               //!< m, 0 on the axis
    double sine, cosine, theta;
};

class CahvorLens : public PlaneLens
{
public:
    //! @param parameters fx, fy, cx, cy, alpha, beta, r0, r1, r2; @param zeros how many follow in a file
    CahvorLens(const String& model, const std::vector<double>& parameters, double linearity, size_t zeros);
    Mat distCoeffs() const CV_OVERRIDE
    {
        std::vector<double> all = coefficients_;
        all.resize(all.size() + zeros_);
        return columnOf(all);
    }
    Ptr<Lens> withParameters(const std::vector<double>& p) const CV_OVERRIDE
    {
        return makePtr<CahvorLens>(model_, p, linearity_, zeros_);
    }

private:
    uchar bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const CV_OVERRIDE;
    uchar unbend(const Vec2d& plane, Vec3d& d) const CV_OVERRIDE;
    std::vector<String> coefficientNames() const CV_OVERRIDE
    {
        return { "alpha", "beta", "r0", "r1", "r2" };
    }

    FromAxis fromAxis(const Vec3d& d, double length) const;
    double chi(double theta, double& slope) const;
    double thetaOf(double chi) const;
    double radial(double theta, double& slope) const;       //!< theta -> t
    double invert(double t) const;                          //!< t -> theta, NaN beyond thetaMax_

    const double linearity_;
    const size_t zeros_;
    double thetaMax_;
    Vec3d axis_, dAxis_[2];     //!< o, and by alpha and beta
};

CahvorLens::CahvorLens(const String& model, const std::vector<double>& parameters, double linearity, size_t zeros)
    : PlaneLens(model, parameters), linearity_(std::abs(linearity) > 1e-15 ? linearity : 0), zeros_(zeros)
{
    const double* p = coefficients_.data();
    const double cA = std::cos(p[ALPHA]), sA = std::sin(p[ALPHA]), cB = std::cos(p[BETA]), sB = std::sin(p[BETA]);
    axis_ = Vec3d(sA*cB, sB, cA*cB);
    dAxis_[0] = Vec3d(cA*cB, 0, -sA*cB);
    dAxis_[1] = Vec3d(-sA*sB, cB, -cA*sB);
    const double slopeTerms[] = { 1 + p[R0], 3*p[R1], 5*p[R2] };
    const double FARTHEST = 0.999*CV_PI, STEEPEST = 1000;
    thetaMax_ = slopeTerms[0] > 0 ? std::min(FARTHEST, thetaOf(std::sqrt(firstPositiveRoot(slopeTerms, 3)))) : 0;
    const double steepest = invert(STEEPEST);
    if (steepest < thetaMax_)
        thetaMax_ = steepest;
}

double CahvorLens::chi(double theta, double& slope) const
{
    const double L = linearity_, angle = L*theta;
    slope = L == 0 ? 1 : L < 0 ? std::cos(angle) : 1/(std::cos(angle)*std::cos(angle));
    return L == 0 ? theta : (L < 0 ? std::sin(angle) : std::tan(angle))/L;
}

//! As far as chi grows; it may end before it reaches the value.
double CahvorLens::thetaOf(double value) const
{
    const double L = std::abs(linearity_);
    return L == 0 ? value : (linearity_ > 0 ? std::atan(L*value) : std::asin(std::min(1., L*value)))/L;
}

double CahvorLens::radial(double theta, double& slope) const
{
    const double* p = coefficients_.data();
    const double x = chi(theta, slope), s = x*x;
    slope *= 1 + p[R0] + s*(3*p[R1] + s*5*p[R2]);
    return x*(1 + p[R0] + s*(p[R1] + s*p[R2]));
}

double CahvorLens::invert(double t) const
{
    return invertMonotone([this](double theta, double& slope) { return radial(theta, slope); }, t, thetaMax_);
}

FromAxis CahvorLens::fromAxis(const Vec3d& d, double length) const
{
    FromAxis at;
    at.cosine = d.dot(axis_)/length;
    at.across = d*(1/length) - at.cosine*axis_;
    at.sine = norm(at.across);
    at.theta = std::atan2(at.sine, at.cosine);
    if (at.sine > 0)
        at.across *= 1/at.sine;
    return at;
}

/* d' = o + F sin(theta) m with F = t/sin(theta), an even function of theta, so that nothing is singular on the axis. */
uchar CahvorLens::bend(const Vec3d& d, Vec2d& plane, Matx23d* byDirection, Vec2d* byCoefficients) const
{
    const double length = norm(d);
    const FromAxis at = fromAxis(d, length);
    double slope, chiSlope;
    const double t = radial(at.theta, slope), F = at.sine > 0 ? t/at.sine : slope;
    const Vec3d bent = axis_ + t*at.across;
    plane = Vec2d(bent[0], bent[1])*(1/bent[2]);
    const auto seen = [&](const Vec3d& move)        // how the image moves with d'
    {
        return Vec2d(move[0] - plane[0]*move[2], move[1] - plane[1]*move[2])*(1/bent[2]);
    };
    // d(F sin(theta) m) = F d(sin(theta) m) + m sin(theta) dF
    const double growth = at.sine > 0 ? slope - F*at.cosine : 0;        // sin(theta) dF/dtheta
    for (int c = 0; c < 3 && byDirection; c++)
    {
        Vec3d unit;
        unit[c] = 1;
        const Vec3d dUnit = (unit - d*(d[c]/(length*length)))*(1/length);
        const Vec3d dAcross = dUnit - axis_*axis_.dot(dUnit);
        const Vec2d column = seen(F*dAcross + at.across*(growth*(at.cosine*at.across[c] - at.sine*axis_[c])/length));
        (*byDirection)(0, c) = column[0];
        (*byDirection)(1, c) = column[1];
    }
    if (byCoefficients)
    {
        for (int c = 0; c < 2; c++)
        {
            const double dCosine = at.sine*at.across.dot(dAxis_[c]);
            byCoefficients[c] = seen(dAxis_[c] - F*(dCosine*axis_ + at.cosine*dAxis_[c])
                                     - at.across*(growth*at.across.dot(dAxis_[c])));
        }
        const double x = chi(at.theta, chiSlope);
        for (int k = 0; k < 3; k++)
            byCoefficients[R0 + k] = seen(at.across*std::pow(x, 2*k + 1));
    }
    return at.theta < thetaMax_ && bent[2] > 0 ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

uchar CahvorLens::unbend(const Vec2d& plane, Vec3d& d) const
{
    const Vec3d bent(plane[0], plane[1], 1);
    const double along = bent.dot(axis_);
    const Vec3d across = bent - along*axis_;
    const double side = norm(across);
    const double theta = along > 0 ? invert(side/along) : NAN;
    d = std::cos(theta)*axis_;
    if (side > 0)
        d += across*(std::sin(theta)/side);
    return std::isfinite(theta) ? REFRACT_OK : REFRACT_OUTSIDE_LENS_MODEL;
}

} // namespace

Ptr<Lens> makeCahvorLens(const LensSpec& spec)
{
    const int count = (int)spec.distCoeffs.size();
    for (int i = E0; i < count; i++)
        if (spec.distCoeffs[i] != 0)
            CV_Error_(Error::StsBadArg, ("%s[%d], e%d of %s, is %g: its centre moves with the angle, and a lens here has "
                                         "one centre; fit the model with E = 0", spec.argument.c_str(), (int)spec.before + i, i - E0,
                                         spec.model.c_str(), spec.distCoeffs[i]));
    spec.requireNoSkew();
    std::vector<double> parameters = spec.parameters();
    parameters.resize(4 + E0);
    return makePtr<CahvorLens>(spec.model, parameters, spec.inName.empty() ? 1 : spec.inName[0], (size_t)(count - E0));
}

}} // namespace
