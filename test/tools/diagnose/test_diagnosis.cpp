// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Mistakes in what is given, told from images that do not fit.
#include "diagnose/plain_fit.hpp"
#include "diagnose/diagnosis.hpp"
#include "diagnose/image_disagreement.hpp"
#include "diagnose/value_mistakes.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/fit.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! Pairs of the rig as they are, with all that is given right.
CalibrationInput rightlyGiven(const RigModel& rig, scenes::Random& random, int outermostRows = 0)
{
    const int cameras = (int)rig.cameras.size();
    CalibrationInput input;
    input.square = 39.;
    input.data.cameraCount = cameras;
    const std::vector<Point3d> object = board(6, 5);
    input.options.window = rig.cameras[0]->window();
    input.options.window.distance = 0.;         // as the tool has it with air on both sides
    for (int c = 0; c < cameras; c++)
    {
        input.data.imageSize[c] = Size(1280, 1024);
        input.options.known[c] = copyWithWindow(rig.cameras[c], GlassWindow());
    }
    for (int i = 0; i < 6; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        const Vec3d rvec = random.vector(0.4);
        input.data.views.push_back(observe(rig, object, rvec, tvec, true, 0.1, random));
        input.data.views.back().stem = "pair" + std::to_string(i);
        input.data.views.back().neighbours = {{0, 1}};       // a board
        if (i % 2 && outermostRows)     // the glass image shows a part of the board that begins a row later
        {
            std::vector<Point3d> later = object;
            for (Point3d& X : later)
                X.y += outermostRows*input.square;
            input.data.views.back().glass[0] = observe(rig, later, rvec, tvec, false, 0.1, random).glass[0];
        }
    }
    return input;
}

CalibrationInput rightlyGiven(int cameras, scenes::Random& random, int outermostRows = 0)
{
    return rightlyGiven(paperRig(cameras), random, outermostRows);
}

std::string explained(const CalibrationInput& input)
{
    std::string text;
    for (const std::string& sentence : diagnose(input))
        text += sentence + '\n';
    return text;
}

} // namespace

TEST_CASE("A wrong square, thickness, index or medium is found and named", "[diagnosis]")
{
    scenes::Random random(910);
    CAPTURE(scenes::seed());
    const CalibrationInput right = rightlyGiven(1, random);
    CHECK(explained(right) == "");

    CalibrationInput square = right;
    square.square = 3.9;
    for (View& view : square.data.views)
        for (Point3d& X : view.objectPoints)
            X *= 0.1;
    CHECK_THAT(explained(square), Catch::Contains("--square=3.9: set free, it would be 39.") && Catch::Contains("unit"));

    // By no unit: whichever of the two is found to be wrong, the other may be.
    square = right;
    square.square = 25.;
    for (View& view : square.data.views)
        for (Point3d& X : view.objectPoints)
            X *= 25./39.;
    CHECK_THAT(explained(square), Catch::Contains("--square=25: set free, it would be 39") || Catch::Contains("or --square would be 39"));

    CalibrationInput thickness = right;
    thickness.options.window.thickness[0] = 0.787;
    CHECK_THAT(explained(thickness), (Catch::Contains("--thickness=19.9") || Catch::Contains("--thickness=20"))
                                     && Catch::Contains("in place of 0.787") && Catch::Contains("unit"));

    CalibrationInput index = right;
    index.options.window.index[0] = 1.05;
    CHECK_THAT(explained(index), Catch::Contains("--index=1.05") && Catch::Contains("the index would be 1.54"));

    CalibrationInput water = right;
    water.options.window.outerIndex = 1.333;
    water.options.flags |= GLASS_FREE_DISTANCE;
    CHECK_THAT(explained(water), Catch::Contains("--outer-index=1 in place of 1.333"));
}

