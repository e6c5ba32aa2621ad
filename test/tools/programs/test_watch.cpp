// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_calib --watch: images come while it runs.
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";

std::string call(const TemporaryFolder& folder)
{
    return "refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --no-cross-validation --glass='" + STEREO
           + "/glass1/*' --out=" + (folder / "calib.yml") + " --direct='" + (folder / "direct/*.jpg") + "' --watch=" + (folder / "direct");
}

int countOf(const std::string& text, const std::string& part)
{
    int count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        count++;
    return count;
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
    const std::string whole = readFile(STEREO + "/measure1/z1200_1.jpg");
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

TEST_CASE("Watching ends when it is quiet, and names a file that is of no use once and leaves it out", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "direct");
    writeFile(folder / "direct/bad.jpg", "no image");
    const std::string whole = readFile(STEREO + "/direct1/air01.jpg");
    writeFile(folder / "direct/half.jpg", whole.substr(0, whole.size()/2));
    for (const auto& entry : std::filesystem::directory_iterator(STEREO + "/direct1"))
        std::filesystem::copy_file(entry.path(), folder/("direct/" + entry.path().filename().string()));
    std::filesystem::copy_file(STEREO + "/direct1/pair1.jpg", folder / "direct/pair1_again.jpg");
    cv::imwrite(folder / "direct/small.jpg", cv::Mat(480, 640, CV_8U, cv::Scalar(90)));
    const ToolResult result = runTool(call(folder) + " --watch-quiet=1.5");
    CAPTURE(result.out, result.err);
    CHECK(result.code != 1);
    CHECK(countOf(result.out, "bad.jpg: '") == 1);
    CHECK(countOf(result.out, "half.jpg: '" + (folder / "direct/half.jpg") + "' is cut short") == 1);
    CHECK(countOf(result.out, "pair1_again.jpg: a copy of '" + (folder / "direct/pair1.jpg") + "': left out") == 1);
    CHECK(countOf(result.out, "small.jpg: 640x480 pixels, the first image has 1280x1024") == 1);
    CHECK(mentions(result.out, "18 images show the board"));
    CHECK(!mentions(result.out + result.err, "more than once"));         // the copy is not in the calibration
}

TEST_CASE("What --watch cannot watch is refused", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "direct");
    std::filesystem::copy_file(STEREO + "/direct1/pair1.jpg", folder / "direct/pair1.jpg");
    const ToolResult quiet = runTool(call(folder) + " --watch-quiet=0.3 --quiet");
    CHECK(quiet.code == 1);             // one image is not enough
    CHECK(quiet.out.empty());
    const struct { std::string arguments, expected; } cases[] = {
        {" --watch=" + (folder / "none"), "no such folder"}, {" --watch=" + (folder / ""), "not the folder of"},
        {" --watch --glass2='" + (folder / "absent/*.png") + "'", "there is no folder '" + (folder / "absent")}};
    const std::string start = call(folder), without = start.substr(0, start.rfind(" --watch="));
    for (const auto& c : cases)
    {
        const ToolResult refused = runTool(without + c.arguments);
        CAPTURE(c.arguments, refused.err);
        CHECK(refused.code == 1);
        CHECK(mentions(refused.err, c.expected));
    }
    std::filesystem::create_directory(folder / "empty");
    const ToolResult empty = runTool(without + " --watch --watch-quiet=0.3 --direct2='" + (folder / "empty/*") + "' --glass2='"
                                     + (folder / "empty/*") + "'");
    CAPTURE(empty.err);
    CHECK(empty.code == 1);
    CHECK(mentions(empty.err, "no image has come for '" + (folder / "empty/*")));
    cv::imwrite(folder / "empty/grey.jpg", cv::Mat(480, 640, CV_8U, cv::Scalar(90)));
    const ToolResult grey = runTool("refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --out=" + (folder / "calib.yml")
                                    + " --watch --watch-quiet=0.3 --glass='" + (folder / "empty/*") + "'");
    CAPTURE(grey.out, grey.err);
    CHECK(mentions(grey.out, "grey.jpg: board not found"));
    CHECK(mentions(grey.err, "shows the target"));
}

