// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_HPP
#define REFRACT_TOOLS_SHEET_HPP

#include "calibrate/calib_file.hpp"
#include "measure/measurement.hpp"
#include "laser/laser_signal.hpp"
#include "laser/ridges.hpp"

/* A sheet of laser light as a plane in the frame of camera 1, a x + b y + c z = d with a unit normal, in the scene's medium. What it was
calibrated with is a part of its error: dplane = noise + byParameters dp, p the parameters of lens and window of camera 1. */
namespace tools {

struct Sheet
{
    cv::Vec4d plane;
    cv::Mat covariance;         //!< 4x4, of the plane, by noise alone
    cv::Mat byParameters;       //!< 4 rows
    double scale = 0.;          //!< px, of the line's profile
    double lineNoise = 0.;      //!< px, of the line's points beyond white noise
    LaserColour colour = LASER_ANY;
    cv::Vec2d depth;            //!< of the points that it was calibrated with
    std::string unit;
    std::string command, time;
};

//! Throws Failure that names the file; also if the sheet was calibrated with another camera.
Sheet readSheet(const std::string& filename, const Calibration& calibration);
void writeSheet(const std::string& filename, const Sheet& sheet, const Calibration& calibration);

/** Where camera rays meet the sheet, with their uncertainty: that of the pixel across the line, of the sheet and of the calibration.
Status REFRACT_PARALLEL_RAYS: the ray lies in the sheet. */
Measurement measureOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line);

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_HPP
