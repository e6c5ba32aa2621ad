// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_BYTES_HPP
#define REFRACT_FUZZ_BYTES_HPP

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

/* The fuzzer's bytes as a sequence of decisions. When they are used up every decision is the plain one: number 0, "not rarely",
the middle of a range; so a short input is a plain call, and each byte more makes it stranger. */
namespace fuzz {

class Bytes
{
public:
    Bytes(const uint8_t* data, size_t size) : at_(data), end_(data + size) {}

    int below(int n) { return n > 256 ? (byte() + 256*byte()) % n : byte() % n; }
    bool maybe() { return byte() % 2 == 1; }
    //! One byte in 16: what a sensible caller would not do.
    bool rarely() { return byte() >= 240; }

    //! Any double at all.
    double number()
    {
        const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
        static const double special[] = {0., -0., 1., -1., nan, inf, -inf, 1e-300, 1e300, -1e300, 5e-324, 1e-9, 1e9, 1e39, -1e39,
                                         1.7e308, 0.5, 2., 3., 90., 255., 65536., 2147483648., 1e18};
        const int kind = byte();
        if (kind < 128)
            return special[kind % (sizeof(special)/sizeof(*special))];
        uint64_t bits = 0;
        for (int i = 0; i < 8; i++)
            bits = bits << 8 | (uint64_t)byte();
        double value;
        std::memcpy(&value, &bits, sizeof(value));
        return value;
    }

    //! Within the range; rarely any number.
    double about(double low, double high)
    {
        if (rarely())
            return number();
        const int steps = at_ == end_ ? 32768 : byte() + 256*byte();
        return low + (high - low)*steps/65535.;
    }

    std::string rest()
    {
        const std::string text((const char*)at_, (size_t)(end_ - at_));
        at_ = end_;
        return text;
    }

private:
    int byte() { return at_ == end_ ? 0 : *at_++; }

    const uint8_t *at_, *end_;
};

} // namespace fuzz

#endif // REFRACT_FUZZ_BYTES_HPP
