#include "console/point_file.hpp"
#include "file_harness.hpp"

// Points for refract_epilines --points.

const char fuzz::EXTENSION[] = ".txt";

void fuzz::tryFile(const std::string& path)
{
    const std::vector<cv::Point2d> points = tools::readPixels(path);
    promise(!points.empty() && cv::checkRange(points), "there are points, all finite");
}
