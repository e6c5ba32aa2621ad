// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is refused before images without a window are written, and what is beside them.
#include "colmap/pinhole_images.hpp"
#include "console/failure.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

using Catch::Contains;

namespace {

std::string refusalOf(const std::function<void()>& run)
{
    try
    {
        run();
        return "";
    }
    catch (const tools::Failure& e)
    {
        return e.what();
    }
}

tools::ColmapModel modelOf(const std::string& name)
{
    tools::ColmapModel model;
    tools::ColmapImage image;
    image.name = name;
    model.images.push_back(image);
    return model;
}

} // namespace

TEST_CASE("Images of a model are read and written below their folders, or not at all", "[colmap]")
{
    const TemporaryFolder f;
    std::filesystem::create_directories(f.path()/"raw/port");
    std::ofstream(f / "raw/port/a.png") << "raw";
    const auto refusal = [&](const std::string& name) {
        return refusalOf([&] { checkPinholeImages(modelOf(name), {}, f / "raw", f / "dense"); });
    };
    CHECK(refusal("port/a.png").empty());
    for (const std::string& name : {f / "raw/port/a.png", std::string("../raw/port/a.png"), std::string("port/../../x.png")})
    {
        CAPTURE(name);
        CHECK_THAT(refusal(name), Contains("is not named from the folder of the images on"));
    }
    CHECK(refusal("port/..a.png").find("not named") == std::string::npos);      // a name
}
