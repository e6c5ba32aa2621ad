// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Cameras in domes, as a user has them: images are rendered, calibrated, measured, checked.
#include "scenes.hpp"
#include "dome_scene.hpp"
#include "truth_file.hpp"
#include <cmath>
#include <cstring>
#include <iostream>
#include <opencv2/refract.hpp>

using namespace dome_scene;

namespace {

//! One camera, its window as in files.
std::string oneCamera(const std::string& window)
{
    return "%YAML:1.0\n---\ntarget: { pattern: chessboard, size: \"9x6\", square: 25. }\nimage_width: 800\nimage_height: 640\n"
           "camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 720., 0., 404., 0., 720., 316., 0., 0., 1. ] }\n"
           "distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.1, 0.05, 0.0005, -0.0005 ] }\n"
           "glass_window: " + window + "\nexposure: { noise: 2., blur: 0.7 }\nseed: 7\nposes:\n"
           "   air: { count: 8, distance: [ 350., 600. ], tilt_deg: [ 10., 35. ], roll_deg: 30., margin: 8. }\n"
           "   pair: { count: 6, distance: [ 350., 600. ], tilt_deg: [ 5., 30. ], roll_deg: 20., margin: 8. }\n"
           "sets:\n   direct: { window: 0, poses: [ air, pair ] }\n   glass: { window: 1, poses: [ pair ] }\n";
}

void readWindows(const Rendered& rig, cv::refract::GlassWindow& found, cv::refract::GlassWindow& truth)
{
    const cv::FileStorage file(rig.out("calib.yml"), cv::FileStorage::READ), given(rig.out("img/truth.yml"), cv::FileStorage::READ);
    file["glass_window"] >> found;
    given["glass_window"] >> truth;
}

} // namespace

TEST_CASE("Two cameras in domes, from images to points, with errors as stated", "[tools][dome]")
{
    const Rendered rig(scene());
    const ToolResult calibrated = runTool(rig.calib() + DOME + "--verbose --out=" + rig.out("calib.yml"));
    INFO(calibrated.out << calibrated.err);
    REQUIRE(calibrated.code == 0);
    CHECK(mentions(calibrated.out, "camera off the centre, mm"));

    const cv::FileStorage found(rig.out("calib.yml"), cv::FileStorage::READ), truth(rig.out("img/truth.yml"), cv::FileStorage::READ);
    for (const std::string camera : {"camera1", "camera2"})
    {
        cv::refract::GlassWindow is, expected;
        found[camera]["glass_window"] >> is;
        truth[camera]["glass_window"] >> expected;
        CHECK(is.shape == cv::refract::WINDOW_DOME);
        std::vector<double> std;
        found[camera]["glass_window_std"]["center"] >> std;
        REQUIRE(std.size() == 3);
        CHECK(found[camera]["glass_window_std"]["normal_deg"].empty());
        const double radiusStd = (double)found[camera]["glass_window_std"]["radius"];
        std::cout << "[numbers] dome of " << camera << ": centre off by " << is.center - expected.center << ", stated " << std[0] << ", "
                  << std[1] << ", " << std[2] << "; radius off by " << is.radius - expected.radius << ", stated " << radiusStd << '\n';
        for (int i = 0; i < 3; i++)
        {
            CHECK(std::abs(is.center[i] - expected.center[i]) < 3*std[i]);
            CHECK(std[i] < 0.5);
        }
        CHECK(std::abs(is.radius - expected.radius) < 3*radiusStd);
        CHECK(radiusStd > 0.);
        CHECK(radiusStd < 0.11);
    }

    const ToolResult measured = runTool("refract_measure " + rig.out("calib.yml") + " " + rig.set("measure1") + " " + rig.set("measure2")
                                        + BOARD + " --out=" + rig.out("points.csv"));
    INFO(measured.out << measured.err);
    REQUIRE(measured.code == 0);
    const std::map<std::string, TrueView> views = readTruth(rig.out("img"));
    const std::vector<cv::Point3d> board = chessboard(9, 6, 25.003);
    double squares = 0., inSigma = 0.;
    int count = 0;
    for (const CsvRow& row : readPointsCsv(readFile(rig.out("points.csv"))))
    {
        const TrueView& view = views.at("measure1/" + row.image + ".png");
        const cv::Vec3d error = row.point - view.inCamera1(board[row.id]);
        squares += error.dot(error);
        for (int i = 0; i < 3; i++)
            inSigma += std::pow(error[i]/row.sigma[i], 2)/3;
        count++;
    }
    REQUIRE(count == 3*54);
    std::cout << "[numbers] points through domes: RMS error " << std::sqrt(squares/count) << " mm, of stated "
              << std::sqrt(inSigma/count) << '\n';
    CHECK(std::sqrt(squares/count) < 0.5);
    CHECK(std::sqrt(inSigma/count) < 2.);           // calibration errors are common to all points
    CHECK(std::sqrt(inSigma/count) > 0.2);

    const std::string check = "refract_check " + rig.out("calib.yml") + BOARD + rig.pairsOf("1", "") + rig.pairsOf("2", "2")
        + " --detect=1";
    const ToolResult same = runTool(check);
    INFO(same.out << same.err);
    CHECK(same.code == 0);
    CHECK(mentions(same.out, "dome of camera 1"));
    CHECK(mentions(same.out, "no sign of it"));
}

