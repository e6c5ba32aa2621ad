// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// How the views of a scene move by steps that are not small.
#include "adjust/view_motion.hpp"
#include "bundle_scenes.hpp"
#include "problem_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Views in a row, each by itself in no position that is special, with points before them.
std::unique_ptr<Problem> makeRow(Random& random, double turned)
{
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    BundleScene scene;
    for (int i = 0; i < 120; i++)
        scene.points.push_back({ 10.*i + random.uniform(0, 9), random.uniform(-60, 60), random.uniform(-30, 30) });
    for (int view = 0; view < 25; view++)
    {
        const Vec3d rvec = random.vector(turned);
        Matx33d R;
        Rodrigues(rvec, R);
        scene.rvecs.push_back(rvec);
        scene.tvecs.push_back(-(R*(Vec3d(45.*view, 0, -600) + random.vector(10))));
    }
    look(truth, random, 0.1, 0, scene);
    return bundleAt(truth, scene, 0.1, 0);
}

Vector6 stepOf(const Vec3d& turn, const Vec3d& shift)
{
    Vector6 step;
    step << turn[0], turn[1], turn[2], shift[0], shift[1], shift[2];
    return step;
}

Vector6 poseOfView(const Problem& problem, int view)
{
    const Pose pose = problem.pose(view);
    return stepOf(pose.rvec, pose.tvec);
}

Vec3d seenBy(const Vector6& pose, const Vec3d& point)
{
    Matx33d R;
    Rodrigues(Vec3d(pose.data()), R);
    return R*point + Vec3d(pose.data() + 3);
}

} // namespace

TEST_CASE("A step of views is to first order that of rvec and t, and is found again", "[view-motion]")
{
    Random random(91);
    CAPTURE(seed());
    const std::unique_ptr<Problem> problem = makeRow(random, 0.1);
    const std::vector<ViewEdge> tree = treeOfViews(*problem);
    CHECK((int)tree.size() == problem->viewCount() - 1);
    ViewMotion motion(*problem, tree);
    for (double size : { 1e-6, 0.2 })
    {
        std::vector<Vec3d> turns;
        std::vector<Vector6> steps;
        for (int view = 0; view < problem->viewCount(); view++)
        {
            turns.push_back(size*random.vector(1));
            steps.push_back(stepOf(turns.back(), size*random.vector(100)));
        }
        motion.turn(turns);
        for (int view = 0; view < problem->viewCount(); view++)
        {
            CAPTURE(size, view);
            const Vector6 pose = motion.poseAfter(view, steps[view]);
            if (size < 1e-3)
                CHECK((pose - poseOfView(*problem, view) - steps[view]).norm() < 1e-3*steps[view].norm());
            CHECK((motion.stepTo(view, pose) - steps[view]).norm() < 1e-9);
        }
    }
}

TEST_CASE("Views and points that turn together keep their places to each other", "[view-motion]")
{
    Random random(92);
    CAPTURE(seed());
    const std::unique_ptr<Problem> problem = makeRow(random, 0);        // equal rvecs: so are their turns
    ViewMotion motion(*problem, treeOfViews(*problem));
    const Vec3d omega(0.05, -0.3, 0.2), about(3000, -200, 100);         // rad, in the scene
    motion.turn(std::vector<Vec3d>(problem->viewCount(), -omega));
    std::vector<Vector6> poses;
    for (int view = 0; view < problem->viewCount(); view++)
        poses.push_back(motion.poseAfter(view, stepOf(-omega, omega.cross(about))));
    for (int cluster = 0; cluster < (int)problem->scene().clusters().size(); cluster++)
    {
        if (problem->observationsOf(cluster).empty())
            continue;
        const Eigen::VectorXd before = problem->scene().clusters()[cluster].values;
        const Vec3d point(before.data());
        Eigen::VectorXd after = before;
        motion.bendPoints(*problem, cluster, after);
        const Vec3d moved = Vec3d(after.data()) + omega.cross(point - about);
        for (int view = 0; view < problem->viewCount(); view++)
            CHECK(norm(seenBy(poses[view], moved) - seenBy(poseOfView(*problem, view), point)) < 1e-8);
    }
}
