// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* How a problem is made: its blocks of parameters, what is known of them, and the images. */

#include "adjust/problem.hpp"
#include "math/dense.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

std::vector<double> sixOf(const Pose& pose)
{
    std::vector<double> six(pose.rvec.val, pose.rvec.val + 3);
    six.insert(six.end(), pose.tvec.val, pose.tvec.val + 3);
    return six;
}

} // namespace

std::vector<SceneImage> sceneImages(const std::vector<PixelViews>& pixels, const std::vector<CovarianceViews>& covariances,
                                    double variance)
{
    std::vector<SceneImage> images;
    for (size_t view = 0; view < pixels[0].size(); view++)
        for (size_t c = 0; c < pixels.size(); c++)
        {
            const std::vector<Point2d>& own = pixels[c][view];
            const bool areKnown = !covariances.empty() && !covariances[c].empty();
            const ImagePoints points = observed(std::vector<Point3d>(own.size()), own,
                                                areKnown ? covariances[c][view] : PixelCovariances(), variance);
            if (!points.pixel.empty())
                images.push_back({ (int)view, (int)c, points });
        }
    return images;
}

Problem::Problem(const Rig& rig, const RigViews& views, const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors,
                 const std::vector<CameraPrior>& cameraPriors, int flags, const Eigen::MatrixXd& targetCovariance)
    : rig_(rig), imagesOfView_(poses.size()), isSeen_(poses.size(), false), pixelSigma_(1)
{
    addBlocks(poses, posePriors, cameraPriors, flags, targetCovariance);
    const Eigen::MatrixXd windows = correlatedWindows(cameraPriors);
    if (windows.size() > 0)
        setRigPrior(windows);
    addImages(views);
    updateCameras();
}

Problem::Problem(const Rig& rig, const std::vector<SceneImage>& images, int pointCount, const std::vector<KnownLength>& lengths,
                 const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors, int flags,
                 const std::vector<CameraPrior>& cameraPriors, const Eigen::MatrixXd& rigCovariance, double lengthScaleSigma)
    : rig_(rig), imagesOfView_(poses.size()), isSeen_(poses.size(), false), scene_(pointCount, lengths), pixelSigma_(1)
{
    Eigen::MatrixXd sharedErrors;           // lengths that are too small by a part are points that are too near by it
    if (lengthScaleSigma != 0)
    {
        sharedErrors = Eigen::MatrixXd::Zero(SharedTargetErrors::COUNT, SharedTargetErrors::COUNT);
        sharedErrors(0, 0) = lengthScaleSigma*lengthScaleSigma;
    }
    addBlocks(poses, posePriors, cameraPriors, flags, sharedErrors);
    const Eigen::MatrixXd known = rigCovariance.size() > 0 ? rigCovariance : correlatedWindows(cameraPriors);
    if (known.size() > 0)
        setRigPrior(known);
    for (const SceneImage& image : images)
        addImage(image.view, image.camera, true, image.points);
    updateCameras();
}

void Problem::addBlocks(const std::vector<Pose>& poses, const std::vector<PosePrior>& posePriors,
                        const std::vector<CameraPrior>& cameraPriors, int flags, const Eigen::MatrixXd& targetCovariance)
{
    size_t most = 6*(rig_.cameras.size() + poses.size()) + SharedTargetErrors::COUNT;
    for (const Camera& camera : rig_.cameras)
        most += camera.parameterCount();
    values_.reserve(most);              // blocks point into it
    for (int c = 0; c < rig_.count(); c++)
        addCameraBlocks(c, cameraPriors.empty() ? CameraPrior() : cameraPriors[c], flags);
    const std::vector<String> names = { "R", "R", "R", "T", "T", "T" };
    for (int c = 1; c < rig_.count(); c++)
    {
        ParameterBlock& block = addBlock(ParameterBlock::EXTRINSICS, c, sixOf(rig_.extrinsics[c]), names,
                                         std::vector<bool>(6, (flags & GLASS_FREE_EXTRINSICS) != 0));
        const int first = rig_.cameras[c].parameterCount();
        if (!cameraPriors.empty() && cameraPriors[c].covariance.cols() == first + 6)
            block.setPrior(cameraPriors[c].covariance.block(first, first, 6, 6));
    }
    targetBlock_ = -1;
    if (targetCovariance.size() > 0)
        addTargetBlock(targetCovariance);
    cameraBlocks_ = (int)blocks_.size();
    for (int view = 0; view < (int)poses.size(); view++)
    {
        const PosePrior prior = posePriors.empty() ? PosePrior() : posePriors[view];
        ParameterBlock& block = addBlock(ParameterBlock::POSE, view, sixOf(poses[view]), names,
                                         std::vector<bool>(6, prior.kind != PosePrior::EXACT));
        if (prior.kind == PosePrior::UNCERTAIN)
            block.sqrtInformation = prior.sqrtInformation;
    }
    for (const Camera& camera : rig_.cameras)
        cameras_.push_back(RigCamera(camera));
}

