// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_stereo given what is wrong: a range of depths, a calibration, images. What it then writes is right, or nothing is written.
#include "programs/run_tool.hpp"
#include "calibrate/calib_file.hpp"
#include "calibrate/rig_model.hpp"
#include "depth_comparison.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <functional>
#include <iostream>

namespace fs = std::filesystem;
using namespace tools;
using cv::Mat;

namespace {

const double MOST_WRONG = 0.02;         // share of the points written that are over 2 % off

struct Pair
{
    Calibration rig;
    Mat left, right;
    Mat withoutWindow[2];
    std::string depth = "400,1300";
};

typedef std::function<void(Pair&)> Change;

struct Mistake
{
    std::string name, expected;         // expected: part of what is said; empty: anything
    Change make;
};

void setWindow(Pair& pair, int camera, const cv::refract::GlassWindow& window)
{
    auto& c = pair.rig.cameras[camera].camera;
    const cv::Size size = c->imageSize();
    c = copyWithWindow(c, window);
    c->setImageSize(size);
}

cv::refract::GlassWindow windowOf(const Pair& pair, int camera) { return pair.rig.cameras[camera].camera->window(); }

void thicken(Pair& pair, int camera, double by)
{
    cv::refract::GlassWindow window = windowOf(pair, camera);
    window.thickness[0] += by;
    setWindow(pair, camera, window);
}

void mirrorNormal(Pair& pair, int camera, int axis)
{
    cv::refract::GlassWindow window = windowOf(pair, camera);
    window.normal[axis] = -window.normal[axis];
    setWindow(pair, camera, window);
}

void exchangeWindows(Pair& pair)
{
    const auto first = windowOf(pair, 0), second = windowOf(pair, 1);
    setWindow(pair, 0, second);
    setWindow(pair, 1, first);
}

Change range(const std::string& depth) { return [=](Pair& p) { p.depth = depth; }; }

//! As cv::flip has it: 1 left and right, 0 top and bottom, -1 both.
Change flipped(bool left, bool right, int how)
{
    return [=](Pair& p) {
        if (left)
            cv::flip(p.left, p.left, how);
        if (right)
            cv::flip(p.right, p.right, how);
    };
}

Mat rolled(const Mat& image, double degrees)
{
    Mat result;
    const cv::Point2f middle(0.5f*(float)(image.cols - 1), 0.5f*(float)(image.rows - 1));
    cv::warpAffine(image, result, cv::getRotationMatrix2D(middle, degrees, 1), image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
    return result;
}

std::vector<Mistake> mistakes()
{
    std::vector<Mistake> all = {
        {"range 700,900", "lies outside", range("700,900")},
        {"range 400,1000", "lies outside", range("400,1000")},
        {"range 900,inf", "lies outside", range("900,inf")},
        {"range 600,650", "hardly anything", range("600,650")},
        {"range 1500,3000", "hardly anything", range("1500,3000")},
        {"range 200,400", "hardly anything", range("200,400")},
        {"windows exchanged", "the windows of cameras 1 and 2 are exchanged", exchangeWindows},
        {"cameras exchanged", "cameras 1 and 2 are exchanged", [](Pair& p) { std::swap(p.rig.cameras[0], p.rig.cameras[1]); }},
        {"R, T reversed", "from camera 2 to camera 1", [](Pair& p) {
            RigidTransform& T = p.rig.extrinsics[1];
            T.R = T.R.t();
            T.t = -(T.R*T.t); }},
        {"normals mirrored in x", "a tilt of both windows", [](Pair& p) { mirrorNormal(p, 0, 0); mirrorNormal(p, 1, 0); }},
        {"normals mirrored in y", "y of both normals", [](Pair& p) { mirrorNormal(p, 0, 1); mirrorNormal(p, 1, 1); }},
        {"normal 1 mirrored in x", "a tilt of the window of camera 1", [](Pair& p) { mirrorNormal(p, 0, 0); }},
        {"thicknesses 22 for 25", "another thickness of both windows", [](Pair& p) { thicken(p, 0, -3); thicken(p, 1, -3); }},
        {"thicknesses 28 for 25", "another thickness of both windows", [](Pair& p) { thicken(p, 0, 3); thicken(p, 1, 3); }},
        {"thickness 1 22 for 25", "another thickness of the window of camera 1", [](Pair& p) { thicken(p, 0, -3); }},
        {"thickness 2 28 for 25", "another thickness of the window of camera 2", [](Pair& p) { thicken(p, 1, 3); }},
        {"no windows", "images taken without the windows", [](Pair& p) { p.left = p.withoutWindow[0]; p.right = p.withoutWindow[1]; }},
        {"no window 1", "images of camera 1 taken without the window", [](Pair& p) { p.left = p.withoutWindow[0]; }},
        {"no window 2", "calibration and images do not fit", [](Pair& p) { p.right = p.withoutWindow[1]; }},
        {"images exchanged", "LEFT and RIGHT are swapped", [](Pair& p) { std::swap(p.left, p.right); }},
        {"both images mirrored", "both images are mirrored, left and right", flipped(true, true, 1)},
        {"both images upside down", "both images are mirrored, top and bottom", flipped(true, true, 0)},
        {"both images turned", "both images are turned by 180 degrees", flipped(true, true, -1)},
        {"LEFT mirrored", "LEFT is mirrored, left and right", flipped(true, false, 1)},
        {"RIGHT upside down", "RIGHT is mirrored, top and bottom", flipped(false, true, 0)},
        {"RIGHT turned", "RIGHT is turned by 180 degrees", flipped(false, true, -1)},
    };
    for (const double degrees : {0.3, 1., 3.})
    {
        all.push_back({cv::format("RIGHT rolled by %g", degrees), "off their rows",
                       [=](Pair& p) { p.right = rolled(p.right, degrees); }});
        all.push_back({cv::format("both rolled by %g", degrees), "off their rows",
                       [=](Pair& p) { p.left = rolled(p.left, degrees); p.right = rolled(p.right, degrees); }});
    }
    return all;
}

//! The bundled scene with its true depth.
class RenderedScene
{
public:
    RenderedScene()
    {
        const ToolResult rendered = runTool("refract_simulate " + paths::bundled() + "/scene/rig.yml --out-dir=" + (folder / "s"));
        INFO(rendered.err);
        REQUIRE(rendered.code == 0);
        pair.rig = readCalibration(folder / "s/truth.yml");
        pair.left = cv::imread(folder / "s/glass1/scene.png");
        pair.right = cv::imread(folder / "s/glass2/scene.png");
        for (int c = 0; c < 2; c++)
            pair.withoutWindow[c] = cv::imread(folder / cv::format("s/direct%d/scene.png", c + 1));
        truth = cv::imread(folder / "s/glass1/scene_depth.tiff", cv::IMREAD_UNCHANGED);
    }

    const TemporaryFolder folder;
    Pair pair;
    Mat truth;
};

struct Outcome
{
    ToolResult said;
    double written = 0, wrong = 0;      // shares: of the pixels; of those written
};

Outcome run(const Pair& pair, const Mat& truth)
{
    const TemporaryFolder folder;
    writeCalibration(folder / "calib.yml", pair.rig);
    cv::imwrite(folder / "left.png", pair.left);
    cv::imwrite(folder / "right.png", pair.right);
    Outcome outcome = {runTool("refract_stereo " + (folder / "calib.yml") + " " + (folder / "left.png") + " " + (folder / "right.png")
                               + " --depth=" + pair.depth + " --depth-map=" + (folder / "d.tiff")), 0, 0};
    if (!fs::exists(folder / "d.tiff"))
        return outcome;
    const Mat depth = cv::imread(folder / "d.tiff", cv::IMREAD_UNCHANGED);
    const DepthComparison comparison = compareDepths(depth, truth);
    outcome.written = (double)cv::countNonZero(depth == depth)/(double)depth.total();
    outcome.wrong = comparison.matched > 0 ? (double)comparison.wrong/comparison.matched : 0;
    return outcome;
}

} // namespace

TEST_CASE("Of what refract_stereo writes after a mistake at most 2 % is wrong, and the mistake is said", "[tools][stereo][mistakes][slow]")
{
    const RenderedScene scene;
    const Outcome right = run(scene.pair, scene.truth);
    CAPTURE(right.said.err);
    CHECK(right.said.code == 0);
    CHECK(right.said.err.empty());
    CHECK(right.written > 0.685);
    double most = 0;
    std::cout << cv::format("[numbers] refract_stereo, no mistake: %.1f %% written, %.2f %% of it wrong\n", 100*right.written,
                            100*right.wrong);
    for (const Mistake& mistake : mistakes())
    {
        Pair pair = scene.pair;
        pair.left = scene.pair.left.clone();
        pair.right = scene.pair.right.clone();
        mistake.make(pair);
        Mat truth = scene.truth;
        if (mistake.name.find("both rolled") == 0)
            truth = rolled(truth, std::stod(mistake.name.substr(15)));
        const Outcome outcome = run(pair, truth);
        std::cout << cv::format("[numbers] refract_stereo, %s: exit %d, %.1f %% written, %.2f %% of it wrong\n", mistake.name.c_str(),
                                outcome.said.code, 100*outcome.written, 100*outcome.wrong);
        CAPTURE(mistake.name, outcome.said.out, outcome.said.err);
        CHECK((outcome.said.code == 1 || outcome.said.code == 2));
        CHECK((outcome.said.code == 2) == (outcome.written > 0));
        CHECK(outcome.wrong <= MOST_WRONG);
        CHECK(mentions(outcome.said.err, mistake.expected));
        CHECK(std::count(outcome.said.err.begin(), outcome.said.err.end(), '\n') == 1);
        CHECK_FALSE(mentions(outcome.said.out + outcome.said.err, "nan"));
        most = std::max(most, outcome.wrong);
    }
    std::cout << cv::format("[numbers] refract_stereo, most wrong of what is written after a mistake: %.2f %%\n", 100*most);
}
