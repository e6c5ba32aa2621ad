// The rooms of the module are those of doc/architecture.md, and no include climbs.
#include <catch2/catch.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

namespace {

const std::string ROOT = std::string(REFRACT_TEST_DIR) + "/..", SOURCES = ROOT + "/modules/refract/src";

std::string contentsOf(const std::string& path)
{
    std::ifstream file(path);
    REQUIRE(file.is_open());
    return std::string(std::istreambuf_iterator<char>(file), {});
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern)
{
    const std::regex expression(pattern);
    std::vector<std::string> found;
    for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it)
        found.push_back((*it)[1]);
    return found;
}

//! Rooms from the ground up.
std::vector<std::string> roomsOnThePage()
{
    const std::string page = contentsOf(ROOT + "/doc/architecture.md");
    return matches(page.substr(0, page.find("## ")), R"(\n\| `(\w+)/`)");
}

std::vector<std::string> sourcesOf(const std::string& room)
{
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(SOURCES + "/" + room))
        files.push_back(entry.path().string());
    return files;
}

} // namespace

TEST_CASE("The page of the house names every room, and no other", "[architecture]")
{
    std::vector<std::string> folders;
    for (const auto& entry : std::filesystem::directory_iterator(SOURCES))
        if (entry.is_directory())
            folders.push_back(entry.path().filename().string());
    std::vector<std::string> named = roomsOnThePage();
    std::sort(folders.begin(), folders.end());
    std::sort(named.begin(), named.end());
    CHECK(folders == named);
    CHECK(folders.size() >= 10);
}

TEST_CASE("No include climbs from one room to a later one", "[architecture]")
{
    const std::vector<std::string> rooms = roomsOnThePage();
    std::map<std::string, size_t> floor;
    for (size_t i = 0; i < rooms.size(); i++)
        floor[rooms[i]] = i;
    int arrows = 0;
    for (const std::string& room : rooms)
        for (const std::string& file : sourcesOf(room))
            for (const std::string& other : matches(contentsOf(file), R"(#include "(\w+)/)"))
            {
                if (!floor.count(other))        // opencv2/
                    continue;
                CAPTURE(file, other);
                CHECK(floor[other] <= floor[room]);
                arrows += other != room;
            }
    CHECK(arrows > 30);
}

TEST_CASE("Files that the page of the house names exist", "[architecture]")
{
    for (const std::string& name : matches(contentsOf(ROOT + "/doc/architecture.md"), "`((?:\\w+/)+\\w[\\w.]*\\.\\w+)`"))
    {
        CAPTURE(name);
        if (name.find("NAME") == std::string::npos)
            CHECK((std::filesystem::exists(SOURCES + "/" + name) || std::filesystem::exists(ROOT + "/" + name)));
    }
}

TEST_CASE("Ceres stays where poses and calibrations are", "[architecture]")
{
    for (const std::string& room : roomsOnThePage())
        for (const std::string& file : sourcesOf(room))
        {
            CAPTURE(file);
            if (room != "pose" && room != "calibrate")
                CHECK(contentsOf(file).find("#include <ceres") == std::string::npos);
        }
}
