// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/gum_table.hpp"
#include "assess/budget.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN(), INFINITE = std::numeric_limits<double>::infinity();
const double ROUNDING = 0.02;           // of the digits of points.csv, and of what is left out at first order

Eigen::RowVector3d rowOf(const Vec3d& v) { return Eigen::RowVector3d(v[0], v[1], v[2]); }

//! Where the cameras see points of which only the place is known.
RigPixels predictedPixels(const Calibration& calibration, const std::vector<Point3d>& points)
{
    RigPixels all;
    for (size_t c = 0; c < calibration.cameras.size(); c++)
    {
        const auto& camera = calibration.cameras[c].camera;
        std::vector<Point2d> pixels;
        refract::refractiveProjectPoints(points, rotationVector(calibration.extrinsics[c].R), calibration.extrinsics[c].t, camera, pixels);
        const Rect2d image(Point2d(-0.5, -0.5), Size2d(camera->imageSize()));
        for (Point2d& pixel : pixels)
            if (!image.contains(pixel))
                pixel = {NOT_KNOWN, NOT_KNOWN};
        all.push_back(pixels);
    }
    return all;
}

std::string nameOf(const TestPoint& point)
{
    return "'" + point.id + "'" + (point.image.empty() ? "" : " of the image '" + point.image + "'");
}

void add(GumTable& table, const std::string& source, const std::string& given, double std, double variance, double dof)
{
    const double contribution = std::sqrt(std::max(0., variance));
    table.rows.push_back({source, given, std > 0 ? std : NOT_KNOWN, std > 0 ? contribution/std : NOT_KNOWN, contribution, NOT_KNOWN, dof});
}

double squareOf(const GumRow& row) { return row.contribution*row.contribution; }

//! u, effective degrees of freedom, k and U from the rows. @param dof of the one estimate of the pixels' noise
void finish(GumTable& table, double total, double dof)
{
    double ofResiduals = 0., ofTest = 0., ofTestResiduals = 0.;
    for (GumRow& row : table.rows)
    {
        const double square = squareOf(row), ofResidual = std::isfinite(row.dof) ? square : 0.;
        row.share = square/total;
        ofResiduals += ofResidual;
        ofTest += row.isOfTest ? square : 0.;
        ofTestResiduals += row.isOfTest ? ofResidual : 0.;
    }
    const auto effective = [dof](double all, double part) { return dof > 0 ? effectiveDof(all, part, dof) : INFINITE; };
    table.u = std::sqrt(total);
    table.dof = effective(total, ofResiduals);
    table.k = coverageFactor(table.dof);
    table.U = table.k*table.u;
    table.testU = coverageFactor(effective(ofTest, ofTestResiduals))*std::sqrt(ofTest);
}

} // namespace

std::string GumRow::knownTo(const std::string& unit) const
{
    return !given.empty() || std::isnan(std) ? given : format("%.3g ", std) + unit;
}

LinearQuantity coordinateOf(const TestPoints& points, size_t point, int axis)
{
    Vec3d direction;
    direction[axis] = 1.;
    const TestPoint& p = points.points[point];
    return {std::string(1, "xyz"[axis]) + " of the point " + nameOf(p), Vec3d(p.X)[axis], {{point, direction}}};
}

LinearQuantity distanceOf(const TestPoints& points, size_t a, size_t b)
{
    const Vec3d between = points.points[b].X - points.points[a].X;
    const double length = norm(between);
    return {"length from " + nameOf(points.points[a]) + " to " + nameOf(points.points[b]), length,
            {{a, -between/length}, {b, between/length}}};
}

/* Heights of points over the plane, h = n dX, are fitted by those of a plane: the change at the foot of the perpendicular from the
camera's centre is the change of the distance. */
LinearQuantity planeDistanceOf(const TestPoints& points, const std::string& image)
{
    const size_t FEWEST = 4;
    const double FLAT = 5.;                 // standard deviations
    std::vector<size_t> used;
    MatrixXd X(points.points.size(), 3);
    double variance = 0.;
    for (size_t i = 0; i < points.points.size(); i++)
    {
        const TestPoint& p = points.points[i];
        if (p.image != image || p.status != 0 || !std::isfinite(p.X.x))
            continue;
        X.row(used.size()) << p.X.x, p.X.y, p.X.z;
        used.push_back(i);
        variance += p.sigma.dot(p.sigma);
    }
    LinearQuantity quantity{"distance of the plane of '" + image + "' from camera 1", 0., {}};
    if (used.size() < FEWEST)
        return quantity;
    X.conservativeResize(used.size(), 3);
    const Eigen::RowVector3d middle = X.colwise().mean();
    X.rowwise() -= middle;
    const SymmetricEigen3 axes(transposeTimes(X, X));
    const Eigen::Vector3d& spread = axes.values;
    if (!(spread[1] > 1e-6*spread[2]) || !(spread[0] <= FLAT*FLAT*variance))        // in a line, or with depth
        return quantity;
    Eigen::Vector3d n = axes.vectors.col(0);
    if (middle.dot(n) < 0)
        n = -n;
    MatrixXd D(used.size(), 3);
    D << VectorXd::Ones(used.size()), product(X, axes.vectors.rightCols(2));
    Eigen::RowVector3d foot;
    foot << 1., -middle*axes.vectors.rightCols(2);
    const Eigen::RowVectorXd weights = product(foot, pseudoInverse(D));
    quantity.value = middle.dot(n);
    for (size_t i = 0; i < used.size(); i++)
        quantity.weights.push_back({used[i], weights[i]*Vec3d(n[0], n[1], n[2])});
    return quantity;
}

