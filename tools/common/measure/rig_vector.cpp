// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "math/rotation.hpp"
#include "measure/eigen_matrix.hpp"
#include "window/parameters.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

using Eigen::VectorXd;

namespace tools {

namespace {

void put(const Vec3d& values, int first, VectorXd& numbers)
{
    for (int i = 0; i < 3; i++)
        numbers[first + i] = values[i];
}

Vec3d get(const VectorXd& numbers, int first) { return Vec3d(numbers[first], numbers[first + 1], numbers[first + 2]); }

//! The first camera that looks through a camera's window.
int ownerOf(const RigModel& rig, int camera)
{
    int owner = 0;
    while (!rig.sharesWindow(owner, camera))
        owner++;
    return owner;
}

RigidTransform placeOfCamera(const RigModel& rig, int camera, const VectorXd& numbers)
{
    const int at = extrinsicsColumn(rig, camera);
    return camera == 0 ? RigidTransform() : transformOf(get(numbers, at), get(numbers, at + 3));
}

void setLens(RigModel& rig, int camera, const VectorXd& numbers)
{
    const ParameterColumns at = columnsOf(rig, camera);
    rig.cameras[camera]->setLensParameters(toMat(numbers.segment(at.lens, at.lensCount)));
}

void setTargets(RigModel& rig, const VectorXd& numbers)
{
    const int at = columnCount(rig);
    rig.targetScale = numbers[at];
    rig.targetMotion = transformOf(get(numbers, at + 1), get(numbers, at + 4));
}

//! Numbers of a shared window for a camera that does not own it.
VectorXd windowNumbersOf(const RigModel& rig, int owner, int camera, const VectorXd& numbers)
{
    const RigidTransform there = fromTo(placeOfCamera(rig, owner, numbers), placeOfCamera(rig, camera, numbers));
    const GlassWindow shared = withParameters(rig.cameras[owner]->window(), numbers.data() + columnsOf(rig, owner).window);
    const std::vector<double> window = windowParameters(seenFrom(shared, there));
    return VectorXd::Map(window.data(), window.size());
}

/** Pose in a camera in one of its images, and its derivatives (6x6) by the pose in camera 1 and by the rotation vectors and
translations that lie between: the targets' motion, the camera's place. */
struct PoseInImage
{
    PoseInImage(const RigModel& rig, const ImageOfView& image, const Vec3d& rvec1, const Vec3d& tvec1)
        : rvec(rvec1), tvec(tvec1), byPose(MatrixXd::Identity(6, 6)), byMotion(MatrixXd::Zero(6, 6)), byRig(MatrixXd::Zero(6, 6))
    {
        if (image.glass && !rig.targetCovariance.empty())
            follow(rig.targetMotion, byMotion);
        if (image.camera > 0)
            byMotion = product(follow(rig.extrinsics[image.camera], byRig), byMotion);
    }
    Vec3d rvec, tvec;
    MatrixXd byPose, byMotion, byRig;

private:
    //! @param byTransform of the new pose @return its derivatives by the one before
    MatrixXd follow(const RigidTransform& transform, MatrixXd& byTransform)
    {
        const Rotation before(rvec.val), then(rotationVector(transform.R).val);
        rvec = rotationVector(then.R*before.R);
        const Matx33d byTurn = Rotation(rvec.val).rightJacobian().inv();
        const MatrixXd zero = MatrixXd::Zero(3, 3), one = MatrixXd::Identity(3, 3);
        MatrixXd byBefore(6, 6);
        byBefore << toEigen(Mat(byTurn*before.rightJacobian())), zero, zero, toEigen(Mat(then.R));
        byTransform << toEigen(Mat(byTurn*before.R.t()*then.rightJacobian())), zero, toEigen(Mat(then.derivativeOf(tvec))), one;
        tvec = transform.apply(tvec);
        byPose = product(byBefore, byPose);
        return byBefore;
    }
};

//! Rows u, v of each point by the relative scale of the target, from those by the translation in the camera.
VectorXd byScale(const MatrixXd& byTranslation, const std::vector<Point3d>& object, const Matx33d& R)
{
    VectorXd result(byTranslation.rows());
    for (size_t i = 0; i < object.size(); i++)
    {
        const Vec3d X = R*Vec3d(object[i]);
        result.segment<2>(2*i) = byTranslation.middleRows<2>(2*i)*Eigen::Map<const Eigen::Vector3d>(X.val);
    }
    return result;
}

Ptr<RefractiveCamera> cameraOf(const RigModel& rig, int camera, bool glass)
{
    return glass ? rig.cameras[camera] : copyWithWindow(rig.cameras[camera], GlassWindow());
}

} // namespace

int rigVectorSize(const RigModel& rig) { return columnCount(rig) + TARGET_ERRORS; }

VectorXd toVector(const RigModel& rig)
{
    VectorXd numbers(rigVectorSize(rig));
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        numbers.segment(at.lens, at.lensCount) = toEigen(rig.cameras[c]->lensParameters());
        const std::vector<double> window = windowParameters(rig.cameras[c]->window());
        std::copy(window.begin(), window.end(), numbers.data() + at.window);
        if (c == 0)
            continue;
        put(rotationVector(rig.extrinsics[c].R), extrinsicsColumn(rig, c), numbers);
        put(rig.extrinsics[c].t, extrinsicsColumn(rig, c) + 3, numbers);
    }
    const int targets = columnCount(rig);
    numbers[targets] = rig.targetScale;
    put(rotationVector(rig.targetMotion.R), targets + 1, numbers);
    put(rig.targetMotion.t, targets + 4, numbers);
    return numbers;
}

