// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/mixed_points.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;

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

} // namespace

std::vector<bool> mixedPoints(LinePiece& piece, double scale, int first, int last)
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

} // namespace tools
