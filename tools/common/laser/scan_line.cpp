// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/scan_line.hpp"
#include "console/numbers.hpp"
#include <algorithm>
#include <cmath>
#include <map>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double REACH = 3.;                // times the scale: farther, the smoothing sees nothing
const double DARKER = 0.5;              // at the end of a line the response falls by half
const double JUMPS = 3.5;               // standard deviations of a third difference
const double KINK = 0.27;               // of a second difference three scales wide: what the smoothing takes off the corner of a kink

//! The points of a piece by their columns; those that there are not are NaN.
class ByColumn
{
public:
    explicit ByColumn(const LinePiece& piece) : piece_(piece), at_(piece.columns.back() - piece.columns.front() + 1, -1)
    {
        for (size_t i = 0; i < piece.columns.size(); i++)
            at_[piece.columns[i] - piece.columns.front()] = (int)i;
    }

    const RidgePoint* at(int column) const
    {
        const int i = column - piece_.columns.front();
        return i < 0 || i >= (int)at_.size() || at_[i] < 0 ? nullptr : &piece_.points[at_[i]];
    }

    //! Across the line, by sums of points with weights; a sum of weights 0. NaN: one is missing.
    double difference(const RidgePoint& of, int column, const std::vector<std::pair<int, double>>& weights, double& sigma) const
    {
        double sum = 0., variance = 0.;
        for (const auto& weight : weights)
        {
            const RidgePoint* const p = at(column + weight.first);
            if (!p)
                return NAN;
            // At the same column: a point is somewhere within its own.
            const Point2d off = p->pixel - of.pixel;
            const double along = piece_.byColumns ? off.x : off.y, across = piece_.byColumns ? off.y : off.x;
            const double slope = -(piece_.byColumns ? p->across[0]/p->across[1] : p->across[1]/p->across[0]);
            sum += weight.second*(across + slope*(weight.first - along));
            variance += std::pow(weight.second*p->sigma, 2);
        }
        const double straight = std::abs(piece_.byColumns ? of.across[1] : of.across[0]);
        sigma = std::sqrt(variance);
        return sum*straight;
    }

private:
    const LinePiece& piece_;
    std::vector<int> at_;
};

const int SHORTEST = 8;                 // columns of a piece of a line
const int GAP = 2;                      // columns without a point within a piece
const double STEP = 1.5;                // pixels from a column to the next
const double CLEARLY = 1.5;             // times as strong as another line in the same column
const size_t ENOUGH = 20;               // residuals to estimate a noise from

//! A piece of a line: points in neighbouring columns.
struct Piece
{
    std::vector<int> points, columns;
    double strength = 0.;
};

//! Whether depth moves the line along the image's columns more than along its rows.
bool movesAlongColumns(const Calibration& calibration, const Sheet& sheet)
{
    const Ptr<RefractiveCamera>& camera = calibration.cameras[0].camera;
    const Size size = camera->imageSize();
    std::vector<Point2d> pixels;
    for (int i = 1; i < 8; i++)
        for (int j = 1; j < 8; j++)
        {
            const Point2d p(size.width*i/8., size.height*j/8.);
            pixels.insert(pixels.end(), {p, p + Point2d(1., 0.), p + Point2d(0., 1.)});
        }
    std::vector<Point3d> points;
    refractivePointsOnPlane(pixels, points, camera, sheet.plane);
    double alongX = 0., alongY = 0.;
    for (size_t i = 0; i < points.size(); i += 3)
    {
        const double x = std::abs(points[i + 1].z - points[i].z)/points[i].z, y = std::abs(points[i + 2].z - points[i].z)/points[i].z;
        if (x == x && y == y)
        {
            alongX += x/(x + y);
            alongY += y/(x + y);
        }
    }
    return alongY >= alongX;
}

std::vector<RidgePoint> atDepth(const std::vector<RidgePoint>& ridges, const Calibration& calibration, const Sheet& sheet,
                                const Vec2d& depth)
{
    std::vector<Point2d> pixels;
    for (const RidgePoint& r : ridges)
        pixels.push_back(r.pixel);
    std::vector<Point3d> points;
    std::vector<uchar> status;
    if (!pixels.empty())
        pointsOnSheet(calibration, sheet, pixels, points, status);
    std::vector<RidgePoint> kept;
    for (size_t i = 0; i < ridges.size(); i++)
        if (points[i].z >= depth[0] && points[i].z <= depth[1])     // false for NaN
            kept.push_back(ridges[i]);
    return kept;
}

