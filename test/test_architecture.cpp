// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The components of the module and of the tools are those of doc/architecture.md, and none includes one of a later layer.
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

namespace fs = std::filesystem;

namespace {

const std::string ROOT = paths::tests() + "/..";
const std::string TREES[] = {"modules/refract/src", "tools/common"};

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
    for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; it++)
        found.push_back((*it)[1]);
    return found;
}

std::string page()
{
    return contentsOf(ROOT + "/doc/architecture.md");
}

//! The lines of its tables.
std::vector<std::string> rowsOf(const std::string& text)
{
    return matches(text, "\n(\\|[^\n]*)");
}

//! What the page says of a tree, under the heading that names it.
std::string sectionOf(const std::string& tree)
{
    const std::string text = page();
    const size_t begin = text.find(": `" + tree + "`\n");
    REQUIRE(begin != std::string::npos);
    return text.substr(begin, text.find("\n## ", begin) - begin);
}

//! Components of a tree, the lowest layer first.
std::vector<std::string> componentsOnThePage(const std::string& tree)
{
    return matches(sectionOf(tree), R"(\n\| `(\w+)/`)");
}

//! Paths below a folder, relative to it.
std::vector<std::string> below(const std::string& folder, bool folders)
{
    std::vector<std::string> paths;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_directory() == folders)
            paths.push_back(entry.path().lexically_relative(folder).generic_string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

//! As a shell would match it: * is any part of a name.
std::regex expressionOf(const std::string& wildcard)
{
    std::string expression;
    for (char c : wildcard)
        expression += c == '*' ? "[^/]*" : c == '.' ? "\\." : std::string(1, c);
    return std::regex(expression);
}

bool isAnyOf(const std::vector<std::string>& paths, const std::string& wildcard)
{
    const std::regex expression = expressionOf(wildcard);
    return std::any_of(paths.begin(), paths.end(), [&](const std::string& p) { return std::regex_match(p, expression); });
}

//! Every path that a table may name: from the root, from either tree; and the names of all files alone.
std::vector<std::string> knownPaths()
{
    std::vector<std::string> paths;
    for (const char* folder : {"modules", "tools", "test", "doc"})
        for (const std::string& path : below(ROOT + "/" + folder, false))
        {
            const std::string whole = std::string(folder) + "/" + path;
            paths.push_back(whole);
            paths.push_back(fs::path(path).filename().string());
            for (const std::string& tree : TREES)
                if (whole.compare(0, tree.size() + 1, tree + "/") == 0)
                    paths.push_back(whole.substr(tree.size() + 1));
        }
    return paths;
}

//! Where Ceres and Eigen may be.
bool isCalibrator(const std::string& file)
{
    const std::string component = file.substr(0, file.find('/'));
    return component == "adjust" || component == "start" || component == "calibrate";
}

} // namespace

TEST_CASE("The page of the architecture names every folder, and no other", "[architecture]")
{
    for (const std::string& tree : TREES)
    {
        std::vector<std::string> named = componentsOnThePage(tree);
        std::sort(named.begin(), named.end());
        CAPTURE(tree);
        CHECK(below(ROOT + "/" + tree, true) == named);
        CHECK(named.size() >= 6);
    }
}

