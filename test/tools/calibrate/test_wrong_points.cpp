// dropWrongPoints: what the robust fit takes out of the data, and what it says if it cannot.
#include "calibrate/wrong_points.hpp"
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
        data.moments.push_back(observe(rig, board(6, 5), random.vector(0.4), tvec, true, 0.1, random));
        data.moments.back().stem = "pair" + std::to_string(i);
    }
    return data;
}

} // namespace

TEST_CASE("Wrong points and a moved board are taken out by name", "[wrong_points]")
{
    scenes::Random random(710);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    data.moments[1].glass[0][7] += Point2d(5, -3);
    for (Point2d& p : data.moments[3].direct[0])
        p += Point2d(2, 1);
    const WrongPoints wrong = dropWrongPoints(data, rig, 0);
    CHECK(wrong.fault == "");
    REQUIRE(wrong.dropped.size() == 2);
    CHECK(wrong.dropped[0].view == "pair1");
    CHECK(wrong.dropped[0].points == 1);
    CHECK(wrong.dropped[0].glass);
    CHECK(std::isnan(data.moments[1].glass[0][7].x));
    CHECK(wrong.dropped[1].view == "pair3");
    CHECK(wrong.dropped[1].image);
    CHECK(data.moments[3].direct[0].empty() != data.moments[3].glass[0].empty());
}

TEST_CASE("If most points are wrong, all stay and it is said", "[wrong_points]")
{
    scenes::Random random(720);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    for (Moment& m : data.moments)
        for (std::vector<Point2d>* pixels : {&m.direct[0], &m.glass[0]})
            for (Point2d& p : *pixels)
                p += Point2d(random.uniform(-300, 300), random.uniform(-300, 300));
    const WrongPoints wrong = dropWrongPoints(data, rig, 0);
    CHECK(wrong.dropped.empty());
    CHECK_THAT(wrong.fault, Catch::Contains("points fit"));
    CHECK(!std::isnan(data.moments[0].glass[0][0].x));
}
