// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/laser_signal.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>

using namespace cv;

namespace tools {

namespace {

//! In grey values of 8 bits.
Mat scaled(const Mat& image)
{
    Mat result;
    image.convertTo(result, CV_32F, image.depth() == CV_16U ? 1./256. : 1.);
    return result;
}

Mat excessOf(const Mat& bgr, LaserColour colour)
{
    std::vector<Mat> channels;
    split(bgr, channels);
    const Mat own = channels[colour];
    channels.erase(channels.begin() + colour);
    return own - max(channels[0], channels[1]);
}

Mat brightnessOf(const Mat& image)
{
    if (image.channels() == 1)
        return image;
    Mat grey;
    cvtColor(image, grey, COLOR_BGR2GRAY);
    return grey;
}

} // namespace

std::vector<std::string> laserColourNames() { return {"blue", "green", "red", "any"}; }

LaserColour laserColourOf(const std::string& name)
{
    const std::vector<std::string> names = laserColourNames();
    return (LaserColour)(std::find(names.begin(), names.end(), name) - names.begin());
}

Mat laserSignal(const Mat& image, LaserColour colour, const Mat& without)
{
    const auto signalOf = [&](const Mat& from) {
        return colour == LASER_ANY || from.channels() == 1 ? brightnessOf(scaled(from)) : excessOf(scaled(from), colour);
    };
    return without.empty() ? signalOf(image) : Mat(signalOf(image) - signalOf(without));
}

} // namespace tools
