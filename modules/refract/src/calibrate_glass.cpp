// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the joint fit: arguments and starts. The problem is in rig_problem, what it tells in covariance. */

#include "arrays.hpp"
#include "residual.hpp"
#include "rig_fit.hpp"
#include "rig_start.hpp"
#include "rotation.hpp"

namespace cv { namespace refract {

namespace {

const int WINDOW_FLAGS = GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX;
const int MONO_FLAGS = WINDOW_FLAGS | GLASS_FREE_INTRINSICS | GLASS_FIX_PRINCIPAL_POINT;
const int STEREO_FLAGS = MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_SHARED_WINDOW;

void checkFlags(int flags, int allowed)
{
    if (flags & ~allowed)
        CV_Error_(Error::StsBadFlag, ("flags is %d; %d has no meaning here", flags, flags & ~allowed));
}

//! Refuses what no data can determine.
void checkWindow(const GlassWindow& window, int flags)
{
    const bool equalMedia = window.innerIndex == window.outerIndex;
    if (window.thickness.empty() && equalMedia)
        CV_Error_(Error::StsBadArg, ("window has no layer and equal media (index %g): it does not refract, so that its "
                                     "normal is undetermined", window.innerIndex));
    if (window.thickness.empty() && (flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX)))
        CV_Error_(Error::StsBadFlag, ("flags is %d, but window has no layer whose thickness or index could be free", flags));
    if (equalMedia && (flags & GLASS_FREE_DISTANCE))
        CV_Error_(Error::StsBadFlag, ("flags has GLASS_FREE_DISTANCE, but innerIndex and outerIndex are both %g: the "
                                      "distance has no effect then and is undetermined", window.innerIndex));
}

} // namespace

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsRefracted,
                      InputArrayOfArrays imagePointsDirect, const Ptr<RefractiveCamera>& camera_,
                      OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, OutputArray stdDeviations,
                      OutputArray covariance, OutputArray perViewErrors, OutputArray jacobian, int flags,
                      TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    Camera& camera = cameraOf(camera_);
    checkFlags(flags, MONO_FLAGS);
    checkWindow(camera.window(), flags);
    RigViews views;
    views.object = readObjectViews(objectPoints, "objectPoints");
    views.cameras.push_back(readCameraViews(imagePointsRefracted, "imagePointsRefracted", imagePointsDirect,
                                            "imagePointsDirect", views.object));
    const CameraViews& seen = views.cameras[0];
    if (!seesAnything(seen.refracted))
        CV_Error(Error::StsBadArg, "imagePointsRefracted has no point that was seen");

    std::vector<Camera> cameras(1, camera);
    cameras[0].setWindow(startWindow(camera, seen, views.object, flags));
    Pose none;
    const RigFit fit = fitRig(cameras, none, views, flags, criteria, jacobian.needed());
    camera = cameras[0];
    writeFit(fit, rvecs, tvecs, stdDeviations, covariance, perViewErrors, jacobian);
    return fit.rms;
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsRefracted,
                      InputArrayOfArrays imagePointsDirect, const Ptr<RefractiveCamera>& camera,
                      OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    return calibrateGlass(objectPoints, imagePointsRefracted, imagePointsDirect, camera, rvecs, tvecs, noArray(),
                          noArray(), noArray(), noArray(), flags, criteria);
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsRefracted,
                      InputArrayOfArrays imagePointsDirect, InputArray cameraMatrix, InputArray distCoeffs,
                      GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs,
                      OutputArray stdDeviations, OutputArray covariance, OutputArray perViewErrors,
                      OutputArray jacobian, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    if (flags & GLASS_FREE_INTRINSICS)
        CV_Error_(Error::StsBadFlag, ("flags is %d; GLASS_FREE_INTRINSICS needs the overload with RefractiveCamera, which "
                                      "returns the lens", flags));
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(cameraMatrix, distCoeffs, window);
    const double rms = calibrateGlass(objectPoints, imagePointsRefracted, imagePointsDirect, camera, rvecs, tvecs,
                                      stdDeviations, covariance, perViewErrors, jacobian, flags, criteria);
    window = camera->window();
    return rms;
}

double calibrateGlass(InputArrayOfArrays objectPoints, InputArrayOfArrays imagePointsRefracted,
                      InputArrayOfArrays imagePointsDirect, InputArray cameraMatrix, InputArray distCoeffs,
                      GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, int flags,
                      TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    return calibrateGlass(objectPoints, imagePointsRefracted, imagePointsDirect, cameraMatrix, distCoeffs, window, rvecs,
                          tvecs, noArray(), noArray(), noArray(), noArray(), flags, criteria);
}

