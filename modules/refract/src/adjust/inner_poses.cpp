// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/inner.hpp"
#include "math/dense.hpp"
#include <atomic>

namespace cv { namespace refract {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

//! A view's residuals and their derivatives by its pose, with its prior.
struct PoseRows
{
    //! False where a point has no image.
    bool set(const Problem& problem, int view)
    {
        const MatrixXd prior = problem.priorRows(problem.poseBlock(view));
        int count = (int)prior.rows();
        for (int i : problem.imagesOf(view))
            count += 2*(int)problem.images()[i].points.pixel.size();
        residuals.resize(count);
        byPose.resize(count, 6);
        int row = 0;
        for (int i : problem.imagesOf(view))
        {
            const Image& image = problem.images()[i];
            if (!problem.evaluate(image, image.rootWeights, Problem::BY_POSE, derivatives_))
                return false;
            const int own = (int)derivatives_.residuals.size();
            residuals.segment(row, own) = derivatives_.residuals;
            byPose.middleRows(row, own) = derivatives_.byPose;
            row += own;
        }
        byPose.bottomRows(prior.rows()) = prior;
        residuals.tail(prior.rows()) = problem.priorResidual(problem.poseBlock(view));
        squares = residuals.squaredNorm();
        return true;
    }

    //! @param gain of squares that the step promises
    Vector6 step(double damping, double& gain) const
    {
        const Vector6 scale = byPose.colwise().norm().cwiseMax(DBL_MIN).cwiseInverse();
        const int count = (int)residuals.size();
        MatrixXd rows(count + 6, 7);
        rows.topRows(count) << byPose*scale.asDiagonal(), -residuals;
        rows.bottomRows<6>() << std::sqrt(damping)*Matrix6::Identity(), Vector6::Zero();
        const MatrixXd R = QR(rows).R();
        const Vector6 scaled = PivotedQR(R.leftCols<6>(), 1e-12).solve(VectorXd(R.col(6)));
        gain = R.col(6).squaredNorm() - (R.col(6) - R.leftCols<6>()*scaled).squaredNorm();
        return scale.cwiseProduct(scaled);
    }

    VectorXd residuals;
    RowMajorMatrix byPose;
    double squares;

private:
    Problem::Derivatives derivatives_;
};

bool optimizePose(Problem& problem, int view, double& squares)
{
    const int ROUNDS = 50;
    PoseRows here, there;
    if (!here.set(problem, view))
        return false;
    StepControl control;
    for (int round = 0; round < ROUNDS && problem.isAdjusted(view) && !control.isHopeless(); round++)
    {
        double gain;
        const Vector6 step = here.step(control.damping(), gain);
        if (StepControl::isNegligible(gain, here.squares, (double)here.residuals.size()))
            break;
        Eigen::Map<VectorXd>& pose = problem.blocks()[problem.poseBlock(view)].values;
        const Vector6 before = pose;
        pose += step;
        if (there.set(problem, view) && there.squares < here.squares)
        {
            std::swap(here, there);
            control.accept();
        }
        else
        {
            pose = before;
            control.reject();
        }
    }
    squares = here.squares;
    return true;
}

} // namespace

bool optimizePoses(Problem& problem, double& squaredError)
{
    std::vector<double> squares(problem.viewCount(), 0.);
    std::atomic<bool> isPossible(true);
    parallel_for_(Range(0, problem.viewCount()), [&](const Range& range)
    {
        for (int view = range.start; view < range.end && isPossible; view++)
            if (!optimizePose(problem, view, squares[view]))
                isPossible = false;
    });
    squaredError = problem.squaredOuterPriors();
    for (double ofView : squares)
        squaredError += ofView;
    return isPossible;
}

bool optimizeInner(Problem& problem, double& squaredError)
{
    const bool isPossible = problem.hasScene() ? optimizePoints(problem, squaredError) : optimizePoses(problem, squaredError);
    return isPossible && std::isfinite(squaredError);
}

VectorXd innerValues(const Problem& problem)
{
    std::vector<double> values;
    if (problem.hasScene())
        for (const Cluster& cluster : problem.scene().clusters())
            values.insert(values.end(), cluster.values.data(), cluster.values.data() + cluster.size());
    else
        for (int view = 0; view < problem.viewCount(); view++)
        {
            const double* const pose = problem.blocks()[problem.poseBlock(view)].values.data();
            values.insert(values.end(), pose, pose + 6);
        }
    return Eigen::Map<const VectorXd>(values.data(), (int)values.size());
}

void setInnerValues(Problem& problem, const VectorXd& values)
{
    const double* next = values.data();
    if (problem.hasScene())
    {
        for (Cluster& cluster : problem.scene().clusters())
        {
            std::copy(next, next + cluster.size(), cluster.values.data());
            next += cluster.size();
        }
        problem.placePoints(problem.scene().points());
    }
    else
        for (int view = 0; view < problem.viewCount(); view++, next += 6)
            std::copy(next, next + 6, problem.blocks()[problem.poseBlock(view)].values.data());
}

}} // namespace
