// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What other programs wrote, and how they name images, as a user gives it to the tools.
#include "paths.hpp"
#include "run_tool.hpp"
#include "temporary_folder.hpp"
#include <opencv2/refract.hpp>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

using namespace cv;
using namespace cv::refract;

namespace {

const std::string DATA = paths::bundled() + "/stereo", BOARD = " --size=6x5 --square=39";

void save(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string withoutName(const std::string& csv) { return csv.substr(csv.find(',')); }

} // namespace

TEST_CASE("refract_calib takes the lens of another program's file as it takes its own", "[tools][foreign]")
{
    const TemporaryFolder f;
    const Ptr<RefractiveCamera> lens = RefractiveCamera::read(DATA + "/truth.yml", "camera1");
    const Mat K = lens->cameraMatrix(), D = lens->distCoeffs();
    RefractiveCamera::create(K, D)->save(f / "own.yml");
    std::string text = format("{\"mtx\": [[%.17g, 0, %.17g], [0, %.17g, %.17g], [0, 0, 1]], \"dist\": [[", K.at<double>(0, 0),
                              K.at<double>(0, 2), K.at<double>(1, 1), K.at<double>(1, 2));
    for (int i = 0; i < (int)D.total(); i++)
        text += format(i ? ", %.17g" : "%.17g", D.at<double>(i));
    save(f / "python.json", text + "]]}");
    std::vector<Vec3d> normals;
    for (const char* name : {"own.yml", "python.json"})
    {
        const ToolResult r = runTool("refract_calib" + BOARD + " --thickness=20 --index=1.5437 --no-cross-validation --direct='" + DATA
                                     + "/direct1/pair[1-3].jpg' --glass='" + DATA + "/glass1/pair[1-3].jpg' --camera=" + (f / name)
                                     + " --out=" + (f / "calib.yml"));
        CAPTURE(name, r.err);
        REQUIRE(r.code == 0);
        normals.push_back(RefractiveCamera::read(f / "calib.yml")->window().normal);
    }
    CHECK(norm(normals[0], normals[1]) < 1e-12);
}

TEST_CASE("A file of another program that is cut short ends in exit code 1, and is named", "[tools][foreign]")
{
    const TemporaryFolder f;
    save(f / "chain.yaml", "cam0:\n  camera_model: pinhole\n  intrinsics: [900, 900, 640, 480]\n");
    const std::string said = "looks like Kalibr's camchain, but there is no 'distortion_model'";
    const ToolResult calib = runTool("refract_calib" + BOARD + " --thickness=20 --index=1.5 --glass='" + DATA
                                     + "/glass1/pair1.jpg' --camera=" + (f / "chain.yaml") + " --out=" + (f / "calib.yml"));
    CHECK(calib.code == 1);
    CHECK(mentions(calib.err, said));
    const ToolResult measure = runTool("refract_measure " + (f / "chain.yaml") + " --points=x.csv --out=" + (f / "o.csv"));
    CHECK(measure.code == 1);
    CHECK(mentions(measure.err, said));
    save(f / "two.json", "{\"K1\": [[900,0,640],[0,900,480],[0,0,1]], \"D1\": [0,0,0,0,0], \"K2\": [[900,0,640],[0,900,480],[0,0,1]], "
                         "\"D2\": [0,0,0,0,0]}");
    const ToolResult unplaced = runTool("refract_measure " + (f / "two.json") + " --points=x.csv --out=" + (f / "o.csv"));
    CHECK(unplaced.code == 1);
    CHECK(mentions(unplaced.err, "has 2 cameras, and does not say where they are from each other"));
    CHECK(f.count() == 2);
}

TEST_CASE("refract_measure finds pairs where each camera has its own part in the names", "[tools][foreign]")
{
    const TemporaryFolder f;
    for (int i : {1, 2})
        for (int camera : {1, 2})
            std::filesystem::create_symlink(std::filesystem::absolute(DATA + format("/measure%d/z600_%d.jpg", camera, i)),
                                            f / format(camera == 1 ? "left%02d.jpg" : "right%02d.jpg", i));
    const std::string command = "refract_measure " + DATA + "/truth.yml" + BOARD;
    const ToolResult named = runTool(command + " '" + (f / "left*.jpg") + "' '" + (f / "right*.jpg") + "' --out=" + (f / "named.csv"));
    CAPTURE(named.err);
    REQUIRE(named.code == 0);
    const ToolResult usual = runTool(command + " '" + DATA + "/measure1/z600_[12].jpg' '" + DATA + "/measure2/z600_[12].jpg' --out="
                                     + (f / "usual.csv"));
    REQUIRE(usual.code == 0);
    std::ifstream first(f / "named.csv"), second(f / "usual.csv");
    int rows = 0;
    for (std::string a, b; std::getline(first, a) && std::getline(second, b); rows++)
        CHECK(withoutName(a) == withoutName(b));
    CHECK(rows == 1 + 2*30);
}
