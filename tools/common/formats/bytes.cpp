// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "formats/bytes.hpp"

#include <zlib.h>

namespace tools {

std::string inflated(const std::string& bytes, bool raw)
{
    const size_t MOST = 64 << 20;           // a camera is small; a file that claims more is none
    const std::string DAMAGED = "what is compressed in it is damaged: is it cut short?";
    z_stream stream = {};
    stream.next_in = (Bytef*)bytes.data();
    stream.avail_in = (uInt)bytes.size();
    if (inflateInit2(&stream, raw ? -MAX_WBITS : MAX_WBITS) != Z_OK)
        throw Failure(DAMAGED);
    std::string result;
    char buffer[16384];
    int state = Z_OK;
    while (state == Z_OK && result.size() < MOST)
    {
        stream.next_out = (Bytef*)buffer;
        stream.avail_out = sizeof buffer;
        state = inflate(&stream, Z_NO_FLUSH);
        result.append(buffer, sizeof buffer - stream.avail_out);
    }
    inflateEnd(&stream);
    if (state != Z_STREAM_END)
        throw Failure(DAMAGED);
    return result;
}

} // namespace tools
