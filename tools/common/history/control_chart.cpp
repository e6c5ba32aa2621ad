// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "history/drift.hpp"
#include "math/dense.hpp"
#include "math/quantile.hpp"
#include "measure/distributions.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

using namespace cv::refract;

namespace tools {

namespace {

const double NOTHING = 1e-9;        // of the largest eigenvalue of a correlation

void decompose(const MatrixXd& V, Innovation& innovation)
{
    const CorrelationSpectrum spectrum(V);
    const int rank = spectrum.rank(NOTHING);
    innovation.root = spectrum.root(rank);
    const MatrixXd inverseRoot = spectrum.inverseRoot(rank);
    innovation.inverse = timesTranspose(inverseRoot, inverseRoot);
}

//! Block by block the inverse of the information: from a score to the estimates of changes, each by itself.
MatrixXd estimatesOfScore(const CheckRecord& check, const std::vector<ChartedChange>& changes)
{
    MatrixXd M = MatrixXd::Zero(check.score.size(), check.score.size());
    Eigen::Index first = 0;
    for (int c : check.changes)
    {
        const int size = changes[c].size();
        M.block(first, first, size, size) = inverse(check.information.block(first, first, size, size));
        first += size;
    }
    return M;
}

const int DRAWS = 60000;
const double EXACT = 1e7;               // degrees of freedom of a noise that is known
const double NOT_YET = std::numeric_limits<double>::quiet_NaN();

double normalTail(double z) { return std::erfc(std::abs(z)/std::sqrt(2.)); }

//! Where a falling function has a value.
double whereFalling(const std::function<double(double)>& f, double value)
{
    double low = 0., high = 1.;
    while (f(high) > value && high < 1e6)
        high *= 2.;
    const int BISECTIONS = 60;
    for (int i = 0; i < BISECTIONS; i++)
    {
        const double middle = 0.5*(low + high);
        (f(middle) > value ? low : high) = middle;
    }
    return 0.5*(low + high);
}

//! EWMAs and their variances; a column each history.
struct Ewmas
{
    MatrixXd value;
    VectorXd variance;

    Ewmas(Eigen::Index count, Eigen::Index histories) : value(MatrixXd::Zero(count, histories)), variance(VectorXd::Zero(count)) {}

    //! @param u standardised, of these parameters
    void add(const std::vector<int>& parameters, const MatrixXd& u)
    {
        for (size_t i = 0; i < parameters.size(); i++)
        {
            const int p = parameters[i];
            value.row(p) = (1. - EWMA_WEIGHT)*value.row(p) + EWMA_WEIGHT*u.row((Eigen::Index)i);
            variance[p] = std::pow(EWMA_WEIGHT, 2) + std::pow(1. - EWMA_WEIGHT, 2)*variance[p];
        }
    }
};

/* Histories in which nothing changes and no chart has exceeded a limit yet. */
class DrawnHistories
{
public:
    explicit DrawnHistories(Eigen::Index count) : ewmas_(count, DRAWS) {}

    //! The probability that the least one of all charts falls below with falseAlarm.
    double add(const Innovation& innovation, const CheckRecord& check, const std::vector<int>& parameters, double falseAlarm)
    {
        MatrixXd w(innovation.rank(), DRAWS);
        if (w.size())
        {
            cv::Mat all(DRAWS, innovation.rank(), CV_64F, w.data());
            random_.fill(all, cv::RNG::NORMAL, 0., 1.);
        }
        w = w*noiseOf(check).asDiagonal();
        ewmas_.add(parameters, innovation.stdAlone.cwiseInverse().asDiagonal()*product(innovation.rootAlone, w));
        const Eigen::RowVectorXd t2 = w.colwise().squaredNorm();
        const std::vector<double> least = leastProbabilities(t2, parameters, innovation.rank());
        const double critical = cv::refract::quantile(least, falseAlarm);
        replaceAlarms(least, critical);
        return critical;
    }

private:
    std::vector<double> leastProbabilities(const Eigen::RowVectorXd& t2, const std::vector<int>& parameters, int rank) const
    {
        Eigen::RowVectorXd largest = Eigen::RowVectorXd::Zero(DRAWS);
        for (int p : parameters)
            largest = largest.cwiseMax(ewmas_.value.row(p).cwiseAbs()/std::sqrt(ewmas_.variance[p]));
        std::vector<double> least(DRAWS);
        for (int i = 0; i < DRAWS; i++)
            least[i] = std::min(normalTail(largest[i]), t2[i] > rank ? upperTailChiSquared(rank, t2[i]) : 1.);
        return least;
    }

    //! One for all checks that take the same estimate. Of the noise's variance over it: Wilson and Hilferty's cube.
    const VectorXd& noiseOf(const CheckRecord& check)
    {
        const auto [found, isNew] = noise_.emplace(std::make_pair(check.sigma, check.dof), VectorXd::Ones(DRAWS));
        const double variance = 2./(9.*check.dof);
        for (int i = 0; isNew && check.dof < EXACT && i < DRAWS; i++)
            found->second[i] = std::pow(std::max(1e-3, 1. - variance + random_.gaussian(std::sqrt(variance))), -1.5);
        return found->second;
    }

