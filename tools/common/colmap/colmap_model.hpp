// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_COLMAP_MODEL_HPP
#define REFRACT_TOOLS_COLMAP_MODEL_HPP

#include <opencv2/core.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace cv { namespace refract { class RefractiveCamera; }}

/* A model as COLMAP has it: what cameras saw, from where, of which points. Numbers are COLMAP's own, so that a model that is read and
written again is the same: its pixel (0, 0) is a corner of the image. */
namespace tools {

//! A rotation as COLMAP writes it, w x y z, and a translation.
struct ColmapPose
{
    cv::Vec4d q = {1., 0., 0., 0.};
    cv::Vec3d t;
};
bool isPose(const ColmapPose& pose);            //!< finite, and a rotation

struct ColmapCamera
{
    uint32_t id = 0;
    std::string model;
    uint64_t width = 0, height = 0;
    std::vector<double> parameters;
};

struct ColmapPixel
{
    double x = 0., y = 0.;
    uint64_t point = 0;                         //!< NO_COLMAP_POINT: none
};
const uint64_t NO_COLMAP_POINT = UINT64_MAX;

struct ColmapImage
{
    uint32_t id = 0;
    ColmapPose cam_from_world;
    uint32_t camera = 0;
    std::string name;
    std::vector<ColmapPixel> pixels;
};

struct ColmapSight
{
    uint32_t image = 0, pixel = 0;
};

struct ColmapPoint
{
    uint64_t id = 0;
    cv::Vec3d X;
    cv::Vec3b color;                            //!< red, green, blue
    double error = 0.;                          //!< mean distance of its pixels from where it is projected
    std::vector<ColmapSight> track;
};

//! A camera or another instrument of a rig.
struct ColmapSensor
{
    int type = 0;                               //!< COLMAP_CAMERA or another
    uint32_t id = 0;
    uint8_t isPlaced = 0;
    ColmapPose sensor_from_rig;
};
const int COLMAP_CAMERA = 0;

struct ColmapRig
{
    uint32_t id = 0;
    std::vector<ColmapSensor> sensors;          //!< the first is the rig's frame
};

//! What a sensor took: of a camera an image.
struct ColmapData
{
    int type = 0;
    uint32_t sensor = 0;
    uint64_t id = 0;
};

//! What a rig took at one moment.
struct ColmapFrame
{
    uint32_t id = 0, rig = 0;
    ColmapPose rig_from_world;
    std::vector<ColmapData> data;
};

struct ColmapModel
{
    std::vector<ColmapCamera> cameras;
    std::vector<ColmapImage> images;
    std::vector<ColmapPoint> points;
    std::vector<ColmapRig> rigs;                //!< and frames: empty before COLMAP 3.12
    std::vector<ColmapFrame> frames;
    bool isBinary = false;
};

/** Reads cameras, images, points3D, and rigs, frames where they are, all .bin or else all .txt. Throws Failure that names the file
and, of a text, the line: where it is cut short, damaged or of another program, where files do not belong together, and where there is
nothing in it. Images without a pose are in it, see isPose(). */
ColmapModel readColmapModel(const std::string& folder);

/** Binary or text as the model says; the folder is made, and files of another model in it go: those of the other kind, and rigs and frames
where this has none. The first line of texts is `comment`. */
void writeColmapModel(const ColmapModel& model, const std::string& folder, const std::string& comment = "");

//! The paths of a model's files; writeColmapModel() writes those of one kind, and removes the others.
std::vector<std::string> colmapFilesOf(const std::string& folder, bool isBinary);

//! Of a camera without a window, as OPENCV, FULL_OPENCV or OPENCV_FISHEYE: by its lens.
ColmapCamera colmapCameraOf(const cv::refract::RefractiveCamera& camera, uint32_t id);

} // namespace tools

#endif // REFRACT_TOOLS_COLMAP_MODEL_HPP
