// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/fit_arguments.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include "calibrate/calibration_error.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

namespace {

//! Refuses to free what a shape has not.
void checkFlagsOfShape(const GlassWindow& window, int flags)
{
    const bool isRound = hasCenter(window.shape);
    const auto refuse = [=](int flag, const char* name, const char* has)
    {
        if (flags & flag)
            CV_Error_(Error::StsBadFlag, ("flags has %s, but a window is %s (window.shape %d), which has %s", name,
                                          isRound ? "a dome or tube" : "flat", window.shape, has));
    };
    if (isRound)
    {
        refuse(GLASS_FREE_DISTANCE, "GLASS_FREE_DISTANCE", "a radius: GLASS_FREE_RADIUS");
        refuse(GLASS_FREE_WEDGE, "GLASS_FREE_WEDGE", "no wedge");
        refuse(GLASS_FREE_CURVATURE, "GLASS_FREE_CURVATURE", "a radius: GLASS_FREE_RADIUS");
    }
    else
        refuse(GLASS_FREE_RADIUS, "GLASS_FREE_RADIUS", "no radius");
}

//! Refuses what no data can determine.
void checkWindow(const GlassWindow& window, int flags)
{
    checkFlagsOfShape(window, flags);
    const bool equalMedia = window.innerIndex == window.outerIndex;
    if (window.thickness.empty() && equalMedia && !(flags & GLASS_FIX_NORMAL))
        CV_Error_(Error::StsBadArg, ("window has no layer and equal media (index %g): it does not refract, so that its "
                                     "normal is undetermined", window.innerIndex));
    if (window.thickness.empty() && (flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_WEDGE)))
        CV_Error_(Error::StsBadFlag, ("flags is %d, but window has no layer whose thickness, index or wedge could be free", flags));
    const bool isParallel = window.wedge.empty() && window.curvature == 0 && !(flags & (GLASS_FREE_WEDGE | GLASS_FREE_CURVATURE));
    if (equalMedia && isParallel && (flags & GLASS_FREE_DISTANCE))
        CV_Error_(Error::StsBadFlag, ("flags has GLASS_FREE_DISTANCE, but innerIndex and outerIndex are both %g and the faces "
                                      "parallel planes: the distance has no effect then and is undetermined", window.innerIndex));
}

} // namespace

void checkFlags(int flags, int allowed)
{
    if (flags & ~allowed)
        CV_Error_(Error::StsBadFlag, ("flags is %d; %d has no meaning here", flags, flags & ~allowed));
}

void addParameters(std::vector<Camera>& cameras, int flags)
{
    for (Camera& camera : cameras)
    {
        if (!camera.refracts())         // no window, nothing to free
            continue;
        GlassWindow window = camera.window();
        const bool hasFaces = !hasCenter(window.shape);
        const bool addsWedge = (flags & GLASS_FREE_WEDGE) && window.wedge.empty(), addsBow = flags & GLASS_FREE_CURVATURE;
        if (addsWedge && hasFaces)
            window.wedge.assign(window.thickness.size(), Vec2d());
        if (addsBow && hasFaces)
            window.shape = WINDOW_BENT;
        if ((addsWedge || addsBow) && hasFaces)
            camera.setWindow(window);
    }
}

void checkWindows(const Rig& rig, const std::vector<bool>& isSeen, int flags, const std::vector<String>& names)
{
    const auto refracts = [](const Camera& camera) { return camera.refracts(); };
    const bool anyRefracts = std::any_of(rig.cameras.begin(), rig.cameras.end(), refracts);
    for (int owner = 0; owner < rig.count(); owner++)
    {
        // A camera without a window may be among others that have one; nothing of it is estimated then.
        if (!rig.owns(owner) || (anyRefracts && !refracts(rig.cameras[owner])))
            continue;
        const GlassWindow window = rig.cameras[owner].window();
        checkWindow(window, flags);
        const bool isShared = std::count(rig.owner.begin(), rig.owner.end(), owner) > 1;
        if (isShared && window.shape == WINDOW_BENT && !window.wedge.empty())
            CV_Error(Error::StsNotImplemented, "a window that several cameras share is bent and has a wedge: its faces have no common "
                                               "centre. Leave one of both out (window.wedge empty, or window.shape WINDOW_FLAT)");
        bool isWindowSeen = false;
        for (int c = owner; c < rig.count(); c++)
            isWindowSeen = isWindowSeen || (rig.owner[c] == owner && isSeen[c]);
        if (isWindowSeen)
            continue;
        CalibrationError error(CalibrationError::WINDOW_NOT_SEEN, names[owner] + " has no point that was seen",
                               "no point was seen through the window");
        error.camera = owner;
        raise(error);
    }
}

void checkWindows(const Rig& rig, const RigViews& views, int flags, const std::vector<String>& names)
{
    std::vector<bool> isSeen;
    for (const CameraViews& camera : views.cameras)
        isSeen.push_back(seesAnything(camera.refracted));
    checkWindows(rig, isSeen, flags, names);
}

