// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/drift.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

using namespace cv::refract;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();
const double SIGNIFICANT = 2.;          // standard deviations of a slope, where there is one
const double LAST_YEAR = 4102444800.*2.;    // of a forecast, seconds since 1970
// By how much chi^2 must fall for a beginning to be worth its parameter, and, as it was searched for, for a ramp to be one at all.
const double WORTH_A_PARAMETER = 4., SEARCHED = 10.;

//! One parameter, of all checks that tell of it.
struct Series
{
    std::vector<double> months;         //!< since the first check of the history
    VectorXd value;
    MatrixXd covariance;
};

Series seriesOf(const CheckHistory& history, const MatrixXd& C, int change, int axis)
{
    Series series;
    const int size = history.changes[change].size();
    const double factor = history.changes[change].factor, start = secondsOf(history.checks[0].time);
    std::vector<double> values, variances;
    std::vector<VectorXd> byParameters;
    for (const CheckRecord& check : history.checks)
    {
        const int row = rowOf(check, history.changes, change);
        if (row < 0)
            continue;
        const Eigen::RowVectorXd of = factor*inverseOf(check, row, size).row(axis);
        const VectorXd d = transposeTimesVector(check.byParameters.middleRows(row, size), of.transpose());
        series.months.push_back((secondsOf(check.time) - start)/MONTH);
        values.push_back(of.dot(check.score.segment(row, size)));
        variances.push_back(of*check.information.block(row, row, size, size)*of.transpose());
        byParameters.push_back(d);
    }
    const Eigen::Index n = (Eigen::Index)values.size();
    series.value = Eigen::Map<VectorXd>(values.data(), n);
    series.covariance.resize(n, n);
    for (Eigen::Index i = 0; i < n; i++)
        for (Eigen::Index j = 0; j < n; j++)
            series.covariance(i, j) = i == j ? variances[i] : byParameters[i].dot(timesVector(C, byParameters[j]));
    return series;
}

/* Generalised least squares of value = height + slope*profile. The height is free: that of the calibration's error, and of what changed
before the first check. */
class TrendFit
{
public:
    TrendFit(const std::vector<double>& months, const VectorXd& value, const MatrixXd& covariance)
        : months_(months), value_(value), S_(covariance) {}

    double chiSquareOfConstant() const { return chiSquare(VectorXd::Zero(0)); }
    double chiSquare(const VectorXd& profile) const
    {
        const MatrixXd J = columns(profile);
        const VectorXd rest = value_ - timesVector(J, solve(J));
        return rest.dot(S_.solve(rest));
    }
    double slope(const VectorXd& profile) const { return solve(columns(profile))[1]; }

    VectorXd ramp(double since) const
    {
        VectorXd profile(value_.size());
        for (Eigen::Index i = 0; i < profile.size(); i++)
            profile[i] = std::max(0., months_[(size_t)i] - since);
        return profile;
    }
    VectorXd step(double after) const
    {
        VectorXd profile(value_.size());
        for (Eigen::Index i = 0; i < profile.size(); i++)
            profile[i] = months_[(size_t)i] > after;
        return profile;
    }

    //! Of slope and beginning; of the slope alone where the beginning is not free.
    MatrixXd covarianceOf(double since, bool isFree) const
    {
        MatrixXd J = columns(ramp(since));
        if (isFree)
        {
            J.conservativeResize(Eigen::NoChange, 3);
            J.col(2) = -slope(ramp(since))*step(since);
        }
        const MatrixXd C = inverse(transposeTimes(J, S_.solve(J)));
        return C.bottomRightCorner(C.rows() - 1, C.cols() - 1);
    }

private:
    MatrixXd columns(const VectorXd& profile) const
    {
        MatrixXd J = MatrixXd::Ones(value_.size(), profile.size() ? 2 : 1);
        if (profile.size())
            J.col(1) = profile;
        return J;
    }
    VectorXd solve(const MatrixXd& J) const
    {
        return timesVector(inverse(transposeTimes(J, S_.solve(J))), transposeTimesVector(J, S_.solve(value_)));
    }

    const std::vector<double>& months_;
    const VectorXd& value_;
    const LDLT S_;
};