TEST_CASE("No component includes one of a later layer", "[architecture]")
{
    for (const std::string& tree : TREES)
    {
        const std::vector<std::string> components = componentsOnThePage(tree);
        std::map<std::string, size_t> layer;
        for (size_t i = 0; i < components.size(); i++)
            layer[components[i]] = i;
        int arrows = 0;
        for (const std::string& file : below(ROOT + "/" + tree, false))
        {
            const std::string component = file.substr(0, file.find('/'));
            for (const std::string& other : matches(contentsOf(ROOT + "/" + tree + "/" + file), R"(#include "(\w+)/)"))
            {
                if (!layer.count(other) || !layer.count(component))      // opencv2/; a file in no component, as precomp.hpp
                    continue;
                CAPTURE(tree, file, other);
                CHECK(layer[other] <= layer[component]);
                arrows += other != component;
            }
        }
        CHECK(arrows > 30);
    }
}

TEST_CASE("Inside the tools an include names the component", "[architecture]")
{
    for (const std::string& file : below(ROOT + "/tools/common", false))
    {
        CAPTURE(file);
        CHECK(file.find('/') != std::string::npos);
        CHECK(matches(contentsOf(ROOT + "/tools/common/" + file), "#include \"([^/\"]+)\"").empty());
    }
}

TEST_CASE("No header of the tools has the include path of one of the module", "[architecture]")
{
    // Sources of the tools see both trees, and would take the one that they are told of first.
    for (const std::string& file : below(ROOT + "/" + TREES[1], false))
        if (fs::path(file).extension() == ".hpp")
        {
            CAPTURE(file);
            CHECK_FALSE(fs::exists(ROOT + "/" + TREES[0] + "/" + file));
        }
}

TEST_CASE("Files that the tables of the architecture name exist", "[architecture]")
{
    const std::vector<std::string> paths = knownPaths();
    int count = 0;
    for (const std::string& row : rowsOf(page()))
        for (const std::string& name : matches(row, R"(`([\w*]+(?:/[\w*]+)*(?:\.[\w*]+)+)`)"))
        {
            if (name.find("NAME") != std::string::npos)
                continue;
            CAPTURE(row, name);
            CHECK(isAnyOf(paths, name));
            count++;
        }
    CHECK(count > 40);
}

TEST_CASE("Folders that the tables of the architecture name exist", "[architecture]")
{
    int count = 0;
    for (const std::string& row : rowsOf(page()))
        for (const std::string& folder : matches(row, R"(`([\w/]+)/`)"))
        {
            CAPTURE(row, folder);
            CHECK((fs::is_directory(ROOT + "/" + folder) || fs::is_directory(ROOT + "/" + TREES[0] + "/" + folder) ||
                   fs::is_directory(ROOT + "/" + TREES[1] + "/" + folder)));
            count++;
        }
    CHECK(count > 16);
}

TEST_CASE("What a component is said to hold is in it, its extension left out", "[architecture]")
{
    std::vector<std::string> programs;
    for (const std::string& file : below(ROOT + "/tools", false))
        programs.push_back(file.substr(0, file.find('.')));
    int count = 0;
    for (const std::string& tree : TREES)
        for (const std::string& row : rowsOf(sectionOf(tree)))
            for (const std::string& component : matches(row, R"(^\| `(\w+)/`)"))
            {
                std::vector<std::string> stems = programs;      // who asks may be one
                for (const std::string& file : below(ROOT + "/" + tree + "/" + component, false))
                    stems.push_back(file.substr(0, file.find('.')));
                for (const std::string& stem : matches(row, R"(`([\w*]+)`)"))
                {
                    CAPTURE(tree, row, stem);
                    CHECK(isAnyOf(stems, stem));
                    count++;
                }
            }
    CHECK(count > 20);
}

TEST_CASE("Ceres and Eigen stay where calibrations are", "[architecture]")
{
    for (const std::string& file : below(ROOT + "/" + TREES[0], false))
    {
        const std::string text = contentsOf(ROOT + "/" + TREES[0] + "/" + file);
        CAPTURE(file);
        CHECK((isCalibrator(file) || text.find("#include <ceres") == std::string::npos));
        CHECK((isCalibrator(file) || file.find("math/dense") == 0 || text.find("#include <Eigen") == std::string::npos));
    }
}

TEST_CASE("Of the module's inner headers the tools include those that this test lists alone", "[architecture]")
{
    const std::vector<std::string> taken = { "math/dense.hpp", "camera/storage.hpp", "pose/near_origin.hpp", "pose/poses.hpp",
                                             "calibrate/refit.hpp", "window/wedge.hpp", "window/parameters.hpp",
                                             "math/quantile.hpp", "math/rigid_transform.hpp", "math/rotation.hpp" };
    int count = 0;
    const std::string page = contentsOf(ROOT + "/doc/architecture.md");
    for (const std::string& header : taken)
    {
        CAPTURE(header);
        CHECK(page.find("`" + header + "`") != std::string::npos);
    }
    for (const std::string& file : below(ROOT + "/tools", false))
        for (const std::string& header : matches(contentsOf(ROOT + "/tools/" + file), R"re(#include "(\w+/[\w.]+)")re"))
        {
            CAPTURE(file, header);
            CHECK((isAnyOf(taken, header) || !fs::exists(ROOT + "/" + TREES[0] + "/" + header)));
            count += isAnyOf(taken, header);
        }
    CHECK(count > 10);
}

TEST_CASE("Files of FileStorage are opened for reading in one place", "[architecture]")
{
    // FileStorage's own errors are of several kinds, and one of its parsers ends the process on a deep file.
    for (const std::string& tree : { std::string("tools"), TREES[0] })
        for (const std::string& file : below(ROOT + "/" + tree, false))
        {
            CAPTURE(tree, file);
            const bool opens = contentsOf(ROOT + "/" + tree + "/" + file).find("FileStorage::READ") != std::string::npos;
            CHECK(opens == (file == "camera/storage.cpp"));
        }
}

TEST_CASE("Of Eigen all sources but those that the page lists include no more than its core", "[architecture]")
{
    const std::string text = page();
    const size_t begin = text.find("## Eigen\n");
    REQUIRE(begin != std::string::npos);
    const std::vector<std::string> listed = matches(text.substr(begin, text.find("\n## ", begin) - begin), R"(\n\| `([\w/.*]+)`)");
    std::vector<std::string> found;
    for (const std::string& tree : TREES)
        for (const std::string& file : below(ROOT + "/" + tree, false))
        {
            std::vector<std::string> headers = matches(contentsOf(ROOT + "/" + tree + "/" + file),
                                                       R"(#include <((?:unsupported/)?Eigen/\w+)>)");
            headers.erase(std::remove(headers.begin(), headers.end(), "Eigen/Core"), headers.end());
            if (headers.empty())
                continue;
            CAPTURE(file);
            CHECK(std::any_of(listed.begin(), listed.end(), [&](const std::string& l) { return isAnyOf({ file }, l); }));
            found.push_back(file);
        }
    for (const std::string& wildcard : listed)
    {
        CAPTURE(wildcard);
        CHECK(isAnyOf(found, wildcard));
    }
}

TEST_CASE("Other libraries of the tools are included where the page says, and nowhere else", "[architecture]")
{
    const std::string text = page();
    const size_t begin = text.find("## Other libraries in the tools\n");
    REQUIRE(begin != std::string::npos);
    int count = 0;
    for (const std::string& row : rowsOf(text.substr(begin, text.find("\n## ", begin) - begin)))
        for (const std::string& header : matches(row, R"(^\| `(<[\w/]+>?)` \|)"))
        {
            std::vector<std::string> included;
            for (const std::string& file : below(ROOT + "/tools", false))
                if (contentsOf(ROOT + "/tools/" + file).find("#include " + header) != std::string::npos)
                    included.push_back(file);
            std::vector<std::string> named;
            for (const std::string& file : matches(row, R"(`([\w/]+\.cpp)`)"))
                named.push_back("common/" + file);
            CAPTURE(header);
            CHECK(included == named);
            count++;
        }
    CHECK(count == 7);
}
