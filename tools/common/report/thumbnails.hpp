// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_THUMBNAILS_HPP
#define REFRACT_TOOLS_THUMBNAILS_HPP

#include "assess/rig_calibration.hpp"

/* Small copies of the images with the detected points, as some mistakes are seen at once in an image and in no number. */
namespace tools {

//! A small JPEG of an image with dots on its points, for the src of an <img>.
struct Thumbnail
{
    std::string uri;            //!< "data:image/jpeg;base64,..."
    std::string caption;
    bool suspect;               //!< no target found, or points left out
};

//! Colours of points in CSS, and how far these lie from where the calibration puts them, in words.
struct PhotoScale
{
    std::string colour, name;
};
std::vector<PhotoScale> photoScale(const RigCalibration& calibration);

/** The images for the page, in their order: all of them, or of very many those to look at first, which are
images without target or with points left out, then those whose points lie farthest off. */
std::vector<Photo> photosToShow(const RigCalibration& calibration);

//! Throws Failure if the image cannot be read any more.
Thumbnail makeThumbnail(const RigCalibration& calibration, const Photo& photo);

} // namespace tools

#endif // REFRACT_TOOLS_THUMBNAILS_HPP
