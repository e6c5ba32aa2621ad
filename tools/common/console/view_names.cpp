// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/view_names.hpp"
#include "console/images.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
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

//! Whether two cameras have a name in common.
bool shareNames(const std::vector<std::vector<std::string>>& cameras)
{
    std::set<std::string> known;
    for (const std::vector<std::string>& names : cameras)
    {
        const std::set<std::string> own(names.begin(), names.end());
        for (const std::string& name : own)
            if (!known.insert(name).second)
                return true;
    }
    return false;
}

} // namespace

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
    if (names.size() < 2 || shareNames(names))
        return;
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
    if (shareNames(left))
        names = left;
}

} // namespace tools
