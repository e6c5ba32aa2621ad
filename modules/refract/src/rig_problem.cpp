// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "rig_problem.hpp"

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

//! GlassCalibrationFlags -> which of distance, thickness[], index[], innerIndex, outerIndex are free.
std::vector<bool> freeMedia(int layers, int flags)
{
    std::vector<bool> isFree(1, (flags & GLASS_FREE_DISTANCE) != 0);
    isFree.insert(isFree.end(), layers, (flags & GLASS_FREE_THICKNESS) != 0);
    isFree.insert(isFree.end(), layers, (flags & GLASS_FREE_INDEX) != 0);
    isFree.push_back(false);
    isFree.push_back((flags & GLASS_FREE_OUTER_INDEX) != 0);
    return isFree;
}

//! Coefficients that are exactly 0 stay 0.
std::vector<bool> freeLens(const std::vector<double>& lens, int flags)
{
    std::vector<bool> isFree(lens.size(), (flags & GLASS_FREE_INTRINSICS) != 0);
    if (flags & GLASS_FIX_PRINCIPAL_POINT)
        isFree[2] = isFree[3] = false;
    for (size_t i = 4; i < lens.size(); i++)
        if (lens[i] == 0)
            isFree[i] = false;
    return isFree;
}

//! Thicknesses and focal lengths stay above a small part of their start.
double lowerBound(RigBlock::Kind kind, int coordinate, const std::vector<double>& values)
{
    const double SMALLEST_PART = 1e-6;
    const int layers = ((int)values.size() - 3)/2;
    if (kind == RigBlock::LENS && coordinate < 2)
        return SMALLEST_PART*values[coordinate];
    if (kind == RigBlock::MEDIA)
        return coordinate == 0 ? 0. : coordinate <= layers ? SMALLEST_PART*values[coordinate] : 1.;
    return -std::numeric_limits<double>::infinity();
}

} // namespace

RigProblem::RigProblem(const std::vector<Camera>& cameras, const Pose& extrinsics, const RigViews& views,
                       const std::vector<Pose>& poses, int flags)
    : cameras_(cameras), shared_((flags & GLASS_SHARED_WINDOW) != 0)
{
    for (int c = 0; c < (int)cameras_.size(); c++)
    {
        const Camera& camera = cameras_[c];
        const std::vector<double> all = camera.parameters();
        const std::vector<double>::const_iterator lensEnd = all.begin() + camera.lensCount();
        const std::vector<double> lens(all.begin(), lensEnd), media(lensEnd + 3, all.end());
        addBlock(RigBlock::LENS, c, lens, freeLens(lens, flags));
        if (c == 1 && shared_)
            continue;
        addBlock(RigBlock::NORMAL, c, std::vector<double>(lensEnd, lensEnd + 3), std::vector<bool>(3, true));
        addBlock(RigBlock::MEDIA, c, media, freeMedia(((int)media.size() - 3)/2, flags));
    }
    if (isStereo())
    {
        const std::array<double, 6> six = sixOf(extrinsics);
        addBlock(RigBlock::EXTRINSICS, 1, std::vector<double>(six.begin(), six.end()),
                 std::vector<bool>(6, (flags & GLASS_FREE_EXTRINSICS) != 0));
    }
    for (const Pose& pose : poses)
        poses_.push_back(sixOf(pose));
    addImages(views);
}

void RigProblem::addBlock(RigBlock::Kind kind, int camera, const std::vector<double>& values,
                          const std::vector<bool>& isFree)
{
    RigBlock block;
    block.kind = kind;
    block.camera = camera;
    block.values = values;
    block.isFree = isFree;
    block.isHeld.assign(values.size(), false);
    for (int i = 0; i < (int)values.size(); i++)
        block.lower.push_back(lowerBound(kind, i, values));
    blocks_.push_back(block);
}

