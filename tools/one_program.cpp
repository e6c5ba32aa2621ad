// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// All tools in one program, which is the one that it is called as.
#include "one_program.hpp"
#include <filesystem>
#include <iostream>
#include <string>

int main(int argc, char** argv)
{
    using tools::ALL_TOOLS;
    const std::string called = std::filesystem::path(argc > 0 ? argv[0] : "").filename().string();
    for (const tools::NamedTool* tool = ALL_TOOLS; tool->name; tool++)
        if (called == tool->name || called == std::string(tool->name) + ".exe")
            return tool->main(argc, argv);
    std::cerr << "This program is all tools of refract in one: call it by the name of one of them";
    for (const tools::NamedTool* tool = ALL_TOOLS; tool->name; tool++)
        std::cerr << (tool == ALL_TOOLS ? ": " : ", ") << tool->name;
    std::cerr << ".\n";
    return 1;
}
