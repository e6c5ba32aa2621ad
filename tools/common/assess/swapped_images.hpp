// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SWAPPED_IMAGES_HPP
#define REFRACT_TOOLS_SWAPPED_IMAGES_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"

/* Images that are not what they are given for: turned, mirrored, exchanged, of other moments. */
namespace tools {

//! The views with one such mistake undone.
struct Undone
{
    std::string name;           //!< "images of camera 2 mirrored"
    int camera;                 //!< from 0; negative: of the rig as a whole
    std::vector<View> views;
    int poses = 0;              //!< more than before
};

//! Mistakes that leave residuals of many pixels.
std::vector<Undone> swappedImages(const RigModel& rig, const std::vector<View>& views);

//! Images given as of one place of the board, or of one moment, that are not: any of them may fit better so.
std::vector<Undone> unrelatedImages(const RigModel& rig, const std::vector<View>& views);

} // namespace tools

#endif // REFRACT_TOOLS_SWAPPED_IMAGES_HPP
