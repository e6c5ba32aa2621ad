// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Public functions of the bundle adjustment: arguments and results; of pixels: bundle_images.cpp. */

#include "calibrate/bundle_fit.hpp"
#include "calibrate/fit_arguments.hpp"
#include "calibrate/fit_priors.hpp"
#include "calibrate/calibration_error.hpp"
#include "calibrate/failure.hpp"
#include "arrays/arrays.hpp"
#include "math/covariance_matrix.hpp"

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

KnownLength checkedLength(const double* row, int i, int pointCount)
{
    const auto isIndex = [&](double value) { return value >= 0 && value < pointCount && value == std::floor(value); };
    if (!isIndex(row[0]) || !isIndex(row[1]) || row[0] == row[1])
        CV_Error_(Error::StsOutOfRange, ("lengths[%d] is between points %g and %g; they must be two different ones of the %d "
                                         "of the scene, counted from 0", i, row[0], row[1], pointCount));
    const KnownLength length = { (int)row[0], (int)row[1], row[2], row[3] };
    if (!(length.length > 0 && std::isfinite(length.length)) || !(length.sigma > 0 && std::isfinite(length.sigma)))
        CV_Error_(Error::StsBadArg, ("lengths[%d] is %g with a standard deviation of %g; both must be positive", i,
                                     length.length, length.sigma));
    return length;
}

std::vector<KnownLength> readLengths(InputArray lengths, int pointCount)
{
    std::vector<KnownLength> known;
    if (lengths.empty())
        return known;
    const Mat given = lengths.getMat();
    const bool isList = given.channels() == 4 && (given.rows == 1 || given.cols == 1);
    if (given.dims > 2 || !(isList || (given.channels() == 1 && given.cols == 4)))
        CV_Error_(Error::StsBadSize, ("lengths is %dx%d with %d channels; it must be Lx4: point, point, length, its standard "
                                      "deviation", given.rows, given.cols, given.channels()));
    Mat_<double> rows;
    given.clone().reshape(1, isList ? (int)given.total() : given.rows).convertTo(rows, CV_64F);
    for (int i = 0; i < rows.rows; i++)
        if (!std::isnan(rows(i, 3)))            // else nothing is known of it
            known.push_back(checkedLength(rows[i], i, pointCount));
    return known;
}

//! The scene's frame is that of the first view, in what is known of no pose.
void holdFrame(int first, BundleTask& task)
{
    const auto isTold = [&](bool (PosePrior::*tells)() const)
    {
        return std::any_of(task.posePriors.begin(), task.posePriors.end(), [=](const PosePrior& prior) { return (prior.*tells)(); });
    };
    const bool isTurned = isTold(&PosePrior::tellsRotation), isPlaced = isTold(&PosePrior::tellsTranslation);
    if (!isTurned && !isPlaced)
        task.posePriors[first].kind = PosePrior::EXACT;
    else if (!isTurned || !isPlaced)
        holdExactly(isTurned ? 3 : 0, norm(task.poses[first].tvec), task.posePriors[first]);
}

//! One view stands where it is; more need a start.
void readViewPoses(InputArrayOfArrays rvecs, InputArrayOfArrays tvecs, const std::vector<Mat>& covariances, int count,
                   BundleTask& task)
{
    const bool isGiven = count > 1 || !rvecs.empty() || !tvecs.empty();
    task.poses = isGiven ? readPoses(rvecs, tvecs, count) : std::vector<Pose>(1);
    if (task.flags & GLASS_USE_POSES)
        task.posePriors = readPosePriors(covariances, task.poses);
    else
        task.posePriors.resize(count);
    const std::vector<bool> isSeen = task.images.seenViews();
    int first = -1;                     // of the views with an image
    for (int view = 0; view < count; view++)
    {
        if (!isSeen[view])
        {
            task.posePriors[view] = PosePrior();
            task.poses[view] = Pose();
            continue;
        }
        PosePrior all;                  // each view needs a start
        all.kind = PosePrior::EXACT;
        checkKnown(task.poses[view], view, all);
        first = first < 0 ? view : first;
    }
    holdFrame(std::max(first, 0), task);
}

