// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FIT_ERROR_HPP
#define REFRACT_TOOLS_FIT_ERROR_HPP

#include "calibrate/rig_data.hpp"
#include <opencv2/refract.hpp>

namespace tools {

/** The library's error with a text (err) in the tools' words: views by the names of their files, options in place of arguments.
@param views of the data, which the library was given */
cv::refract::CalibrationError inToolsWords(const cv::refract::CalibrationError& error, const RigData& data,
                                           const std::vector<int>& views);

} // namespace tools

#endif // REFRACT_TOOLS_FIT_ERROR_HPP
