// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PROVENANCE_HPP
#define REFRACT_TOOLS_PROVENANCE_HPP

#include "calibrate/rig_data.hpp"
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/* Where a calibration comes from, as calib.yml keeps it for whoever tests it later: calibration_images (which must not test it),
calibrated_volume (beyond which it extrapolates) and uncertainty_sources (what its covariance is made of). */
namespace tools {

//! Names and notes of the calibrated device.
struct Label
{
    std::string serial;                                         //!< of the window; may be empty
    std::vector<std::pair<std::string, std::string>> notes;     //!< key and free text
};

//! "key=text" -> a note; the key becomes a name in YAML and JSON.
std::pair<std::string, std::string> parseNote(const std::string& text);

//! The keys window_serial and notes of a calibration file.
Label readLabel(const cv::FileStorage& fs);
void writeLabel(cv::FileStorage& fs, const Label& label);

//! An image in which the target was found.
struct CalibrationImage
{
    std::string name;               //!< of its view: the file's stem
    int camera = 0;
    std::string sha256;             //!< of the file; empty where many images came in one file of points
    cv::Point2d mean;               //!< of the target's pixels; of older files all that is known of them
    std::vector<cv::Point2d> pixels;    //!< of the target's points that are seen, to a hundredth; empty: an older file
};

//! A box that holds the points seen through the windows, in the frame of camera 1.
struct CalibratedVolume
{
    cv::Point3d least, most;

    cv::Vec3d size() const { return most - least; }
    double diagonal() const { return cv::norm(size()); }
    bool contains(const cv::Point3d& X) const;
};

const char* const SQUARE_OF_BOARD = "square of the board";             //!< names of sources
const char* const SCALE_OF_TARGETS = "scale of the targets";           //!< in %
const char* const INDEX_OF_MEDIUM = "index of the scene's medium";

/** What one given value contributes to the covariance of the calibration: factor*factor^T. A standard deviation of the value moves
the parameters by a column; the images' own part is what is left of the covariance. */
struct UncertaintySource
{
    std::string name, given;        //!< "thickness, camera 1", "0.1 mm"
    double std = 0.;                //!< of each column's value; 0: they differ
    cv::Mat factor;                 //!< rows of the covariance

    bool isOfTarget() const { return name == SQUARE_OF_BOARD || name == SCALE_OF_TARGETS; }
};

struct Provenance
{
    std::vector<CalibrationImage> images;
    std::optional<CalibratedVolume> volume;
    std::vector<UncertaintySource> sources;
};

//! Throws Failure that names the file where the keys are there but make no sense.
Provenance readProvenance(const cv::FileStorage& fs, const std::string& filename);
void writeProvenance(cv::FileStorage& fs, const Provenance& provenance);

/* Images that calibrated, so that they are known again: they must not test the calibration. A file is known by its bytes; an image that
was stored anew, made a little noisier, cropped, or of which points were left out, by where it shows the target: a board that was held anew,
even next to where it was, is farther off. */

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

#endif // REFRACT_TOOLS_PROVENANCE_HPP
