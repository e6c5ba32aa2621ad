// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Numbers beside their uncertainty, and letters of any encoding.
#include "console/numbers.hpp"
#include "console/table.hpp"
#include <catch2/catch.hpp>

using namespace tools;

TEST_CASE("Numbers have two digits of their uncertainty, in any unit", "[tools][rounded]")
{
    CHECK(decimalsOf(0.0226) == 3);
    CHECK(decimalsOf(0.0996) == 2);
    CHECK(decimalsOf(0.0000226) == 6);
    CHECK(decimalsOf(123.) == -1);
    CHECK(rounded(1234.5, -1) == "1230");
    CHECK(rounded(0.01, 3, true) == "+0.010");
    CHECK(rounded(-0.0004, 3, true) == "0.000");            // zero has no sign
    CHECK(rounded(-0.0006, 3, true) == "-0.001");
    CHECK(plusMinus(7.04, 0.02) == "7.040 +- 0.020");
    CHECK(plusMinus(150.9007, 108.6) == "150 +- 110");      // not 150.9 +- 1.1e+02
    CHECK(plusMinus(-1.9968e-06, 6.8e-06) == "-0.0000020 +- 0.0000068");
    CHECK(plusMinus(1.5, 0.) == "1.500000 +- 0.000000");
}

TEST_CASE("What is not UTF-8 is known, and replaced", "[tools][rounded]")
{
    CHECK(isUtf8("Prüfling \xF0\x9F\x98\x80"));
    CHECK_FALSE(isUtf8("Pr\xFC" "fling"));
    CHECK_FALSE(isUtf8("\xC0\xAF"));
    CHECK_FALSE(isUtf8("\xED\xA0\x80"));
    CHECK(toUtf8("Pr\xFC" "f") == "Pr\xEF\xBF\xBD" "f");
}
