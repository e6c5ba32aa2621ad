// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Mistakes in what is given, told from images that do not fit.
#include "assess/fit_quality.hpp"
#include "assess/misfit.hpp"
#include "calibrate/image_fit.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! Pairs of the paper's rig as they are, with all that is given right.
Given rightlyGiven(int cameras, scenes::Random& random, int outermostRows = 0)
{
    const RigModel rig = paperRig(cameras);
    Given given;
    given.square = 39.;
    given.data.cameraCount = cameras;
    const std::vector<Point3d> object = board(6, 5);
    given.options.window = rig.cameras[0]->window();
    given.options.window.distance = 0.;         // as the tool has it with air on both sides
    for (int c = 0; c < cameras; c++)
    {
        given.data.imageSize[c] = Size(1280, 1024);
        given.options.known[c] = copyWithWindow(rig.cameras[c], GlassWindow());
    }
    for (int i = 0; i < 6; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        const Vec3d rvec = random.vector(0.4);
        given.data.moments.push_back(observe(rig, object, rvec, tvec, true, 0.1, random));
        given.data.moments.back().stem = "pair" + std::to_string(i);
        given.data.moments.back().neighbours = {{0, 1}};       // a board
        if (i % 2 && outermostRows)     // the glass image shows a part of the board that begins a row later
        {
            std::vector<Point3d> later = object;
            for (Point3d& X : later)
                X.y += outermostRows*given.square;
            given.data.moments.back().glass[0] = observe(rig, later, rvec, tvec, false, 0.1, random).glass[0];
        }
    }
    return given;
}

std::string explained(const Given& given)
{
    std::string text;
    for (const std::string& sentence : explainMisfit(given))
        text += sentence + '\n';
    return text;
}

} // namespace

TEST_CASE("A wrong square, thickness, index or medium is found and named", "[misfit]")
{
    scenes::Random random(910);
    CAPTURE(scenes::seed());
    const Given right = rightlyGiven(1, random);
    CHECK(explained(right) == "");

    Given square = right;
    square.square = 3.9;
    for (Moment& m : square.data.moments)
        for (Point3d& X : m.objectPoints)
            X *= 0.1;
    CHECK_THAT(explained(square), (Catch::Contains("--square=39") || Catch::Contains("--square=38.9"))
                                  && Catch::Contains("in place of 3.9") && Catch::Contains("unit"));

    Given thickness = right;
    thickness.options.window.thickness[0] = 0.787;
    CHECK_THAT(explained(thickness), (Catch::Contains("--thickness=19.9") || Catch::Contains("--thickness=20"))
                                     && Catch::Contains("in place of 0.787") && Catch::Contains("unit"));

    Given index = right;
    index.options.window.index[0] = 1.05;
    CHECK_THAT(explained(index), Catch::Contains("--index=1.54"));

    Given water = right;
    water.options.window.outerIndex = 1.333;
    water.options.flags |= GLASS_FREE_DISTANCE;
    CHECK_THAT(explained(water), Catch::Contains("--outer-index=1 in place of 1.333"));
}

TEST_CASE("Water taken for air is found from glass-only views, and refused", "[misfit]")
{
    scenes::Random random(915);
    CAPTURE(scenes::seed());
    RigModel wet = paperRig(1);
    GlassWindow window = wet.cameras[0]->window();
    window.outerIndex = 1.333;
    wet.cameras[0]->setWindow(window);
    Given given = rightlyGiven(1, random);
    for (Moment& m : given.data.moments)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(640, 800));
        m.glass[0] = observe(wet, m.objectPoints, random.vector(0.4), tvec, false, 0.1, random).glass[0];
        m.direct[0].clear();
    }
    CHECK_THAT(explained(given), Catch::Contains("--outer-index=1.333 in place of 1"));

    RigCalibration c;
    c.data = given.data;
    c.options = given.options;
    c.start = startModel(c.data, c.options, c.lensSources);
    c.fit = fitImages(c.data, c.start, allMoments(c.data), 0);
    c.residuals = residualsOf(c.data, c.fit);
    c.baselines = computeBaselines(c.data, c.start, c.lensSources);
    CHECK_THROWS_WITH(requireSensible(c, given), Catch::Contains("does not fit its images")
                                                  && Catch::Contains("--outer-index=1.333"));
}

