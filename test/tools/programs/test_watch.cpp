// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib --watch: images come while it runs.
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <chrono>
#include <thread>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";

std::string call(const TemporaryFolder& folder)
{
    return "refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --no-cross-validation --glass='" + STEREO
           + "/glass1/*' --out=" + (folder / "calib.yml") + " --direct='" + (folder / "direct/*.jpg") + "' --watch=" + (folder / "direct");
}

} // namespace

TEST_CASE("refract_calib says of each image that comes what the next should show, then calibrates", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "direct");
    std::vector<std::string> images;
    for (const auto& entry : std::filesystem::directory_iterator(STEREO + "/direct1"))
        images.push_back(entry.path().string());
    std::sort(images.begin(), images.end());
    REQUIRE(images.size() >= 12);
    const std::string whole = readFile(images[0]);
    std::thread camera([&] {
        const auto pause = std::chrono::milliseconds(150);
        writeFile(folder / "direct/00_later.jpg", whole.substr(0, whole.size()/2));       // is complete only later
        writeFile(folder / "direct/none.txt", "not asked for");
        for (const std::string& image : images)
        {
            std::this_thread::sleep_for(pause);
            std::filesystem::copy_file(image, folder/("direct/" + std::filesystem::path(image).filename().string()));
            if (image == images[1])
                writeFile(folder / "direct/00_later.jpg", whole);
        }
    });
    const ToolResult result = runTool(call(folder) + " --watch-count=" + std::to_string(images.size() + 1) + " --watch-quiet=20");
    camera.join();
    CAPTURE(result.out, result.err);
    REQUIRE(result.code != 1);
    CHECK(std::filesystem::exists(folder / "calib.yml"));
    for (const std::string& image : images)
        CHECK(mentions(result.out, std::filesystem::path(image).filename().string() + ": board found, 30 of 30 points"));
    CHECK(mentions(result.out, "00_later.jpg: board found"));
    CHECK(!mentions(result.out, "none.txt"));
    CHECK(mentions(result.out, "Next: hold the board into the"));
    CHECK(mentions(result.out, std::to_string(images.size() + 1) + " images show the board"));
}

TEST_CASE("Watching ends when it is quiet, and says what is wrong with a file", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "direct");
    writeFile(folder / "direct/bad.jpg", "no image");
    std::filesystem::copy_file(STEREO + "/direct1/" + "pair1.jpg", folder / "direct/pair1.jpg");
    const ToolResult result = runTool(call(folder) + " --watch-quiet=1.5");
    CAPTURE(result.out, result.err);
    CHECK(result.code == 1);            // as one image is not enough, and the other is none
    CHECK(mentions(result.out, "bad.jpg: '"));
    CHECK(mentions(result.out, "take it out of the folder"));
    CHECK(mentions(result.out, "pair1.jpg: board found, 30 of 30 points (1 so far)"));
    const ToolResult quiet = runTool(call(folder) + " --watch-quiet=0.3 --quiet");
    CHECK(quiet.out.empty());

    const struct { std::string arguments, expected; } cases[] = {
        {" --watch=" + (folder / "none"), "no such folder"}, {" --watch=" + (folder / ""), "not the folder of"}};
    const std::string start = call(folder), without = start.substr(0, start.rfind(" --watch="));
    for (const auto& c : cases)
    {
        const ToolResult refused = runTool(without + c.arguments);
        CAPTURE(c.arguments, refused.err);
        CHECK(refused.code == 1);
        CHECK(mentions(refused.err, c.expected));
    }
}
