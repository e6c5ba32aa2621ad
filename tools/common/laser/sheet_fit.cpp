// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet_fit.hpp"
#include "laser/sheet_consensus.hpp"
#include "console/failure.hpp"
#include "measure/eigen_matrix.hpp"
#include "measure/point_derivatives.hpp"
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

const double NEAR_PX = 3.;              // a point of the line is not farther from where the sheet puts it
const double ALIGNED = 0.93;            // cosine of its direction to that of the line
const double OUTLIER = 3.5;             // robust standard deviations off the straight line
const size_t FEWEST = 15;               // points of a line
const int ROUNDS = 6;
const double MAX_TILT_STD = 0.2;        // radians, of a plane that is determined

typedef Eigen::Matrix<double, 3, 1> Vector3;

//! Two unit vectors that make an orthonormal basis with the normal; the plane's third parameter is d.
struct PlaneBasis
{
    Vec3d normal, b1, b2;

    explicit PlaneBasis(const Vec4d& plane) : normal(plane.val)
    {
        const Vec3d other = std::abs(normal[0]) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        b1 = normal.cross(other)/norm(normal.cross(other));
        b2 = normal.cross(b1);
    }
    Eigen::RowVector3d derivative(const Point3d& X) const { return {b1.dot(Vec3d(X)), b2.dot(Vec3d(X)), -1.}; }
    Vec4d moved(const Vec4d& plane, const Vector3& by) const
    {
        const Vec3d n = normal + by[0]*b1 + by[1]*b2;
        return Vec4d(n[0], n[1], n[2], plane[3] + by[2])/norm(n);
    }
    Eigen::Matrix<double, 4, 3> ofPlane() const
    {
        Eigen::Matrix<double, 4, 3> P = Eigen::Matrix<double, 4, 3>::Zero();
        for (int i = 0; i < 3; i++)
            P.row(i) << b1[i], b2[i], 0.;
        P(3, 2) = 1.;
        return P;
    }
};

//! The points of a line, by what their distances e from the sheet depend on.
struct LineRows
{
    VectorXd e, sigma;          //!< sigma: of e, by the line's own noise
    VectorXd along;             //!< position on the line, from its middle
    MatrixXd byPlane, byPose, byParameters;     //!< byPose: by errors of the board's corners; byParameters with the pose
    MatrixXd ofPose;            //!< 6x6, covariance of the pose
};

LineRows rowsOf(const Calibration& calibration, const BoardImage& image, const std::vector<int>& points, const Vec4d& plane,
                double lineNoise, double pixelSigma)
{
    const PlaneBasis basis(plane);
    const int count = (int)points.size();
    std::vector<Point3d> onBoard;
    Vec3d middle;
    for (int i : points)
    {
        onBoard.emplace_back(image.points[i].onBoard.x, image.points[i].onBoard.y, 0.);
        middle += Vec3d(image.points[i].inCamera)/count;
    }
    const PointDerivatives d = differentiatePoints(calibration.cameras[0].camera, onBoard, image.pose.rvec, image.pose.tvec);
    const Matx33d R = image.pose.rotation();
    Eigen::Matrix<double, 3, 2> R2;
    R2 << R(0, 0), R(0, 1), R(1, 0), R(1, 1), R(2, 0), R(2, 1);
    const Eigen::RowVector3d n(plane[0], plane[1], plane[2]);
    const Vec3d direction = intersectionOf(image, plane);
    LineRows rows;
    rows.e.resize(count);
    rows.sigma.resize(count);
    rows.along.resize(count);
    rows.byPlane.resize(count, 3);
    rows.byPose.resize(count, 6);
    rows.byParameters.resize(count, d.byParameters.cols());
    for (int k = 0; k < count; k++)
    {
        const BoardPoint& p = image.points[points[k]];
        const Vec3d X(p.inCamera);
        rows.e[k] = basis.normal.dot(X) - plane[3];
        rows.sigma[k] = std::abs(basis.normal.dot(p.byAcross))*std::hypot(p.ridge.sigma, lineNoise);
        rows.along[k] = direction.dot(X - middle);
        rows.byPlane.row(k) = basis.derivative(p.inCamera);
        // X = R X_board + t, and X_board stays on the pixel: G dX = du - A dp
        const Eigen::Matrix2d GR = d.byPose.block(2*k, 3, 2, 3)*R2;
        const Eigen::RowVector2d byPixel = n*R2*GR.inverse();
        rows.byPose.row(k) = n*image.pose.differentiatePoint(onBoard[k]) - byPixel*d.byPose.middleRows(2*k, 2);
        rows.byParameters.row(k) = rows.byPose.row(k)*image.pose.byParameters - byPixel*d.byParameters.middleRows(2*k, 2);
    }
    rows.ofPose = std::pow(std::max(pixelSigma, image.pose.residual), 2)*image.pose.byNoise;
    return rows;
}

