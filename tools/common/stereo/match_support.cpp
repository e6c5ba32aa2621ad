// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/match_support.hpp"

#include <opencv2/imgproc.hpp>

namespace tools {

using cv::Mat;

namespace {

const cv::Size PATCH(11, 11);
const double ALIKE = 0.6;           // correlation; true partners have more even where noise is half of the contrast
const double FLAT = 0.25;           // variance, grey levels squared, as rounding to 8 bits leaves

Mat greyFloat(const Mat& image)
{
    Mat result;
    greyOf(image, BRIGHTNESS).convertTo(result, CV_32F);
    return result;
}

//! The second image as the first sees it.
Mat moved(const Mat& second, const Mat& disparity, bool vertical)
{
    Mat mapX(disparity.size(), CV_32F), mapY(disparity.size(), CV_32F), result;
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            const float d = disparity.at<float>(y, x), by = d == d ? d : 0;
            mapX.at<float>(y, x) = (float)x - (vertical ? 0 : by);
            mapY.at<float>(y, x) = (float)y - (vertical ? by : 0);
        }
    cv::remap(second, result, mapX, mapY, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    return result;
}

Mat averaged(const Mat& values)
{
    Mat result;
    cv::blur(values, result, PATCH);
    return result;
}

} // namespace

int supportedMatches(const DenseStereo& stereo, bool vertical)
{
    const Mat first = greyFloat(stereo.rectified1), second = moved(greyFloat(stereo.rectified2), stereo.disparity, vertical);
    const Mat mean1 = averaged(first), mean2 = averaged(second);
    const Mat variance1 = averaged(first.mul(first)) - mean1.mul(mean1), variance2 = averaged(second.mul(second)) - mean2.mul(mean2);
    const Mat together = averaged(first.mul(second)) - mean1.mul(mean2);
    int count = 0;
    for (int y = 0; y < first.rows; y++)
        for (int x = 0; x < first.cols; x++)
        {
            const double v1 = variance1.at<float>(y, x), v2 = variance2.at<float>(y, x), c = together.at<float>(y, x);
            const float d = stereo.disparity.at<float>(y, x);
            count += d == d && v1 > FLAT && v2 > FLAT && c > 0 && c*c > ALIKE*ALIKE*v1*v2;
        }
    return count;
}

} // namespace tools
