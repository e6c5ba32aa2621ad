// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/check_problem.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include "measure/measurement.hpp"
#include "measure/rig_vector.hpp"
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int ITERATIONS = 10, HALVINGS = 6;
const double CONVERGED = 1e-3;          // of chi^2, which then is known to far less than 1
const double NOWHERE = std::numeric_limits<double>::infinity();

} // namespace

//! One linearisation: residuals and derivatives, as they are and with the poses projected out.
struct CheckRows
{
    struct OfView
    {
        VectorXd residual;
        MatrixXd byParameters;
        UnknownsOfView unknowns;
    };
    std::vector<OfView> views;
    VectorXd residual;
    MatrixXd byParameters, byQ;     //!< q: of their error
    double squares = 0.;            //!< of all residuals, whatever the poses

    bool isFinite() const { return std::isfinite(squares) && byParameters.allFinite() && byQ.allFinite(); }
};

//! H step = gradient, of q and delta.
struct CheckProblem::Normal
{
    MatrixXd H;
    VectorXd gradient;
};

static std::vector<ViewObservations> observationsOf(const RigModel& rig, const std::vector<View>& views)
{
    std::vector<ViewObservations> all;
    for (const View& view : views)
        all.push_back(observationsOf(rig, view));
    return all;
}

CheckProblem::CheckProblem(const CheckInput& input, const std::vector<View>& views, double sigma)
    : CheckProblem(input, observationsOf(input.rig, views), sigma) {}

CheckProblem::CheckProblem(const CheckInput& input, const std::vector<ViewObservations>& views, double sigma)
    : input_(input.rig.targetCovariance.empty() ? withTargetColumns(input, Mat()) : input), sigma_(sigma),
      parameters_(parametersOf(input_.rig)), views_(views)
{
    const double NOTHING = 1e-13;
    const CorrelationSpectrum spectrum(toEigen(input_.covariance));
    const int rank = spectrum.rank(NOTHING);
    if (rank > 0)
    {
        root_ = spectrum.root(rank);
        inverseRoot_ = spectrum.inverseRoot(rank);
    }
    else        // an exact calibration: one direction along which nothing moves, as Eigen wants a column
        root_ = inverseRoot_ = MatrixXd::Zero(parameters_.size(), 1);
    for (const ViewObservations& view : views_)
        observations_ += (int)view.pixels.size() - view.unknowns();
}

RigModel CheckProblem::rigOf(const VectorXd& q, const Change* change, const VectorXd& delta) const
{
    RigModel rig = input_.rig.clone();
    setParameters(rig, parameters_ + timesVector(root_, q));
    if (change)
        change->apply(rig, delta);
    return rig;
}

MatrixXd CheckProblem::derivative(const Change& change, const VectorXd& q, const VectorXd& delta) const
{
    const double SMALL = 1e-3;      // of the range; cv::Rodrigues takes turns below 1e-5 for none
    const VectorXd ranges = change.ranges();
    MatrixXd D(parameters_.size(), ranges.size());
    for (int i = 0; i < ranges.size(); i++)
    {
        const VectorXd step = SMALL*ranges[i]*VectorXd::Unit(ranges.size(), i);
        D.col(i) = (parametersOf(rigOf(q, &change, delta + step)) - parametersOf(rigOf(q, &change, delta - step)))
                   / (2.*SMALL*ranges[i]);
    }
    return D;
}

