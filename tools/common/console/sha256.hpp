// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SHA256_HPP
#define REFRACT_TOOLS_SHA256_HPP

#include <string>

namespace tools {

//! SHA-256 of a file's bytes, 64 hexadecimal digits. Throws Failure if it cannot be read.
std::string sha256OfFile(const std::string& path);

//! Of a text.
std::string sha256Of(const std::string& text);

} // namespace tools

#endif // REFRACT_TOOLS_SHA256_HPP
