#ifndef REFRACT_TOOLS_TARGET_LENGTHS_HPP
#define REFRACT_TOOLS_TARGET_LENGTHS_HPP

#include "target/target.hpp"

namespace tools {

//! Distances between neighbouring points, measured minus true.
std::vector<double> lengthErrors(const Target& target, const std::vector<cv::Point3d>& points);

//! Distances between neighbouring points, measured over true.
std::vector<double> lengthRatios(const Target& target, const std::vector<cv::Point3d>& points);

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_LENGTHS_HPP
