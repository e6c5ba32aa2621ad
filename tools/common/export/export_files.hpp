// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_EXPORT_FILES_HPP
#define REFRACT_TOOLS_EXPORT_FILES_HPP

#include "calibrate/calib_file.hpp"
#include "colmap/colmap_model.hpp"
#include "export/central_camera.hpp"
#include <opencv2/core.hpp>
#include <opencv2/refract.hpp>
#include <string>
#include <vector>

/* Files for programs that have no model of a window, each states its error, and for those that have one. */
namespace tools {

//! A line of what refract_measure wrote.
struct MeasuredPoint
{
    std::string image;                      //!< stem: the view
    std::vector<cv::Point2d> pixels;        //!< of each camera, raw; NaN: not seen
    cv::Point3d X;                          //!< frame of camera 1
};

//! Points that have a place. Throws Failure that names file and line.
std::vector<MeasuredPoint> readMeasuredPoints(const std::string& path, int cameras);

/* A camera behind a window as Calibmar and COLMAP's fork for cameras under water have it, exactly; makePort() reads it again. */

//! FLATPORT (normal, distance) or DOMEPORT (centre, radius), then thickness and the indices inside, of the port, outside.
struct ColmapPort
{
    std::string model;                  //!< empty: there is no window
    std::vector<double> parameters;
};

/** Throws Failure for a window, or a lens, that they have none like.
@param name of the camera @param program that is told */
ColmapPort colmapPortOf(const cv::refract::GlassWindow& window, const std::string& name, const std::string& program);
ColmapCamera exactColmapCamera(const cv::refract::RefractiveCamera& camera, uint32_t id, const std::string& name,
                               const std::string& program);

//! A file of a folder, and its text.
struct ExportFile
{
    std::string name, text;
};

/** OpenCV: the keys of calib.yml without windows; R, T, R3 ... from the first central camera to each. `central_R`, `central_T`:
frame of camera 1 of the calibration -> each central camera. */
void writeOpenCV(const std::string& path, const CentralRig& rig);

//! mrcal: NAME.cameramodel of each camera; the reference frame is that of camera 1 of the calibration.
std::vector<ExportFile> mrcalFiles(const CentralRig& rig);

//! ROS: NAME.yaml of each camera, sensor_msgs/CameraInfo; of a pair with its rectification.
std::vector<ExportFile> rosFiles(const CentralRig& rig);

/** COLMAP's text model: cameras.txt, images.txt, points3D.txt; the world is the frame of camera 1 of the calibration.
@param points measured ones, with the pixels where the central cameras would have seen them; may be empty
@param extension what the names of images end in; may be empty */
std::vector<ExportFile> colmapFiles(const CentralRig& rig, const std::vector<MeasuredPoint>& points, const std::string& extension);

/** Calibmar: NAME.yaml of each camera, lens and window, exactly; where the cameras are has no place there. Throws Failure for a lens or a
window that it has none like.
@param source the calibration's file */
std::vector<ExportFile> calibmarFiles(const Calibration& calibration, const std::string& source);

/** COLMAP's fork for cameras under water: the text model with windows, pixels and points as they are, exactly. Throws Failure as
calibmarFiles() does. */
std::vector<ExportFile> underwaterColmapFiles(const Calibration& calibration, const std::string& source,
                                              const std::vector<MeasuredPoint>& points, const std::string& extension);

/** OpenPTV: camN.tif.ori and camN.tif.addpar of each camera, and ptv.par, exactly. Throws Failure for a lens or a window that it has none
like, and where the cameras have different ones. */
std::vector<ExportFile> openPtvFiles(const Calibration& calibration);

} // namespace tools

#endif // REFRACT_TOOLS_EXPORT_FILES_HPP