void RigProblem::addImages(const RigViews& views)
{
    for (int view = 0; view < views.count(); view++)
        for (int c = 0; c < (int)views.cameras.size(); c++)
            for (bool refracted : { true, false })
            {
                const CameraViews& seen = views.cameras[c];
                RigImage image;
                image.view = view;
                image.camera = c;
                image.refracted = refracted;
                image.points = observed(views.object[view], (refracted ? seen.refracted : seen.direct)[view]);
                if (!image.points.pixel.empty())
                    images_.push_back(image);
            }
}

int RigProblem::blockOf(RigBlock::Kind kind, int camera) const
{
    if (shared_ && (kind == RigBlock::NORMAL || kind == RigBlock::MEDIA))
        camera = 0;
    for (int i = 0; i < (int)blocks_.size(); i++)
        if (blocks_[i].kind == kind && blocks_[i].camera == camera)
            return i;
    return -1;
}

//! In the order of ImageResidual's blocks after the pose.
std::vector<int> RigProblem::blocksOf(const RigImage& image) const
{
    std::vector<int> blocks;
    if (image.camera == 1)
        blocks.push_back(blockOf(RigBlock::EXTRINSICS, 1));
    blocks.push_back(blockOf(RigBlock::LENS, image.camera));
    if (image.refracted)
    {
        blocks.push_back(blockOf(RigBlock::NORMAL, image.camera));
        blocks.push_back(blockOf(RigBlock::MEDIA, image.camera));
    }
    return blocks;
}

ceres::CostFunction* RigProblem::makeCost(const RigImage& image) const
{
    const bool isCamera2 = image.camera == 1;
    const ImageResidual::Window window = !image.refracted ? ImageResidual::WITHOUT :
        isCamera2 && shared_ ? ImageResidual::OF_CAMERA_1 : ImageResidual::OWN;
    return ImageResidual::Create(cameras_[isCamera2 && shared_ ? 1 : image.camera], image.points, isCamera2, window);
}

Camera RigProblem::camera(int c) const
{
    const int window = shared_ ? 0 : c;
    const std::vector<double>& normal = blocks_[blockOf(RigBlock::NORMAL, window)].values;
    const std::vector<double>& media = blocks_[blockOf(RigBlock::MEDIA, window)].values;
    std::vector<double> all = blocks_[blockOf(RigBlock::LENS, c)].values;
    const size_t lensCount = all.size();
    all.insert(all.end(), normal.begin(), normal.end());
    all.insert(all.end(), media.begin(), media.end());
    if (shared_ && c == 1)
    {
        const Pose toCamera2 = extrinsics();
        Vec3d n(normal.data());
        double distance = media[0];
        windowInCamera2(Rotation(toCamera2.rvec.val).R, toCamera2.tvec, n, distance);
        if (!(n[2] > 0))
            CV_Error_(Error::StsBadArg, ("GLASS_SHARED_WINDOW: camera 2 looks away from the window, whose normal is "
                                         "(%g, %g, %g) in its frame", n[0], n[1], n[2]));
        if (distance < 0 && media[media.size() - 2] != media.back())
            CV_Error_(Error::StsBadArg, ("GLASS_SHARED_WINDOW: camera 2 lies beyond the window, at distance %g",
                                         distance));
        std::copy(n.val, n.val + 3, all.begin() + lensCount);
        all[lensCount + 3] = std::max(distance, 0.);
    }
    Camera result(cameras_[c]);
    result.setParameters(all);
    return result;
}

Pose RigProblem::pose(int view) const { return poseOf(poses_[view].data()); }

Pose RigProblem::extrinsics() const { return poseOf(blocks_[blockOf(RigBlock::EXTRINSICS, 1)].values.data()); }

int RigProblem::pointCount() const
{
    int count = 0;
    for (const RigImage& image : images_)
        count += (int)image.points.pixel.size();
    return count;
}

int RigProblem::freeCount() const
{
    int count = 0;
    for (const RigBlock& block : blocks_)
        count += (int)block.tangentBasis().cols();
    return count;
}

}} // namespace
