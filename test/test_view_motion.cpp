// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How the views of a scene move by steps that are not small.
#include "adjust/view_motion.hpp"
#include "bundle_scenes.hpp"
#include "math/robust_scale.hpp"
#include "problem_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int VIEWS = 25;

//! Views in rows, to and fro, with points before them, each second one rolled by so much.
std::unique_ptr<Problem> makeRows(Random& random, double turned, double roll, int rows)
{
    const double BETWEEN = 100;
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    BundleScene scene;
    for (int i = 0; i < 120*rows; i++)
        scene.points.push_back({ 10.*(i % 120) + random.uniform(0, 9), random.uniform(-60, 60 + BETWEEN*(rows - 1)),
                                 random.uniform(-30, 30) });
    for (int view = 0; view < VIEWS*rows; view++)
    {
        const int row = view/VIEWS, along = row % 2 ? VIEWS - 1 - view % VIEWS : view % VIEWS;
        Matx33d R, rolled;
        Rodrigues(random.vector(turned), R);
        Rodrigues(Vec3d(0, 0, view % 2 ? roll : 0), rolled);
        R = rolled*R;
        Vec3d rvec;
        Rodrigues(R, rvec);
        scene.rvecs.push_back(rvec);
        scene.tvecs.push_back(-(R*(Vec3d(45.*along, BETWEEN*row, -600) + random.vector(10))));
    }
    look(truth, random, 0.1, 0, scene);
    return bundleAt(truth, scene, 0.1, 0);
}

Vector6 joined(const Vec3d& rvec, const Vec3d& tvec)
{
    Vector6 pose;
    pose << rvec[0], rvec[1], rvec[2], tvec[0], tvec[1], tvec[2];
    return pose;
}

std::vector<Vector6> posesOf(const Problem& problem)
{
    std::vector<Vector6> poses;
    for (int view = 0; view < problem.viewCount(); view++)
        poses.push_back(joined(problem.pose(view).rvec, problem.pose(view).tvec));
    return poses;
}

Vec3d seenBy(const Vector6& pose, const Vec3d& point)
{
    Matx33d R;
    Rodrigues(Vec3d(pose.data()), R);
    return R*point + Vec3d(pose.data() + 3);
}

//! Of a view that turns with its scene by omega about a point.
Vector6 turnedTogether(const Vector6& pose, const Vec3d& omega, const Vec3d& about)
{
    Matx33d R, Q;
    Rodrigues(Vec3d(pose.data()), R);
    Rodrigues(omega, Q);
    const Vec3d centre = about + Q*(-(R.t()*Vec3d(pose.data() + 3)) - about);
    R = R*Q.t();
    Vec3d rvec;
    Rodrigues(R, rvec);
    return joined(rvec, -(R*centre));
}

Vec3d middleOf(const Problem& problem, int view)
{
    std::vector<double> seen[3];
    for (const Image& image : problem.images())
        for (const Point3d& point : image.points.object)
            for (int k = 0; k < 3 && image.view == view; k++)
                seen[k].push_back(Vec3d(point)[k]);
    return Vec3d(median(seen[0]), median(seen[1]), median(seen[2]));
}

} // namespace

TEST_CASE("A step of views is to first order that of rvec and t, and to second order is found again", "[view-motion]")
{
    Random random(91);
    CAPTURE(seed());
    const std::unique_ptr<Problem> problem = makeRows(random, 0.1, 3, 1);
    const ViewGraph graph(*problem);
    CHECK((int)graph.tree.size() == VIEWS - 1);
    for (const ViewEdge& edge : graph.tree)
        CHECK(std::abs(edge.from - edge.to) < 4);       // those that share most
    ViewMotion motion(*problem, graph);
    const std::vector<Vector6> from = posesOf(*problem);
    for (double size : { 1e-6, 0.02 })
    {
        std::vector<Vector6> steps;
        for (int view = 0; view < VIEWS; view++)
            steps.push_back(joined(size*random.vector(1), size*random.vector(100)));
        const std::vector<Vector6> poses = motion.posesAfter(steps), again = motion.stepsTo(poses);
        for (int view = 0; view < VIEWS; view++)
        {
            CAPTURE(size, view);
            if (size < 1e-3)
                CHECK((poses[view] - from[view] - steps[view]).norm() < 1e-3*steps[view].norm());
            CHECK((again[view] - steps[view]).norm() < size*steps[view].norm());
        }
    }
}

