// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "stereo/disparity.hpp"

namespace cv { namespace refract {

Disparity::Disparity(InputArray disparity, bool handleMissingValues)
{
    const int type = disparity.type();
    if (!disparity.empty() && type != CV_8UC1 && type != CV_16SC1 && type != CV_32SC1 && type != CV_32FC1)
        CV_Error_(Error::StsUnsupportedFormat, ("disparity is %s; it must be CV_8UC1, CV_16SC1, CV_32SC1 or CV_32FC1",
                                                typeToString(type).c_str()));
    disparity.getMat().convertTo(image_, CV_32F);
    if (image_.empty())
        return;
    image_.setTo(std::numeric_limits<float>::quiet_NaN(), cv::abs(image_) > FLT_MAX);
    if (!handleMissingValues)
        return;
    float least = std::numeric_limits<float>::infinity();
    for (int y = 0; y < image_.rows; y++)
        for (int x = 0; x < image_.cols; x++)
            least = std::min(least, image_.at<float>(y, x));     // NaN is not less
    image_.setTo(std::numeric_limits<float>::quiet_NaN(), image_ == least);
}

}} // namespace