PointErrors::PointErrors(const Calibration& calibration, const TestPoints& points, double pixelSigma, const std::optional<Vec4d>& plane)
    : calibration_(calibration), pixelSigma_(pixelSigma), havePixels_(points.havePixels)
{
    const int parameters = columnCount(modelOf(calibration));
    covariance_ = calibration.covariance.empty() ? MatrixXd(MatrixXd::Zero(parameters, parameters)) : toEigen(calibration.covariance);
    std::vector<Point3d> X;
    RigPixels pixels(calibration.cameras.size());
    for (const TestPoint& point : points.points)
    {
        X.push_back(point.X);
        for (size_t c = 0; c < pixels.size(); c++)
            pixels[c].push_back(point.pixels[c]);
    }
    if (points.havePixels)
        requireSamePoints(points, pixels, plane);
    joint_ = jointErrorOf(calibration, X, points.havePixels ? pixels : predictedPixels(calibration, X), plane);
    for (size_t i = 0; i < X.size(); i++)
        noise_.push_back(noiseVariance(points.points[i], i));
}

void PointErrors::requireSamePoints(const TestPoints& points, const RigPixels& pixels, const std::optional<Vec4d>& plane) const
{
    const Measurement m = plane ? measureOnPlane(calibration_, pixels[0], *plane, pixelSigma_)
                                : measureRig(calibration_, pixels, pixelSigma_);
    for (size_t i = 0; i < points.points.size(); i++)
    {
        const TestPoint& point = points.points[i];
        const double off = norm(point.X - m.points[i]);
        if (point.status == 0 && off > std::max(1e-6*norm(point.X), ROUNDING*norm(m.sigma[i])))
            throw Failure("'" + points.source + "' is not of this calibration" + (plane ? " and --plane" : "") + ": the point "
                          + nameOf(point) + format(" is %.3g away from where its pixels show it. Measure again (refract_measure)", off));
    }
}

double PointErrors::noiseVariance(const TestPoint& point, size_t i)
{
    const double stated = point.sigma.dot(point.sigma), shape = joint_.noise[i].trace();
    const double ofCalibration = diagonalOfProduct(product(joint_.byCalibration[i], covariance_),
                                                   joint_.byCalibration[i].transpose()).sum();
    const double expected = pixelSigma_*pixelSigma_, left = stated - ofCalibration;
    if (!(stated == stated) || std::abs(left - expected*shape) < ROUNDING*stated)
        return expected;
    if (havePixels_ && !(left < expected*shape))
    {
        stated_.more = true;
        return left/shape;
    }
    if (havePixels_ && expected > 0)
    {
        stated_.lessThanPixels = true;
        return expected;
    }
    if (left > -ROUNDING*ofCalibration)
        return std::max(0., left)/shape;
    stated_.lessThanCalibration = true;
    return stated/shape;
}

GumTable PointErrors::table(const LinearQuantity& quantity) const { return table(quantity, {}); }

GumTable PointErrors::table(const LinearQuantity& quantity, const std::vector<CertifiedSource>& certified) const
{
    GumTable result;
    result.quantity = quantity.name;
    result.value = quantity.value;
    Eigen::RowVectorXd byCalibration = Eigen::RowVectorXd::Zero(covariance_.rows());
    double noise = 0., meanNoise = 0.;
    for (const auto& weight : quantity.weights)
    {
        const Eigen::RowVector3d w = rowOf(weight.second);
        byCalibration += product(w, joint_.byCalibration[weight.first]);
        noise += noise_[weight.first]*(w*joint_.noise[weight.first]*w.transpose())(0, 0);
        meanNoise += noise_[weight.first]/quantity.weights.size();
    }
    const double calibration = propagated(covariance_, byCalibration)(0, 0);
    const double dof = calibration_.dof > 0 ? calibration_.dof : INFINITE;
    double left = calibration;
    for (const UncertaintySource& s : calibration_.provenance.sources)
    {
        if (s.factor.rows != covariance_.rows())
            throw Failure("uncertainty_sources of the calibration are not of its cameras: was the file edited? Calibrate again");
        const double variance = product(byCalibration, toEigen(s.factor)).squaredNorm();
        add(result, s.name, s.given, s.std, variance, INFINITE);
        left -= variance;
    }
    if (left < -1e-6*calibration)
        throw Failure("uncertainty_sources of the calibration are more than its covariance: was the file edited? Calibrate again");
    if (!calibration_.covariance.empty())
        add(result, calibration_.provenance.sources.empty() ? "the calibration" : CALIBRATION_NOISE, "", 0., left, dof);
    const double pixel = std::sqrt(meanNoise);
    const size_t ofRig = result.rows.size();
    add(result, "noise of the points' own pixels", format("%.2g px", pixel), pixel, noise, dof);
    double total = calibration + noise;
    for (const CertifiedSource& source : certified)
    {
        const double variance = std::pow(source.std*source.sensitivity, 2);
        add(result, source.name, source.given, source.std, variance, INFINITE);
        total += variance;
    }
    for (size_t i = ofRig; i < result.rows.size(); i++)
        result.rows[i].isOfTest = true;
    finish(result, total, calibration_.dof);
    return result;
}

} // namespace tools
