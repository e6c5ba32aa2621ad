// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The window's normal from pairs (Plate2024, section 3.1.1).

Direct bearing x, refracted bearing w and normal n lie in the plane of incidence of the point, at any depth:

    n . a = 0,    a = w x x

On bearings the intersection of the paper's lines may lie at infinity. For unit pixel noise the residual n.a has the
variance n^T S n, S = G G^T with the 3x4 matrix G = da/d(pixels); so

    e = n.a / sqrt(n^T S n)

is, to first order, the distance in pixels of the pair (4 coordinates) to the nearest pair that is collinear with the
centre. The start is the smallest eigenvector of sum a a^T / tr S; Gauss-Newton on the sphere then minimises sum e^2.
A pair next to the centre moves little and its direction is all noise; e gives it no more weight than that.

The derivatives J of e hang on the movements that were observed, noise and all, which is no information. Given e, the noise of J
has the covariance sigma^2 N with N = B^T (S - S n n^T S/(n^T S n)) B / (n^T S n), B the tangent basis. It grows without bound next
to the centre; so a second fit weights a pair by w = k^2/(k^2 + sigma^2 tr N), where k is the usual length of J. Its information is
H = sum w (J J^T - sigma^2 N) and its covariance sigma^2 H^-1 (sum w^2 J J^T) H^-1, as of any model with errors in its variables
(Fuller 1987). */

#include "start/normal_from_pairs.hpp"
#include "arrays/arrays.hpp"
#include "math/robust_scale.hpp"

