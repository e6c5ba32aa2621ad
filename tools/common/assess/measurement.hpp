#ifndef REFRACT_TOOLS_MEASUREMENT_HPP
#define REFRACT_TOOLS_MEASUREMENT_HPP

#include "calibrate/calib_file.hpp"
#include "target/target.hpp"

namespace tools {

/** A status of the tools, beyond cv::refract::RefractiveStatus: the pixels of a point contradict each other by more than noise
and calibration explain. */
const uchar INCONSISTENT = 9;

//! Points in the camera-1 frame; NaN where there is no answer.
struct Measurement
{
    std::vector<cv::Point2d> pixels1, pixels2;      //!< as seen; pixels2 is empty for one camera
    std::vector<cv::Point3d> points;
    std::vector<cv::Vec3d> sigma;                   //!< one standard deviation of x, y, z
    std::vector<uchar> status;                      //!< cv::refract::RefractiveStatus, or INCONSISTENT
    double noise = 0.;          //!< of a pixel coordinate, as this view shows it; 0: no more than stated, or nothing tells
    double worstMisfit = 0.;    //!< px, of the inconsistent points

    int answers() const;                            //!< points that are not NaN
    int inconsistent() const;
    int seenPoints() const;                         //!< that the image shows, or both
};

/* The uncertainty has two parts: pixelSigma, one standard deviation of each pixel coordinate, and the calibration's own
covariance if the file has one. Unknown pixelSigma (NaN): unknown uncertainty. */

//! Maximum-likelihood triangulation.
Measurement measureStereo(const Calibration& calibration, const std::vector<cv::Point2d>& pixels1,
                          const std::vector<cv::Point2d>& pixels2, double pixelSigma);

//! Where the rays of camera 1 meet a plane (a, b, c, d) of its frame.
Measurement measureOnPlane(const Calibration& calibration, const std::vector<cv::Point2d>& pixels, const cv::Vec4d& plane,
                           double pixelSigma);

/** The points of a target of known shape, from its pose to camera 1. Residuals larger than pixelSigma take its place, and are
said in Measurement::noise. */
Measurement measureTarget(const Calibration& calibration, const Target& target, const std::vector<cv::Point2d>& pixels,
                          double pixelSigma);

//! The same rig with the windows left out.
Calibration withoutWindows(const Calibration& calibration);

//! Standard deviation of a pixel coordinate, from the calibration's residuals; NaN where unknown.
double pixelSigmaOf(const Calibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_MEASUREMENT_HPP
