// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/view_observations.hpp"
#include "console/failure.hpp"
#include "math/dense.hpp"
#include "measure/eigen_matrix.hpp"
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
        if (!step.allFinite())          // a point has no image, or nothing holds the pose
            throw Failure("no pose of the target explains its points: with this calibration a camera does not see some of them");
        observed.move(step);
        derivatives = differentiateView(rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
    }
    return derivatives;
}

size_t giveUpFarOff(const RigModel& rig, const ViewObservations& at, double far, ViewObservations& observed)
{
    const double NOTHING = 1e6;         // times the noise: next to no weight
    const VectorXd misses = at.weighed(at.pixels - differentiateView(rig, at.objectPoints, at.rvec, at.tvec, at.images).predicted);
    std::vector<double> squares(at.objectPoints.size(), 0.);
    std::vector<int> pointOf;           // of each row
    for (const ImageOfView& image : at.images)
        for (int point : image.points)
            pointOf.insert(pointOf.end(), {point, point});
    for (size_t row = 0; row < pointOf.size(); row++)
        squares[pointOf[row]] += misses[row]*misses[row];
    if (observed.noise.size() == 0)
        observed.noise = VectorXd::Ones((Eigen::Index)pointOf.size());
    for (size_t row = 0; row < pointOf.size(); row++)
        if (squares[pointOf[row]] > far*far)
            observed.noise[row] *= NOTHING;
    return std::count_if(squares.begin(), squares.end(), [=](double s) { return s > far*far; });
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

UnknownsOfView::UnknownsOfView(const ViewObservations& observed, const MatrixXd& byPose) : unknowns_(observed.isScene ? 3 : 6)
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
    groups_.reserve(rows.size());
    rows_.reserve(row);
    normals_.reserve((size_t)row*unknowns_);
    R_.reserve(rows.size()*unknowns_*unknowns_);
    for (const std::vector<int>& group : rows)
        add(group, byPose.rightCols(unknowns_));
}

void UnknownsOfView::add(const std::vector<int>& rows, const Eigen::Ref<const MatrixXd>& byUnknowns)
{
    const Group group{rows_.size(), normals_.size(), R_.size(), (int)rows.size()};
    groups_.push_back(group);
    left_ += group.count - unknowns_;
    rows_.insert(rows_.end(), rows.begin(), rows.end());
    normals_.resize(normals_.size() + (size_t)group.count*unknowns_);
    R_.resize(R_.size() + unknowns_*unknowns_);
    VectorXd x;
    for (int j = 0; j < unknowns_; j++)
    {
        reflect(group, byUnknowns.col(j).data(), x);        // by those before
        for (int i = 0; i < j; i++)
            R_[group.R + i*unknowns_ + j] = x[i];
        auto rest = x.tail(x.size() - j);
        const double length = rest.norm();
        if (!(length > 0.))
            continue;
        const double diagonal = x[j] > 0. ? -length : length;
        R_[group.R + j*unknowns_ + j] = diagonal;
        x[j] -= diagonal;
        Eigen::Map<VectorXd>(&normals_[group.normals + (size_t)j*group.count + j], rest.size()) = rest/rest.norm();
    }
}

void UnknownsOfView::reflect(const Group& group, const double* column, VectorXd& x) const
{
    const int m = group.count;
    const int* const rows = &rows_[group.rows];
    x.resize(m);
    for (int i = 0; i < m; i++)
        x[i] = column[rows[i]];
    const double* normal = &normals_[group.normals];
    for (int j = 0; j < unknowns_; j++, normal += m)
    {
        double along = 0.;
        for (int i = j; i < m; i++)
            along += normal[i]*x[i];
        for (int i = j; i < m; i++)
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
            reflect(group, rows.col(column).data(), x);
            at = std::copy(x.data() + unknowns_, x.data() + x.size(), at);
        }
    }
    return all;
}

VectorXd UnknownsOfView::solve(const VectorXd& residual) const
{
    VectorXd step(unknowns_*(Eigen::Index)groups_.size()), x;
    Eigen::Index at = 0;
    for (const Group& group : groups_)
    {
        reflect(group, residual.data(), x);
        step.segment(at, unknowns_) = solveR(group, x);
        at += unknowns_;
    }
    return step;
}

VectorXd UnknownsOfView::solveR(const Group& group, const VectorXd& x) const
{
    typedef Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> RowMatrix;
    const Eigen::Map<const RowMatrix> R(&R_[group.R], unknowns_, unknowns_);
    const double NOTHING = 1e-14*R.diagonal().cwiseAbs().maxCoeff();        // what moves no pixel is not moved
    VectorXd step = VectorXd::Zero(unknowns_);
    for (int j = unknowns_ - 1; j >= 0; j--)
        if (std::abs(R(j, j)) > NOTHING)
            step[j] = (x[j] - R.row(j).dot(step))/R(j, j);
    return step;
}

namespace {

const int CUBIC = 3, TERMS = 10;
const int POINTS_PER_TERM = 2;

//! Columns x^i y^j, x and y within -1 to 1.
MatrixXd polynomials(const VectorXd& pixels)
{
    const Eigen::Index n = pixels.size()/2;
    MatrixXd xy(n, 2);
    for (Eigen::Index i = 0; i < n; i++)
        xy.row(i) = pixels.segment<2>(2*i).transpose();
    const Eigen::RowVector2d low = xy.colwise().minCoeff(), high = xy.colwise().maxCoeff();
    for (int axis = 0; axis < 2; axis++)
        xy.col(axis) = (2.*xy.col(axis).array() - low[axis] - high[axis])/std::max(1e-9, high[axis] - low[axis]);
    MatrixXd columns(n, TERMS);
    int column = 0;
    for (int i = 0; i <= CUBIC; i++)
        for (int j = 0; i + j <= CUBIC; j++)
            columns.col(column++) = xy.col(0).array().pow(i)*xy.col(1).array().pow(j);
    return columns;
}

void addImage(const RigModel& rig, const View& view, double& squares, double& dof)
{
    ViewObservations observed = observationsOf(rig, view);
    const ViewDerivatives derivatives = refinePose(rig, observed);
    const Eigen::Index n = observed.pixels.size()/2;
    const VectorXd residual = observed.pixels - derivatives.predicted;
    if (n < POINTS_PER_TERM*TERMS || !residual.allFinite())
        return;
    const PivotedQR smooth(polynomials(observed.pixels));
    for (int axis = 0; axis < 2; axis++)
    {
        VectorXd rest(n);
        for (Eigen::Index i = 0; i < n; i++)
            rest[i] = residual[2*i + axis];
        rest = smooth.rotate(rest);
        squares += rest.tail(n - smooth.rank()).squaredNorm();
        dof += (double)(n - smooth.rank());
    }
}

} // namespace

ImageNoise imageNoise(const RigModel& rig, const std::vector<View>& views)
{
    double squares = 0., dof = 0.;
    for (const View& view : views)
        for (int c = 0; c < (int)rig.cameras.size(); c++)
            for (bool glass : {false, true})
            {
                View alone = view;
                alone.direct = alone.glass = {};
                (glass ? alone.glass : alone.direct)[c] = (glass ? view.glass : view.direct)[c];
                const std::vector<Point2d>& pixels = (glass ? alone.glass : alone.direct)[c];
                if (pixels.empty())
                    continue;
                try
                {
                    addImage(rig, alone, squares, dof);
                }
                catch (const Failure&) {}       // no pose
            }
    return {dof > 0. ? std::sqrt(squares/dof) : 0., dof};
}

} // namespace tools