void Problem::addTargetBlock(const Eigen::MatrixXd& covariance)
{
    const int count = SharedTargetErrors::COUNT;
    const String scale = "scale of the targets", motion = "motion of the targets";
    targetBlock_ = (int)blocks_.size();
    ParameterBlock& block = addBlock(ParameterBlock::TARGETS, 0, std::vector<double>(count, 0.),
                                     { scale, motion, motion, motion, motion, motion, motion }, std::vector<bool>(count, false));
    block.setPrior(covariance);
}

//! What a block was given as; empty: nothing is known of it, or it is another camera's now.
std::vector<double> Problem::givenValues(const ParameterBlock& block, const Rig& given, const std::vector<Pose>& poses) const
{
    if (block.kind == ParameterBlock::TARGETS)
        return {};
    if (block.kind == ParameterBlock::POSE || block.kind == ParameterBlock::EXTRINSICS)
    {
        if (block.kind == ParameterBlock::POSE ? poses.empty() : !given.extrinsics[block.index].found)
            return {};
        return sixOf(block.kind == ParameterBlock::POSE ? poses[block.index] : given.extrinsics[block.index]);
    }
    const Camera& camera = given.cameras[block.index];
    const int first = block.kind == ParameterBlock::LENS ? 0 : camera.lensCount() +
        (block.kind == ParameterBlock::PLACE ? block.at.normal : block.at.media);
    if (block.kind == ParameterBlock::LENS || given.owns(block.index))
    {
        const std::vector<double> all = camera.parameters();
        return std::vector<double>(all.begin() + first, all.begin() + first + block.values.size());
    }
    if (block.kind != ParameterBlock::PLACE || hasCenter(block.at.shape))
        return {};              // the search gave the window to another camera
    // The given normal, as the camera sees it that has it now.
    const int from = given.owner[block.index];
    const Vec3d n = rotationMatrix(rig_.extrinsics[block.index].rvec)*(rotationMatrix(rig_.extrinsics[from].rvec).t()
        *given.cameras[from].layers().normal());
    return std::vector<double>(n.val, n.val + 3);
}

void Problem::setPriorMeans(const Rig& given, const std::vector<Pose>& poses)
{
    int first = 0;              // of the block's values in those of the rig
    for (int block = 0; block < (int)blocks_.size(); block++)
    {
        Eigen::VectorXd& mean = blocks_[block].priorMean;
        const bool isOfRig = rigPrior_.count() > 0 && block < cameraBlocks_;
        const std::vector<double> known = isOfRig || blocks_[block].sqrtInformation.rows() > 0 ? givenValues(blocks_[block], given, poses)
                                                                                               : std::vector<double>();
        for (int i = 0; i < (int)known.size(); i++)
            if (std::isfinite(known[i]))        // else nothing is known of it
                mean[i] = known[i];
        if (isOfRig)
            rigPrior_.mean.segment(first, mean.size()) = mean;
        first += (int)mean.size();
    }
}

//! Of a window the rows of its owner count; the others follow from them.
void Problem::setRigPrior(const Eigen::MatrixXd& covariance)
{
    std::vector<int> rows;                  // of the covariance, per value
    std::vector<Eigen::VectorXd> directions;
    int count = 0;
    for (int i = 0; i < cameraBlocks_; i++)
        count += (int)blocks_[i].values.size();
    Eigen::VectorXd mean(count);
    for (int i = 0; i < cameraBlocks_; i++)
    {
        ParameterBlock& block = blocks_[i];
        const int first = (int)rows.size(), size = (int)block.values.size(), row = publicRow(block.kind, block.index);
        mean.segment(first, size) = block.values;
        for (int k = 0; k < size; k++)
            rows.push_back(block.kind == ParameterBlock::TARGETS ? -1 : row + k);
        if (block.kind == ParameterBlock::TARGETS)
            continue;
        const bool isWhole = block.isOnManifold();
        const double ofBlock = isWhole ? covariance.diagonal().segment(row, size).sum() : 0;
        for (int k = 0; k < size; k++)
            if (isWhole ? ofBlock > 0 : covariance(row + k, row + k) > 0)
                block.isFree[k] = true;
        const Eigen::MatrixXd tangents = block.tangentBasis();
        for (int k = 0; k < tangents.cols(); k++)
        {
            const double variance = tangents.col(k).dot(timesVector(covariance.block(row, row, size, size), tangents.col(k)));
            if (!(variance > 0))
                continue;
            directions.push_back(Eigen::VectorXd::Zero(count));
            directions.back().segment(first, size) = tangents.col(k);
        }
    }
    Eigen::MatrixXd known(count, directions.size()), ofValues = Eigen::MatrixXd::Zero(count, count);
    for (size_t k = 0; k < directions.size(); k++)
        known.col(k) = directions[k];
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            if (rows[i] >= 0 && rows[j] >= 0)
                ofValues(i, j) = covariance(rows[i], rows[j]);
    rigPrior_ = makeRigPrior(mean, known, product(transposeTimes(known, ofValues), known));
}

