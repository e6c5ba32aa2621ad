// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/view_motion.hpp"
#include "math/robust_scale.hpp"
#include "math/rotation.hpp"
#include <map>
#include <queue>

namespace cv { namespace refract {

namespace {

//! The views that see a point, each once, in their order.
std::vector<std::vector<int> > viewsOfPoints(const Problem& problem)
{
    std::vector<std::vector<int> > all(problem.scene().pointCount());
    for (const Image& image : problem.images())
        for (size_t row = 0; row < image.points.index.size(); row++)
            if (image.rootWeights[row] > 0)
                all[image.points.index[row]].push_back(image.view);
    for (std::vector<int>& views : all)
    {
        std::sort(views.begin(), views.end());
        views.erase(std::unique(views.begin(), views.end()), views.end());
    }
    return all;
}

//! Of each view: with which others it shares points, one after the other along a point's views, and how many.
std::vector<std::map<int, int> > sharedPoints(const Problem& problem)
{
    std::vector<std::map<int, int> > shared(problem.viewCount());
    for (const std::vector<int>& views : viewsOfPoints(problem))
        for (size_t k = 1; k < views.size(); k++)
        {
            shared[views[k - 1]][views[k]]++;
            shared[views[k]][views[k - 1]]++;
        }
    return shared;
}

//! By coordinates, as some points may be far away.
std::vector<Vec3d> middlesOfViews(const Problem& problem)
{
    std::vector<std::vector<double> > seen[3];
    for (std::vector<std::vector<double> >& coordinates : seen)
        coordinates.resize(problem.viewCount());
    for (const Image& image : problem.images())
        for (size_t row = 0; row < image.points.object.size(); row++)
            for (int k = 0; k < 3 && image.rootWeights[row] > 0; k++)
                seen[k][image.view].push_back(Vec3d(image.points.object[row])[k]);
    std::vector<Vec3d> middles;
    for (int view = 0; view < problem.viewCount(); view++)
        middles.push_back(Vec3d(median(seen[0][view]), median(seen[1][view]), median(seen[2][view])));
    return middles;
}

//! d(R rvec) along a change of rvec.
Matx33d derivativeAlong(const Rotation& rotation, const Vec3d& turn)
{
    return turn[0]*rotation.dR[0] + turn[1]*rotation.dR[1] + turn[2]*rotation.dR[2];
}

} // namespace

//! It grows by the view that shares most points with one that it has (Prim).
std::vector<ViewEdge> treeOfViews(const Problem& problem)
{
    const std::vector<std::map<int, int> > shared = sharedPoints(problem);
    std::vector<ViewEdge> tree;
    std::vector<bool> isReached(shared.size(), false);
    typedef std::pair<int, std::pair<int, int> > Candidate;         // how many points; -from, -to: the first of equals
    std::priority_queue<Candidate> next;
    const auto reach = [&](int view)
    {
        isReached[view] = true;
        for (const std::pair<const int, int>& other : shared[view])
            if (!isReached[other.first])
                next.push({ other.second, { -view, -other.first } });
    };
    for (int view = 0; view < (int)shared.size(); view++)
        if (!problem.isAdjusted(view))
            reach(view);
    for (int root = -1; root < (int)shared.size(); root++)
    {
        if (root >= 0 && !isReached[root])
            reach(root);
        while (!next.empty())
        {
            const ViewEdge edge = { -next.top().second.first, -next.top().second.second };
            next.pop();
            if (isReached[edge.to])
                continue;
            tree.push_back(edge);
            reach(edge.to);
        }
    }
    return tree;
}

ViewMotion::ViewMotion(const Problem& problem, const std::vector<ViewEdge>& tree) : tree_(tree)
{
    const std::vector<Vec3d> middles = middlesOfViews(problem);
    for (int view = 0; view < problem.viewCount(); view++)
    {
        const double* const pose = problem.blocks()[problem.poseBlock(view)].values.data();
        views_.push_back(View{ Vec3d(pose), Vec3d(pose + 3), middles[view], Matx33d::zeros(), Vec3d() });
    }
}

void ViewMotion::turn(const std::vector<Vec3d>& turns)
{
    for (size_t i = 0; i < views_.size(); i++)
    {
        View& view = views_[i];
        const Rotation rotation(view.rvec.val);
        const Matx33d after = rotationMatrix(view.rvec + turns[i]);
        view.bend = (after - derivativeAlong(rotation, turns[i])).t()*rotation.R - Matx33d::eye();
    }
    for (const ViewEdge& edge : tree_)
    {
        const View& from = views_[edge.from];
        View& to = views_[edge.to];
        to.way = from.way + 0.5*(from.bend + to.bend)*(to.middle - from.middle);
    }
}

Vector6 ViewMotion::poseAfter(int view, const Vector6& step) const
{
    const View& from = views_[view];
    const Rotation rotation(from.rvec.val);
    const Vec3d turn(step.data()), shift(step.data() + 3), rvec = from.rvec + turn;
    const Vec3d way = from.way - rotation.R.t()*(shift + rotation.derivativeOf(from.middle)*turn);
    const Vec3d tvec = rotation.R*from.middle + from.tvec - rotationMatrix(rvec)*(from.middle + way);
    Vector6 pose;
    pose << rvec[0], rvec[1], rvec[2], tvec[0], tvec[1], tvec[2];
    return pose;
}

Vector6 ViewMotion::stepTo(int view, const Vector6& pose) const
{
    const View& from = views_[view];
    const Rotation rotation(from.rvec.val);
    const Vec3d rvec(pose.data()), tvec(pose.data() + 3), turn = rvec - from.rvec;
    const Vec3d way = rotationMatrix(rvec).t()*(rotation.R*from.middle + from.tvec - tvec) - from.middle - from.way;
    const Vec3d shift = -(rotation.R*way) - rotation.derivativeOf(from.middle)*turn;
    Vector6 step;
    step << turn[0], turn[1], turn[2], shift[0], shift[1], shift[2];
    return step;
}

void ViewMotion::bendPoints(const Problem& problem, int cluster, Eigen::Ref<Eigen::VectorXd> points) const
{
    std::vector<bool> isBent(points.size()/3, false);
    for (const Observation& o : problem.observationsOf(cluster))
    {
        const Image& image = problem.images()[o.image];
        const int place = problem.scene().placeInCluster(image.points.index[o.row]);
        if (isBent[place] || !(image.rootWeights[o.row] > 0))
            continue;
        const View& view = views_[image.view];
        const Vec3d change = view.way + view.bend*(Vec3d(&points[3*place]) - view.middle);
        points.segment<3>(3*place) += Eigen::Map<const Eigen::Vector3d>(change.val);
        isBent[place] = true;
    }
}

}} // namespace
