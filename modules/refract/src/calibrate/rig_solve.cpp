// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint problem on Ceres' trust region.

Ceres keeps bounds by projecting each step, and creeps where a step's other coordinates rely on the one that was cut off.
So every few iterations a coordinate that lies on its bound, with the cost falling beyond it, is held there, and is let go
when the cost falls towards the inside.

A small change of the cost is no proof of a minimum: the step that is left to that of the linearised problem must be far
below what the noise does. */

#include "calibrate/information.hpp"
#include "calibrate/trust_region.hpp"
#include <ceres/manifold.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/sphere_manifold.h>

namespace cv { namespace refract {

void addToProblem(ceres::Problem& problem, RigBlock& block)
{
    double* values = block.values.data();
    const int size = (int)block.values.size();
    problem.AddParameterBlock(values, size);
    std::vector<int> fixed;
    for (int i = 0; i < size; i++)
        if (!block.isFree[i] || block.isHeld[i])
            fixed.push_back(i);
        else if (std::isfinite(block.lower[i]))
            problem.SetParameterLowerBound(values, i, block.lower[i]);
    if ((int)fixed.size() == size)
        problem.SetParameterBlockConstant(values);
    else if (block.kind == RigBlock::NORMAL)
        problem.SetManifold(values, new ceres::SphereManifold<3>());
    else if (!fixed.empty())
        problem.SetManifold(values, new ceres::SubsetManifold(size, fixed));
}

String RigProblem::startFault() const
{
    for (const RigImage& image : images_)
    {
        const Camera* camera = cameras_[image.camera].camera(image.refracted);
        if (!camera)
            this->camera(image.camera);         // throws
        const Extrinsics& toCamera = cameras_[image.camera].extrinsics;
        const Extrinsics toCamera1(poses_[image.view].data());
        for (size_t i = 0; i < image.points.object.size(); i++)
        {
            if (image.rootWeights[i] == 0)
                continue;
            const Point3d& point = image.points.object[i];
            const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(point)));
            double u, v;
            uchar status = REFRACT_OK;
            camera->project(1, &X[0], &X[1], &X[2], nullptr, &u, &v, &status);
            if (status != REFRACT_OK)
                return format("view %d of camera %d, point (%g, %g, %g): no image %s at the start (RefractiveStatus %d); "
                              "check the window's distance and thickness, the lens, the units, and given poses", image.view,
                              image.camera + 1, point.x, point.y, point.z,
                              image.refracted ? "through the window" : "without window", status);
        }
    }
    return String();
}

//! The step that is left is far below the uncertainty of what it would move.
bool RigProblem::isAtMinimum() const
{
    const double NEGLIGIBLE = 1e-3;     // standard deviations
    const double LEAST_SIGMA = 1e-6;    // px: perfect data end in rounding errors
    const double variance = freedom() > 0 ? squaredError()/freedom() : 0;
    return stepLeft(*this) < NEGLIGIBLE*std::max(std::sqrt(variance), LEAST_SIGMA);
}

bool RigProblem::solve(const TermCriteria& criteria)
{
    const String fault = startFault();
    if (!fault.empty())
        CV_Error(Error::StsBadArg, fault);
    return takeTurns(criteria, [this](TrustRegion& region) {
        solveInside(region);
        return region.outcome != ceres::FAILURE && !(isOnBound() && holdAtBounds()) && region.outcome == ceres::CONVERGENCE
               && isAtMinimum();
    });
}

bool RigProblem::isOnBound() const
{
    for (const RigBlock& block : blocks_)
        for (int i = 0; i < (int)block.values.size(); i++)
            if (block.isFree[i] && block.values[i] <= block.lower[i])
                return true;
    return false;
}

bool RigProblem::holdAtBounds()
{
    std::vector<RowMajorMatrix> gradients;
    for (const RigBlock& block : blocks_)
        gradients.push_back(RowMajorMatrix::Zero(block.values.size(), 1));
    for (const RigImage& image : images_)
    {
        const Derivatives d = derivatives(image);
        for (size_t i = 0; i < d.blocks.size(); i++)
            gradients[d.blocks[i]] += d.byBlock[i].transpose()*d.residuals;
    }
    for (size_t b = 0; b < blocks_.size(); b++)
        gradients[b] += priorByBlock((int)b).transpose()*priorOfBlock((int)b);
    bool changed = false;
    for (size_t b = 0; b < blocks_.size(); b++)
        for (int i = 0; i < (int)blocks_[b].values.size(); i++)
        {
            RigBlock& block = blocks_[b];
            const bool hold = block.isFree[i] && block.values[i] <= block.lower[i] && gradients[b](i) >= 0;
            changed = changed || hold != block.isHeld[i];
            block.isHeld[i] = hold;
        }
    return changed;
}

void RigProblem::addPose(ceres::Problem& problem, int view)
{
    double* const values = poses_[view].data();
    problem.AddParameterBlock(values, 6);
    if (!isAdjusted(view))
        problem.SetParameterBlockConstant(values);
    else if (isUncertain(view))
        problem.AddResidualBlock(new ceres::NormalPrior(priorByPose(view), Eigen::Map<const Vector6>(knownPoses_[view].data())),
                                 nullptr, values);
}

void RigProblem::solveInside(TrustRegion& region)
{
    ceres::Problem::Options problemOptions;
    problemOptions.evaluation_callback = this;
    ceres::Problem problem(problemOptions);
    const std::shared_ptr<ceres::ParameterBlockOrdering> ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    int group = 1;      // one for each block: inside a group, Ceres orders by address, which differs from run to run
    for (RigBlock& block : blocks_)
    {
        addToProblem(problem, block);
        if (block.priorRows.rows() > 0)
            problem.AddResidualBlock(new ceres::NormalPrior(pixelSigma_*block.priorRows, block.known), nullptr,
                                     block.values.data());
        ordering->AddElementToGroup(block.values.data(), group++);
    }
    for (const RigImage& image : images_)
    {
        if (image.usedCount() == 0)     // a view that is left with none of them has no pose
            continue;
        std::vector<double*> values(1, poses_[image.view].data());
        for (int i : blocksOf(image))
            values.push_back(blocks_[i].values.data());
        problem.AddResidualBlock(makeCost(image), nullptr, values);
    }
    for (int view = 0; view < viewCount(); view++)
    {
        if (!isSeen_[view])
            continue;
        ordering->AddElementToGroup(poses_[view].data(), 0);
        addPose(problem, view);
    }
    region.solve(problem, ordering);
    updateCameras();
}

}} // namespace
