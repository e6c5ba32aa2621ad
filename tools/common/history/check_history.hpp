// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_HISTORY_HPP
#define REFRACT_TOOLS_CHECK_HISTORY_HPP

#include "assess/rig_check.hpp"
#include "calibrate/provenance.hpp"
#include "console/json.hpp"
#include "console/times.hpp"
#include <string>
#include <vector>

/* All checks of one calibration, as refract_check --history keeps them: a JSON file, a record a check, in the order of their times. Each
has the SHA-256 of itself, with what the file says of the rig and its charts, and of the one before, and the file that of the last one: an
edited or deleted record is told, as is one that was left out on purpose. Whoever computes them all anew is not found out; that takes a
signature. */
namespace tools {

//! Parameters that are charted together: the two of a window's tilt, the focal length.
struct ChartedChange
{
    std::string name, unit;             //!< "window of camera 1: tilt", "degrees"
    std::vector<std::string> axes;      //!< a name of each parameter
    double factor;                      //!< from a parameter to the unit

    int size() const { return (int)axes.size(); }
};

struct CheckedImage
{
    std::string name, sha256;
};

//! One check. What of the rig it tells, as ChartedScore has it.
struct CheckRecord
{
    std::string time;                   //!< ISO 8601, UTC
    std::vector<CheckedImage> images;   //!< or files of points
    std::vector<CalibrationImage> shown;    //!< where they show the target, by which an image is known if it was stored anew
    std::string verdict;
    double sigma = 0., dof = 0.;        //!< of a pixel coordinate, and how well the calibration knows it
    std::vector<int> changes;           //!< which of CheckHistory::changes its images tell, in their order
    VectorXd score;
    MatrixXd information, byParameters;
    Json written;                       //!< as the file has it, with SHA-256 of the record before and of this one; null: new
};

struct CheckHistory
{
    std::string calibration;            //!< SHA-256 of its file
    std::string serial;                 //!< of the window; may be empty
    std::vector<ChartedChange> changes;
    std::vector<CheckRecord> checks;
    std::string last;                   //!< SHA-256 of the last check, as the file says; the next one is chained to it
    std::vector<std::string> broken;    //!< where the chain is, a sentence each
};

//! No file: an empty history. Throws Failure if the file is not one.
CheckHistory readHistory(const std::string& filename);
//! The complete file or none.
void writeHistory(const std::string& filename, const CheckHistory& history);

//! What a check adds. @param files that it read, which are known by their bytes @param shown of its images
CheckRecord recordOf(const ChartedScore& score, const std::vector<std::string>& files, const std::string& time, CheckHistory& history,
                     const std::vector<CalibrationImage>& shown = {});

/** Throws Failure unless the history is that of this calibration, and the check is a new and later one. An empty history becomes that of
the calibration. */
void requireSameRig(CheckHistory& history, const std::string& filename, const Calibration& calibration,
                    const std::string& calibrationFile);
//! @param tolerance of pixels, within which two images are the same
void requireNew(const CheckHistory& history, const std::string& filename, const CheckRecord& check, double tolerance = USUAL_TOLERANCE);
//! Throws Failure if one of its images calibrated.
void requireNotCalibrated(const CheckRecord& check, const Calibration& calibration, double tolerance);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_HISTORY_HPP
