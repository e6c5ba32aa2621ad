// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// rejectOutliers: what the robust fit takes out of the data, and what it says if it cannot.
#include "calibrate/outliers.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace tools;

namespace {

//! Six pairs of one camera.
RigData sixPairs(const RigModel& rig, scenes::Random& random)
{
    RigData data;
    data.imageSize[0] = Size(1280, 1024);
    for (int i = 0; i < 6; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        data.views.push_back(observe(rig, board(6, 5), random.vector(0.4), tvec, true, 0.1, random));
        data.views.back().stem = "pair" + std::to_string(i);
    }
    return data;
}

} // namespace

TEST_CASE("Wrong points and a moved board are taken out by name", "[outliers]")
{
    scenes::Random random(710);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    data.views[1].glass[0][7] += Point2d(5, -3);
    for (Point2d& p : data.views[3].direct[0])
        p += Point2d(2, 1);
    const Outliers outliers = rejectOutliers(data, rig, 0);
    CHECK(outliers.fault == "");
    REQUIRE(outliers.rejected.size() == 2);
    CHECK(outliers.rejected[0].view == "pair1");
    CHECK(outliers.rejected[0].points == 1);
    CHECK(outliers.rejected[0].glass);
    CHECK(std::isnan(data.views[1].glass[0][7].x));
    CHECK(outliers.rejected[1].view == "pair3");
    CHECK(outliers.rejected[1].image);
    CHECK(data.views[3].direct[0].empty() != data.views[3].glass[0].empty());
}

TEST_CASE("If most points are wrong, all stay and it is said", "[outliers]")
{
    scenes::Random random(720);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    for (View& view : data.views)
        for (std::vector<Point2d>* pixels : {&view.direct[0], &view.glass[0]})
            for (Point2d& p : *pixels)
                p += Point2d(random.uniform(-300, 300), random.uniform(-300, 300));
    const Outliers outliers = rejectOutliers(data, rig, 0);
    CHECK(outliers.rejected.empty());
    CHECK_THAT(outliers.fault, Catch::Contains("points fit"));
    CHECK(!std::isnan(data.views[0].glass[0][0].x));
}

TEST_CASE("A lens from few images of a small board does not cost good images", "[outliers]")
{
    for (unsigned salt : {0u, 1u, 2u, 3u, 4u, 5u})
    {
        scenes::Random random(730 + salt);
        CAPTURE(scenes::seed(), salt);
        const RigModel rig = paperRig(4);
        RigData data;
        data.cameraCount = 4;
        data.imageSize.fill(Size(1280, 1024));
        for (int i = 0; i < 8; i++)
        {
            const Vec3d rvec = random.vector(0.4);
            const Vec3d tvec(random.uniform(-60, 60), random.uniform(-50, 50), random.uniform(500, 700));
            data.views.push_back(observe(rig, board(6, 5, 15.), rvec, tvec, true, 0.02, random));
            data.views.back().stem = "pair" + std::to_string(i);
        }
        RigOptions options;
        options.window = rig.cameras[0]->window();
        options.window.normal = Vec3d(0, 0, 1);
        options.lensCoefficients = 4;
        RigModel start;
        std::vector<LensSource> lensSources;
        const Outliers outliers = startWithoutOutliers(data, options, start, lensSources);
        CHECK(outliers.fault == "");
        for (const Rejected& rejected : outliers.rejected)
        {
            CAPTURE(rejected.sentence());
            CHECK(!rejected.image);
        }
    }
}
