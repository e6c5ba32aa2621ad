// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the joint fit for several cameras: arguments and results. */

#include "calibrate/fit_arguments.hpp"
#include "calibrate/fit_priors.hpp"
#include "calibrate/refit.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

//! What is known beside images and poses, and what is wanted; the cameras have their parameters.
static void readOptions(const GlassRigOptions& options, const Rig& rig, RigTask& task)
{
    checkPoseCovariances(options.poseCovariances, options.flags);
    task.cameraPriors = readCameraPriors(options.cameraCovariances, rig.cameras);
    task.targetCovariance = readTargetCovariance(options.targetCovariance);
    task.flags = options.flags & ~FROM_EARLIER_FIT;
    task.isRefit = (options.flags & FROM_EARLIER_FIT) != 0;
    task.criteria = options.criteria;
    task.wantsCovariance = options.computeCovariance;
}

//! What both forms for any number of cameras do, but for the results beside cameras, Rs and Ts.
static RigFit calibrate(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                        const std::vector<std::vector<Mat> >& imagePointsRefracted,
                        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputArrayOfArrays rvecs,
                        InputArrayOfArrays tvecs, const GlassRigOptions& options)
{
    const int flags = options.flags;
    const int count = (int)cameras.size();
    RigTask task;
    task.views = readRigViews(objectPoints, imagePointsDirect, imagePointsRefracted, count, HalfPixels::TAKEN);
    addPixelCovariances(options.pixelCovariancesDirect, options.pixelCovariancesRefracted, task.views);
    checkCount(imagePointsRefracted.size(), count, "imagePointsRefracted", false);
    checkCount(windowOfCamera.size(), count, "windowOfCamera", true);
    std::vector<String> names, refractedNames;
    for (int c = 0; c < count; c++)
    {
        names.push_back(numbered("cameras", c));
        refractedNames.push_back(numbered("imagePointsRefracted", c));
    }
    Rig rig;
    rig.cameras = camerasOf(cameras, names);
    addParameters(rig.cameras, flags);
    setOwners(rig, windowOfCamera);
    checkWindows(rig, task.views, flags, refractedNames);
    if (flags & GLASS_USE_POSES)
    {
        task.knownPoses = readPoses(rvecs, tvecs, task.views.count());
        task.posePriors = readPosePriors(options.poseCovariances, task.knownPoses);
        for (int view = 0; view < task.views.count(); view++)
        {
            if (hasPoints(task.views, view))
                checkKnown(task.knownPoses[view], view, task.posePriors[view]);
            task.knownPoses[view].found = task.posePriors[view].tellsAll();
        }
    }
    readOptions(options, rig, task);
    const bool placesFollow = task.isIncremental(rig) && Rs.needed() && Ts.needed() && Rs.empty() && Ts.empty();
    rig.extrinsics = placesFollow ? std::vector<Pose>(count) : readExtrinsicPoses(Rs, Ts, count);

    const RigFit fit = fitCheckingPairs(rig, task);
    if (areExtrinsicsFree(flags, rig, task.cameraPriors))
        writeExtrinsicPoses(rig, Rs, Ts);
    setCameras(rig, cameras);           // last of these: what throws leaves them as they were
    return fit;
}

//! Of all calibrations of rigs.
static const int RIG_FLAGS = MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL;

static GlassRigResult resultOf(const RigFit& fit, const GlassRigOptions& options)
{
    GlassRigResult result;
    result.rms = fit.rms;
    result.pixelStd = fit.sigma;
    result.degreesOfFreedom = fit.freedom;
    if (options.computeCovariance)      // else it is not as it holds
    {
        result.stdDeviations = fit.stdDeviations;
        result.covariance = fit.covariance;
    }
    result.perViewErrors = fit.perViewErrors;
    result.imageStatus = fit.imageStatus;
    result.inliers = fit.inliers;
    result.otherMinima = fit.otherMinima;
    result.targetErrors = fit.targetErrors;
    return result;
}

GlassRigResult fitGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                           const std::vector<std::vector<Mat> >& imagePointsRefracted,
                           const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                           InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                           InputOutputArrayOfArrays tvecs, const GlassRigOptions& options)
{
    const RigFit fit = calibrate(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs,
                                 options);
    writePoses(fit.poses, rvecs, tvecs);
    return resultOf(fit, options);
}

GlassRigResult calibrateGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                                 const std::vector<std::vector<Mat> >& imagePointsRefracted,
                                 const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                                 InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                                 InputOutputArrayOfArrays tvecs, const GlassRigOptions& options)
{
    CV_INSTRUMENT_REGION();

    checkFlags(options.flags, RIG_FLAGS | GLASS_USE_POSES);
    return fitGlassRig(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs, options);
}

double calibrateGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                         const std::vector<std::vector<Mat> >& imagePointsRefracted,
                         const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                         InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, OutputArrayOfArrays rvecs,
                         OutputArrayOfArrays tvecs, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, RIG_FLAGS);
    GlassRigOptions options(flags);
    options.criteria = criteria;
    options.computeCovariance = false;
    const RigFit fit = calibrate(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts,
                                 noArray(), noArray(), options);
    writePoses(fit.poses, rvecs, tvecs);
    return fit.rms;
}

GlassRigResult stereoCalibrateGlass(InputArrayOfArrays objectPoints,
                                    InputArrayOfArrays imagePointsDirect1, InputArrayOfArrays imagePointsRefracted1,
                                    InputArrayOfArrays imagePointsDirect2, InputArrayOfArrays imagePointsRefracted2,
                                    const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                                    InputOutputArray R, InputOutputArray T, OutputArrayOfArrays rvecs,
                                    OutputArrayOfArrays tvecs, const GlassRigOptions& options)
{
    CV_INSTRUMENT_REGION();

    const int flags = options.flags;
    checkFlags(flags, MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_SHARED_WINDOW);
    Rig rig;
    rig.cameras = camerasOf({ camera1, camera2 }, { "camera1", "camera2" });
    addParameters(rig.cameras, flags);
    rig.extrinsics = { Pose(), poseOf({ readRotation(R, "R"), readVec3(T, "T") }) };
    setOwners(rig, flags & GLASS_SHARED_WINDOW ? std::vector<int>{ 0, 0 } : std::vector<int>{ 0, 1 });
    RigTask task;
    task.views.object = readObjectViews(objectPoints, "objectPoints");
    task.views.cameras.push_back(readCameraViews(imagePointsDirect1, "imagePointsDirect1", imagePointsRefracted1,
                                                 "imagePointsRefracted1", task.views.object));
    task.views.cameras.push_back(readCameraViews(imagePointsDirect2, "imagePointsDirect2", imagePointsRefracted2,
                                                 "imagePointsRefracted2", task.views.object));
    checkWindows(rig, task.views, flags, { "imagePointsRefracted1", "imagePointsRefracted2" });
    addPixelCovariances(options.pixelCovariancesDirect, options.pixelCovariancesRefracted, task.views);
    readOptions(options, rig, task);

    const RigFit fit = fitCheckingPairs(rig, task);
    if (areExtrinsicsFree(flags, rig, task.cameraPriors))
    {
        writeRotation(rotationMatrix(rig.extrinsics[1].rvec), R);
        Mat(rig.extrinsics[1].tvec).copyTo(T);
    }
    setCameras(rig, { camera1, camera2 });
    writePoses(fit.poses, rvecs, tvecs);
    return resultOf(fit, options);
}

}} // namespace
