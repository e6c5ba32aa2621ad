// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the joint fit for several cameras: arguments and results. */

#include "calibrate/calibrate_rig.hpp"
#include "calibrate/calibration_error.hpp"
#include "calibrate/refit.hpp"
#include "start/pose_start.hpp"
#include "start/rig_task.hpp"
#include "math/covariance_matrix.hpp"
#include "math/rotation.hpp"
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
    if (equalMedia && (flags & GLASS_FREE_DISTANCE))
        CV_Error_(Error::StsBadFlag, ("flags has GLASS_FREE_DISTANCE, but innerIndex and outerIndex are both %g: the "
                                      "distance has no effect then and is undetermined", window.innerIndex));
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

//! Covariances of what was read; nothing if there are none.
static void addPixelCovariances(const std::vector<std::vector<Mat> >& direct, const std::vector<std::vector<Mat> >& refracted,
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
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d elements; cameras has %d", name, (int)count, expected));
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

//! Vectors as calib3d keeps them: one array a view, or one array of 3-vectors. They may be NaN.
int countVectors(InputArrayOfArrays a, const char* name)
{
    if (a.empty())
        return 0;
    return a.isMatVector() || a.kind() == _InputArray::STD_VECTOR_VECTOR ? (int)a.total() : (int)readPoints3(a, name).size();
}

static std::vector<Vec3d> readVectors(InputArrayOfArrays a, int count, const char* name)
{
    std::vector<Vec3d> vectors;
    if (a.isMatVector() || a.kind() == _InputArray::STD_VECTOR_VECTOR)
        for (int i = 0; i < (int)a.total(); i++)
        {
            Mat numbers;
            a.getMat(i).convertTo(numbers, CV_64F);
            if (numbers.total()*numbers.channels() != 3)
                CV_Error_(Error::StsBadSize, ("%s has %d values; it must be a vector of 3", numbered(name, i).c_str(),
                                              (int)numbers.total()*numbers.channels()));
            vectors.push_back(Vec3d(numbers.ptr<double>()));
        }
    else
        for (const Point3d& p : readPoints3(a, name))
            vectors.push_back(Vec3d(p));
    if ((int)vectors.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d vectors, but there are %d views, whose poses must be given", name,
                                             (int)vectors.size(), count));
    return vectors;
}

//! What is exact beside what is not: far below what images tell, so that it is a prior as the rest.
static double exactly(int coordinate, double distance)
{
    const double EXACTLY = 1e-8;        // radians, and of the distance
    return coordinate < 3 || !(distance > 0) ? EXACTLY : EXACTLY*distance;
}

void holdExactly(int first, double distance, PosePrior& prior)
{
    const int rows = (int)prior.sqrtInformation.rows();
    prior.kind = PosePrior::UNCERTAIN;
    prior.sqrtInformation.conservativeResize(rows + 3, 6);
    prior.sqrtInformation.bottomRows(3).setZero();
    for (int i = 0; i < 3; i++)
        prior.sqrtInformation(rows + i, first + i) = 1/exactly(first + i, distance);
}

static PosePrior readPosePrior(InputArray covariance, const Pose& pose, const String& name)
{
    PosePrior prior;
    prior.kind = PosePrior::EXACT;
    Mat numbers;
    covariance.getMat().convertTo(numbers, CV_64F);
    const int values = (int)numbers.total()*numbers.channels();
    if (values == 0)
        return prior;
    if (values != 36)
        CV_Error_(Error::StsBadSize, ("%s has %d values; it must be 6x6, or empty", name.c_str(), values));
    const Mat_<double> all = knownCovariance(numbers.reshape(1, 6), name);
    if (countNonZero(all) == 0)
        return prior;
    std::vector<int> known;
    for (int i = 0; i < 6; i++)
        if (!std::isnan(all(i, i)))
            known.push_back(i);
    prior.kind = known.empty() ? PosePrior::NONE : PosePrior::UNCERTAIN;
    if (known.empty())
        return prior;
    const double distance = norm(pose.tvec);
    const int count = (int)known.size();
    Eigen::MatrixXd C(count, count), rows = Eigen::MatrixXd::Zero(count, 6);
    for (int i = 0; i < count; i++)
    {
        for (int j = 0; j < count; j++)
            C(i, j) = all(known[i], known[j]);
        if (C(i, i) == 0)
            C(i, i) = std::pow(exactly(known[i], distance), 2);
        rows(i, known[i]) = 1;
    }
    prior.sqrtInformation = whiten(C, rows);
    return prior;
}

std::vector<Pose> readPoses(InputArrayOfArrays rvecs, InputArrayOfArrays tvecs, int count)
{
    const std::vector<Vec3d> r = readVectors(rvecs, count, "rvecs"), t = readVectors(tvecs, count, "tvecs");
    std::vector<Pose> poses(count);
    for (int view = 0; view < count; view++)
    {
        poses[view].rvec = r[view];
        poses[view].tvec = t[view];
        poses[view].found = std::isfinite(norm(r[view])) && std::isfinite(norm(t[view]));
    }
    return poses;
}