TEST_CASE("Both cameras and their pairs are watched at once, straight on to the calibration", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    const std::string sets[] = {"direct1", "glass1", "direct2", "glass2"};
    for (const std::string& set : sets)
        std::filesystem::create_directory(folder/set);
    const auto bring = [&](const std::string& set, const std::string& name) {
        std::filesystem::copy_file(STEREO + "/" + set + "/" + name, folder/(set + "/" + name));
    };
    for (int i = 1; i <= 12; i++)               // the lens first
        for (const std::string set : {"direct1", "direct2"})
            bring(set, cv::format("air%02d.jpg", i));
    std::atomic<bool> ended(false);
    std::thread camera([&] {
        for (int pair = 1; pair <= 6; pair++)
            for (const std::string& set : sets)
            {
                if (!ended)
                    std::this_thread::sleep_for(std::chrono::milliseconds(300));
                bring(set, cv::format("pair%d.jpg", pair));
            }
    });
    const auto glob = [&](const std::string& set) { return "='" + (folder/set) + "/*.jpg'"; };
    const ToolResult result = runTool("refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --no-cross-validation --direct"
        + glob("direct1") + " --glass" + glob("glass1") + " --direct2" + glob("direct2") + " --glass2" + glob("glass2") + " --out="
        + (folder / "calib.yml") + " --max-normal-std=1 --watch --watch-quiet=60");
    ended = true;
    camera.join();
    CAPTURE(result.out, result.err);
    CHECK(result.code != 1);
    CHECK(mentions(result.out, "camera 2, direct, air05.jpg: board found, 30 of 30 points, edges "));
    CHECK(mentions(result.out, "pair 3 complete: '"));
    CHECK(mentions(result.out, "direct and glass of all cameras"));
    CHECK(mentions(result.out, "'pair1' waits for camera "));
    // Three pairs are the least that is judged, and one degree is met by them: nobody waits for 60 s of quiet.
    CHECK(mentions(result.out, "camera 2: normal +- "));
    CHECK(mentions(result.out, ": enough"));
    CHECK(countOf(result.out, ": enough") == 1);
}

TEST_CASE("Watching ends when the best next pair would gain less than --watch-gain asks for, and not before", "[tools][calib][watch]")
{
    const TemporaryFolder folder;
    for (const std::string set : {"direct1", "glass1"})
    {
        std::filesystem::create_directory(folder/set);
        for (const auto& entry : std::filesystem::directory_iterator(STEREO + "/" + set))
            std::filesystem::copy_file(entry.path(), folder/(set + "/" + entry.path().filename().string()));
    }
    const std::string watch = "refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --no-cross-validation --direct='"
        + (folder / "direct1/*.jpg") + "' --glass='" + (folder / "glass1/*.jpg") + "' --out=" + (folder / "calib.yml") + " --watch";
    const std::string begin = "so far: the best next pair would take ", end = " % off the calibration's part of a point's error";
    const ToolResult goesOn = runTool(watch + " --watch-quiet=1 --watch-gain=0.01");
    CAPTURE(goesOn.out, goesOn.err);
    CHECK(goesOn.code != 1);
    CHECK(mentions(goesOn.out, begin));
    CHECK(!mentions(goesOn.out, ": enough"));
    const size_t at = goesOn.out.find(begin);
    REQUIRE(at != std::string::npos);
    const double gain = std::stod(goesOn.out.substr(at + begin.size()));
    CHECK(gain > 0.01);
    // The same images; nothing else would end this before two minutes of quiet.
    const auto start = std::chrono::steady_clock::now();
    const ToolResult ended = runTool(watch + cv::format(" --watch-quiet=120 --watch-gain=%.1f", gain + 1.));
    CAPTURE(ended.out, ended.err);
    CHECK(ended.code != 1);
    CHECK(countOf(ended.out, end + ": enough") == 1);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(120));
    CHECK(std::filesystem::exists(folder / "calib.yml"));
}
