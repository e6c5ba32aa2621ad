// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_KEYED_CAMERAS_HPP
#define REFRACT_TOOLS_KEYED_CAMERAS_HPP

#include "console/json.hpp"
#include "formats/foreign_rig.hpp"

namespace tools {

/** The cameras of a file of names and values, whatever it was written as (YAML, XML, JSON, NumPy, MATLAB), and where they are, if it
says. No cameras: it has none. Throws Failure, or Json::Error where a value is not what it must be.
@param format receives whose file it looks like, before anything is thrown */
ForeignRig readKeyedCameras(const Json& file, std::string& format);

//! All numbers of a list of lists, or of a map's data; empty where it has others than numbers.
std::vector<double> numbersOf(const Json& json);

} // namespace tools

#endif // REFRACT_TOOLS_KEYED_CAMERAS_HPP
