// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Lens files of names and values: each lens against the formula of the program that wrote it.
#include "formats/foreign_files.hpp"

using cv::refract::RefractiveCamera;
using tools::ForeignRig;
using tools::readForeignRig;

namespace {

const Distortion BROWN = brown(-0.11, 0.07, 0.001, -0.002, 0.013);
const std::string K = "[[1210.5, 0, 639.25], [0, 1190.25, 481.5], [0, 0, 1]]", D = "[[-0.11, 0.07, 0.001, -0.002, 0.013]]";

void requireSame(const ForeignRig& rig) { requireLens(rig.cameras.at(0), BROWN, 1210.5, 1190.25, 639.25, 481.5); }

} // namespace

TEST_CASE("A camera matrix and coefficients are read by any of their usual names, of JSON and of YAML in every style", "[foreign]")
{
    TemporaryFolder f;
    for (const char* matrix : {"camera_matrix", "K", "mtx", "cameraMatrix"})
        for (const char* distortion : {"distortion_coefficients", "dist", "D", "distCoeffs", "dist_coeff"})
            requireSame(rigOf(f, std::string("{\"") + matrix + "\": " + K + ", \"" + distortion + "\": " + D + "}"));
    requireSame(rigOf(f, "{\"K\": " + K + ", \"\\\"NaN\": \"NaN\", \"rms\": NaN, \"D\": " + D + "}"));       // as Python writes it
    requireSame(rigOf(f, "mtx: " + K + "\ndist: " + D + "\n"));
    requireSame(rigOf(f, "mtx: " + K + "\rdist: " + D + "\r"));
    requireSame(rigOf(f, "# made by hand\nmtx:\n- - 1210.5\n  - 0.0\n  - 639.25\n- - 0.0\n  - 1190.25\n  - 481.5\n- [0, 0, 1]\n"
                        "dist:\n  - -0.11\n  - 0.07   # k2\n  - 1e-3\n  - -0.002\n  - 0.013\n"));
    const ForeignRig below = rigOf(f, "{\"cameras\": [{\"name\": \"a\", \"K\": " + K + ", \"dist\": " + D
                                  + ", \"width\": 1280, \"height\": 960}]}");
    requireSame(below);
    CHECK(below.cameras[0]->imageSize() == cv::Size(1280, 960));
    requireLens(rigOf(f, "distortion_model: fisheye\nK: " + K + "\nD: [0.02, -0.01, 0.003, 0.001]\n").cameras[0],
                equidistant(0.02, -0.01, 0.003, 0.001), 1210.5, 1190.25, 639.25, 481.5);
}

TEST_CASE("A stereo pair of OpenCV's names has its place, of XML and YAML too", "[foreign]")
{
    TemporaryFolder f;
    const cv::Mat R = (cv::Mat_<double>(3, 3) << 0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8), T = (cv::Mat_<double>(3, 1) << -60, 1, 2);
    for (const char* name : {"stereo.yml", "stereo.xml", "stereo.json"})
    {
        {
            cv::FileStorage fs(f/name, cv::FileStorage::WRITE);
            fs << "cameraMatrix1" << (cv::Mat_<double>(3, 3) << 1210.5, 0, 639.25, 0, 1190.25, 481.5, 0, 0, 1) << "distCoeffs1"
               << (cv::Mat_<double>(1, 5) << -0.11, 0.07, 0.001, -0.002, 0.013) << "cameraMatrix2"
               << (cv::Mat_<double>(3, 3) << 900, 0, 320, 0, 900, 240, 0, 0, 1) << "distCoeffs2" << cv::Mat::zeros(1, 5, CV_64F)
               << "R" << R << "T" << T;
        }
        const auto rig = readForeignRig(f/name);
        REQUIRE(rig);
        REQUIRE(rig->cameras.size() == 2);
        requireSame(*rig);
        requireLens(rig->cameras[1], brown(0, 0, 0, 0), 900, 900, 320, 240);
        CHECK(cv::norm(rig->Rs[1], R) < 1e-15);
        CHECK(cv::norm(rig->Ts[1], T) < 1e-12);
    }
}

TEST_CASE("Cameras that each say where they are in one frame are related to the first", "[foreign]")
{
    TemporaryFolder f;
    const auto camera = [](const std::string& R, const std::string& t) {
        return "{\"K\": " + K + ", \"dist\": " + D + ", \"R\": " + R + ", \"t\": " + t + "}"; };
    const std::string I = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]", turned = "[[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]]";
    for (const std::string first : {"[0, 0, 0]", "[10, 0, 0]"})
    {
        const ForeignRig rig = rigOf(f, "{\"cam0\": " + camera(I, first) + ", \"cam1\": " + camera(turned, "[-60, 1, 2]") + "}");
        REQUIRE(rig.cameras.size() == 2);
        const cv::Mat R = (cv::Mat_<double>(3, 3) << 0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8);
        const double shift = first == "[0, 0, 0]" ? 0 : 10;
        const cv::Mat T = (cv::Mat_<double>(3, 1) << -60 - 0.8*shift, 1, 2 + 0.6*shift);
        CHECK(cv::norm(rig.Rs[1], R) < 1e-12);
        CHECK(cv::norm(rig.Ts[1], T) < 1e-9);
    }
}

