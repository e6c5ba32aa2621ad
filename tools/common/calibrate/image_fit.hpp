#ifndef REFRACT_TOOLS_IMAGE_FIT_HPP
#define REFRACT_TOOLS_IMAGE_FIT_HPP

#include "calibrate/calib_file.hpp"
#include "calibrate/rig_data.hpp"

/* From views of a target to a calibrated rig of one or two cameras: the lens from the direct images and the start of R and
T (starting_model.cpp), and the joint fit of windows, rig and board poses (image_fit.cpp). Geometry is the library's. */
namespace tools {

struct RigOptions
{
    cv::refract::GlassWindow window;                        //!< the known values, and the start of the others
    int flags = 0;                                          //!< GlassCalibrationFlags
    int lensCoefficients = 5;                               //!< of the lens that the images determine
    cv::Ptr<cv::refract::RefractiveCamera> known[2];        //!< lens from a file; null: from the images
    cv::Mat knownCovariance[2];                             //!< of its lens parameters; empty where the file has none
    double thicknessStd = 0., indexStd = 0.;                //!< of the given values; 0: exact
};

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

//! Where the lens of a camera came from.
struct LensSource
{
    enum Kind { FROM_FILE, FROM_DIRECT, FROM_GLASS } kind = FROM_FILE;
    int views = 0;
    double rms = 0.;            //!< cv::calibrateCamera's
};

//! The outcome of one joint fit.
struct Fit
{
    RigModel rig;
    std::vector<int> moments;                   //!< that took part, as indices into RigData::moments
    std::vector<cv::Vec3d> rvecs, tvecs;        //!< board -> camera 1, of each of them
    cv::Mat stdDeviations, covariance;
    cv::Mat imageStatus;                        //!< GlassImageStatus; a row each: direct 1, glass 1 (, direct 2, glass 2)
    std::vector<cv::Mat> inliers;               //!< of each of these, row by row: which points were used
    cv::Mat otherMinima;                        //!< a row each camera, see calibrateGlassRig
    double rms = 0.;
    double freedom = 0.;                        //!< degrees of freedom: coordinates - free parameters - 6 for each board
    double sigma = 0.;                          //!< of a pixel coordinate, from the residuals
};

//! One observed corner: where it was seen, and seen minus modelled.
struct Residual
{
    int camera, moment;
    bool glass;
    cv::Point2d pixel, error;
};

//! Same lens, other window.
cv::Ptr<cv::refract::RefractiveCamera> copyWithWindow(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                                      const cv::refract::GlassWindow& window);

//! cv::calibrateCamera on the seen points of all views that are not empty.
cv::Ptr<cv::refract::RefractiveCamera> calibratePinhole(const std::vector<cv::Point3d>& objectPoints,
        const std::vector<std::vector<cv::Point2d>>& views, cv::Size imageSize, int coefficients, double& rms);

//! The start: lenses, the windows as given, and R, T from the moment that explains the others best.
RigModel startModel(const RigData& data, const RigOptions& options, std::vector<LensSource>& lensSources);

const int MAX_ITERATIONS = 1000, MAX_ROBUST_ITERATIONS = 100;     // the latter in each of many rounds

//! calibrateGlassRig on some of the moments.
Fit fitImages(const RigData& data, const RigModel& start, const std::vector<int>& moments, int flags,
              int maxIterations = MAX_ITERATIONS);

/** One fit of all images: lenses that came from images are free in it, so that their uncertainty is in every +-; direct
images are views too, each with its own pose. The windows are found first, with the lenses held.
@param flags gets GLASS_FREE_INTRINSICS if so */
Fit fitAllImages(const RigData& data, const RigModel& start, const std::vector<LensSource>& lensSources, int& flags);

//! All corners of the moments that took part.
std::vector<Residual> residualsOf(const RigData& data, const Fit& fit);

//! Board -> a camera of the rig, from board -> camera 1.
void poseInCamera(const RigModel& rig, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);

//! Board -> camera `camera` of the k-th moment of a fit.
void poseInCamera(const Fit& fit, size_t k, int camera, cv::Vec3d& rvec, cv::Vec3d& tvec);

/* Which column of Fit::covariance is what. */
struct ParameterColumns
{
    int lens, normal, distance, thickness, index, innerIndex, outerIndex, end;
    int lensCount, layers;
    std::vector<cv::String> names;
};
ParameterColumns columnsOf(const cv::refract::RefractiveCamera& camera, int first = 0);
ParameterColumns columnsOf(const RigModel& rig, int camera);

//! Two principal standard deviations of the normal of a camera, larger first.
std::vector<double> normalStdDeg(const cv::Mat& covariance, const RigModel& rig, int camera);

//! As a file of it would be, without what the estimate is worth.
Calibration calibrationOf(const RigModel& rig);

//! A number that was estimated.
struct EstimatedParameter
{
    std::string name;
    int column;                 //!< of Fit::covariance
    double value, std;
    bool isNormal;
};

//! Window parameters that were free, camera after camera; of the normal x and y (z follows), of a shared window once.
std::vector<EstimatedParameter> estimatedWindowParameters(const Fit& fit, int flags);

//! Lens parameters and R (rotation vector), T that were free.
std::vector<EstimatedParameter> estimatedRigParameters(const Fit& fit);

//! One standard deviation of what was free in the window of a camera.
WindowStd windowStd(const Fit& fit, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_FIT_HPP