TEST_CASE("Water behind a far wall, taken for air, is not taken for boards that moved", "[diagnosis]")
{
    // The two images of a pair are a thousand pixels apart, which a window near the camera never does.
    std::cout << "seed " << scenes::seed() << '\n';
    for (int trial = 0; trial < 4; trial++)
    {
        scenes::Random random(916 + trial);
        RigModel wet = paperRig(1);
        wet.cameras[0] = refract::RefractiveCamera::create(Matx33d(9000, 0, 639.5, 0, 9000, 511.5, 0, 0, 1), noArray());
        const double tilt = random.uniform(0.4, 0.7), azimuth = random.uniform(0, 2*CV_PI);
        const Vec3d normal(std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt));
        wet.cameras[0]->setWindow(GlassWindow(normal, 48., 1.67, 1800., 1.333));
        CalibrationInput input;
        input.square = 39.;
        input.data.cameraCount = 1;
        input.data.imageSize[0] = Size(1280, 1024);
        input.options.window = GlassWindow(normal, 48., 1.67);
        input.options.known[0] = copyWithWindow(wet.cameras[0], GlassWindow());
        for (int i = 0; i < 4; i++)
        {
            const Vec3d tvec(random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(2900, 3300));
            input.data.views.push_back(observe(wet, board(10, 6), random.vector(0.3), tvec, true, 0.3, random));
            input.data.views.back().stem = "pair" + std::to_string(i);
            input.data.views.back().neighbours = {{0, 1}};
        }
        CHECK_THAT(explained(input), Catch::Contains("--outer-index=1.333 in place of 1") && !Catch::Contains("unpaired"));
    }
}

TEST_CASE("Water taken for air is found from glass-only views, and refused", "[diagnosis]")
{
    scenes::Random random(915);
    CAPTURE(scenes::seed());
    RigModel wet = paperRig(1);
    GlassWindow window = wet.cameras[0]->window();
    window.outerIndex = 1.333;
    wet.cameras[0]->setWindow(window);
    CalibrationInput input = rightlyGiven(1, random);
    for (View& view : input.data.views)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(640, 800));
        view.glass[0] = observe(wet, view.objectPoints, random.vector(0.4), tvec, false, 0.1, random).glass[0];
        view.direct[0].clear();
    }
    CHECK_THAT(explained(input), Catch::Contains("--outer-index=1.333 in place of 1"));

    RigCalibration c;
    c.data = input.data;
    c.options = input.options;
    c.start = startModel(c.data, c.options, c.lensSources);
    c.fit = fitImages(c.data, c.start, allViews(c.data), 0);
    c.residuals = residualsOf(c.data, c.fit);
    c.baselines = computeBaselines(c.data, c.start, c.lensSources);
    const double separate = rmsOfSeparateFits(c.baselines, c.lensSources);
    CHECK_THROWS_WITH(requirePlausible(c.data, c.residuals, separate, input), Catch::Contains("does not fit its images")
                                                                              && Catch::Contains("--outer-index=1.333"));
}

TEST_CASE("Water taken for air is found by each camera of a sealed rig alone", "[diagnosis][slow]")
{
    scenes::Random random(916);
    CAPTURE(scenes::seed());
    const double NOISE = 0.02;          // px
    RigModel wet = paperRig(2);
    CalibrationInput input = rightlyGiven(2, random);
    input.options.window = wet.cameras[0]->window();
    input.options.window.distance = 30.;
    input.options.flags = GLASS_FREE_INTRINSICS;
    input.data.views.clear();
    for (int c = 0; c < 2; c++)
    {
        Mat lens = wet.cameras[c]->lensParameters().clone();
        lens.at<double>(0) = lens.at<double>(1) = 1000.;        // wide: refraction is no radial distortion
        wet.cameras[c]->setLensParameters(lens);
        GlassWindow window = wet.cameras[c]->window();
        window.distance = 30.;
        window.outerIndex = 1.333;
        wet.cameras[c]->setWindow(window);
        input.options.known[c].reset();
    }
    for (int i = 0; i < 20; i++)
    {
        const Vec3d tvec(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(450, 650));
        input.data.views.push_back(observe(wet, board(6, 5), random.vector(0.05), tvec, false, NOISE, random));
        for (std::vector<Point2d>& pixels : input.data.views.back().direct)
            pixels.clear();
    }
    const double clean = 1.6*NOISE;
    const Explanation medium = wrongMediumOfEach(input, clean);
    CHECK_THAT(medium.sentence, Catch::Contains("--outer-index=1.333 in place of 1"));
    CHECK(medium.px < clean);
    CHECK(noiseOfImages(input) > NOISE/2);          // a start is far from the lens: smooth maps leave a little of that

    input.options.window.outerIndex = 1.333;
    input.options.flags |= GLASS_FREE_DISTANCE;
    CHECK(!(wrongMediumOfEach(input, clean).px < NO_FIT));
}

