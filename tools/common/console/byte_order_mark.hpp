// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BYTE_ORDER_MARK_HPP
#define REFRACT_TOOLS_BYTE_ORDER_MARK_HPP

#include <string>

namespace tools {

//! A text without the mark with which some programs, and editors of Windows, begin UTF-8.
inline std::string withoutByteOrderMark(std::string text)
{
    const std::string MARK = "\xEF\xBB\xBF";
    if (text.compare(0, MARK.size(), MARK) == 0)
        text.erase(0, MARK.size());
    return text;
}

} // namespace tools

#endif // REFRACT_TOOLS_BYTE_ORDER_MARK_HPP
