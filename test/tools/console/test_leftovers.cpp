// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What a signal leaves behind: nothing.
#include "console/file_output.hpp"
#include "console/leftovers.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <fstream>
#include <iterator>

using namespace tools;

namespace {

void writeFile(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string readFile(const std::string& path)
{
    std::ifstream in(path);
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

//! What ended a child that wrote half of a file and got the signal; its signals are as the tools have them.
int endOfWriter(const std::string& path, int signalNumber, bool ignored)
{
    const pid_t child = fork();
    if (child == 0)
    {
        for (int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
            signal(s, SIG_DFL);
        if (ignored)
            signal(signalNumber, SIG_IGN);
        removeLeftoversOnSignals();
        OutputFile file(path);
        writeFile(file.temporary(), "half");
        raise(signalNumber);
        writeFile(path, "went on");
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

} // namespace

TEST_CASE("A signal that ends a tool leaves no temporary file", "[leftovers]")
{
    for (const int signalNumber : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
    {
        const TemporaryFolder folder;
        CAPTURE(signalNumber);
        CHECK(endOfWriter(folder / "out.yml", signalNumber, false) == signalNumber);
        CHECK(folder.count() == 0);
        CHECK(endOfWriter(folder / "out.yml", signalNumber, true) == 0);        // as with nohup
        CHECK(readFile(folder / "out.yml") == "went on");
    }
}

TEST_CASE("Folders go after what is in them, and what is given back stays", "[leftovers]")
{
    const TemporaryFolder folder;
    const std::string inner = folder / "inner";
    std::filesystem::create_directory(inner);
    const pid_t child = fork();
    if (child == 0)
    {
        signal(SIGTERM, SIG_DFL);
        removeLeftoversOnSignals();
        const Leftover ofFolder(inner), ofFile(inner + "/file"), absent(inner + "/absent");
        {
            const Leftover done(folder / "done");
            writeFile(folder / "done", "complete");
        }
        writeFile(inner + "/file", "half");
        raise(SIGTERM);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WIFSIGNALED(status));
    CHECK(!std::filesystem::exists(inner));
    CHECK(readFile(folder / "done") == "complete");
}
