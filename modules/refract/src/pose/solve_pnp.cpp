// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The public calls for one view's pose, without wrong matches. */

#include "pose/pose_covariance.hpp"
#include "arrays/arrays.hpp"

namespace cv { namespace refract {

ImagePoints readPosePoints(InputArray objectPoints_, InputArray imagePoints_, int least, int most)
{
    const std::vector<Point3d> objectPoints = readPoints3(objectPoints_, "objectPoints");
    const std::vector<Point2d> imagePoints = readPoints2(imagePoints_, "imagePoints");
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
    return observed(objectPoints, imagePoints);
}

Pose readPose(InputArray rvec, InputArray tvec)
{
    return poseOf({ readRotation(rvec, "rvec"), readVec3(tvec, "tvec") });
}

static std::vector<PoseMinimum> solvePnP(InputArray objectPoints, InputArray imagePoints, const Camera& camera,
                                     InputArray rvec, InputArray tvec, bool useExtrinsicGuess)
{
    const ImagePoints points = readPosePoints(objectPoints, imagePoints, useExtrinsicGuess ? 3 : 4);
    return findMinima(camera, points, useExtrinsicGuess ? readPose(rvec, tvec) : Pose());
}

static void writeCovariances(const Camera& camera, const ImagePoints& points, const std::vector<PoseMinimum>& minima,
                             const PoseNoise& noise, OutputArrayOfArrays covariances)
{
    std::vector<Mat> all;
    for (const PoseMinimum& minimum : minima)
        all.push_back(Mat(poseCovariance(camera, points, minimum.pose, noise), true));
    covariances.create((int)all.size(), 1, CV_64F);
    for (int i = 0; i < (int)all.size(); i++)
    {
        covariances.create(6, 6, CV_64F, i, true);
        all[i].copyTo(covariances.getMat(i));
    }
}

//! As cv::solvePnPGeneric's: of coordinates, not of distances.
static void writeErrors(const std::vector<PoseMinimum>& minima, OutputArray reprojectionError)
{
    if (!reprojectionError.needed())
        return;
    Mat errors((int)minima.size(), 1, CV_64F);
    for (int i = 0; i < errors.rows; i++)
        errors.at<double>(i) = minima[i].rms/std::sqrt(2.);
    errors.copyTo(reprojectionError);
}

void writePoses(const std::vector<PoseMinimum>& minima, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs)
{
    std::vector<Vec3d> r, t;
    for (const PoseMinimum& minimum : minima)
    {
        r.push_back(minimum.pose.rvec);
        t.push_back(minimum.pose.tvec);
    }
    writeVectors(r, rvecs);
    writeVectors(t, tvecs);
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

    std::vector<PoseMinimum> minima = solvePnP(objectPoints, imagePoints, cameraOf(camera), rvec, tvec, useExtrinsicGuess);
    minima.resize(std::min<size_t>(minima.size(), 1));
    writeErrors(minima, reprojectionError);
    if (minima.empty())
        return false;
    Mat(minima[0].pose.rvec).copyTo(rvec);
    Mat(minima[0].pose.tvec).copyTo(tvec);
    return true;
}

bool refractiveSolvePnP(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera, OutputArray rvec,
                        OutputArray tvec, bool useExtrinsicGuess, OutputArray reprojectionError, OutputArray covariance,
                        double sigma, InputArray cameraCovariance)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    const PoseNoise noise = readPoseNoise(sigma, cameraCovariance, seenBy);
    if (!refractiveSolvePnP(objectPoints, imagePoints, camera, rvec, tvec, useExtrinsicGuess, reprojectionError))
    {
        covariance.release();
        return false;
    }
    const ImagePoints points = readPosePoints(objectPoints, imagePoints, 3);
    Mat(poseCovariance(seenBy, points, readPose(rvec, tvec), noise)).copyTo(covariance);
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
    const ImagePoints points = readPosePoints(objectPoints, imagePoints, useExtrinsicGuess ? 3 : 4);
    const std::vector<PoseMinimum> minima = findMinima(seenBy, points, useExtrinsicGuess ? readPose(rvec, tvec) : Pose());
    writePoses(minima, rvecs, tvecs);
    writeErrors(minima, reprojectionError);
    writeCovariances(seenBy, points, minima, noise, covariances);
    return (int)minima.size();
}

int refractiveSolvePnPGeneric(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                              OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs, bool useExtrinsicGuess,
                              InputArray rvec, InputArray tvec, OutputArray reprojectionError)
{
    CV_INSTRUMENT_REGION();

    const std::vector<PoseMinimum> minima =
        solvePnP(objectPoints, imagePoints, cameraOf(camera), rvec, tvec, useExtrinsicGuess);
    writePoses(minima, rvecs, tvecs);
    writeErrors(minima, reprojectionError);
    return (int)minima.size();
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
