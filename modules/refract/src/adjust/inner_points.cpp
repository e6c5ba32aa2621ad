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

Image partOf(const Image& image, const std::vector<int>& rows)
{
    Image part = { image.view, image.camera, image.refracted, {}, {} };
    for (int row : rows)
    {
        part.points.object.push_back(image.points.object[row]);
        part.points.pixel.push_back(image.points.pixel[row]);
        if (!image.points.whitening.empty())
            part.points.whitening.push_back(image.points.whitening[row]);
        part.rootWeights.push_back(image.rootWeights[row]);
    }
    return part;
}

//! Images at the current points: residuals, and derivatives by these.
class SceneRows
{
public:
    explicit SceneRows(const Problem& problem) : problem_(problem), images_(problem.images().size()) {}

    //! Of these clusters alone: of the last ones on their way, few rows are asked for.
    void update(const std::vector<int>& clusters)
    {
        std::vector<std::vector<int> > wanted(images_.size());
        for (int cluster : clusters)
            for (const Observation& o : problem_.observationsOf(cluster))
                if (problem_.images()[o.image].rootWeights[o.row] > 0)
                    wanted[o.image].push_back(o.row);
        parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
        {
            for (int i = range.start; i < range.end; i++)
                if (!wanted[i].empty())
                    updateImage(problem_.images()[i], wanted[i], images_[i]);
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
            const Eigen::Matrix<double, 2, 3> E = images_[o.image].byPose.middleRows<2>(2*o.row);
            const int at = 3*problem_.scene().placeInCluster(image.points.index[o.row]);
            sum.value += residual.squaredNorm();
            sum.matrix.block<3, 3>(at, at) += E.transpose()*E;
            sum.gradient.segment<3>(at) += E.transpose()*residual;
        }
        sum.value += cluster.addLengths(problem_.pixelSigma(), sum.matrix, sum.gradient);
        return sum;
    }

private:
    void updateImage(const Image& image, const std::vector<int>& wanted, Problem::Derivatives& rows) const
    {
        const Image some = partOf(image, wanted);
        Problem::Derivatives ofSome;
        problem_.evaluate(some, some.rootWeights, Problem::BY_POSE, ofSome);
        rows.residuals.resize(2*image.rootWeights.size());
        rows.byPose.resize(rows.residuals.size(), 3);
        const RowMajorMatrix byPoint = problem_.byScenePoint(some, ofSome.byPose);
        for (size_t k = 0; k < wanted.size(); k++)
        {
            rows.residuals.segment<2>(2*wanted[k]) = ofSome.residuals.segment<2>(2*k);
            rows.byPose.middleRows<2>(2*wanted[k]) = byPoint.middleRows<2>(2*k);
        }
    }

    const Problem& problem_;
    std::vector<Problem::Derivatives> images_;      //!< byPose: by the points
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

//! Of the clusters that have an image.
double sumOfSquares(const std::vector<ClusterSearch>& searches)
{
    double sum = 0;
    for (const ClusterSearch& search : searches)
        if (std::isfinite(search.best.value))
            sum += search.best.value;
    return sum;
}

template<class Body>
void forEachOf(const std::vector<int>& clusters, const Body& body)
{
    parallel_for_(Range(0, (int)clusters.size()), [&](const Range& range)
    {
        for (int k = range.start; k < range.end; k++)
            body(clusters[k]);
    });
}

} // namespace

std::vector<double> optimizeClusters(Problem& problem, const std::vector<int>& some)
{
    const int ROUNDS = 50;
    std::vector<Cluster>& clusters = problem.scene().clusters();
    std::vector<ClusterSearch> searches(clusters.size());
    std::vector<int> left = some;
    if (some.empty())
    {
        left.resize(clusters.size());
        std::iota(left.begin(), left.end(), 0);
    }
    const int count = std::max((int)left.size(), 1);
    SceneRows rows(problem);
    for (int round = 0; round < ROUNDS && !left.empty(); round++)
    {
        rows.update(left);
        forEachOf(left, [&](int i)
        {
            ClusterSearch& search = searches[i];
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
        });
        const double mean = sumOfSquares(searches)/count;
        forEachOf(left, [&](int i)
        {
            ClusterSearch& search = searches[i];
            search.isDone = !std::isfinite(search.best.value);
            if (search.isDone)
                return;
            double gain;
            const VectorXd step = stepOf(search.best, search.control.damping(), gain);
            search.isDone = round + 1 == ROUNDS || search.control.isHopeless() ||
                            StepControl::isNegligible(gain, std::max(mean, search.best.value), 6);
            clusters[i].values = search.isDone ? search.values : VectorXd(search.values + step);
            problem.placeCluster(i);
        });
        left.erase(std::remove_if(left.begin(), left.end(), [&](int i) { return searches[i].isDone; }), left.end());
    }
    std::vector<double> squares;
    for (const ClusterSearch& search : searches)
        squares.push_back(search.best.value);
    return squares;
}

std::vector<MatrixXd> informationOfClusters(const Problem& problem, const std::vector<int>& some)
{
    SceneRows rows(problem);
    rows.update(some);
    std::vector<MatrixXd> matrices(problem.scene().clusters().size());
    for (int i : some)
        matrices[i] = rows.squaresOf(i).matrix;
    return matrices;
}

bool optimizePoints(Problem& problem, double& squaredError)
{
    const std::vector<double> squares = optimizeClusters(problem);
    squaredError = std::accumulate(squares.begin(), squares.end(), problem.squaredOuterPriors());
    return std::isfinite(squaredError);
}

}} // namespace
