// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Files that arrive come once, when they have stopped to grow; those of no use come again when they are written anew.
#include "calibrate/live_pairs.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>

using namespace tools;

namespace {

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

} // namespace

TEST_CASE("A file comes when it has stopped to grow", "[new files]")
{
    const TemporaryFolder folder;
    NewFiles files(folder / "*.png");
    CHECK(files.next().empty());
    CHECK(!files.arePending());
    const std::string a = folder / "a.png", b = folder / "b.png";
    write(a, "1");
    write(folder / "other.txt", "1");
    CHECK(files.next().empty());
    CHECK(files.arePending());
    write(a, "12");
    CHECK(files.next().empty());        // it has grown
    CHECK(files.next() == a);
    CHECK(files.isNew(a));
    write(b, "1");
    CHECK(files.next() == a);           // until it is done with
    files.finish(a, true);
    CHECK(files.next().empty());
    CHECK(files.next() == b);
    files.finish(b, false);
    CHECK(files.next().empty());
    CHECK(!files.arePending());
    write(a, "123");                    // in use already
    CHECK(files.next().empty());
    CHECK(!files.arePending());
    write(b, "123");                    // taken again
    CHECK(files.next().empty());
    CHECK(files.arePending());
    CHECK(files.next() == b);
    files.finish(b, true);
    std::filesystem::remove(a);
    std::filesystem::remove(b);
    CHECK(files.next().empty());
    CHECK(!files.arePending());
}
