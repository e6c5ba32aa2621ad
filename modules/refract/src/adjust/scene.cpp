// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/scene.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

//! For each point the first of those that lengths tie it to, directly or through others.
std::vector<int> firstOfCluster(const std::vector<Point3d>& points, const std::vector<KnownLength>& lengths)
{
    std::vector<int> parent(points.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i)
    {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    };
    for (const KnownLength& length : lengths)
    {
        if (!std::isfinite(points[length.a].x) || !std::isfinite(points[length.b].x))
            continue;
        const int a = root(length.a), b = root(length.b);
        parent[std::max(a, b)] = std::min(a, b);
    }
    std::vector<int> first(points.size());
    for (int i = 0; i < (int)points.size(); i++)
        first[i] = root(i);
    return first;
}

} // namespace

//! Length minus the known one, in its standard deviations, and its derivatives by values.
double Cluster::residual(const KnownLength& length, Eigen::RowVectorXd& byValues) const
{
    const Eigen::Vector3d between = values.segment<3>(3*length.a) - values.segment<3>(3*length.b);
    const double found = between.norm();
    byValues.setZero(size());
    if (found > 0)
    {
        byValues.segment<3>(3*length.a) = between.transpose()/(found*length.sigma);
        byValues.segment<3>(3*length.b) = -byValues.segment<3>(3*length.a);
    }
    return (found - length.length)/length.sigma;
}

double Cluster::addLengths(double pixelSigma, Eigen::MatrixXd& matrix, Eigen::VectorXd& gradient) const
{
    double squares = 0;
    Eigen::RowVectorXd byValues;
    for (const KnownLength& length : lengths)
    {
        const double r = pixelSigma*residual(length, byValues);
        byValues *= pixelSigma;
        matrix += byValues.transpose()*byValues;
        gradient += byValues.transpose()*r;
        squares += r*r;
    }
    return squares;
}

double Cluster::squaredLengthError(double pixelSigma) const
{
    double squares = 0;
    Eigen::RowVectorXd byValues;
    for (const KnownLength& length : lengths)
        squares += std::pow(pixelSigma*residual(length, byValues), 2);
    return squares;
}

Scene::Scene(int pointCount, const std::vector<KnownLength>& lengths)
    : pointCount_(pointCount), lengths_(lengths), clusterOf_(pointCount, -1), at_(pointCount, -1) {}

void Scene::setPoints(const std::vector<Point3d>& points)
{
    const std::vector<int> first = firstOfCluster(points, lengths_);
    clusterOf_.assign(pointCount_, -1);
    at_.assign(pointCount_, -1);
    std::vector<std::vector<int> > members;
    for (int i = 0; i < pointCount_; i++)
    {
        if (!std::isfinite(points[i].x))
            continue;
        if (first[i] == i)
            members.push_back(std::vector<int>());
        clusterOf_[i] = first[i] == i ? (int)members.size() - 1 : clusterOf_[first[i]];
        at_[i] = (int)members[clusterOf_[i]].size();
        members[clusterOf_[i]].push_back(i);
    }
    values_.assign(3*(size_t)pointCount_, 0.);
    clusters_.clear();
    double* next = values_.data();
    for (const std::vector<int>& ofCluster : members)
    {
        const Cluster cluster = { ofCluster, {}, Eigen::Map<Eigen::VectorXd>(next, 3*(int)ofCluster.size()) };
        for (int i : ofCluster)
        {
            *next++ = points[i].x; *next++ = points[i].y; *next++ = points[i].z;
        }
        clusters_.push_back(cluster);
    }
    for (const KnownLength& length : lengths_)
        if (isUsed(length.a) && isUsed(length.b))
            clusters_[clusterOf_[length.a]].lengths.push_back({ at_[length.a], at_[length.b], length.length, length.sigma });
}

std::vector<Point3d> Scene::points() const
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    std::vector<Point3d> points(pointCount_, Point3d(NaN, NaN, NaN));
    for (const Cluster& cluster : clusters_)
        for (int k = 0; k < (int)cluster.points.size(); k++)
            points[cluster.points[k]] = Point3d(cluster.values[3*k], cluster.values[3*k + 1], cluster.values[3*k + 2]);
    return points;
}

int Scene::lengthCount() const
{
    int count = 0;
    for (const Cluster& cluster : clusters_)
        count += (int)cluster.lengths.size();
    return count;
}

int Scene::coordinateCount() const
{
    int count = 0;
    for (const Cluster& cluster : clusters_)
        count += cluster.size();
    return count;
}

}} // namespace
