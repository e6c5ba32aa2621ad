// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SURVEY_HPP
#define REFRACT_TOOLS_SURVEY_HPP

#include "calibrate/rig_model.hpp"
#include "colmap/colmap_model.hpp"

/* Images that a calibrated rig took while it moved through a scene, as a model of COLMAP has them: a list of observations. */
namespace tools {

RigidTransform transformOf(const ColmapPose& pose);
ColmapPose colmapPoseOf(const RigidTransform& transform);

struct LeftOutImage
{
    std::string name, reason;
};

struct Survey
{
    ColmapModel model;                          //!< pinholes in water, bent, in any unit
    std::vector<int> cameraOf, viewOf;          //!< of each of its images; -1: left out
    std::vector<std::string> views;             //!< one a moment
    std::vector<LeftOutImage> leftOut;

    std::vector<cv::Vec3i> observations;        //!< view, camera, index of the point
    std::vector<cv::Point2d> pixels;            //!< raw, of each of them
    std::vector<cv::Vec2i> sources;             //!< image, and index of the pixel there, of each of them

    //! Its images have no pose.
    void leaveOut(int view);
    int imageCount() const { return (int)model.images.size() - (int)leftOut.size(); }
    //! "image 'a.png'" of one that was not left out, by an observation.
    const ColmapImage& imageOf(int observation) const { return model.images[sources[observation][0]]; }
};

const int MIN_POINTS = 6;       //!< of an image, to have a pose

/** @param globs one for each camera of the rig, of names of images; none for a rig of one camera, which took all, and for a model that has
a rig of as many cameras, in its order
@param folder of the model, for a sentence
Throws Failure where images are of no camera, of two, or of another size, where two of a camera are of one moment or no two of a rig are,
and where the model's rig is not as the calibration's. */
Survey surveyOf(ColmapModel model, const RigModel& rig, const std::vector<std::string>& globs, const std::string& folder);

/** px: where each observation (view, camera, point) was seen from where it is projected; NaN: its view has no pose (NaN), its point no
answer, or the camera does not see it. */
std::vector<double> errorsOf(const std::vector<cv::Vec3i>& observations, const std::vector<cv::Point2d>& pixels, const RigModel& rig,
                             const std::vector<cv::Vec3d>& rvecs, const std::vector<cv::Vec3d>& tvecs,
                             const std::vector<cv::Point3d>& points);

//! Of each a vector, as OpenCV gives poses.
std::vector<cv::Vec3d> vectorsOf(const std::vector<cv::Mat>& arrays);

//! Whether a name is what a pattern of * and ? means; * is for '/' too.
bool matchesPattern(const std::string& name, const std::string& pattern);

} // namespace tools

#endif // REFRACT_TOOLS_SURVEY_HPP
