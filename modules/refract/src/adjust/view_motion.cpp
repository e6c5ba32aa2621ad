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

//! Of each view: with which others it shares points, and how many. Of a point's views only those that follow each other count.
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

ViewGraph::ViewGraph(const Problem& problem) : isRoot(problem.viewCount(), true)
{
    growTree(problem);
    factor();
}

//! It grows by the view that shares most points with one that it has (Prim).
void ViewGraph::growTree(const Problem& problem)
{
    const std::vector<std::map<int, int> > shared = sharedPoints(problem);
    std::vector<bool> isReached(shared.size(), false);
    typedef std::pair<int, std::pair<int, int> > Candidate;         // how many points; -from, -to: the first of equals
    std::priority_queue<Candidate> next;
    const auto reach = [&](int view)
    {
        isReached[view] = true;
        for (const std::pair<const int, int>& other : shared[view])
        {
            if (!isReached[other.first])
                next.push({ other.second, { -view, -other.first } });
            if (view < other.first)
                edges.push_back({ view, other.first, other.second });
        }
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
            const ViewEdge edge = { -next.top().second.first, -next.top().second.second, next.top().first };
            next.pop();
            if (isReached[edge.to])
                continue;
            tree.push_back(edge);
            isRoot[edge.to] = false;
            reach(edge.to);
        }
    }
}

void ViewGraph::factor()
{
    BlockGraph graph(isRoot.size());
    for (const ViewEdge& edge : edges)
    {
        graph[edge.from].push_back(edge.to);
        graph[edge.to].push_back(edge.from);
    }
    laplacian_ = BlockCholesky(graph);
    const auto column = [&](int view) -> BlockCholesky::Column& { return laplacian_.column(laplacian_.at(view)); };
    for (size_t view = 0; view < isRoot.size(); view++)
        if (isRoot[view])
            column((int)view).diagonal.setIdentity();       // and nothing beside it: its correction is 0
    for (const ViewEdge& edge : edges)
    {
        for (int view : { edge.from, edge.to })
            if (!isRoot[view])
                column(view).diagonal.diagonal().array() += edge.shared;
        if (isRoot[edge.from] || isRoot[edge.to])
            continue;
        const bool isInOrder = laplacian_.at(edge.from) < laplacian_.at(edge.to);
        BlockCholesky::Column& first = column(isInOrder ? edge.from : edge.to);
        const int row = laplacian_.at(isInOrder ? edge.to : edge.from);
        first.blocks[std::lower_bound(first.rows.begin(), first.rows.end(), row) - first.rows.begin()].diagonal().array() -= edge.shared;
    }
    laplacian_.factor(laplacian_.diagonal().cwiseSqrt(), DBL_EPSILON);
}

std::vector<Vector6> ViewGraph::corrections(const std::vector<Vector6>& off) const
{
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6*isRoot.size(), 1);
    for (size_t i = 0; i < edges.size(); i++)
    {
        const ViewEdge& edge = edges[i];
        if (!isRoot[edge.from])
            all.block<6, 1>(6*edge.from, 0) += edge.shared*off[i];
        if (!isRoot[edge.to])
            all.block<6, 1>(6*edge.to, 0) -= edge.shared*off[i];
    }
    laplacian_.solveL(all);
    laplacian_.solveTranspose(all);
    std::vector<Vector6> corrections;
    for (size_t view = 0; view < isRoot.size(); view++)
        corrections.push_back(all.block<6, 1>(6*view, 0));
    return corrections;
}

ViewMotion::ViewMotion(const Problem& problem, const ViewGraph& graph) : graph_(graph), sceneScale_(problem.sceneScale())
{
    const std::vector<Vec3d> middles = middlesOfViews(problem);
    for (int view = 0; view < problem.viewCount(); view++)
    {
        const double* const pose = problem.blocks()[problem.poseBlock(view)].values.data();
        const Rotation rotation(pose);
        const Vec3d middle = sceneScale_*middles[view];
        views_.push_back(View{ rotation, Vec3d(pose), Vec3d(pose + 3), rotation.rightJacobian(), middle, Vec3d(), Vec3d(),
                               Matx33d::eye(), middle });
    }
}

