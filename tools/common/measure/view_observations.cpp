// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/view_observations.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace tools {

//! The pose comes from the first of: direct images, glass images; of camera 1, of camera 2, ...
static bool startPose(const RigModel& rig, const View& view, ViewObservations& observed)
{
    for (bool glass : {false, true})
        for (int c = 0; c < (int)rig.cameras.size(); c++)
        {
            const std::vector<Point2d>& pixels = glass ? view.glass[c] : view.direct[c];
            const Ptr<RefractiveCamera> camera = glass ? rig.cameras[c] : copyWithWindow(rig.cameras[c], GlassWindow());
            if (pixels.empty() || !refractiveSolvePnP(pointsOfTarget(rig, view.objectPoints), pixels, camera, observed.rvec, observed.tvec))
                continue;
            poseFromImage(rig, c, glass, observed.rvec, observed.tvec);
            return true;
        }
    return false;
}

void addImage(const View& view, int camera, bool glass, ViewObservations& observed)
{
    const std::vector<Point2d>& points = (glass ? view.glass : view.direct)[camera];
    ImageOfView image{camera, glass, {}};
    std::vector<double> pixels(observed.pixels.data(), observed.pixels.data() + observed.pixels.size());
    for (size_t i = 0; i < points.size(); i++)
        if (seen(points[i]))
        {
            image.points.push_back((int)i);
            pixels.insert(pixels.end(), {points[i].x, points[i].y});
        }
    if (image.points.empty())
        return;
    observed.images.push_back(image);
    observed.pixels = Eigen::Map<VectorXd>(pixels.data(), pixels.size());
}

ViewObservations observationsOf(const RigModel& rig, const View& view)
{
    ViewObservations observed;
    observed.objectPoints = view.objectPoints;
    if (!startPose(rig, view, observed))
        throw Failure("no pose of the target explains its points in view '" + view.stem + "': check --size and --square");
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (bool glass : {false, true})
            addImage(view, c, glass, observed);
    return observed;
}

ViewDerivatives refinePose(const RigModel& rig, ViewObservations& observed)
{
    const int ITERATIONS = 4;       // from the pose that fits one of the images best
    ViewDerivatives derivatives = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
    for (int i = 0; i < ITERATIONS; i++)
    {
        const VectorXd step = PivotedQR(derivatives.byPose).solve(VectorXd(observed.pixels - derivatives.predicted));
        observed.move(step);
        derivatives = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
    }
    return derivatives;
}

MatrixXd ViewObservations::weighed(const MatrixXd& rows) const
{
    if (noise.size() == 0)
        return rows;
    return rows.array().colwise()/noise.array();
}

void ViewObservations::move(const VectorXd& step)
{
    for (int i = 0; i < 3 && !isScene; i++)
    {
        rvec[i] += step[i];
        tvec[i] += step[3 + i];
    }
    for (size_t i = 0; isScene && i < objectPoints.size(); i++)
        objectPoints[i] += Point3d(step[3*i], step[3*i + 1], step[3*i + 2]);
}

UnknownsOfView::UnknownsOfView(const ViewObservations& observed, const MatrixXd& byPose)
{
    std::vector<std::vector<int>> rows(observed.isScene ? observed.objectPoints.size() : 1);
    int row = 0;
    for (const ImageOfView& image : observed.images)
        for (int point : image.points)
        {
            std::vector<int>& group = rows[observed.isScene ? point : 0];
            group.push_back(row++);
            group.push_back(row++);
        }
    for (const std::vector<int>& group : rows)
    {
        groups_.emplace_back(group, byPose.rightCols(observed.isScene ? 3 : 6));
        left_ += groups_.back().left();
    }
}

UnknownsOfView::Group::Group(const std::vector<int>& rows, const Eigen::Ref<const MatrixXd>& byUnknowns)
    : rows_(rows), normals_(MatrixXd::Zero(rows.size(), byUnknowns.cols())), R_(MatrixXd::Zero(byUnknowns.cols(), byUnknowns.cols()))
{
    VectorXd x;
    for (Eigen::Index j = 0; j < R_.cols(); j++)
    {
        reflect(byUnknowns.col(j).data(), x);       // by those before
        R_.col(j).head(j) = x.head(j);
        auto rest = x.tail(x.size() - j);
        const double length = rest.norm();
        if (!(length > 0.))
            continue;
        R_(j, j) = x[j] > 0. ? -length : length;
        x[j] -= R_(j, j);
        normals_.col(j).tail(rest.size()) = rest/rest.norm();
    }
}

void UnknownsOfView::Group::reflect(const double* column, VectorXd& x) const
{
    const Eigen::Index m = normals_.rows();
    x.resize(m);
    for (Eigen::Index i = 0; i < m; i++)
        x[i] = column[rows_[i]];
    for (Eigen::Index j = 0; j < normals_.cols(); j++)
    {
        const double* normal = normals_.col(j).data();
        double along = 0.;
        for (Eigen::Index i = j; i < m; i++)
            along += normal[i]*x[i];
        for (Eigen::Index i = j; i < m; i++)
            x[i] -= 2.*along*normal[i];
    }
}

MatrixXd UnknownsOfView::projectedOut(const MatrixXd& rows) const
{
    MatrixXd all(left_, rows.cols());
    VectorXd x;
    for (Eigen::Index column = 0; column < rows.cols(); column++)
    {
        double* at = all.col(column).data();
        for (const Group& group : groups_)
        {
            group.reflect(rows.col(column).data(), x);
            at = std::copy(x.data() + x.size() - group.left(), x.data() + x.size(), at);
        }
    }
    return all;
}

VectorXd UnknownsOfView::solve(const VectorXd& residual) const
{
    std::vector<double> step;
    VectorXd x;
    for (const Group& group : groups_)
    {
        group.reflect(residual.data(), x);
        const VectorXd part = group.solveR(x);
        step.insert(step.end(), part.data(), part.data() + part.size());
    }
    return Eigen::Map<VectorXd>(step.data(), step.size());
}

VectorXd UnknownsOfView::Group::solveR(const VectorXd& x) const
{
    const double NOTHING = 1e-14*R_.diagonal().cwiseAbs().maxCoeff();       // what moves no pixel is not moved
    VectorXd step = VectorXd::Zero(R_.cols());
    for (Eigen::Index j = R_.cols() - 1; j >= 0; j--)
        if (std::abs(R_(j, j)) > NOTHING)
            step[j] = (x[j] - R_.row(j).dot(step))/R_(j, j);
    return step;
}

} // namespace tools
