// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHEET_HPP
#define REFRACT_TOOLS_SHEET_HPP

#include "calibrate/calib_file.hpp"
#include "measure/measurement.hpp"
#include "laser/emitter.hpp"
#include "laser/laser_signal.hpp"
#include "laser/ridges.hpp"
#include "measure/eigen_matrix.hpp"

/* A sheet of laser light as a plane in the frame of camera 1, a x + b y + c z = d with a unit normal, in the scene's medium; or that of an
emitter behind its own window, which is bent. What it was calibrated with is a part of its error: dstate = noise + byParameters dp, p the
parameters of lens and window of camera 1; the state is a plane's four numbers, or an emitter's as EmitterPrior has it. */
namespace tools {

struct Sheet
{
    cv::Vec4d plane;            //!< of an emitter's sheet: the nearest to where it was seen
    Emitter emitter = {};       //!< without a camera: the sheet is the plane
    cv::Mat covariance;         //!< of the state, by noise alone
    cv::Mat byParameters;       //!< a row for each number of the state
    double scale = 0.;          //!< px, of the line's profile
    double lineNoise = 0.;      //!< px, of the line's points beyond white noise
    LaserColour colour = LASER_ANY;
    cv::Vec2d depth;            //!< of the points that it was calibrated with
    std::string unit;
    std::string command, time;
};

//! Throws Failure that names the file; also if the sheet was calibrated with another camera.
bool isPlane(const Sheet& sheet);

//! Where the rays of camera 1's pixels meet it; NaN and a RefractiveStatus where they do not.
void pointsOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<cv::Point2d>& pixels,
                   std::vector<cv::Point3d>& points, std::vector<uchar>& status);

Sheet readSheet(const std::string& filename, const Calibration& calibration);
void writeSheet(const std::string& filename, const Sheet& sheet, const Calibration& calibration);

//! How points on a sheet move, three rows a point; NaN where there is none.
struct OnSheetDerivatives
{
    MatrixXd byAcross;          //!< by one pixel across the line
    MatrixXd byState;           //!< by the sheet's own error
    MatrixXd byParameters;      //!< by those of camera 1, which move the sheet too
};

OnSheetDerivatives differentiateOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line,
                                        const std::vector<cv::Point3d>& points);

/** Where camera rays meet the sheet, with their uncertainty: that of the pixel across the line, of the sheet and of the calibration.
Status REFRACT_PARALLEL_RAYS: the ray lies in the sheet. */
Measurement measureOnSheet(const Calibration& calibration, const Sheet& sheet, const std::vector<RidgePoint>& line);

} // namespace tools

#endif // REFRACT_TOOLS_SHEET_HPP
