// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_tools, of which every tool is a link.
#include "run_tool.hpp"
#include <catch2/catch.hpp>

TEST_CASE("The one program is the tool that its first argument names", "[tools]")
{
    const std::string version = runTool("refract_calib --version").out;
    CHECK(mentions(version, "refract_calib"));
    CHECK(runTool("refract_tools refract_calib --version").out == version);
    CHECK(runTool("refract_tools calib --version").out == version);
    const ToolResult mistake = runTool("refract_tools calib --size=6x5");
    CHECK(mistake.code == 1);
    CHECK(mistake.err == runTool("refract_calib --size=6x5").err);
}

TEST_CASE("The one program names the tools that it has", "[tools]")
{
    for (const std::string arguments : {"", " calibrate", " --size=6x5"})
    {
        CAPTURE(arguments);
        const ToolResult result = runTool("refract_tools" + arguments);
        CHECK(result.code == 1);
        CHECK(result.out.empty());
        CHECK(mentions(result.err, "refract_tools TOOL OPTIONS"));
        CHECK(mentions(result.err, "refract_calib"));
    }
    const ToolResult help = runTool("refract_tools --help");
    CHECK(help.code == 0);
    CHECK(mentions(help.out, "refract_undistort"));
}
