// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// All tools in one program, which is the one that it is called as, or the one that its first argument names.
#include "one_program.hpp"
#include <filesystem>
#include <iostream>
#include <string>

using tools::ALL_TOOLS;
using tools::NamedTool;

//! With the prefix or without it. Null: there is none.
static const NamedTool* toolNamed(const std::string& name)
{
    for (const NamedTool* tool = ALL_TOOLS; tool->name; tool++)
        if (name == tool->name || "refract_" + name == tool->name)
            return tool;
    return nullptr;
}

static void list(std::ostream& out)
{
    out << "refract_tools is all tools of refract in one: refract_tools TOOL OPTIONS. TOOL is one of";
    for (const NamedTool* tool = ALL_TOOLS; tool->name; tool++)
        out << (tool == ALL_TOOLS ? " " : ", ") << tool->name;
    out << ".\n";
}

int main(int argc, char** argv)
{
    const std::filesystem::path called(argc > 0 ? argv[0] : "");
    if (const NamedTool* tool = toolNamed((called.extension() == ".exe" ? called.stem() : called.filename()).string()))
        return tool->main(argc, argv);
    const std::string first = argc > 1 ? argv[1] : "";
    if (const NamedTool* tool = toolNamed(first))
    {
        std::string name = tool->name;          // in its messages
        argv[1] = name.data();
        return tool->main(argc - 1, argv + 1);
    }
    const bool asksForHelp = first == "--help" || first == "-h";
    list(asksForHelp ? std::cout : std::cerr);
    return asksForHelp ? 0 : 1;
}
