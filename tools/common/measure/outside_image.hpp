// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_OUTSIDE_IMAGE_HPP
#define REFRACT_TOOLS_OUTSIDE_IMAGE_HPP

#include "measure/measurement.hpp"

/* Pixels that no image has. The lens model answers for them too, somewhere, with a +- as good as any other. */
namespace tools {

/** Points with a pixel more than a pixel outside of its image become NaN with the status OUTSIDE_IMAGE. To be called before their
consistency is checked, which they would distort. Cameras whose image size is not known are left out. */
void forgetOutside(const Calibration& calibration, Measurement& measurement);

//! What to say of them, with the first one by its name; empty: there are none.
std::string outsideIn(const Calibration& calibration, const Measurement& measurement, const std::vector<std::string>& ids);

} // namespace tools

#endif // REFRACT_TOOLS_OUTSIDE_IMAGE_HPP