void checkKnown(const Pose& pose, int view, const PosePrior& prior)
{
    for (int i = 0; i < 6; i++)
    {
        const double value = i < 3 ? pose.rvec[i] : pose.tvec[i - 3];
        if (prior.tells(i) && !std::isfinite(value))
            CV_Error_(Error::StsBadArg, ("%s[%d] is %g; it must be finite", numbered(i < 3 ? "rvecs" : "tvecs", view).c_str(), i % 3,
                                         value));
    }
}

std::vector<PosePrior> readPosePriors(InputArrayOfArrays covariances, const std::vector<Pose>& poses)
{
    const int count = (int)poses.size();
    std::vector<Mat> all;
    if (!covariances.empty())
        covariances.getMatVector(all);              // of a std::vector<Matx66d>, too
    if (!all.empty() && (int)all.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("poseCovariances has %d elements, but there are %d views", (int)all.size(), count));
    all.resize(count);
    std::vector<PosePrior> priors;
    for (int view = 0; view < count; view++)
        priors.push_back(readPosePrior(all[view], poses[view], numbered("poseCovariances", view)));
    return priors;
}

std::vector<CameraPrior> readCameraPriors(InputArrayOfArrays covariances, const std::vector<Camera>& cameras)
{
    std::vector<CameraPrior> priors;
    if (covariances.empty())
        return priors;
    std::vector<Mat> all;
    covariances.getMatVector(all);
    checkCount(all.size(), (int)cameras.size(), "cameraCovariances", false);
    for (int c = 0; c < (int)all.size(); c++)
    {
        const String name = numbered("cameraCovariances", c);
        const int lens = cameras[c].lensCount(), both = cameras[c].parameterCount(), side = all[c].rows;
        if (!all[c].empty() && (all[c].channels() != 1 || all[c].cols != side ||
                                (side != lens && side != both && side != both + 6)))
            CV_Error_(Error::StsBadSize, ("%s is %dx%d with %d channels; it must be %dx%d (lens), %dx%d (lens and window), %dx%d "
                                          "(these, rvec and T) or empty", name.c_str(), side, all[c].cols, all[c].channels(), lens, lens,
                                          both, both, both + 6, both + 6));
        CameraPrior prior;
        Mat_<double> numbers;
        all[c].convertTo(numbers, CV_64F);
        const Mat_<double> known = knownCovariance(numbers, name);
        if (!known.empty())
            prior.covariance = Eigen::Map<const RowMajorMatrix>(known.ptr<double>(), side, side);
        if (prior.covariance.diagonal().array().isNaN().all())      // nothing is known
            prior.covariance.resize(0, 0);
        priors.push_back(prior);
    }
    return priors;
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

//! 7x7, or nothing.
static Eigen::MatrixXd readTargetCovariance(InputArray covariance)
{
    const int count = SharedTargetErrors::COUNT;
    const Mat given = covariance.getMat();
    if (given.empty())
        return Eigen::MatrixXd();
    if (given.channels() != 1 || given.rows != count || given.cols != count)
        CV_Error_(Error::StsBadSize, ("targetCovariance is %dx%d with %d channels; it must be 7x7 (relative error of the scale, "
                                      "rotation vector, translation), or empty", given.rows, given.cols, given.channels()));
    Mat_<double> numbers;
    given.convertTo(numbers, CV_64F);
    const Mat_<double> known = knownCovariance(numbers, "targetCovariance");
    return Eigen::Map<const RowMajorMatrix>(known.ptr<double>(), count, count);
}

void writeMasks(const std::vector<Mat>& masks, OutputArrayOfArrays out)
{
    if (!out.needed())
        return;
    out.create((int)masks.size(), 1, CV_8U);
    for (int i = 0; i < (int)masks.size(); i++)
    {
        if (masks[i].empty())
        {
            out.create(0, 0, CV_8U, i, true);
            continue;
        }
        out.create(masks[i].size(), CV_8U, i, true);
        masks[i].copyTo(out.getMat(i));
    }
}

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
    setCameras(rig, cameras);
    if (areExtrinsicsFree(flags, rig, task.cameraPriors))
        writeExtrinsicPoses(rig, Rs, Ts);
    return fit;
}

//! Of all calibrations of rigs.
static const int RIG_FLAGS = MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL;

double fitGlassRig(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
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
    return fit.rms;
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
                       flags, poseCovariances, criteria, cameraCovariances, pixelCovariancesDirect, pixelCovariancesRefracted);
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
    setCameras(rig, { camera1, camera2 });
    if (flags & GLASS_FREE_EXTRINSICS)
    {
        Mat(rotationMatrix(rig.extrinsics[1].rvec)).copyTo(R);
        Mat(rig.extrinsics[1].tvec).copyTo(T);
    }
    writeFit(fit, rvecs, tvecs, stdDeviations, covariance, perViewErrors);
    return fit.rms;
}

}} // namespace
