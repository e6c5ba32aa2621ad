// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Colours that a window in front of water draws apart, and what brings them together again.
#include "depth_comparison.hpp"
#include "run_tool.hpp"
#include "truth_file.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>
#include <cmath>
#include <iostream>

using namespace cv;
using cv::refract::GlassWindow;
using cv::refract::refractiveIndex;

namespace {

//! A camera in air behind 10 mm of glass, water on the other side; what it sees stands 1.2 m away, its middle 25 degrees off axis.
std::string boardScene(const std::string& channels, const std::string& window)
{
    return R"(%YAML:1.0
---
target: { pattern: chessboard, size: "5x7", square: 30. }
image_width: 1600
image_height: 500
camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 1400., 0., 799.5, 0., 1400., 249.5, 0., 0., 1. ] }
distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ 0., 0., 0., 0. ] }
glass_window: { normal: [ 0., 0., 1. ], distance: 40., thickness: [ 10. ], )" + window + R"( }
exposure: { noise: 0.3, blur: 0.6 }
)" + channels + R"(
poses:
   right: [ { rvec: [ 0.06, 0.1, 0.05 ], tvec: [ 340., -85., 1200. ] } ]
   left: [ { rvec: [ -0.06, 0.1, -0.03 ], tvec: [ -455., -85., 1200. ] } ]
sets:
   glass: { window: 1, poses: [ right, left ] }
)";
}

const char* const MATERIALS = "wavelength: 540., materials: [ air, N-BK7, water ]";

std::vector<Point2d> cornersIn(const Mat& image, const std::vector<Point2d>& near)
{
    Mat grey;
    image.convertTo(grey, CV_8U);
    std::vector<Point2f> corners(near.begin(), near.end());
    cornerSubPix(grey, corners, Size(9, 9), Size(-1, -1), TermCriteria(TermCriteria::EPS + TermCriteria::COUNT, 100, 1e-4));
    return std::vector<Point2d>(corners.begin(), corners.end());
}

double rmsBetween(const std::vector<Point2d>& a, const std::vector<Point2d>& b)
{
    return std::sqrt(norm(a, b, NORM_L2SQR)/(double)a.size());
}

//! RMS distance between a board's corners in red and in blue.
double apart(const Mat& image, const std::vector<Point2d>& near)
{
    REQUIRE(image.channels() == 3);
    Mat channels[3];
    split(image, channels);
    return rmsBetween(cornersIn(channels[2], near), cornersIn(channels[0], near));
}

//! Where a pinhole sees the board.
std::vector<Point2d> pinholePixels(const TrueView& view)
{
    std::vector<Point2d> pixels;
    for (const Point3d& p : chessboard(5, 7, 30.))
    {
        const Vec3d x = view.inCamera1(p);
        pixels.emplace_back(799.5 + 1400*x[0]/x[2], 249.5 + 1400*x[1]/x[2]);
    }
    return pixels;
}

struct Apart
{
    double raw, together, oneMap;       //!< as taken; each colour corrected by itself; all as one
    double off;                         //!< of the corrected ones from the pinhole's
};

Apart correct(const std::string& wavelengths)
{
    const TemporaryFolder f;
    writeFile(f / "rig.yml", boardScene("channels: [ " + wavelengths + " ]", MATERIALS));
    const ToolResult rendered = runTool("refract_simulate " + (f / "rig.yml") + " --out-dir=" + (f / "s"));
    INFO(rendered.err);
    REQUIRE(rendered.code == 0);
    Apart sum = {0, 0, 0, 0};
    for (const std::string name : {"right1.png", "left1.png"})
    {
        const TrueView view = readTruth(f / "s").at("glass/" + name);
        const std::string call = "refract_undistort " + (f / "s/truth.yml") + " " + (f / "s/glass/") + name + view.planeOption();
        const ToolResult one = runTool(call + " --out-dir=" + (f / "one"));
        const ToolResult each = runTool(call + " --channels=" + wavelengths + " --out-dir=" + (f / "each"));
        INFO(one.err << each.err);
        REQUIRE((one.code == 0 && each.code == 0));
        CHECK(mentions(one.out, "corrected in the light of the calibration, 540 nm"));
        CHECK(mentions(each.out, "corrected each colour by itself"));
        const std::vector<Point2d> pinhole = pinholePixels(view);
        const Mat corrected = imread(f / "each/" + name);
        sum.raw += 0.5*apart(imread(f / "s/glass/" + name), view.pixels);
        sum.oneMap += 0.5*apart(imread(f / "one/" + name), pinhole);
        sum.together += 0.5*apart(corrected, pinhole);
        for (int channel = 0; channel < 3; channel++)
        {
            Mat grey;
            extractChannel(corrected, grey, channel);
            sum.off = std::max(sum.off, rmsBetween(cornersIn(grey, pinhole), pinhole));
        }
    }
    return sum;
}

} // namespace

