// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/view_derivatives.hpp"
#include "measure/eigen_matrix.hpp"
#include "calibrate/parameter_columns.hpp"
#include <opencv2/calib3d.hpp>
#include <Eigen/Cholesky>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

//! Pose in a camera, and its derivatives (6x6) by the pose in camera 1 and by the rig's R (rotation vector) and T.
struct PoseInCamera
{
    PoseInCamera(const RigModel& rig, int camera, const Vec3d& rvec1, const Vec3d& tvec1)
        : rvec(rvec1), tvec(tvec1), byPose(MatrixXd::Identity(6, 6)), byRig(MatrixXd::Zero(6, 6))
    {
        if (camera == 0)
            return;
        const Vec3d rigRvec = rotationVector(rig.extrinsics[camera].R);
        Mat r, t, rr1, rt1, rr2, rt2, tr1, tt1, tr2, tt2;
        composeRT(rvec1, tvec1, rigRvec, rig.extrinsics[camera].T, r, t, rr1, rt1, rr2, rt2, tr1, tt1, tr2, tt2);
        rvec = Vec3d(r.ptr<double>());
        tvec = Vec3d(t.ptr<double>());
        byPose << toEigen(rr1), toEigen(rt1), toEigen(tr1), toEigen(tt1);
        byRig << toEigen(rr2), toEigen(rt2), toEigen(tr2), toEigen(tt2);
    }
    Vec3d rvec, tvec;
    MatrixXd byPose, byRig;
};

Ptr<RefractiveCamera> cameraOf(const RigModel& rig, int camera, bool glass)
{
    return glass ? rig.cameras[camera] : copyWithWindow(rig.cameras[camera], GlassWindow());
}

} // namespace

ViewDerivatives differentiateView(const RigModel& rig, const std::vector<Point3d>& objectPoints, const Vec3d& rvec,
                                  const Vec3d& tvec, const std::vector<ImageOfView>& images)
{
    int rows = 0;
    for (const ImageOfView& image : images)
        rows += 2*(int)image.points.size();
    ViewDerivatives view;
    view.predicted.resize(rows);
    view.byPose.resize(rows, 6);
    view.byParameters = MatrixXd::Zero(rows, columnCount(rig));
    int row = 0;
    for (const ImageOfView& image : images)
    {
        const PoseInCamera pose(rig, image.camera, rvec, tvec);
        std::vector<Point3d> object;
        for (int i : image.points)
            object.push_back(objectPoints[i]);
        std::vector<Point2d> pixels;
        Mat jacobian;
        refractiveProjectPoints(object, pose.rvec, pose.tvec, cameraOf(rig, image.camera, image.glass), pixels, noArray(),
                                jacobian);
        const MatrixXd J = toEigen(jacobian);
        const ParameterColumns at = columnsOf(rig, image.camera);
        const int n = (int)J.rows(), own = image.glass ? at.end - at.lens : at.lensCount;
        for (size_t i = 0; i < pixels.size(); i++)
        {
            view.predicted[row + 2*i] = pixels[i].x;
            view.predicted[row + 2*i + 1] = pixels[i].y;
        }
        view.byPose.middleRows(row, n) = J.leftCols(6)*pose.byPose;
        view.byParameters.block(row, at.lens, n, own) = J.middleCols(6, own);
        if (image.camera > 0)
            view.byParameters.block(row, extrinsicsColumn(rig, image.camera), n, 6) = J.leftCols(6)*pose.byRig;
        row += n;
    }
    return view;
}

ImageOfView pointsInImage(const RigModel& rig, const std::vector<Point3d>& objectPoints, const Vec3d& rvec, const Vec3d& tvec,
                          int camera, bool glass)
{
    Vec3d rvecC = rvec, tvecC = tvec;
    poseInCamera(rig, camera, rvecC, tvecC);
    const Rect2d image(Point2d(-0.5, -0.5), Size2d(rig.cameras[camera]->imageSize()));
    std::vector<Point2d> pixels;
    refractiveProjectPoints(objectPoints, rvecC, tvecC, cameraOf(rig, camera, glass), pixels);
    ImageOfView result{camera, glass, {}};
    for (size_t i = 0; i < pixels.size(); i++)
        if (image.contains(pixels[i]))          // false for NaN
            result.points.push_back((int)i);
    return result;
}

//! Columns of one length: rotations and translations are in different units.
static MatrixXd scaled(const MatrixXd& byPose)
{
    const Eigen::RowVectorXd scale = byPose.colwise().norm().cwiseMax(1e-300);
    return byPose.array().rowwise()/scale.array();
}

PoseNullSpace::PoseNullSpace(const MatrixXd& byPose) : qr_(scaled(byPose)) {}

MatrixXd PoseNullSpace::operator()(const MatrixXd& rows) const
{
    // Not as a product: Q has as many columns as the view has rows.
    MatrixXd rotated = rows;
    rotated.applyOnTheLeft(qr_.householderQ().adjoint());
    return rotated.bottomRows(rows.rows() - qr_.cols());
}

MatrixXd covarianceWith(const MatrixXd& covariance, const MatrixXd& byParameters, double sigma)
{
    const MatrixXd CJt = covariance*byParameters.transpose();
    MatrixXd predicted = byParameters*CJt;
    predicted.diagonal().array() += sigma*sigma;
    return covariance - CJt*predicted.ldlt().solve(CJt.transpose());
}

} // namespace tools
