// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Of a point X and another at o with |X - o| = L, images often tell one direction d hardly: along their rays, or where one of two cameras
sees half a pixel, along one ray. The length holds at both s of |X + s d - o| = L, and between them the squares have a hill. Fits start
at either, as the images of cameras that are not yet where they should be have it. Starts are the other s of each end of each length,
and the points where images alone have them.

Of a point of halves, the sheet that half a pixel sees is bent by the window, and a line of sight may meet it twice as well. Starts are
nearer and farther along d. */

#include "adjust/point_minima.hpp"
#include "adjust/inner.hpp"
#include "math/dense.hpp"
#include "math/robust_scale.hpp"

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

//! Without lengths while it lives.
class ImagesAlone
{
public:
    explicit ImagesAlone(Problem& problem) : clusters_(problem.scene().clusters())
    {
        for (Cluster& cluster : clusters_)
        {
            lengths_.push_back(std::vector<KnownLength>());
            lengths_.back().swap(cluster.lengths);
        }
    }
    ~ImagesAlone()
    {
        for (size_t i = 0; i < clusters_.size(); i++)
            lengths_[i].swap(clusters_[i].lengths);
    }
    ImagesAlone(const ImagesAlone&) = delete;
    ImagesAlone& operator=(const ImagesAlone&) = delete;

private:
    std::vector<Cluster>& clusters_;
    std::vector<std::vector<KnownLength> > lengths_;
};

const int BY_RAYS = 2;          // whole pixels: rays meet once

//! Whole pixels of each point that have a weight.
std::vector<int> countWholePixels(const Problem& problem)
{
    std::vector<int> whole(problem.scene().pointCount(), 0);
    for (const Image& image : problem.images())
        for (size_t row = 0; row < image.rootWeights.size(); row++)
            whole[image.points.index[row]] += image.rootWeights[row] > 0 && image.points.rowsOf(row) == 2;
    return whole;
}

//! Equations of a cluster beyond its unknowns.
int freedomOf(const Problem& problem, int index)
{
    const Cluster& cluster = problem.scene().clusters()[index];
    int equations = (int)cluster.lengths.size();
    for (const Observation& o : problem.observationsOf(index))
        if (problem.images()[o.image].rootWeights[o.row] > 0)
            equations += problem.images()[o.image].points.rowsOf(o.row);
    return equations - cluster.size();
}

//! Clusters that may have several minima: of several points, or of one that halves determine.
std::vector<int> clustersOfSeveralMinima(const Problem& problem, const std::vector<int>& wholePixels)
{
    std::vector<int> some;
    for (int i = 0; i < (int)problem.scene().clusters().size(); i++)
    {
        const std::vector<int>& points = problem.scene().clusters()[i].points;
        if (points.size() > 1 || wholePixels[points[0]] < BY_RAYS)
            some.push_back(i);
    }
    return some;
}

//! How far the first point of each of some clusters is from a camera that sees it.
std::vector<double> distancesOf(const Problem& problem, const std::vector<int>& some)
{
    std::vector<double> distances(problem.scene().clusters().size(), 0.);
    for (int i : some)
    {
        const Image& image = problem.images()[problem.observationsOf(i)[0].image];
        const Vec3d center = problem.camFromScene(image).inverse(Vec3d())/problem.sceneScale();
        distances[i] = (problem.scene().clusters()[i].values.head<3>() - Vector3d(center[0], center[1], center[2])).norm();
    }
    return distances;
}

//! The best that was found of each cluster that may have several minima, and the next best.
class BestClusters
{
public:
    explicit BestClusters(Problem& problem)
        : problem_(problem), wholePixels_(countWholePixels(problem)), some_(clustersOfSeveralMinima(problem, wholePixels_)),
          distances_(distancesOf(problem, some_)), ofOthers_(distances_.size(), std::numeric_limits<double>::infinity()),
          hasChanged_(distances_.size(), false)
    {
        if (isNone())
            return;
        squares_ = optimizeClusters(problem, some_);
        for (const Cluster& cluster : problem.scene().clusters())
            best_.push_back(cluster.values);
    }
    bool isNone() const { return some_.empty(); }

