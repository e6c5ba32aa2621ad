// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "simulate/exposure.hpp"

#include <opencv2/imgproc.hpp>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Size;

namespace {

void vignette(Mat& levels, double loss)
{
    const Point2d centre(0.5*(levels.cols - 1), 0.5*(levels.rows - 1));
    const int channels = levels.channels();
    for (int y = 0; y < levels.rows; y++)
        for (int x = 0; x < levels.cols; x++)
        {
            const Point2d offset = Point2d(x, y) - centre;
            const float share = (float)(1 - loss*offset.dot(offset)/centre.dot(centre));
            for (int channel = 0; channel < channels; channel++)
                levels.ptr<float>(y, x)[channel] *= share;
        }
}

} // namespace

Mat expose(Mat& levels, const Exposure& exposure, uint64_t seed)
{
    if (exposure.blur > 0)
        cv::GaussianBlur(levels, levels, Size(), exposure.blur*FINE);
    cv::resize(levels, levels, levels.size()/FINE, 0, 0, cv::INTER_AREA);
    levels = levels(cv::Rect(cv::Point(PAD, PAD), levels.size() - Size(2*PAD, 2*PAD))).clone();
    vignette(levels, exposure.vignetting);
    Mat noise(levels.rows, levels.cols*levels.channels(), CV_32F);      // of each channel its own
    cv::RNG rng(seed);
    rng.fill(noise, cv::RNG::NORMAL, 0., exposure.noise);
    levels += noise.reshape(levels.channels());
    Mat image;
    levels.convertTo(image, CV_8U);
    return image;
}

} // namespace tools