namespace {

//! Each of what is given of a rig, drawn from what refract_calib assumes where nothing is said.
std::string drawnScene(cv::RNG& random, int number)
{
    std::string rig = scene();
    const auto draw = [&](const std::string& before, double nominal, double sigma)      // each occurrence another
    {
        for (size_t at = 0; (at = rig.find(before, at)) != std::string::npos; )
        {
            size_t end = at + before.size();
            end += std::strspn(rig.c_str() + end, "0123456789.");
            const std::string drawn = before + cv::format("%.6f", nominal + random.gaussian(sigma));
            rig.replace(at, end - at, drawn);
            at += drawn.size();
        }
    };
    draw("radius: ", 50, 0.1);
    draw("thickness: [ ", 5, 0.1);
    draw("index: [ ", 1.49, 0.001);
    draw("square: ", 25, 0.0005*25);
    const double water = 1.333 + random.gaussian(0.001);        // both cameras are in it
    draw("outer_index: ", water, 0);
    // A turn about where the boards are, and 0.02 mm.
    const std::string motion = "rvec: [ 0., 0., 0. ], tvec: [ 0.02, -0.015, 0.02 ]", seed = "seed: 5";
    const double turnX = random.gaussian(0.02/130), turnY = random.gaussian(0.02/130), turnZ = random.gaussian(0.02/130), away = 500;
    rig.replace(rig.find(motion), motion.size(),
                cv::format("rvec: [ %.7f, %.7f, %.7f ], tvec: [ %.5f, %.5f, %.5f ]", turnX, turnY, turnZ,
                           random.gaussian(0.02) - turnY*away, random.gaussian(0.02) + turnX*away, random.gaussian(0.02)));
    rig.replace(rig.find(seed), seed.size(), cv::format("seed: %d", number));
    return rig;
}

} // namespace

TEST_CASE("Domes as delivered, from images: errors of centre and radius are what is stated", "[.monte-carlo]")
{
    const int trials = scenes::trials(20);
    double ofCenter = 0, ofRadius = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        cv::RNG random(8000 + trial);
        const Rendered rig(drawnScene(random, 8000 + trial));
        const ToolResult r = runTool(rig.calib() + DOME + "--no-cross-validation --quiet --out=" + rig.out("calib.yml"));
        CAPTURE(trial, r.out, r.err);
        REQUIRE(r.code == 0);
        const cv::FileStorage found(rig.out("calib.yml"), cv::FileStorage::READ), truth(rig.out("img/truth.yml"), cv::FileStorage::READ);
        for (const std::string camera : {"camera1", "camera2"})
        {
            cv::refract::GlassWindow is, expected;
            found[camera]["glass_window"] >> is;
            truth[camera]["glass_window"] >> expected;
            std::vector<double> std;
            found[camera]["glass_window_std"]["center"] >> std;
            for (int i = 0; i < 3; i++)
                ofCenter += std::pow((is.center[i] - expected.center[i])/std[i], 2)/(6*trials);
            ofRadius += std::pow((is.radius - expected.radius)/(double)found[camera]["glass_window_std"]["radius"], 2)/(2*trials);
        }
    }
    std::cout << "[numbers] two domes in water as delivered, " << trials << " rendered rigs: error over stated, centre "
              << std::sqrt(ofCenter) << ", radius " << std::sqrt(ofRadius) << std::endl;
    CHECK(std::abs(ofCenter - 1) < 4*std::sqrt(2./(2*trials)));         // a camera's coordinates may be one
    CHECK(std::abs(ofRadius - 1) < 4*std::sqrt(2./(2*trials)));
}