//! Of the middles of two views, to first order, in a frame that has turned as they have.
static Vec3d turnedBetween(const Vec3d& between, const Vec3d& fromTurn, const Vec3d& toTurn)
{
    return between - 0.5*(fromTurn + toTurn).cross(between);
}

//! As the tree has turned them, and then the middles with the frames between them, each edge is off by what its way round makes.
void ViewMotion::closeEdges()
{
    std::vector<Vector6> off;
    for (const ViewEdge& edge : graph_.edges)
    {
        const View &from = views_[edge.from], &to = views_[edge.to];
        off.push_back(joined(rotationVector(rotationMatrix(from.turn - to.turn)*from.turned.t()*to.turned), Vec3d()));
    }
    std::vector<Vector6> corrections = graph_.corrections(off);
    for (size_t i = 0; i < views_.size(); i++)
        views_[i].turned = views_[i].turned*rotationMatrix(Vec3d(corrections[i].data()));
    for (size_t i = 0; i < off.size(); i++)
    {
        const View &from = views_[graph_.edges[i].from], &to = views_[graph_.edges[i].to];
        const Vec3d between = turnedBetween(to.middle - from.middle, from.turn, to.turn) + to.way - from.way;
        off[i] = joined(Vec3d(), to.moved - from.moved - 0.5*(from.turned + to.turned)*between);
    }
    corrections = graph_.corrections(off);
    for (size_t i = 0; i < views_.size(); i++)
        views_[i].moved += Vec3d(corrections[i].data() + 3);
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
    for (const ViewEdge& edge : graph_.tree)
    {
        const View& from = views_[edge.from];
        View& to = views_[edge.to];
        const Vec3d between = turnedBetween(to.middle - from.middle, from.turn, to.turn) + to.way - from.way;
        to.turned = from.turned*rotationMatrix(to.turn - from.turn);
        to.moved = from.moved + 0.5*(from.turned + to.turned)*between;
    }
    closeEdges();
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

//! What edges say of turns and ways is linear in these: along the tree, then as all edges together have it.
void ViewMotion::findTurnsAndWays()
{
    const auto turnBetween = [&](const ViewEdge& edge)
    { return rotationVector(views_[edge.from].turned.t()*views_[edge.to].turned); };
    const auto wayBetween = [&](const ViewEdge& edge)
    {
        const View &from = views_[edge.from], &to = views_[edge.to];
        return Vec3d((0.5*(from.turned + to.turned)).solve(to.moved - from.moved, DECOMP_LU))
               - turnedBetween(to.middle - from.middle, from.turn, to.turn);
    };
    std::vector<Vector6> off;
    for (const ViewEdge& edge : graph_.tree)
        views_[edge.to].turn = views_[edge.from].turn + turnBetween(edge);
    for (const ViewEdge& edge : graph_.edges)
        off.push_back(joined(views_[edge.to].turn - views_[edge.from].turn - turnBetween(edge), Vec3d()));
    std::vector<Vector6> corrections = graph_.corrections(off);
    for (size_t i = 0; i < views_.size(); i++)
        views_[i].turn += Vec3d(corrections[i].data());
    for (const ViewEdge& edge : graph_.tree)
        views_[edge.to].way = views_[edge.from].way + wayBetween(edge);
    for (size_t i = 0; i < off.size(); i++)
    {
        const ViewEdge& edge = graph_.edges[i];
        off[i] = joined(Vec3d(), views_[edge.to].way - views_[edge.from].way - wayBetween(edge));
    }
    corrections = graph_.corrections(off);
    for (size_t i = 0; i < views_.size(); i++)
        views_[i].way += Vec3d(corrections[i].data() + 3);
}

std::vector<Vector6> ViewMotion::stepsTo(const std::vector<Vector6>& poses)
{
    for (size_t i = 0; i < views_.size(); i++)
    {
        View& view = views_[i];
        const Matx33d R = rotationMatrix(Vec3d(poses[i].data()));
        view.turned = R.t()*view.rotation.R;
        view.moved = R.t()*(view.rotation.R*view.middle + view.tvec - Vec3d(poses[i].data() + 3));
        view.turn = rotationVector(view.turned);        // of roots: of the others it follows
        view.way = view.moved - view.middle;
    }
    findTurnsAndWays();
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
