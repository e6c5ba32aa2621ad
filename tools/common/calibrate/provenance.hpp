// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PROVENANCE_HPP
#define REFRACT_TOOLS_PROVENANCE_HPP

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

} // namespace tools

#endif // REFRACT_TOOLS_PROVENANCE_HPP