TEST_CASE("Red and blue edges 25 degrees off axis in water come together", "[tools][colours]")
{
    const struct { const char* name; const char* wavelengths; double least; } cases[] = {
        {"a usual sensor's", "610,540,465", 3.}, {"the visible's ends", "690,540,410", 5.}};
    for (const auto& c : cases)
    {
        const Apart a = correct(c.wavelengths);
        std::cout << format("[numbers] red and blue corners 25 degrees off axis, water, f = 1400 px, %s (%s nm): %.2f px apart; one map "
                            "for all: %.2f; each its own: %.3f; these from the pinhole's: %.3f\n", c.name, c.wavelengths, a.raw,
                            a.oneMap, a.together, a.off);
        CHECK(a.raw > c.least);
        CHECK(a.oneMap > 0.6*a.raw);            // without water the image is smaller
        CHECK(a.together < 0.1);
        CHECK(a.off < 0.1);
    }
}

TEST_CASE("Each channel that is rendered is seen through a window of its indices", "[tools][colours]")
{
    const TemporaryFolder f;
    writeFile(f / "rig.yml", boardScene("channels: [ 610., 540., 465. ]", MATERIALS));
    REQUIRE(runTool("refract_simulate " + (f / "rig.yml") + " --out-dir=" + (f / "s")).code == 0);
    const TrueView view = readTruth(f / "s").at("glass/right1.png");
    const Mat image = imread(f / "s/glass/right1.png"), K = (Mat_<double>(3, 3) << 1400, 0, 799.5, 0, 1400, 249.5, 0, 0, 1);
    const double wavelengths[] = {465, 540, 610};
    for (int channel = 0; channel < 3; channel++)
    {
        const double nm = wavelengths[channel];
        const GlassWindow window(Vec3d(0, 0, 1), 10, refractiveIndex("N-BK7", nm), 40, refractiveIndex("water", nm));
        std::vector<Point2d> expected;
        cv::refract::refractiveProjectPoints(chessboard(5, 7, 30.), view.rvec, view.tvec, K, noArray(), window, expected);
        Mat grey;
        extractChannel(image, grey, channel);
        CHECK(rmsBetween(cornersIn(grey, view.pixels), expected) < 0.05);
    }
}

TEST_CASE("What a channel's band leaves: pixels by nanometre of its light's middle", "[colours]")
{
    const Mat K = (Mat_<double>(3, 3) << 1400, 0, 799.5, 0, 1400, 249.5, 0, 0, 1);
    const Vec3d far(1200*std::tan(std::asin(std::sin(25*CV_PI/180)/1.334)), 0, 1200);
    GlassWindow window(Vec3d(0, 0, 1), 10, 1.5, 40);
    window.materials = {"air", "N-BK7", "water"};
    const auto pixel = [&](double nm) {
        std::vector<Point2d> pixels;
        cv::refract::refractiveProjectPoints(std::vector<Point3d>{far}, Vec3d(), Vec3d(), K, noArray(), window.atWavelength(nm),
                                             pixels);
        return pixels[0].x;
    };
    const struct { const char* name; double nm; } channels[] = {{"red", 610}, {"green", 540}, {"blue", 465}};
    for (const auto& c : channels)
    {
        const double perNm = (pixel(c.nm - 5) - pixel(c.nm + 5))/10;
        // x = f tan(asin(n sin w)), all of the way in water
        const double indexPerNm = (refractiveIndex("water", c.nm - 5) - refractiveIndex("water", c.nm + 5))/10;
        const double inWater = std::sin(25*CV_PI/180)/1.334, expected = 1400*indexPerNm*inWater/std::pow(std::cos(25*CV_PI/180), 3);
        std::cout << format("[numbers] %s, %g nm, 25 degrees off axis in water, f = 1400 px: %.4f px by nm; a band of +-35 nm is %.2f px "
                            "wide\n", c.name, c.nm, perNm, pixel(c.nm - 35) - pixel(c.nm + 35));
        CHECK(perNm == Approx(expected).epsilon(0.1));
    }
}

