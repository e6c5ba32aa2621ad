// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/relaxed_fit.hpp"
#include "measure/rig_vector.hpp"
#include "math/dense.hpp"
#include <cmath>
#include <limits>
#include <utility>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int ITERATIONS = 25;
const double CONVERGED = 0.02;          // of chi^2, of which ten decide,
const double CONVERGED_SHARE = 1e-5;    // or of its size: what leaves that much explains nothing,
const double GROSS = 4.;                // least of all what leaves so much for each degree of freedom: it creeps, and where it ends
const double GROSS_SHARE = 1e-3;        // does not matter
const double LEAST_DAMPING = 1e-12, MOST_DAMPING = 1e3;

//! Sum of the shifts, of one state.
VectorXd shifted(const VectorXd& numbers, const std::vector<Shift>& freed, const VectorXd& by, bool glass)
{
    VectorXd result = numbers;
    for (size_t k = 0; k < freed.size(); k++)
        for (const auto& number : freed[k].numbers)
            if (glass || !freed[k].glassOnly)
                result[number.first] += by[k]*number.second;
    return result;
}

//! How the numbers of one state change with what is estimated and with the shifts.
MatrixXd changesOf(const RigModel& rig, const MatrixXd& free, const std::vector<Shift>& freed, bool glass)
{
    MatrixXd changes(free.rows(), free.cols() + freed.size());
    changes << free, MatrixXd::Zero(free.rows(), freed.size());
    for (size_t k = 0; k < freed.size(); k++)
        for (const auto& number : freed[k].numbers)
            if (glass || !freed[k].glassOnly)
                changes(number.first, free.cols() + k) += number.second;
    return product(consistentChanges(rig), changes);
}

} // namespace

//! What is left of one view's pixels and of what is known of its pose, over the noise, and how it changes.
struct RelaxedFit::Rows
{
    MatrixXd byAll, byPose;                     //!< byPose: no columns where the pose is known exactly
    VectorXd rest;
};

//! Normal equations with the poses eliminated, and what it takes to get these back.
struct RelaxedFit::Normal
{
    MatrixXd matrix;
    VectorXd right;
    double chiSquare = 0.;
    std::vector<Rows> rows;                     //!< of each view
    MatrixXd glassChanges;

    bool isFinite() const { return std::isfinite(chiSquare) && matrix.allFinite() && right.allFinite(); }
};

RelaxedFit::RelaxedFit(const RigData& data, const Fit& fit, bool posesKnown, double noise)
    : problem_(data, fit, posesKnown), noise_(noise), dof_(fit.dof)
{
    start_.direct = start_.glass = problem_.rig;
    start_.views = problem_.views;
    start_.before = toVector(problem_.rig);
}

//! By what is estimated and the shifts: only of the numbers that an image depends on, a few of those of a rig of many cameras.
static MatrixXd byChanges(const ImageDerivatives& image, const MatrixXd& changes)
{
    MatrixXd own(image.columns.size(), changes.cols());
    for (size_t i = 0; i < image.columns.size(); i++)
        own.row(i) = changes.row(image.columns[i]);
    return product(image.byParameters, own);
}

//! @param changes of the numbers of direct images and of those through the windows
RelaxedFit::Rows RelaxedFit::rowsOf(const Relaxed& at, size_t k, const std::vector<MatrixXd>& changes) const
{
    const ViewObservations& observed = at.views[k];
    const bool isExact = !problem_.poseInformation.empty() && !std::isfinite(problem_.poseInformation[k](0, 0));
    const Eigen::Index known = problem_.poseInformation.empty() || isExact ? 0 : 6, count = observed.pixels.size() + known;
    Rows rows{MatrixXd::Zero(count, changes[0].cols()), MatrixXd(count, 6), VectorXd(count)};
    Eigen::Index row = 0;
    for (const ImageOfView& image : observed.images)
    {
        const ImageDerivatives own = differentiateImage(image.glass ? at.glass : at.direct, observed.objectPoints, observed.rvec,
                                                        observed.tvec, image);
        const Eigen::Index n = own.predicted.size();
        rows.byAll.middleRows(row, n) = byChanges(own, changes[image.glass])/noise_;
        rows.byPose.middleRows(row, n) = own.byPose/noise_;
        rows.rest.segment(row, n) = (observed.pixels.segment(row, n) - own.predicted)/noise_;
        row += n;
    }
    if (known > 0)
    {
        const MatrixXd root = LLT(problem_.poseInformation[k]).L().transpose();
        rows.byPose.bottomRows(6) = root;
        rows.rest.tail(6) = timesVector(root, problem_.knownPoses[k] - toVector(observed.rvec, observed.tvec));
    }
    if (isExact)
        rows.byPose.resize(count, 0);
    return rows;
}

