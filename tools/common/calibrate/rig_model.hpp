#ifndef REFRACT_TOOLS_RIG_MODEL_HPP
#define REFRACT_TOOLS_RIG_MODEL_HPP

#include "calibrate/calib_file.hpp"

/* One or two cameras behind their windows, and where they are to each other. */
namespace tools {

//! What is known of a camera before its images are looked at: from a file, from a data sheet.
struct KnownCamera
{
    cv::Mat lens;                               //!< its parameters
    std::vector<double> thickness, index;       //!< of its window
    cv::Mat covariance;         //!< as calibrateGlassRig's cameraCovariances, where the values are those; empty: nothing
};

//! Lenses, windows and their places: the start of a fit and its result.
struct RigModel
{
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    cv::Matx33d R = cv::Matx33d::eye();         //!< camera 1 -> camera 2
    cv::Vec3d T;
    std::vector<KnownCamera> known = {};        //!< one per camera, or empty

    RigModel clone() const;
};

//! Same lens, other window.
cv::Ptr<cv::refract::RefractiveCamera> copyWithWindow(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                                      const cv::refract::GlassWindow& window);

//! Board -> a camera of the rig, from board -> camera 1.
void poseInCamera(const RigModel& rig, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);

//! As a file of it would be, without what the estimate is worth.
Calibration calibrationOf(const RigModel& rig);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_MODEL_HPP
