// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/check_level.hpp"
#include "calibrate/parameter_columns.hpp"
#include "math/dense.hpp"
#include "measure/distributions.hpp"
#include "measure/rig_vector.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

using namespace cv::refract;

namespace tools {

namespace {

const int DRAWS = 20000, LEAST_IN_TAIL = 50;

//! T with T^T T the inverse of D^T G D: gains are squared lengths of T D^T score.
MatrixXd whitening(const TestedDirections& tested, const MatrixXd& G)
{
    const Eigen::Index size = tested.directions.rows();
    const MatrixXd part = product(transposeTimes(tested.directions, G.block(tested.first, tested.first, size, size)), tested.directions);
    return LLT(part).solveL(tested.directions.transpose());
}

//! Of the noise's variance over its estimate, of so many degrees of freedom: Wilson and Hilferty's cube.
double drawnVariance(double dof, cv::RNG& random)
{
    const double variance = 2./(9.*dof);
    return std::pow(std::max(1e-3, 1. - variance + random.gaussian(std::sqrt(variance))), 3);
}

const double NONE_SHOWS = std::numeric_limits<double>::infinity();

//! The noncentrality with which one number shows.
double noncentralityThatShows(double dof, double critical, double power)
{
    const double limit = quantileF(1, dof, critical);
    double low = 0., high = 1.;
    while (upperTailNoncentralF(1, dof, high, limit) < power)
        high *= 2.;
    for (int i = 0; i < 40; i++)
        (upperTailNoncentralF(1, dof, 0.5*(low + high), limit) < power ? low : high) = 0.5*(low + high);
    return high;
}

std::string valueOf(const UncertaintySource& source) { return source.name.substr(0, source.name.find(", camera")); }

//! Nobody gives a wedge: it is 0 within its +-, as are a bow and a tilt.
bool isGiven(const UncertaintySource& source)
{
    const std::string of = valueOf(source);
    return source.std > 0.
           && (source.isOfTarget() || of == "thickness" || of == "index" || of == "radius" || of == INDEX_OF_MEDIUM);
}

//! "mm" of "0.1 mm (default)".
std::string unitOf(const UncertaintySource& source)
{
    const size_t begin = source.given.find_first_not_of("0123456789.e+- "), end = source.given.find(" (");
    return begin == std::string::npos || begin >= end ? "" : source.given.substr(begin, end - begin);
}

//! How an error by one standard deviation moves the calibrated values and the target, a line each.
std::vector<Change> errorsOf(const UncertaintySource& source, const CheckInput& input)
{
    const int scale = columnCount(input.rig);
    const double sizeInItsUnit = input.square > 0. ? input.square : 100.;
    std::vector<Change> errors;
    for (int column = 0; column < source.factor.cols; column++)
    {
        VectorXd direction = VectorXd::Zero(scale + 1);
        for (int i = 0; i < scale; i++)
            direction[i] = source.factor.at<double>(i, column);
        direction[scale] = source.isOfTarget() ? source.std/sizeInItsUnit : 0.;
        errors.push_back({"", -1, {{"", 1., 1, 1.}}, [direction](RigModel& rig, const VectorXd& delta) {
            VectorXd p = parametersOf(rig);
            p.head(direction.size()) += delta[0]*direction;
            setParameters(rig, p); }});
    }
    return errors;
}

} // namespace

double gainOf(const TestedDirections& tested, const MatrixXd& G, const VectorXd& score)
{
    return timesVector(whitening(tested, G), score.segment(tested.first, tested.directions.rows())).squaredNorm();
}

double probabilityOf(double gain, int count, double dof)
{
    return upperTailAnyF(count, dof, gain/count);
}

double criticalProbability(const std::vector<TestedDirections>& tested, const MatrixXd& G, double dof, double falseAlarm)
{
    const double bonferroni = falseAlarm/std::max((size_t)1, tested.size());
    if (tested.empty() || falseAlarm*DRAWS < LEAST_IN_TAIL)
        return bonferroni;
    const SymmetricEigen eigen(G);
    const MatrixXd root = eigen.vectors*eigen.values.cwiseMax(0.).cwiseSqrt().asDiagonal();
    std::vector<MatrixXd> white;
    for (const TestedDirections& t : tested)
        white.push_back(product(whitening(t, G), root.middleRows(t.first, t.directions.rows())));
    cv::RNG random(0x5eed);
    std::vector<double> least;
    VectorXd z(root.cols());
    for (int draw = 0; draw < DRAWS; draw++)
    {
        for (double& value : z)
            value = random.gaussian(1.);
        std::map<int, double> largest;          // gain, for each number of parameters
        for (size_t i = 0; i < tested.size(); i++)
        {
            double& gain = largest[tested[i].count()];
            gain = std::max(gain, timesVector(white[i], z).squaredNorm());
        }
        const double variance = drawnVariance(dof, random);
        double p = 1.;
        for (const auto& [count, gain] : largest)
            p = std::min(p, probabilityOf(gain/variance, count, dof));
        least.push_back(p);
    }
    std::sort(least.begin(), least.end());
    return std::max(bonferroni, least[(size_t)(falseAlarm*DRAWS)]);
}

std::vector<UnseenError> unseenErrors(const CheckInput& input, const CheckProblem& problem, const CheckFit& asCalibrated, double dof,
                                      double critical, double power)
{
    const double FAR_OFF = 100.;            // standard deviations: how it looks then nobody knows
    const double needed = noncentralityThatShows(dof, critical, power);
    std::vector<UnseenError> unseen;
    for (const UncertaintySource& source : input.sources)
    {
        if (!isGiven(source))
            continue;
        const MatrixXd G = problem.information(errorsOf(source, input), asCalibrated).G;
        if (!(G.size() > 0))
            return {};
        const double times = std::sqrt(needed/std::max(0., SymmetricEigen(G).values[0]));
        const UnseenError error{valueOf(source), times < FAR_OFF ? times*source.std : NONE_SHOWS, unitOf(source),
                                source.isOfTarget()};
        const auto same = std::find_if(unseen.begin(), unseen.end(), [&](const UnseenError& u) { return u.of == error.of; });
        if (same == unseen.end())
            unseen.push_back(error);
        else
            same->least = std::max(same->least, error.least);
    }
    std::stable_partition(unseen.begin(), unseen.end(), [](const UnseenError& u) { return u.isOfTarget; });
    return unseen;
}

} // namespace tools
