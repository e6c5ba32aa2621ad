// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_THUMBNAILS_HPP
#define REFRACT_TOOLS_THUMBNAILS_HPP

#include "assess/rig_calibration.hpp"

/* The images themselves, small, with the points that were found in them: what no number says is seen at a glance. */
namespace tools {

//! A small JPEG of an image with dots on its points, for the src of an <img>.
struct Thumbnail
{
    std::string uri;            //!< "data:image/jpeg;base64,..."
    std::string caption;
    bool suspect;               //!< no target found, or points left out
};

//! The images that the views of the sets came from; none for corners that came from a file.
std::vector<Photo> photosOf(const RigViewSets& sets);

//! Throws Failure if the image cannot be read any more.
Thumbnail makeThumbnail(const RigCalibration& calibration, const Photo& photo);

} // namespace tools

#endif // REFRACT_TOOLS_THUMBNAILS_HPP