TEST_CASE("Two cameras in one dome, from images to its centre", "[tools][dome]")
{
    // What camera 2 sees of it: R center1 + T.
    const Rendered rig(scene("[ 62., -2., -8. ]", "[ -57.763216, 0., 20.881486 ]", "200.05"));
    const ToolResult r = runTool(rig.calib() + " --window=dome --radius=200 --center=60,0,0 --shared-window --thickness=5 --index=1.49 "
                                 "--outer-index=1.333 --no-cross-validation --quiet --out=" + rig.out("calib.yml"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    const cv::FileStorage file(rig.out("calib.yml"), cv::FileStorage::READ);
    const cv::Vec3d expected[] = {cv::Vec3d(62, -2, -8), cv::Vec3d(-57.763216, 0, 20.881486)};
    for (int k : {0, 1})
    {
        cv::refract::GlassWindow window;
        std::vector<double> std;
        const cv::FileNode camera = file[k ? "camera2" : "camera1"];
        camera["glass_window"] >> window;
        camera["glass_window_std"]["center"] >> std;
        REQUIRE(std.size() == 3);
        std::cout << "[numbers] one dome, camera " << k + 1 << ": centre off by " << window.center - expected[k] << ", stated " << std[0]
                  << ", " << std[1] << ", " << std[2] << '\n';
        for (int i = 0; i < 3; i++)
            CHECK(std::abs(window.center[i] - expected[k][i]) < 4*std[i]);
    }
}

TEST_CASE("refract_check names the dome that moved", "[tools][dome]")
{
    const Rendered now(scene("[ 3.8, -2., 6. ]"));
    std::string before = readFile(now.out("img/truth.yml"));
    const size_t at = before.find("center: [ 3.7");
    REQUIRE(at != std::string::npos);
    before.replace(at, before.find(']', at) + 1 - at, "center: [ 3., -2., 6. ]");
    writeFile(now.out("calib.yml"), before);
    const ToolResult r = runTool("refract_check " + now.out("calib.yml") + " --size=9x6 --square=25.003" + now.pairsOf("1", "")
                                 + now.pairsOf("2", "2") + " --pixel-sigma=0.03 --detect=1");
    INFO(r.out << r.err);
    CHECK(r.code == 2);
    CHECK(mentions(r.out, "dome of camera 1 moved by 0.8"));
    CHECK(mentions(r.out, "moved"));
}

TEST_CASE("A dome that is given wrongly is refused, or told", "[tools][dome]")
{
    const Rendered rig(scene());
    struct Case { std::string options, says; };
    for (const Case& c : {Case{" --window=dome --thickness=5 --index=1.49", "--window=dome needs --radius"},
                          Case{" --radius=50 --thickness=5 --index=1.49", "add --window=dome or --window=tube"},
                          Case{" --window=ball --radius=50 --thickness=5 --index=1.49", "--window: ball not in"},
                          Case{DOME + std::string("--center=0,0,60"), "outside its radius of 50"},
                          Case{DOME + std::string("--center=0,0"), "give three numbers"},
                          Case{DOME + std::string("--distance=5"), "--distance is of a flat window"},
                          Case{DOME + std::string("--wedge-std=1"), "--wedge-std is of a flat window"},
                          Case{DOME + std::string("--bow-std=1"), "--bow-std is of a flat window"},
                          Case{DOME + std::string("--free=wedge"), "--free=wedge is of a flat window"},
                          Case{DOME + std::string("--free=curvature"), "say --free=radius"},
                          Case{DOME + std::string("--max-normal-std=1"), "has no normal"},
                          Case{DOME + std::string("--axis=0,1,0"), "--axis is of a tube"},
                          Case{" --window=tube --radius=50 --thickness=5 --index=1.49", "--window=tube needs --axis"},
                          Case{" --window=bent --thickness=5 --index=1.49", "--bow-std=2"},
                          Case{" --radius-std=1 --thickness=5 --index=1.49", "--radius-std is of a dome or tube"}})
    {
        const ToolResult r = runTool(rig.calib() + c.options + " --out=" + rig.out("calib.yml") + " --quiet");
        INFO(c.options << "\n" << r.out << r.err);
        CHECK(r.code == 1);
        CHECK(mentions(r.err, c.says));
        CHECK(!std::filesystem::exists(rig.out("calib.yml")));
    }
    // The outer radius in place of the inner one.
    const ToolResult r = runTool(rig.calib() + " --window=dome --radius=55 --thickness=5 --index=1.49 --outer-index=1.333 "
                                 "--no-cross-validation --quiet --out=" + rig.out("calib.yml"));
    INFO(r.out << r.err);
    CHECK(r.code != 0);
    CHECK(mentions(r.err, "--radius"));
    CHECK(mentions(r.err, "is that given of the outer face?"));
}

TEST_CASE("A camera in a tube, from images to the tube", "[tools][dome]")
{
    const Rendered rig(oneCamera("{ shape: tube, center: [ 4., 0., 6. ], axis: [ 0.05, 0.99812, 0.03533 ], radius: 60.05, "
                                 "thickness: [ 3.95 ], index: [ 1.4904 ], outer_index: 1.3334 }"));
    const ToolResult r = runTool(rig.one() + " --window=tube --radius=60 --axis=0,1,0 --thickness=4 --index=1.49 --outer-index=1.333 "
                                 "--verbose --no-cross-validation --report=" + rig.out("r.html") + " --out=" + rig.out("calib.yml"));
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "camera off the axis, mm"));
    CHECK(mentions(readFile(rig.out("r.html")), "Seen from above"));
    cv::refract::GlassWindow is, expected;
    readWindows(rig, is, expected);
    CHECK(is.shape == cv::refract::WINDOW_TUBE);
    const cv::FileStorage file(rig.out("calib.yml"), cv::FileStorage::READ);
    std::vector<double> center, axis;
    file["glass_window_std"]["center"] >> center;
    file["glass_window_std"]["axis_deg"] >> axis;
    REQUIRE(center.size() == 3);
    REQUIRE(axis.size() == 2);
    // Centres are compared where they are nearest to the camera.
    const auto nearest = [](const cv::refract::GlassWindow& w) { return w.center - w.axis.dot(w.center)*w.axis; };
    const double turned = std::asin(cv::norm(is.axis.cross(expected.axis)))*180/CV_PI;
    const cv::Vec3d moved = nearest(is) - nearest(expected);
    std::cout << "[numbers] tube: axis off by " << turned << " degrees, stated " << axis[0] << "; centre off by " << moved << ", stated "
              << center[0] << ", " << center[1] << ", " << center[2] << '\n';
    CHECK(turned < 4*axis[0]);
    CHECK(std::abs(moved[0]) < 4*center[0]);
    CHECK(std::abs(moved[2]) < 4*center[2]);
    CHECK(cv::norm(moved) < 1);
}

