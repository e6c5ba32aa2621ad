// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the joint fit for several cameras: arguments and results. */

#include "calibrate/fit_arguments.hpp"
#include "calibrate/fit_priors.hpp"
#include "calibrate/refit.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

//! What both forms do, but for the results beside cameras, Rs and Ts.
static RigFit calibrate(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                        const std::vector<std::vector<Mat> >& imagePointsRefracted,
                        const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                        InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputArrayOfArrays rvecs,
                        InputArrayOfArrays tvecs, int flags, InputArrayOfArrays poseCovariances, TermCriteria criteria,
                        InputArrayOfArrays cameraCovariances, InputArray targetCovariance,
                        const std::vector<std::vector<Mat> >& pixelCovariancesDirect,
                        const std::vector<std::vector<Mat> >& pixelCovariancesRefracted, bool wantsCovariance)
{
    const int count = (int)cameras.size();
    RigTask task;
    task.wantsCovariance = wantsCovariance;
    task.views = readRigViews(objectPoints, imagePointsDirect, imagePointsRefracted, count, HalfPixels::TAKEN);
    addPixelCovariances(pixelCovariancesDirect, pixelCovariancesRefracted, task.views);
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
        task.posePriors = readPosePriors(poseCovariances, task.knownPoses);
        for (int view = 0; view < task.views.count(); view++)
        {
            if (hasPoints(task.views, view))
                checkKnown(task.knownPoses[view], view, task.posePriors[view]);
            task.knownPoses[view].found = task.posePriors[view].tellsAll();
        }
    }
    task.cameraPriors = readCameraPriors(cameraCovariances, rig.cameras);
    task.targetCovariance = readTargetCovariance(targetCovariance);
    task.flags = flags & ~FROM_EARLIER_FIT;
    task.isRefit = (flags & FROM_EARLIER_FIT) != 0;
    task.criteria = criteria;
    const bool placesFollow = task.isIncremental(rig) && Rs.needed() && Ts.needed() && Rs.empty() && Ts.empty();
    rig.extrinsics = placesFollow ? std::vector<Pose>(count) : readExtrinsicPoses(Rs, Ts, count);

    const RigFit fit = fitCheckingPairs(rig, task);
    if (areExtrinsicsFree(flags, rig, task.cameraPriors))
        writeExtrinsicPoses(rig, Rs, Ts);
    setCameras(rig, cameras);           // last: what throws leaves them as they were
    return fit;
}

//! Of all calibrations of rigs.
static const int RIG_FLAGS = MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL;

FitStatistics fitGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                          const std::vector<std::vector<Mat> >& imagePointsRefracted, const std::vector<Ptr<RefractiveCamera> >& cameras,
                          const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
                          InputOutputArrayOfArrays rvecs, InputOutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                          OutputArray perViewErrors, OutputArray imageStatus, OutputArrayOfArrays inliers, OutputArray otherMinima,
                          InputArray targetCovariance, OutputArray targetErrors, int flags, InputArrayOfArrays poseCovariances,
                          TermCriteria criteria, InputArrayOfArrays cameraCovariances,
                          const std::vector<std::vector<Mat> >& pixelCovariancesDirect,
                          const std::vector<std::vector<Mat> >& pixelCovariancesRefracted)
{
    const RigFit fit = calibrate(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts,
                                 rvecs, tvecs, flags, poseCovariances, criteria, cameraCovariances, targetCovariance,
                                 pixelCovariancesDirect, pixelCovariancesRefracted, stdDeviations.needed() || covariance.needed());
    writeFit(fit, rvecs, tvecs, stdDeviations, covariance, perViewErrors);
    writeMat(fit.imageStatus, imageStatus);
    writeMasks(fit.inliers, inliers);
    writeMat(fit.otherMinima, otherMinima);
    writeMat(fit.targetErrors, targetErrors);
    return { fit.rms, fit.sigma, fit.freedom };
}

double calibrateGlassRig(InputArrayOfArrays objectPoints,
                         const std::vector<std::vector<Mat> >& imagePointsDirect,
                         const std::vector<std::vector<Mat> >& imagePointsRefracted,
                         const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                         InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                         InputOutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                         OutputArray perViewErrors, OutputArray imageStatus, OutputArrayOfArrays inliers,
                         OutputArray otherMinima, int flags, InputArrayOfArrays poseCovariances, TermCriteria criteria,
                         InputArrayOfArrays cameraCovariances, const std::vector<std::vector<Mat> >& pixelCovariancesDirect,
                         const std::vector<std::vector<Mat> >& pixelCovariancesRefracted)
{
    return calibrateGlassRig(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs,
                             stdDeviations, covariance, perViewErrors, imageStatus, inliers, otherMinima, noArray(), noArray(), flags,
                             poseCovariances, criteria, cameraCovariances, pixelCovariancesDirect, pixelCovariancesRefracted);
}

double calibrateGlassRig(InputArrayOfArrays objectPoints,
                         const std::vector<std::vector<Mat> >& imagePointsDirect,
                         const std::vector<std::vector<Mat> >& imagePointsRefracted,
                         const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                         InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                         InputOutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                         OutputArray perViewErrors, OutputArray imageStatus, OutputArrayOfArrays inliers,
                         OutputArray otherMinima, InputArray targetCovariance, OutputArray targetErrors, int flags,
                         InputArrayOfArrays poseCovariances, TermCriteria criteria, InputArrayOfArrays cameraCovariances,
                         const std::vector<std::vector<Mat> >& pixelCovariancesDirect,
                         const std::vector<std::vector<Mat> >& pixelCovariancesRefracted)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, RIG_FLAGS | GLASS_USE_POSES);
    return fitGlassRig(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs,
                       stdDeviations, covariance, perViewErrors, imageStatus, inliers, otherMinima, targetCovariance, targetErrors,
                       flags, poseCovariances, criteria, cameraCovariances, pixelCovariancesDirect, pixelCovariancesRefracted).rms;
}

double calibrateGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                         const std::vector<std::vector<Mat> >& imagePointsRefracted,
                         const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<int>& windowOfCamera,
                         InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts, OutputArrayOfArrays rvecs,
                         OutputArrayOfArrays tvecs, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, RIG_FLAGS);
    const RigFit fit = calibrate(objectPoints, imagePointsDirect, imagePointsRefracted, cameras, windowOfCamera, Rs, Ts,
                                 noArray(), noArray(), flags, noArray(), criteria, noArray(), noArray(), {}, {}, false);
    writeFit(fit, rvecs, tvecs, noArray(), noArray(), noArray());
    return fit.rms;
}

double stereoCalibrateGlass(InputArrayOfArrays objectPoints,
                            InputArrayOfArrays imagePointsDirect1, InputArrayOfArrays imagePointsRefracted1,
                            InputArrayOfArrays imagePointsDirect2, InputArrayOfArrays imagePointsRefracted2,
                            const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                            InputOutputArray R, InputOutputArray T, OutputArrayOfArrays rvecs,
                            OutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                            OutputArray perViewErrors, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

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
    task.flags = flags;
    task.criteria = criteria;
    task.wantsCovariance = stdDeviations.needed() || covariance.needed();

    const RigFit fit = fitCheckingPairs(rig, task);
    if (flags & GLASS_FREE_EXTRINSICS)
    {
        writeRotation(rotationMatrix(rig.extrinsics[1].rvec), R);
        Mat(rig.extrinsics[1].tvec).copyTo(T);
    }
    setCameras(rig, { camera1, camera2 });
    writeFit(fit, rvecs, tvecs, stdDeviations, covariance, perViewErrors);
    return fit.rms;
}

}} // namespace
