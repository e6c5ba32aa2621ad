// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Of a point X and another at o with |X - o| = L, images often tell one direction d hardly: along their rays, or where one of two cameras
sees half a pixel, along one ray. The length holds at both s of |X + s d - o| = L, and between them the squares have a hill. Fits start
at either, as the images of cameras that are not yet where they should be have it. Starts are the other s of each end of each length,
and the points where images alone have them. */

#include "adjust/point_minima.hpp"
#include "adjust/inner.hpp"
#include "math/dense.hpp"

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

//! The best that was found of each cluster, and the next best.
class BestClusters
{
public:
    explicit BestClusters(Problem& problem) : problem_(problem)
    {
        squares_ = optimizeClusters(problem, true);
        values_ = innerValues(problem);
        hasChanged_.assign(squares_.size(), false);
        ofOthers_.assign(squares_.size(), std::numeric_limits<double>::infinity());
    }

    //! From where the points are; true if one is better for it.
    bool improve()
    {
        const double BETTER = 1e-3;         // of the squares: more than what minimisation leaves
        problem_.placePoints(problem_.scene().points());
        const std::vector<double> now = optimizeClusters(problem_, true);
        int at = 0;
        bool isBetter = false;
        for (size_t i = 0; i < now.size(); i++)
        {
            const Cluster& cluster = problem_.scene().clusters()[i];
            if (isElsewhere(cluster, values_.segment(at, cluster.size())))
                ofOthers_[i] = std::min(ofOthers_[i], std::max(now[i], squares_[i]));
            if (now[i] < (1 - BETTER)*squares_[i])
            {
                squares_[i] = now[i];
                values_.segment(at, cluster.size()) = cluster.values;
                isBetter = hasChanged_[i] = true;
            }
            at += cluster.size();
        }
        return isBetter;
    }

    void restore() { setInnerValues(problem_, values_); }
    bool hasChanged() const { return std::find(hasChanged_.begin(), hasChanged_.end(), true) != hasChanged_.end(); }
    //! By how much another minimum of this cluster has more squares.
    double lead(int cluster) const { return ofOthers_[cluster] - squares_[cluster]; }

private:
    static bool isElsewhere(const Cluster& cluster, const VectorXd& best)
    {
        const double SAME = 1e-3;           // of the longest length
        double longest = 0;
        for (const KnownLength& length : cluster.lengths)
            longest = std::max(longest, length.length);
        return (cluster.values - best).norm() > SAME*longest;
    }

    Problem& problem_;
    std::vector<double> squares_, ofOthers_;
    VectorXd values_;
    std::vector<bool> hasChanged_;
};

//! Moves a point by s along d to where the length holds again, or to where it holds best if it holds at one place only.
void mirror(const KnownLength& length, bool ofFirst, const MatrixXd& ofImages, Eigen::Map<VectorXd>& values)
{
    const int own = 3*(ofFirst ? length.a : length.b), other = 3*(ofFirst ? length.b : length.a);
    const SymmetricEigen3 axes(Eigen::Matrix3d(ofImages.block<3, 3>(own, own)));
    const Vector3d d = axes.vectors.col(0), between = values.segment<3>(own) - values.segment<3>(other);
    const double half = d.dot(between), root = half*half - between.squaredNorm() + length.length*length.length;
    const double wayBack = root > 0 ? std::copysign(std::sqrt(root), half) : 0;
    values.segment<3>(own) -= (half + wayBack)*d;
}

//! The lengths with this number in their clusters, by one of their ends; false: no cluster has as many.
bool mirrorAll(Problem& problem, int number, bool ofFirst, const std::vector<MatrixXd>& ofImages)
{
    bool isAny = false;
    for (size_t i = 0; i < ofImages.size(); i++)
    {
        Cluster& cluster = problem.scene().clusters()[i];
        if (number >= (int)cluster.lengths.size())
            continue;
        isAny = true;
        mirror(cluster.lengths[number], ofFirst, ofImages[i], cluster.values);
    }
    return isAny;
}

void search(Problem& problem, BestClusters& best)
{
    const int ROUNDS = 3;
    {
        const ImagesAlone alone(problem);
        optimizeClusters(problem, true);
    }
    bool isBetter = best.improve();
    for (int round = 0; round < ROUNDS && (round == 0 || isBetter); round++)
    {
        best.restore();
        std::vector<MatrixXd> ofImages;
        {
            const ImagesAlone alone(problem);
            ofImages = informationOfTied(problem);
        }
        isBetter = false;
        bool isAny = true;
        for (int start = 0; isAny; start++)
        {
            best.restore();
            isAny = mirrorAll(problem, start/2, start % 2 == 0, ofImages);
            isBetter = (isAny && best.improve()) || isBetter;
        }
    }
    best.restore();
}

} // namespace

bool moveToLeastMinima(Problem& problem)
{
    if (problem.scene().lengthCount() == 0)
        return false;
    BestClusters best(problem);
    search(problem, best);
    return best.hasChanged();
}

std::vector<Point3d> pointsOfOneMinimum(Problem& problem)
{
    const double LEAD = 25;         // variances of a residual
    std::vector<Point3d> points = problem.scene().points();
    if (problem.scene().lengthCount() == 0)
        return points;
    BestClusters best(problem);
    search(problem, best);
    points = problem.scene().points();
    const double NaN = std::numeric_limits<double>::quiet_NaN(), variance = problem.squaredError()/std::max(problem.freedom(), 1);
    for (int i = 0; i < (int)problem.scene().clusters().size(); i++)
        if (best.lead(i) < LEAD*variance)
            for (int point : problem.scene().clusters()[i].points)
                points[point] = Point3d(NaN, NaN, NaN);
    return points;
}

}} // namespace