TEST_CASE("Images exchanged, moved or of other moments are found and named", "[diagnosis][slow]")
{
    scenes::Random random(920);
    CAPTURE(scenes::seed());
    const CalibrationInput right = rightlyGiven(1, random), stereo = rightlyGiven(2, random);
    CHECK(explained(stereo) == "");

    CalibrationInput swapped = right;
    for (View& view : swapped.data.views)
        std::swap(view.direct[0], view.glass[0]);
    CHECK_THAT(explained(swapped), Catch::Contains("--direct and --glass exchanged"));

    CalibrationInput second = stereo;
    for (View& view : second.data.views)
        std::swap(view.direct[1], view.glass[1]);
    CHECK_THAT(explained(second), Catch::Contains("--direct2 and --glass2 exchanged"));

    CalibrationInput cameras = stereo;
    for (View& view : cameras.data.views)
        std::swap(view.glass[0], view.glass[1]);
    CHECK_THAT(explained(cameras), Catch::Contains("--glass and --glass2 exchanged") && !Catch::Contains("--unpaired"));
    for (View& view : cameras.data.views)
    {
        std::swap(view.glass[0], view.glass[1]);
        std::swap(view.direct[0], view.direct[1]);
    }
    CHECK_THAT(explained(cameras), Catch::Contains("--direct and --direct2 exchanged"));

    CalibrationInput moved = right;
    for (size_t i = 0; i < moved.data.views.size(); i++)
        moved.data.views[i].glass[0] = right.data.views[(i + 1) % 6].glass[0];
    CHECK_THAT(explained(moved), Catch::Contains("--unpaired") && !Catch::Contains("--square"));

    CalibrationInput views = stereo;
    for (size_t i = 0; i < views.data.views.size(); i++)
        for (bool glass : {false, true})
            (glass ? views.data.views[i].glass : views.data.views[i].direct)[1] =
                (glass ? stereo.data.views[(i + 1) % 6].glass : stereo.data.views[(i + 1) % 6].direct)[1];
    CHECK_THAT(explained(views), Catch::Contains("not the same moment"));

    CalibrationInput shared = stereo;
    shared.options.windows = {0, 0};
    CHECK_THAT(explained(shared), Catch::Contains("leave --shared-window") && !Catch::Contains("same moment"));

    CHECK_THAT(explained(rightlyGiven(1, random, 1)), Catch::Contains("in 3 of 6 pairs") && Catch::Contains("--size"));
}

TEST_CASE("Of exchanges the images that are exchanged are compared again, and none that there are not is one", "[diagnosis]")
{
    scenes::Random random(760);
    CalibrationInput input = rightlyGiven(3, random);
    for (View& view : input.data.views)
    {
        view.direct = {};
        std::swap(view.glass[1], view.glass[2]);
    }
    const MixUps mixUps = findMixUps(input);
    REQUIRE(mixUps.camerasApart > WINDOWS_PX);
    std::vector<std::string> sentences;
    for (const std::vector<MixUp>* some : {&mixUps.clear, &mixUps.possible})
        for (const MixUp& mixUp : *some)
            sentences.push_back(mixUp.sentence);
    CAPTURE(sentences);
    CHECK(std::find(sentences.begin(), sentences.end(), "--glass2 and --glass3 exchanged") != sentences.end());
    CHECK(std::find(sentences.begin(), sentences.end(), "--direct2 and --direct3 exchanged") == sentences.end());
    BoardPoses poses;
    for (int other : {0, 1})
    {
        RoughLenses lenses = roughLensesOf(input.data);
        Disagreements changed = disagreementsOf(input.data, input.options, lenses, poses);
        RigData data = input.data;
        for (View& view : data.views)
            std::swap(view.glass[other], view.glass[2]);
        std::swap(lenses.glass[other], lenses.glass[2]);
        update(data, input.options, lenses, {other, 2}, poses, changed);
        CHECK(changed.kinds() == disagreementsOf(data, input.options, lenses, poses).kinds());
    }
}

TEST_CASE("What the library says is told in the tool's words", "[diagnosis]")
{
    scenes::Random random(930);
    CalibrationInput input = rightlyGiven(1, random);
    const CalibrationError error(CalibrationError::NOT_CONVERGED, "it did not converge; raise criteria.maxCount", "it did not converge");
    for (const int flags : {0, (int)GLASS_FREE_THICKNESS})
    {
        input.options.flags = flags;
        const std::string text = explainError(error, input);
        CHECK_THAT(text, Catch::StartsWith("it did not converge: the images hardly determine"));
        CHECK_THAT(text, !Catch::Contains("criteria") && Catch::Contains("give what you know", Catch::CaseSensitive::No));
        CHECK((text.find("--free") != std::string::npos) == (flags != 0));
    }

    // What fits comes before what one may do if nothing does.
    input.options.flags = 0;
    input.options.window.outerIndex = 1.333;
    input.options.outer = {1.333, "water:T=21", "water:T=21"};
    input.notices = {"a notice"};
    const std::string text = explainError(error, input);
    const size_t medium = text.find("--outer-index=1 in place of water:T=21 (1.33300)"), hint = text.find("ive what you know");
    CAPTURE(text);
    REQUIRE(medium != std::string::npos);
    REQUIRE(hint != std::string::npos);
    CHECK(medium < hint);
    CHECK(medium < text.find("a notice"));
}

