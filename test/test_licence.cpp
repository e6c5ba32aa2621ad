// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Every source file, script and CMake file says whose it is and under which licence, in its first lines.
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

namespace fs = std::filesystem;

namespace {

const fs::path ROOT = fs::path(paths::tests()) / "..";
const char* const OWN = "This file is part of the refract project. It is subject to the license terms in the LICENSE file at its "
                        "top level.\nSPDX-License-Identifier: Apache-2.0\n";
const char* const OPENCV = "This file is part of OpenCV project.\n"
                           "It is subject to the license terms in the LICENSE file found in the top-level directory\n"
                           "of this distribution and at http://opencv.org/license.html.\n";

bool endsWith(const std::string& text, const std::string& end)
{
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

//! What begins a comment in a file of this name and first line; empty where no licence is asked for: data, prose, settings.
std::string commentOf(const std::string& name, const std::string& firstLine)
{
    for (const char* end : {".cpp", ".hpp", ".h", ".hpp.in", ".js"})
        if (endsWith(name, end))
            return "// ";
    for (const char* end : {".py", ".sh", ".cmake", ".cmake.in", ".map"})
        if (endsWith(name, end))
            return "# ";
    return name == "CMakeLists.txt" || firstLine.compare(0, 2, "#!") == 0 ? "# " : "";
}

//! The licence as comments that begin so.
std::string asComment(const std::string& licence, const std::string& comment)
{
    std::string lines;
    for (size_t begin = 0, end; (end = licence.find('\n', begin)) != std::string::npos; begin = end + 1)
        lines += comment + licence.substr(begin, end + 1 - begin);
    return lines;
}

//! As .gitignore has it: builds, outputs, caches; and what tools hide.
bool isOfNoCommit(const fs::path& folder)
{
    const std::string name = folder.filename().string();
    return name.compare(0, 5, "build") == 0 || name == "out" || name == "__pycache__" || (name[0] == '.' && name != ".ci");
}

std::vector<fs::path> filesOfTheProject()
{
    std::vector<fs::path> files;
    for (fs::recursive_directory_iterator it(ROOT), end; it != end; ++it)
        if (it->is_directory() && isOfNoCommit(it->path()))
            it.disable_recursion_pending();
        else if (it->is_regular_file())
            files.push_back(it->path());
    return files;
}

} // namespace

TEST_CASE("Every source file and script begins with its licence", "[licence]")
{
    int count = 0;
    for (const fs::path& path : filesOfTheProject())
    {
        std::ifstream file(path);
        REQUIRE(file.is_open());
        std::string begin;
        std::getline(file, begin);
        const std::string comment = commentOf(path.filename().string(), begin);
        if (comment.empty())
            continue;
        const bool isScript = begin.compare(0, 2, "#!") == 0;
        begin = isScript ? "" : begin + '\n';
        for (std::string line; begin.size() < 500 && std::getline(file, line); )
            begin += line + '\n';

        const std::string name = path.lexically_relative(ROOT).generic_string();
        const std::string licence = asComment(name.compare(0, 8, "modules/") == 0 ? OPENCV : OWN, comment);
        count++;
        if (begin.compare(0, licence.size(), licence) != 0)
            FAIL_CHECK(name << ": begin the file, " << (isScript ? "after its first line, " : "") << "with\n" << licence);
    }
    CHECK(count > 500);
}
