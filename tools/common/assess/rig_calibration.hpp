// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_CALIBRATION_HPP
#define REFRACT_TOOLS_RIG_CALIBRATION_HPP

#include "assess/cross_validation.hpp"
#include "calibrate/lens_choice.hpp"
#include "calibrate/outliers.hpp"
#include "calibrate/provenance.hpp"
#include <optional>

/* A complete calibration, and the numbers that describe it. */
namespace tools {

//! The expected error of a measured point that the caller allows at a range.
struct ErrorLimit
{
    double range, error;
};

//! Limits that the caller sets; 0 or empty: none.
struct Limits
{
    double rms = 0., normalStdDeg = 0.;
    std::vector<ErrorLimit> errors;
};

//! An image that was searched for the target.
struct Photo
{
    std::string path, stem;
    int camera;
    bool glass;
    std::vector<cv::Point2d> points;            //!< found; empty: the target was not
};

//! The data of the table, the JSON summary and the report; what is derived from them is in findings.hpp.
struct RigCalibration
{
    RigData data;
    RigOptions options;
    LensChoice lens;                            //!< where the user named none
    RigModel start;
    std::vector<LensSource> lensSources;
    Fit fit;
    std::vector<Residual> residuals;
    Baselines baselines;
    HeldOut heldOut;
    NearFar nearFar;
    bool crossValidated = true;                 //!< false: heldOut and nearFar were not wanted
    std::vector<Influence> influences;          //!< only if asked for
    std::vector<std::string> withoutTarget;     //!< images in which the target was not found
    std::vector<Photo> photos;
    std::vector<UsedImage> used;                //!< images that show the target
    std::vector<std::string> notices;           //!< of the checks of the images, see data_checks.cpp
    std::vector<Rejected> fewPoints;            //!< images that have no pose, already removed from data
    Outliers outliers;                          //!< points and images, already removed from data
    std::vector<std::string> inputs;            //!< files that it was made from
    Limits limits;
    Label label;
    std::string unit = "mm";                    //!< of length
    double square = 0.;                         //!< side of a square of the board, as given; 0: there is no board
};

//! Images that have no pose, then outliers.
std::vector<Rejected> rejectedOf(const RigCalibration& calibration);

struct Rms
{
    double px = NONE;           //!< sqrt(mean |r|^2), as cv::calibrateCamera
    int points = 0, views = 0;
};

//! Of the images of one camera in one state; view >= 0: of that view alone.
Rms rmsOf(const RigCalibration& calibration, int camera, bool glass, int view = -1);

//! Both states together.
Rms rmsOfCamera(const RigCalibration& calibration, int camera);

//! Another tilt of a window that has a minimum of its own: its images through the window alone do not exclude it.
struct SecondSolution
{
    cv::Vec3d normal;           //!< of a dome or tube its centre
    std::string of;             //!< "normal", "centre"
    double excess;              //!< root of the difference of the squared errors, in standard deviations of a pixel
    double rms;                 //!< px, through the window, where the fit has rmsOf
    double fitRms;

    bool isExcluded() const { return excess >= 3.; }    //!< by the data, see calibrateGlassRig
    std::string sentence() const;
};

//! The second best of a camera's window; none with pairs, and for a shared window in the first camera alone.
std::optional<SecondSolution> secondSolution(const RigCalibration& calibration, int camera);

//! Share of the cells of an 8 x 6 grid over the image with a corner seen through the window.
double coverage(const RigCalibration& calibration, int camera);

//! Of all points seen through the windows; none without images through them.
std::optional<CalibratedVolume> calibratedVolume(const RigCalibration& calibration);

//! Distance of the board's points from camera 1, at the views with a glass image: nearest, median, farthest z.
cv::Vec3d workingDepth(const RigCalibration& calibration, int camera);

/* What a dome or tube is to the camera in it: one in the centre of a dome sees as if there were none. */

struct RoundWindow
{
    std::string shape;                  //!< "dome", "tube"
    double offset, offsetStd;           //!< of the camera from the centre, or from a tube's axis
    double px, length, depth;           //!< the farthest that it moves a point of the image: there, and at the middle depth of the boards
    double withPx, ignoredPx;           //!< RMS through the window: of the fit, and with the window ignored

    //! The images fit as well if it is ignored.
    bool isNeedless() const;
    //! "3.1 +- 0.05 mm from the camera, which moves points by up to 2.1 px (0.7 mm at z = 600 mm)"
    std::string offsetWords(const std::string& unit) const;
    //! What the images cannot tell; empty: it has to be modelled.
    std::string needless(const std::string& unit) const;
};

//! None: the window is no such one.
std::optional<RoundWindow> roundWindowOf(const RigCalibration& calibration, int camera);

/** The +- of tiltDegrees() of a flat window: that of the normal towards the optical axis. What is across it says how well the direction
of the tilt is known; of a tilt that is hardly one both count. */
double tiltStdDegrees(const Fit& fit, int camera);

//! Where a window is, in words: "3.21 +- 0.02 degrees" of tilt, or how far the centre of a dome is from the camera.
std::string placeInWords(const RigCalibration& calibration, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_CALIBRATION_HPP