TEST_CASE("Where a fit does not converge, one window for cameras that look the same way is named if it fits", "[diagnosis]")
{
    scenes::Random random(931);
    const CalibrationError error(CalibrationError::NOT_CONVERGED, "it did not converge; raise criteria.maxCount", "it did not converge");
    RigModel rig = paperRig(2);
    CHECK_THAT(explainError(error, rightlyGiven(rig, random)), !Catch::Contains("--window-of-camera"));
    GlassWindow pane = rig.cameras[0]->window();
    pane.normal = rig.extrinsics[1].R*pane.normal;
    pane.distance += pane.normal.dot(rig.extrinsics[1].t);
    rig.cameras[1]->setWindow(pane);            // the pane of camera 1, as camera 2 has it
    CalibrationInput input = rightlyGiven(rig, random);
    CHECK_THAT(explainError(error, input), Catch::Contains("With --window-of-camera=1,1 they fit within 0."));
    input.options.windows = {0, 0};             // said already
    CHECK_THAT(explainError(error, input), !Catch::Contains("--window-of-camera"));
}

TEST_CASE("Points of files that are mirrored, or in another unit than the window, are told", "[diagnosis]")
{
    scenes::Random random(980);
    const RigModel rig = paperRig(2);
    std::vector<Point3d> object = board(6, 5);
    for (size_t i = 0; i < object.size(); i++)
        object[i].z = 25.*(int)(i*7 % 4);
    CalibrationInput input = rightlyGiven(2, random);
    input.square = 0.;
    for (View& view : input.data.views)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        view = observe(rig, object, random.vector(0.4), tvec, false, 0.1, random);
        view.stem = "v";
        for (int c = 0; c < 2; c++)
            view.direct[c].clear();
    }
    input.data.views.resize(2);
    CHECK(medianErrorOfFit(input.data, input.options) < 0.3);

    CalibrationInput leftHanded = input, oneMirrored = input, metres = input;
    for (View& view : leftHanded.data.views)
        for (Point3d& X : view.objectPoints)
            std::swap(X.x, X.y);
    CHECK_THAT(explained(leftHanded), Catch::Contains("left-handed") && !Catch::Contains("camera 2 counted"));
    for (View& view : oneMirrored.data.views)
        for (Point2d& p : view.glass[1])
            p.y = 1023. - p.y;
    CHECK_THAT(explained(oneMirrored), Catch::Contains("camera 2 counted from the other side"));
    for (View& view : metres.data.views)
        for (Point3d& X : view.objectPoints)
            X *= 0.001;
    CHECK_THAT(explained(metres), Catch::Contains("x, y, z 1000 times as large") && Catch::Contains("another unit"));
}

TEST_CASE("Images that fit in any unit are no reason to name another one", "[diagnosis]")
{
    scenes::Random random(981);
    RigModel rig = paperRig(1);
    GlassWindow wall = rig.cameras[0]->window();
    wall.thickness = {1.};
    wall.distance = 30.;
    wall.outerIndex = 1.333;
    rig.cameras[0] = copyWithWindow(rig.cameras[0], wall);
    std::vector<Point3d> object = board(6, 5, 10.);
    for (size_t i = 0; i < object.size(); i++)
        object[i].z = 8.*(int)(i*7 % 4);
    CalibrationInput input = rightlyGiven(1, random);
    input.square = 0.;
    input.options.window = wall;
    input.data.views.resize(2);
    for (View& view : input.data.views)
    {
        view = observe(rig, object, random.vector(0.4), Vec3d(random.uniform(-9, 9), random.uniform(-9, 9), 600), false, 0.1, random);
        view.stem = "v";
        view.direct[0].clear();
    }
    REQUIRE(medianErrorOfFit(input.data, input.options) < 0.3);
    CalibrationInput farther = input;
    for (View& view : farther.data.views)
        for (Point3d& X : view.objectPoints)
            X *= 1000.;
    REQUIRE(medianErrorOfFit(farther.data, farther.options) < largestSoundError(input.data));       // it would explain them
    CHECK(wrongUnitOfPoints(input).px == NO_FIT);
}
