// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/relaxed_fit.hpp"
#include "diagnose/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
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

//! Inverse of a covariance, 0 for what has no variance (it is fixed) or an unknown one (NaN, about which nothing is known).
MatrixXd informationOf(const MatrixXd& covariance)
{
    const int n = (int)covariance.rows();
    std::vector<int> known;
    for (int i = 0; i < n; i++)
        if (covariance(i, i) > 0.)
            known.push_back(i);
    if (known.empty())
        return MatrixXd::Zero(n, n);
    MatrixXd part(known.size(), known.size());
    VectorXd scale(known.size());
    for (size_t i = 0; i < known.size(); i++)
        scale[i] = 1./std::sqrt(covariance(known[i], known[i]));
    for (size_t i = 0; i < known.size(); i++)
        for (size_t j = 0; j < known.size(); j++)
            part(i, j) = covariance(known[i], known[j])*scale[i]*scale[j];
    const SymmetricEigen eigen(part);
    const VectorXd inverse = eigen.values.unaryExpr([](double x) { return x > 1e-12 ? 1./x : 0.; });
    const MatrixXd of = timesTranspose(eigen.vectors*inverse.asDiagonal(), eigen.vectors);
    MatrixXd information = MatrixXd::Zero(n, n);
    for (size_t i = 0; i < known.size(); i++)
        for (size_t j = 0; j < known.size(); j++)
            information(known[i], known[j]) = of(i, j)*scale[i]*scale[j];
    return information;
}

//! Two directions across a normal.
Eigen::Matrix<double, 3, 2> across(const Vec3d& normal)
{
    const Vec3d a = normalize(normal.cross(std::abs(normal[1]) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0))), b = normal.cross(a);
    Eigen::Matrix<double, 3, 2> basis;
    basis << a[0], b[0], a[1], b[1], a[2], b[2];
    return basis;
}

const double BEFORE_BOARDS = 0.2;       // of the range of the nearest board: where a window is, and how well that is known;
const double AT_MOST = 0.6;             // beyond this part boards reach into it

/** Parallel faces between equal media are indifferent to the distance. A wedge is not: its glass is as thick as where the light goes
through, and cameras that share it look through it at two places. Whatever is tested, it is then somewhere before the boards. */
bool showsDistanceByWedge(const Fit& fit, int camera)
{
    const ParameterColumns at = columnsOf(fit.rig, camera);
    const GlassWindow& window = fit.rig.cameras[camera]->window();
    return fit.rig.ownsWindow(camera) && window.innerIndex == window.outerIndex && at.wedge < at.curvature
        && fit.stdDeviations.at<double>(at.wedge) > 0.;
}

//! A fit that took the wedge for none held it; a cause that alone was free to say so would explain what only the held distance leaves.
bool holdsDistance(const Fit& fit, int camera) { return !(fit.stdDeviations.at<double>(columnsOf(fit.rig, camera).distance) > 0.); }

double nearestBoard(const Fit& fit)
{
    double nearest = INFINITY;
    for (const Vec3d& tvec : fit.tvecs)
        nearest = std::min(nearest, norm(tvec));
    return nearest;
}

//! What the fit estimated, a column each.
MatrixXd freeOf(const Fit& fit)
{
    const RigModel& rig = fit.rig;
    const int size = rigVectorSize(rig), targets = columnCount(rig);
    std::vector<VectorXd> columns;
    const auto add = [&](int number) { columns.push_back(VectorXd::Unit(size, number)); };
    const auto addFree = [&](int first, int end) {
        for (int i = first; i < end; i++)
            if (fit.stdDeviations.at<double>(i) > 0.)
                add(i);
    };
    const auto addAcross = [&](const Vec3d& axis, int first) {
        const Eigen::Matrix<double, 3, 2> basis = across(axis);
        for (int k = 0; k < 2; k++)
        {
            columns.push_back(VectorXd::Zero(size));
            columns.back().segment<3>(first) = basis.col(k);
        }
    };
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        addFree(at.lens, at.lens + at.lensCount);
        if (c > 0)
            addFree(extrinsicsColumn(rig, c), extrinsicsColumn(rig, c) + 6);
        if (!rig.ownsWindow(c))
            continue;
        const GlassWindow window = rig.cameras[c]->window();
        const Vec3d* const axis = at.has(at.normal) ? &window.normal : at.has(at.axis) ? &window.axis : nullptr;
        if (at.has(at.normal))
            addAcross(*axis, at.normal);
        else if (axis)          // a tube's centre moves along its axis without effect
        {
            addAcross(*axis, at.center);
            addAcross(*axis, at.axis);
        }
        else
            addFree(at.center, at.center + 3);
        addFree(at.thickness - 1, at.end);          // from the distance or the radius on
        if (showsDistanceByWedge(fit, c) && holdsDistance(fit, c))
            add(at.distance);
    }
    for (int i = 0; i < TARGET_ERRORS && !rig.targetCovariance.empty(); i++)
        if (rig.targetCovariance.at<double>(i, i) > 0.)
            add(targets + i);
    MatrixXd free(size, columns.size());
    for (size_t i = 0; i < columns.size(); i++)
        free.col(i) = columns[i];
    return free;
}

