// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SETTINGS_FILE_HPP
#define REFRACT_TOOLS_SETTINGS_FILE_HPP

#include <iosfwd>
#include <string>

namespace tools {

//! The text of a file of settings, without a byte order mark. Throws Failure for a setting that comes twice.
std::string readSettings(std::istream& in);

} // namespace tools

#endif // REFRACT_TOOLS_SETTINGS_FILE_HPP
