// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGES_HPP
#define REFRACT_TOOLS_IMAGES_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

/* Many cameras store their orientation in the EXIF data, and viewers rotate the picture by it. The lens does not rotate: the tools use
the pixels as they are stored, and warn the user. */

//! The sentence, once; empty if no file was noted.
std::string takeRotationNotice();

//! What of a colour image is looked at; the numbers are OpenCV's order.
enum Channel { BLUE, GREEN, RED, BRIGHTNESS };

//! "blue", "green", "red"; "brightness": all of them.
std::string nameOf(Channel channel);
//! BRIGHTNESS for any other name.
Channel channelOf(const std::string& name);

//! One channel; of a grey image, itself.
cv::Mat greyOf(const cv::Mat& image, Channel channel);

/** As cv::remap, each channel by a map of its own; one map serves all. Where there is a fourth channel and three maps, it is
alpha: a pixel is as opaque as the least of its colours.
@param maps CV_32FC2 */
cv::Mat remapChannels(const cv::Mat& image, const std::vector<cv::Mat>& maps, int interpolation);

//! By its name, as decoders of video take all kinds of files for one, texts too.
bool isNamedAsVideo(const std::string& path);

//! Files that match, sorted; none is no error.
std::vector<std::string> matchingFiles(const std::string& glob);

//! Files that match, sorted; throws Failure if there are none.
std::vector<std::string> expandGlob(const std::string& glob);

/** The whole image, 8-bit grey (more bits are scaled so that the brightest pixel becomes 255); throws Failure that names
the file if it is missing, cut or not an image. */
cv::Mat readGrey(const std::string& path, Channel channel = BRIGHTNESS);

/** The same with the file's channels (1 or 3) and depth.
@param withAlpha four channels where the file has them: how opaque a pixel is, the last */
cv::Mat readImage(const std::string& path, bool withAlpha = false);

//! What a file is, before its pixels are used.
struct ImageFacts
{
    cv::Size size;
    bool coloured;          //!< false: grey, also where a file repeats the one grey in three channels
};

//! Reads the whole image, so that Failure is thrown as by readGrey.
ImageFacts factsOf(const std::string& path);

//! Throws Failure if the calibration's image size is known (not empty) and the image has another.
void requireSize(const cv::Mat& image, const std::string& path, cv::Size calibrated);

//! The files that there are with 0, 1, 2, ... or 1, 2, ... in place of %d, of programs that have a file for each camera.
std::vector<std::string> numberedFiles(const std::string& pattern);

//! File name without folder and extension.
std::string stemOf(const std::string& path);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGES_HPP
