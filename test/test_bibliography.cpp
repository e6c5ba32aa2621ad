// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the module and the pages cite is in refract.bib, and nothing else is.
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

namespace fs = std::filesystem;

namespace {

const fs::path ROOT = fs::path(paths::tests()) / "..";

std::string contentsOf(const fs::path& path)
{
    std::ifstream file(path);
    REQUIRE(file.is_open());
    return std::string(std::istreambuf_iterator<char>(file), {});
}

std::vector<std::smatch> matches(const std::string& text, const std::string& pattern)
{
    const std::regex expression(pattern);
    return { std::sregex_iterator(text.begin(), text.end(), expression), {} };
}

//! Each entry's text, by its key; keys in the order of the file.
std::map<std::string, std::string> bibliography(std::vector<std::string>& keys)
{
    const std::string text = contentsOf(ROOT / "modules/refract/doc/refract.bib");
    std::map<std::string, std::string> entries;
    for (const std::smatch& entry : matches(text, R"(@\w+\{(\w+),\n([^@]*)\n\}\n)"))
    {
        keys.push_back(entry[1]);
        entries[entry[1]] = entry[2];
    }
    return entries;
}

//! Keys that the module's sources, header and tutorial cite, with a file that does.
std::map<std::string, std::string> citations()
{
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(ROOT / "modules/refract"))
    {
        if (!entry.is_regular_file() || entry.path().extension() == ".bib")
            continue;
        const std::string text = contentsOf(entry.path());
        for (const std::smatch& citation : matches(text, R"([@\\]cite (\w+))"))
            found[citation[1]] = entry.path().lexically_relative(ROOT).generic_string();
    }
    return found;
}

} // namespace

TEST_CASE("Every citation is in the bibliography, and the other way round", "[bibliography]")
{
    std::vector<std::string> keys;
    const std::map<std::string, std::string> entries = bibliography(keys), cited = citations();
    CHECK(entries.size() == keys.size());
    CHECK(std::is_sorted(keys.begin(), keys.end()));
    for (const auto& [key, file] : cited)
    {
        CAPTURE(file);
        INFO("cited, but not in modules/refract/doc/refract.bib: " << key);
        CHECK(entries.count(key));
    }
    for (const auto& [key, fields] : entries)
    {
        INFO("in modules/refract/doc/refract.bib, but cited nowhere in the module: " << key);
        CHECK(cited.count(key));
        CHECK(fields.find("title = {") != std::string::npos);
        CHECK((fields.find("author = {") != std::string::npos || fields.find("key = {") != std::string::npos));
    }
    CHECK(cited.size() > 15);
}

TEST_CASE("What tables of the pages cite by name and year is in the bibliography", "[bibliography]")
{
    std::vector<std::string> keys;
    const std::map<std::string, std::string> entries = bibliography(keys);
    int count = 0;
    for (const auto& page : fs::directory_iterator(ROOT / "doc"))
    {
        if (page.path().extension() != ".md")
            continue;
        const std::string text = contentsOf(page.path());
        // | Malitson 1965 |, | Quan and Fry 1995 |, | Beadie et al. 2015 |
        for (const std::smatch& name : matches(text, R"(\| ([A-Z][a-z]+)(?: and ([A-Z][a-z]+)| et al\.)? ((?:19|20)\d\d) \|)"))
        {
            CAPTURE(page.path().filename().string(), name.str());
            CHECK(entries.count(name[1].str() + name[2].str() + name[3].str()));
            count++;
        }
    }
    CHECK(count > 5);
}