//! PxP, in the order of stdDeviations; or nothing.
Eigen::MatrixXd readRigCovariance(const Mat& given, const std::vector<Camera>& cameras)
{
    if (given.empty())
        return Eigen::MatrixXd();
    int count = 6*((int)cameras.size() - 1);
    for (const Camera& camera : cameras)
        count += camera.parameterCount();
    if (given.channels() != 1 || given.rows != count || given.cols != count)
        CV_Error_(Error::StsBadSize, ("rigCovariance is %dx%d with %d channels; it must be %dx%d (the parameters of each camera, then R "
                                      "and T of each but the first), or empty", given.rows, given.cols, given.channels(), count, count));
    Mat_<double> numbers;
    given.convertTo(numbers, CV_64F);
    Mat_<double> known = knownCovariance(numbers, "rigCovariance");
    for (int i = 0; i < count; i++)
        if (std::isnan(known(i, i)))
            known(i, i) = 0;            // the flags decide
    return Eigen::Map<const RowMajorMatrix>(known.ptr<double>(), count, count);
}

//! Whether something is known of where a camera of the rig is: by its prior, else as the flags have it.
bool isPlaceKnown(const Rig& rig, const BundleTask& task, int c)
{
    const int T = rig.cameras[c].parameterCount() + 3;
    if (!task.cameraPriors.empty() && task.cameraPriors[c].covariance.cols() == T + 3)
    {
        const Eigen::VectorXd variances = task.cameraPriors[c].covariance.diagonal().tail(3);
        if ((variances.array() == variances.array()).any())     // not NaN
            return true;
    }
    if (task.rigCovariance.size() > 0)
    {
        int row = 6*(c - 1) + 3;
        for (const Camera& camera : rig.cameras)
            row += camera.parameterCount();
        if ((task.rigCovariance.diagonal().segment(row, 3).array() > 0).any())
            return true;
    }
    return !(task.flags & GLASS_FREE_EXTRINSICS);
}

//! What tells the scale.
void checkScale(const Rig& rig, BundleTask& task)
{
    for (int c = 1; c < rig.count(); c++)
        task.scale.isRigKnown = task.scale.isRigKnown || isPlaceKnown(rig, task, c);
    const auto isPlaced = [](const PosePrior& prior) { return prior.tellsTranslation(); };
    task.scale.arePosesKnown = std::count_if(task.posePriors.begin(), task.posePriors.end(), isPlaced) > 1;
    task.scale.areLengthsKnown = !task.lengths.empty() && !std::isnan(task.lengthScaleSigma);
    if (task.scale.any())
        return;
    const String reason = "nothing tells the scale";
    raise(CalibrationError(CalibrationError::NO_SCALE, reason + ": give a length between two points (lengths, and a lengthScaleStd that "
                           "is a number), R and T of several cameras without GLASS_FREE_EXTRINSICS or with their covariance, or the "
                           "poses of several views (GLASS_USE_POSES)", reason));
}

void writePoints(const std::vector<Point3d>& points, int depth, OutputArray out)
{
    PointWriter writer(out, (int)points.size(), 3, depth);
    const int count = (int)points.size();
    for (int begin = 0; begin < count; begin += BLOCK)
    {
        const int n = std::min(BLOCK, count - begin);
        double x[BLOCK], y[BLOCK], z[BLOCK];
        uchar status[BLOCK];
        for (int k = 0; k < n; k++)
        {
            const Point3d& point = points[begin + k];
            x[k] = point.x; y[k] = point.y; z[k] = point.z;
            status[k] = std::isfinite(point.x) ? REFRACT_OK : REFRACT_NOT_CONVERGED;
        }
        writer.store(begin, n, x, y, z, status);
    }
}