TEST_CASE("A pane that is bent is found to be, within what is said of it", "[tools][dome]")
{
    const Rendered rig(oneCamera("{ shape: bent, normal: [ 0.1, -0.05, 0.993731 ], distance: 40., curvature: 2.4e-5, thickness: [ 20. ], "
                                 "index: [ 1.52 ] }"));
    const std::string call = rig.one() + " --thickness=20 --index=1.52 --thickness-std=0 --index-std=0 --wedge-std=0 --no-cross-validation "
                             "--verbose --out=" + rig.out("calib.yml");
    const ToolResult r = runTool(call + " --bow-std=3");
    INFO(r.out << r.err);
    REQUIRE(r.code == 0);
    CHECK(mentions(r.out, "bow, mm of sag per m"));
    cv::refract::GlassWindow is, expected;
    readWindows(rig, is, expected);
    CHECK(is.shape == cv::refract::WINDOW_BENT);
    const cv::FileStorage file(rig.out("calib.yml"), cv::FileStorage::READ);
    const double std = (double)file["glass_window_std"]["curvature"];
    std::cout << "[numbers] bent pane: curvature off by " << is.curvature - expected.curvature << ", stated " << std << '\n';
    CHECK(std > 0.);
    CHECK(std < 8.*3.*1.01/1e6);
    CHECK(std::abs(is.curvature - expected.curvature) < 3*std);
    const ToolResult flat = runTool(call);
    INFO(flat.err);
    cv::refract::GlassWindow without, same;
    readWindows(rig, without, same);
    CHECK(without.shape == cv::refract::WINDOW_FLAT);
}

TEST_CASE("Tools that only use a calibration take a dome", "[tools][dome]")
{
    const Rendered rig(scene());
    const std::string truth = rig.out("img/truth.yml"), first = rig.out("img/measure1/test1.png");
    const std::string second = rig.out("img/measure2/test1.png");
    for (const std::string& command : {"refract_undistort " + truth + " " + first + " --depth=500 --out-dir=" + rig.out("undistorted"),
                                       "refract_epilines " + truth + " " + first + " " + second + BOARD + " --out=" + rig.out("lines.png"),
                                       "refract_export " + truth + " --to=colmap --depth=380,650 --out-dir=" + rig.out("model")})
    {
        const ToolResult r = runTool(command);
        INFO(command << "\n" << r.out << r.err);
        CHECK(r.code == 0);
    }
}