//! A camera's prior has a covariance of where its window is with its distance, or what else the window has.
static bool correlatesWindow(const CameraPrior& prior, const Camera& camera)
{
    const WindowLayout& at = camera.layers().at();
    const int lens = camera.lensCount();
    if (prior.covariance.cols() < lens + at.count)
        return false;
    return (prior.covariance.block(lens + at.normal, lens + at.media, at.media - at.normal, at.count - at.media).array().abs() > 0).any();
}

/** Priors of windows that are of two blocks, as a covariance of the public parameters, which knows nothing else; empty: there is none.
Markers on a pane, say, tell its normal and its distance together. */
Eigen::MatrixXd Problem::correlatedWindows(const std::vector<CameraPrior>& cameraPriors) const
{
    Eigen::MatrixXd known;
    for (int c = 0; c < (int)cameraPriors.size(); c++)
    {
        if (!rig_.owns(c) || !correlatesWindow(cameraPriors[c], rig_.cameras[c]))
            continue;
        if (known.size() == 0)
            known = Eigen::MatrixXd::Zero(publicCount(), publicCount());
        const int lens = rig_.cameras[c].lensCount(), count = rig_.cameras[c].layers().at().count;
        const int row = publicRow(ParameterBlock::LENS, c) + lens;
        const Eigen::MatrixXd window = cameraPriors[c].covariance.block(lens, lens, count, count);
        known.block(row, row, count, count) = window.array().isNaN().select(0, window);
    }
    return known;
}

void Problem::addCameraBlocks(int c, const CameraPrior& prior, int flags)
{
    const Camera& camera = rig_.cameras[c];
    const WindowLayout& at = camera.layers().at();
    const std::vector<double> all = camera.parameters();
    const std::vector<String> names = camera.parameterNames();
    // Of a camera without a window the flags of the others' windows mean nothing.
    const std::vector<bool> isFree = camera.refracts() ? freeWindowParameters(at, flags) : std::vector<bool>(at.count, false);
    bool isBlockKnown = true;       // by itself
    const auto add = [&](ParameterBlock::Kind kind, int first, const std::vector<bool>& free)
    {
        const int size = (int)free.size();
        ParameterBlock& block = addBlock(kind, c, std::vector<double>(all.begin() + first, all.begin() + first + size),
                                         std::vector<String>(names.begin() + first, names.begin() + first + size), free);
        if (isBlockKnown && first + size <= prior.covariance.cols())
            block.setPrior(prior.covariance.block(first, first, size, size));
    };
    const int lens = camera.lensCount();
    add(ParameterBlock::LENS, 0, freeLens(camera, flags));
    if (!rig_.owns(c))
        return;
    isBlockKnown = !correlatesWindow(prior, camera);
    add(ParameterBlock::PLACE, lens + at.normal, std::vector<bool>(at.media - at.normal, camera.refracts() && !(flags & GLASS_FIX_NORMAL)));
    add(ParameterBlock::MEDIA, lens + at.media, std::vector<bool>(isFree.begin() + at.media, isFree.end()));
}

ParameterBlock& Problem::addBlock(ParameterBlock::Kind kind, int index, const std::vector<double>& values,
                                  const std::vector<String>& names, const std::vector<bool>& isFree)
{
    const int size = (int)values.size();
    CV_Assert(values_.size() + size <= values_.capacity());
    double* const kept = values_.data() + values_.size();
    values_.insert(values_.end(), values.begin(), values.end());
    const bool isPose = kind == ParameterBlock::POSE;
    ParameterBlock block = { kind, index, isPose ? WindowLayout() : rig_.cameras[index].layers().at(),
                             Eigen::Map<Eigen::VectorXd>(kept, size), isFree, names, std::vector<double>(),
                             std::vector<bool>(size, false), Eigen::VectorXd(), Eigen::MatrixXd() };
    for (int i = 0; i < size; i++)
        block.lower.push_back(kind == ParameterBlock::MEDIA ? lowerBound(block.windowParameter(i), kept[i]) :
                              kind == ParameterBlock::LENS ? lowerBoundOfLens(i, kept[i]) :
                              -std::numeric_limits<double>::infinity());
    block.priorMean = block.values;
    block.sqrtInformation.resize(0, size);
    blocks_.push_back(block);
    return blocks_.back();
}

void Problem::addImages(const RigViews& views)
{
    for (int view = 0; view < views.count(); view++)
        for (int c = 0; c < (int)views.cameras.size(); c++)
            for (bool refracted : { false, true })
            {
                const CameraViews& seen = views.cameras[c];
                const CovarianceViews& covariances = refracted ? seen.refractedCovariances : seen.directCovariances;
                addImage(view, c, refracted, observed(views.object[view], (refracted ? seen.refracted : seen.direct)[view],
                                                      covariances.empty() ? PixelCovariances() : covariances[view], views.variance));
            }
}

//! Nothing if it shows no point.
void Problem::addImage(int view, int camera, bool refracted, const ImagePoints& points)
{
    if (points.pixel.empty())
        return;
    imagesOfView_[view].push_back((int)images_.size());
    images_.push_back({ view, camera, refracted, points, std::vector<double>(points.pixel.size(), 1.) });
    isSeen_[view] = true;
}

}} // namespace