RelaxedFit::Normal RelaxedFit::linearize(const Relaxed& at, const std::vector<Shift>& freed) const
{
    const MatrixXd& free = problem_.free;
    const int count = (int)(free.cols() + freed.size());
    const std::vector<MatrixXd> changes = {changesOf(at.direct, free, freed, false), changesOf(at.glass, free, freed, true)};
    Normal normal;
    normal.glassChanges = changes[true];
    const MatrixXd own = transposeTimes(free, problem_.information);
    normal.matrix = MatrixXd::Zero(count, count);
    normal.right = VectorXd::Zero(count);
    normal.matrix.topLeftCorner(free.cols(), free.cols()) = product(own, free);
    normal.right.head(free.cols()) = timesVector(own, problem_.known - at.before);
    normal.chiSquare = problem_.priorOf(at.before);
    for (size_t k = 0; k < at.views.size(); k++)
    {
        Rows rows = rowsOf(at, k, changes);
        normal.chiSquare += rows.rest.squaredNorm();
        if (!std::isfinite(normal.chiSquare))
            return normal;
        MatrixXd all(rows.byAll.rows(), count + 1);
        all << rows.byAll, rows.rest;
        if (rows.byPose.cols() > 0)
            all = PoseNullSpace(rows.byPose)(all);
        const auto byAll = all.leftCols(count);
        addGram(byAll, 1., normal.matrix);
        normal.right += transposeTimesVector(byAll, all.col(count));
        normal.rows.push_back(std::move(rows));
    }
    normal.matrix = normal.matrix.selfadjointView<Eigen::Lower>();
    return normal;
}

//! The rigs of both states from their numbers; false: a window that cannot be.
bool RelaxedFit::setRigs(const std::vector<Shift>& freed, Relaxed& at) const
{
    try
    {
        at.direct = withVector(problem_.rig, shifted(at.before, freed, at.shifts, false));
        at.glass = withVector(problem_.rig, shifted(at.before, freed, at.shifts, true));
        return true;
    }
    catch (const cv::Exception&)
    {
        return false;
    }
}

bool RelaxedFit::move(const Normal& normal, const std::vector<Shift>& freed, const VectorXd& step, Relaxed& at) const
{
    at.before += timesVector(problem_.free, step.head(problem_.free.cols()));
    at.shifts += step.tail(at.shifts.size());
    if (!setRigs(freed, at))
        return false;
    for (size_t k = 0; k < at.views.size(); k++)
    {
        const Rows& rows = normal.rows[k];
        if (rows.byPose.cols() == 0)
            continue;
        const VectorXd pose = PivotedQR(rows.byPose).solve(VectorXd(rows.rest - timesVector(rows.byAll, step)));
        for (int i = 0; i < 3; i++)
        {
            at.views[k].rvec[i] += pose[i];
            at.views[k].tvec[i] += pose[3 + i];
        }
    }
    return true;
}

//! With each number scaled by how well it is determined.
static VectorXd solved(const MatrixXd& matrix, const VectorXd& right, double damping)
{
    const VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = scale.asDiagonal()*matrix*scale.asDiagonal();
    scaled.diagonal().array() += damping;
    return scale.asDiagonal()*LDLT(scaled).solve(VectorXd(scale.asDiagonal()*right));
}

/** Distances stay before the boards: where a step would carry one beyond, it ends at the bound, and all else is solved for with that. A fit
that goes on meets points before the window, and gets no further in any direction. */
VectorXd RelaxedFit::stepFrom(const Relaxed& at, const Normal& normal, double damping) const
{
    const VectorXd step = solved(normal.matrix, normal.right, damping);
    VectorXd held = VectorXd::Zero(step.size());
    std::vector<int> columns;
    for (const RelaxedProblem::Bound& bound : problem_.bounds)
    {
        const double distance = at.before[bound.number], wanted = distance + step[bound.column];
        if (wanted > 0. && wanted < bound.most)
            continue;
        columns.push_back(bound.column);
        held[bound.column] = (wanted < bound.most ? 0.5*distance : bound.most) - distance;     // never quite at the camera
    }
    if (columns.empty())
        return step;
    MatrixXd matrix = normal.matrix;
    VectorXd right = normal.right - timesVector(normal.matrix, held);
    for (int column : columns)
    {
        matrix.row(column).setZero();
        matrix.col(column).setZero();
        matrix(column, column) = 1.;
        right[column] = 0.;
    }
    return solved(matrix, right, damping) + held;
}

