// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/moved_rig.hpp"
#include "assess/change.hpp"
#include "match/depth_range.hpp"
#include "math/dense.hpp"
#include "measure/rig_vector.hpp"
#include "measure/view_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREE = CV_PI/180.;

bool isTurn(const Change& change)
{
    return std::all_of(change.quantities.begin(), change.quantities.end(), [](const ChangedQuantity& q) { return q.unit == "degrees"; });
}

//! The parameters of the rig by those of all changes of the table, a column each, in their standard deviations; of these 0: not at all.
MatrixXd byChanges(const RigModel& rig, const Vec3d& middle, const std::function<VectorXd(const Change&)>& stdsOf)
{
    const double SMALL = 1e-3;          // of the range; cv::Rodrigues takes turns below 1e-5 for none
    std::vector<VectorXd> columns;
    for (const Change& change : changesOf(rig, "", middle))
    {
        const VectorXd stds = stdsOf(change), steps = SMALL*change.ranges();
        for (int i = 0; i < change.size(); i++)
        {
            if (!(stds[i] > 0.))
                continue;
            VectorXd values[2];
            for (int side : {0, 1})
            {
                RigModel moved = rig.clone();
                change.apply(moved, (side ? steps[i] : -steps[i])*VectorXd::Unit(change.size(), i));
                values[side] = parametersOf(moved);
            }
            columns.push_back(stds[i]*(values[1] - values[0])/(2.*steps[i]));
        }
    }
    MatrixXd D(parametersOf(rig).size(), columns.size());
    for (size_t i = 0; i < columns.size(); i++)
        D.col(i) = columns[i];
    return D;
}

MatrixXd byTurns(const RigModel& rig, const MayHaveTurned& turned)
{
    return byChanges(rig, Vec3d(0, 0, 1), [&](const Change& change) {
        const double std = !isTurn(change) ? 0. : change.isTilt ? turned.windows : turned.ofCamera(change.turnedCamera());
        return VectorXd(VectorXd::Constant(change.size(), std*DEGREE)); });
}

//! The calibration's covariance with what may have changed since, independently, a column each.
Mat covarianceWith(const CheckInput& input, const MatrixXd& changes)
{
    MatrixXd C = input.covariance.empty() ? MatrixXd(MatrixXd::Zero(changes.rows(), changes.rows())) : toEigen(input.covariance);
    addGram(changes.transpose(), 1., C);
    C.triangularView<Eigen::StrictlyUpper>() = C.transpose();
    return toMat(C);
}

//! Points all over what both cameras see.
std::vector<Point3d> pointsInBoth(const RigModel& rig, int first, int second, const Vec2d& depth)
{
    const int STEPS = 6, DEPTHS = 3;
    const double FAR = 100.;            // times the near end: farther points look as those
    std::vector<Point3d> both;
    for (int k = 0; k < DEPTHS; k++)
    {
        const double far = std::min(depth[1], FAR*depth[0]), share = k/(DEPTHS - 1.);
        const std::vector<Point3d> points = pointsAtDepth(rig.cameras[0], 1./((1. - share)/depth[0] + share/far), STEPS);
        std::vector<Point3d> kept;
        std::copy_if(points.begin(), points.end(), std::back_inserter(kept), [](const Point3d& X) { return X.x == X.x; });
        const std::vector<int> seen1 = pointsInImage(rig, kept, Vec3d(), Vec3d(), first, true).points;
        const std::vector<int> seen2 = pointsInImage(rig, kept, Vec3d(), Vec3d(), second, true).points;
        for (int i : seen1)
            if (std::binary_search(seen2.begin(), seen2.end(), i))
                both.push_back(kept[i]);
    }
    return both;
}

} // namespace

Mat covarianceOfMoved(const CheckInput& input, const MayHaveTurned& turned)
{
    return covarianceWith(input, byTurns(input.rig, turned));
}

Mat covarianceOfChanged(const CheckInput& input, double depth, double share)
{
    return covarianceWith(input, byChanges(input.rig, Vec3d(0, 0, depth), [&](const Change& change) {
        return VectorXd(share*change.ranges()); }));
}

double searchWidth(const CheckInput& input, int first, int second, const Vec2d& depth, double degrees)
{
    const double MANY = 3., NOISE = 3.;         // standard deviations; px, of features
    const std::vector<Point3d> points = pointsInBoth(input.rig, first, second, depth);
    const int count = (int)points.size();
    std::vector<int> all(count);
    for (int i = 0; i < count; i++)
        all[i] = i;
    const ViewDerivatives view = differentiateView(input.rig, points, Vec3d(), Vec3d(), {{first, true, all}, {second, true, all}});
    const MatrixXd D = byTurns(input.rig, {{degrees}, degrees});
    const MatrixXd C = input.covariance.empty() ? MatrixXd(MatrixXd::Zero(D.rows(), D.rows())) : toEigen(input.covariance);
    double width = 0.;
    for (int i = 0; i < count; i++)
    {
        MatrixXd byPoint(4, 3), byParameters(4, view.byParameters.cols());
        byPoint << view.byPose.block(2*i, 3, 2, 3), view.byPose.block(2*(count + i), 3, 2, 3);
        byParameters << view.byParameters.middleRows(2*i, 2), view.byParameters.middleRows(2*(count + i), 2);
        const VectorXd miss = QR(byPoint).Q().col(3);           // what no motion of the point does to its four coordinates
        const VectorXd row = transposeTimesVector(byParameters, miss);
        const double known = std::sqrt(std::max(0., row.dot(timesVector(C, row))));
        const double turned = transposeTimesVector(D, row).cwiseAbs().maxCoeff();
        const double inSecond = miss.tail(2).norm();
        if (inSecond > 0. && std::isfinite(known))
            width = std::max(width, (MANY*known + turned)/inSecond);
    }
    return width + NOISE;
}

} // namespace tools
