// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RELATIVE_POSE_HPP
#define OPENCV_REFRACT_RELATIVE_POSE_HPP

#include "camera/camera.hpp"

namespace cv { namespace refract {

//! Matches of two cameras.
struct PixelMatches
{
    std::vector<Point2d> pixel1, pixel2;
    size_t size() const { return pixel1.size(); }
};

/** Two cameras, judged by matches. Errors are Sampson's: a match's distance from its epipolar curve over the length of its
gradient, to first order how far its two pixels together are from agreeing. */
struct MatchedCameras
{
    const Camera &camera1, &camera2;
    Vec3d centre1, centre2;         //!< near which all rays pass, each in its camera
    bool refracts() const { return camera1.refracts() || camera2.refracts(); }
};

/** Camera 1 -> camera 2: T = centre2 - R centre1 + q baseline, with q such that T has its length. The baseline is what a pair
of pinholes at the centres knows; it hardly depends on the length. */
struct RelativePose
{
    Matx33d R;
    Vec3d baseline;                 //!< unit
    double length;                  //!< of T
};

//! False if no baseline of this direction gives T this length.
bool translation(const MatchedCameras& pair, const RelativePose& pose, Vec3d& T);

//! Of each match, NaN where it has no distance; byPose, if it is wanted, by the rotation vector (3) and by T (3).
void sampsonErrors(const MatchedCameras& pair, const PixelMatches& matches, const Matx33d& R, const Vec3d& T,
                   std::vector<double>& errors, std::vector<Matx16d>* byPose);

//! Most likely R and baseline for the pose's length: the sum of squared errors, NaN if there is none.
double refineAtLength(const MatchedCameras& pair, const PixelMatches& matches, RelativePose& pose, int iterations);

/** Columns: how the rotation vector and T move by the five parameters that refineAtLength estimates. */
Matx<double, 6, 5> motionAtLength(const MatchedCameras& pair, const RelativePose& pose);

}} // namespace

#endif // OPENCV_REFRACT_RELATIVE_POSE_HPP
