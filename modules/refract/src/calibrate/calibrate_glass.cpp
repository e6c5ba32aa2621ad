// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the joint fit for one camera: a rig of one. */

#include "calibrate/fit_arguments.hpp"

namespace cv { namespace refract {

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
                      InputArrayOfArrays imagePointsRefracted, const Ptr<RefractiveCamera>& camera,
                      OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
                      OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian, int flags,
                      TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, MONO_FLAGS);
    Rig rig = { { cameraOf(camera) }, { 0 }, { Pose() } };
    addParameters(rig.cameras, flags);
    RigTask task;
    task.views.object = readObjectViews(objectPoints, "objectPoints");
    task.views.cameras.push_back(readCameraViews(imagePointsDirect, "imagePointsDirect", imagePointsRefracted,
                                                 "imagePointsRefracted", task.views.object));
    checkWindows(rig, task.views, flags, { "imagePointsRefracted" });
    task.flags = flags;
    task.criteria = criteria;
    task.wantsJacobian = jacobian.needed();
    task.wantsCovariance = stdDeviations.needed() || covariance.needed();
    const RigFit fit = fitCheckingPairs(rig, task);
    cameraOf(camera) = rig.cameras[0];
    writePoses(fit.poses, rvecs, tvecs);
    writeMat(fit.stdDeviations, stdDeviations);
    writeMat(fit.covariance, covariance);
    writeMat(fit.perViewErrors, perViewErrors);
    writeMat(fit.jacobian, jacobian);
    return fit.rms;
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
                      InputArrayOfArrays imagePointsRefracted, const Ptr<RefractiveCamera>& camera,
                      OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    return calibrateGlass(objectPoints, imagePointsDirect, imagePointsRefracted, camera, rvecs, tvecs, noArray(),
                          noArray(), noArray(), noArray(), flags, criteria);
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
                      InputArrayOfArrays imagePointsRefracted, InputArray cameraMatrix, InputArray distCoeffs,
                      GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
                      OutputArray stdDeviations, OutputArray covariance, OutputArray perViewErrors,
                      OutputArray jacobian, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    if (flags & GLASS_FREE_INTRINSICS)
        CV_Error_(Error::StsBadFlag, ("flags is %d; GLASS_FREE_INTRINSICS needs the overload with RefractiveCamera, which "
                                      "returns the lens", flags));
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(cameraMatrix, distCoeffs, window);
    const double rms = calibrateGlass(objectPoints, imagePointsDirect, imagePointsRefracted, camera, rvecs, tvecs,
                                      stdDeviations, covariance, perViewErrors, jacobian, flags, criteria);
    window = camera->window();
    return rms;
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsDirect,
                      InputArrayOfArrays imagePointsRefracted, InputArray cameraMatrix, InputArray distCoeffs,
                      GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags,
                      TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    return calibrateGlass(objectPoints, imagePointsDirect, imagePointsRefracted, cameraMatrix, distCoeffs, window, rvecs,
                          tvecs, noArray(), noArray(), noArray(), noArray(), flags, criteria);
}

}} // namespace