    //! Of clusters that have been moved, from where they are; true if one is better for it.
    bool improve(const std::vector<int>& moved)
    {
        const double BETTER = 1e-3;         // of the squares: more than what minimisation leaves
        const double SEEN = 1e-6*problem_.pixelSigma()*problem_.pixelSigma();
        problem_.placePoints(problem_.scene().points());
        const std::vector<double> now = optimizeClusters(problem_, moved);
        bool isBetter = false;
        for (int i : moved)
        {
            const Cluster& cluster = problem_.scene().clusters()[i];
            if ((cluster.values - best_[i]).norm() > tolerance(i))
                ofOthers_[i] = std::min(ofOthers_[i], std::max(now[i], squares_[i]));
            if (now[i] < (1 - BETTER)*squares_[i] - SEEN)
            {
                squares_[i] = now[i];
                best_[i] = cluster.values;
                isBetter = hasChanged_[i] = true;
            }
        }
        return isBetter;
    }

    void restore()
    {
        for (int i : some_)
        {
            problem_.scene().clusters()[i].values = best_[i];
            problem_.placeCluster(i);
        }
    }
    bool hasChanged() const { return std::find(hasChanged_.begin(), hasChanged_.end(), true) != hasChanged_.end(); }
    const std::vector<int>& clusters() const { return some_; }
    double distance(int cluster) const { return distances_[cluster]; }
    //! By how much another minimum of this cluster has more squares.
    double lead(int cluster) const { return ofOthers_[cluster] - squares_[cluster]; }
    double squares(int cluster) const { return squares_[cluster]; }

    //! Of a residual, as the median cluster tells it: cameras that are off leave some clusters with huge squares.
    double usualVariance() const
    {
        const double MEDIAN = 0.4549;       // of chi2 with one degree of freedom
        const size_t ENOUGH = 10;
        std::vector<double> variances;
        for (int i : some_)
            if (freedomOf(problem_, i) > 0)
                variances.push_back(squares_[i]/freedomOf(problem_, i));
        return variances.size() < ENOUGH ? problem_.squaredError()/std::max(problem_.freedom(), 1) : median(variances)/MEDIAN;
    }

    //! Those that rays have once, whatever the others of the cluster.
    bool isByRays(int point) const { return wholePixels_[point] >= BY_RAYS; }

private:
    //! Nearer it is the same place.
    double tolerance(int i) const
    {
        const double SAME = 1e-3;           // of the longest length, or of a single point's distance
        const Cluster& cluster = problem_.scene().clusters()[i];
        double longest = cluster.lengths.empty() ? distances_[i] : 0;
        for (const KnownLength& length : cluster.lengths)
            longest = std::max(longest, length.length);
        return SAME*longest;
    }

    Problem& problem_;
    const std::vector<int> wholePixels_, some_;
    const std::vector<double> distances_;
    std::vector<double> squares_, ofOthers_;
    std::vector<bool> hasChanged_;
    std::vector<VectorXd> best_;        //!< values
};

//! The direction of a point that images tell least.
Vector3d weakDirection(const MatrixXd& ofImages, int place)
{
    return SymmetricEigen3(Eigen::Matrix3d(ofImages.block<3, 3>(3*place, 3*place))).vectors.col(0);
}

//! Moves a point by s along d to where the length holds again, or to where it holds best if it holds at one place only.
void mirror(const KnownLength& length, bool ofFirst, const MatrixXd& ofImages, Eigen::Map<VectorXd>& values)
{
    const int own = 3*(ofFirst ? length.a : length.b), other = 3*(ofFirst ? length.b : length.a);
    const Vector3d d = weakDirection(ofImages, own/3), between = values.segment<3>(own) - values.segment<3>(other);
    const double half = d.dot(between), root = half*half - between.squaredNorm() + length.length*length.length;
    const double wayBack = root > 0 ? std::copysign(std::sqrt(root), half) : 0;
    values.segment<3>(own) -= (half + wayBack)*d;
}