TEST_CASE("A calibration from one channel says so, and is right in the others by their wavelengths", "[tools][colours]")
{
    const TemporaryFolder f;
    std::string scene = boardScene("channels: [ 610., 540., 465. ]", MATERIALS);
    scene = scene.substr(0, scene.find("poses:")) + R"(poses:
   lens: { count: 8, distance: [ 500., 800. ], tilt_deg: [ 10., 35. ], roll_deg: 20. }
   pair: { count: 5, distance: [ 450., 800. ], tilt_deg: [ 10., 35. ], roll_deg: 20. }
sets:
   direct: { window: 0, poses: [ lens, pair ] }
   glass: { window: 1, poses: [ pair ] }
)";
    writeFile(f / "rig.yml", scene);
    REQUIRE(runTool("refract_simulate " + (f / "rig.yml") + " --out-dir=" + (f / "s")).code == 0);
    const std::string calib = "refract_calib --size=5x7 --square=30 --direct='" + (f / "s/direct/*.png") + "' --glass='"
        + (f / "s/glass/*.png") + "' --no-cross-validation --thickness=10 --index=N-BK7 --outer-index=water";
    const ToolResult green = runTool(calib + " --channel=green --verbose --out=" + (f / "green.yml"));
    INFO(green.out << green.err);
    REQUIRE(green.code == 0);
    CHECK(mentions(green.out, "green channel"));
    CHECK(mentions(green.out, "the index of water at 540 nm"));
    CHECK(mentions(green.out, "0.0011 (N-BK7, light of 505 to 575 nm)"));
    CHECK(mentions(readFile(f / "green.yml"), "channel: green"));

    const auto found = cv::refract::RefractiveCamera::read(f / "green.yml");
    CHECK(found->window().wavelength == 540.);
    CHECK(found->window().materials == std::vector<String>{"", "N-BK7", "water"});
    for (const auto& view : readTruth(f / "s"))
        if (view.first.find("glass/") == 0)
        {
            Mat channels[3];
            split(imread(f / ("s/" + view.first)), channels);
            const double wavelengths[] = {465, 540, 610};
            Vec3d rvec, tvec;
            REQUIRE(cv::refract::refractiveSolvePnP(chessboard(5, 7, 30.), cornersIn(channels[1], view.second.pixels), found, rvec, tvec));
            for (int channel = 0; channel < 3; channel++)
            {
                const auto camera = found->clone();
                camera->setWindow(found->window().atWavelength(wavelengths[channel]));
                std::vector<Point2d> seen;
                cv::refract::refractiveProjectPoints(chessboard(5, 7, 30.), rvec, tvec, camera, seen);
                CAPTURE(view.first, channel);
                CHECK(rmsBetween(cornersIn(channels[channel], view.second.pixels), seen) < 0.1);
            }
        }

    // What is measured is looked for in the same channel: its pose is the true one.
    const ToolResult measured = runTool("refract_measure " + (f / "green.yml") + " " + (f / "s/glass/pair1.png")
                                        + " --size=5x7 --square=30 --out=" + (f / "points.csv"));
    INFO(measured.out << measured.err);
    REQUIRE(measured.code == 0);
    CHECK(mentions(measured.out, "green channel"));
    CHECK(mentions(runTool(calib + " --channel=infrared --out=" + (f / "x.yml")).err, "--channel"));
}

