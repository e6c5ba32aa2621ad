#ifndef REFRACT_TOOLS_PINHOLE_CAMERA_HPP
#define REFRACT_TOOLS_PINHOLE_CAMERA_HPP

#include <opencv2/refract.hpp>

namespace tools {

//! cv::calibrateCamera on the seen points of all views that are not empty.
cv::Ptr<cv::refract::RefractiveCamera> calibratePinhole(const std::vector<cv::Point3d>& objectPoints,
        const std::vector<std::vector<cv::Point2d>>& views, cv::Size imageSize, int coefficients, double& rms);

} // namespace tools

#endif // REFRACT_TOOLS_PINHOLE_CAMERA_HPP
