// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The joint problem without a target on Ceres' trust region. Ceres eliminates the clusters of points; all images are
linearised side by side before it asks for their points' residuals one by one. Bounds and the test for a minimum are
rig_solve.cpp's. */

#include "calibrate/bundle_problem.hpp"
#include "calibrate/bundle_information.hpp"
#include "calibrate/trust_region.hpp"
#include <ceres/problem.h>

namespace cv { namespace refract {

namespace {

typedef Eigen::Map<RowMajorMatrix> RowsMap;

//! One sighting. Blocks: its cluster, the pose, and those of the rig.
class PixelResidual : public ceres::CostFunction
{
public:
    PixelResidual(const BundleProblem& bundle, const Cluster& cluster, const Sighting& sighting)
        : state_(bundle.state(sighting.image)), sighting_(sighting)
    {
        set_num_residuals(2);
        *mutable_parameter_block_sizes() = { cluster.size(), 6 };
        for (int i : bundle.rig().blocksOf(bundle.rig().images()[sighting.image]))
            mutable_parameter_block_sizes()->push_back((int)bundle.rig().blocks()[i].values.size());
    }

    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override
    {
        if (!state_.isPossible)
            return false;
        const RigProblem::Derivatives& derivatives = state_.derivatives;
        const int row = 2*sighting_.row;
        residuals[0] = derivatives.residuals[row];
        residuals[1] = derivatives.residuals[row + 1];
        if (!jacobians)
            return true;
        const std::vector<int32_t>& sizes = parameter_block_sizes();
        if (jacobians[0])
        {
            RowsMap byCluster(jacobians[0], 2, sizes[0]);
            byCluster.setZero();
            byCluster.middleCols<3>(3*sighting_.at) = state_.byPoint.middleRows<2>(row);
        }
        if (jacobians[1])
            RowsMap(jacobians[1], 2, 6) = derivatives.byPose.middleRows<2>(row);
        for (size_t i = 2; i < sizes.size(); i++)
            if (jacobians[i])
                RowsMap(jacobians[i], 2, sizes[i]) = derivatives.byBlock[i - 2].middleRows<2>(row);
        return true;
    }

private:
    const BundleProblem::ImageState& state_;
    const Sighting sighting_;
};

class LengthResidual : public ceres::CostFunction
{
public:
    LengthResidual(const Cluster& cluster, const KnownLength& length, double pixelSigma)
        : cluster_(cluster), length_(length), pixelSigma_(pixelSigma)
    {
        set_num_residuals(1);
        mutable_parameter_block_sizes()->push_back(cluster.size());
    }

    //! The cluster's values are those that Ceres asks for, as for the images.
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override
    {
        Eigen::RowVectorXd byValues;
        residuals[0] = pixelSigma_*cluster_.residual(length_, byValues);
        if (jacobians && jacobians[0])
            Eigen::Map<Eigen::RowVectorXd>(jacobians[0], cluster_.size()) = pixelSigma_*byValues;
        return true;
    }

private:
    const Cluster& cluster_;
    const KnownLength length_;
    const double pixelSigma_;
};

} // namespace

//! The step that is left is far below the uncertainty of what it would move.
bool BundleProblem::isAtMinimum()
{
    const double NEGLIGIBLE = 1e-3;     // standard deviations
    const double LEAST_SIGMA = 1e-3;    // px: perfect data end in rounding errors, those of normal equations
    const double variance = freedom() > 0 ? squaredError()/freedom() : 0;
    return ReducedBundle(*this, false).stepLeft() < NEGLIGIBLE*std::max(std::sqrt(variance), LEAST_SIGMA);
}

bool BundleProblem::solve(const TermCriteria& criteria)
{
    return takeTurns(criteria, [this](TrustRegion& region) {
        solveInside(region);
        evaluate(true);
        return region.outcome != ceres::FAILURE && !(rig_.isOnBound() && rig_.holdAtBounds())
               && region.outcome == ceres::CONVERGENCE && isAtMinimum();
    });
}

void BundleProblem::solveInside(TrustRegion& region)
{
    ceres::Problem::Options problemOptions;
    problemOptions.evaluation_callback = this;
    ceres::Problem problem(problemOptions);
    const std::shared_ptr<ceres::ParameterBlockOrdering> ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    int group = 1;      // one for each block: inside a group, Ceres orders by address, which differs from run to run
    for (RigBlock& block : rig_.blocks())
    {
        addToProblem(problem, block);
        ordering->AddElementToGroup(block.values.data(), group++);
    }
    for (int view = 0; view < rig_.viewCount(); view++)
    {
        rig_.addPose(problem, view);
        ordering->AddElementToGroup(rig_.poseValues(view), group++);
    }
    for (Cluster& cluster : clusters_)
    {
        double* const values = cluster.values.data();
        for (const Sighting& sighting : cluster.sightings)
        {
            const RigImage& image = rig_.images()[sighting.image];
            std::vector<double*> blocks = { values, rig_.poseValues(image.view) };
            for (int i : rig_.blocksOf(image))
                blocks.push_back(rig_.blocks()[i].values.data());
            problem.AddResidualBlock(new PixelResidual(*this, cluster, sighting), nullptr, blocks);
        }
        for (const KnownLength& length : cluster.lengths)
            problem.AddResidualBlock(new LengthResidual(cluster, length, rig_.pixelSigma()), nullptr, values);
        ordering->AddElementToGroup(values, 0);     // by address in it: as they are kept, one after the other
    }

    region.solve(problem, ordering);
}

}} // namespace
