// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What must not be written over: files that are read, and those that another run is about to write.
#include "console/failure.hpp"
#include "console/file_output.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>
#include <memory>

using namespace tools;

TEST_CASE("An output is none of the files that a name with a number stands for", "[outputs]")
{
    const TemporaryFolder folder;
    for (const char* name : {"cam1.csv", "cam2.csv"})
        std::ofstream(folder/name) << "id,u1,v1\n";
    const std::string inputs = folder / "cam%d.csv";
    CHECK_THROWS_AS(checkOutputs({{"--out", folder / "cam2.csv", OUTPUT_TEXT}}, {inputs}), Failure);
    CHECK_NOTHROW(checkOutputs({{"--out", folder / "cam3.csv", OUTPUT_TEXT}}, {inputs}));
}

TEST_CASE("A lock is of one at a time, and one that was left behind is of nobody", "[outputs]")
{
    const TemporaryFolder folder;
    const std::string name = folder / "out.lock";
    std::ofstream(name) << "";                  // as a run that was killed leaves it
    {
        const std::unique_ptr<FileLock> mine = FileLock::tryOnce(name, name);
        REQUIRE(mine);
        CHECK_FALSE(FileLock::tryOnce(name, name));   // of another open file, as that of another process
    }
    CHECK_FALSE(std::ifstream(name).good());
    CHECK(FileLock::tryOnce(name, name));
}
