// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/sheet_fit.hpp"
#include "console/numbers.hpp"
#include "math/dense.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double AGREE_PX = 4.;             // of most points of a line, as two boards make a plane that is a little off elsewhere

struct Line
{
    int image;
    const std::vector<int>* points;
    Point3d ends[2];
};

//! Pixels, across its line, by which a point is off a plane.
double pixelsOffPlane(const BoardPoint& point, const Vec4d& plane)
{
    const Vec3d n(plane[0], plane[1], plane[2]);
    return (n.dot(Vec3d(point.inCamera)) - plane[3])/n.dot(point.byAcross);
}

double medianOff(const BoardImage& image, const std::vector<int>& points, const Vec4d& plane)
{
    std::vector<double> off;
    for (int i : points)
        off.push_back(std::abs(pixelsOffPlane(image.points[i], plane)));
    return median(off);
}

std::vector<Line> linesOf(const std::vector<BoardImage>& images)
{
    std::vector<Line> lines;
    for (size_t m = 0; m < images.size(); m++)
        for (const std::vector<int>& points : images[m].candidates)
        {
            const auto far = [&](const Point3d& from) {
                const auto farther = [&](int a, int b) {
                    return norm(images[m].points[a].inCamera - from) < norm(images[m].points[b].inCamera - from); };
                return images[m].points[*std::max_element(points.begin(), points.end(), farther)].inCamera;
            };
            const Point3d end = far(images[m].points[points[0]].inCamera);
            lines.push_back({(int)m, &points, {end, far(end)}});
        }
    return lines;
}

//! Of least squares through four points.
Vec4d planeThrough(const Line& a, const Line& b)
{
    const Point3d points[] = {a.ends[0], a.ends[1], b.ends[0], b.ends[1]};
    const Point3d middle = (points[0] + points[1] + points[2] + points[3])*0.25;
    Mat rows(4, 3, CV_64F);
    for (int i = 0; i < 4; i++)
        Mat(Vec3d(points[i] - middle)).reshape(1, 1).copyTo(rows.row(i));
    const SVD svd(rows);
    const Vec3d normal(svd.vt.ptr<double>(2));
    return Vec4d(normal[0], normal[1], normal[2], normal.dot(Vec3d(middle)));
}

//! How many pixels of lines are on a plane, at most one line an image.
double scoreOf(const std::vector<BoardImage>& images, const std::vector<Line>& lines, const Vec4d& plane)
{
    std::vector<size_t> best(images.size(), 0);
    for (const Line& line : lines)
        if (line.points->size() > best[line.image] && medianOff(images[line.image], *line.points, plane) < AGREE_PX)
            best[line.image] = line.points->size();
    double score = 0.;
    for (size_t points : best)
        score += std::sqrt((double)points);     // many images rather than long lines
    return score;
}

const double ALIGNED = 0.93;            // cosine of a point's direction to that of the line
const double OUTLIER = 3.5;             // robust standard deviations off the straight line
const size_t FEWEST = 15;               // points of a line

//! The direction on a board in camera 1 in which a plane cuts it; zero: they are parallel.
Vec3d intersectionOf(const BoardImage& image, const Vec4d& plane)
{
    const Vec3d along = Vec3d(image.plane.val).cross(Vec3d(plane.val));
    return norm(along) > 0. ? along/norm(along) : Vec3d();
}

//! Points of a line, and how far they are from a sheet.
struct OnLine
{
    SheetDistances distances;
    Vec3d direction;            //!< of the line on the board, in camera 1
    VectorXd pixels;            //!< distances as pixels across the line, each to its own side

    OnLine(const BoardImage& image, const std::vector<int>& points, const SheetSurface& sheet)
    {
        std::vector<Point3d> X;
        for (int i : points)
            X.push_back(image.points[i].inCamera);
        distances = sheet.distances(X);
        Vec3d normal;
        pixels.resize((Eigen::Index)points.size());
        for (size_t k = 0; k < points.size(); k++)
        {
            const Vec3d n(distances.byPoint(k, 0), distances.byPoint(k, 1), distances.byPoint(k, 2));
            if (n == n)
                normal += n;
            pixels[k] = distances.e[k]/n.dot(image.points[points[k]].byAcross);
        }
        direction = intersectionOf(image, Vec4d(normal[0], normal[1], normal[2], 0.));
    }
};

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

} // namespace

Vec4d planeOfMostLines(const std::vector<BoardImage>& images)
{
    const std::vector<Line> lines = linesOf(images);
    Vec4d best;
    double most = 0.;
    for (size_t a = 0; a < lines.size(); a++)
        for (size_t b = a + 1; b < lines.size(); b++)
        {
            if (lines[a].image == lines[b].image)
                continue;
            const Vec4d plane = planeThrough(lines[a], lines[b]);
            if (medianOff(images[lines[a].image], *lines[a].points, plane) > AGREE_PX ||
                medianOff(images[lines[b].image], *lines[b].points, plane) > AGREE_PX)
                continue;
            const double score = scoreOf(images, lines, plane);
            if (score > most)
            {
                most = score;
                best = plane;
            }
        }
    return best;
}

