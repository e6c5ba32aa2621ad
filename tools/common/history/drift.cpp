// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/drift.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
#include <algorithm>
#include <limits>

using namespace cv::refract;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();
const double VERY_STRONG = 10.;         // difference of two chi^2

//! A step or a ramp, as a share of what it is at the last check.
double profileAt(const CheckHistory& history, size_t check, size_t since, bool steady)
{
    if (check <= since)
        return 0.;
    const double t0 = secondsOf(history.checks[since].time), t1 = secondsOf(history.checks.back().time);
    return !steady ? 1. : t1 > t0 ? (secondsOf(history.checks[check].time) - t0)/(t1 - t0) : 1.;
}

//! What the innovations would be if one change were there and no noise, and what they are; the filter runs over all at once.
class CauseSearch
{
public:
    CauseSearch(const CheckHistory& history, const MatrixXd& covariance) : history_(history)
    {
        const size_t checks = history.checks.size();
        for (size_t since = 0; since + 1 < checks; since++)
            for (bool steady : {false, true})
                if (!steady || since + 2 < checks)
                    addProfile(since, steady);
        addFromTheStart();
        run(covariance);
    }

    //! The best profile of a change.
    DriftCause best(int change) const
    {
        DriftCause best{change, false, 0, false, -1., {}, {}};
        for (const Column& c : columns_)
            if (c.change == change && c.axis == 0)
                take(c, best);
        return best;
    }

private:
    struct Column
    {
        int change, axis;
        size_t since;
        bool steady, fromStart;
        Eigen::Index at;
    };

    void add(size_t since, bool steady, bool fromStart)
    {
        for (int c = 0; c < (int)history_.changes.size(); c++)
            for (int axis = 0; axis < history_.changes[c].size(); axis++)
                columns_.push_back({c, axis, since, steady, fromStart, (Eigen::Index)columns_.size() + 1});
    }

    void addProfile(size_t since, bool steady) { add(since, steady, false); }
    void addFromTheStart() { add(0, false, true); }         // between the calibration and the first check

    void run(const MatrixXd& covariance)
    {
        const Eigen::Index count = (Eigen::Index)columns_.size() + 1;
        InnovationFilter filter(covariance, count);
        A_ = MatrixXd::Zero(count, MOST_AXES);
        b_ = VectorXd::Zero(count);
        for (size_t t = 0; t < history_.checks.size(); t++)
        {
            const CheckRecord& check = history_.checks[t];
            MatrixXd scores = MatrixXd::Zero(check.score.size(), count);
            scores.col(0) = check.score;
            for (const Column& c : columns_)
            {
                const int row = rowOf(check, history_.changes, c.change);
                if (row >= 0)
                    scores.col(c.at) = (c.fromStart ? 1. : profileAt(history_, t, c.since, c.steady))*check.information.col(row + c.axis);
            }
            addSums(filter.add(check, history_.changes, scores));
        }
    }

    //! Normal equations of each change: X^T V^-1 X, of whose columns the axes are neighbours, and X^T V^-1 e.
    void addSums(const Innovation& innovation)
    {
        const MatrixXd& X = innovation.value;
        const MatrixXd WX = product(innovation.inverse, X);
        b_ += transposeTimesVector(WX, X.col(0));
        for (const Column& c : columns_)
            for (int other = 0; other < history_.changes[c.change].size(); other++)
                A_(c.at, other) += WX.col(c.at).dot(X.col(c.at - c.axis + other));
    }

    void take(const Column& first, DriftCause& best) const
    {
        const int size = history_.changes[first.change].size();
        const MatrixXd A = A_.block(first.at, 0, size, size);
        const PivotedQR qr(A);
        if (qr.rank() < size)
            return;
        const VectorXd b = b_.segment(first.at, size), value = qr.solve(b);
        if (!(b.dot(value) > best.gain))
            return;
        const MatrixXd covariance = qr.solve(MatrixXd(MatrixXd::Identity(size, size)));
        const double factor = history_.changes[first.change].factor;
        best = {first.change, first.fromStart, first.since, first.steady, b.dot(value), factor*value, factor*factor*covariance};
    }