//! The seen points of a view at a pose.
ViewObservations observedAt(const View& view, int cameras, const Vec3d& rvec, const Vec3d& tvec)
{
    ViewObservations observed;
    observed.objectPoints = view.objectPoints;
    observed.rvec = rvec;
    observed.tvec = tvec;
    for (bool glass : {false, true})        // in this order, so that each state has one block of rows
        for (int c = 0; c < cameras; c++)
            addImage(view, c, glass, observed);
    return observed;
}

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

VectorXd toVector(const Vec3d& rvec, const Vec3d& tvec)
{
    VectorXd pose(6);
    pose << rvec[0], rvec[1], rvec[2], tvec[0], tvec[1], tvec[2];
    return pose;
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
    : rig_(fit.rig.clone()), free_(freeOf(fit)), noise_(noise), dof_(fit.dof)
{
    const int size = rigVectorSize(rig_), targets = columnCount(rig_);
    information_ = MatrixXd::Zero(size, size);
    known_ = VectorXd::Zero(size);
    for (int c = 0; c < (int)rig_.known.size(); c++)
    {
        const KnownCamera& known = rig_.known[c];
        if (known.covariance.empty())
            continue;
        const ParameterColumns at = columnsOf(rig_, c);
        RigModel given = rig_.clone();
        given.cameras[c]->setLensParameters(known.lens);
        GlassWindow window = known.window;
        const GlassWindow now = rig_.cameras[c]->window();
        window.shape = now.shape;
        window.wedge.resize(now.wedge.size());
        const bool isNormalKnown = known.covariance.rows > at.lensCount && at.has(at.normal)
            && known.covariance.at<double>(at.normal - at.lens, at.normal - at.lens) > 0;
        if (!isNormalKnown)
            window.normal = now.normal;
        window.axis = now.axis;
        if (window.shape == WINDOW_TUBE)
            window.center = now.center;
        given.cameras[c]->setWindow(window);
        known_.segment(at.lens, at.end - at.lens) = toVector(given).segment(at.lens, at.end - at.lens);
        MatrixXd covariance = toEigen(known.covariance);
        const int count = rig_.ownsWindow(c) ? (int)covariance.rows() : std::min((int)covariance.rows(), at.lensCount);
        information_.block(at.lens, at.lens, count, count) = informationOf(covariance.topLeftCorner(count, count));
    }
    known_[targets] = 1.;
    if (rig_.targetCovariance.empty())
        rig_.targetCovariance = Mat::zeros(TARGET_ERRORS, TARGET_ERRORS, CV_64F);     // so that poseInImage follows the motion
    else
        information_.bottomRightCorner(TARGET_ERRORS, TARGET_ERRORS) = informationOf(toEigen(rig_.targetCovariance));
    start_.before = toVector(rig_);
    for (int c = 0; c < (int)rig_.cameras.size(); c++)
        if (showsDistanceByWedge(fit, c))
        {
            const int distance = columnsOf(rig_, c).distance;
            const double nearest = nearestBoard(fit), somewhere = BEFORE_BOARDS*nearest;
            Eigen::Index column;
            free_.row(distance).maxCoeff(&column);
            bounds_.push_back({distance, (int)column, std::max(AT_MOST*nearest, 1.01*start_.before[distance])});
            if (!holdsDistance(fit, c))
                continue;
            known_[distance] = start_.before[distance] = somewhere;
            information_(distance, distance) = 1./(somewhere*somewhere);
            rig_ = withVector(rig_, start_.before);
        }
    start_.direct = start_.glass = rig_;
    for (size_t k = 0; k < fit.views.size(); k++)
    {
        const View& view = data.views[fit.views[k]];
        start_.views.push_back(observedAt(view, data.cameraCount, fit.rvecs[k], fit.tvecs[k]));
        if (!posesKnown)
            continue;
        const bool exact = view.pose->covariance.empty();
        poseInformation_.push_back(exact ? MatrixXd::Constant(1, 1, INFINITY) : informationOf(toEigen(view.pose->covariance)));
        knownPoses_.push_back(toVector(view.pose->rvec, view.pose->tvec));
    }
}

double RelaxedFit::priorOf(const VectorXd& numbers) const
{
    const VectorXd off = numbers - known_;
    return off.dot(timesVector(information_, off));
}

//! @param changes of the numbers of direct images and of those through the windows
RelaxedFit::Rows RelaxedFit::rowsOf(const Relaxed& at, size_t k, const std::vector<MatrixXd>& changes) const
{
    const ViewObservations& observed = at.views[k];
    std::vector<ImageOfView> images[2];
    for (const ImageOfView& image : observed.images)
        images[image.glass].push_back(image);
    const bool isExact = !poseInformation_.empty() && !std::isfinite(poseInformation_[k](0, 0));
    const Eigen::Index known = poseInformation_.empty() || isExact ? 0 : 6, count = observed.pixels.size() + known;
    Rows rows{MatrixXd::Zero(count, changes[0].cols()), MatrixXd(count, 6), VectorXd(count)};
    Eigen::Index row = 0;
    for (bool glass : {false, true})
    {
        if (images[glass].empty())
            continue;
        const ViewDerivatives view = differentiateView(glass ? at.glass : at.direct, observed.objectPoints, observed.rvec,
                                                       observed.tvec, images[glass]);
        const Eigen::Index n = view.predicted.size();
        rows.byAll.middleRows(row, n) = product(view.byParameters, changes[glass]/noise_);
        rows.byPose.middleRows(row, n) = view.byPose/noise_;
        rows.rest.segment(row, n) = (observed.pixels.segment(row, n) - view.predicted)/noise_;
        row += n;
    }
    if (known > 0)
    {
        const MatrixXd root = LLT(poseInformation_[k]).L().transpose();
        rows.byPose.bottomRows(6) = root;
        rows.rest.tail(6) = timesVector(root, knownPoses_[k] - toVector(observed.rvec, observed.tvec));
    }
    if (isExact)
        rows.byPose.resize(count, 0);
    return rows;
}

RelaxedFit::Normal RelaxedFit::linearize(const Relaxed& at, const std::vector<Shift>& freed) const
{
    const int count = (int)(free_.cols() + freed.size());
    const std::vector<MatrixXd> changes = {changesOf(at.direct, free_, freed, false), changesOf(at.glass, free_, freed, true)};
    Normal normal;
    normal.glassChanges = changes[true];
    const MatrixXd own = transposeTimes(free_, information_);
    normal.matrix = MatrixXd::Zero(count, count);
    normal.right = VectorXd::Zero(count);
    normal.matrix.topLeftCorner(free_.cols(), free_.cols()) = product(own, free_);
    normal.right.head(free_.cols()) = timesVector(own, known_ - at.before);
    normal.chiSquare = priorOf(at.before);
    for (size_t k = 0; k < at.views.size(); k++)
    {
        const Rows rows = rowsOf(at, k, changes);
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
        normal.rows.push_back(rows);
    }
    normal.matrix = normal.matrix.selfadjointView<Eigen::Lower>();
    return normal;
}

//! The rigs of both states from their numbers; false: a window that cannot be.
bool RelaxedFit::setRigs(const std::vector<Shift>& freed, Relaxed& at) const
{
    try
    {
        at.direct = withVector(rig_, shifted(at.before, freed, at.shifts, false));
        at.glass = withVector(rig_, shifted(at.before, freed, at.shifts, true));
        return true;
    }
    catch (const cv::Exception&)
    {
        return false;
    }
}

bool RelaxedFit::move(const Normal& normal, const std::vector<Shift>& freed, const VectorXd& step, Relaxed& at) const
{
    at.before += timesVector(free_, step.head(free_.cols()));
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
    for (const Bound& bound : bounds_)
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
    all << normal.glassChanges, MatrixXd::Zero(freed.size(), free_.cols()), MatrixXd::Identity(freed.size(), freed.size());
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
    const Eigen::Index own = free_.cols();
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
    for (const ViewObservations& observed : start_.views)
        for (const ImageOfView& image : observed.images)
        {
            Eigen::Index row = 0;
            for (const ImageOfView& other : observed.images)
            {
                if (&other == &image)
                    break;
                row += 2*(Eigen::Index)other.points.size();
            }
            const ViewDerivatives view = differentiateView(rig_, observed.objectPoints, observed.rvec, observed.tvec, {image});
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
