// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "rig_problem.hpp"
#include <ceres/sphere_manifold.h>

namespace cv { namespace refract {

Eigen::MatrixXd RigBlock::tangentBasis() const
{
    const int size = (int)values.size();
    if (kind == NORMAL)
    {
        Eigen::Matrix<double, 3, 2, Eigen::RowMajor> basis;
        ceres::SphereManifold<3>().PlusJacobian(values.data(), basis.data());
        return basis.colwise().normalized();    // radians; Ceres' scale differs between versions
    }
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size, std::count(isFree.begin(), isFree.end(), true));
    for (int i = 0, column = 0; i < size; i++)
        if (isFree[i])
            basis(i, column++) = 1;
    return basis;
}

String RigBlock::nameOf(int coordinate) const
{
    static const char* const LENS_NAMES[] = { "fx", "fy", "cx", "cy" };
    const int layers = ((int)values.size() - 3)/2, layer = coordinate - 1;
    switch (kind)
    {
    case LENS:
        return coordinate < 4 ? String(LENS_NAMES[coordinate]) : format("distortion coefficient %d", coordinate - 4);
    case NORMAL:
        return "normal";
    case EXTRINSICS:
        return coordinate < 3 ? "R" : "T";
    case MEDIA:
        break;
    }
    if (layer < 0)
        return "distance";
    if (layer < 2*layers)
        return layer < layers ? format("thickness[%d]", layer) : format("index[%d]", layer - layers);
    return layer == 2*layers ? "innerIndex" : "outerIndex";
}

std::vector<const double*> RigProblem::valuesOf(const RigImage& image) const
{
    std::vector<const double*> values(1, poses_[image.view].data());
    for (int i : blocksOf(image))
        values.push_back(blocks_[i].values.data());
    return values;
}

double RigProblem::squaredError(const RigImage& image) const
{
    const std::unique_ptr<ceres::CostFunction> cost(makeCost(image));
    Eigen::VectorXd residuals(cost->num_residuals());
    CV_Assert(cost->Evaluate(valuesOf(image).data(), residuals.data(), nullptr));
    return residuals.squaredNorm();
}

double RigProblem::squaredError() const
{
    double sum = 0;
    for (const RigImage& image : images_)
        sum += squaredError(image);
    return sum;
}

RigProblem::Derivatives RigProblem::derivatives(const RigImage& image) const
{
    const std::unique_ptr<ceres::CostFunction> cost(makeCost(image));
    Derivatives result;
    result.blocks = blocksOf(image);
    result.byPose.resize(cost->num_residuals(), 6);
    std::vector<double*> jacobians(1, result.byPose.data());
    for (int i : result.blocks)
        result.byBlock.push_back(RowMajorMatrix(cost->num_residuals(), blocks_[i].values.size()));
    for (RowMajorMatrix& byBlock : result.byBlock)
        jacobians.push_back(byBlock.data());
    result.residuals.resize(cost->num_residuals());
    CV_Assert(cost->Evaluate(valuesOf(image).data(), result.residuals.data(), jacobians.data()));
    return result;
}

int RigProblem::publicCount() const
{
    int count = isStereo() ? 6 : 0;
    for (const Camera& camera : cameras_)
        count += camera.parameterCount();
    return count;
}

Eigen::MatrixXd RigProblem::publicBasis() const
{
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(publicCount(), freeCount());
    int column = 0;
    for (const RigBlock& block : blocks_)
    {
        const Eigen::MatrixXd tangent = block.tangentBasis();
        basis.block(publicRow(block), column, tangent.rows(), tangent.cols()) = tangent;
        column += (int)tangent.cols();
    }
    if (shared_)
        addSharedWindow(basis);
    return basis;
}

int RigProblem::publicRow(const RigBlock& block) const
{
    if (block.kind == RigBlock::EXTRINSICS)
        return publicCount() - 6;
    const int camera = block.camera == 1 ? cameras_[0].parameterCount() : 0;
    const int normal = camera + cameras_[block.camera].lensCount();
    return block.kind == RigBlock::LENS ? camera : block.kind == RigBlock::NORMAL ? normal : normal + 3;
}

//! Camera 2's rows: n2 = R n1, d2 = d1 + n2.T, and the same media.
void RigProblem::addSharedWindow(Eigen::MatrixXd& basis) const
{
    const int normal1Row = cameras_[0].lensCount(), extrinsicsRow = publicCount() - 6;
    const int normal2Row = cameras_[0].parameterCount() + cameras_[1].lensCount();
    const Pose toCamera2 = extrinsics();
    const Rotation rotation(toCamera2.rvec.val);
    const Vec3d normal1(blocks_[blockOf(RigBlock::NORMAL, 0)].values.data()), normal2 = rotation.R*normal1;
    const Matx33d byRvec = rotation.derivativeOf(normal1);

    typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> > Map33;
    typedef Eigen::Map<const Eigen::RowVector3d> Map13;
    basis.middleRows(normal2Row, 3) = Map33(rotation.R.val)*basis.middleRows(normal1Row, 3) +
                                      Map33(byRvec.val)*basis.middleRows(extrinsicsRow, 3);
    basis.row(normal2Row + 3) = basis.row(normal1Row + 3) +
                                Map13(toCamera2.tvec.val)*basis.middleRows(normal2Row, 3) +
                                Map13(normal2.val)*basis.middleRows(extrinsicsRow + 3, 3);
    const int others = cameras_[0].windowCount() - 4;
    basis.middleRows(normal2Row + 4, others) = basis.middleRows(normal1Row + 4, others).eval();
}

}} // namespace
