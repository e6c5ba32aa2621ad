// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Text broken into lines: none is wider than a terminal, and no word is lost.
#include "console/table.hpp"
#include <catch2/catch.hpp>
#include <random>

using namespace tools;

namespace {

//! All letters but blanks, in their order.
std::string lettersOf(const std::vector<std::string>& lines)
{
    std::string letters;
    for (const std::string& line : lines)
        for (char c : line)
            if (c != ' ')
                letters += c;
    return letters;
}

} // namespace

TEST_CASE("A short line stays as it is", "[lines]")
{
    CHECK(brokenInto("  as it is", 80, "  ", LongWords::BROKEN) == std::vector<std::string>{"  as it is"});
    CHECK(brokenInto("", 80, "  ", LongWords::BROKEN) == std::vector<std::string>{""});
    CHECK(columnsOf("±5°") == 3);
}

TEST_CASE("A long text is broken between words, a long word within it or not", "[lines]")
{
    CHECK(brokenInto("one two three", 8, "  ", LongWords::BROKEN) == std::vector<std::string>{"one two", "  three"});
    CHECK(brokenInto("see /a/very/long/path now", 10, "  ", LongWords::BROKEN)
          == std::vector<std::string>{"see", "  /a/very/", "  long/pat", "  h now"});
    CHECK(brokenInto("see /a/very/long/path now", 10, "  ", LongWords::WHOLE)
          == std::vector<std::string>{"see", "  /a/very/long/path", "  now"});
}

TEST_CASE("Random text: no line is too wide, no letter is lost", "[lines]")
{
    const unsigned seed = 5;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    for (int trial = 0; trial < 2000; trial++)
    {
        std::string text;
        for (int words = random() % 12; words >= 0; words--)
        {
            for (int letters = 1 + random() % (random() % 8 ? 9 : 60); letters > 0; letters--)
                text += random() % 5 ? std::string(1, char('a' + random() % 26)) : std::string("±");
            text += words ? " " : "";
        }
        const size_t columns = 10 + random() % 40;
        const std::vector<std::string> lines = brokenInto(text, columns, "  ", LongWords::BROKEN);
        CAPTURE(text, columns);
        CHECK(lettersOf(lines) == lettersOf({text}));
        for (const std::string& line : lines)
            CHECK(columnsOf(line) <= columns);
        for (const std::string& line : firstOf(lines, 2, columns))
            CHECK(columnsOf(line) <= columns);
    }
}

TEST_CASE("What is left out is marked", "[lines]")
{
    const std::vector<std::string> lines = {"one two", "three four", "five"};
    CHECK(firstOf(lines, 3, 12) == lines);
    CHECK(firstOf(lines, 2, 14) == std::vector<std::string>{"one two", "three four ..."});
    CHECK(firstOf(lines, 2, 12) == std::vector<std::string>{"one two", "three ..."});
    CHECK(firstOf(lines, 0, 12).empty());
}