TEST_CASE("refract's own files are left to the module", "[foreign]")
{
    TemporaryFolder f;
    const auto camera = RefractiveCamera::create(cv::Matx33d(900, 0, 320, 0, 900, 240, 0, 0, 1), cv::noArray());
    for (const char* name : {"own.yml", "own.xml", "own.json"})
    {
        camera->save(f/name);
        CHECK_FALSE(readForeignRig(f/name));
    }
}

TEST_CASE("ROS's camera_info is read", "[foreign]")
{
    TemporaryFolder f;
    const auto block = [](const std::string& name, int rows, int columns, const std::string& data)
    { return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) + "\n  data: [" + data + "]\n"; };
    const std::string head = "image_width: 1280\nimage_height: 960\ncamera_name: left\n"
        + block("camera_matrix", 3, 3, "1210.5, 0, 639.25, 0., 1190.25, 481.5, 0,\n         0, 1"), tail = block("rectification_matrix",
                                                                                                                 3, 3,
        "1, 0, 0, 0, 1, 0, 0, 0, 1") + block("projection_matrix", 3, 4, "1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0");
    const ForeignRig plumb = rigOf(f, head + "distortion_model: plumb_bob\n"
                                  + block("distortion_coefficients", 1, 5, "-0.11, 0.07, 0.001, -0.002, 0.013") + tail);
    requireSame(plumb);
    CHECK(plumb.format == "ROS's camera_info");
    CHECK(plumb.cameras[0]->imageSize() == cv::Size(1280, 960));
    requireLens(rigOf(f, head + "distortion_model: rational_polynomial\n"
                     + block("distortion_coefficients", 1, 8, "-0.11, 0.07, 0.001, -0.002, 0.013, 0.1, 0.02, 0.003") + tail).cameras[0],
                brown(-0.11, 0.07, 0.001, -0.002, 0.013, 0.1, 0.02, 0.003), 1210.5, 1190.25, 639.25, 481.5);
    requireLens(rigOf(f, head + "distortion_model: equidistant\n" + block("distortion_coefficients", 1, 4, "0.02, -0.01, 0.003, 0.001")
                     + tail).cameras[0], equidistant(0.02, -0.01, 0.003, 0.001), 1210.5, 1190.25, 639.25, 481.5);
    CHECK(refusal(saved(f, "x", head + "distortion_model: division\n" + block("distortion_coefficients", 1, 1, "0.1")))
          == "'" + f/"x" + "' looks like ROS's camera_info, but its distortion_model 'division' has no equal among OpenCV's");
}

TEST_CASE("Kalibr's camchain is read, each camera from the one before it", "[foreign]")
{
    TemporaryFolder f;
    const std::string first = "cam0:\n  cam_overlaps: [1, 2]\n  camera_model: pinhole\n"
        "  distortion_coeffs: [-0.11, 0.07, 0.001, -0.002]\n  distortion_model: radtan\n  intrinsics: [1210.5, 1190.25, 639.25, 481.5]\n"
        "  resolution: [1280, 960]\n  rostopic: /cam0/image_raw\n",
        second = "cam1:\n  T_cn_cnm1:\n  - [0.8, 0.0, 0.6, -0.06]\n  - [0.0, 1.0, 0.0, 0.001]\n  - [-0.6, 0.0, 0.8, 0.002]\n"
        "  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: [0.02, -0.01, 0.003, 0.001]\n  distortion_model: equi\n"
        "  intrinsics: [900, 901, 320, 240]\n  resolution: [640, 480]\n";
    std::string third = second;
    third.replace(0, 4, "cam2");
    const ForeignRig rig = rigOf(f, first + second + third);
    REQUIRE(rig.cameras.size() == 3);
    requireLens(rig.cameras[0], brown(-0.11, 0.07, 0.001, -0.002), 1210.5, 1190.25, 639.25, 481.5);
    requireLens(rig.cameras[1], equidistant(0.02, -0.01, 0.003, 0.001), 900, 901, 320, 240);
    CHECK(rig.cameras[1]->imageSize() == cv::Size(640, 480));
    const cv::Matx33d step(0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8);
    const cv::Vec3d t(-0.06, 0.001, 0.002);
    CHECK(cv::norm(rig.Rs[2], cv::Mat(step*step)) < 1e-15);
    CHECK(cv::norm(rig.Ts[2], cv::Mat(step*t + t)) < 1e-15);
    CHECK(refusal(saved(f, "x", "cam0:\n  camera_model: omni\n  intrinsics: [1, 2, 3, 4, 5]\n  distortion_model: radtan\n"))
          == "'" + f/"x" + "' looks like Kalibr's camchain, but its lens omni-radtan has no equal among OpenCV's: calibrate with "
             "pinhole-radtan or pinhole-equi");
    CHECK(refusal(saved(f, "x", first.substr(0, first.find("  intrinsics")) + "  intrinsics: [1, 2]\n"))
          == "'" + f/"x" + "' looks like Kalibr's camchain, but its intrinsics must have 4 numbers, and has 2");
}