std::shared_ptr<const CheckRows> CheckProblem::linearise(const RigModel& rig, const std::vector<ViewObservations>& views) const
{
    const auto rows = std::make_shared<CheckRows>();
    rows->residual.resize(observations_);
    rows->byParameters.resize(observations_, parameters_.size());
    int row = 0;
    for (const ViewObservations& observed : views)
    {
        const ViewDerivatives view = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
        const VectorXd residual = observed.weighed(observed.pixels - view.predicted);
        const MatrixXd byPose = observed.weighed(view.byPose);
        rows->squares += residual.squaredNorm();
        if (!residual.allFinite() || !byPose.allFinite())
        {
            rows->squares = NOWHERE;
            return rows;
        }
        rows->views.push_back({residual, observed.weighed(view.byParameters), UnknownsOfView(observed, byPose)});
        const CheckRows::OfView& of = rows->views.back();
        const int count = (int)residual.size() - observed.unknowns();
        rows->residual.segment(row, count) = of.unknowns.projectedOut(residual);
        rows->byParameters.middleRows(row, count) = of.unknowns.projectedOut(of.byParameters);
        row += count;
    }
    rows->byQ = product(rows->byParameters, root_);
    return rows;
}

CheckProblem::Normal CheckProblem::normalEquations(const CheckRows& rows, const MatrixXd& byDelta, const VectorXd& q) const
{
    const Eigen::Index n = rows.byQ.cols(), k = byDelta.cols();
    MatrixXd J(rows.byQ.rows(), n + k);
    J << rows.byQ, product(rows.byParameters, byDelta);
    Normal normal{MatrixXd::Zero(n + k, n + k), transposeTimesVector(J, rows.residual)/(sigma_*sigma_)};
    addGram(J, 1./(sigma_*sigma_), normal.H);
    normal.H.triangularView<Eigen::StrictlyUpper>() = normal.H.transpose();
    normal.H.diagonal().head(n).array() += 1.;
    normal.gradient.head(n) -= q;
    return normal;
}

CheckFit CheckProblem::iterate(const Change* change, const MatrixXd& directions, const CheckFit& start) const
{
    CheckFit fit = start;
    const Eigen::Index n = root_.cols(), k = directions.cols();
    VectorXd eta = VectorXd::Zero(k);
    const auto objective = [&](const CheckFit& at) {
        return at.rows && at.rows->isFinite() ? at.rows->squares/(sigma_*sigma_) + at.q.squaredNorm() : NOWHERE; };
    fit.delta = timesVector(directions, eta);
    if (!fit.rows)
    {
        fit.rig = rigOf(fit.q, change, fit.delta);
        fit.rows = linearise(fit.rig, fit.views);
    }
    for (int i = 0; i < ITERATIONS; i++)
    {
        fit.chiSquare = objective(fit);
        if (!std::isfinite(fit.chiSquare))
            return fit;
        const MatrixXd tangent = change ? product(derivative(*change, fit.q, fit.delta), directions) : MatrixXd(parameters_.size(), 0);
        const Normal normal = normalEquations(*fit.rows, tangent, fit.q);
        const LDLT H(normal.H);
        const VectorXd step = H.solve(normal.gradient);
        if (!step.allFinite())
            return fit;
        fit.covariance = propagated(H.inverse().bottomRightCorner(k, k), directions);
        // What is left if the linearisation holds; the rest of the decrease is that of poses and points.
        const double before = fit.chiSquare;
        const double after = fit.rows->residual.squaredNorm()/(sigma_*sigma_) + fit.q.squaredNorm() - normal.gradient.dot(step);
        if (before - after < CONVERGED + 1e-9*before)
        {
            fit.chiSquare = after;
            return fit;
        }
        const VectorXd byParameters = timesVector(root_, step.head(n)) + timesVector(tangent, step.tail(k));
        std::vector<VectorXd> unknowns;
        for (const CheckRows::OfView& of : fit.rows->views)
            unknowns.push_back(of.unknowns.solve(of.residual - timesVector(of.byParameters, byParameters)));
        const CheckFit last = fit;
        const VectorXd lastEta = eta;
        bool isBetter = false;
        double share = 1.;
        for (int halving = 0; !isBetter && halving < HALVINGS; halving++, share *= 0.5)
        {
            fit = last;
            eta = lastEta + share*step.tail(k);
            fit.q += share*step.head(n);
            fit.delta = timesVector(directions, eta);
            for (size_t v = 0; v < fit.views.size(); v++)
                fit.views[v].move(share*unknowns[v]);
            try
            {
                fit.rig = rigOf(fit.q, change, fit.delta);
                fit.rows = linearise(fit.rig, fit.views);
                isBetter = objective(fit) <= before;
            }
            catch (const cv::Exception&)        // so far away there is no such window or lens
            {
                fit.rows.reset();
            }
        }
        if (!isBetter && !std::isfinite(objective(fit)))    // beyond what can be: no farther than here
            return last;
    }
    fit.chiSquare = objective(fit);
    return fit;
}

