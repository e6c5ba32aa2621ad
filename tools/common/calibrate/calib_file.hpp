// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CALIB_FILE_HPP
#define REFRACT_TOOLS_CALIB_FILE_HPP

#include "calibrate/provenance.hpp"
#include "calibrate/rigid_transform.hpp"
#include "console/images.hpp"
#include "console/times.hpp"
#include <opencv2/refract.hpp>
#include <string>
#include <vector>

/* calib.yml: one camera at top level; two under `camera1`, `camera2` with `R`, `T` beside them; more: `camera3` with `R3`, `T3`
and so on; window_of_camera where some share a window: equal numbers look through the same one.

Per camera: image_width, image_height, camera_matrix, distortion_coefficients, lens_model, glass_window {normal, distance, thickness,
index, inner_index, outer_index, wedge, curvature, wavelength, materials; of a dome or tube center, axis, radius in place of normal and
distance}, glass_window_std {normal_deg, distance, center, axis_deg, radius, thickness, index, outer_index, wedge, curvature, each where
the window has it}, rms. At top level also rms (over all cameras), covariance, residual_sigma, degrees_of_freedom, unit and
target_square (of the board), placement_std (see GivenStd), channel (of colour images, that it is for), verdict, contradictions (what the
data say against what was given, a sentence each), weak_points (a sentence each), window_serial,
notes {key: text}, what provenance.hpp names, and command,
refract_version, opencv_version, calibration_time. */
namespace tools {

class Command;

//! One standard deviation of what was estimated; 0 where it was fixed, empty where nothing is known.
struct WindowStd
{
    std::vector<double> normalDeg;      //!< two principal ones, larger first, degrees; empty: it has a centre
    double distance = 0.;
    std::vector<double> center;         //!< of a dome or tube, x, y, z; of a flat window empty
    std::vector<double> axisDeg;        //!< of a tube, as normalDeg
    double radius = 0.;
    std::vector<double> thickness, index;
    double outerIndex = 0.;
    std::vector<double> wedge;          //!< radians, two a layer
    double curvature = 0.;

    bool isKnown() const { return !normalDeg.empty() || !center.empty(); }
};

struct CameraCalibration
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    WindowStd windowStd;
    double rms = -1.;                   //!< px; negative where unknown
    bool windowGiven = false;           //!< the file has a glass_window, be it one without layers
    double normalLength = 1.;           //!< as the file has it; the camera's own is 1
};

struct Calibration
{
    std::vector<CameraCalibration> cameras;
    std::vector<RigidTransform> extrinsics;     //!< camera 1 -> each camera; the first is the identity
    std::vector<int> windows;                   //!< which window each camera looks through; empty: each has its own
    double rms = -1.;                           //!< px, over all cameras; negative where unknown
    cv::Mat covariance;     //!< of calibrateGlassRig, in its order; empty where unknown
    double sigma = -1.;     //!< standard deviation of a pixel coordinate, from the residuals; negative where unknown
    double dof = 0.;        //!< degrees of freedom of those residuals; 0 where unknown
    std::string unit;       //!< of length; empty where unknown
    double square = 0.;     //!< side of a square of the board that it was made with; 0 where unknown
    double placementStd = -1.;      //!< by how much boards moved between direct and glass images, per axis; negative where unknown
    Channel channel = BRIGHTNESS;   //!< of colour images, in which the points were found: it is valid for that one
    std::string verdict;    //!< of refract_calib; empty where unknown
    /** Between the images and given values, a sentence each: errors of points may be larger than their +-. */
    std::vector<std::string> contradictions;
    std::vector<std::string> weakPoints;    //!< which the verdict counts on the reader to look at
    Label label;
    Provenance provenance;
    std::string command;    //!< the command line that made it
    std::string time;       //!< of its data, see timeOfFiles()

    //! A camera at the end, where it is from camera 1.
    void add(const CameraCalibration& camera, const RigidTransform& cam_from_cam1 = RigidTransform());
    bool single() const { return cameras.size() == 1; }
    std::vector<cv::Size> imageSizes() const;       //!< of each camera; empty ones where unknown
};

/** Throws cv::Exception or Failure that names the file; also if a lens comes without distortion_coefficients or the
covariance is not of these cameras or none at all. */
Calibration readCalibration(const std::string& filename);

/** A file without glass_window is a mistake more often than not: refuses it, unless `noWindow` says that there is none (and
refuses a window then). Refuses a normal that is no unit vector, too: in a calibration someone edited it; only a scene that
was written by hand may have any length.
@param option that says so, for the text; empty if the tool has none */
void requireWindows(const Calibration& calibration, const std::string& filename, bool noWindow,
                    const std::string& option = "--no-window");

//! Warns the user of a calibration that its own images contradict.
void warnOfContradictions(const Calibration& calibration, const std::string& filename, const Command& command);

//! All three: of a rig to work with.
Calibration readCalibration(const std::string& filename, bool noWindow, const Command& command,
                            const std::string& option = "--no-window");

//! A lens from a file, and its covariance.
struct KnownLens
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    cv::Mat covariance;         //!< of its parameters; empty where the file has none
};

//! Whether a file has several cameras, by their names.
bool isOfRig(const std::string& filename);

/** A lens as RefractiveCamera::read takes it, which is content without distortion_coefficients; this is not.
@param name of the camera in the file, as there */
KnownLens readLens(const std::string& filename, const std::string& name = "");

//! The cameras, their windows and places, as all files of a rig have them.
void writeCameras(cv::FileStorage& fs, const Calibration& calibration);

//! Writes the complete file or none. Adds versions.
void writeCalibration(const std::string& filename, const Calibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_CALIB_FILE_HPP
