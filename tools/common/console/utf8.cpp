// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/utf8.hpp"

#include <algorithm>
#include <cstdint>

namespace tools {

namespace {

//! Bytes of the character that begins there; 0: none does (RFC 3629).
size_t lengthOfCharacter(const std::string& text, size_t at)
{
    const unsigned char first = (unsigned char)text[at];
    const size_t length = first < 0x80 ? 1 : first >= 0xC2 && first < 0xE0 ? 2 : (first & 0xF0) == 0xE0 ? 3
        : first >= 0xF0 && first < 0xF5 ? 4 : 0;
    if (length == 0 || at + length > text.size())
        return 0;
    uint32_t code = length == 1 ? first : first & (0x7F >> length);
    for (size_t i = 1; i < length; i++)
    {
        const unsigned char next = (unsigned char)text[at + i];
        if ((next & 0xC0) != 0x80)
            return 0;
        code = code << 6 | (next & 0x3F);
    }
    const bool isLong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    return isLong || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? 0 : length;
}

} // namespace

std::string inLowerCase(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; });
    return text;
}

bool isUtf8(const std::string& text)
{
    for (size_t i = 0, length = 0; i < text.size(); i += length)
        if ((length = lengthOfCharacter(text, i)) == 0)
            return false;
    return true;
}

std::string toUtf8(const std::string& text)
{
    std::string result;
    for (size_t i = 0; i < text.size(); )
    {
        const size_t length = lengthOfCharacter(text, i);
        result += length ? text.substr(i, length) : "\xEF\xBF\xBD";
        i += length ? length : 1;
    }
    return result;
}

} // namespace tools
