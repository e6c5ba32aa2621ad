// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is wrong with images before a fit: names that pair nothing, one image under two names, parallel boards.
#include "calibrate/rig_data.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace tools;

namespace {

//! Views of one camera, as pairs if the names are common.
RigImages images(const std::string& direct, const std::string& glass, double tilt, scenes::Random& random)
{
    const RigModel rig = paperRig(1);
    RigImages sets;
    for (int i = 0; i < 6; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        const View view = observe(rig, board(6, 5), random.vector(tilt), tvec, true, 0.1, random);
        const std::string number = std::to_string(i);
        sets.direct[0].images.push_back({direct + number, "d/" + direct + number + ".png", view.direct[0], {}});
        sets.glass[0].images.push_back({glass + number, "g/" + glass + number + ".png", view.glass[0], {}});
    }
    for (DetectedImages* set : {&sets.direct[0], &sets.glass[0]})
        set->imageSize = Size(1280, 1024);
    return sets;
}

Target chessboard()
{
    TargetOptions options;
    options.size = "6x5";
    options.square = 39.;
    return Target(options);
}

std::string allNotices(const RigImages& sets, bool unpaired)
{
    std::string text;
    const Target target = chessboard();
    for (const std::string& notice : noticesOf(sets, groupIntoViews(&target, sets, unpaired)))
        text += notice + '\n';
    return text;
}

} // namespace

TEST_CASE("Names that pair no image are refused, with both names and what to do", "[data_checks]")
{
    scenes::Random random(810);
    CHECK_NOTHROW(requirePairs(images("v", "v", 0.4, random)));
    const RigImages sets = images("air", "wet", 0.4, random);
    CHECK_THROWS_WITH(requirePairs(sets), Catch::Contains("'air0'") && Catch::Contains("'wet0'")
                                          && Catch::Contains("--unpaired"));

    RigImages oneGlass = sets;
    oneGlass.glass[0].images.resize(1);
    CHECK_NOTHROW(requirePairs(oneGlass));

    RigImages notFound = sets;
    notFound.glass[0].withoutTarget = {"g/air0.png"};
    CHECK_THROWS_WITH(requirePairs(notFound), Catch::Contains("not found") && Catch::Contains("'air0'"));
}

TEST_CASE("One image under two names is told", "[data_checks]")
{
    scenes::Random random(820);
    RigImages sets = images("v", "v", 0.4, random);
    CHECK(allNotices(sets, false) == "");
    sets.glass[0].images[4].points = sets.glass[0].images[1].points;
    CHECK_THAT(allNotices(sets, false), Catch::StartsWith("one image is given more than once")
                                        && Catch::Contains("leave out what stands twice: 'g/v1.png' and 'g/v4.png'"));

    for (DetectedImage& image : sets.glass[0].images)
        image.points = sets.glass[0].images[0].points;
    CHECK_THAT(allNotices(sets, false), Catch::Contains("images are given more than once") && Catch::Contains("'g/v0.png' and 'g/v1.png', ")
                                        && !Catch::Contains("v5.png"));
}

TEST_CASE("Boards that are all parallel are told where they hide something", "[data_checks]")
{
    scenes::Random random(830);
    const RigImages flat = images("v", "v", 0.01, random), tilted = images("v", "v", 0.4, random);
    CHECK_THAT(allNotices(flat, false), Catch::Contains("direct images are parallel"));
    CHECK_THAT(allNotices(flat, false), !Catch::Contains("through the window are parallel"));     // pairs do not mind
    CHECK_THAT(allNotices(flat, true), Catch::Contains("through the window are parallel"));
    CHECK(allNotices(tilted, true) == "");
}

TEST_CASE("A target found in few of the images is told", "[data_checks]")
{
    scenes::Random random(840);
    RigImages sets = images("v", "v", 0.4, random);
    sets.direct[0].withoutTarget = {"a.png", "b.png", "c.png", "d.png", "e.png", "f.png", "g.png", "h.png"};
    CHECK_THAT(allNotices(sets, false), Catch::Contains("6 of 14 direct images") && Catch::Contains("--size"));
    // Whose board another camera saw at that moment, needs no other --size.
    for (const std::string name : {"a", "b", "c", "d", "e"})
        sets.direct[1].images.push_back({name, "2/" + name + ".png", {}, {}});
    CHECK_THAT(allNotices(sets, false), Catch::Contains("6 of 14 direct images; other cameras saw it at 5 of the moments without")
                                        && !Catch::Contains("--size"));
}
