// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_POSES_HPP
#define OPENCV_REFRACT_POSES_HPP

#include "arrays/views.hpp"
#include "camera/camera.hpp"
#include "math/rigid_transform.hpp"

namespace cv { namespace refract {

class NearOrigin;

//! Object -> camera.
struct Pose
{
    Vec3d rvec, tvec;
    bool found = false;
};

Pose poseOf(const RigidTransform& transform);
RigidTransform transformOf(const Pose& pose);

//! Mean distance of the targets; NaN if no pose was found.
double meanRange(const std::vector<Pose>& poses);

//! Object -> camera, with camera 1 -> camera, gives object -> camera 1.
Pose inCamera1(const Pose& inCamera, const Pose& extrinsics);

/** Pose of a target seen through lens and window: closed-form start on the bearings (solvePnP on the pinhole directions),
then maximum likelihood. NaN image points are left out; halves have a say in the second, not in the start. To start other fits from:
a target that would be before the window is put just behind it (findMinima has no such poses).
@param start if found, the start
@param rms reprojection error in pixels by cv::calibrateCamera's definition */
Pose solvePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints,
               const Pose& start, double& rms);

//! A minimum of the reprojection error.
struct PoseMinimum
{
    Pose pose;
    double rms;         //!< of distances
};

void sortByError(std::vector<PoseMinimum>& minima);

//! RMS of the coordinates that were observed, without weights.
double coordinateRms(const Camera& camera, const ImagePoints& points, const PoseMinimum& minimum);

//! All minima that the start, or else the closed forms, lead to, the smallest first.
std::vector<PoseMinimum> findMinima(const Camera& camera, const ImagePoints& points, const Pose& start);

//! Maximum likelihood from a start; the RMS, NaN if it failed, as where the start gives some point no image.
double refinePose(const Camera& camera, const ImagePoints& points, Pose& pose, int iterations = 100);

//! The points whose pixels are whole, which have rays: no halves.
ImagePoints observedWhole(const std::vector<Point3d>& objectPoints, std::vector<Point2d> imagePoints);

//! How many points were seen whole and are no copies of others, which tell nothing.
int countDifferent(const ImagePoints& points);

//! Rank of the points' scatter: 0 one place, 1 a line, 2 a plane, 3 space.
int scatterRank(const std::vector<Point3d>& points);

/** The arguments of a pose's calls, without the points that were not seen; throws with the arguments' names.
@param least points that there must be, or none at all
@param most points that there may be */
ImagePoints readPosePoints(InputArray objectPoints, InputArray imagePoints, int least, int most = INT_MAX);
/** The same with half pixels, and covariances or noArray().
@param variance the median of the pixels' coordinates, in units of which they are weighed */
ImagePoints readWeightedPosePoints(InputArray objectPoints, InputArray imagePoints, InputArray pixelCovariances, int least,
                                   double& variance);
Pose readPose(InputArray rvec, InputArray tvec);
void writePose(const Pose& pose, OutputArray rvec, OutputArray tvec);
void writePoses(const std::vector<PoseMinimum>& minima, const NearOrigin& origin, OutputArrayOfArrays rvecs,
                OutputArrayOfArrays tvecs);

//! The part of an image's points that must agree with one pose, else the image is of no use.
const double LEAST_INLIER_RATIO = 1./3;

/** The image points that one pose agrees with to a few pixels, found by random samples (the same ones every time); the
others NaN. Empty if they are fewer than LEAST_INLIER_RATIO, or fewer than 4. */
std::vector<Point2d> pointsOfOnePose(const Camera& camera, const std::vector<Point3d>& objectPoints,
                                     const std::vector<Point2d>& imagePoints);

//! The least sum of squared errors of such a pose, each cut off at some pixels.
double costOfOnePose(const Camera& camera, const std::vector<Point3d>& objectPoints, const std::vector<Point2d>& imagePoints);

}} // namespace

#endif // OPENCV_REFRACT_POSES_HPP
