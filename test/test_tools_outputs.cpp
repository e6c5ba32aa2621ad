// What the tools write never takes the place of what they read.
#include "run_tool.hpp"
#include <catch2/catch.hpp>
#include <map>

namespace {

const std::string STEREO = REFRACT_BUNDLED_DIR "/stereo";
const std::string TARGET = " --size=6x5 --square=39";

//! A folder with a calibration and images that may be spoiled.
struct Inputs
{
    TemporaryFolder folder;
    std::string calib = folder / "calib.yml", left = folder / "left.jpg", right = folder / "right.jpg";

    Inputs()
    {
        std::filesystem::copy_file(STEREO + "/truth.yml", calib);
        std::filesystem::copy_file(STEREO + "/measure1/z600_1.jpg", left);
        std::filesystem::copy_file(STEREO + "/measure2/z600_1.jpg", right);
        std::filesystem::create_symlink(left, folder / "link.jpg");
        std::filesystem::create_hard_link(calib, folder / "hard.yml");
        std::filesystem::create_directory(folder / "sub");
    }

    //! Contents of all files, by name.
    std::map<std::string, std::string> contents() const
    {
        std::map<std::string, std::string> all;
        for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
            if (entry.is_regular_file())
                all[entry.path().string()] = readFile(entry.path().string());
        return all;
    }
};

} // namespace

TEST_CASE("no tool overwrites what it reads, or writes one file twice", "[tools][outputs]")
{
    const Inputs in;
    const TemporaryFolder& f = in.folder;
    const std::string images = " " + in.left + " " + in.right + TARGET;
    const std::string measure = "refract_measure " + in.calib + images + " --pixel-sigma=0.014 --out=";
    const std::string epilines = "refract_epilines " + in.calib + images + " --out=";
    const std::string calib = "refract_calib" + TARGET + " --thickness=20 --index=1.5 --camera=" + in.calib + " --glass='"
                              + (f / "*.jpg") + "' --out=";
    const std::string check = "refract_check " + in.calib + TARGET + " --pixel-sigma=0.014 --glass=" + in.left + " --summary=";
    std::ofstream(f / "truth.yml") << readFile(STEREO + "/rig.yml");
    std::ofstream(f / "points.txt") << "640 500\n";

    const struct { std::string command, expected; } cases[] = {
        {measure + in.calib, "overwritten"},
        {measure + in.left, "overwritten"},
        {measure + (f / "sub/../right.jpg"), "overwritten"},
        {measure + (f / "link.jpg"), "overwritten"},
        {measure + (f / "hard.yml"), "overwritten"},
        {measure + (f / "p.csv") + " --compare-with=" + (f / "p.csv"), "p.csv"},
        {measure + (f / "no/p.csv"), "does not exist"},
        {measure + (f / "sub"), "folder"},
        {epilines + in.left, "overwritten"},
        {epilines + (f / "picture"), "extension"},
        {epilines + (f / "picture.txt"), "extension"},
        {"refract_epilines " + in.calib + " " + in.left + " " + in.right + " --points=" + (f / "points.txt") + " --out="
            + (f / "points.txt"), "extension"},
        {"refract_undistort " + in.calib + " " + in.left + " --depth=600 --out-dir=" + (f / "sub/.."), "overwritten"},
        {"refract_undistort " + in.calib + " '" + in.left + "' --depth=600 --out-dir=" + (f / ""), "overwritten"},
        {"refract_simulate " + (f / "truth.yml") + " --out-dir=" + (f / ""), "overwritten"},
        {check + in.calib, "overwritten"},
        {check + in.left, "overwritten"},
        {calib + in.calib, "overwritten"},
        {calib + in.left, "extension"},
        {calib + (f / "new.txt"), ".yml"},
        {calib + (f / "new"), ".yml"},
        {calib + (f / "new.yml") + " --report=" + in.left, "overwritten"},
        {calib + (f / "new.yml") + " --summary=" + in.right, "overwritten"},
        {calib + (f / "new.yml") + " --summary=" + (f / "./new.yml"), "--out and --summary"},
        {calib + (f / "new.yml") + " --summary=" + (f / "x") + " --report=" + (f / "sub/../x"), "--summary and --report"},
        {calib + (f / "new.yml") + " --pinhole-out=" + (f / "new.yml"), "--out and --pinhole-out"},
        {calib + (f / "new.yml") + " --pinhole-out=" + (f / "pinhole.csv"), "--pinhole-out"},
    };
    const auto before = in.contents();
    for (const auto& c : cases)
    {
        const ToolResult result = runTool(c.command);
        INFO(c.command << "\n" << result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(in.contents() == before);
    }
}
