// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/residual.hpp"
#include "arrays/arrays.hpp"

namespace cv { namespace refract {

namespace {

template<int Columns>
using RowsMap = Eigen::Map<Eigen::Matrix<double, 2, Columns, Eigen::RowMajor>, 0, Eigen::OuterStride<> >;
typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Matrix3Map;

//! The two rows that point i fills in the jacobian of one block.
template<int Columns>
RowsMap<Columns> rowsOf(double* jacobian, int i, int size = Columns)
{ return RowsMap<Columns>(jacobian + (size_t)2*i*size, 2, size, Eigen::OuterStride<>(size)); }

Matrix3Map eigen(const Matx33d& m) { return Matrix3Map(m.val); }

} // namespace

ImageResidual::ImageResidual(const RigCamera& camera, const ImagePoints& points, const std::vector<double>& rootWeights,
                             const Kind& kind, const SharedTargetErrors& targetErrors)
    : camera_(camera), points_(points), rootWeights_(rootWeights), targetErrors_(targetErrors), refracted_(kind.refracted)
{
    const auto addBlock = [&](bool exists, int size)
    {
        if (exists)
            sizes_.push_back(size);
        return exists ? (int)sizes_.size() - 1 : -1;
    };
    addBlock(true, 6);
    targets_ = addBlock(kind.hasTargetErrors, SharedTargetErrors::COUNT);
    extrinsics_ = addBlock(!kind.isCamera1, 6);
    lens_ = addBlock(true, camera.lensCount());
    place_ = addBlock(kind.refracted, camera.placeCount());
    media_ = addBlock(kind.refracted, camera.mediaCount());
    owner_ = addBlock(kind.refracted && camera.window && !kind.ownerIsCamera1, 6);
}

//! Where the target is in this image.
struct ImageResidual::Target
{
    Target(const double* pose, const SharedTargetErrors& errors, bool refracted)
        : rotation(pose), t(pose + 3), placed(errors.place(rotation.R, t, refracted)),
          motion(refracted ? errors.rotation.R : Matx33d::eye()) {}
    Rotation rotation;              //!< object -> camera 1 in the direct images
    Vec3d t;
    SimilarityTransform placed;     //!< object -> camera 1 in this one
    Matx33d motion;
};

//! One point on its way, and the derivatives of its weighted pixel.
struct ImageResidual::Point
{
    Vec3d inObject, inCamera1;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> byPoint;
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> byParameters, byOwnersWindow;

