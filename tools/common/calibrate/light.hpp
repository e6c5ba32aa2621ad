// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIGHT_HPP
#define REFRACT_TOOLS_LIGHT_HPP

#include "console/images.hpp"
#include <opencv2/refract.hpp>
#include <array>

/* A window bends each colour of light by another angle: what light an image is made of, and a camera in light of another colour.
Wavelengths in air, nm. */
namespace tools {

//! What a channel is made of; from shortest to longest if the source is white.
struct Light
{
    double wavelength = 550., shortest = 450., longest = 650.;
};

//! @param wavelength 0: the channel's usual one
Light lightOf(Channel channel, double wavelength = 0.);

//! Of each channel of a colour image, in OpenCV's order: blue, green, red.
typedef std::array<double, 3> ChannelWavelengths;

//! "610,540,465": of red, green and blue, as --channels has them.
ChannelWavelengths parseChannels(const std::string& text);
//! @param ofRedGreenBlue three numbers. @param name of them, for the sentence of a Failure
ChannelWavelengths channelsOf(const std::vector<double>& ofRedGreenBlue, const std::string& name);

/** The camera in the light of each channel; one without a window is the same in all.
@param of the file that the camera is from, for the sentence of a Failure if it does not say what the window is made of */
std::vector<cv::Ptr<cv::refract::RefractiveCamera>> camerasInColours(const cv::Ptr<cv::refract::RefractiveCamera>& camera,
                                                                     const ChannelWavelengths& wavelengths, const std::string& of);

/** What a colour image that was corrected for one colour should know; empty if the window is the same in all colours, or the
file does not say. */
std::string oneColourNotice(const cv::refract::RefractiveCamera& camera);

} // namespace tools

#endif // REFRACT_TOOLS_LIGHT_HPP
