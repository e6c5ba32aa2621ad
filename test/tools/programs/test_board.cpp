// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_board as a user runs it; what is on the paper: test/tools/target/test_board_page.cpp.
#include "run_tool.hpp"
#include <catch2/catch.hpp>
#include <algorithm>

TEST_CASE("refract_board writes boards to print", "[tools][board]")
{
    const TemporaryFolder folder;
    const std::string board = "refract_board --size=6x5 --square=25";
    for (const std::string name : {"board.pdf", "board.svg"})
        for (const std::string pattern : {"chessboard", "circles", "acircles", "charuco"})
        {
            const std::string call = board + " --pattern=" + pattern + " --out=";
            const ToolResult result = runTool(call + (folder/name)), again = runTool(call + (folder/("again" + name)) + " --quiet");
            CAPTURE(name, pattern, result.err);
            REQUIRE(result.code == 0);
            CHECK(result.err.empty());
            CHECK(again.out.empty());
            CHECK(mentions(result.out, "100 %"));
            CHECK(readFile(folder/name).size() > 1000);
            CHECK(readFile(folder/name) == readFile(folder/("again" + name)));
        }
    CHECK(readFile(folder / "board.pdf").compare(0, 5, "%PDF-") == 0);
    CHECK(mentions(readFile(folder / "board.svg"), "<svg"));
}

TEST_CASE("refract_board refuses with one sentence and writes nothing", "[tools][board]")
{
    const TemporaryFolder folder;
    const std::string out = " --out=" + (folder / "board.pdf"), size = " --size=6x5", square = " --square=25";
    const struct { std::string arguments, expected; } cases[] = {
        {size + square, "--out"},
        {square + out, "--size"},
        {size + out, "--square"},
        {size + square + " --out=" + (folder / "board.png"), ".pdf or .svg"},
        {size + square + " --out=" + (folder / "no/board.pdf"), "does not exist"},
        {size + square + " --paper=A5" + out, "larger paper"},
        {size + square + " --paper=b" + out, "--paper"},
        {size + " --square=0.1" + out, "0.5 mm"},
        {size + " --square=25 --unit=m" + out, "10 m"},
        {size + square + " --pattern=charuco --marker=25" + out, "--marker"},
        {size + square + " --pattern=charuco --dictionary=x" + out, "--dictionary"},
        {" --size=60x50 --square=2 --pattern=charuco --dictionary=DICT_4X4_50" + out, "markers"},
    };
    for (const auto& c : cases)
    {
        const ToolResult result = runTool("refract_board" + c.arguments);
        CAPTURE(c.arguments, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, c.expected));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(folder.count() == 0);
    }
}
