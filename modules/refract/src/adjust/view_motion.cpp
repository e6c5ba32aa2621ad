// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/view_motion.hpp"
#include "math/robust_scale.hpp"
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

//! Of each view: with which others it shares points, and how many. Of a point's views only those that follow each other count: a tree asks
//! no more.
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

//! v of the matrix of v x.
Vec3d fromCross(const Matx33d& m)
{
    return 0.5*Vec3d(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
}

//! Of those of one rotation, the one that is nearest.
Vec3d nearestRotationVector(const Matx33d& R, const Vec3d& near)
{
    const Vec3d rvec = rotationVector(R);
    const double angle = norm(rvec);
    const Vec3d axis = angle > 0 ? rvec/angle : near/std::max(norm(near), DBL_MIN);
    return axis*(angle + 2*CV_PI*std::round((axis.dot(near) - angle)/(2*CV_PI)));
}

Vector6 joined(const Vec3d& rotation, const Vec3d& translation)
{
    Vector6 both;
    both << rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2];
    return both;
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

ViewMotion::ViewMotion(const Problem& problem, const std::vector<ViewEdge>& tree)
    : tree_(tree), isRoot_(problem.viewCount(), true), sceneScale_(problem.sceneScale())
{
    const std::vector<Vec3d> middles = middlesOfViews(problem);
    for (int view = 0; view < problem.viewCount(); view++)
    {
        const double* const pose = problem.blocks()[problem.poseBlock(view)].values.data();
        const Rotation rotation(pose);
        Matx33d turnByRvec;
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                turnByRvec(i, k) = fromCross(rotation.R.t()*rotation.dR[k])[i];
        const Vec3d middle = sceneScale_*middles[view];
        views_.push_back(View{ rotation, Vec3d(pose), Vec3d(pose + 3), turnByRvec, middle, Vec3d(), Vec3d(), Matx33d::eye(), middle });
    }
    for (const ViewEdge& edge : tree_)
        isRoot_[edge.to] = false;
}

std::vector<Vector6> ViewMotion::posesAfter(const std::vector<Vector6>& steps)
{
    for (size_t i = 0; i < views_.size(); i++)
    {
        View& view = views_[i];
        const Vec3d change(steps[i].data()), shift(steps[i].data() + 3);
        view.turn = -(view.turnByRvec*change);      // what is seen turns the other way
        view.way = -(view.rotation.R.t()*(shift + view.rotation.derivativeOf(view.middle)*change));
        view.turned = rotationMatrix(view.turn);
        view.moved = view.middle + view.way;
    }
    for (const ViewEdge& edge : tree_)
    {
        const View& from = views_[edge.from];
        View& to = views_[edge.to];
        const Vec3d between = to.middle - from.middle;
        to.turned = from.turned*rotationMatrix(to.turn - from.turn);
        to.moved = from.moved + 0.5*(from.turned + to.turned)*(between + to.way - from.way - 0.5*(from.turn + to.turn).cross(between));
    }
    std::vector<Vector6> poses;
    for (size_t i = 0; i < views_.size(); i++)
    {
        const View& view = views_[i];
        const Matx33d R = view.rotation.R*view.turned.t();
        poses.push_back(joined(nearestRotationVector(R, view.rvec + Vec3d(steps[i].data())),
                               view.rotation.R*view.middle + view.tvec - R*view.moved));
    }
    return poses;
}

std::vector<Vector6> ViewMotion::stepsTo(const std::vector<Vector6>& poses)
{
    for (size_t i = 0; i < views_.size(); i++)
    {
        View& view = views_[i];
        const Matx33d R = rotationMatrix(Vec3d(poses[i].data()));
        view.turned = R.t()*view.rotation.R;
        view.moved = R.t()*(view.rotation.R*view.middle + view.tvec - Vec3d(poses[i].data() + 3));
        if (!isRoot_[i])
            continue;
        view.turn = rotationVector(view.turned);
        view.way = view.moved - view.middle;
    }
    for (const ViewEdge& edge : tree_)
    {
        const View& from = views_[edge.from];
        View& to = views_[edge.to];
        const Vec3d between = to.middle - from.middle;
        to.turn = from.turn + rotationVector(from.turned.t()*to.turned);
        to.way = from.way + Vec3d((0.5*(from.turned + to.turned)).solve(to.moved - from.moved, DECOMP_LU)) - between
                 + 0.5*(from.turn + to.turn).cross(between);
    }
    std::vector<Vector6> steps;
    for (const View& view : views_)
    {
        const Vec3d change = view.turnByRvec.solve(-view.turn, DECOMP_SVD);
        steps.push_back(joined(change, -(view.rotation.R*view.way) - view.rotation.derivativeOf(view.middle)*change));
    }
    return steps;
}

void ViewMotion::movePoints(const Problem& problem, int cluster, const Eigen::VectorXd& change, Eigen::Ref<Eigen::VectorXd> points) const
{
    const int count = (int)points.size()/3;
    std::vector<const View*> seenBy(count, nullptr);        // the last of those that see it
    for (const Observation& o : problem.observationsOf(cluster))
    {
        const Image& image = problem.images()[o.image];
        if (image.rootWeights[o.row] > 0)
            seenBy[problem.scene().placeInCluster(image.points.index[o.row])] = &views_[image.view];
    }
    for (int i = 0; i < count; i++)
    {
        Vec3d point(&points[3*i]);
        const Vec3d pointChange(&change[3*i]);
        if (const View* const view = seenBy[i])
        {
            const Vec3d arm = sceneScale_*point - view->middle;
            const Vec3d own = sceneScale_*pointChange - view->way - view->turn.cross(arm);
            point = (view->moved + view->turned*(arm + own))/sceneScale_;
        }
        else
            point += pointChange;
        points.segment<3>(3*i) = Eigen::Map<const Eigen::Vector3d>(point.val);
    }
}

}} // namespace