//! Middle and slope of a line, of least squares.
struct ReducedLine
{
    Eigen::Vector2d e;
    MatrixXd byPlane, byParameters;
    Eigen::Matrix2d ofNoise, ofPose;

    explicit ReducedLine(const LineRows& rows)
    {
        MatrixXd D(rows.e.size(), 2);
        D << VectorXd::Ones(rows.e.size()), rows.along;
        const VectorXd weights = rows.sigma.cwiseAbs2().cwiseInverse();
        ofNoise = (D.transpose()*weights.asDiagonal()*D).inverse();
        const MatrixXd reduce = ofNoise*D.transpose()*weights.asDiagonal();
        e = reduce*rows.e;
        byPlane = reduce*rows.byPlane;
        byParameters = reduce*rows.byParameters;
        const MatrixXd byPose = reduce*rows.byPose;
        ofPose = byPose*rows.ofPose*byPose.transpose();
    }
    Eigen::Matrix2d weight(double poseNoise) const { return (ofNoise + poseNoise*poseNoise*ofPose).inverse(); }
};

//! Generalised least squares on the plane.
struct PlaneStep
{
    Vector3 step = Vector3::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), covariance;
    MatrixXd byParameters;
    double chiSquare = 0.;

    //! @param left out of it, or -1
    PlaneStep(const std::vector<ReducedLine>& lines, double poseNoise, int left = -1)
    {
        Vector3 gradient = Vector3::Zero();
        MatrixXd gradientByParameters = MatrixXd::Zero(3, lines[0].byParameters.cols());
        for (size_t m = 0; m < lines.size(); m++)
        {
            if ((int)m == left)
                continue;
            const MatrixXd HtW = lines[m].byPlane.transpose()*lines[m].weight(poseNoise);
            information += HtW*lines[m].byPlane;
            gradient += HtW*lines[m].e;
            gradientByParameters += HtW*lines[m].byParameters;
        }
        covariance = information.inverse();
        step = -covariance*gradient;
        byParameters = -covariance*gradientByParameters;
        for (size_t m = 0; m < lines.size(); m++)
            if ((int)m != left)
            {
                const Eigen::Vector2d rest = lines[m].e + lines[m].byPlane*step;
                chiSquare += rest.dot(lines[m].weight(poseNoise)*rest);
            }
    }
};

//! By how much the poses' errors must be larger for chi^2 to be what it should.
double poseNoiseOf(const std::vector<ReducedLine>& lines)
{
    const double dof = 2.*lines.size() - 3.;
    double low = 1., high = 1.;
    if (dof <= 0. || PlaneStep(lines, low).chiSquare <= dof)
        return 1.;
    while (PlaneStep(lines, high).chiSquare > dof && high < 1e3)
        high *= 2.;
    for (int i = 0; i < 40; i++)
    {
        const double middle = 0.5*(low + high);
        (PlaneStep(lines, middle).chiSquare > dof ? low : high) = middle;
    }
    return high;
}

double medianOf(std::vector<double> values)
{
    std::nth_element(values.begin(), values.begin() + values.size()/2, values.end());
    return values[values.size()/2];
}

//! Where points are off the straight line through them, px across; the line by the image's x or y.
std::vector<double> straightResiduals(const BoardImage& image, const std::vector<int>& points, const Vec4d& plane)
{
    const Vec3d direction = intersectionOf(image, plane);
    MatrixXd D(points.size(), 2);
    VectorXd off(points.size());
    for (size_t k = 0; k < points.size(); k++)
    {
        const BoardPoint& p = image.points[points[k]];
        D.row(k) << 1., direction.dot(Vec3d(p.inCamera));
        off[k] = pixelsOffPlane(p, plane)*(Vec3d(plane.val).dot(p.byAcross) < 0. ? -1. : 1.);
    }
    const VectorXd rest = off - D*D.householderQr().solve(off);
    return std::vector<double>(rest.data(), rest.data() + rest.size());
}

