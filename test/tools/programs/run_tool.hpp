// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_RUN_TOOL_HPP
#define REFRACT_TEST_RUN_TOOL_HPP

#include "temporary_folder.hpp"
#include "paths.hpp"
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <sys/wait.h>

/* Runs the built tools as a user would. */

inline std::string readFile(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

inline void writeFile(const std::string& path, const std::string& text)
{
    std::ofstream(path, std::ios::binary) << text;
}

inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct ToolResult
{
    int code;                   //!< exit code; -1 if it was ended by a signal
    std::string out, err;
    std::string progress = {};  //!< the lines "... how far it is", which a slow machine has and a fast one not; not in err
};

//! Takes the lines that tell the progress out of stderr.
inline std::string takeProgress(std::string& err)
{
    std::istringstream in(err);
    std::string rest, progress, line;
    while (std::getline(in, line))
        (line.compare(0, 4, "... ") == 0 ? progress : rest) += line + '\n';
    err = rest;
    return progress;
}

//! "refract_calib --help": the name of a built tool and its arguments, for the shell.
inline ToolResult runTool(const std::string& commandLine, const std::string& environment = "")
{
    const TemporaryFolder folder;
    const std::string out = folder / "out", err = folder / "err";
    const int status = std::system((environment + ' ' + paths::programs() + '/' + commandLine + " >" + out + " 2>" + err).c_str());
    ToolResult result = {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(out), readFile(err), ""};
    result.progress = takeProgress(result.err);
    return result;
}

#endif // REFRACT_TEST_RUN_TOOL_HPP
