// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/progress.hpp"
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <thread>
#include <unistd.h>

using namespace tools;

TEST_CASE("Progress without a terminal names what is worked on, every few seconds", "[progress]")
{
    for (const bool quiet : {false, true})
    {
        std::FILE* file = std::tmpfile();
        const int terminal = dup(STDERR_FILENO);
        dup2(fileno(file), STDERR_FILENO);
        {
            Progress progress("searching", 3, quiet);
            progress.at("a.png");
            progress.step();
            progress.at("b.png");
            std::this_thread::sleep_for(std::chrono::milliseconds(5400));
        }
        dup2(terminal, STDERR_FILENO);
        close(terminal);
        std::rewind(file);
        char text[100] = "";
        const size_t length = std::fread(text, 1, sizeof(text), file);
        std::fclose(file);
        CHECK(std::string(text, length) == (quiet ? "" : "... searching 1/3: b.png\n"));
    }
}