VectorXd parametersOf(const RigModel& rig)
{
    const VectorXd numbers = toVector(rig);
    return rig.targetCovariance.empty() ? VectorXd(numbers.head(columnCount(rig))) : numbers;
}

void setParameters(RigModel& rig, const VectorXd& p)
{
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        setLens(rig, c, p);
        rig.cameras[c]->setWindow(withParameters(rig.cameras[c]->window(), p.data() + columnsOf(rig, c).window));
        if (c > 0)
            rig.extrinsics[c] = placeOfCamera(rig, c, p);
    }
    if (!rig.targetCovariance.empty())
        setTargets(rig, p);
}

RigModel withVector(const RigModel& rig, const VectorXd& numbers)
{
    RigModel result = rig.clone();
    for (int c = 1; c < (int)rig.cameras.size(); c++)
        result.extrinsics[c] = placeOfCamera(rig, c, numbers);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        setLens(result, c, numbers);
        const int owner = ownerOf(rig, c);
        GlassWindow window = withParameters(rig.cameras[c]->window(), numbers.data() + columnsOf(rig, c).window);
        if (owner < c)
            window = seenFrom(result.cameras[owner]->window(), fromTo(result.extrinsics[owner], result.extrinsics[c]));
        window.distance = std::max(0., window.distance);        // between equal media any will do, and 0 is given
        result.cameras[c]->setWindow(window);
    }
    setTargets(result, numbers);
    return result;
}

MatrixXd consistentChanges(const RigModel& rig)
{
    const VectorXd numbers = toVector(rig);
    MatrixXd changes = MatrixXd::Identity(numbers.size(), numbers.size());
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        if (rig.ownsWindow(c))
        {
            for (int column : {at.normal, at.axis})         // unit vectors
                if (at.has(column))
                {
                    const Eigen::Vector3d unit = numbers.segment<3>(column);
                    changes.block<3, 3>(column, column) -= unit*unit.transpose();
                }
            continue;
        }
        // Only the rows of this camera's window, which is a few products of the rest: by differences.
        const double STEP = 1e-6;
        const int owner = ownerOf(rig, c);
        changes.middleRows(at.window, at.end - at.window).setZero();
        std::vector<int> columns;
        for (int i = columnsOf(rig, owner).window; i < columnsOf(rig, owner).end; i++)
            columns.push_back(i);
        for (int camera : {owner, c})
            for (int i = 0; i < 6 && camera > 0; i++)
                columns.push_back(extrinsicsColumn(rig, camera) + i);
        for (int column : columns)
        {
            VectorXd more = numbers, less = numbers;
            more[column] += STEP;
            less[column] -= STEP;
            changes.block(at.window, column, at.end - at.window, 1) =
                (windowNumbersOf(rig, owner, c, more) - windowNumbersOf(rig, owner, c, less))/(2.*STEP);
        }
    }
    return changes;
}

PointDerivatives differentiatePoints(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points,
                                     const Vec3d& rvec, const Vec3d& tvec)
{
    Mat ignored, jacobian;
    refractiveProjectPoints(points, rvec, tvec, camera, ignored, noArray(), jacobian);
    const Eigen::MatrixXd J = toEigen(jacobian);
    return {J.leftCols(6), J.rightCols(J.cols() - 6)};
}