TEST_CASE("Views and points that turn together keep their places to each other", "[view-motion]")
{
    Random random(92);
    CAPTURE(seed());
    const Vec3d omega(0.05, -0.3, 0.2), about(3000, -200, 100);         // rad, in the scene
    const double PART = 1e-5;
    const std::unique_ptr<Problem> problem = makeRows(random, 0.1, 3, 1);
    const std::vector<Vector6> from = posesOf(*problem);
    std::vector<Vector6> steps;
    for (const Vector6& pose : from)
        steps.push_back((turnedTogether(pose, PART*omega, about) - turnedTogether(pose, -PART*omega, about))/(2*PART));
    const ViewGraph graph(*problem);
    ViewMotion motion(*problem, graph);
    const std::vector<Vector6> poses = motion.posesAfter(steps);
    for (int cluster = 0; cluster < (int)problem->scene().clusters().size(); cluster++)
    {
        if (problem->observationsOf(cluster).empty())
            continue;
        Eigen::VectorXd after = problem->scene().clusters()[cluster].values;
        const Vec3d point(after.data());
        const Vec3d change = omega.cross(point - about);
        motion.movePoints(*problem, cluster, Eigen::Map<const Eigen::Vector3d>(change.val), after);
        const Vec3d moved(after.data());
        for (int view = 0; view < VIEWS; view++)
            CHECK(norm(seenBy(poses[view], moved) - seenBy(from[view], point)) < 1e-4);
    }
}

TEST_CASE("A row of views that bends and twists keeps what is between its views", "[view-motion]")
{
    Random random(93);
    CAPTURE(seed());
    const std::unique_ptr<Problem> problem = makeRows(random, 0, 0, 1);
    std::vector<Vec3d> middles, turns;          // of the scene, rad
    std::vector<Vector6> steps;
    Vec3d way;
    for (int view = 0; view < VIEWS; view++)
    {
        const double part = (double)view/VIEWS;
        middles.push_back(middleOf(*problem, view));
        turns.push_back(Vec3d(0.6*part*part, 0.5*part, 0.2*std::sin(3*part)));
        if (view > 0)
            way += 0.5*(turns[view] + turns[view - 1]).cross(middles[view] - middles[view - 1]);
        steps.push_back(joined(-turns[view], -way + turns[view].cross(middles[view])));      // rvec is 0
    }
    const ViewGraph graph(*problem);
    ViewMotion motion(*problem, graph);
    const std::vector<Vector6> from = posesOf(*problem), poses = motion.posesAfter(steps);
    std::vector<Vec3d> moved;
    std::vector<Matx33d> R(VIEWS);
    for (int view = 0; view < VIEWS; view++)
    {
        Rodrigues(Vec3d(poses[view].data()), R[view]);
        moved.push_back(R[view].t()*(seenBy(from[view], middles[view]) - Vec3d(poses[view].data() + 3)));
    }
    for (int view = 1; view < VIEWS; view++)
    {
        CAPTURE(view);
        const double before = norm(middles[view] - middles[view - 1]);
        CHECK(std::abs(norm(moved[view] - moved[view - 1]) - before) < 1e-3*before);
        Vec3d between;
        Rodrigues(R[view - 1]*R[view].t(), between);        // in the frame that has turned
        CHECK(norm(between - (turns[view] - turns[view - 1])) < 0.01*norm(between));
    }
}

//! Rotation between two views after a step, less what it says.
double angleOff(const std::vector<Vector6>& poses, const std::vector<Vec3d>& turns, int a, int b)
{
    Matx33d A, B, said;
    Rodrigues(Vec3d(poses[a].data()), A);
    Rodrigues(Vec3d(poses[b].data()), B);
    Rodrigues(turns[a] - turns[b], said);
    Vec3d off;
    Rodrigues(said*A*B.t(), off);
    return norm(off);
}

TEST_CASE("Rows of views that become a bowl keep what is between neighbours of two rows", "[view-motion]")
{
    const int ROWS = 8;
    const double RADIUS = 5000;         // mm: its far corner turns by 15 degrees
    Random random(94);
    CAPTURE(seed());
    const std::unique_ptr<Problem> problem = makeRows(random, 0, 0, ROWS);
    std::vector<Vec3d> turns;           // of the scene: z = (x^2 + y^2)/(2 RADIUS)
    std::vector<Vector6> steps;
    for (int view = 0; view < VIEWS*ROWS; view++)
    {
        const Vec3d middle = middleOf(*problem, view), way(0, 0, (middle[0]*middle[0] + middle[1]*middle[1])/(2*RADIUS));
        turns.push_back(Vec3d(middle[1], -middle[0], 0)/RADIUS);
        steps.push_back(joined(-turns[view], -way + turns[view].cross(middle)));        // rvec is 0
    }
    const ViewGraph graph(*problem);
    const std::vector<Vector6> poses = ViewMotion(*problem, graph).posesAfter(steps);
    double across = 0;                  // mean square
    for (int view = 0; view < VIEWS*(ROWS - 1); view++)
    {
        const int beside = 2*VIEWS*(view/VIEWS + 1) - 1 - view;         // rows are to and fro
        across += std::pow(angleOff(poses, turns, view, beside), 2)/(VIEWS*(ROWS - 1));
    }
    CHECK(std::sqrt(across) < 1e-3);    // a tree alone leaves 2e-3
}
