#ifndef REFRACT_TOOLS_IMAGES_HPP
#define REFRACT_TOOLS_IMAGES_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

//! Files that match, sorted; throws Failure if there are none.
std::vector<std::string> expandGlob(const std::string& glob);

//! The whole image, 8-bit grey; throws Failure that names the file if it is missing, cut or not an image.
cv::Mat readGrey(const std::string& path);

//! The same in colour where it has any (CV_8UC1 or CV_8UC3).
cv::Mat readImage(const std::string& path);

//! File name without folder and extension.
std::string stemOf(const std::string& path);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGES_HPP