namespace cv { namespace refract {

namespace {

typedef Matx<double, 3, 2> Matx32d;

struct Pair
{
    Vec3d a;            //!< refracted x direct bearing
    Matx33d S;          //!< covariance of a for unit pixel noise
    Vec2d shift;        //!< pixels from the direct to the refracted point
    double weight = 1;
};

Matx33d crossMatrix(const Vec3d& v)
{
    return Matx33d(0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0);
}

//! Unit bearing of a pixel and its derivative by the pixel, the pseudo-inverse of the lens' Jacobian.
bool bearingOf(const Lens& lens, const Point2d& point, Vec3d& bearing, Matx32d& dBearing)
{
    uchar status = REFRACT_OK;
    lens.unproject(1, &point.x, &point.y, &bearing[0], &bearing[1], &bearing[2], &status);
    if (status != REFRACT_OK)
        return false;
    Vec2d pixel;
    Matx23d J;
    if (lens.projectJacobian(bearing, pixel, J.val, NULL) != REFRACT_OK)
        return false;
    dBearing = J.t()*(J*J.t()).inv();
    return true;
}

std::vector<Pair> readPairs(const Lens& lens, const PixelViews& direct, const PixelViews& refracted)
{
    std::vector<Pair> pairs;
    for (size_t view = 0; view < direct.size(); view++)
        for (size_t i = 0; i < std::min(direct[view].size(), refracted[view].size()); i++)
        {
            const Point2d& from = direct[view][i];
            const Point2d& to = refracted[view][i];
            Vec3d x, w;
            Matx32d dx, dw;
            if (!isWhole(from) || !isWhole(to) || !bearingOf(lens, from, x, dx) || !bearingOf(lens, to, w, dw))
                continue;
            const Matx32d byDirect = crossMatrix(w)*dx, byRefracted = crossMatrix(x)*dw;
            Pair pair;
            pair.a = w.cross(x);
            pair.S = byDirect*byDirect.t() + byRefracted*byRefracted.t();
            pair.shift = Vec2d(to.x - from.x, to.y - from.y);
            pairs.push_back(pair);
        }
    return pairs;
}

//! Smallest eigenvector; false if the lines are all one.
bool linearNormal(const std::vector<Pair>& pairs, Vec3d& n)
{
    Matx33d M = Matx33d::zeros();
    for (const Pair& pair : pairs)
        M += (1/trace(pair.S))*(pair.a*pair.a.t());
    Vec3d values;
    Matx33d vectors;
    eigen(M, values, vectors);      // descending
    n = Vec3d(vectors.row(2).val);
    return values[1] > 1e-12*values[0];
}

//! Two orthonormal vectors orthogonal to n, as columns.
Matx32d tangentBasis(const Vec3d& n)
{
    Vec3d axis(0, 0, 0);
    axis[std::abs(n[0]) < 0.6 ? 0 : 1] = 1;
    const Vec3d b1 = normalize(n.cross(axis)), b2 = n.cross(b1);
    return Matx32d(b1[0], b2[0], b1[1], b2[1], b1[2], b2[2]);
}

//! A pair's error and its derivative by the two tangent coordinates.
struct PairError
{
    PairError(const Pair& pair, const Vec3d& n, const Matx32d& basis)
    {
        const Vec3d Sn = pair.S*n;
        const double s2 = n.dot(Sn), s = std::sqrt(s2);
        e = n.dot(pair.a)/s;
        J = basis.t()*(pair.a/s - (e/s2)*Sn);
    }
    double e;
    Vec2d J;
};

//! Covariance of a pair's derivative for unit pixel noise, given its error.
Matx22d derivativeNoise(const Pair& pair, const Vec3d& n, const Matx32d& basis)
{
    const Vec3d Sn = pair.S*n;
    const double s2 = n.dot(Sn);
    const Vec2d along = basis.t()*Sn;
    return (1/s2)*(basis.t()*pair.S*basis - (1/s2)*(along*along.t()));
}

struct NormalEquations
{
    double cost = 0;
    Matx22d A = Matx22d::zeros();
    Vec2d b;
};

NormalEquations linearize(const std::vector<Pair>& pairs, const Vec3d& n, const Matx32d& basis)
{
    NormalEquations equations;
    for (const Pair& pair : pairs)
    {
        const PairError error(pair, n, basis);
        equations.cost += pair.weight*error.e*error.e;
        equations.A += pair.weight*(error.J*error.J.t());
        equations.b -= pair.weight*error.e*error.J;
    }
    return equations;
}

//! Gauss-Newton with halving, on the two tangent coordinates of the sphere; false if it does not converge.
bool refineNormal(const std::vector<Pair>& pairs, Vec3d& n, Matx32d& basis, NormalEquations& here)
{
    basis = tangentBasis(n);
    here = linearize(pairs, n, basis);
    const int MOST = 1000;      // next to the centre a point's weight hangs on the normal: 0.9 of the error may stay per step
    for (int iteration = 0; iteration < MOST; iteration++)
    {
        Vec2d step = here.A.solve(here.b, DECOMP_SVD);
        if (here.b.dot(step) < DBL_EPSILON*here.cost)       // a gain that the cost's rounding would hide
            return true;
        bool improved = false;
        while (!improved && norm(step) > 1e-15)
        {
            const Vec3d trial = normalize(n + basis*step);
            const Matx32d trialBasis = tangentBasis(trial);
            const NormalEquations there = linearize(pairs, trial, trialBasis);
            improved = there.cost < here.cost;
            if (improved)
            {
                n = trial;
                basis = trialBasis;
                here = there;
            }
            else
                step *= 0.5;
        }
        if (!improved)
            return true;
    }
    return false;
}

//! Without weights: all have the same noise.
double sumOfSquares(const std::vector<Pair>& pairs, const Vec3d& n, const Matx32d& basis)
{
    double sum = 0;
    for (const Pair& pair : pairs)
        sum += std::pow(PairError(pair, n, basis).e, 2);
    return sum;
}

//! By what of their derivatives is not noise.
void weigh(std::vector<Pair>& pairs, const Vec3d& n, const Matx32d& basis, double variance)
{
    std::vector<double> squares, noise;
    for (const Pair& pair : pairs)
    {
        const PairError error(pair, n, basis);
        squares.push_back(error.J.dot(error.J));
        noise.push_back(variance*trace(derivativeNoise(pair, n, basis)));
    }
    const double usual = median(squares);
    for (size_t i = 0; i < pairs.size(); i++)
        pairs[i].weight = usual/(usual + noise[i]);
}

//! Of the two tangent coordinates; zero where what is left of the derivatives without noise may be chance.
Matx22d tangentCovariance(const std::vector<Pair>& pairs, const Vec3d& n, const Matx32d& basis, double variance)
{
    const double CLEAR = 3;         // standard deviations of the noise's part, a sum of squares
    if (std::isnan(variance))
        return Matx22d::all(variance);
    Matx22d information = Matx22d::zeros(), score = Matx22d::zeros(), vectors;
    for (const Pair& pair : pairs)
    {
        const PairError error(pair, n, basis);
        information += pair.weight*(error.J*error.J.t() - variance*derivativeNoise(pair, n, basis));
        score += pair.weight*pair.weight*(error.J*error.J.t());
    }
    Vec2d values;
    eigen(information, values, vectors);
    const Vec2d weakest(vectors.row(1).val);
    double squares = 0;
    for (const Pair& pair : pairs)
        squares += std::pow(pair.weight*variance*weakest.dot(derivativeNoise(pair, n, basis)*weakest), 2);
    if (values[1] <= CLEAR*std::sqrt(2*squares))
        return Matx22d::zeros();
    const Matx22d inverse = information.inv(DECOMP_SVD);
    return variance*(inverse*score*inverse);
}

/** Whether normals far off are nearly as likely, as where all points are on one line through the centre, which may be anywhere on it:
then the covariance is that of some dent of the errors.
@param direction unit, tangent, the least determined one; sigma along it
@param cost at n */
bool isFlat(const std::vector<Pair>& pairs, const Vec3d& n, const Vec3d& direction, double sigma, double variance, double cost)
{
    const double FAR = 4, LEAST = 2.5, STEP = 1.25;       // standard deviations, and what they should be beyond these; of one to the next
    const Vec3d across = n.cross(direction);
    for (double angle = FAR*sigma; angle < CV_PI/2; angle *= STEP)
        for (double side : { -angle, angle })
        {
            const Vec3d there = std::cos(side)*n + std::sin(side)*direction;
            const Matx32d basis(across[0], 0, across[1], 0, across[2], 0);      // one step to the best beside it
            const NormalEquations equations = linearize(pairs, there, basis);
            const double gain = equations.A(0, 0) > 0 ? equations.b[0]*equations.b[0]/equations.A(0, 0) : 0;
            if (equations.cost - gain < cost + LEAST*LEAST*variance)
                return true;
        }
    return false;
}

double shiftRms(const std::vector<Pair>& pairs)
{
    double sum = 0;
    for (const Pair& pair : pairs)
        sum += pair.shift.dot(pair.shift);
    return std::sqrt(sum/(double)pairs.size());
}

NormalEstimate refusal(const String& why)
{
    NormalEstimate estimate;
    estimate.undetermined = why;
    return estimate;
}

} // namespace

NormalEstimate normalFromPairs(const Camera& camera, const PixelViews& direct, const PixelViews& refracted)
{
    std::vector<Pair> pairs = readPairs(camera.lens(), direct, refracted);
    if (pairs.size() < 2)
        return refusal(format("%d points were seen both without and with the window; at least 2 are needed",
                              (int)pairs.size()));
    const double shift = shiftRms(pairs);
    if (!(shift > 1e-6))
        return refusal("no point moves between the images without and with the window; are the images of a pair the same?");

    Vec3d n;
    Matx32d basis;
    NormalEquations solution;
    if (!linearNormal(pairs, n))
        return refusal("all points move along one and the same line; use a target that fills more of the image, or more "
                       "views");
    if (!refineNormal(pairs, n, basis, solution))
        return refusal("the iteration did not converge");
    const double count = (double)pairs.size(), left = count > 2 ? count - 2 : std::numeric_limits<double>::quiet_NaN();
    if (count > 2)
    {
        weigh(pairs, n, basis, sumOfSquares(pairs, n, basis)/left);
        if (!refineNormal(pairs, n, basis, solution))
            return refusal("the iteration did not converge");
    }
    const double ROUNDING = 1e-16;      // square pixels
    const double squares = sumOfSquares(pairs, n, basis), variance = std::max(squares/left, ROUNDING);      // NaN stays

    // The movement must stand out from what remains across the lines, else the lines' directions are noise.
    NormalEstimate estimate;
    estimate.rms = std::sqrt(squares/count);
    if (shift < 3*estimate.rms)
        return refusal(format("the points move by %.3g px (RMS) through the window, but miss the lines through the centre "
                              "by %.3g px; was the target moved within a pair?", shift, estimate.rms));
    const Matx22d covariance = tangentCovariance(pairs, n, basis, variance);
    Vec2d principal;
    Matx22d directions;
    eigen(covariance, principal, directions);
    const double sigma = std::sqrt(principal[0]);
    if (sigma > 0.5)
        return refusal(format("its standard deviation is %.0f degrees; take more views, or a target that fills more of the "
                              "image", sigma*180/CV_PI));
    if (sigma == 0 || isFlat(pairs, n, basis*Vec2d(directions.row(0).val), sigma, variance, solution.cost))
        return refusal("along one direction the points move no more than the pixels' noise makes them; use a target that fills more "
                       "of the image, or more views");
    estimate.normal = n[2] < 0 ? -n : n;
    estimate.covariance = basis*covariance*basis.t();
    return estimate;
}

namespace {

//! Median distance in pixels of a view's pairs to the lines through the centre of n.
double medianError(const std::vector<Pair>& pairs, const Vec3d& n)
{
    std::vector<double> errors;
    for (const Pair& pair : pairs)
        errors.push_back(std::abs(n.dot(pair.a))/std::sqrt(n.dot(pair.S*n)));
    return median(errors);
}

} // namespace

NormalEstimate normalFromInlierPairs(const Camera& camera, const PixelViews& direct, const PixelViews& refracted)
{
    const int MOST_CANDIDATES = 32;
    const double STANDS_OUT = 4;        // times the median view's error
    std::vector<std::vector<Pair> > views;
    std::vector<size_t> places;
    for (size_t view = 0; view < direct.size(); view++)
    {
        views.push_back(readPairs(camera.lens(), { direct[view] }, { refracted[view] }));
        if (views.back().empty())
            views.pop_back();
        else
            places.push_back(view);
    }
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> bestErrors;
    const size_t step = views.size()/MOST_CANDIDATES + 1;
    for (size_t i = 0; i < views.size(); i += step)
    {
        const NormalEstimate candidate = normalFromPairs(camera, { direct[places[i]] }, { refracted[places[i]] });
        if (!candidate.undetermined.empty())
            continue;
        std::vector<double> errors;
        for (const std::vector<Pair>& view : views)
            errors.push_back(medianError(view, candidate.normal));
        const double usual = median(errors);
        if (!(usual < least))
            continue;
        least = usual;
        bestErrors = errors;
    }
    PixelViews inliers(direct.size());
    for (size_t i = 0; i < views.size(); i++)
        if (bestErrors.empty() || bestErrors[i] <= STANDS_OUT*least)
            inliers[places[i]] = direct[places[i]];
    return normalFromPairs(camera, inliers, refracted);
}

}} // namespace