CheckFit CheckProblem::fitUnchanged() const
{
    CheckFit start;
    start.views = views_;
    start.q = VectorXd::Zero(root_.cols());
    return fitUnchanged(start);
}

CheckFit CheckProblem::fitUnchanged(const CheckFit& start) const { return iterate(nullptr, MatrixXd(0, 0), start); }

CheckFit CheckProblem::asCalibrated() const
{
    CheckProblem exact = *this;
    exact.root_ = MatrixXd::Zero(root_.rows(), 1);
    CheckFit fit = exact.fitUnchanged();
    fit.q = VectorXd::Zero(root_.cols());
    const auto rows = std::make_shared<CheckRows>(*fit.rows);
    rows->byQ = product(rows->byParameters, root_);
    fit.rows = rows;
    return fit;
}

CheckFit CheckProblem::fit(const Change& change, const MatrixXd& directions, const CheckFit& start) const
{
    CheckFit fit;
    fit.chiSquare = NOWHERE;
    try
    {
        fit = iterate(&change, directions, start);
    }
    catch (const cv::Exception&) {}     // no such window or lens
    fit.rows.reset();                   // they are large, and nobody goes on from here
    return fit;
}

MatrixXd CheckProblem::directionsOf(const Change& change) const
{
    return derivative(change, VectorXd::Zero(root_.cols()), VectorXd::Zero(change.size()))*change.ranges().asDiagonal();
}

CheckProblem::Information CheckProblem::information(const std::vector<Change>& changes, const CheckFit& at) const
{
    Eigen::Index columns = 0;
    for (const Change& change : changes)
        columns += change.size();
    MatrixXd byDelta(parameters_.size(), columns);
    columns = 0;
    for (const Change& change : changes)
    {
        const int size = change.size();
        byDelta.middleCols(columns, size) = derivative(change, at.q, VectorXd::Zero(size))*change.ranges().asDiagonal();
        columns += size;
    }
    const CheckRows& rows = *at.rows;
    if (!rows.isFinite())
        return {};
    const MatrixXd effect = product(rows.byParameters, byDelta);
    // r + A dp is what the calibrated values leave; S^-1 by the matrix inversion lemma.
    const double precision = 1./(sigma_*sigma_);
    const VectorXd r = rows.residual + timesVector(rows.byQ, at.q);
    MatrixXd H = transposeTimes(rows.byQ, rows.byQ, precision);
    H.diagonal().array() += 1.;
    const MatrixXd mixed = transposeTimes(rows.byQ, effect, precision);
    const LDLT ldlt(H);
    const VectorXd alongQ = transposeTimesVector(rows.byQ, r, precision), q = ldlt.solve(alongQ);
    Information result;
    result.chiSquare = precision*r.squaredNorm() - alongQ.dot(q);
    result.G = transposeTimes(effect, effect, precision) - transposeTimes(mixed, ldlt.solve(mixed));
    result.score = precision*(transposeTimesVector(effect, r) - timesVector(transposeTimes(effect, rows.byQ), q));
    result.byParameters = transposeTimes(ldlt.solve(mixed), inverseRoot_.transpose());    // B^T S^-1 A L = (H^-1 mixed)^T
    return result;
}

} // namespace tools
