// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ONE_PROGRAM_HPP
#define REFRACT_TOOLS_ONE_PROGRAM_HPP

namespace tools {

struct NamedTool
{
    const char* name;
    int (*main)(int argc, char** argv);
};

//! One for each refract_*.cpp, by name; the last is null. CMakeLists.txt makes it.
extern const NamedTool ALL_TOOLS[];

} // namespace tools

#endif // REFRACT_TOOLS_ONE_PROGRAM_HPP
