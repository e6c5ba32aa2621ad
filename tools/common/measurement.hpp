#ifndef REFRACT_TOOLS_MEASUREMENT_HPP
#define REFRACT_TOOLS_MEASUREMENT_HPP

#include "calib_file.hpp"
#include "target.hpp"

namespace tools {

//! Points in the camera-1 frame; NaN where there is no answer.
struct Measurement
{
    std::vector<cv::Point2d> pixels1, pixels2;      //!< as seen; pixels2 is empty for one camera
    std::vector<cv::Point3d> points;
    std::vector<cv::Vec3d> sigma;                   //!< one standard deviation of x, y, z
    std::vector<uchar> status;                      //!< cv::refract::RefractiveStatus

    int answers() const;
};

/* The uncertainty has two parts: pixelSigma, one standard deviation of each pixel coordinate, and the calibration's own
covariance if the file has one. Unknown pixelSigma (NaN): unknown uncertainty. */

//! Maximum-likelihood triangulation.
Measurement measureStereo(const Calibration& calibration, const std::vector<cv::Point2d>& pixels1,
                          const std::vector<cv::Point2d>& pixels2, double pixelSigma);

//! Where the rays of camera 1 meet a plane (a, b, c, d) of its frame.
Measurement measureOnPlane(const Calibration& calibration, const std::vector<cv::Point2d>& pixels, const cv::Vec4d& plane,
                           double pixelSigma);

//! The points of a target of known shape, from its pose to camera 1.
Measurement measureTarget(const Calibration& calibration, const Target& target, const std::vector<cv::Point2d>& pixels,
                          double pixelSigma);

//! The same rig with the windows left out.
Calibration withoutWindows(const Calibration& calibration);

//! Standard deviation of a pixel coordinate, from the calibration's residuals; NaN where unknown.
double pixelSigmaOf(const Calibration& calibration);

//! Distances between neighbouring points, measured minus true.
std::vector<double> lengthErrors(const Target& target, const std::vector<cv::Point3d>& points);

} // namespace tools

#endif // REFRACT_TOOLS_MEASUREMENT_HPP
