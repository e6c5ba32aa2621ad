// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/check_level.hpp"
#include "measure/distributions.hpp"
#include "math/dense.hpp"
#include <algorithm>
#include <cmath>
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

} // namespace tools
