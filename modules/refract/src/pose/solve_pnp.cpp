// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The public calls for one view's pose, without wrong matches. */

#include "pose/pose_covariance.hpp"
#include "arrays/arrays.hpp"

namespace cv { namespace refract {

//! What can be checked before it is known which points were seen.
static void readTarget(InputArray objectPoints_, InputArray imagePoints_, int least, int most, std::vector<Point3d>& objectPoints,
                       std::vector<Point2d>& imagePoints)
{
    objectPoints = readPoints3(objectPoints_, "objectPoints");
    imagePoints = readPoints2(imagePoints_, "imagePoints");
    if (objectPoints.size() != imagePoints.size())
        CV_Error_(Error::StsUnmatchedSizes, ("objectPoints has %d points, imagePoints %d; they must agree",
                                             (int)objectPoints.size(), (int)imagePoints.size()));
    if (!objectPoints.empty() && (int)objectPoints.size() < least)
        CV_Error_(Error::StsBadArg, ("objectPoints has %d points; a pose needs at least %d",
                                     (int)objectPoints.size(), least));
    if ((int)objectPoints.size() > most)
        CV_Error_(Error::StsBadArg, ("objectPoints has %d points; it must have at most %d", (int)objectPoints.size(), most));
    for (const Point3d& p : objectPoints)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            CV_Error_(Error::StsBadArg, ("objectPoints holds the point (%g, %g, %g); it must be finite", p.x, p.y, p.z));
}

ImagePoints readPosePoints(InputArray objectPoints_, InputArray imagePoints_, int least, int most)
{
    std::vector<Point3d> objectPoints;
    std::vector<Point2d> imagePoints;
    readTarget(objectPoints_, imagePoints_, least, most, objectPoints, imagePoints);
    return observedWhole(objectPoints, imagePoints);
}

ImagePoints readWeightedPosePoints(InputArray objectPoints_, InputArray imagePoints_, InputArray pixelCovariances, int least,
                                   double& variance)
{
    std::vector<Point3d> objectPoints;
    std::vector<Point2d> imagePoints;
    readTarget(objectPoints_, imagePoints_, least, INT_MAX, objectPoints, imagePoints);
    const PixelCovariances covariances = readPixelCovariances(pixelCovariances, imagePoints, "pixelCovariances");
    MedianVariance median;
    if (!covariances.empty())
        median.add(imagePoints, covariances);
    variance = median();
    return observed(objectPoints, imagePoints, covariances, variance);
}

Pose readPose(InputArray rvec, InputArray tvec)
{
    return poseOf({ readRotation(rvec, "rvec"), readVec3(tvec, "tvec") });
}

//! Without covariances.
static ImagePoints readPoints(InputArray objectPoints, InputArray imagePoints, bool useExtrinsicGuess)
{
    double variance;
    return readWeightedPosePoints(objectPoints, imagePoints, noArray(), useExtrinsicGuess ? 3 : 4, variance);
}

static void writeCovariances(const Camera& camera, const ImagePoints& points, const NearOrigin& origin,
                             const std::vector<PoseMinimum>& minima, const PoseNoise& noise, OutputArrayOfArrays covariances)
{
    if (!covariances.needed())
        return;
    std::vector<Mat> all;
    for (const PoseMinimum& minimum : minima)
        all.push_back(Mat(poseCovariance(camera, points, origin, minimum.pose, noise), true));
    writeMatrices(all, covariances);
}

//! As cv::solvePnPGeneric's: of coordinates, not of distances.
static void writeErrors(const Camera& camera, const ImagePoints& points, const std::vector<PoseMinimum>& minima,
                        OutputArray reprojectionError)
{
    if (!reprojectionError.needed())
        return;
    Mat errors((int)minima.size(), 1, CV_64F);
    for (int i = 0; i < errors.rows; i++)
        errors.at<double>(i) = coordinateRms(camera, points, minima[i]);
    errors.copyTo(reprojectionError);
}

void writePose(const Pose& pose, OutputArray rvec, OutputArray tvec)
{
    Mat(pose.rvec).copyTo(rvec);
    Mat(pose.tvec).copyTo(tvec);
}

//! The pose of the least error, if there is one.
static bool writeBest(const Camera& camera, const ImagePoints& points, const NearOrigin& origin, std::vector<PoseMinimum> minima,
                      OutputArray rvec, OutputArray tvec, OutputArray reprojectionError)
{
    minima.resize(std::min<size_t>(minima.size(), 1));
    writeErrors(camera, points, minima, reprojectionError);
    if (minima.empty())
        return false;
    writePose(origin.toFar(minima[0].pose), rvec, tvec);
    return true;
}

void writePoses(const std::vector<PoseMinimum>& minima, const NearOrigin& origin, OutputArrayOfArrays rvecs,
                OutputArrayOfArrays tvecs)
{
    std::vector<Vec3d> r, t;
    for (const PoseMinimum& minimum : minima)
    {
        const Pose pose = origin.toFar(minimum.pose);
        r.push_back(pose.rvec);
        t.push_back(pose.tvec);
    }
    writeVectors(r, rvecs);
    writeVectors(t, tvecs);
}

//! Three points have up to eight exact poses, of which a guess chooses and nothing else.
static std::vector<PoseMinimum> minimaOf(const Camera& camera, const ImagePoints& points, const Pose& guess)
{
    return guess.found || countDifferent(points) >= 4 ? findMinima(camera, points, guess) : std::vector<PoseMinimum>();
}

bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, InputArray cameraMatrix,
                        InputArray distCoeffs, const GlassWindow& window, OutputArray rvec,
                        OutputArray tvec, bool useExtrinsicGuess, OutputArray reprojectionError)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolvePnP(objectPoints, imagePoints, RefractiveCamera::create(cameraMatrix, distCoeffs, window),
                              rvec, tvec, useExtrinsicGuess, reprojectionError);
}

bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                        OutputArray rvec, OutputArray tvec, bool useExtrinsicGuess,
                        OutputArray reprojectionError)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    ImagePoints points = readPoints(objectPoints, imagePoints, useExtrinsicGuess);
    const NearOrigin origin = moveNear(points);
    const Pose guess = useExtrinsicGuess ? origin.toNear(readPose(rvec, tvec)) : Pose();
    return writeBest(seenBy, points, origin, minimaOf(seenBy, points, guess), rvec, tvec, reprojectionError);
}

bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera, OutputArray rvec,
                        OutputArray tvec, bool useExtrinsicGuess, OutputArray reprojectionError, OutputArray covariance,
                        double sigma, InputArray cameraCovariance, InputArray pixelCovariances)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    const PoseNoise noise = readPoseNoise(sigma, cameraCovariance, seenBy);
    double variance;
    ImagePoints points = readWeightedPosePoints(objectPoints, imagePoints, pixelCovariances, useExtrinsicGuess ? 3 : 4, variance);
    const NearOrigin origin = moveNear(points);
    const Pose guess = useExtrinsicGuess ? origin.toNear(readPose(rvec, tvec)) : Pose();
    const std::vector<PoseMinimum> minima = minimaOf(seenBy, points, guess);
    if (!writeBest(seenBy, points, origin, minima, rvec, tvec, reprojectionError))
    {
        covariance.release();
        return false;
    }
    const PoseNoise scaled = { noise.sigma*std::sqrt(variance), noise.camera };     // of the median pixel
    if (covariance.needed())
        Mat(poseCovariance(seenBy, points, origin, minima[0].pose, scaled)).copyTo(covariance);
    return true;
}

int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                              OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, bool useExtrinsicGuess, InputArray rvec,
                              InputArray tvec, OutputArray reprojectionError, OutputArrayOfArrays covariances, double sigma,
                              InputArray cameraCovariance)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    const PoseNoise noise = readPoseNoise(sigma, cameraCovariance, seenBy);
    ImagePoints points = readPoints(objectPoints, imagePoints, useExtrinsicGuess);
    const NearOrigin origin = moveNear(points);
    const Pose guess = useExtrinsicGuess ? origin.toNear(readPose(rvec, tvec)) : Pose();
    const std::vector<PoseMinimum> minima = minimaOf(seenBy, points, guess);
    writePoses(minima, origin, rvecs, tvecs);
    writeErrors(seenBy, points, minima, reprojectionError);
    writeCovariances(seenBy, points, origin, minima, noise, covariances);
    return (int)minima.size();
}

int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                              OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, bool useExtrinsicGuess,
                              InputArray rvec, InputArray tvec, OutputArray reprojectionError)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolvePnPGeneric(objectPoints, imagePoints, camera, rvecs, tvecs, useExtrinsicGuess, rvec, tvec,
                                     reprojectionError, noArray());
}

int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints, InputArray cameraMatrix,
                              InputArray distCoeffs, const GlassWindow& window, OutputArrayOfArrays rvecs,
                              OutputArrayOfArrays tvecs, bool useExtrinsicGuess, InputArray rvec, InputArray tvec,
                              OutputArray reprojectionError)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolvePnPGeneric(objectPoints, imagePoints,
                                     RefractiveCamera::create(cameraMatrix, distCoeffs, window), rvecs, tvecs,
                                     useExtrinsicGuess, rvec, tvec, reprojectionError);
}

}} // namespace
