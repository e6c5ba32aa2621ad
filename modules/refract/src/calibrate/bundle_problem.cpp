// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/bundle_problem.hpp"
#include <numeric>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

RigViews viewsOfScene(const std::vector<PixelViews>& pixels, int pointCount)
{
    RigViews views;
    const int count = (int)pixels[0].size();
    views.object.assign(count, std::vector<Point3d>(pointCount));
    for (const PixelViews& ofCamera : pixels)
    {
        CameraViews camera;
        camera.refracted = ofCamera;
        camera.direct.resize(count);
        views.cameras.push_back(camera);
    }
    return views;
}

bool isUsed(const Point3d& point) { return std::isfinite(point.x); }

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
        if (!isUsed(points[length.a]) || !isUsed(points[length.b]))
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

BundleProblem::BundleProblem(const Rig& rig, const std::vector<PixelViews>& pixels, int pointCount,
                             const std::vector<Pose>& poses, const std::vector<PoseKnowledge>& known,
                             const std::vector<KnownLength>& lengths, int flags)
    : rig_(rig, viewsOfScene(pixels, pointCount), poses, known, std::vector<CameraKnowledge>(), flags),
      pointCount_(pointCount), lengths_(lengths), states_(rig_.images().size()), hasDerivatives_(false) {}

void BundleProblem::setPoints(const std::vector<Point3d>& points, const std::vector<std::vector<uchar> >& isInlier)
{
    const std::vector<int> first = firstOfCluster(points, lengths_);
    std::vector<int>&clusterOf = clusterOf_, &at = at_;
    clusterOf.assign(pointCount_, -1);
    at.assign(pointCount_, -1);
    std::vector<std::vector<int> > members;
    for (int i = 0; i < pointCount_; i++)
    {
        if (!isUsed(points[i]))
            continue;
        if (first[i] == i)
            members.push_back(std::vector<int>());
        clusterOf[i] = first[i] == i ? (int)members.size() - 1 : clusterOf[first[i]];
        at[i] = (int)members[clusterOf[i]].size();
        members[clusterOf[i]].push_back(i);
    }
    values_.assign(3*(size_t)pointCount_, 0.);
    clusters_.clear();
    double* next = values_.data();
    for (const std::vector<int>& ofCluster : members)
    {
        Cluster cluster = { ofCluster, {}, {}, Eigen::Map<Eigen::VectorXd>(next, 3*(int)ofCluster.size()) };
        for (int i : ofCluster)
        {
            *next++ = points[i].x; *next++ = points[i].y; *next++ = points[i].z;
        }
        clusters_.push_back(cluster);
    }
    for (const KnownLength& length : lengths_)
        if (isUsed(points[length.a]) && isUsed(points[length.b]))
            clusters_[clusterOf[length.a]].lengths.push_back({ at[length.a], at[length.b], length.length, length.sigma });
    isInlier_.assign(rig_.images().size(), std::vector<uchar>());
    for (int i = 0; i < (int)rig_.images().size(); i++)
    {
        const std::vector<int>& index = rig_.images()[i].points.index;
        std::vector<double> rootWeights(index.size(), 0.);
        for (int row = 0; row < (int)index.size(); row++)
        {
            if (clusterOf[index[row]] < 0 || (!isInlier.empty() && !isInlier[i][row]))
                continue;
            rootWeights[row] = 1;
            clusters_[clusterOf[index[row]]].sightings.push_back({ i, row, at[index[row]] });
        }
        rig_.setRootWeights(i, rootWeights);
        isInlier_[i].assign(rootWeights.begin(), rootWeights.end());
    }
    rig_.setObjectPoints(this->points());
}

std::vector<Point3d> BundleProblem::points() const
{
    std::vector<Point3d> points(pointCount_, Point3d(NaN, NaN, NaN));
    for (const Cluster& cluster : clusters_)
        for (int k = 0; k < (int)cluster.points.size(); k++)
            points[cluster.points[k]] = Point3d(cluster.values[3*k], cluster.values[3*k + 1], cluster.values[3*k + 2]);
    return points;
}

int BundleProblem::lengthCount() const
{
    int count = 0;
    for (const Cluster& cluster : clusters_)
        count += (int)cluster.lengths.size();
    return count;
}

int BundleProblem::equationCount() const
{
    return rig_.equationCount() + lengthCount();
}

int BundleProblem::freedom() const
{
    int ofPoints = 0;
    for (const Cluster& cluster : clusters_)
        ofPoints += cluster.size();
    return rig_.freedom() + lengthCount() - ofPoints;
}

double BundleProblem::squaredError() const
{
    double sum = rig_.squaredError();
    Eigen::RowVectorXd byValues;
    for (const Cluster& cluster : clusters_)
        for (const KnownLength& length : cluster.lengths)
            sum += std::pow(rig_.pixelSigma()*cluster.residual(length, byValues), 2);
    return sum;
}

bool BundleProblem::evaluate(bool wantsDerivatives)
{
    rig_.updateCameras();
    rig_.setObjectPoints(points());
    parallel_for_(Range(0, (int)states_.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
        {
            const RigImage& image = rig_.images()[i];
            ImageState& state = states_[i];
            state.isPossible = rig_.evaluate(image, wantsDerivatives, state.derivatives);
            if (!state.isPossible || !wantsDerivatives)
                continue;
            // A point moves as the view's translation does, turned into the scene's frame.
            const Matx33d R = rotationMatrix(rig_.pose(image.view).rvec);
            state.byPoint = state.derivatives.byPose.rightCols<3>()*
                            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> >(R.val);
        }
    });
    hasDerivatives_ = wantsDerivatives;
    return std::all_of(states_.begin(), states_.end(), [](const ImageState& state) { return state.isPossible; });
}

void BundleProblem::evaluateAll(std::vector<std::vector<uchar> >& hasImage)
{
    hasImage.assign(states_.size(), std::vector<uchar>());
    std::vector<std::vector<double> > weights;
    for (int i = 0; i < (int)states_.size(); i++)
    {
        const RigImage& image = rig_.images()[i];
        weights.push_back(image.rootWeights);
        for (double error : rig_.pixelErrors(image, rig_.pose(image.view)))
            hasImage[i].push_back(clusterOf_[image.points.index[hasImage[i].size()]] >= 0 && std::isfinite(error));
        rig_.setRootWeights(i, std::vector<double>(hasImage[i].begin(), hasImage[i].end()));
    }
    CV_Assert(evaluate(true));
    for (int i = 0; i < (int)states_.size(); i++)
        rig_.setRootWeights(i, weights[i]);
}

void BundleProblem::PrepareForEvaluation(bool wantsDerivatives, bool isNewPoint)
{
    if (isNewPoint || (wantsDerivatives && !hasDerivatives_))
        evaluate(wantsDerivatives);
}

}} // namespace
