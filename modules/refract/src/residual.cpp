// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "residual.hpp"
#include "rotation.hpp"
#include <Eigen/Core>

namespace cv { namespace refract {

namespace {

typedef Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> Rows;
typedef Eigen::Map<Rows, 0, Eigen::OuterStride<> > RowsMap;
typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Matrix3Map;

Vec3d vec3(const double* v) { return Vec3d(v[0], v[1], v[2]); }

//! The two rows that point i fills in the jacobian of one block.
RowsMap rowsOf(double* jacobian, int i, int size)
{ return RowsMap(jacobian + (size_t)2*i*size, 2, size, Eigen::OuterStride<>(size)); }

Matrix3Map eigen(const Matx33d& m) { return Matrix3Map(m.val); }

Eigen::RowVector3d row(const Vec3d& v) { return Eigen::RowVector3d(v[0], v[1], v[2]); }

} // namespace

Rotation::Rotation(const double* rvec)
{
    R = rotationMatrix(vec3(rvec), dR);
}

Matx33d Rotation::derivativeOf(const Vec3d& v) const
{
    Matx33d d;
    for (int i = 0; i < 3; i++)
    {
        const Vec3d column = dR[i]*v;
        for (int k = 0; k < 3; k++)
            d(k, i) = column[k];
    }
    return d;
}

void windowInCamera2(const Matx33d& R, const Vec3d& T, Vec3d& normal, double& distance)
{
    normal = R*normal;
    distance += normal.dot(T);
}

ImageResidual::ImageResidual(const Camera& camera, const ImagePoints& points, bool isCamera2, Window window)
    : camera_(camera), points_(points), window_(window), extrinsics_(isCamera2 ? 1 : -1),
      lens_(isCamera2 ? 2 : 1), normal_(lens_ + 1), media_(lens_ + 2)
{
    CV_Assert(isCamera2 || window != OF_CAMERA_1);
    set_num_residuals(2*(int)points.pixel.size());
    std::vector<int32_t>& sizes = *mutable_parameter_block_sizes();
    sizes.assign(isCamera2 ? 2 : 1, 6);
    sizes.push_back(camera.lensCount());
    if (hasWindow())
    {
        sizes.push_back(3);
        sizes.push_back(camera.windowCount() - 3);
    }
}

ceres::CostFunction* ImageResidual::Create(const Camera& camera, const ImagePoints& points, bool isCamera2,
                                           Window window)
{
    return new ImageResidual(camera, points, isCamera2, window);
}

bool ImageResidual::setCamera(double const* const* parameters, Camera& camera) const
{
    const double* lens = parameters[lens_];
    if (!(lens[0] > 0 && lens[1] > 0))      // a trial step may leave the focal lengths' domain
        return false;
    std::vector<double> all(lens, lens + camera.lensCount());
    if (hasWindow())
    {
        Vec3d normal = vec3(parameters[normal_]);
        const double* media = parameters[media_];
        double distance = media[0];
        if (window_ == OF_CAMERA_1)
        {
            windowInCamera2(Rotation(parameters[extrinsics_]).R, vec3(parameters[extrinsics_] + 3), normal, distance);
            // With equal media the distance has no effect, and need not be known well enough to be positive here.
            const int last = camera.windowCount() - 4;
            if (media[last] == media[last - 1])
                distance = std::max(distance, 0.);
        }
        if (!(normal[2] > 0 && distance >= 0))
            return false;
        all.insert(all.end(), normal.val, normal.val + 3);
        all.push_back(distance);
        all.insert(all.end(), media + 1, media + camera.windowCount() - 3);
    }
    else
    {
        const double none[] = { 0, 0, 1, 0, 1, 1 };
        camera.setWindow(GlassWindow());
        all.insert(all.end(), none, none + 6);
    }
    camera.setParameters(all);
    return true;
}

//! The path from the object to the camera.
struct ImageResidual::Frames
{
    Frames(const double* pose, const double* extrinsics, const double* normal)
        : object(pose), camera2(extrinsics), tPose(vec3(pose + 3)), T(vec3(extrinsics + 3)), normal1(vec3(normal)) {}
    const Rotation object, camera2;
    const Vec3d tPose, T, normal1;      //!< the normal in the frame that its block is in
};

//! One point on its way, and the derivatives of its pixel.
struct ImageResidual::Point
{
    Vec3d inObject, inCamera1;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> byPoint;
    Rows byParameters;
};

//! The rows of point i in every jacobian that is wanted.
void ImageResidual::writeJacobians(const Frames& frames, Point& point, int i, double** jacobians) const
{
    const int lensCount = camera_.lensCount(), mediaCount = camera_.windowCount() - 3;
    const auto wanted = [&](int block) { return block >= 0 && jacobians[block]; };
    if (wanted(0))
    {
        RowsMap pose = rowsOf(jacobians[0], i, 6);
        pose.rightCols<3>() = point.byPoint*eigen(frames.camera2.R);
        pose.leftCols<3>() = pose.rightCols<3>().eval()*eigen(frames.object.derivativeOf(point.inObject));
    }
    if (wanted(extrinsics_))
    {
        RowsMap rows = rowsOf(jacobians[extrinsics_], i, 6);
        rows.leftCols<3>() = point.byPoint*eigen(frames.camera2.derivativeOf(point.inCamera1));
        rows.rightCols<3>() = point.byPoint;
    }
    if (wanted(lens_))
        rowsOf(jacobians[lens_], i, lensCount) = point.byParameters.leftCols(lensCount);
    if (!hasWindow())
        return;

    Rows byNormal = point.byParameters.middleCols(lensCount, 3);
    if (window_ == OF_CAMERA_1)
    {
        const Eigen::Vector2d byDistance = point.byParameters.col(lensCount + 3);
        byNormal += byDistance*row(frames.T);       // d2 = d1 + n2.T moves with n2 = R n1
        if (wanted(extrinsics_))
        {
            RowsMap rows = rowsOf(jacobians[extrinsics_], i, 6);
            rows.leftCols<3>() += byNormal*eigen(frames.camera2.derivativeOf(frames.normal1));
            rows.rightCols<3>() += byDistance*row(frames.camera2.R*frames.normal1);
        }
        byNormal = byNormal*eigen(frames.camera2.R);
    }
    if (wanted(normal_))
        rowsOf(jacobians[normal_], i, 3) = byNormal;
    if (wanted(media_))
        rowsOf(jacobians[media_], i, mediaCount) = point.byParameters.middleCols(lensCount + 3, mediaCount);
}

bool ImageResidual::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const
{
    Camera camera(camera_);
    if (!setCamera(parameters, camera))
        return false;
    const double nothing[6] = { 0, 0, 0, 0, 0, 0 };
    const Frames frames(parameters[0], extrinsics_ > 0 ? parameters[extrinsics_] : nothing,
                        hasWindow() ? parameters[normal_] : nothing);

    // A pose alone (solvePose) does without the derivatives by camera parameters.
    const bool byParameters = jacobians && std::any_of(jacobians + 1, jacobians + parameter_block_sizes().size(),
                                                       [](const double* jacobian) { return jacobian != nullptr; });
    Point point;
    point.byParameters = Rows::Zero(2, camera.parameterCount());
    for (int i = 0; i < (int)points_.pixel.size(); i++)
    {
        point.inObject = points_.object[i];
        point.inCamera1 = frames.object.R*point.inObject + frames.tPose;
        Vec2d pixel;
        if (camera.projectJacobian(frames.camera2.R*point.inCamera1 + frames.T, pixel, point.byPoint.data(),
                                   byParameters ? point.byParameters.data() : nullptr) != REFRACT_OK)
            return false;
        residuals[2*i] = pixel[0] - points_.pixel[i].x;
        residuals[2*i + 1] = pixel[1] - points_.pixel[i].y;
        if (jacobians)
            writeJacobians(frames, point, i, jacobians);
    }
    return true;
}

}} // namespace
