// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DEVICE_LABEL_HPP
#define REFRACT_TOOLS_DEVICE_LABEL_HPP

#include <opencv2/core/persistence.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tools {

//! Names and notes of the calibrated device.
struct Label
{
    std::string serial;                                         //!< of the window; may be empty
    std::vector<std::pair<std::string, std::string>> notes;     //!< key and free text
};

//! "key=text" -> a note; the key becomes a name in YAML and JSON.
std::pair<std::string, std::string> parseNote(const std::string& text);

//! The keys window_serial and notes of a calibration file.
Label readLabel(const cv::FileStorage& fs);
void writeLabel(cv::FileStorage& fs, const Label& label);

} // namespace tools

#endif // REFRACT_TOOLS_DEVICE_LABEL_HPP
