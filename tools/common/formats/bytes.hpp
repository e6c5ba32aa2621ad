// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BYTES_HPP
#define REFRACT_TOOLS_BYTES_HPP

#include "console/failure.hpp"

#include <cstdint>
#include <cstring>
#include <string>

namespace tools {

//! Reads a binary file, little endian, from its beginning to its end. Throws Failure where it is too short.
class ByteReader
{
public:
    explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

    size_t left() const { return bytes_.size() - at_; }
    void skip(size_t count)
    {
        if (count > left())
            throw Failure("it ends too early: is it cut short?");
        at_ += count;
    }
    std::string take(size_t count)
    {
        skip(count);
        return bytes_.substr(at_ - count, count);
    }
    template<typename T> T number()
    {
        T value;
        const std::string raw = take(sizeof value);
        std::memcpy(&value, raw.data(), sizeof value);
        return value;
    }

    //! By its kind ('i', 'u', 'f') and bytes, as NumPy names them.
    double number(char kind, int bytes)
    {
        switch (kind*16 + bytes)
        {
        case 'i'*16 + 1: return number<int8_t>();
        case 'i'*16 + 2: return number<int16_t>();
        case 'i'*16 + 4: return number<int32_t>();
        case 'i'*16 + 8: return (double)number<int64_t>();
        case 'u'*16 + 1: return number<uint8_t>();
        case 'u'*16 + 2: return number<uint16_t>();
        case 'u'*16 + 4: return number<uint32_t>();
        case 'u'*16 + 8: return (double)number<uint64_t>();
        case 'f'*16 + 4: return number<float>();
        case 'f'*16 + 8: return number<double>();
        default: throw Failure("a number has a type that is not read");
        }
    }

private:
    const std::string& bytes_;
    size_t at_ = 0;
};

/** What zlib has made smaller. @param raw without zlib's own heading, as in a zip file. Throws Failure. */
std::string inflated(const std::string& bytes, bool raw);

} // namespace tools

#endif // REFRACT_TOOLS_BYTES_HPP
