#ifndef REFRACT_TOOLS_RIG_CALIBRATION_HPP
#define REFRACT_TOOLS_RIG_CALIBRATION_HPP

#include "rig_checks.hpp"

/* The whole of a calibration, and the numbers that describe it. */
namespace tools {

//! Everything that the table and the report speak of.
struct RigCalibration
{
    RigData data;
    RigOptions options;
    Rig start;
    std::vector<LensSource> lensSources;
    Fit fit;
    std::vector<Residual> residuals;
    Baselines baselines;
    NearFar nearFar;
    std::vector<Influence> influences;          //!< only if asked for
    std::vector<std::string> withoutTarget;     //!< images in which the target was not found
    double maxRms = 0., maxNormalStdDeg = 0.;   //!< the caller's limits; 0: none
};

struct Rms
{
    double px = NONE;           //!< sqrt(mean |r|^2), as cv::calibrateCamera
    int points = 0, views = 0;
};

//! Of the images of one camera in one state; moment >= 0: of that moment alone.
Rms rmsOf(const RigCalibration& calibration, int camera, bool glass, int moment = -1);

//! Both states together.
Rms rmsOfCamera(const RigCalibration& calibration, int camera);

//! A number that was estimated.
struct FreeParameter
{
    std::string name;
    int column;                 //!< of Fit::covariance
    double value, std;
    bool isNormal;
};

//! Window parameters that were free, camera after camera; of the normal x and y (z follows), of a shared window once.
std::vector<FreeParameter> freeWindowParameters(const Fit& fit, int flags);

//! Lens parameters and R (rotation vector), T that were free.
std::vector<FreeParameter> freeRigParameters(const Fit& fit);

//! Share of the cells of an 8 x 6 grid over the image with a corner seen through the window.
double coverage(const RigCalibration& calibration, int camera);

//! Distance of the board's points from camera 1, at the moments with a glass image: nearest, median, farthest z.
cv::Vec3d workingDepth(const RigCalibration& calibration, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_CALIBRATION_HPP