TEST_CASE("refract_stereo rectifies each colour by itself", "[tools][colours][stereo]")
{
    const TemporaryFolder f;
    std::string rig = readFile(paths::bundled() + "/water/rig.yml");
    // A quarter of the pixels, for a test.
    for (const auto& change : std::vector<std::pair<std::string, std::string>>{
             {"image_width: 1280", "image_width: 640"}, {"image_height: 960", "image_height: 480"},
             {"1040., 0., 641.3, 0., 1040.4, 476.2", "520., 0., 320.4, 0., 520.2, 237.9"},
             {"1043., 0., 637.9, 0., 1042.8, 483.5", "521.5, 0., 318.7, 0., 521.4, 241.5"}})
        for (size_t at; (at = rig.find(change.first)) != std::string::npos; )
            rig.replace(at, change.first.size(), change.second);
    writeFile(f / "rig.yml", rig);
    REQUIRE(runTool("refract_simulate " + (f / "rig.yml") + " --out-dir=" + (f / "s")).code == 0);
    const std::string call = "refract_stereo " + (f / "s/truth.yml") + " " + (f / "s/room1/scene.png") + " " + (f / "s/room2/scene.png")
        + " --depth=550,1450 --depth-map=" + (f / "d.tiff");
    const auto rms = [&](const ToolResult& result) {
        INFO(result.out << result.err);
        REQUIRE(result.code == 0);
        return compareDepths(imread(f / "d.tiff", IMREAD_UNCHANGED), imread(f / "s/room1/scene_depth.tiff", IMREAD_UNCHANGED)).rms;
    };
    const double one = rms(runTool(call)), each = rms(runTool(call + " --channels=610,540,465"));
    CHECK(each < one);
    CHECK(each < 4.);
    const ToolResult grey = runTool(call + " --channels=610");
    CHECK(grey.code == 1);
    CHECK(mentions(grey.err, "red, green and blue"));
}

TEST_CASE("Colours are refused where nothing tells of them, with one sentence", "[tools][colours]")
{
    const TemporaryFolder f;
    writeFile(f / "unknown.yml", boardScene("channels: [ 610., 540., 465. ]", "index: [ 1.52 ], outer_index: 1.333"));
    writeFile(f / "order.yml", boardScene("channels: [ 465., 540., 610. ]", MATERIALS));
    writeFile(f / "ultraviolet.yml", boardScene("channels: [ 610., 540., 365. ]", MATERIALS));
    writeFile(f / "material.yml", boardScene("", "materials: [ air, N-BK8, water ]"));
    writeFile(f / "grey.yml", boardScene("", MATERIALS));
    const std::string simulate = "refract_simulate ", out = " --out-dir=" + (f / "s");
    REQUIRE(runTool(simulate + (f / "grey.yml") + " --out-dir=" + (f / "g")).code == 0);
    const std::string undistort = "refract_undistort " + (f / "g/truth.yml") + " " + (f / "g/glass/right1.png") + " --depth=1200" + out;
    const struct { std::string call, mentioned; } cases[] = {
        {simulate + (f / "unknown.yml") + out, "unknown.yml' does not name the window's materials"},
        {simulate + (f / "order.yml") + out, "red, green and blue"},
        {simulate + (f / "ultraviolet.yml") + out, "365"},
        {simulate + (f / "material.yml") + out, "N-BK7"},
        {undistort + " --channels=610,540,465", "right1.png' is a grey image"},
        {undistort + " --channels=465,540,610", "--channels=465,540,610"},
        {undistort + " --channels=610,540", "--channels=610,540"},
        {undistort + " --channels=a,b,c", "--channels"}};
    for (const auto& c : cases)
    {
        CAPTURE(c.call);
        const ToolResult result = runTool(c.call);
        CHECK(result.code == 1);
        CHECK(result.out.empty());
        CHECK(mentions(result.err, c.mentioned));
        CHECK_FALSE(std::filesystem::exists(f / "s"));
    }
}
