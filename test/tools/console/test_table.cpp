// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Table: what is too wide for a terminal is broken between words.
#include "console/table.hpp"
#include <catch2/catch.hpp>
#include <sstream>

using namespace tools;

namespace {

std::vector<std::string> linesOf(const Table& table)
{
    std::ostringstream out;
    table.print(out);
    std::vector<std::string> lines;
    std::istringstream in(out.str());
    for (std::string line; std::getline(in, line); )
        lines.push_back(line);
    return lines;
}

} // namespace

TEST_CASE("A narrow table is one line a row", "[table]")
{
    Table table({"", "value"});
    table.add({"  thickness", "20"});
    CHECK(linesOf(table) == std::vector<std::string>{"             value", "------------------", "  thickness     20"});
}

TEST_CASE("A wide table fits 100 columns and loses no word", "[table]")
{
    const std::string words = "pair 1: near (z = 490.7 mm), in the right half, right edge farther by 30 degrees, "
                              "and a few words more";
    Table table({"", "camera 1 with a long name", "camera 2 with a long name", "±"});
    table.add({words, "opencv, 5 coefficients, 18 views, 0.019 px, refined", "2", "3"});
    table.add({std::string(120, 'x'), "", "", ""});      // cannot be broken
    const std::vector<std::string> lines = linesOf(table);
    REQUIRE(lines.size() > 4);

    Table breakable({"", "camera 1 with a long name", "camera 2 with a long name"});
    breakable.add({words, "opencv, 5 coefficients, 18 views, 0.019 px, refined", "2"});
    std::string first;
    for (const std::string& line : linesOf(breakable))
    {
        CHECK(line.size() <= 100);
        first += line + '\n';
    }
    std::istringstream in(words);
    for (std::string word; in >> word; )
        CHECK_THAT(first, Catch::Contains(word));
}

TEST_CASE("Of alternatives the first are said, and how many others there are", "[table]")
{
    CHECK(alternatives({"a", "b", "c"}, 3) == "a; or b; or c");
    CHECK(alternatives({"a", "b", "c", "d"}, 3) == "a; or b; or c; or d");
    CHECK(alternatives({"a", "b", "c", "d", "e"}, 3) == "a; or b; or c; or one of 2 others");
    CHECK(alternatives({"a"}, 0) == "a");
}
