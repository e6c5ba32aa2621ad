// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIBRATION_IMAGES_HPP
#define REFRACT_TOOLS_CALIBRATION_IMAGES_HPP

#include "calibrate/provenance.hpp"
#include "calibrate/rig_data.hpp"

/* Images that calibrated, so that they are known again: they must not test the calibration. A file is known by its bytes; an image that
was stored anew, made a little noisier, or of which points were left out, by where it shows the target: a board that was held anew, even
next to where it was, is farther off. */
namespace tools {

//! One that calibrates.
struct UsedImage
{
    std::string path;               //!< empty: its points came in a file of points
    CalibrationImage image;         //!< without sha256
};

std::vector<UsedImage> usedImages(const RigImages& sets);

//! As they go into the file: with the hashes of those that are files.
std::vector<CalibrationImage> withHashes(const std::vector<UsedImage>& used);

//! The middle of the pixels that are seen; NaN: none is.
cv::Point2d meanOfSeen(const std::vector<cv::Point2d>& pixels);

//! The image with these bytes; null: none.
const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, const std::string& sha256);

/** The image of a camera that shows the target where these pixels do, whatever their names and numbers are; null: none.
@param pixelSigma noise of a pixel coordinate: images of more are known again by coarser agreement */
const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, int camera, const std::vector<cv::Point2d>& pixels,
                                  double pixelSigma);

} // namespace tools

#endif // REFRACT_TOOLS_CALIBRATION_IMAGES_HPP