//! The lengths with this number in their clusters, by one of their ends. @return the clusters that have as many
std::vector<int> mirrorAll(Problem& problem, int number, bool ofFirst, const std::vector<MatrixXd>& ofImages)
{
    std::vector<int> moved;
    for (int i = 0; i < (int)ofImages.size(); i++)
    {
        Cluster& cluster = problem.scene().clusters()[i];
        if (number >= (int)cluster.lengths.size())
            continue;
        moved.push_back(i);
        mirror(cluster.lengths[number], ofFirst, ofImages[i], cluster.values);
    }
    return moved;
}

//! Points alone by so much of their distance along d. @return their clusters
std::vector<int> slideAll(Problem& problem, const BestClusters& best, double part, const std::vector<MatrixXd>& ofImages)
{
    std::vector<int> moved;
    for (int i : best.clusters())
    {
        Cluster& cluster = problem.scene().clusters()[i];
        if (cluster.points.size() > 1)
            continue;
        moved.push_back(i);
        cluster.values += part*best.distance(i)*weakDirection(ofImages[i], 0);
    }
    return moved;
}

//! @return whether another minimum is better
bool searchAlong(Problem& problem, BestClusters& best)
{
    best.restore();
    std::vector<MatrixXd> ofImages;
    {
        const ImagesAlone alone(problem);
        ofImages = informationOfClusters(problem, best.clusters());
    }
    bool isBetter = false;
    std::vector<int> moved = best.clusters();
    for (int start = 0; !moved.empty(); start++)
    {
        best.restore();
        moved = mirrorAll(problem, start/2, start % 2 == 0, ofImages);
        isBetter = (!moved.empty() && best.improve(moved)) || isBetter;
    }
    for (double part : { -0.5, -0.25, -0.1, 0.1, 0.25, 0.5 })
    {
        best.restore();
        moved = slideAll(problem, best, part, ofImages);
        isBetter = (!moved.empty() && best.improve(moved)) || isBetter;
    }
    return isBetter;
}

void search(Problem& problem, BestClusters& best)
{
    const int ROUNDS = 3;
    {
        const ImagesAlone alone(problem);
        optimizeClusters(problem, best.clusters());
    }
    best.improve(best.clusters());
    for (int round = 0; round < ROUNDS && searchAlong(problem, best); round++) {}
    best.restore();
}

} // namespace

bool moveToLeastMinima(Problem& problem)
{
    BestClusters best(problem);
    if (best.isNone())
        return false;
    search(problem, best);
    return best.hasChanged();
}

std::vector<Point3d> pointsOfOneMinimum(Problem& problem, double lead)
{
    const double MET = 1e-6;        // by three equations for three unknowns
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    BestClusters best(problem);
    if (best.isNone())
        return problem.scene().points();
    search(problem, best);
    std::vector<Point3d> points = problem.scene().points();
    const double variance = best.usualVariance();
    for (int i : best.clusters())
    {
        const std::vector<int>& own = problem.scene().clusters()[i].points;
        const bool isMet = freedomOf(problem, i) > 0 || best.squares(i) <= MET*variance;
        if (isMet && !(best.lead(i) < lead*variance))
            continue;
        const bool areAllByRays = std::all_of(own.begin(), own.end(), [&](int point) { return best.isByRays(point); });
        for (int point : own)
            if (areAllByRays || !best.isByRays(point))
                points[point] = Point3d(NaN, NaN, NaN);
    }
    return points;
}

std::vector<Point3d> pointsThatTell(const Problem& problem)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    std::vector<Point3d> points = problem.scene().points();
    for (int i = 0; i < (int)problem.scene().clusters().size(); i++)
        if (freedomOf(problem, i) <= 0)
            for (int point : problem.scene().clusters()[i].points)
                points[point] = Point3d(NaN, NaN, NaN);
    return points;
}

}} // namespace