//! What all forms do.
BundleFit adjust(const BundleImages& images, const std::vector<Point3d>& points, const std::vector<Ptr<RefractiveCamera> >& cameras,
                 const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
                 InputArrayOfArrays rvecs, InputArrayOfArrays tvecs, InputOutputArray points3D, InputArray lengths,
                 const BundleAdjustOptions& options)
{
    const int flags = options.flags;
    const int count = (int)cameras.size();
    checkCount(windowOfCamera.size(), count, "windowOfCamera", true);
    std::vector<String> names, ofImages;
    for (int c = 0; c < count; c++)
    {
        names.push_back(numbered("cameras", c));
        ofImages.push_back(numbered("imagePoints", c));
    }
    BundleTask task;
    task.images = images;
    task.flags = flags;
    task.criteria = options.criteria;
    task.wantsPoseCovariances = options.computeViewCovariances;
    task.wantsPointDeviations = options.computePointDeviations;
    if (!(options.covarianceMemory >= 0))
        CV_Error_(Error::StsBadArg, ("covarianceMemory is %g; it must not be negative", options.covarianceMemory));
    task.covarianceMemory = options.covarianceMemory;
    task.points = points;
    const int depth = task.points.empty() ? CV_64F : points3D.depth();
    task.points.resize(images.points, Point3d(NaN, NaN, NaN));
    task.lengths = readLengths(lengths, images.points);
    checkPoseCovariances(options.poseCovariances, flags);
    readViewPoses(rvecs, tvecs, options.poseCovariances, images.views, task);

    Rig rig;
    rig.cameras = camerasOf(cameras, names);
    addParameters(rig.cameras, flags);
    rig.extrinsics = readExtrinsicPoses(Rs, Ts, count);
    setOwners(rig, windowOfCamera);
    if (!options.rigCovariance.empty() && !options.cameraCovariances.empty())
        CV_Error(Error::StsBadArg, "cameraCovariances and rigCovariance are both given; give one: rigCovariance is of all cameras");
    task.rigCovariance = readRigCovariance(options.rigCovariance, rig.cameras);
    if (options.lengthScaleStd < 0 || std::isinf(options.lengthScaleStd))
        CV_Error_(Error::StsBadArg, ("lengthScaleStd is %g; it must be finite and not negative, or NaN: not known",
                                     options.lengthScaleStd));
    task.lengthScaleSigma = task.lengths.empty() ? 0 : options.lengthScaleStd;
    task.cameraPriors = readCameraPriors(options.cameraCovariances, rig.cameras);
    checkScale(rig, task);
    checkWindows(rig, images.seeingCameras(), flags, ofImages);

    BundleFit fit;
    throwUnlessConverged(fitBundle(rig, task, fit), FitKind::BUNDLE);
    if (areExtrinsicsFree(flags, rig, task.cameraPriors) || (count > 1 && task.rigCovariance.size() > 0))
        writeExtrinsicPoses(rig, Rs, Ts);
    setCameras(rig, cameras);
    writePoints(fit.points, depth, points3D);
    return fit;
}

const int BUNDLE_FLAGS = MONO_FLAGS | GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL;

//! Of a list of observations: one array.
Mat listedCovariances(const std::vector<std::vector<Mat> >& given)
{
    if (given.empty() || (given.size() == 1 && given[0].empty()))
        return Mat();
    if (given.size() != 1 || given[0].size() != 1)
        CV_Error_(Error::StsBadSize, ("pixelCovariances is %d lists, the first of %d arrays; of a list of observations it must be one "
                                      "list of one array, or empty", (int)given.size(), (int)given[0].size()));
    return given[0][0];
}