Relaxed RelaxedFit::fit(const Relaxed& start, const std::vector<Shift>& freed) const
{
    Relaxed at = start;
    if (at.shifts.size() != (Eigen::Index)freed.size())
        at.shifts = VectorXd::Zero(freed.size());
    Normal normal = linearize(at, freed);
    double damping = 1e-9;
    for (int i = 0; i < ITERATIONS && normal.isFinite() && damping < MOST_DAMPING; i++)
    {
        Relaxed next = at;
        const VectorXd step = stepFrom(at, normal, damping);
        if (!step.allFinite() || !move(normal, freed, step, next))
        {
            damping = std::max(1e-6, 30.*damping);
            continue;
        }
        Normal there = linearize(next, freed);
        if (!there.isFinite() || there.chiSquare > normal.chiSquare + CONVERGED)
        {
            damping = std::max(1e-6, 30.*damping);
            continue;
        }
        const double gained = normal.chiSquare - there.chiSquare;
        at = std::move(next);
        normal = std::move(there);
        damping = std::max(LEAST_DAMPING, damping/30.);
        const double share = normal.chiSquare > GROSS*dof_ ? GROSS_SHARE : CONVERGED_SHARE;
        if (gained < std::max(CONVERGED, share*normal.chiSquare))
            break;
    }
    at.chiSquare = normal.isFinite() ? normal.chiSquare : std::numeric_limits<double>::infinity();
    if (!normal.isFinite())
        return at;
    const VectorXd scale = normal.matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = scale.asDiagonal()*normal.matrix*scale.asDiagonal();
    scaled.diagonal().array() += 1e-12;
    const MatrixXd inverse = scale.asDiagonal()*LDLT(scaled).inverse()*scale.asDiagonal();
    MatrixXd all(normal.glassChanges.rows() + freed.size(), inverse.cols());
    all << normal.glassChanges, MatrixXd::Zero(freed.size(), problem_.free.cols()), MatrixXd::Identity(freed.size(), freed.size());
    at.covariance = propagated(inverse, all);
    return at;
}

std::vector<double> RelaxedFit::gains(const Relaxed& at, const std::vector<std::vector<Shift>>& sets) const
{
    std::vector<Shift> all;
    for (const std::vector<Shift>& set : sets)
        all.insert(all.end(), set.begin(), set.end());
    Relaxed here = at;
    here.shifts = VectorXd::Zero(all.size());
    const Normal normal = linearize(here, all);
    const Eigen::Index own = problem_.free.cols();
    const double without = normal.right.head(own).dot(solved(normal.matrix.topLeftCorner(own, own), normal.right.head(own), 1e-12));
    std::vector<double> gains;
    Eigen::Index first = own;
    for (const std::vector<Shift>& set : sets)
    {
        const Eigen::Index count = (Eigen::Index)set.size();
        MatrixXd matrix(own + count, own + count);
        VectorXd right(own + count);
        matrix << normal.matrix.topLeftCorner(own, own), normal.matrix.block(0, first, own, count),
                  normal.matrix.block(first, 0, count, own), normal.matrix.block(first, first, count, count);
        right << normal.right.head(own), normal.right.segment(first, count);
        gains.push_back(right.dot(solved(matrix, right, 1e-12)) - without);
        first += count;
    }
    return gains;
}

double RelaxedFit::noiseOfSingleImages() const
{
    double squares = 0., dof = 0.;
    for (const ViewObservations& observed : problem_.views)
        for (const ImageOfView& image : observed.images)
        {
            Eigen::Index row = 0;
            for (const ImageOfView& other : observed.images)
            {
                if (&other == &image)
                    break;
                row += 2*(Eigen::Index)other.points.size();
            }
            const ImageDerivatives view = differentiateImage(problem_.rig, observed.objectPoints, observed.rvec, observed.tvec, image);
            const Eigen::Index n = view.predicted.size();
            if (n <= 6)
                continue;
            const VectorXd rest = PoseNullSpace(view.byPose)(observed.pixels.segment(row, n) - view.predicted);
            squares += rest.squaredNorm();
            dof += (double)rest.size();
        }
    return dof > 0. ? std::sqrt(squares/dof) : 0.;
}

} // namespace tools
