// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What stands at the axes of pictures.
#include "report/plot.hpp"
#include <catch2/catch.hpp>

using tools::Plot;

TEST_CASE("An axis says its unit where that is known", "[plot]")
{
    CHECK(Plot::quoted("z", "mm") == "'z, mm'");
    CHECK(Plot::quoted("z", "") == "'z'");              // and no comma with nothing after it
    CHECK(Plot::quoted("camera's z", "'") == "'camera''s z, '''");
}