    void whiten(const Whitening& W)
    {
        for (int c = 0; c < 3; c++)
            W.apply(byPoint(0, c), byPoint(1, c));
        for (int c = 0; c < (int)byParameters.cols(); c++)
            W.apply(byParameters(0, c), byParameters(1, c));
    }
};

//! The rows of point i in every jacobian that is wanted.
void ImageResidual::writeJacobians(const Target& target, Point& point, int i, double** jacobians) const
{
    const auto wanted = [&](int block) { return block >= 0 && jacobians[block]; };
    if (wanted(0))
    {
        RowsMap<6> pose = rowsOf<6>(jacobians[0], i);
        pose.rightCols<3>() = point.byPoint*eigen(camera_.extrinsics.rotation.R*target.motion);
        pose.leftCols<3>() = pose.rightCols<3>().eval()*eigen(target.rotation.derivativeOf(point.inObject*targetErrors_.scale));
    }
    if (wanted(targets_))
        writeTargetErrors(target, point, jacobians[targets_] + (size_t)2*i*SharedTargetErrors::COUNT);
    if (wanted(extrinsics_))
    {
        RowsMap<6> rows = rowsOf<6>(jacobians[extrinsics_], i);
        rows.leftCols<3>() = point.byPoint*eigen(camera_.extrinsics.rotation.derivativeOf(point.inCamera1));
        rows.rightCols<3>() = point.byPoint;
    }
    const int lensCount = sizes_[lens_];
    if (wanted(lens_))
        rowsOf<Eigen::Dynamic>(jacobians[lens_], i, lensCount) = point.byParameters.leftCols(lensCount);
    if (!refracted_)
        return;

    const WindowLayout& at = camera_.at();
    auto byWindow = point.byParameters.middleCols(lensCount, at.count);
    if (camera_.window)
    {
        if (wanted(extrinsics_))
            rowsOf<6>(jacobians[extrinsics_], i) += byWindow.lazyProduct(camera_.window->byCamera);
        if (wanted(owner_))
            rowsOf<6>(jacobians[owner_], i) = byWindow.lazyProduct(camera_.window->byOwner);
        point.byOwnersWindow.noalias() = byWindow.lazyProduct(camera_.window->byWindow);
        byWindow = point.byOwnersWindow;
    }
    if (wanted(place_))
        rowsOf<Eigen::Dynamic>(jacobians[place_], i, sizes_[place_]) = byWindow.middleCols(at.normal, sizes_[place_]);
    if (wanted(media_))
        rowsOf<Eigen::Dynamic>(jacobians[media_], i, sizes_[media_]) = byWindow.middleCols(at.media, sizes_[media_]);
}

void ImageResidual::writeTargetErrors(const Target& target, const Point& point, double* jacobian) const
{
    RowsMap<SharedTargetErrors::COUNT> rows = rowsOf<SharedTargetErrors::COUNT>(jacobian, 0);
    const Eigen::Matrix<double, 2, 3> byCamera1 = point.byPoint*eigen(camera_.extrinsics.rotation.R);
    const Vec3d turned = target.rotation.R*point.inObject, byScale = target.motion*turned;
    rows.setZero();
    rows.col(0) = byCamera1*Eigen::Map<const Eigen::Vector3d>(byScale.val);
    if (!refracted_)
        return;
    const Vec3d direct = turned*targetErrors_.scale + target.t;
    rows.middleCols<3>(1) = byCamera1*eigen(targetErrors_.rotation.derivativeOf(direct));
    rows.rightCols<3>() = byCamera1;
}

bool ImageResidual::linearize(const Camera& camera, const double* pose, double* residuals, double** jacobians) const
{
    const Target target(pose, targetErrors_, refracted_);
    // Known windows and lenses do without the derivatives by camera parameters.
    const bool byParameters = std::any_of(jacobians + lens_, jacobians + sizes_.size(),
                                          [](const double* jacobian) { return jacobian != nullptr; }) ||
                              (camera_.window && extrinsics_ >= 0 && jacobians[extrinsics_]);
    const int SMALL = 32, count = camera.parameterCount();      // so many points' derivatives stay in the cache
    AutoBuffer<double, 2*32*SMALL> buffer(2*(3 + count)*SMALL);
    const Columns byPoint = { buffer.data(), 3, SMALL };
    const Columns byParameter = { byParameters ? buffer.data() + 6*SMALL : nullptr, count, SMALL };
    double x[SMALL], y[SMALL], z[SMALL], u[SMALL], v[SMALL];
    uchar status[SMALL];
    Point point;
    point.byParameters.setZero(2, count);
    bool areAll = true;
    for (int begin = 0; begin < (int)points_.pixel.size(); begin += SMALL)
    {
        const int n = std::min(SMALL, (int)points_.pixel.size() - begin);
        placePoints(target.placed, begin, n, x, y, z, status);
        camera.projectJacobian(n, x, y, z, u, v, byPoint, byParameter, status);
        for (int k = 0; k < n; k++)
        {
            const int i = begin + k;
            const bool hasImage = writeResidual(i, u[k], v[k], status[k], residuals);
            areAll = areAll && hasImage;
            const double w = hasImage ? rootWeights_[i] : 0;
            point.inObject = points_.object[i];
            point.inCamera1 = target.placed.apply(point.inObject);
            for (int r = 0; r < 2; r++)
            {
                for (int c = 0; c < 3; c++)
                    point.byPoint(r, c) = w == 0 ? 0 : w*byPoint.at(r, c)[k];
                for (int c = 0; c < count && byParameters; c++)
                    point.byParameters(r, c) = w == 0 ? 0 : w*byParameter.at(r, c)[k];
            }
            if (!points_.whitening.empty())
                point.whiten(points_.whitening[i]);
            writeJacobians(target, point, i, jacobians);
        }
    }
    return areAll;
}

//! Points begin ... begin + n - 1 in the camera's frame.
void ImageResidual::placePoints(const SimilarityTransform& placed, int begin, int n, double* x, double* y, double* z,
                                uchar* status) const
{
    const TransformWithDerivatives& toCamera = camera_.extrinsics;
    const Matx33d R = toCamera.rotation.R*placed.A;
    const Vec3d t = toCamera.apply(placed.t);
    for (int k = 0; k < n; k++)
    {
        const Vec3d X = R*Vec3d(points_.object[begin + k]) + t;
        x[k] = X[0]; y[k] = X[1]; z[k] = X[2];
        status[k] = REFRACT_OK;
    }
}

//! False if the point has a weight and no image.
bool ImageResidual::writeResidual(int i, double u, double v, uchar status, double* residuals) const
{
    const double w = rootWeights_[i];
    const bool hasImage = w == 0 || status == REFRACT_OK;
    const Vec2d error = hasImage ? points_.error(i, u, v) : Vec2d::all(std::numeric_limits<double>::infinity());
    for (int k = 0; k < 2; k++)
        residuals[2*i + k] = w == 0 ? 0 : w*error[k];
    return hasImage;
}

bool ImageResidual::project(const Camera& camera, const double* pose, double* residuals) const
{
    const SimilarityTransform placed = targetErrors_.place(rotationMatrix(Vec3d(pose)), Vec3d(pose + 3), refracted_);
    double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
    uchar status[BLOCK];
    bool areAll = true;
    for (int begin = 0; begin < (int)points_.pixel.size(); begin += BLOCK)
    {
        const int n = std::min(BLOCK, (int)points_.pixel.size() - begin);
        placePoints(placed, begin, n, x, y, z, status);
        camera.project(n, x, y, z, nullptr, u, v, status);
        for (int k = 0; k < n; k++)
            areAll = writeResidual(begin + k, u[k], v[k], status[k], residuals) && areAll;
    }
    return areAll;
}

bool ImageResidual::evaluate(const double* pose, double* residuals, double** jacobians) const
{
    const Camera* camera = camera_.camera(refracted_);
    if (!camera)
    {
        std::fill(residuals, residuals + count(), std::numeric_limits<double>::infinity());
        return false;
    }
    return jacobians ? linearize(*camera, pose, residuals, jacobians) : project(*camera, pose, residuals);
}

}} // namespace
