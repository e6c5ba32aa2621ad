// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which image of a pair is waited for, said as they come.
#include "calibrate/live_pairs.hpp"
#include <catch2/catch.hpp>

using namespace tools;

namespace {

const LivePlace DIRECT = {0, false}, GLASS = {0, true}, DIRECT2 = {1, false}, GLASS2 = {1, true};

bool has(const std::string& text, const std::string& part)
{
    CAPTURE(text, part);
    const bool found = text.find(part) != std::string::npos;
    CHECK(found);
    return found;
}

} // namespace

TEST_CASE("A pair of one camera is complete with both images", "[live pairs]")
{
    LivePairs pairs({DIRECT, GLASS}, false);
    CHECK(pairs.areAny());
    has(pairs.add("air01", 0, true), "for the lens");
    has(pairs.add("07", 0, true), "waits for its glass image");
    CHECK(pairs.complete() == 0);
    has(pairs.add("07", 1, true), "pair 1 complete: '07', direct and glass");
    CHECK(pairs.add("08", 1, true) == "'08' waits for its direct image");
    has(pairs.add("08", 0, false), "the board was not found in it");
    CHECK(pairs.complete() == 1);
    CHECK(pairs.incomplete().size() == 1);
    has(pairs.incomplete()[0], "'08' lacks its direct image");
    has(pairs.add("08", 0, true), "pair 2 complete");           // taken again
    has(pairs.add("08", 0, true), "pair 2 complete");           // and again: it counts once
    CHECK(pairs.complete() == 2);
    CHECK(pairs.incomplete().empty());
}

TEST_CASE("A pair of two cameras is complete with four images", "[live pairs]")
{
    LivePairs pairs({DIRECT, GLASS, DIRECT2, GLASS2}, false);
    has(pairs.add("a", 0, true), "'a' waits for camera 2's direct image");
    has(pairs.add("a", 2, true), "for the lens, or waits");
    CHECK(pairs.add("a", 1, true) == "'a' waits for camera 2's glass image");
    has(pairs.add("a", 3, true), "pair 1 complete: 'a', direct and glass of all cameras");
    has(pairs.add("b", 1, true), "'b' waits for camera 1's direct image and camera 2's direct image and camera 2's glass image");
    CHECK(pairs.incomplete().size() == 1);
}

TEST_CASE("Unpaired images of two cameras are views, and those of one wait for nothing", "[live pairs]")
{
    LivePairs views({DIRECT, GLASS, DIRECT2, GLASS2}, true);
    has(views.add("a", 0, true), "camera 2's direct image");
    has(views.add("a", 2, true), "view 1 complete: 'a' of all cameras");
    CHECK(!views.arePairs());
    LivePairs one({DIRECT}, false), unpaired({DIRECT, GLASS}, true);
    CHECK(one.add("a", 0, true).empty());
    CHECK(!one.areAny());
    CHECK(unpaired.add("a", 0, true).empty());
    CHECK(unpaired.add("b", 1, true).empty());
}