//! As the arrays have them: an empty list is no view.
static std::vector<Mat> viewsOf(const std::vector<std::vector<Mat> >& imagePoints, int camera)
{
    return imagePoints.empty() ? std::vector<Mat>() : imagePoints[camera];
}

RigViews readRigViews(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                      const std::vector<std::vector<Mat> >& imagePointsRefracted, int cameras, HalfPixels halves)
{
    if (cameras == 0)
        CV_Error(Error::StsBadArg, "cameras is empty; at least one is needed");
    checkCount(imagePointsDirect.size(), cameras, "imagePointsDirect", !imagePointsRefracted.empty());
    checkCount(imagePointsRefracted.size(), cameras, "imagePointsRefracted", !imagePointsDirect.empty());
    RigViews views;
    views.object = readObjectViews(objectPoints, "objectPoints");
    for (int c = 0; c < cameras; c++)
        views.cameras.push_back(readCameraViews(viewsOf(imagePointsDirect, c), numbered("imagePointsDirect", c).c_str(),
                                                viewsOf(imagePointsRefracted, c), numbered("imagePointsRefracted", c).c_str(),
                                                views.object, halves));
    return views;
}

void addPixelCovariances(const std::vector<std::vector<Mat> >& direct, const std::vector<std::vector<Mat> >& refracted,
                                RigViews& views)
{
    const int count = (int)views.cameras.size();
    checkCount(direct.size(), count, "pixelCovariancesDirect", true);
    checkCount(refracted.size(), count, "pixelCovariancesRefracted", true);
    MedianVariance median;
    for (int c = 0; c < count; c++)
    {
        CameraViews& seen = views.cameras[c];
        seen.directCovariances = readCovarianceViews(viewsOf(direct, c), seen.direct, numbered("pixelCovariancesDirect", c));
        seen.refractedCovariances = readCovarianceViews(viewsOf(refracted, c), seen.refracted,
                                                        numbered("pixelCovariancesRefracted", c));
        for (int view = 0; view < views.count(); view++)
        {
            median.add(seen.direct[view], seen.directCovariances.empty() ? PixelCovariances() : seen.directCovariances[view]);
            median.add(seen.refracted[view],
                       seen.refractedCovariances.empty() ? PixelCovariances() : seen.refractedCovariances[view]);
        }
    }
    if (!direct.empty() || !refracted.empty())
        views.variance = median();
}

std::vector<Camera> camerasOf(const std::vector<Ptr<RefractiveCamera> >& handles, const std::vector<String>& names)
{
    std::vector<Camera> cameras;
    for (size_t c = 0; c < handles.size(); c++)
    {
        cameras.push_back(cameraOf(handles[c], names[c].c_str()));
        for (size_t earlier = 0; earlier < c; earlier++)
            if (handles[earlier] == handles[c])
                CV_Error_(Error::StsBadArg, ("%s and %s are one object; each holds its own result",
                                             names[earlier].c_str(), names[c].c_str()));
    }
    return cameras;
}

void setOwners(Rig& rig, const std::vector<int>& windowOfCamera)
{
    for (int c = 0; c < rig.count(); c++)
    {
        if (windowOfCamera.empty())
        {
            rig.owner.push_back(c);
            continue;
        }
        rig.owner.push_back((int)(std::find(windowOfCamera.begin(), windowOfCamera.end(), windowOfCamera[c]) -
                                  windowOfCamera.begin()));
        rig.cameras[c].setWindow(rig.cameras[rig.owner[c]].window());
    }
}

void setCameras(const Rig& rig, const std::vector<Ptr<RefractiveCamera> >& handles)
{
    for (int c = 0; c < rig.count(); c++)
        cameraOf(handles[c]) = rig.cameras[c];
}

void checkCount(size_t count, int expected, const char* name, bool mayBeEmpty)
{
    if ((int)count != expected && !(mayBeEmpty && count == 0))
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d elements; there are %d cameras", name, (int)count, expected));
}

std::vector<Pose> readExtrinsicPoses(InputArrayOfArrays Rs, InputArrayOfArrays Ts, int cameras)
{
    std::vector<Pose> poses;
    for (const RigidTransform& camera : cameras == 1 ? std::vector<RigidTransform>(1) : readExtrinsics(Rs, Ts, cameras))
        poses.push_back(poseOf(camera));
    return poses;
}

void writeExtrinsicPoses(const Rig& rig, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts)
{
    std::vector<RigidTransform> extrinsics;
    for (const Pose& pose : rig.extrinsics)
        extrinsics.push_back(transformOf(pose));
    writeExtrinsics(extrinsics, Rs, Ts);
}

bool areExtrinsicsFree(int flags, const Rig& rig, const std::vector<CameraPrior>& priors)
{
    bool areFree = (flags & GLASS_FREE_EXTRINSICS) != 0;
    for (int c = 1; c < (int)priors.size(); c++)
    {
        const int first = rig.cameras[c].parameterCount();
        if (priors[c].covariance.cols() == first + 6)
            areFree = areFree || (priors[c].covariance.diagonal().tail(6).array() > 0).any();
    }
    return areFree;
}

}} // namespace