namespace {

//! Camera 2's window is camera 1's; the fit refuses one that is behind camera 2.
GlassWindow seenByCamera2(GlassWindow window, const Pose& extrinsics)
{
    windowInCamera2(rotationMatrix(extrinsics.rvec), extrinsics.tvec, window.normal, window.distance);
    window.distance = std::max(window.distance, 0.);
    return window;
}

//! A window in the frame of camera 2 -> the same in the frame of camera 1.
GlassWindow seenByCamera1(GlassWindow window, const Pose& extrinsics)
{
    window.distance -= window.normal.dot(extrinsics.tvec);
    window.distance = std::max(window.distance, 0.);
    window.normal = rotationMatrix(extrinsics.rvec).t()*window.normal;
    return window;
}

void startWindows(std::vector<Camera>& cameras, const Pose& extrinsics, const RigViews& views, int flags)
{
    const bool shared = (flags & GLASS_SHARED_WINDOW) != 0, seenBy1 = seesAnything(views.cameras[0].refracted);
    if (seenBy1)
        cameras[0].setWindow(startWindow(cameras[0], views.cameras[0], views.object, flags));
    if (shared)
        cameras[1].setWindow(seenByCamera2(cameras[0].window(), extrinsics));
    if (shared && seenBy1)
        return;
    cameras[1].setWindow(startWindow(cameras[1], views.cameras[1], views.object, flags));
    if (shared)
        cameras[0].setWindow(seenByCamera1(cameras[1].window(), extrinsics));
}

} // namespace

double stereoCalibrateGlass(InputArrayOfArrays objectPoints,
                            InputArrayOfArrays imagePointsRefracted1, InputArrayOfArrays imagePointsDirect1,
                            InputArrayOfArrays imagePointsRefracted2, InputArrayOfArrays imagePointsDirect2,
                            const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                            InputOutputArray R, InputOutputArray T, OutputArrayOfArrays rvecs,
                            OutputArrayOfArrays tvecs, OutputArray stdDeviations, OutputArray covariance,
                            OutputArray perViewErrors, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    if (camera1 == camera2)
        CV_Error(Error::StsBadArg, "camera1 and camera2 are one object; each holds its own result");
    std::vector<Camera> cameras;
    cameras.push_back(cameraOf(camera1, "camera1"));
    cameras.push_back(cameraOf(camera2, "camera2"));
    const bool shared = (flags & GLASS_SHARED_WINDOW) != 0;
    checkFlags(flags, STEREO_FLAGS);
    for (int c = 0; c < (shared ? 1 : 2); c++)
        checkWindow(cameras[c].window(), flags);

    RigViews views;
    views.object = readObjectViews(objectPoints, "objectPoints");
    views.cameras.push_back(readCameraViews(imagePointsRefracted1, "imagePointsRefracted1", imagePointsDirect1,
                                            "imagePointsDirect1", views.object));
    views.cameras.push_back(readCameraViews(imagePointsRefracted2, "imagePointsRefracted2", imagePointsDirect2,
                                            "imagePointsDirect2", views.object));
    const bool seen1 = seesAnything(views.cameras[0].refracted), seen2 = seesAnything(views.cameras[1].refracted);
    if (shared ? !seen1 && !seen2 : !seen1 || !seen2)
        CV_Error_(Error::StsBadArg, ("imagePointsRefracted%d has no point that was seen", seen1 ? 2 : 1));

    Pose extrinsics;
    extrinsics.rvec = rotationVector(readRotation(R, "R"));
    extrinsics.tvec = readVec3(T, "T");
    extrinsics.found = true;
    startWindows(cameras, extrinsics, views, flags);
    const RigFit fit = fitRig(cameras, extrinsics, views, flags, criteria, false);

    cameraOf(camera1) = cameras[0];
    cameraOf(camera2) = cameras[1];
    if (flags & GLASS_FREE_EXTRINSICS)
    {
        Mat(rotationMatrix(extrinsics.rvec)).copyTo(R);
        Mat(extrinsics.tvec).copyTo(T);
    }
    writeFit(fit, rvecs, tvecs, stdDeviations, covariance, perViewErrors, noArray());
    return fit.rms;
}

}} // namespace