LineRows rowsOf(const Calibration& calibration, const BoardImage& image, const std::vector<int>& points, const SheetSurface& sheet,
                double lineNoise, double pixelSigma)
{
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
    const OnLine line(image, points, sheet);
    LineRows rows;
    rows.e = line.distances.e;
    rows.byState = product(line.distances.byState, sheet.basis());
    rows.sigma.resize(count);
    rows.along.resize(count);
    rows.byPose.resize(count, 6);
    rows.byParameters.resize(count, d.byParameters.cols());
    for (int k = 0; k < count; k++)
    {
        const BoardPoint& p = image.points[points[k]];
        const Eigen::RowVector3d n = line.distances.byPoint.row(k);
        const double perPixel = std::abs(n.dot(Eigen::RowVector3d(p.byAcross[0], p.byAcross[1], p.byAcross[2])));
        rows.sigma[k] = perPixel*std::hypot(p.ridge.sigma, lineNoise);
        rows.along[k] = line.direction.dot(Vec3d(p.inCamera) - middle);
        // X = R X_board + t, and X_board stays on the pixel: G dX = du - A dp
        const Eigen::Matrix2d GR = d.byPose.block(2*k, 3, 2, 3)*R2;
        const Eigen::RowVector2d byPixel = n*R2*inverse2(GR);
        rows.byPose.row(k) = n*image.pose.differentiatePoint(onBoard[k]) - byPixel*d.byPose.middleRows(2*k, 2);
        rows.byParameters.row(k) = product(rows.byPose.row(k), image.pose.byParameters)
            - product(byPixel, d.byParameters.middleRows(2*k, 2));
    }
    rows.ofPose = std::pow(std::max(pixelSigma, image.pose.residual), 2)*image.pose.byNoise;
    return rows;
}

ReducedLine::ReducedLine(const LineRows& rows, int coefficients)
{
    const VectorXd along = rows.along/rows.along.cwiseAbs().maxCoeff();
    MatrixXd D = MatrixXd::Ones(rows.e.size(), coefficients);
    for (int i = 1; i < coefficients; i++)
        D.col(i) = D.col(i - 1).cwiseProduct(along);
    const VectorXd weights = rows.sigma.cwiseAbs2().cwiseInverse();
    ofNoise = inverse(transposeTimes(weights.asDiagonal()*D, D));
    const MatrixXd reduce = timesTranspose(ofNoise, D)*weights.asDiagonal();
    e = timesVector(reduce, rows.e);
    byState = product(reduce, rows.byState);
    byParameters = product(reduce, rows.byParameters);
    ofPose = propagated(rows.ofPose, product(reduce, rows.byPose));
}

MatrixXd ReducedLine::weight(double poseNoise) const { return inverse(ofNoise + poseNoise*poseNoise*ofPose); }

std::vector<int> pointsOnSheet(const BoardImage& image, const SheetSurface& sheet, double scale, double near)
{
    std::vector<int> all(image.points.size());
    for (size_t i = 0; i < all.size(); i++)
        all[i] = (int)i;
    const OnLine from(image, all, sheet);
    const Vec3d onBoard = image.pose.rotation().t()*from.direction;
    std::vector<int> points;
    for (int i : all)
    {
        const BoardPoint& p = image.points[i];
        if (std::abs(from.pixels[i]) < near && std::abs(p.alongOnBoard[0]*onBoard[0] + p.alongOnBoard[1]*onBoard[1]) > ALIGNED)
            points.push_back(i);
    }
    for (int round = 0; round < 5 && points.size() >= FEWEST; round++)
    {
        const std::vector<double> rest = straightResiduals(image, points, sheet);
        std::vector<double> lengths;
        for (double r : rest)
            lengths.push_back(std::abs(r));
        const double most = OUTLIER*1.4826*median(lengths);
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

std::vector<double> straightResiduals(const BoardImage& image, const std::vector<int>& points, const SheetSurface& sheet)
{
    const OnLine line(image, points, sheet);
    MatrixXd D(points.size(), 2);
    VectorXd off = line.pixels;
    for (size_t k = 0; k < points.size(); k++)
    {
        const BoardPoint& p = image.points[points[k]];
        D.row(k) << 1., line.direction.dot(Vec3d(p.inCamera));
        const Eigen::RowVector3d n = line.distances.byPoint.row(k);
        off[k] *= n.dot(Eigen::RowVector3d(p.byAcross[0], p.byAcross[1], p.byAcross[2])) < 0. ? -1. : 1.;
    }
    const VectorXd rest = off - timesVector(D, QR(D).solve(off));
    return std::vector<double>(rest.data(), rest.data() + rest.size());
}

} // namespace tools