//! Points that are independent of each other, one by one along the line.
std::vector<int> thinned(const BoardImage& image, std::vector<int> points, double distance)
{
    const bool wide = [&] {
        double least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
        for (int i : points)
            for (int axis = 0; axis < 2; axis++)
            {
                const double at = axis ? image.points[i].ridge.pixel.y : image.points[i].ridge.pixel.x;
                least[axis] = std::min(least[axis], at);
                most[axis] = std::max(most[axis], at);
            }
        return most[0] - least[0] > most[1] - least[1];
    }();
    const auto at = [&](int i) { return wide ? image.points[i].ridge.pixel.x : image.points[i].ridge.pixel.y; };
    std::sort(points.begin(), points.end(), [&](int a, int b) { return at(a) < at(b); });
    std::vector<int> kept;
    for (int i : points)
        if (kept.empty() || at(i) - at(kept.back()) >= distance)
            kept.push_back(i);
    return kept;
}

//! What lies where the sheet puts the line; empty: too little.
std::vector<int> pointsOnSheet(const BoardImage& image, const Vec4d& plane, double scale)
{
    const Vec3d direction = intersectionOf(image, plane), onBoard = image.pose.rotation().t()*direction;
    std::vector<int> points;
    for (size_t i = 0; i < image.points.size(); i++)
    {
        const BoardPoint& p = image.points[i];
        if (std::abs(pixelsOffPlane(p, plane)) < NEAR_PX &&
            std::abs(p.alongOnBoard[0]*onBoard[0] + p.alongOnBoard[1]*onBoard[1]) > ALIGNED)
            points.push_back((int)i);
    }
    for (int round = 0; round < 5 && points.size() >= FEWEST; round++)
    {
        const std::vector<double> rest = straightResiduals(image, points, plane);
        std::vector<double> lengths;
        for (double r : rest)
            lengths.push_back(std::abs(r));
        const double most = OUTLIER*1.4826*medianOf(lengths);
        std::vector<int> kept;
        for (size_t k = 0; k < points.size(); k++)
            if (lengths[k] <= most)
                kept.push_back(points[k]);
        if (kept.size() == points.size())
            break;
        points = kept;
    }
    points = thinned(image, points, independentAfter(scale));
    return points.size() < FEWEST ? std::vector<int>() : points;
}

//! What the points are off a straight line, and what of that is not white noise.
void judgeStraightness(const BoardImage& image, const Vec4d& plane, LineOnBoard& line)
{
    const std::vector<double> rest = straightResiduals(image, line.points, plane);
    std::vector<double> variances;
    double squares = 0.;
    for (size_t k = 0; k < rest.size(); k++)
    {
        squares += rest[k]*rest[k];
        variances.push_back(std::pow(image.points[line.points[k]].ridge.sigma, 2));
    }
    line.rmsPx = std::sqrt(squares/rest.size());
    line.noise = excessNoise(rest, variances);
}

//! Of a parabola through the points.
void judgeBend(const LineRows& rows, LineOnBoard& line)
{
    const double half = rows.along.cwiseAbs().maxCoeff();
    MatrixXd D(rows.e.size(), 3);
    D << VectorXd::Ones(rows.e.size()), rows.along/half, (rows.along/half).cwiseAbs2();
    const VectorXd weights = rows.sigma.cwiseAbs2().cwiseInverse();
    const MatrixXd covariance = (D.transpose()*weights.asDiagonal()*D).inverse();
    line.bend = -(covariance*D.transpose()*weights.asDiagonal()*rows.e)[2];
    line.bendSigma = std::sqrt(covariance(2, 2));
}

