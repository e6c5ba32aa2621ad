// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ROUND_WINDOW_HPP
#define REFRACT_TOOLS_ROUND_WINDOW_HPP

#include "assess/rig_calibration.hpp"

/* What a dome or tube is to the camera in it: one in the centre of a dome sees as if there were none. */
namespace tools {

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

/** Where a window is, in words: "tilted by 3.21 +- 0.02 degrees", or that of a dome. The +- of a tilt is that of the normal. */
std::string placeInWords(const RigCalibration& calibration, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_ROUND_WINDOW_HPP