    //! By others that have none.
    void replaceAlarms(const std::vector<double>& least, double critical)
    {
        for (int i = 0; i < DRAWS; i++)
        {
            if (!(least[i] < critical))
                continue;
            int other = i;
            while (least[other] < critical)
                other = random_.uniform(0, DRAWS);
            ewmas_.value.col(i) = ewmas_.value.col(other);
            for (auto& noise : noise_)
                noise.second[i] = noise.second[other];
        }
    }

    cv::RNG random_ = cv::RNG(0x5eed);
    Ewmas ewmas_;
    std::map<std::pair<double, double>, VectorXd> noise_;       // over its estimate; by that and its degrees of freedom
};

//! Of each parameter, whether its chart has the other sign.
VectorXd signsOf(const std::vector<ChartedChange>& changes)
{
    std::vector<double> signs;
    for (const ChartedChange& change : changes)
        signs.insert(signs.end(), change.axes.size(), change.factor < 0. ? -1. : 1.);
    return Eigen::Map<VectorXd>(signs.data(), (Eigen::Index)signs.size());
}

} // namespace

InnovationFilter::InnovationFilter(const MatrixXd& covariance, Eigen::Index scenarios)
    : C0_(covariance), C_(covariance), mean_(MatrixXd::Zero(covariance.rows(), scenarios))
{
}

Innovation InnovationFilter::add(const CheckRecord& check, const std::vector<ChartedChange>& changes, const MatrixXd& scores)
{
    const MatrixXd& D = check.byParameters;
    Innovation result;
    decompose(check.information - timesTranspose(product(D, C0_ - C_), D), result);
    result.value = scores - product(D, mean_);
    const MatrixXd gain = product(timesTranspose(C_, D), result.inverse);
    mean_ += product(gain, result.value);
    C_ -= product(product(gain, D), C_);
    C_ = 0.5*(C_ + C_.transpose()).eval();
    const MatrixXd M = estimatesOfScore(check, changes);
    result.alone = product(M, result.value);
    result.rootAlone = product(M, result.root);
    result.stdAlone = result.rootAlone.rowwise().norm();
    return result;
}

double ChartPoint::probabilityOf(int parameter) const { return seen[parameter] ? normalTail(ewma[parameter]) : 1.; }

double ChartPoint::probabilityOfT2() const { return upperTailChiSquared(dof, t2); }

bool ChartPoint::isAlarm() const
{
    for (int i = 0; i < (int)seen.size(); i++)
        if (isBeyond(i))
            return true;
    return isBeyondT2();
}

std::vector<int> firstParameters(const std::vector<ChartedChange>& changes)
{
    std::vector<int> first = {0};
    for (const ChartedChange& change : changes)
        first.push_back(first.back() + change.size());
    return first;
}

std::vector<int> parametersOf(const CheckRecord& check, const std::vector<ChartedChange>& changes)
{
    const std::vector<int> first = firstParameters(changes);
    std::vector<int> parameters;
    for (int c : check.changes)
        for (int i = first[c]; i < first[c + 1]; i++)
            parameters.push_back(i);
    return parameters;
}

std::vector<ChartLimit> chartLimits(const CheckHistory& history, const MatrixXd& covariance, double falseAlarm)
{
    std::vector<ChartLimit> limits;
    if (history.checks.empty())
        return limits;
    InnovationFilter filter(covariance);
    DrawnHistories drawn(firstParameters(history.changes).back());
    for (const CheckRecord& check : history.checks)
    {
        const Innovation innovation = filter.add(check, history.changes, check.score);
        ChartLimit limit;
        limit.critical = drawn.add(innovation, check, parametersOf(check, history.changes), falseAlarm);
        limit.limit = whereFalling(normalTail, limit.critical);
        limit.limitT2 = whereFalling([&](double x) { return upperTailChiSquared(innovation.rank(), x); }, limit.critical);
        limits.push_back(limit);
    }
    return limits;
}

std::vector<ChartPoint> controlCharts(const CheckHistory& history, const MatrixXd& covariance, const std::vector<ChartLimit>& limits)
{
    const int count = firstParameters(history.changes).back();
    const VectorXd signs = signsOf(history.changes);
    InnovationFilter filter(covariance);
    Ewmas ewmas(count, 1);
    std::vector<ChartPoint> points;
    for (size_t t = 0; t < history.checks.size(); t++)
    {
        const CheckRecord& check = history.checks[t];
        const Innovation innovation = filter.add(check, history.changes, check.score);
        const std::vector<int> parameters = parametersOf(check, history.changes);
        ewmas.add(parameters, innovation.stdAlone.cwiseInverse().asDiagonal()*innovation.alone);
        ChartPoint point;
        point.ewma = point.std = VectorXd::Constant(count, NOT_YET);
        point.seen.assign((size_t)count, false);
        for (int i = 0; i < count; i++)
            if (ewmas.variance[i] > 0.)
                point.ewma[i] = signs[i]*ewmas.value(i, 0)/std::sqrt(ewmas.variance[i]);
        for (size_t i = 0; i < parameters.size(); i++)
        {
            point.seen[parameters[i]] = true;
            point.std[parameters[i]] = innovation.stdAlone[(Eigen::Index)i];
        }
        point.t2 = innovation.value.col(0).dot(timesVector(innovation.inverse, innovation.value.col(0)));
        point.dof = innovation.rank();
        point.critical = limits[t].critical;
        point.limit = limits[t].limit;
        point.limitT2 = limits[t].limitT2;
        points.push_back(point);
    }
    return points;
}

} // namespace tools
