// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/rig_problem.hpp"
#include <ceres/sphere_manifold.h>

namespace cv { namespace refract {

Eigen::MatrixXd RigBlock::tangentBasis(bool withHeld) const
{
    const int size = (int)values.size();
    if (kind == NORMAL && isFree[0])
    {
        Eigen::Matrix<double, 3, 2, Eigen::RowMajor> basis;
        ceres::SphereManifold<3>().PlusJacobian(values.data(), basis.data());
        return basis.colwise().normalized();    // radians; Ceres' scale differs between versions
    }
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size, size);
    int column = 0;
    for (int i = 0; i < size; i++)
        if (isFree[i] && (withHeld || !isHeld[i]))
            basis(i, column++) = 1;
    return basis.leftCols(column);
}

Eigen::VectorXd RigProblem::residuals(const RigImage& image) const
{
    Derivatives result;
    CV_Assert(evaluate(image, false, result));
    return result.residuals;
}

std::vector<double> RigProblem::pixelErrors(const RigImage& image, const Pose& pose) const
{
    const Camera* camera = cameras_[image.camera].camera(image.refracted);
    if (!camera)
        return std::vector<double>(image.points.pixel.size(), std::numeric_limits<double>::infinity());
    const Extrinsics& toCamera = cameras_[image.camera].extrinsics;
    const Extrinsics toCamera1(pose);
    std::vector<double> errors;
    for (size_t i = 0; i < image.points.pixel.size(); i++)
    {
        const Vec3d X = toCamera.apply(toCamera1.apply(Vec3d(image.points.object[i])));
        Point2d pixel;
        uchar status = REFRACT_OK;
        camera->project(1, &X[0], &X[1], &X[2], nullptr, &pixel.x, &pixel.y, &status);
        errors.push_back(status == REFRACT_OK ? norm(pixel - image.points.pixel[i]) :
                         std::numeric_limits<double>::infinity());
    }
    return errors;
}

double RigProblem::squaredError() const
{
    double sum = 0;
    for (const RigImage& image : images_)
        sum += residuals(image).squaredNorm();
    for (int view = 0; view < viewCount(); view++)
        if (isUncertain(view))
            sum += priorOfPose(view).squaredNorm();
    for (int block = 0; block < (int)blocks_.size(); block++)
        sum += priorOfBlock(block).squaredNorm();
    return sum;
}

Vector6 RigProblem::priorOfPose(int view) const
{
    typedef Eigen::Map<const Vector6> Map6;
    return priorByPose(view)*(Map6(poses_[view].data()) - Map6(knownPoses_[view].data()));
}

Eigen::VectorXd RigProblem::priorOfBlock(int block) const
{
    return priorByBlock(block)*(blocks_[block].values - blocks_[block].known);
}

bool RigProblem::evaluate(const RigImage& image, bool wantsDerivatives, Derivatives& result) const
{
    const std::unique_ptr<ceres::CostFunction> cost(makeCost(image));
    const std::vector<const double*> pose(1, poses_[image.view].data());    // the cameras hold the rest
    result.residuals.resize(cost->num_residuals());
    if (!wantsDerivatives)
        return cost->Evaluate(pose.data(), result.residuals.data(), nullptr);
    result.blocks = blocksOf(image);
    result.byBlock.resize(result.blocks.size());
    result.byPose.resize(cost->num_residuals(), 6);
    std::vector<double*> jacobians(1, result.byPose.data());
    for (size_t i = 0; i < result.blocks.size(); i++)
    {
        result.byBlock[i].resize(cost->num_residuals(), blocks_[result.blocks[i]].values.size());
        jacobians.push_back(result.byBlock[i].data());
    }
    return cost->Evaluate(pose.data(), result.residuals.data(), jacobians.data());
}

RigProblem::Derivatives RigProblem::derivatives(const RigImage& image) const
{
    Derivatives result;
    CV_Assert(evaluate(image, true, result));
    if (!isAdjusted(image.view))
        result.byPose.setZero();
    return result;
}

int RigProblem::publicCount() const
{
    return publicRow(RigBlock::EXTRINSICS, rig_.count());
}

//! The first row of a block. A window has rows in every camera that looks through it.
int RigProblem::publicRow(RigBlock::Kind kind, int camera) const
{
    int row = 0;
    if (kind == RigBlock::EXTRINSICS)
    {
        for (const Camera& c : rig_.cameras)
            row += c.parameterCount();
        return row + 6*(camera - 1);
    }
    for (int c = 0; c < camera; c++)
        row += rig_.cameras[c].parameterCount();
    const Camera& at = rig_.cameras[camera];
    return row + (kind == RigBlock::LENS ? 0 : at.lensCount() + (kind == RigBlock::NORMAL ? at.layers().at().normal
                                                                                          : at.layers().at().media));
}

Eigen::MatrixXd RigProblem::publicBasis() const
{
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(publicCount(), freeCount());
    int column = 0;
    for (const RigBlock& block : blocks_)
    {
        const Eigen::MatrixXd tangent = block.tangentBasis();
        basis.block(publicRow(block.kind, block.camera), column, tangent.rows(), tangent.cols()) = tangent;
        column += (int)tangent.cols();
    }
    for (int c = 0; c < rig_.count(); c++)
        if (!rig_.owns(c))
            addSharedWindow(c, basis);
    return basis;
}

//! The rows of a window in a camera that does not own it.
void RigProblem::addSharedWindow(int camera, Eigen::MatrixXd& basis) const
{
    const int owner = rig_.owner[camera], row = publicRow(RigBlock::NORMAL, camera);
    const int ownerRow = publicRow(RigBlock::NORMAL, owner);
    const WindowTransfer& window = *cameras_[camera].window;
    Eigen::MatrixXd rows = window.byWindow*basis.middleRows<4>(ownerRow);
    if (camera > 0)
        rows += window.byCamera*basis.middleRows<6>(publicRow(RigBlock::EXTRINSICS, camera));
    if (owner > 0)
        rows += window.byOwner*basis.middleRows<6>(publicRow(RigBlock::EXTRINSICS, owner));
    basis.middleRows<4>(row) = rows;
    const WindowLayout& at = rig_.cameras[camera].layers().at();
    const int rest = at.thickness - at.normal, others = at.count - at.thickness;
    basis.middleRows(row + rest, others) = basis.middleRows(ownerRow + rest, others).eval();
}

}} // namespace