//! Points linked to pieces, from column to column.
std::vector<Piece> piecesOf(const std::vector<RidgePoint>& ridges, bool byColumns)
{
    std::map<int, std::vector<int>> columns;
    const auto along = [&](int i) { return byColumns ? ridges[i].pixel.x : ridges[i].pixel.y; };
    const auto across = [&](int i) { return byColumns ? ridges[i].pixel.y : ridges[i].pixel.x; };
    for (int i = 0; i < (int)ridges.size(); i++)
        columns[cvRound(along(i))].push_back(i);
    std::vector<Piece> pieces, open;
    const auto close = [&](int before) {
        for (size_t k = 0; k < open.size();)
            if (open[k].columns.back() < before)
            {
                pieces.push_back(open[k]);
                open.erase(open.begin() + k);
            }
            else
                k++;
    };
    for (const auto& entry : columns)
    {
        close(entry.first - GAP - 1);
        for (int i : entry.second)
        {
            Piece* nearest = nullptr;
            double least = INFINITY;
            for (Piece& piece : open)
            {
                const int columnsAway = entry.first - piece.columns.back();
                const double away = std::abs(across(i) - across(piece.points.back()));
                if (columnsAway > 0 && away <= STEP*columnsAway && away < least)
                {
                    least = away;
                    nearest = &piece;
                }
            }
            if (!nearest)
            {
                open.emplace_back();
                nearest = &open.back();
            }
            nearest->points.push_back(i);
            nearest->columns.push_back(entry.first);
        }
    }
    close(INT_MAX);
    const auto isShort = [](const Piece& piece) { return (int)piece.points.size() < SHORTEST; };
    pieces.erase(std::remove_if(pieces.begin(), pieces.end(), isShort), pieces.end());
    for (Piece& piece : pieces)
    {
        std::vector<double> strengths;
        for (int i : piece.points)
            strengths.push_back(ridges[i].curvature);
        piece.strength = median(strengths);
    }
    return pieces;
}

//! Of each column the pieces that have a point there, the strongest first.
std::map<int, std::vector<std::pair<double, int>>> rankedByColumn(const std::vector<Piece>& pieces)
{
    std::map<int, std::vector<std::pair<double, int>>> columns;
    for (size_t k = 0; k < pieces.size(); k++)
        for (int column : pieces[k].columns)
            columns[column].push_back({pieces[k].strength, (int)k});
    for (auto& entry : columns)
        std::sort(entry.second.rbegin(), entry.second.rend());
    return columns;
}

bool isClear(const std::vector<std::pair<double, int>>& ranked)
{
    return ranked.size() == 1 || ranked[0].first > CLEARLY*ranked[1].first;
}

//! A reflection runs beside a stronger line: where that ends, it is a reflection still.
void dropReflections(std::vector<Piece>& pieces)
{
    std::vector<size_t> beaten(pieces.size(), 0);
    for (const auto& entry : rankedByColumn(pieces))
        for (size_t k = 1; k < entry.second.size() && isClear(entry.second); k++)
            beaten[entry.second[k].second]++;
    std::vector<Piece> kept;
    for (size_t k = 0; k < pieces.size(); k++)
        if (2*beaten[k] < pieces[k].columns.size())
            kept.push_back(pieces[k]);
    pieces = kept;
}

//! The piece of each column that is clearly the strongest, -1 where none is.
std::map<int, int> strongestOf(const std::vector<Piece>& pieces)
{
    std::map<int, int> strongest;
    for (const auto& entry : rankedByColumn(pieces))
        strongest[entry.first] = isClear(entry.second) ? entry.second[0].second : -1;
    return strongest;
}

/** Of the points beyond white noise, by how far each is from the line through two others. Where the surface bends, that is seen too.
@param usual where there are too few */
double noiseOfPieces(const std::vector<RidgePoint>& ridges, const std::vector<Piece>& pieces, bool byColumns, double scale, double usual)
{
    const int apart = std::max(1, (int)std::ceil(independentAfter(scale)));
    std::vector<double> residuals, variances;
    for (const Piece& piece : pieces)
        for (int k = apart; k + apart < (int)piece.points.size(); k++)
        {
            const RidgePoint &p = ridges[piece.points[k]], &a = ridges[piece.points[k - apart]], &b = ridges[piece.points[k + apart]];
            const double t = byColumns ? (p.pixel.x - a.pixel.x)/(b.pixel.x - a.pixel.x) : (p.pixel.y - a.pixel.y)/(b.pixel.y - a.pixel.y);
            const double weight = std::sqrt(1. + (1. - t)*(1. - t) + t*t);      // three points of equal noise
            const Point2d off = p.pixel - (a.pixel + t*(b.pixel - a.pixel));
            residuals.push_back(Vec2d(off).dot(p.across)/weight);
            variances.push_back((p.sigma*p.sigma + std::pow((1. - t)*a.sigma, 2) + std::pow(t*b.sigma, 2))/(weight*weight));
        }
    return residuals.size() < ENOUGH ? usual : excessNoise(residuals, variances);
}

} // namespace

