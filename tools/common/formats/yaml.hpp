// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_YAML_HPP
#define REFRACT_TOOLS_YAML_HPP

#include "console/json.hpp"

namespace tools {

/** YAML as programs write numbers with it: maps, lists, both in either style, numbers and texts. cv::FileStorage takes only what OpenCV
writes: a heading, and lists that are indented. Tags are passed over; anchors, and texts of several lines, are refused.
Throws Json::Error that names the line. */
Json readYaml(const std::string& text);

} // namespace tools

#endif // REFRACT_TOOLS_YAML_HPP
