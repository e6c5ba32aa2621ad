// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/inner.hpp"
#include "math/dense.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! The sum of squares of one cluster's observations and lengths, with what a step needs.
struct ClusterSquares
{
    double value = 0;
    MatrixXd matrix;
    VectorXd gradient;
};

//! A cluster on its way.
struct ClusterSearch
{
    ClusterSquares best;
    VectorXd values;            //!< of the best
    StepControl control;
    bool isDone = false;
};

//! All images at the current points: residuals, and derivatives by the pose's translation in the scene's frame.
class SceneRows
{
public:
    explicit SceneRows(const Problem& problem) : problem_(problem), images_(problem.images().size()) {}

    void update()
    {
        parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
        {
            for (int i = range.start; i < range.end; i++)
            {
                const Image& image = problem_.images()[i];
                problem_.evaluate(image, image.rootWeights, Problem::BY_POSE, images_[i]);
                images_[i].byPose.rightCols<3>() = problem_.byScenePoint(image, images_[i].byPose);
            }
        });
    }

    //! Infinite where a point has no image.
    ClusterSquares squaresOf(int index) const
    {
        const Cluster& cluster = problem_.scene().clusters()[index];
        ClusterSquares sum;
        sum.matrix = MatrixXd::Zero(cluster.size(), cluster.size());
        sum.gradient = VectorXd::Zero(cluster.size());
        for (const Observation& o : problem_.observationsOf(index))
        {
            const Image& image = problem_.images()[o.image];
            if (image.rootWeights[o.row] == 0)
                continue;
            const Eigen::Vector2d residual = images_[o.image].residuals.segment<2>(2*o.row);
            const Eigen::Matrix<double, 2, 3> E = images_[o.image].byPose.block<2, 3>(2*o.row, 3);
            const int at = 3*problem_.scene().placeInCluster(image.points.index[o.row]);
            sum.value += residual.squaredNorm();
            sum.matrix.block<3, 3>(at, at) += E.transpose()*E;
            sum.gradient.segment<3>(at) += E.transpose()*residual;
        }
        sum.value += cluster.addLengths(problem_.pixelSigma(), sum.matrix, sum.gradient);
        return sum;
    }

private:
    const Problem& problem_;
    std::vector<Problem::Derivatives> images_;
};

//! @param gain of squares that the step promises
VectorXd stepOf(const ClusterSquares& sum, double damping, double& gain)
{
    const double LEAST = 1e-12;     // keeps what no image determines where it is
    const VectorXd scale = sum.matrix.diagonal().cwiseMax(DBL_MIN).cwiseSqrt().cwiseInverse();
    MatrixXd A = scale.asDiagonal()*sum.matrix*scale.asDiagonal();
    A.diagonal().array() += damping + LEAST;
    const VectorXd gradient = scale.cwiseProduct(sum.gradient), step = -LDLT(A).solve(gradient);
    gain = -gradient.dot(step);
    return scale.cwiseProduct(step);
}

//! Of the clusters that have an image: what one of them may still gain is little against it.
double meanSquares(const std::vector<ClusterSearch>& searches)
{
    double sum = 0;
    for (const ClusterSearch& search : searches)
        if (std::isfinite(search.best.value))
            sum += search.best.value;
    return sum/std::max((double)searches.size(), 1.);
}

} // namespace

std::vector<double> optimizeClusters(Problem& problem)
{
    const int ROUNDS = 50;
    std::vector<Cluster>& clusters = problem.scene().clusters();
    std::vector<ClusterSearch> searches(clusters.size());
    SceneRows rows(problem);
    bool areDone = false;
    for (int round = 0; round < ROUNDS && !areDone; round++)
    {
        rows.update();
        parallel_for_(Range(0, (int)clusters.size()), [&](const Range& range)
        {
            for (int i = range.start; i < range.end; i++)
            {
                ClusterSearch& search = searches[i];
                if (search.isDone)
                    continue;
                ClusterSquares now = rows.squaresOf(i);
                if (round > 0 && !(now.value < search.best.value))
                    search.control.reject();
                else
                {
                    if (round > 0)
                        search.control.accept();
                    search.best = std::move(now);
                    search.values = clusters[i].values;
                }
            }
        });
        const double mean = meanSquares(searches);
        areDone = true;
        for (size_t i = 0; i < clusters.size(); i++)
        {
            ClusterSearch& search = searches[i];
            search.isDone = search.isDone || !std::isfinite(search.best.value);
            if (search.isDone)
                continue;
            double gain;
            const VectorXd step = stepOf(search.best, search.control.damping(), gain);
            search.isDone = round + 1 == ROUNDS || search.control.isHopeless() ||
                            StepControl::isNegligible(gain, std::max(mean, search.best.value), 6);
            clusters[i].values = search.isDone ? search.values : VectorXd(search.values + step);
            areDone = areDone && search.isDone;
        }
        problem.placePoints(problem.scene().points());
    }
    std::vector<double> squares;
    for (const ClusterSearch& search : searches)
        squares.push_back(search.best.value);
    return squares;
}

std::vector<MatrixXd> clusterInformation(const Problem& problem)
{
    SceneRows rows(problem);
    rows.update();
    std::vector<MatrixXd> matrices;
    for (int i = 0; i < (int)problem.scene().clusters().size(); i++)
        matrices.push_back(rows.squaresOf(i).matrix);
    return matrices;
}

bool optimizePoints(Problem& problem, double& squaredError)
{
    const std::vector<double> squares = optimizeClusters(problem);
    squaredError = std::accumulate(squares.begin(), squares.end(), 0.);
    for (int block = 0; block < problem.outerCount(); block++)
        squaredError += problem.priorResidual(block).squaredNorm();
    if (problem.rigPrior().count() > 0)
        squaredError += problem.rigPriorResidual().squaredNorm();
    return std::isfinite(squaredError);
}

}} // namespace
