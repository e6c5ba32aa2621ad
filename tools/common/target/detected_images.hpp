// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DETECTED_IMAGES_HPP
#define REFRACT_TOOLS_DETECTED_IMAGES_HPP

#include "target/image_check.hpp"
#include "target/target.hpp"
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tools {

//! One image in which the target was found.
struct DetectedImage
{
    std::string stem;                   //!< its view's name (view_names.hpp), mostly the file's stem: images of one view have the same
    std::string path;
    std::vector<cv::Point2d> points;    //!< a pixel of each point of the target, NaN where it was not seen
    std::vector<cv::Point3d> objectPoints = {};     //!< of points.csv; empty: those of the Target
    int seenCount() const;
};

/** Reads mrcal's corners.vnl: a vnlog table with the columns filename, x, y and perhaps level or weight, one row a
point, the points of an image row by row. '-' or a weight of 0 or less = not seen; an image with a single row of '-'
shows no target.
@param count points per image
@return file names in the file's order, each with its points, none if it shows no target */
std::vector<std::pair<std::string, std::vector<cv::Point2d>>> readCornersVnl(const std::string& path, int count);

/** Points of any target that someone else has found: `view,x,y,z,u,v`, one row an observed point, `view` in place of an
image's stem. x, y, z are in the frame of the target and in the unit of all lengths; a point without u and v was not seen.
Throws Failure that names file and line, also if a view has a point twice. */
std::vector<DetectedImage> readPointsCsv(const std::string& path);

//! The images of one camera in one state (direct or through the window), in the order of their names.
struct DetectedImages
{
    std::vector<DetectedImage> images;
    std::vector<std::string> withoutTarget;     //!< paths of images in which the target was not found
    std::vector<std::string> files;             //!< that were read
    cv::Size imageSize;

    const DetectedImage* find(const std::string& stem) const;   //!< null if there is none
};

/** Finds the target in all images of globs, or reads mrcal corners.vnl or points.csv (recognised by their extensions). All images are
read once before any is searched, and some of each source are searched before all of any: a mistake is told within seconds.
@param target null: there is none, and only a points.csv can be read.
@param quiet no progress.
@param channel of colour images, in which the target is looked for.
Throws Failure if there is no image, an image cannot be read, images of a camera differ in size, or no image of a source shows the
target. */
std::vector<DetectedImages> readDetectedImages(const std::vector<ImageSource>& sources, const Target* target, bool quiet,
                                               Channel channel = BRIGHTNESS);

//! The same of one source. @param imageSize that its images must have; empty: it is not known
DetectedImages readDetectedImages(const std::string& source, const Target* target, cv::Size imageSize, bool quiet,
                                  Channel channel = BRIGHTNESS);

//! A file of points in place of images: there is nothing to look at.
bool isPointFile(const std::string& source);

} // namespace tools

#endif // REFRACT_TOOLS_DETECTED_IMAGES_HPP
