// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIBRATION_IMAGES_HPP
#define REFRACT_TOOLS_CALIBRATION_IMAGES_HPP

#include "calibrate/provenance.hpp"
#include "calibrate/rig_data.hpp"

/* Images that calibrated, so that they are known again: they must not test the calibration. A file is known by its bytes; an image that
was stored anew, made a little noisier, cropped, or of which points were left out, by where it shows the target: a board that was held anew,
even next to where it was, is farther off. */
namespace tools {

//! One that calibrates.
struct UsedImage
{
    std::string path;               //!< empty: its points came in a file of points
    CalibrationImage image;         //!< without sha256
};

std::vector<UsedImage> usedImages(const RigImages& sets);

/* Storing an image as a JPEG of quality 50, or two grey levels of noise, move a corner by 0.03 px where 0.014 px is its noise. A board that
moves by a tenth of a millimetre, 600 mm away, moves by 0.2 px. */
const double USUAL_TOLERANCE = 0.1;

//! For images of this noise of a pixel coordinate, or of an unknown one (NaN).
double sameImageTolerance(double pixelSigma);

//! As they go into the file: with the hashes of those that are files.
std::vector<CalibrationImage> withHashes(const std::vector<UsedImage>& used);

/** Whether two images show the target in the same pixels, whatever their names and numbers are.
@param tolerance px, by which more than half of them may be off */
bool areOfOneImage(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second, double tolerance);

//! The middle of the pixels that are seen; NaN: none is.
cv::Point2d meanOfSeen(const std::vector<cv::Point2d>& pixels);

//! The image with these bytes; null: none.
const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, const std::string& sha256);

/** The image of a camera that shows the target where these pixels do (areOfOneImage), or the same number of whole pixels beside them, as
one does that was cropped or rolled; null: none. */
const CalibrationImage* findImage(const std::vector<CalibrationImage>& images, int camera, const std::vector<cv::Point2d>& pixels,
                                  double tolerance);

/** Of the shown images those of which two or more are beside images of their camera by the same shift, whole or not: they were resampled. A
single board may be moved so; of several, at different places, each moves otherwise. */
std::vector<std::string> movedAlike(const std::vector<CalibrationImage>& images, const std::vector<CalibrationImage>& shown,
                                    double tolerance);

} // namespace tools

#endif // REFRACT_TOOLS_CALIBRATION_IMAGES_HPP
