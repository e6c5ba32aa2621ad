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

bool ImageResidual::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const
{
    Camera camera(camera_);
    if (!setCamera(parameters, camera))
        return false;

    const Rotation object(parameters[0]);
    const double still[6] = { 0, 0, 0, 0, 0, 0 };
    const double* extrinsics = extrinsics_ > 0 ? parameters[extrinsics_] : still;
    const Rotation cam2(extrinsics);
    const Vec3d T = vec3(extrinsics + 3);
    const Vec3d normal1 = hasWindow() ? vec3(parameters[normal_]) : Vec3d();
    const Vec3d normal2 = cam2.R*normal1;
    const Matx33d dNormal2 = cam2.derivativeOf(normal1);

    const auto wanted = [&](int block) { return jacobians && block > 0 && jacobians[block]; };
    const bool wantsExtrinsics = wanted(extrinsics_);
    const bool wantsNormal = hasWindow() && wanted(normal_), wantsMedia = hasWindow() && wanted(media_);
    const bool shared = window_ == OF_CAMERA_1;
    const bool wantsParameters = wanted(lens_) || wantsNormal || wantsMedia || (shared && wantsExtrinsics);

    const int lensCount = camera.lensCount(), mediaCount = camera.windowCount() - 3;
    Rows byParameters(2, camera.parameterCount());
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> byPoint;

    for (int i = 0; i < (int)points_.pixel.size(); i++)
    {
        const Vec3d inObject(points_.object[i]);
        const Vec3d inCamera1 = object.R*inObject + vec3(parameters[0] + 3);
        Vec2d pixel;
        if (camera.projectJacobian(cam2.R*inCamera1 + T, pixel, byPoint.data(),
                                   wantsParameters ? byParameters.data() : nullptr) != REFRACT_OK)
            return false;
        residuals[2*i] = pixel[0] - points_.pixel[i].x;
        residuals[2*i + 1] = pixel[1] - points_.pixel[i].y;
        if (!jacobians)
            continue;

        if (jacobians[0])
        {
            RowsMap pose = rowsOf(jacobians[0], i, 6);
            pose.rightCols<3>() = byPoint*eigen(cam2.R);
            pose.leftCols<3>() = pose.rightCols<3>().eval()*eigen(object.derivativeOf(inObject));
        }
        Rows byNormal = byParameters.middleCols(lensCount, 3);
        const Eigen::Vector2d byDistance = byParameters.col(lensCount + 3);
        if (shared && wantsParameters)      // d2 = d1 + n2.T moves with n2
            byNormal += byDistance*Eigen::RowVector3d(T[0], T[1], T[2]);
        if (wantsExtrinsics)
        {
            RowsMap rows = rowsOf(jacobians[extrinsics_], i, 6);
            rows.leftCols<3>() = byPoint*eigen(cam2.derivativeOf(inCamera1));
            rows.rightCols<3>() = byPoint;
            if (shared)
            {
                rows.leftCols<3>() += byNormal*eigen(dNormal2);
                rows.rightCols<3>() += byDistance*Eigen::RowVector3d(normal2[0], normal2[1], normal2[2]);
            }
        }
        if (wanted(lens_))
            rowsOf(jacobians[lens_], i, lensCount) = byParameters.leftCols(lensCount);
        if (wantsNormal)
        {
            if (shared)
                byNormal = byNormal*eigen(cam2.R);
            rowsOf(jacobians[normal_], i, 3) = byNormal;
        }
        if (wantsMedia)
            rowsOf(jacobians[media_], i, mediaCount) = byParameters.middleCols(lensCount + 3, mediaCount);
    }
    return true;
}

}} // namespace
