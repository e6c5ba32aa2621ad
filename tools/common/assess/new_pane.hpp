// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_NEW_PANE_HPP
#define REFRACT_TOOLS_NEW_PANE_HPP

#include "assess/check_input.hpp"

namespace tools {

//! How much panes of one kind differ from each other, standard deviations.
struct PaneStd
{
    double thickness, index;
    double wedge;                   //!< of each of its two angles, about 0, radians
};

/** A calibration whose panes were exchanged since for others of the same kind. Thickness and index are the calibrated ones with the
difference of two panes; wedges are about 0. */
CheckInput withNewPanes(const CheckInput& input, const PaneStd& std);

} // namespace tools

#endif // REFRACT_TOOLS_NEW_PANE_HPP