TEST_CASE("DepthAI's calibration is read", "[foreign]")
{
    TemporaryFolder f;
    const std::string camera = "{\"cameraType\": 0, \"distortionCoeff\": [-0.11, 0.07, 0.001, -0.002, 0.013, 0.1, 0.02, 0.003, 0,0,0,0,0,0]"
        ", \"height\": 960, \"width\": 1280, \"intrinsicMatrix\": " + K + "}";
    const ForeignRig rig = rigOf(f, "{\"boardName\": \"x\", \"cameraData\": [[0, " + camera + "], [1, " + camera + "]]}");
    REQUIRE(rig.cameras.size() == 2);
    CHECK(rig.Rs.empty());
    requireLens(rig.cameras[1], brown(-0.11, 0.07, 0.001, -0.002, 0.013, 0.1, 0.02, 0.003), 1210.5, 1190.25, 639.25, 481.5);
}

TEST_CASE("What a file of names and values cannot mean is refused in a sentence", "[foreign]")
{
    TemporaryFolder f;
    const auto says = [&](const std::string& text) { return refusal(saved(f, "x", text)); };
    const std::string looks = "'" + f/"x" + "' looks like a file of OpenCV's camera matrix and coefficients, but ";
    CHECK(says("{\"K\": " + K + "}") == looks + "it has a camera matrix without coefficients of distortion: name them "
          "distortion_coefficients, distCoeffs, D or dist; of a lens without distortion five zeros");
    CHECK_THAT(says("K: " + K + "\nD: [0.1, 0.2, 0.3, 0.4]\n"), Catch::Contains("add distortion_model"));
    CHECK_THAT(says("K: [[1, 2], [3, 4]]\nD: [0]\n"), Catch::Contains("its K must have 9 numbers, and has 4"));
    CHECK_THAT(says("K: " + K + "\nD: none\n"), Catch::Contains("its D are not all numbers"));
    CHECK_THAT(says("{\"K\": [[NaN, 0, 50], [0, 100, 50], [0, 0, 1]], \"D\": [0]}"), Catch::Contains("its K must have 9 numbers"));
    CHECK_THAT(says("{\"K\": " + K + ", \"D\": [0, -Infinity]}"), Catch::Contains("its D are not all numbers"));
    CHECK_THAT(says("K: [[100, 7, 50], [0, 100, 50], [0, 0, 1]]\nD: [0, 0, 0, 0, 0]\n"), Catch::Contains("its lens cannot be one"));
    CHECK_THAT(says("name: 5\nother: [1, 2]\n"), Catch::Contains("looks like YAML, but there is no camera in it"));
    CHECK_THAT(says("{\"cameraType\": 0, \"distortionCoeff\": [-0.11, 0."), Catch::Contains("looks like JSON, but parse error at line 1"));
    CHECK_THAT(says("cam0:\n  camera_model: pinhole\n  intrinsics: [461.6, 46"), Catch::Contains("looks like YAML, but line 3: a bracket"));
    CHECK_NOTHROW(says("pt1_cam1_X,pt1_cam1_Y\n1,2\n"));      // is told by what reads refract's own files
    CHECK_NOTHROW(says("--- [\na\n"));             // a bracket in what is skipped
    CHECK_NOTHROW(says("% K = [1210 0 639\n%  0 1190 481\nhello\n"));
    CHECK_THAT(says("a:\n  K: " + K + "\n  D: [0, 0, 0, 0, 0]\n  R: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n  t: [0, 0, 0]\nb:\n  K: " + K
                    + "\n  D: [0, 0, 0, 0, 0]\n  R: [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]\n  t: [nan, 0, 0]\n"),
               Catch::Contains("camera 2") || Catch::Contains("t must have 3 numbers"));
    CHECK(says("hello").empty());
    CHECK(says("").empty());
}
