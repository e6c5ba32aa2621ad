// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_BYTES_HPP
#define REFRACT_TOOLS_BYTES_HPP

#include "console/failure.hpp"

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

private:
    const std::string& bytes_;
    size_t at_ = 0;
};

/** What zlib has made smaller. @param raw without zlib's own heading, as in a zip file. Throws Failure. */
std::string inflated(const std::string& bytes, bool raw);

} // namespace tools

#endif // REFRACT_TOOLS_BYTES_HPP
