// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PINHOLE_IMAGES_HPP
#define REFRACT_TOOLS_PINHOLE_IMAGES_HPP

#include "calibrate/calib_file.hpp"
#include "colmap/colmap_model.hpp"

/* Images as pinholes without windows would have taken them, for programs that know no other camera. */
namespace tools {

struct PinholeImages
{
    int images = 0;
    std::vector<std::string> leftOut;   //!< images that show no point: nothing tells how far their scene is
    size_t points = 0;                  //!< pixels of points, of all images
    double rms = 0., most = 0.;         //!< px, by wrong depth: of all pixels; what 95 % of them are below. NaN: too few points
};

/** Reads each image of a model that refract_bundle has refined, corrects it at the depth of the points that it shows, interpolated between
them, and writes DIR/images/NAME, a model of these images with PINHOLE cameras, DIR/sparse, and what COLMAP's dense stereo wants beside
them, DIR/stereo. What wrong depth does to a pixel is told by points that take no part in the interpolation.
@param model its cameras are 1, 2, ... of the calibration, or it has one camera. Throws Failure, also where the calibration sees the points
elsewhere than the model says. */
PinholeImages writePinholeImages(const ColmapModel& model, const Calibration& calibration, const std::string& imageFolder,
                                 const std::string& folder, bool quiet);

std::string pinholeImagesJson(const PinholeImages& images, const std::string& command);

//! Throws Failure if a file would overwrite one that is read, and where an image is not there.
void checkPinholeImages(const ColmapModel& model, const std::vector<std::string>& inputs, const std::string& imageFolder,
                        const std::string& folder);

} // namespace tools

#endif // REFRACT_TOOLS_PINHOLE_IMAGES_HPP
