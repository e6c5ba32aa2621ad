// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What Ceres is given: one cost, the poses of targets or the points of a scene being at their best.
#include "adjust/inner.hpp"
#include "adjust/reduced_cost.hpp"
#include "bundle_scenes.hpp"
#include "problem_scenes.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

//! The cost by values of its own, one block after the other.
class Cost
{
public:
    explicit Cost(Problem& problem) : cost(problem)
    {
        for (int block : cost.variableBlocks())
            values.push_back(problem.blocks()[block].values);
        std::vector<double*> state;
        for (VectorXd& block : values)
            state.push_back(block.data());
        cost.setState(state);
        REQUIRE(cost.linearize());
        for (int i = 0; i < cost.groupCount(); i++)
            groups.emplace_back(new ReducedCost::Group(cost, i));
    }
    double squaredError()
    {
        cost.PrepareForEvaluation(false, true);
        double sum = 0;
        for (const auto& group : groups)
        {
            VectorXd residuals(group->num_residuals());
            REQUIRE(group->Evaluate(nullptr, residuals.data(), nullptr));
            sum += residuals.squaredNorm();
        }
        return sum;
    }
    //! By each block.
    std::vector<VectorXd> gradient()
    {
        cost.PrepareForEvaluation(true, true);
        std::vector<VectorXd> gradients;
        for (const VectorXd& block : values)
            gradients.push_back(VectorXd::Zero(block.size()));
        for (const auto& group : groups)
        {
            VectorXd residuals(group->num_residuals());
            std::vector<RowMajorMatrix> jacobians;
            std::vector<double*> pointers;
            for (int block : group->blocks())
                jacobians.push_back(RowMajorMatrix(residuals.size(), values[block].size()));
            for (RowMajorMatrix& J : jacobians)
                pointers.push_back(J.data());
            REQUIRE(group->Evaluate(nullptr, residuals.data(), pointers.data()));
            for (size_t i = 0; i < jacobians.size(); i++)
                gradients[group->blocks()[i]] += 2*jacobians[i].transpose()*residuals;
        }
        return gradients;
    }

    ReducedCost cost;
    std::vector<std::unique_ptr<ReducedCost::Group> > groups;
    std::vector<VectorXd> values;
};

//! Of the squared error along every free coordinate, against central differences; relative to its largest part in the block.
double largestGradientError(Problem& problem)
{
    Cost cost(problem);
    const FreeSpace space(problem);
    const std::vector<VectorXd> gradient = cost.gradient();
    double largest = 0;
    for (size_t k = 0; k < cost.values.size(); k++)
    {
        const MatrixXd& basis = space.bases[cost.cost.variableBlocks()[k]];
        const VectorXd exact = basis.transpose()*gradient[k];
        for (int i = 0; i < basis.cols(); i++)
        {
            const VectorXd kept = cost.values[k];
            const double step = 1e-5*std::max(0.1, std::abs(kept.dot(basis.col(i))));
            cost.values[k] = kept + step*basis.col(i);
            const double above = cost.squaredError();
            cost.values[k] = kept - step*basis.col(i);
            const double below = cost.squaredError();
            cost.values[k] = kept;
            largest = std::max(largest, std::abs((above - below)/(2*step) - exact[i])/exact.norm());
        }
    }
    return largest;
}

} // namespace

TEST_CASE("The gradient is that of the squared error with the best poses", "[adjust]")
{
    CAPTURE(seed());
    for (bool shared : { false, true })
    {
        Random random(31);
        const RigTruth truth = makeRig(2, shared ? std::vector<int>{ 0, 0 } : std::vector<int>{ 0, 1 }, 1.333);
        const RigScene scene = makeRigScene(truth, 4, random, 0.5);
        const std::unique_ptr<Problem> problem = problemAt(truth, scene, true, GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE |
                                                           GLASS_FREE_INTRINSICS | GLASS_FREE_INDEX);
        CAPTURE(shared);
        CHECK(largestGradientError(*problem) < 1e-5);
    }
}

TEST_CASE("The gradient holds behind a pane with a wedge that two cameras share, none of them the first", "[adjust][wedge]")
{
    CAPTURE(seed());
    Random random(32);
    RigTruth truth = makeRig(3, { 0, 1, 1 }, 1.333);
    for (int c = 0; c < 2; c++)
    {
        GlassWindow window = truth.cameras[c]->window();
        window.wedge = { Vec2d(0.01 - 0.03*c, 0.02) };
        truth.cameras[c]->setWindow(window);
    }
    const Matx33d R = truth.Rs[2]*truth.Rs[1].t();
    truth.cameras[2]->setWindow(windowInFrame(truth.cameras[1]->window(), R, truth.Ts[2] - R*truth.Ts[1]));
    const RigScene scene = makeRigScene(truth, 4, random, 0.5);
    const std::unique_ptr<Problem> problem = problemAt(truth, scene, true, GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE |
                                                       GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_WEDGE);
    CHECK(largestGradientError(*problem) < 1e-5);
}

TEST_CASE("The gradient is that of the squared error with the best points", "[adjust]")
{
    CAPTURE(seed());
    for (bool moves : { false, true })
    {
        CAPTURE(moves);
        Random random(9);
        const RigTruth truth = makeRig(2, { 0, 1 }, 1.333);
        BundleScene scene = moves ? makeMovingScene(truth, 4, 20, random, 0.5) : makeWandScene(truth, 15, random, 0.5, 0.05);
        keepWhatAllSee(scene);
        const std::unique_ptr<Problem> problem = bundleAt(truth, scene, 0.5, GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS);
        CHECK(largestGradientError(*problem) < 1e-5);
    }
}

TEST_CASE("What a step of the outer parameters does to the inner ones is what the linearisation says", "[adjust]")
{
    CAPTURE(seed());
    Random random(33);
    const RigTruth truth = makeRig(1, { 0 }, 1.333);
    const RigScene scene = makeRigScene(truth, 3, random, 0.2);
    const std::unique_ptr<Problem> problem = problemAt(truth, scene, false, GLASS_FREE_DISTANCE);
    double squaredError;
    REQUIRE(optimizeInner(*problem, squaredError));
    const FreeSpace space(*problem);
    const Information information = informationOf(*problem);
    const VectorXd before = innerValues(*problem);
    ParameterBlock& media = problem->blocks()[2];
    REQUIRE(media.kind == ParameterBlock::MEDIA);
    const double step = 1e-3;
    media.values[0] += step;
    problem->updateCameras();
    REQUIRE(optimizeInner(*problem, squaredError));
    const VectorXd change = (innerValues(*problem) - before)/step;
    for (int view = 0; view < 3; view++)
    {
        const VectorXd predicted = information.inner[view].byOuter.col(space.first[2]);
        CHECK((change.segment<6>(6*view) - predicted).norm() < 1e-3*predicted.norm());
    }
}
