// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/view_names.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/options.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

namespace tools {

namespace {

bool isDigit(char c) { return std::isdigit((unsigned char)c); }

//! How many letters all of them begin with, in order (from the end: reversed).
size_t commonStart(const std::vector<std::string>& names)
{
    size_t length = names.empty() ? 0 : names[0].size();
    for (const std::string& name : names)
        length = std::min<size_t>(length, std::mismatch(name.begin(), name.end(), names[0].begin(), names[0].end()).first - name.begin());
    return length;
}

std::vector<std::string> reversed(std::vector<std::string> names)
{
    for (std::string& name : names)
        std::reverse(name.begin(), name.end());
    return names;
}

//! Takes off what all begin with; digits at its end are those of moments, of which all happen to begin alike.
void takeOffStart(std::vector<std::string>& names)
{
    size_t length = commonStart(names);
    while (length > 0 && isDigit(names[0][length - 1]))
        length--;
    for (std::string& name : names)
        name.erase(0, length);
}

bool areDistinct(const std::vector<std::string>& names)
{
    return std::set<std::string>(names.begin(), names.end()).size() == names.size();
}

//! Names that two cameras have in common.
size_t countShared(const std::vector<std::vector<std::string>>& cameras)
{
    std::set<std::string> known, shared;
    for (const std::vector<std::string>& names : cameras)
    {
        const std::set<std::string> own(names.begin(), names.end());
        for (const std::string& name : own)
            if (!known.insert(name).second)
                shared.insert(name);
    }
    return shared.size();
}

//! Whether a text has the form of a pattern. @param moment receives what stands at {}
bool isOfForm(const char* pattern, const std::string& text, std::string& moment)
{
    if (!*pattern)
        return text.empty();
    if (pattern[0] == '*')
    {
        for (size_t length = 0; length <= text.size(); length++)
            if (isOfForm(pattern + 1, text.substr(length), moment))
                return true;
        return false;
    }
    if (pattern[0] != '{' || pattern[1] != '}')
        return !text.empty() && text[0] == pattern[0] && isOfForm(pattern + 1, text.substr(1), moment);
    for (size_t length = text.size(); length > 0; length--)
        if (isOfForm(pattern + 2, text.substr(length), moment))
        {
            moment = text.substr(0, length);
            return true;
        }
    return false;
}

} // namespace

std::string momentOf(const std::string& path, const std::string& pattern)
{
    const std::filesystem::path file(path);
    std::string name = stemOf(path), moment;
    std::filesystem::path folder = file.parent_path();
    for (auto left = std::count(pattern.begin(), pattern.end(), '/'); left > 0; left--, folder = folder.parent_path())
        name = folder.filename().generic_string() + "/" + name;
    return isOfForm(pattern.c_str(), name, moment) ? moment : "";
}

Option addViewPattern(OptionParser& parser, std::string& pattern)
{
    return parser.add("--view-pattern", pattern,
                      "where names of images have the moment: {}, and * for anything, as in cam*_{}_raw or {}/*");
}

std::vector<std::string> momentsByPattern(const std::vector<std::string>& paths, const std::string& pattern)
{
    const std::string option = "--view-pattern=" + pattern + ": ";
    if (pattern.find("{}") == std::string::npos || pattern.find("{}") != pattern.rfind("{}"))
        throw Failure(option + "{} must stand in it once, where the moment is, as in cam*_{}_raw");
    std::map<std::string, std::string> known;
    std::vector<std::string> moments;
    for (const std::string& path : paths)
    {
        moments.push_back(momentOf(path, pattern));
        const auto first = known.insert({moments.back(), path});
        if (moments.back().empty())
            throw Failure(option + "'" + path + "' has no name of this form");
        if (!first.second)
            throw Failure(option + "'" + first.first->second + "' and '" + path + "' of one camera both are of the moment '"
                          + moments.back() + "'");
    }
    return moments;
}

std::vector<std::string> viewNames(const std::vector<std::string>& paths)
{
    std::vector<std::string> stems, whole;
    for (const std::string& path : paths)
    {
        stems.push_back(stemOf(path));
        whole.push_back((std::filesystem::path(path).parent_path()/stems.back()).generic_string());
    }
    if (areDistinct(stems) || !areDistinct(whole))
        return stems;
    const size_t folder = whole[0].substr(0, commonStart(whole)).rfind('/');
    for (std::string& name : whole)
        name.erase(0, folder == std::string::npos ? 0 : folder + 1);
    return whole;
}

void takeOffCameras(std::vector<std::vector<std::string>>& names)
{
    if (names.size() < 2 || countShared(names) > 0)
        return;
    const auto isOne = [](const std::vector<std::string>& camera) {
        return std::set<std::string>(camera.begin(), camera.end()).size() == 1; };
    if (std::all_of(names.begin(), names.end(), isOne))
    {
        const std::string first = names[0][0];
        for (std::vector<std::string>& camera : names)
            camera.assign(camera.size(), first);
        return;
    }
    std::vector<std::vector<std::string>> left = names;
    for (std::vector<std::string>& camera : left)
    {
        const std::set<std::string> all(camera.begin(), camera.end());     // a pair has one name twice
        takeOffStart(camera);
        camera = reversed(camera);
        takeOffStart(camera);
        camera = reversed(camera);
        const std::set<std::string> still(camera.begin(), camera.end());
        if (still.size() != all.size() || still.count("") > 0)
            return;
    }
    if (countShared(left) >= (std::any_of(names.begin(), names.end(), isOne) ? 1u : 2u))
        names = left;
}

} // namespace tools