    static const int MOST_AXES = 3;
    const CheckHistory& history_;
    std::vector<Column> columns_;
    MatrixXd A_;
    VectorXd b_;
};

} // namespace

int rowOf(const CheckRecord& check, const std::vector<ChartedChange>& changes, int change)
{
    int row = 0;
    for (int c : check.changes)
    {
        if (c == change)
            return row;
        row += changes[c].size();
    }
    return -1;
}

//! A change's own estimate: to multiply the rows of its score with.
static MatrixXd inverseOf(const CheckRecord& check, int row, int size)
{
    return inverse(check.information.block(row, row, size, size));
}

Estimates estimatesOf(const CheckHistory& history, const CheckRecord& check, const MatrixXd& covariance)
{
    const std::vector<int> first = firstParameters(history.changes);
    Estimates result{VectorXd::Constant(first.back(), NOT_KNOWN), VectorXd::Constant(first.back(), NOT_KNOWN)};
    for (int c : check.changes)
    {
        const int row = rowOf(check, history.changes, c), size = history.changes[c].size();
        const double factor = history.changes[c].factor;
        const MatrixXd M = factor*inverseOf(check, row, size), D = check.byParameters.middleRows(row, size);
        const MatrixXd noise = check.information.block(row, row, size, size) - timesTranspose(product(D, covariance), D);
        result.value.segment(first[c], size) = timesVector(M, check.score.segment(row, size));
        result.std.segment(first[c], size) = diagonalOfProduct(product(M, noise), M.transpose()).cwiseMax(0.).cwiseSqrt();
    }
    return result;
}

std::vector<DriftCause> driftCauses(const CheckHistory& history, const MatrixXd& covariance)
{
    if (history.checks.empty())
        return {};
    const CauseSearch search(history, covariance);
    const auto penalised = [&](const DriftCause& c) {
        return c.gain - history.changes[c.change].size()*std::log(10.*(double)history.checks.size()); };
    std::vector<DriftCause> causes;
    for (int c = 0; c < (int)history.changes.size(); c++)
    {
        const DriftCause cause = search.best(c);
        if (cause.gain > 0.)
            causes.push_back(cause);
    }
    std::stable_sort(causes.begin(), causes.end(), [&](const DriftCause& a, const DriftCause& b) { return penalised(a) > penalised(b); });
    while (causes.size() > 1 && penalised(causes.back()) < penalised(causes[0]) - VERY_STRONG)
        causes.pop_back();
    return causes;
}

std::string sentenceOf(const DriftCause& cause, const CheckHistory& history)
{
    const ChartedChange& change = history.changes[cause.change];
    const VectorLength length = lengthOf(cause.value, cause.covariance);
    return change.name + (cause.steady ? " has drifted by " : " has changed by ") + plusMinus(length.value, length.std)
        + (change.unit.empty() ? "" : " " + change.unit)
        + (cause.sinceCalibration ? " since the calibration" : " since " + history.checks[cause.since].time.substr(0, 10));
}

std::vector<std::string> HistoryResult::chartsBeyond(const CheckHistory& history) const
{
    const ChartPoint& last = points.back();
    const std::vector<int> first = firstParameters(history.changes);
    std::vector<std::string> names;
    for (size_t c = 0; c < history.changes.size(); c++)
        for (int i = first[c]; i < first[c + 1]; i++)
            if (last.isBeyond(i))
            {
                const std::string axis = history.changes[c].axes[i - first[c]];
                names.push_back(history.changes[c].name + (axis.empty() ? "" : " " + axis));
            }
    if (last.isBeyondT2())
        names.push_back("T^2 of all");
    return names;
}

HistoryResult chartHistory(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm)
{
    HistoryResult result;
    result.points = controlCharts(history, covariance, chartLimits(history, covariance, falseAlarm));
    if (result.isAlarm())
        result.causes = driftCauses(history, covariance);
    return result;
}

std::string causesIn(const HistoryResult& result, const CheckHistory& history)
{
    const size_t MOST = 3;
    std::vector<std::string> sentences;
    for (const DriftCause& cause : result.causes)
        sentences.push_back(sentenceOf(cause, history));
    return alternatives(sentences, MOST);
}

} // namespace tools