/** Which points mix two surfaces. The sigma of the others gets what the line's bend within the reach of the smoothing makes of them.
@param scale px, of the smoothing @param last column of the image that may have a point; there and at the first a line goes on */
static std::vector<bool> mixedPoints(LinePiece& piece, double scale, int first, int last)
{
    std::vector<bool> mixed(piece.points.size(), false);
    if (piece.points.empty())
        return mixed;
    const int reach = (int)std::ceil(REACH*scale), half = (reach + 1)/2;
    const bool begins = piece.columns.front() > first, ends = piece.columns.back() < last;
    const ByColumn all(piece);
    const auto mix = [&](int column, int around) {
        for (size_t k = 0; k < piece.columns.size(); k++)
            if (std::abs(piece.columns[k] - column) <= around)
                mixed[k] = true;
    };
    if (begins)
        mix(piece.columns.front(), reach);
    if (ends)
        mix(piece.columns.back(), reach);
    std::vector<double> more(piece.points.size(), 0.);
    for (size_t i = 0; i < piece.points.size(); i++)
    {
        const RidgePoint& p = piece.points[i];
        const int column = piece.columns[i];
        for (int k = -reach; k <= reach && !mixed[i]; k++)
            if (const RidgePoint* other = all.at(column + k))
                mixed[i] = other->curvature < DARKER*p.curvature;
        double sigma = 0.;
        // Of a jump; a line that bends evenly has none.
        const double third = all.difference(p, column, {{-3*half, -1.}, {-half, 3.}, {half, -3.}, {3*half, 1.}}, sigma);
        if (std::abs(third) > JUMPS*sigma)
            mix(column, half);
        const double second = all.difference(p, column, {{-reach, 0.5}, {0, -1.}, {reach, 0.5}}, sigma);
        more[i] = second == second ? KINK*std::sqrt(std::max(0., second*second - sigma*sigma)) : 0.;
    }
    for (size_t i = 0; i < piece.points.size(); i++)
        piece.points[i].sigma = std::hypot(piece.points[i].sigma, more[i]);
    return mixed;
}

ScanLine findScanLine(const Mat& signal, const Calibration& calibration, const Sheet& sheet, const Vec2d& depth)
{
    const std::vector<RidgePoint> ridges = atDepth(findRidges(signal, sheet.scale, noiseOf(signal)), calibration, sheet, depth);
    const bool byColumns = movesAlongColumns(calibration, sheet);
    std::vector<Piece> pieces = piecesOf(ridges, byColumns);
    dropReflections(pieces);
    ScanLine line;
    const std::map<int, int> strongest = strongestOf(pieces);
    for (const auto& entry : strongest)
        line.ambiguous += entry.second < 0;
    for (size_t k = 0; k < pieces.size(); k++)
    {
        Piece part;
        for (size_t i = 0; i < pieces[k].points.size(); i++)
            if (strongest.at(pieces[k].columns[i]) == (int)k)
            {
                part.points.push_back(pieces[k].points[i]);
                part.columns.push_back(pieces[k].columns[i]);
            }
        pieces[k] = part;
    }
    line.noise = noiseOfPieces(ridges, pieces, byColumns, sheet.scale, sheet.lineNoise);
    const int border = borderOf(sheet.scale) + 1, last = (byColumns ? signal.cols : signal.rows) - 1 - border;
    for (const Piece& piece : pieces)
    {
        LinePiece part = {{}, piece.columns, byColumns};
        for (int i : piece.points)
        {
            part.points.push_back(ridges[i]);
            part.points.back().sigma = std::hypot(ridges[i].sigma, line.noise);
        }
        const std::vector<bool> mixed = mixedPoints(part, sheet.scale, border, last);
        for (size_t i = 0; i < part.points.size(); i++)
            if (mixed[i])
                line.mixed++;
            else
                line.points.push_back(part.points[i]);
    }
    const auto along = [&](const RidgePoint& p) { return byColumns ? p.pixel.x : p.pixel.y; };
    std::sort(line.points.begin(), line.points.end(), [&](const RidgePoint& a, const RidgePoint& b) { return along(a) < along(b); });
    return line;
}

} // namespace tools