ImageDerivatives differentiateImage(const RigModel& rig, const std::vector<Point3d>& objectPoints, const Vec3d& rvec, const Vec3d& tvec,
                                    const ImageOfView& image)
{
    const bool hasTargetErrors = !rig.targetCovariance.empty();
    const ParameterColumns at = columnsOf(rig, image.camera);
    const int own = image.glass ? at.end - at.lens : at.lensCount;
    ImageDerivatives result;
    const auto addColumns = [&](int first, int count) {
        for (int i = 0; i < count; i++)
            result.columns.push_back(first + i); };
    addColumns(at.lens, own);
    if (image.camera > 0)
        addColumns(extrinsicsColumn(rig, image.camera), 6);
    if (hasTargetErrors)
        addColumns(columnCount(rig), TARGET_ERRORS);
    const PoseInImage pose(rig, image, rvec, tvec);
    std::vector<Point3d> given;
    for (int i : image.points)
        given.push_back(objectPoints[i]);
    std::vector<Point2d> pixels;
    Mat jacobian;
    refractiveProjectPoints(pointsOfTarget(rig, given), pose.rvec, pose.tvec, cameraOf(rig, image.camera, image.glass), pixels, noArray(),
                            jacobian);
    const MatrixXd J = toEigen(jacobian);
    const Eigen::Index n = J.rows();
    result.predicted.resize(n);
    for (size_t i = 0; i < pixels.size(); i++)
        result.predicted.segment<2>(2*i) << pixels[i].x, pixels[i].y;
    result.byPose = product(J.leftCols(6), pose.byPose);
    result.byParameters.resize(n, result.columns.size());
    result.byParameters.leftCols(own) = J.middleCols(6, own);
    if (image.camera > 0)
        result.byParameters.middleCols(own, 6) = product(J.leftCols(6), pose.byRig);
    if (hasTargetErrors)
    {
        result.byParameters.col(result.byParameters.cols() - TARGET_ERRORS) = byScale(J.middleCols(3, 3), given, rotationMatrix(pose.rvec));
        result.byParameters.rightCols(6) = product(J.leftCols(6), pose.byMotion);
    }
    return result;
}

ViewDerivatives differentiateView(const RigModel& rig, const std::vector<Point3d>& objectPoints, const Vec3d& rvec,
                                  const Vec3d& tvec, const std::vector<ImageOfView>& images)
{
    int rows = 0;
    for (const ImageOfView& image : images)
        rows += 2*(int)image.points.size();
    ViewDerivatives view;
    view.predicted.resize(rows);
    view.byPose.resize(rows, 6);
    view.byParameters = MatrixXd::Zero(rows, columnCount(rig) + (rig.targetCovariance.empty() ? 0 : TARGET_ERRORS));
    Eigen::Index row = 0;
    for (const ImageOfView& image : images)
    {
        const ImageDerivatives own = differentiateImage(rig, objectPoints, rvec, tvec, image);
        const Eigen::Index n = own.predicted.size();
        view.predicted.segment(row, n) = own.predicted;
        view.byPose.middleRows(row, n) = own.byPose;
        for (size_t i = 0; i < own.columns.size(); i++)
            view.byParameters.block(row, own.columns[i], n, 1) = own.byParameters.col(i);
        row += n;
    }
    return view;
}

ImageOfView pointsInImage(const RigModel& rig, const std::vector<Point3d>& objectPoints, const Vec3d& rvec, const Vec3d& tvec,
                          int camera, bool glass)
{
    Vec3d rvecC = rvec, tvecC = tvec;
    poseInImage(rig, camera, glass, rvecC, tvecC);
    const Rect2d image(Point2d(-0.5, -0.5), Size2d(rig.cameras[camera]->imageSize()));
    std::vector<Point2d> pixels;
    refractiveProjectPoints(pointsOfTarget(rig, objectPoints), rvecC, tvecC, cameraOf(rig, camera, glass), pixels);
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

PoseNullSpace::PoseNullSpace(const MatrixXd& byPose) : qr_(scaled(byPose)), columns_(byPose.cols()) {}

MatrixXd PoseNullSpace::operator()(const MatrixXd& rows) const
{
    return qr_.rotate(rows).bottomRows(rows.rows() - columns_);
}

MatrixXd covarianceWith(const MatrixXd& covariance, const MatrixXd& byParameters, double sigma)
{
    const MatrixXd CJt = timesTranspose(covariance, byParameters);
    MatrixXd predicted = product(byParameters, CJt);
    predicted.diagonal().array() += sigma*sigma;
    return covariance - product(CJt, LDLT(predicted).solveTranspose(CJt));
}

} // namespace tools
