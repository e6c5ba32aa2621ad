// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_UTF8_HPP
#define REFRACT_TOOLS_UTF8_HPP

#include <string>

/* Pages, XML and JSON are UTF-8; what users give may be anything. */
namespace tools {

bool isUtf8(const std::string& text);

//! The letters of ASCII; others stay as they are.
std::string inLowerCase(std::string text);

//! With a replacement character for each byte that is none of a character: for names of files, which may be any bytes.
std::string toUtf8(const std::string& text);

} // namespace tools

#endif // REFRACT_TOOLS_UTF8_HPP