BundleAdjustResult resultOf(const BundleFit& fit, const std::vector<Mat>& inliers)
{
    BundleAdjustResult result;
    result.rms = fit.rms;
    result.pixelStd = fit.sigma;
    result.degreesOfFreedom = fit.freedom;
    result.stdDeviations = fit.stdDeviations;
    result.covariance = fit.covariance;
    result.pointDeviations = fit.pointDeviations;
    result.viewCovariances = fit.poseCovariances;
    result.perViewErrors = fit.perViewErrors;
    result.inliers = inliers;
    return result;
}

} // namespace

BundleAdjustResult refractiveBundleAdjust(const std::vector<std::vector<Mat> >& imagePoints,
                                          const std::vector<Ptr<RefractiveCamera> >& cameras,
                                          const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs,
                                          InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                                          InputOutputArrayOfArrays tvecs, InputOutputArray points3D, InputArray lengths,
                                          const BundleAdjustOptions& options)
{
    CV_INSTRUMENT_REGION();

    checkFlags(options.flags, BUNDLE_FLAGS | GLASS_USE_POSES);
    std::vector<PixelViews> pixels;
    for (size_t c = 0; c < imagePoints.size(); c++)
        pixels.push_back(readPixelViews(imagePoints[c], numbered("imagePoints", (int)c).c_str(), HalfPixels::TAKEN));
    const std::vector<Point3d> points = readPoints3(points3D, "points3D");
    const BundleImages images = denseImages(pixels, (int)cameras.size(), (int)points.size(), options.pixelCovariances);
    const BundleFit fit = adjust(images, points, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs, points3D, lengths, options);
    writePoses(fit.poses, rvecs, tvecs);
    return resultOf(fit, denseMasks(images, fit.isUsed));
}

BundleAdjustResult refractiveBundleAdjust(InputArray observations, InputArray imagePoints,
                                          const std::vector<Ptr<RefractiveCamera> >& cameras,
                                          const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs,
                                          InputOutputArrayOfArrays Ts, InputOutputArrayOfArrays rvecs,
                                          InputOutputArrayOfArrays tvecs, InputOutputArray points3D, InputArray lengths,
                                          const BundleAdjustOptions& options)
{
    CV_INSTRUMENT_REGION();

    checkFlags(options.flags, BUNDLE_FLAGS | GLASS_USE_POSES);
    const std::vector<Point3d> points = readPoints3(points3D, "points3D");
    const BundleImages images = listedImages(observations, imagePoints, (int)cameras.size(), countVectors(rvecs, "rvecs"),
                                             (int)points.size(), listedCovariances(options.pixelCovariances));
    const BundleFit fit = adjust(images, points, cameras, windowOfCamera, Rs, Ts, rvecs, tvecs, points3D, lengths, options);
    writePoses(fit.poses, rvecs, tvecs);
    return resultOf(fit, { listedMask(images, fit.isUsed) });
}

double refractiveBundleAdjust(InputArrayOfArrays imagePoints, const std::vector<Ptr<RefractiveCamera> >& cameras,
                              const std::vector<int>& windowOfCamera, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts,
                              InputOutputArray points3D, InputArray lengths, int flags, TermCriteria criteria)
{
    CV_INSTRUMENT_REGION();

    checkFlags(flags, BUNDLE_FLAGS);
    std::vector<PixelViews> pixels;
    for (const std::vector<Point2d>& ofCamera : readPixelViews(imagePoints, "imagePoints", HalfPixels::TAKEN))
        pixels.push_back(PixelViews(1, ofCamera));
    const std::vector<Point3d> points = readPoints3(points3D, "points3D");
    BundleAdjustOptions options(flags);
    options.criteria = criteria;
    options.computePointDeviations = options.computeViewCovariances = false;
    const BundleImages images = denseImages(pixels, (int)cameras.size(), (int)points.size(), {});
    return adjust(images, points, cameras, windowOfCamera, Rs, Ts, noArray(), noArray(), points3D, lengths, options).rms;
}

}} // namespace