void requireDetermined(const PlaneStep& step)
{
    const bool regular = step.covariance.allFinite() && step.covariance(0, 0) > 0. && step.covariance(1, 1) > 0.;
    if (!regular || std::sqrt(std::max(step.covariance(0, 0), step.covariance(1, 1))) > MAX_TILT_STD)
        throw Failure("the lines do not determine the sheet of light: show the board at several distances, tilted in several ways, "
                      "so that its lines are not one line in space");
}

} // namespace

double SheetFit::heldOutRms() const
{
    double sum = 0.;
    for (const LineOnBoard& line : lines)
        sum += std::pow(line.heldOut.rms, 2);
    return std::sqrt(sum/lines.size());
}

double SheetFit::heldOutRatio() const
{
    double sum = 0.;
    for (const LineOnBoard& line : lines)
        sum += std::pow(line.heldOut.rms/line.heldOut.stated, 2);
    return std::sqrt(sum/lines.size());
}

SheetFit fitSheet(const std::vector<BoardImage>& images, const Calibration& calibration, double pixelSigma, double scale)
{
    Vec4d plane = planeOfMostLines(images);
    if (plane == Vec4d())
        throw Failure("no two images agree on a sheet of light: is the line on the boards, and of the colour that --laser says?");
    SheetFit fit;
    std::vector<LineRows> rows;
    std::vector<ReducedLine> reduced;
    for (int round = 0; round < ROUNDS; round++)
    {
        fit.lines.clear();
        fit.without.clear();
        rows.clear();
        reduced.clear();
        for (size_t m = 0; m < images.size(); m++)
        {
            LineOnBoard line;
            line.image = (int)m;
            line.points = pointsOnSheet(images[m], plane, scale);
            if (line.points.empty())
            {
                fit.without.push_back((int)m);
                continue;
            }
            judgeStraightness(images[m], plane, line);
            rows.push_back(rowsOf(calibration, images[m], line.points, plane, line.noise, pixelSigma));
            reduced.emplace_back(rows.back());
            fit.lines.push_back(line);
        }
        if (reduced.size() < 2)
            throw Failure("the line was found on fewer than two boards: take images of the board at several distances and tilts");
        fit.poseNoise = poseNoiseOf(reduced);
        const PlaneStep step(reduced, fit.poseNoise);
        requireDetermined(step);
        if (round + 1 < ROUNDS)
        {
            plane = PlaneBasis(plane).moved(plane, step.step);
            continue;
        }
        const Eigen::Matrix<double, 4, 3> P = PlaneBasis(plane).ofPlane();
        fit.sheet.covariance = toMat(P*step.covariance*P.transpose());
        fit.sheet.byParameters = toMat(P*step.byParameters);
    }
    fit.sheet.plane = plane[3] < 0. ? -plane : plane;
    if (plane[3] < 0.)
        fit.sheet.byParameters = -fit.sheet.byParameters;
    fit.sheet.scale = scale;
    std::vector<double> noises;
    double nearest = INFINITY, farthest = -INFINITY;
    const MatrixXd C = covarianceOfCamera1(calibration, rows[0].byParameters.cols());
    for (size_t m = 0; m < rows.size(); m++)
    {
        LineOnBoard& line = fit.lines[m];
        judgeBend(rows[m], line);
        noises.push_back(line.noise);
        const PlaneStep others(reduced, fit.poseNoise, (int)m);
        const VectorXd e = rows[m].e + rows[m].byPlane*others.step;
        line.heldOut.rms = std::sqrt(e.squaredNorm()/e.size());
        const MatrixXd byParameters = rows[m].byParameters + rows[m].byPlane*others.byParameters;
        const double variance = rows[m].sigma.squaredNorm()
            + fit.poseNoise*fit.poseNoise*(rows[m].byPose*rows[m].ofPose*rows[m].byPose.transpose()).trace()
            + (rows[m].byPlane*others.covariance*rows[m].byPlane.transpose()).trace()
            + (byParameters*C*byParameters.transpose()).trace();
        line.heldOut.stated = std::sqrt(variance/e.size());
        for (int i : line.points)
        {
            nearest = std::min(nearest, images[line.image].points[i].inCamera.z);
            farthest = std::max(farthest, images[line.image].points[i].inCamera.z);
        }
    }
    fit.sheet.lineNoise = medianOf(noises);
    fit.sheet.depth = Vec2d(nearest, farthest);
    return fit;
}

} // namespace tools
