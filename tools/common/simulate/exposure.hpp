// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXPOSURE_HPP
#define REFRACT_TOOLS_EXPOSURE_HPP

#include <opencv2/core.hpp>

namespace tools {

//! Blur, noise and vignetting of a camera. Grey levels 0 ... 255.
struct Exposure
{
    double dark = 35., light = 205., background = 110.;
    double blur = 0.7;          //!< standard deviation of the lens's point spread, pixels, 0 ... 2
    double noise = 2.;          //!< standard deviation, grey levels
    double vignetting = 0.;     //!< loss of light in the image's corners, 0 ... 1
};

const int FINE = 2;         // samples per pixel, each way
const int PAD = 8;          // pixels rendered around the image, so that the blur has no border

//! Size of the image with its padding, in pixels.
inline cv::Size paddedSize(cv::Size image) { return image + cv::Size(2*PAD, 2*PAD); }

//! Pixel of the image in which a fine sample of the padded image lies.
inline cv::Point2d pixelOfSample(int x, int y)
{
    return cv::Point2d((x + 0.5)/FINE - 0.5 - PAD, (y + 0.5)/FINE - 0.5 - PAD);
}

/** The light that falls on the fine grid of the padded image -> the image: blur at the finer resolution, the mean over each
pixel, vignetting, noise, 8 bits.
@param levels grey levels or colours, float32; used up */
cv::Mat expose(cv::Mat& levels, const Exposure& exposure, uint64_t seed);

} // namespace tools

#endif // REFRACT_TOOLS_EXPOSURE_HPP
