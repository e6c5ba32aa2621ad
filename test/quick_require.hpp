// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_QUICK_REQUIRE_HPP
#define REFRACT_TEST_QUICK_REQUIRE_HPP

#include <catch2/catch.hpp>

/* For loops of thousands: REQUIRE with the values to show, which are written out only where it fails. Catch2's own CAPTURE
   and REQUIRE write them every time, which takes many times as long as what is tested, above all under sanitizers. */
#define QUICK_REQUIRE(condition, ...) \
    do \
    { \
        if (!(condition)) \
        { \
            CAPTURE(__VA_ARGS__); \
            FAIL(#condition); \
        } \
    } while (false)

#endif