TEST_CASE("Images exchanged, moved or of other moments are found and named", "[misfit][slow]")
{
    scenes::Random random(920);
    CAPTURE(scenes::seed());
    const Given right = rightlyGiven(1, random), stereo = rightlyGiven(2, random);
    CHECK(explained(stereo) == "");

    Given swapped = right;
    for (Moment& m : swapped.data.moments)
        std::swap(m.direct[0], m.glass[0]);
    CHECK_THAT(explained(swapped), Catch::Contains("--direct and --glass exchanged"));

    Given second = stereo;
    for (Moment& m : second.data.moments)
        std::swap(m.direct[1], m.glass[1]);
    CHECK_THAT(explained(second), Catch::Contains("--direct2 and --glass2 exchanged"));

    Given cameras = stereo;
    for (Moment& m : cameras.data.moments)
        std::swap(m.glass[0], m.glass[1]);
    CHECK_THAT(explained(cameras), Catch::Contains("--glass and --glass2 exchanged") && !Catch::Contains("--unpaired"));
    for (Moment& m : cameras.data.moments)
    {
        std::swap(m.glass[0], m.glass[1]);
        std::swap(m.direct[0], m.direct[1]);
    }
    CHECK_THAT(explained(cameras), Catch::Contains("--direct and --direct2 exchanged"));

    Given moved = right;
    for (size_t i = 0; i < moved.data.moments.size(); i++)
        moved.data.moments[i].glass[0] = right.data.moments[(i + 1) % 6].glass[0];
    CHECK_THAT(explained(moved), Catch::Contains("--unpaired") && !Catch::Contains("--square"));

    Given moments = stereo;
    for (size_t i = 0; i < moments.data.moments.size(); i++)
        for (bool glass : {false, true})
            (glass ? moments.data.moments[i].glass : moments.data.moments[i].direct)[1] =
                (glass ? stereo.data.moments[(i + 1) % 6].glass : stereo.data.moments[(i + 1) % 6].direct)[1];
    CHECK_THAT(explained(moments), Catch::Contains("not the same moment"));

    Given shared = stereo;
    shared.options.windows = {0, 0};
    CHECK_THAT(explained(shared), Catch::Contains("leave --shared-window") && !Catch::Contains("same moment"));

    CHECK_THAT(explained(rightlyGiven(1, random, 1)), Catch::Contains("in 3 of 6 pairs") && Catch::Contains("--size"));
}

TEST_CASE("What the library says is told in the tool's words", "[misfit]")
{
    scenes::Random random(930);
    Given given = rightlyGiven(1, random);
    for (const int flags : {0, (int)GLASS_FREE_THICKNESS})
    {
        given.options.flags = flags;
        const std::string text = explainError("the calibration did not converge in 1000 iterations; raise "
                                              "criteria.maxCount, or fix what the views hardly determine", given);
        CHECK_THAT(text, !Catch::Contains("criteria") && Catch::Contains("give what you know", Catch::CaseSensitive::No));
        CHECK((text.find("--free") != std::string::npos) == (flags != 0));
    }

    // What fits comes before what one may do if nothing does.
    given.options.flags = 0;
    given.options.window.outerIndex = 1.333;
    given.options.outer = {1.333, "water:T=21", "water:T=21"};
    given.notices = {"a notice"};
    const std::string text = explainError("the calibration did not converge in 1000 iterations; raise criteria.maxCount, or fix what "
                                          "the views hardly determine", given);
    const size_t medium = text.find("--outer-index=1 in place of water:T=21 (1.33300)"), hint = text.find("ive what you know");
    CAPTURE(text);
    REQUIRE(medium != std::string::npos);
    REQUIRE(hint != std::string::npos);
    CHECK(medium < hint);
    CHECK(medium < text.find("a notice"));
}

TEST_CASE("Points of files that are mirrored, or in another unit than the window, are told", "[misfit]")
{
    scenes::Random random(980);
    const RigModel rig = paperRig(2);
    std::vector<Point3d> object = board(6, 5);
    for (size_t i = 0; i < object.size(); i++)
        object[i].z = 25.*(int)(i*7 % 4);
    Given given = rightlyGiven(2, random);
    given.square = 0.;
    for (Moment& m : given.data.moments)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        m = observe(rig, object, random.vector(0.4), tvec, false, 0.1, random);
        m.stem = "v";
        for (int c = 0; c < 2; c++)
            m.direct[c].clear();
    }
    given.data.moments.resize(2);
    CHECK(medianErrorOfFit(given.data, given.options) < 0.3);

    Given leftHanded = given, oneMirrored = given, metres = given;
    for (Moment& m : leftHanded.data.moments)
        for (Point3d& X : m.objectPoints)
            std::swap(X.x, X.y);
    CHECK_THAT(explained(leftHanded), Catch::Contains("left-handed") && !Catch::Contains("camera 2 counted"));
    for (Moment& m : oneMirrored.data.moments)
        for (Point2d& p : m.glass[1])
            p.y = 1023. - p.y;
    CHECK_THAT(explained(oneMirrored), Catch::Contains("camera 2 counted from the other side"));
    for (Moment& m : metres.data.moments)
        for (Point3d& X : m.objectPoints)
            X *= 0.001;
    CHECK_THAT(explained(metres), Catch::Contains("x, y, z 1000 times as large") && Catch::Contains("another unit"));
}
