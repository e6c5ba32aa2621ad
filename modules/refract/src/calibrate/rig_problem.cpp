// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/rig_problem.hpp"
#include <Eigen/Cholesky>
#include <map>

namespace cv { namespace refract {

namespace {

std::array<double, 6> sixOf(const Pose& pose)
{
    std::array<double, 6> six;
    std::copy(pose.rvec.val, pose.rvec.val + 3, six.begin());
    std::copy(pose.tvec.val, pose.tvec.val + 3, six.begin() + 3);
    return six;
}

Pose poseOf(const double* six)
{
    Pose pose;
    pose.rvec = Vec3d(six);
    pose.tvec = Vec3d(six + 3);
    pose.found = true;
    return pose;
}

//! Focal lengths stay above a small part of their start.
double lowerBoundOfLens(int coordinate, double start)
{
    return coordinate < 2 ? 1e-6*start : -std::numeric_limits<double>::infinity();
}

} // namespace

std::vector<bool> freeLens(const Camera& camera, int flags)
{
    static const std::map<String, int> FIXED_BY = {
        { "fx", GLASS_FIX_FOCAL_LENGTH }, { "fy", GLASS_FIX_FOCAL_LENGTH }, { "cx", GLASS_FIX_PRINCIPAL_POINT },
        { "cy", GLASS_FIX_PRINCIPAL_POINT }, { "k1", GLASS_FIX_K1 }, { "k2", GLASS_FIX_K2 }, { "k3", GLASS_FIX_K3 },
        { "k4", GLASS_FIX_K4 }, { "k5", GLASS_FIX_K5 }, { "k6", GLASS_FIX_K6 }, { "p1", GLASS_FIX_TANGENT_DIST },
        { "p2", GLASS_FIX_TANGENT_DIST }, { "s1", GLASS_FIX_S1_S2_S3_S4 }, { "s2", GLASS_FIX_S1_S2_S3_S4 },
        { "s3", GLASS_FIX_S1_S2_S3_S4 }, { "s4", GLASS_FIX_S1_S2_S3_S4 }, { "tauX", GLASS_FIX_TAUX_TAUY },
        { "tauY", GLASS_FIX_TAUX_TAUY } };
    const std::vector<String> names = camera.parameterNames();
    std::vector<bool> isFree;
    for (int i = 0; i < camera.lensCount(); i++)
    {
        const auto fixed = FIXED_BY.find(names[i]);
        isFree.push_back((flags & GLASS_FREE_INTRINSICS) && !camera.lens().isFixed(i)
                         && !(fixed != FIXED_BY.end() && (flags & fixed->second)));
    }
    return isFree;
}

RigProblem::RigProblem(const Rig& rig, const RigViews& views, const std::vector<Pose>& poses,
                       const std::vector<PoseKnowledge>& known, const std::vector<CameraKnowledge>& knownCameras, int flags)
    : rig_(rig), imagesOfView_(poses.size()), known_(known), isSeen_(poses.size(), false), pixelSigma_(1)
{
    size_t most = 6*rig_.cameras.size();
    for (const Camera& camera : rig_.cameras)
        most += camera.parameterCount();
    values_.reserve(most);
    for (int c = 0; c < rig_.count(); c++)
    {
        const Camera& camera = rig_.cameras[c];
        const WindowLayout& at = camera.layers().at();
        const int lens = camera.lensCount();
        const std::vector<bool> isFree = freeWindowParameters(at, flags);
        const CameraKnowledge ofCamera = knownCameras.empty() ? CameraKnowledge() : knownCameras[c];
        addBlock(RigBlock::LENS, c, 0, freeLens(camera, flags));
        setKnown(ofCamera, 0, blocks_.back());
        if (!rig_.owns(c))
            continue;
        addBlock(RigBlock::NORMAL, c, lens + at.normal, std::vector<bool>(3, !(flags & GLASS_FIX_NORMAL)));
        addBlock(RigBlock::MEDIA, c, lens + at.media, std::vector<bool>(isFree.begin() + at.media, isFree.end()));
        setKnown(ofCamera, lens + at.media, blocks_.back());
    }
    for (int c = 1; c < rig_.count(); c++)
        addBlock(RigBlock::EXTRINSICS, c, 0, std::vector<bool>(6, (flags & GLASS_FREE_EXTRINSICS) != 0));
    for (const Pose& pose : poses)
        poses_.push_back(sixOf(pose));
    knownPoses_ = poses_;
    addImages(views);
    for (const Camera& camera : rig_.cameras)
        cameras_.push_back(RigCamera(camera));
    updateCameras();
}

//! @param first of the camera's parameters that is in the block; its others follow
void RigProblem::addBlock(RigBlock::Kind kind, int camera, int first, const std::vector<bool>& isFree)
{
    const int size = (int)isFree.size();
    const bool isPlace = kind == RigBlock::EXTRINSICS;
    const std::array<double, 6> place = sixOf(rig_.extrinsics[camera]);
    const std::vector<double> all = isPlace ? std::vector<double>(place.begin(), place.end())
                                            : rig_.cameras[camera].parameters();
    const std::vector<String> names = isPlace ? std::vector<String>{ "R", "R", "R", "T", "T", "T" }
                                              : rig_.cameras[camera].parameterNames();
    CV_Assert(values_.size() + size <= values_.capacity());
    double* const kept = values_.data() + values_.size();
    values_.insert(values_.end(), all.begin() + first, all.begin() + first + size);
    RigBlock block = { kind, camera, rig_.cameras[camera].layers().at(), Eigen::Map<Eigen::VectorXd>(kept, size), isFree,
                       std::vector<String>(names.begin() + first, names.begin() + first + size), std::vector<double>(),
                       std::vector<bool>(size, false), Eigen::VectorXd(), Eigen::MatrixXd() };
    for (int i = 0; i < size; i++)
        block.lower.push_back(kind == RigBlock::MEDIA ? lowerBound(block.windowParameter(i), kept[i]) :
                              kind == RigBlock::LENS ? lowerBoundOfLens(i, kept[i]) :
                              -std::numeric_limits<double>::infinity());
    block.known = block.values;
    block.priorRows.resize(0, size);
    blocks_.push_back(block);
}

/** The part of what is known that belongs to a block. Roots of correlations: the parameters' sizes differ by orders.
@param first column of the block's first value */
void RigProblem::setKnown(const CameraKnowledge& known, int first, RigBlock& block)
{
    const int size = (int)block.values.size();
    if (first + size > known.covariance.cols())
        return;
    const Eigen::MatrixXd covariance = known.covariance.block(first, first, size, size);
    std::vector<int> uncertain;
    for (int i = 0; i < size; i++)
        if (covariance(i, i) > 0)
            uncertain.push_back(i);
        else if (block.kind == RigBlock::LENS && covariance(i, i) == 0)
            block.isFree[i] = false;
    const int count = (int)uncertain.size();
    Eigen::MatrixXd correlation(count, count);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            correlation(i, j) = covariance(uncertain[i], uncertain[j])/
                                std::sqrt(covariance(uncertain[i], uncertain[i])*covariance(uncertain[j], uncertain[j]));
    const Eigen::LLT<Eigen::MatrixXd> root(correlation);
    if (root.info() != Eigen::Success)
        CV_Error_(Error::StsBadArg, ("cameraCovariances[%d] is not positive definite where it is not 0", block.camera));
    const Eigen::MatrixXd inverse = root.matrixL().solve(Eigen::MatrixXd::Identity(count, count));
    block.priorRows.setZero(count, size);
    for (int j = 0; j < count; j++)
    {
        block.isFree[uncertain[j]] = true;
        block.priorRows.col(uncertain[j]) = inverse.col(j)/std::sqrt(covariance(uncertain[j], uncertain[j]));
    }
}

void RigProblem::addImages(const RigViews& views)
{
    for (int view = 0; view < views.count(); view++)
        for (int c = 0; c < (int)views.cameras.size(); c++)
            for (bool refracted : { false, true })
            {
                const CameraViews& seen = views.cameras[c];
                RigImage image;
                image.view = view;
                image.camera = c;
                image.refracted = refracted;
                image.points = observed(views.object[view], (refracted ? seen.refracted : seen.direct)[view]);
                if (image.points.pixel.empty())
                    continue;
                image.rootWeights.assign(image.points.pixel.size(), 1.);
                imagesOfView_[view].push_back((int)images_.size());
                images_.push_back(image);
                isSeen_[view] = true;
            }
}

int RigProblem::blockOf(RigBlock::Kind kind, int camera) const
{
    if (kind == RigBlock::NORMAL || kind == RigBlock::MEDIA)
        camera = rig_.owner[camera];
    for (int i = 0; i < (int)blocks_.size(); i++)
        if (blocks_[i].kind == kind && blocks_[i].camera == camera)
            return i;
    return -1;
}

const double* RigProblem::valuesOf(RigBlock::Kind kind, int camera) const
{
    const int block = blockOf(kind, camera);
    return block < 0 ? nullptr : blocks_[block].values.data();
}

//! In the order of ImageResidual's blocks after the pose.
std::vector<int> RigProblem::blocksOf(const RigImage& image) const
{
    const int c = image.camera, owner = rig_.owner[c];
    std::vector<int> blocks;
    if (c > 0)
        blocks.push_back(blockOf(RigBlock::EXTRINSICS, c));
    blocks.push_back(blockOf(RigBlock::LENS, c));
    if (!image.refracted)
        return blocks;
    blocks.push_back(blockOf(RigBlock::NORMAL, c));
    blocks.push_back(blockOf(RigBlock::MEDIA, c));
    if (owner != c && owner > 0)
        blocks.push_back(blockOf(RigBlock::EXTRINSICS, owner));
    return blocks;
}

ceres::CostFunction* RigProblem::makeCost(const RigImage& image) const
{
    const ImageResidual::Image kind = { image.refracted, image.camera == 0, rig_.owner[image.camera] == 0 };
    return ImageResidual::Create(cameras_[image.camera], image.points, image.rootWeights, kind);
}

void RigProblem::updateCameras()
{
    for (int c = 0; c < rig_.count(); c++)
    {
        RigCamera::Parameters parameters;
        parameters.extrinsics = valuesOf(RigBlock::EXTRINSICS, c);
        parameters.lens = valuesOf(RigBlock::LENS, c);
        parameters.normal = valuesOf(RigBlock::NORMAL, c);
        parameters.media = valuesOf(RigBlock::MEDIA, c);
        parameters.ownerExtrinsics = valuesOf(RigBlock::EXTRINSICS, rig_.owner[c]);
        parameters.ownsWindow = rig_.owns(c);
        cameras_[c].set(parameters);
    }
}

Camera RigProblem::camera(int c) const
{
    if (cameras_[c].camera(true))
        return *cameras_[c].camera(true);
    const WindowTransfer* window = cameras_[c].window.get();
    CV_Assert(window);
    const Vec3d& n = window->normal;
    if (!(n[2] > 0))
        CV_Error_(Error::StsBadArg, ("shared window: camera %d looks away from it, as its normal is (%g, %g, %g) in the "
                                     "camera's frame", c + 1, n[0], n[1], n[2]));
    CV_Error_(Error::StsBadArg, ("shared window: camera %d lies beyond the window, at distance %g", c + 1,
                                 window->distance));
}

Rig RigProblem::rig() const
{
    Rig rig = rig_;
    for (int c = 0; c < rig.count(); c++)
    {
        rig.cameras[c] = camera(c);
        if (c > 0)
            rig.extrinsics[c] = poseOf(valuesOf(RigBlock::EXTRINSICS, c));
    }
    return rig;
}

Pose RigProblem::pose(int view) const
{
    Pose pose = poseOf(poses_[view].data());
    pose.found = isSeen_[view];
    return pose;
}

void RigProblem::setPose(int view, const Pose& pose)
{
    if (knowledgeOf(view) != PoseKnowledge::EXACT)
        poses_[view] = sixOf(pose);
}

void RigProblem::setObjectPoints(const std::vector<Point3d>& points)
{
    for (RigImage& image : images_)
        for (size_t i = 0; i < image.points.index.size(); i++)
            if (std::isfinite(points[image.points.index[i]].x))     // derivatives are finite whatever the weight
                image.points.object[i] = points[image.points.index[i]];
}

bool RigProblem::hasPriors() const
{
    return equationCount() > 2*pointCount();
}

void RigProblem::setRootWeights(int image, const std::vector<double>& rootWeights)
{
    images_[image].rootWeights = rootWeights;
    const int view = images_[image].view;
    isSeen_[view] = std::any_of(imagesOfView_[view].begin(), imagesOfView_[view].end(),
                                [this](int i) { return images_[i].usedCount() > 0; });
}

int RigProblem::pointCount() const
{
    int count = 0;
    for (const RigImage& image : images_)
        count += image.usedCount();
    return count;
}

int RigProblem::freeCount() const
{
    int count = 0;
    for (const RigBlock& block : blocks_)
        count += (int)block.tangentBasis().cols();
    return count;
}

int RigProblem::poseCount() const
{
    int count = 0;
    for (int view = 0; view < viewCount(); view++)
        count += isAdjusted(view);
    return count;
}

int RigProblem::equationCount() const
{
    int count = 2*pointCount();
    for (int view = 0; view < viewCount(); view++)
        count += isUncertain(view) ? 6 : 0;
    for (const RigBlock& block : blocks_)
        count += (int)block.priorRows.rows();
    return count;
}

}} // namespace
