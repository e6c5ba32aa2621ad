// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/problem.hpp"
#include "arrays/arrays.hpp"
#include "math/dense.hpp"
#include "window/place.hpp"
#include <numeric>

namespace cv { namespace refract {

static Pose poseOf(const double* six)
{
    Pose pose;
    pose.rvec = Vec3d(six);
    pose.tvec = Vec3d(six + 3);
    pose.found = true;
    return pose;
}

void Problem::setRootWeights(int image, const std::vector<double>& rootWeights)
{
    images_[image].rootWeights = rootWeights;
    const int view = images_[image].view;
    isSeen_[view] = std::any_of(imagesOfView_[view].begin(), imagesOfView_[view].end(),
                                [this](int i) { return images_[i].usedCount() > 0; });
}

int Problem::pointCount() const
{
    int count = 0;
    for (const Image& image : images_)
        count += image.usedCount();
    return count;
}

int Problem::coordinateCount() const
{
    int count = 0;
    for (const Image& image : images_)
        count += image.coordinateCount();
    return count;
}

int Problem::blockOf(ParameterBlock::Kind kind, int camera) const
{
    if (kind == ParameterBlock::PLACE || kind == ParameterBlock::MEDIA)
        camera = rig_.owner[camera];
    for (int i = 0; i < cameraBlocks_; i++)
        if (blocks_[i].kind == kind && blocks_[i].index == camera)
            return i;
    return -1;
}

const double* Problem::valuesOf(ParameterBlock::Kind kind, int camera) const
{
    const int block = blockOf(kind, camera);
    return block < 0 ? nullptr : blocks_[block].values.data();
}

std::vector<int> Problem::blocksOf(const Image& image) const
{
    const int c = image.camera, owner = rig_.owner[c];
    std::vector<int> blocks;
    if (targetBlock_ >= 0)
        blocks.push_back(targetBlock_);
    if (c > 0)
        blocks.push_back(blockOf(ParameterBlock::EXTRINSICS, c));
    blocks.push_back(blockOf(ParameterBlock::LENS, c));
    if (!image.refracted)
        return blocks;
    blocks.push_back(blockOf(ParameterBlock::PLACE, c));
    blocks.push_back(blockOf(ParameterBlock::MEDIA, c));
    if (owner != c && owner > 0)
        blocks.push_back(blockOf(ParameterBlock::EXTRINSICS, owner));
    return blocks;
}

void Problem::updateCameras()
{
    if (targetBlock_ >= 0)
        targetErrors_ = SharedTargetErrors(blocks_[targetBlock_].values.data());
    for (int c = 0; c < rig_.count(); c++)
    {
        RigCamera::Parameters parameters;
        parameters.extrinsics = valuesOf(ParameterBlock::EXTRINSICS, c);
        parameters.lens = valuesOf(ParameterBlock::LENS, c);
        parameters.place = valuesOf(ParameterBlock::PLACE, c);
        parameters.media = valuesOf(ParameterBlock::MEDIA, c);
        parameters.ownerExtrinsics = valuesOf(ParameterBlock::EXTRINSICS, rig_.owner[c]);
        parameters.ownsWindow = rig_.owns(c);
        cameras_[c].set(parameters);
    }
}

Camera Problem::camera(int c) const
{
    const Camera* camera = cameras_[c].camera(true);
    CV_Assert(camera);          // findPointWithoutImage() says why there is none, and the fit does not come to such a place
    return *camera;
}

Rig Problem::rig() const
{
    Rig rig = rig_;
    for (int c = 0; c < rig.count(); c++)
    {
        rig.cameras[c] = camera(c);
        if (c > 0)
            rig.extrinsics[c] = poseOf(valuesOf(ParameterBlock::EXTRINSICS, c));
    }
    return rig;
}

Pose Problem::pose(int view) const
{
    Pose pose = poseOf(blocks_[poseBlock(view)].values.data());
    pose.found = isSeen_[view];
    return pose;
}

RigidTransform Problem::camFromScene(const Image& image) const
{
    const RigidTransform cam1FromScene = transformOf(pose(image.view));
    return image.camera == 0 ? cam1FromScene
                             : transformOf(poseOf(valuesOf(ParameterBlock::EXTRINSICS, image.camera)))*cam1FromScene;
}

std::vector<Pose> Problem::poses() const
{
    std::vector<Pose> all;
    for (int view = 0; view < viewCount(); view++)
        all.push_back(pose(view));
    return all;
}

void Problem::setPose(int view, const Pose& pose)
{
    ParameterBlock& block = blocks_[poseBlock(view)];
    if (!block.isFree[0])
        return;
    std::copy_n(pose.rvec.val, 3, block.values.data());
    std::copy_n(pose.tvec.val, 3, block.values.data() + 3);
}

void Problem::placePoints(const std::vector<Point3d>& points)
{
    parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
    {
        for (int image = range.start; image < range.end; image++)
        {
            ImagePoints& own = images_[image].points;
            for (size_t i = 0; i < own.index.size(); i++)
                if (std::isfinite(points[own.index[i]].x))     // derivatives are finite whatever the weight
                    own.object[i] = points[own.index[i]];
        }
    });
}

void Problem::placeCluster(int cluster)
{
    const double* const values = scene_.clusters()[cluster].values.data();
    for (const Observation& o : observations_[cluster])
    {
        ImagePoints& points = images_[o.image].points;
        points.object[o.row] = Point3d(Vec3d(values + 3*scene_.placeInCluster(points.index[o.row])));
    }
}

void Problem::setPoints(const std::vector<Point3d>& points, const Masks& isInlier)
{
    scene_.setPoints(points);
    observations_.assign(scene_.clusters().size(), std::vector<Observation>());
    for (int i = 0; i < (int)images_.size(); i++)
    {
        const std::vector<int>& index = images_[i].points.index;
        std::vector<double> rootWeights(index.size(), 0.);
        for (int row = 0; row < (int)index.size(); row++)
        {
            if (!scene_.isUsed(index[row]))
                continue;
            observations_[scene_.clusterOf(index[row])].push_back({ i, row });
            rootWeights[row] = isInlier.empty() || isInlier[i][row] ? 1 : 0;
        }
        setRootWeights(i, rootWeights);
    }
    placePoints(scene_.points());
}

bool Problem::evaluate(const Image& image, const std::vector<double>& rootWeights, Wanted wanted, Derivatives& result) const
{
    const ImageResidual residual(cameras_[image.camera], image.points, rootWeights,
                                 { image.refracted, image.camera == 0, rig_.owner[image.camera] == 0, targetBlock_ >= 0 },
                                 targetErrors_);
    const double* const pose = blocks_[poseBlock(image.view)].values.data();
    const int rows = residual.count();
    result.residuals.resize(rows);
    if (wanted == RESIDUALS)
        return residual.evaluate(pose, result.residuals.data(), nullptr);
    const std::vector<int>& sizes = residual.blockSizes();
    std::vector<double*> jacobians(sizes.size(), nullptr);
    result.byPose.resize(rows, 6);
    jacobians[0] = result.byPose.data();
    if (wanted == ALL)
    {
        result.byBlock.resize(sizes.size() - 1);
        for (size_t i = 1; i < sizes.size(); i++)
        {
            result.byBlock[i - 1].resize(rows, sizes[i]);
            jacobians[i] = result.byBlock[i - 1].data();
        }
    }
    return residual.evaluate(pose, result.residuals.data(), jacobians.data());
}

Pose Problem::inDirectImages(const Image& image, const Pose& pose) const
{
    if (!image.refracted || !pose.found || targetBlock_ < 0)
        return pose;
    const Matx33d back = targetErrors_.rotation.R.t();
    Pose direct;
    direct.rvec = rotationVector(back*rotationMatrix(pose.rvec));
    direct.tvec = back*(pose.tvec - targetErrors_.translation);
    direct.found = true;
    return direct;
}

//! A point moves as the view's translation does, turned into the scene's frame.
RowMajorMatrix Problem::byScenePoint(const Image& image, const RowMajorMatrix& byPose) const
{
    const Matx33d R = rotationMatrix(pose(image.view).rvec);
    return sceneScale()*byPose.rightCols<3>()*Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> >(R.val);
}

double Problem::squaredPixelError(const Image& image) const
{
    Derivatives result;
    evaluate(image, image.rootWeights, RESIDUALS, result);
    return result.residuals.squaredNorm();
}

double Problem::squaredError() const
{
    std::vector<double> squares(images_.size());
    parallel_for_(Range(0, (int)images_.size()), [&](const Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            squares[i] = squaredPixelError(images_[i]);
    });
    double sum = std::accumulate(squares.begin(), squares.end(), 0.);
    for (int block = 0; block < (int)blocks_.size(); block++)
        sum += priorResidual(block).squaredNorm();
    if (rigPrior_.count() > 0)
        sum += rigPriorResidual().squaredNorm();
    for (const Cluster& cluster : scene_.clusters())
        sum += cluster.squaredLengthError(pixelSigma_);
    return sum;
}

bool Problem::isActive(int block) const
{
    return blocks_[block].kind != ParameterBlock::POSE || isAdjusted(blocks_[block].index);
}

Eigen::MatrixXd Problem::priorRows(int block) const
{
    const Eigen::MatrixXd& rows = blocks_[block].sqrtInformation;
    return isActive(block) ? Eigen::MatrixXd(pixelSigma_*rows) : Eigen::MatrixXd(0, rows.cols());
}

Eigen::VectorXd Problem::priorResidual(int block) const
{
    return timesVector(priorRows(block), blocks_[block].values - blocks_[block].priorMean);
}

Eigen::MatrixXd Problem::rigPriorRows() const { return pixelSigma_*rigPrior_.sqrtInformation; }

Eigen::VectorXd Problem::rigPriorResidual() const
{
    Eigen::VectorXd change(rigPrior_.mean.size());
    int first = 0;
    for (int i = 0; i < cameraBlocks_ && change.size() > 0; i++)
    {
        change.segment(first, blocks_[i].values.size()) = blocks_[i].values;
        first += (int)blocks_[i].values.size();
    }
    return timesVector(rigPriorRows(), change - rigPrior_.mean);
}

double Problem::squaredOuterPriors() const
{
    double sum = rigPrior_.count() > 0 ? rigPriorResidual().squaredNorm() : 0;
    for (int block = 0; block < outerCount(); block++)
        sum += priorResidual(block).squaredNorm();
    return sum;
}

int Problem::equationCount() const
{
    int count = coordinateCount() + scene_.lengthCount() + rigPrior_.count();
    for (int block = 0; block < (int)blocks_.size(); block++)
        count += isActive(block) ? (int)blocks_[block].sqrtInformation.rows() : 0;
    return count;
}

int Problem::unknownCount() const
{
    int count = scene_.coordinateCount();
    for (int block = 0; block < (int)blocks_.size(); block++)
        count += isActive(block) ? (int)blocks_[block].tangentBasis().cols() : 0;
    return count;
}

//! The first row of a block. A window has rows in every camera that looks through it.
int Problem::publicRow(ParameterBlock::Kind kind, int camera) const
{
    int row = 0;
    if (kind == ParameterBlock::EXTRINSICS || kind == ParameterBlock::TARGETS)
    {
        for (const Camera& c : rig_.cameras)
            row += c.parameterCount();
        return row + 6*((kind == ParameterBlock::TARGETS ? rig_.count() : camera) - 1);
    }
    for (int c = 0; c < camera; c++)
        row += rig_.cameras[c].parameterCount();
    const Camera& camera_ = rig_.cameras[camera];
    const WindowLayout& at = camera_.layers().at();
    return row + (kind == ParameterBlock::LENS ? 0 : camera_.lensCount() + (kind == ParameterBlock::PLACE ? at.normal : at.media));
}

Eigen::MatrixXd Problem::publicBasis() const
{
    int count = 0;
    for (int i = 0; i < cameraBlocks_; i++)
        count += (int)blocks_[i].tangentBasis().cols();
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(publicCount(), count);
    int column = 0;
    for (int i = 0; i < cameraBlocks_; i++)
    {
        const Eigen::MatrixXd tangent = blocks_[i].tangentBasis();
        basis.block(publicRow(blocks_[i].kind, blocks_[i].index), column, tangent.rows(), tangent.cols()) = tangent;
        column += (int)tangent.cols();
    }
    for (int c = 0; c < rig_.count(); c++)
        if (!rig_.owns(c))
            addSharedWindow(c, basis);
    return basis;
}

//! The rows of a window in a camera that does not own it.
void Problem::addSharedWindow(int camera, Eigen::MatrixXd& basis) const
{
    const int owner = rig_.owner[camera], row = publicRow(ParameterBlock::PLACE, camera);
    const int ownerRow = publicRow(ParameterBlock::PLACE, owner);
    const TransferredWindow& window = *cameras_[camera].window;
    const int count = rig_.cameras[camera].layers().at().count;
    Eigen::MatrixXd rows = product(window.byWindow, basis.middleRows(ownerRow, count));
    if (camera > 0)
        rows += product(window.byCamera, basis.middleRows<6>(publicRow(ParameterBlock::EXTRINSICS, camera)));
    if (owner > 0)
        rows += product(window.byOwner, basis.middleRows<6>(publicRow(ParameterBlock::EXTRINSICS, owner)));
    basis.middleRows(row, count) = rows;
}

}} // namespace
