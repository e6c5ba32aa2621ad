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
                             const Kind& kind)
    : camera_(camera), points_(points), rootWeights_(rootWeights), refracted_(kind.refracted)
{
    const auto addBlock = [&](bool exists, int size)
    {
        if (exists)
            sizes_.push_back(size);
        return exists ? (int)sizes_.size() - 1 : -1;
    };
    addBlock(true, 6);
    extrinsics_ = addBlock(!kind.isCamera1, 6);
    lens_ = addBlock(true, camera.lensCount());
    normal_ = addBlock(kind.refracted, 3);
    media_ = addBlock(kind.refracted, camera.mediaCount());
    owner_ = addBlock(kind.refracted && camera.window && !kind.ownerIsCamera1, 6);
}

//! One point on its way, and the derivatives of its weighted pixel.
struct ImageResidual::Point
{
    Vec3d inObject, inCamera1;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> byPoint;
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> byParameters;
};

//! The rows of point i in every jacobian that is wanted.
void ImageResidual::writeJacobians(const Rotation& object, const Point& point, int i, double** jacobians) const
{
    const auto wanted = [&](int block) { return block >= 0 && jacobians[block]; };
    if (wanted(0))
    {
        RowsMap<6> pose = rowsOf<6>(jacobians[0], i);
        pose.rightCols<3>() = point.byPoint*eigen(camera_.extrinsics.rotation.R);
        pose.leftCols<3>() = pose.rightCols<3>().eval()*eigen(object.derivativeOf(point.inObject));
    }
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

    Eigen::Matrix<double, 2, 4> byWindow = point.byParameters.middleCols<4>(lensCount + camera_.at().normal);     // and distance
    if (camera_.window)
    {
        if (wanted(extrinsics_))
            rowsOf<6>(jacobians[extrinsics_], i) += byWindow*camera_.window->byCamera;
        if (wanted(owner_))
            rowsOf<6>(jacobians[owner_], i) = byWindow*camera_.window->byOwner;
        byWindow *= camera_.window->byWindow;
    }
    if (wanted(normal_))
        rowsOf<3>(jacobians[normal_], i) = byWindow.leftCols<3>();
    if (!wanted(media_))
        return;
    const int mediaCount = sizes_[media_];
    RowsMap<Eigen::Dynamic> media = rowsOf<Eigen::Dynamic>(jacobians[media_], i, mediaCount);
    const WindowLayout& at = camera_.at();
    media = point.byParameters.middleCols(lensCount + at.media, mediaCount);
    media.col(at.distance - at.media) = byWindow.col(3);
}

bool ImageResidual::linearize(const Camera& camera, const double* pose, double* residuals, double** jacobians) const
{
    const Rotation object(pose);
    const Vec3d t(pose + 3);
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
        placePoints(object.R, t, begin, n, x, y, z, status);
        camera.projectJacobian(n, x, y, z, u, v, byPoint, byParameter, status);
        for (int k = 0; k < n; k++)
        {
            const int i = begin + k;
            const bool hasImage = writeResidual(i, u[k], v[k], status[k], residuals);
            areAll = areAll && hasImage;
            const double w = hasImage ? rootWeights_[i] : 0;
            point.inObject = points_.object[i];
            point.inCamera1 = object.R*point.inObject + t;
            for (int r = 0; r < 2; r++)
            {
                for (int c = 0; c < 3; c++)
                    point.byPoint(r, c) = w == 0 ? 0 : w*byPoint.at(r, c)[k];
                for (int c = 0; c < count && byParameters; c++)
                    point.byParameters(r, c) = w == 0 ? 0 : w*byParameter.at(r, c)[k];
            }
            writeJacobians(object, point, i, jacobians);
        }
    }
    return areAll;
}

//! Points begin ... begin + n - 1 in the camera's frame.
void ImageResidual::placePoints(const Matx33d& R1, const Vec3d& t1, int begin, int n, double* x, double* y, double* z,
                                uchar* status) const
{
    const TransformWithDerivatives& toCamera = camera_.extrinsics;
    const Matx33d R = toCamera.rotation.R*R1;
    const Vec3d t = toCamera.apply(t1);
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
    residuals[2*i] = w == 0 ? 0 : hasImage ? w*(u - points_.pixel[i].x) : std::numeric_limits<double>::infinity();
    residuals[2*i + 1] = w == 0 ? 0 : hasImage ? w*(v - points_.pixel[i].y) : std::numeric_limits<double>::infinity();
    return hasImage;
}

bool ImageResidual::project(const Camera& camera, const double* pose, double* residuals) const
{
    const Matx33d R = Rotation(pose).R;
    double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
    uchar status[BLOCK];
    bool areAll = true;
    for (int begin = 0; begin < (int)points_.pixel.size(); begin += BLOCK)
    {
        const int n = std::min(BLOCK, (int)points_.pixel.size() - begin);
        placePoints(R, Vec3d(pose + 3), begin, n, x, y, z, status);
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