//! The best of many beginnings, of which at least two checks tell afterwards.
double bestBeginning(const TrendFit& fit, double last)
{
    const int STEPS = 400;
    double best = 0., least = fit.chiSquare(fit.ramp(0.));
    for (int i = 1; i < STEPS; i++)
    {
        const double since = last*i/STEPS, chiSquare = fit.chiSquare(fit.ramp(since));
        if (chiSquare < least)
        {
            least = chiSquare;
            best = since;
        }
    }
    return best;
}

void forecast(Trend& trend, double since, const MatrixXd& C, double start)
{
    const double slope = std::abs(trend.perMonth), months = since + trend.limit/slope;
    if (!trend.isSignificant() || start + months*MONTH > LAST_YEAR)
        return;
    VectorXd by(C.rows());
    by[0] = -trend.limit/(slope*trend.perMonth);
    if (by.size() > 1)
        by[1] = 1.;
    const double std = std::sqrt(std::max(0., by.dot(timesVector(C, by))));
    trend.reached = start + months*MONTH;
    trend.earliest = trend.reached - std*MONTH;
    trend.latest = trend.reached + std*MONTH;
}

} // namespace

bool Trend::isSignificant() const
{
    const auto chance = [](double deviations) { return std::erfc(deviations/std::sqrt(2.)); };
    return among*chance(std::abs(perMonth)/std) < chance(SIGNIFICANT);      // false for NaN
}

Trend trendThrough(const std::vector<double>& months, const VectorXd& value, const MatrixXd& covariance, double limit, double start)
{
    Trend trend{NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, 0, limit, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, 1};
    const size_t FEWEST = 3, FEWEST_OF_RAMP = 4;
    std::vector<double> times = months;
    times.erase(std::unique(times.begin(), times.end()), times.end());
    if (times.size() < FEWEST)
        return trend;
    const TrendFit fit(months, value, covariance);
    double since = 0., best = fit.chiSquare(fit.ramp(0.));
    const double constant = fit.chiSquareOfConstant(), begun = bestBeginning(fit, times[times.size() - 2]);
    const double ramp = fit.chiSquare(fit.ramp(begun));
    const bool isRamp = times.size() >= FEWEST_OF_RAMP && begun > 0. && ramp < best - WORTH_A_PARAMETER && ramp < constant - SEARCHED;
    if (isRamp)
    {
        since = begun;
        best = ramp;
    }
    for (size_t i = 0; i + 1 < times.size(); i++)
    {
        const double step = fit.chiSquare(fit.step(times[i]));
        if (!(step < best - WORTH_A_PARAMETER) || !(step < constant - SEARCHED))
            continue;
        best = step;
        trend.step = start + times[i]*MONTH;
        trend.checksSince = (int)(times.size() - 1 - i);
    }
    if (trend.step == trend.step)
    {
        trend.perMonth = trend.std = 0.;
        return trend;
    }
    const MatrixXd C = fit.covarianceOf(since, isRamp);
    trend.perMonth = fit.slope(fit.ramp(since));
    trend.std = std::sqrt(C(0, 0));
    if (isRamp)
    {
        trend.since = start + since*MONTH;
        trend.sinceStd = std::sqrt(C(1, 1))*MONTH;
    }
    forecast(trend, since, C, start);
    return trend;
}

std::vector<Trend> trendsOf(const CheckHistory& history, const MatrixXd& covariance, const std::vector<ChartPoint>& points)
{
    std::vector<Trend> trends;
    const double lambda = EWMA_WEIGHT;
    for (int c = 0; c < (int)history.changes.size(); c++)
        for (int axis = 0; axis < history.changes[c].size(); axis++)
        {
            const Series series = seriesOf(history, covariance, c, axis);
            const double limit = points.empty() ? NOT_KNOWN : points.back().limit*std::sqrt(lambda/(2. - lambda))
                * std::abs(history.changes[c].factor)*points.back().std[(Eigen::Index)trends.size()];
            trends.push_back(trendThrough(series.months, series.value, series.covariance, limit, secondsOf(history.checks[0].time)));
        }
    for (Trend& trend : trends)
        trend.among = (int)trends.size();
    return trends;
}

} // namespace tools
