// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// RefractiveCamera: making, changing, reading and writing.
#include "scenes.hpp"
#include "temporary_file.hpp"
#include "temporary_folder.hpp"

#include <opencv2/core/utils/filesystem.hpp>

#include <atomic>
#include <fcntl.h>
#include <fstream>
#include <sys/stat.h>
#include <thread>
#include <type_traits>
#include <unistd.h>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

std::vector<Vec2d> someProjections(const Ptr<RefractiveCamera>& camera)
{
    std::vector<Vec3d> points = { { 0, 0, 500 }, { 40, -30, 450 }, { -120, 80, 700 }, { 10, 200, 1e4 } };
    std::vector<Vec2d> pixels;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels);
    return pixels;
}

GlassWindow someWindow()
{
    GlassWindow w(Vec3d(0.1, -0.05, 1), 6, 1.52, 31.7, 1.333);
    w.thickness = { 6, 0.76, 6.1 };
    w.index = { 1.52, 1.48, 1.52 };
    return w;
}

} // namespace

TEST_CASE("A camera keeps what it was made of", "[camera]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const GlassWindow window = someWindow();
    const Ptr<RefractiveCamera> camera = makeCamera(kind, window);
    CHECK(largestDifference(camera->cameraMatrix(), kind.K) == 0);
    CHECK(camera->cameraMatrix().type() == CV_64FC1);
    CHECK(camera->distCoeffs().total() == kind.coefficients.size());
    if (!kind.coefficients.empty())
        CHECK(largestDifference(camera->distCoeffs(), kind.coefficients) == 0);
    CHECK(camera->lensModel() == kind.model);
    CHECK(largestDifference(camera->lensParameters(), kind.parameters()) == 0);
    CHECK(camera->window().normal == window.normal);
    CHECK(camera->window().thickness == window.thickness);
    CHECK(camera->imageSize() == Size());
}

TEST_CASE("A camera by name is the one of the model's own call", "[camera]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const Ptr<RefractiveCamera> camera = makeCamera(kind, someWindow());
    Ptr<RefractiveCamera> same;
    if (kind.isMrcal())
        same = RefractiveCamera::createMrcal(kind.model, kind.intrinsics(), someWindow());
    else if (kind.model == "fisheye")
        same = RefractiveCamera::createFisheye(kind.K, kind.coefficients, someWindow());
    else if (kind.model == "opencv")
        same = RefractiveCamera::create(kind.K, kind.coefficients, someWindow());
    else
        return;         // it has no call of its own
    CHECK(same->lensModel() == camera->lensModel());
    CHECK(largestDifference(same->lensParameters(), camera->lensParameters()) == 0);
    CHECK(largestDifference(someProjections(same), someProjections(camera)) == 0);
}

TEST_CASE("A wrong name, or what does not belong to it, is refused in calls and in files", "[camera]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1), skewed(1000, 3, 640, 0, 1000, 480, 0, 0, 1);
    const auto create = [&](const String& model, InputArray k, const std::vector<double>& d)
    {
        return thrown([&] { RefractiveCamera::createByName(model, k, d); });
    };
    const auto zeros = [](int count) { return std::vector<double>(count, 0.); };
    CHECK_THAT(create("pinhole", K, {}), Contains("lensModel is pinhole; known are opencv, fisheye, ")
               && Contains(", LENSMODEL_PINHOLE, "));
    CHECK_THAT(create("", K, {}), Contains("lensModel is ; known are"));
    CHECK_THAT(create("opencv", K, zeros(6)), Contains("distCoeffs has 6 values; opencv has 0, 4, 5, 8, 12 or 14"));
    CHECK_THAT(create("fisheye", K, zeros(5)), Contains("distCoeffs has 5 values; fisheye has 0 or 4"));
    CHECK_THAT(create("LENSMODEL_CAHVOR", K, zeros(4)), Contains("distCoeffs has 4 values; LENSMODEL_CAHVOR has 5"));
    for (const LensKind& kind : allLenses())
        if (kind.model != "fisheye")
            CHECK_THAT(create(kind.model, skewed, kind.coefficients), Contains("cameraMatrix(0, 1) is 3"));
    CHECK_THAT(thrown([&] { RefractiveCamera::createMrcal("fisheye", std::vector<double>(8, 1.)); }),
               Contains("lensModel is fisheye; known are LENSMODEL_PINHOLE"));
    CHECK_THAT(thrown([&] { RefractiveCamera::createMrcal("LENSMODEL_PINHOLE", std::vector<double>(3, 1.)); }),
               Contains("intrinsics has 3 values"));
    const TemporaryFile file(".yml");
    {
        FileStorage fs(file.path, FileStorage::WRITE);
        fs << "camera_matrix" << Mat(K) << "distortion_coefficients" << Mat::zeros(4, 1, CV_64F);
        fs << "lens_model" << "LENSMODEL_CAHVOR";
    }
    CHECK_THAT(thrown([&] { RefractiveCamera::read(file.path); }),
               Contains("distortion_coefficients has 4 values; LENSMODEL_CAHVOR has 5"));
}

TEST_CASE("A file says by the words of ROS and of OpenCV's sample that its lens is a fisheye", "[camera]")
{
    const auto modelOf = [](const String& line) {
        FileStorage out(".yml", FileStorage::WRITE | FileStorage::MEMORY);
        out << "camera_matrix" << Mat(Matx33d(800, 0, 320, 0, 800, 240, 0, 0, 1));
        out << "distortion_coefficients" << Mat(Vec4d(-0.02, 0.01, 0.001, -0.001));
        const FileStorage in(out.releaseAndGetString() + line + "\n", FileStorage::READ | FileStorage::MEMORY);
        return RefractiveCamera::read(in.root())->lensModel();
    };
    for (const char* line : { "distortion_model: equidistant", "distortion_model: fisheye", "fisheye_model: 1" })
        CHECK(modelOf(line) == "fisheye");
    for (const char* line : { "", "distortion_model: plumb_bob", "fisheye_model: 0", "lens_model: opencv" })
        CHECK(modelOf(line) == "opencv");
    for (const char* line : { "distortion_model: division", "distortion_model: 3" })
        CHECK_THAT(thrown([&] { modelOf(line); }), Contains("OpenCV has no lens for its distortion_model"));
}

TEST_CASE("The names of lens models are those that make lenses", "[camera]")
{
    const std::vector<String> names = RefractiveCamera::lensModels();
    for (const LensKind& kind : allLenses())
    {
        CAPTURE(kind.name);
        CHECK(std::any_of(names.begin(), names.end(), [&](const String& name)
        {
            const size_t given = name.find("...");
            return given == String::npos ? name == kind.model : name.compare(0, given, kind.model, 0, given) == 0;
        }));
    }
    CHECK(std::count(names.begin(), names.end(), "LENSMODEL_CAHVORE_linearity=...") == 1);
}

TEST_CASE("Camera matrix and coefficients are taken in every type and shape", "[camera]")
{
    const Matx33d K(1000, 0, 640, 0, 1010.5, 480, 0, 0, 1);
    const std::vector<double> d = { -0.25, 0.125, 0.5e-3, -0.25e-3, 0.0625 };
    const std::vector<Vec2d> expected = someProjections(RefractiveCamera::create(K, d));

    CHECK(largestDifference(someProjections(RefractiveCamera::create(Matx33f(K), d)), expected) == 0);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(Mat(K), Mat(d))), expected) == 0);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, Mat(d).t())), expected) == 0);
    Mat d32;
    Mat(d).convertTo(d32, CV_32F);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, d32)), expected) < 1e-4);
    Mat wide(5, 3, CV_64F, Scalar(7));
    Mat(d).copyTo(wide.col(1));
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, wide.col(1))), expected) == 0);
    Mat big(5, 5, CV_64F, Scalar(7)), inner = big(Rect(1, 1, 3, 3));
    Mat(K).copyTo(inner);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(inner, d)), expected) == 0);

    const std::vector<Vec2d> plain = someProjections(RefractiveCamera::create(K, std::vector<double>(5, 0.)));
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, noArray())), plain) == 0);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, Mat())), plain) == 0);
    CHECK(largestDifference(someProjections(RefractiveCamera::create(K, std::vector<double>())), plain) == 0);
}

TEST_CASE("A wrong lens argument is named with its value", "[camera]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const auto create = [](InputArray k, InputArray d) { return thrown([&] { RefractiveCamera::create(k, d); }); };
    CHECK(create(K, noArray()) == "");
    CHECK_THAT(create(Matx33d(0, 0, 640, 0, 1000, 480, 0, 0, 1), noArray()), Contains("cameraMatrix") && Contains("(0, 1000)"));
    CHECK_THAT(create(Matx33d(1000, 0, 640, 0, -3, 480, 0, 0, 1), noArray()), Contains("cameraMatrix") && Contains("-3"));
    CHECK_THAT(create(Matx33d(1000, 0, NaN, 0, 1000, 480, 0, 0, 1), noArray()), Contains("cameraMatrix") && Contains("nan"));
    CHECK_THAT(create(Matx33d(1000, 2.5, 640, 0, 1000, 480, 0, 0, 1), noArray()), Contains("cameraMatrix") && Contains("2.5"));
    CHECK_THAT(create(Matx33d(1000, 0, 640, 0, 1000, 480, 0, 0, 2), noArray()), Contains("cameraMatrix") && Contains("2"));
    CHECK_THAT(create(Mat::eye(3, 4, CV_64F), noArray()), Contains("cameraMatrix") && Contains("3x4"));
    CHECK_THAT(create(Mat::eye(3, 3, CV_32S), noArray()), Contains("cameraMatrix") && Contains("32SC1"));
    CHECK_THAT(create(Mat(), noArray()), Contains("cameraMatrix") && Contains("empty"));
    for (int n : { 1, 2, 3, 6, 7, 9, 13, 15 })
        CHECK_THAT(create(K, Mat::zeros(n, 1, CV_64F)), Contains("distCoeffs") && Contains(std::to_string(n)));
    CHECK_THAT(create(K, std::vector<double>{ 0, INF, 0, 0 }), Contains("distCoeffs[1]") && Contains("inf"));
    CHECK_THAT(thrown([&] { RefractiveCamera::createFisheye(K, std::vector<double>(5, 0.)); }),
               Contains("distCoeffs") && Contains("5"));
    CHECK_THAT(thrown([&] { RefractiveCamera::createMrcal("LENSMODEL_OPENCV4", std::vector<double>(4, 1.)); }),
               Contains("intrinsics") && Contains("4"));
    CHECK_THAT(thrown([&] { RefractiveCamera::createMrcal("nonsense", std::vector<double>(4, 1.)); }),
               Contains("lensModel") && Contains("nonsense"));
}

TEST_CASE("An empty camera is refused by name", "[camera]")
{
    const std::vector<Vec2d> pixels(1);
    std::vector<Vec3d> out;
    CHECK_THAT(thrown([&] { refractivePointsOnPlane(pixels, out, Ptr<RefractiveCamera>(), Vec4d(0, 0, 1, 5)); }),
               Contains("camera"));
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d::eye(), noArray());
    CHECK_THAT(thrown([&] { triangulateRefractive(camera, Ptr<RefractiveCamera>(), Matx33d::eye(), Vec3d(1, 0, 0),
                                                  pixels, pixels, out); }),
               Contains("camera2"));
}

TEST_CASE("Setting window and lens changes what is projected", "[camera]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const Ptr<RefractiveCamera> camera = makeCamera(kind, GlassWindow());
    camera->setWindow(someWindow());
    CHECK(largestDifference(someProjections(camera), someProjections(makeCamera(kind, someWindow()))) == 0);

    Mat parameters = camera->lensParameters();
    parameters.at<double>(2) += 3;
    camera->setLensParameters(parameters);
    CHECK(largestDifference(camera->lensParameters(), parameters) == 0);
    CHECK(camera->cameraMatrix().at<double>(0, 2) == kind.K(0, 2) + 3);
    LensKind moved = kind;
    moved.K(0, 2) += 3;
    CHECK(largestDifference(someProjections(camera), someProjections(makeCamera(moved, someWindow()))) == 0);

    CHECK_THAT(thrown([&] { camera->setLensParameters(std::vector<double>(3, 1.)); }),
               Contains("parameters") && Contains("3"));
    parameters.at<double>(0) = -1;
    CHECK_THAT(thrown([&] { camera->setLensParameters(parameters); }), Contains("parameters") && Contains("-1"));
    parameters.at<double>(0) = NaN;
    CHECK_THAT(thrown([&] { camera->setLensParameters(parameters); }), Contains("parameters") && Contains("nan"));
    GlassWindow wrong = someWindow();
    wrong.outerIndex = 0.7;
    CHECK_THAT(thrown([&] { camera->setWindow(wrong); }), Contains("outerIndex") && Contains("0.7"));
    // A refused change changes nothing.
    CHECK(largestDifference(someProjections(camera), someProjections(makeCamera(moved, someWindow()))) == 0);

    camera->setImageSize(Size(1280, 1024));
    for (Size wrong : { Size(-1, 5), Size(5, -1), Size(0, 5), Size(5, 0) })
        CHECK_THAT(thrown([&] { camera->setImageSize(wrong); }), Contains(format("size is %dx%d", wrong.width, wrong.height)));
    CHECK(camera->imageSize() == Size(1280, 1024));
}

TEST_CASE("A written camera is read back to the last bit", "[camera]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    const std::string extension = GENERATE(".yml", ".xml", ".json");
    CAPTURE(kind.name, extension);
    const TemporaryFile file(extension);
    const Ptr<RefractiveCamera> camera = makeCamera(kind, someWindow());
    camera->setImageSize(Size(1280, 1024));
    {
        FileStorage fs(file.path, FileStorage::WRITE);
        camera->write(fs);
    }
    const Ptr<RefractiveCamera> back = RefractiveCamera::read(file.path);
    CHECK(back->lensModel() == camera->lensModel());
    CHECK(back->imageSize() == Size(1280, 1024));
    CHECK(largestDifference(back->lensParameters(), camera->lensParameters()) == 0);
    CHECK(largestDifference(back->cameraMatrix(), camera->cameraMatrix()) == 0);
    CHECK(largestDifference(someProjections(back), someProjections(camera)) < 1e-12);
}

TEST_CASE("A camera is not overwritten through its base", "[camera]")
{
    CHECK(!std::is_copy_assignable<RefractiveCamera>::value);
}

TEST_CASE("A clone is a camera of its own", "[camera]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const Ptr<RefractiveCamera> camera = makeCamera(kind, someWindow());
    camera->setImageSize(Size(1280, 1024));
    const std::vector<Vec2d> before = someProjections(camera);
    const Ptr<RefractiveCamera> copy = camera->clone();
    CHECK(copy != camera);
    CHECK(copy->lensModel() == camera->lensModel());
    CHECK(copy->imageSize() == Size(1280, 1024));
    CHECK(largestDifference(someProjections(copy), before) == 0);

    copy->setWindow(GlassWindow());
    Mat parameters = copy->lensParameters();
    parameters.at<double>(2) += 3;
    copy->setLensParameters(parameters);
    copy->setImageSize(Size());
    CHECK(largestDifference(someProjections(camera), before) == 0);
    CHECK(camera->imageSize() == Size(1280, 1024));
    LensKind moved = kind;
    moved.K(0, 2) += 3;
    CHECK(largestDifference(someProjections(copy), someProjections(makeCamera(moved, GlassWindow()))) == 0);
}

TEST_CASE("Cameras in maps of one's own file", "[camera]")
{
    const LensKind &paper = lensNamed("the paper's"), &fisheye = lensNamed("fisheye");
    const Ptr<FileStorage> out = makePtr<FileStorage>(".yml", FileStorage::WRITE | FileStorage::MEMORY);
    *out << "rig" << "{";
    makeCamera(paper, someWindow())->write(out, "left");
    makeCamera(fisheye, GlassWindow())->write(out, "right");
    *out << "}";
    const FileStorage in(out->releaseAndGetString(), FileStorage::READ | FileStorage::MEMORY);
    const Ptr<RefractiveCamera> left = RefractiveCamera::read(in["rig"]["left"]);
    CHECK(largestDifference(someProjections(left), someProjections(makeCamera(paper, someWindow()))) < 1e-12);
    CHECK(RefractiveCamera::read(in["rig"]["right"])->lensModel() == "fisheye");
    CHECK_THAT(thrown([&] { RefractiveCamera::read(in["rig"]["middle"]); }), Contains("node is not a map"));
    CHECK_THAT(thrown([&] { RefractiveCamera::read(in["rig"]); }), Contains("rig has no camera_matrix"));
    CHECK_THAT(thrown([&] { left->write(Ptr<FileStorage>()); }), Contains("fs is not open"));
    CHECK_THAT(thrown([&] { left->write(out); }), Contains("fs is not open"));
}

TEST_CASE("A camera of mrcal's models is read back as such", "[camera]")
{
    const TemporaryFile file(".yml");
    const std::vector<double> intrinsics = { 1000, 1010, 640, 480, 0.5, 0.03, 1e-4, -2e-4, 1e-4, 0.8, 0.1, 0.002 };
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal("LENSMODEL_OPENCV8", intrinsics, someWindow());
    {
        FileStorage fs(file.path, FileStorage::WRITE);
        camera->write(fs);
    }
    const Ptr<RefractiveCamera> back = RefractiveCamera::read(file.path);
    CHECK(back->lensModel() == "LENSMODEL_OPENCV8");
    CHECK(largestDifference(back->lensParameters(), intrinsics) == 0);
    CHECK(back->window().thickness == someWindow().thickness);
}

TEST_CASE("A saved camera is read back to the last bit, in every format", "[camera]")
{
    const std::string suffix = GENERATE(".yml", ".xml", ".json", "");
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(suffix, kind.name);
    const TemporaryFile file(suffix, "what was there before");
    const Ptr<RefractiveCamera> camera = makeCamera(kind, someWindow());
    camera->save(file.path);
    const Ptr<RefractiveCamera> back = RefractiveCamera::read(file.path);
    CHECK(largestDifference(someProjections(back), someProjections(camera)) == 0);
    CHECK(back->lensModel() == camera->lensModel());
}

TEST_CASE("A camera that cannot be saved leaves nothing", "[camera]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d::eye(), noArray(), someWindow());
    CHECK_THAT(thrown([&] { camera->save("no/such/folder/camera.yml"); }), Contains("no/such/folder/camera.yml"));
    const std::string folder = cv::tempfile(".folder");
    REQUIRE(cv::utils::fs::createDirectory(folder));
    CHECK_THAT(thrown([&] { camera->save(folder); }), Contains(folder));
    const std::filesystem::path path(folder);
    for (const auto& entry : std::filesystem::directory_iterator(path.parent_path()))
        if (entry.path() != path)
            CHECK_THAT(entry.path().filename().string(), !Contains(path.filename().string()));
    cv::utils::fs::remove_all(folder);
}

TEST_CASE("A file that several write at the same time is whole for who reads it", "[camera]")
{
    const TemporaryFolder folder;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d::eye(), noArray(), someWindow());
    const std::string path = folder / "camera.yml";
    camera->save(path);
    std::atomic<int> failed(0), writing(2);
    const auto writer = [&]
    {
        for (int i = 0; i < 300; i++)
            failed += !thrown([&] { camera->save(path); }).empty();
        writing--;
    };
    std::thread first(writer), second(writer);
    int reads = 0;
    while (writing > 0 || reads == 0)
    {
        failed += !thrown([&] { RefractiveCamera::read(path); }).empty();
        reads++;
    }
    first.join();
    second.join();
    printNumber("reads of a file that two threads write 600 times, failed of " + std::to_string(reads), failed, "");
    CHECK(failed == 0);
    CHECK(std::distance(std::filesystem::directory_iterator(std::filesystem::path(path).parent_path()), {}) == 1);
}

TEST_CASE("A camera is saved where a link leads, into a pipe, and not over a read-only file", "[camera]")
{
    const TemporaryFolder folder;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d::eye(), noArray(), someWindow());
    std::filesystem::create_symlink("real.yml", folder / "link.yml");
    for (int i = 0; i < 2; i++)         // it leads to nothing yet, then to a file
    {
        camera->save(folder / "link.yml");
        CHECK(std::filesystem::is_symlink(folder / "link.yml"));
        CHECK(std::filesystem::is_regular_file(folder / "real.yml"));
    }
    CHECK_NOTHROW(RefractiveCamera::read(folder / "link.yml"));

    REQUIRE(mkfifo((folder / "pipe.yml").c_str(), 0600) == 0);
    const int reader = open((folder / "pipe.yml").c_str(), O_RDONLY | O_NONBLOCK);
    camera->save(folder / "pipe.yml");
    CHECK(std::filesystem::is_fifo(folder / "pipe.yml"));
    char text[6] = {};
    CHECK(read(reader, text, 5) == 5);
    CHECK(std::string(text) == "%YAML");
    close(reader);

    std::filesystem::permissions(folder / "real.yml", std::filesystem::perms(0444));
    CHECK_THAT(thrown([&] { camera->save(folder / "link.yml"); }), Contains("link.yml"));
    CHECK(folder.count() == 3);
}

TEST_CASE("Two cameras in one file are read by name, camera1 by default", "[camera]")
{
    const TemporaryFile file(".yml");
    {
        FileStorage fs(file.path, FileStorage::WRITE);
        int number = 1;
        for (const char* name : { "camera1", "camera2" })
        {
            fs << name << "{";
            RefractiveCamera::create(Matx33d(1000*number, 0, 640, 0, 1000*number, 480, 0, 0, 1), noArray())->write(fs);
            fs << "}";
            number++;
        }
    }
    CHECK(RefractiveCamera::read(file.path)->cameraMatrix().at<double>(0, 0) == 1000);
    CHECK(RefractiveCamera::read(file.path, "camera1")->cameraMatrix().at<double>(0, 0) == 1000);
    CHECK(RefractiveCamera::read(file.path, "camera2")->cameraMatrix().at<double>(0, 0) == 2000);
    CHECK_THAT(thrown([&] { RefractiveCamera::read(file.path, "camera3"); }),
               Contains(file.path) && Contains("camera3"));
}

TEST_CASE("The file of OpenCV's calibration sample is a camera without window", "[camera]")
{
    const TemporaryFile file(".yml", "%YAML:1.0\n---\ncalibration_time: \"today\"\nimage_width: 640\nimage_height: 480\n"
        "flags: 0\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
        "   data: [ 535.4, 0., 320., 0., 539.4, 235., 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
        "   data: [ -0.26, -0.04, 1.8e-03, -2.5e-04, 0.23 ]\navg_reprojection_error: 0.2\n");
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(file.path);
    CHECK(camera->imageSize() == Size(640, 480));
    CHECK(camera->lensModel() == "opencv");
    CHECK(camera->distCoeffs().at<double>(4) == 0.23);
    CHECK(camera->window().thickness.empty());
}

TEST_CASE("A .cameramodel is read as mrcal writes it", "[camera]")
{
    const TemporaryFile file(".cameramodel",
        "# generated on some day\n# with a { 'lensmodel': 'in a comment' }\n{\n    'lensmodel':  'LENSMODEL_OPENCV4',\n\n"
        "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n"
        "    'intrinsics': [ 1761.181055, 1761.250444, 1965.706996, 1087.518797, -0.0126, 0.0359, -2.5e-4, 5e-4,],\n\n"
        "    'valid_intrinsics_region': [ [ 1, 2 ], [ 3, 4 ], ],\n"
        "    'optimization_inputs': b'binary {data}, \\' and more',\n"
        "    'extrinsics': ( 2e-2, -3e-1, -1e-2,  1., 2, -3., ),\n    'imagersize': [ 4000, 2200 ]\n}\n");
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(file.path);
    CHECK(camera->lensModel() == "LENSMODEL_OPENCV4");
    CHECK(camera->imageSize() == Size(4000, 2200));
    CHECK(largestDifference(camera->lensParameters(), std::vector<double>{
        1761.181055, 1761.250444, 1965.706996, 1087.518797, -0.0126, 0.0359, -2.5e-4, 5e-4 }) == 0);
    CHECK(camera->window().thickness.empty());
}

TEST_CASE("A file that is no camera is refused with its name", "[camera]")
{
    CHECK_THAT(thrown([] { RefractiveCamera::read("no/such/file.yml"); }), Contains("no/such/file.yml"));
    CHECK_THAT(thrown([] { RefractiveCamera::read("no/such/file.cameramodel"); }), Contains("no/such/file.cameramodel"));
    std::string random;
    Random source;
    for (int i = 0; i < 4000; i++)
        random += (char)source.below(256);
    const std::string model = "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [ 1, 1, 1, 1 ] }";
    struct Bad { std::string suffix, text; };
    std::vector<Bad> bads = {
        { ".yml", "" }, { ".xml", "" }, { ".json", "" }, { ".cameramodel", "" },
        { ".yml", random }, { ".xml", random }, { ".json", random }, { ".cameramodel", random },
        { ".yml", "%YAML:1.0\n---\nother: 1\n" },
        { ".yml", "%YAML:1.0\n---\ncamera_matrix: 5\n" },
        { ".yml", "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5" },
        { ".yml", "%YAML:1.0\n---\n- 1\n- 2\n" },
        { ".json", "{ \"camera_matrix\": \"text\" }" },
        { ".xml", "<?xml version=\"1.0\"?>\n<opencv_storage><camera_matrix>" },
        { ".cameramodel", "{ 'lensmodel': 5 }" },
        { ".cameramodel", "{ 'lensmodel': 'LENSMODEL_PINHOLE' }" },
        { ".cameramodel", "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [ 1, 1, 1, x ] }" } };
    for (size_t length = 0; length < model.size(); length += 5)
        bads.push_back({ ".cameramodel", model.substr(0, length) });
    for (const Bad& bad : bads)
    {
        CAPTURE(bad.suffix, bad.text.substr(0, 100), seed());
        const TemporaryFile file(bad.suffix, bad.text);
        CHECK_THAT(thrown([&] { RefractiveCamera::read(file.path); }), Contains(file.path));
    }
}

// FileStorage's parsers call themselves for each level, and end with the stack.
TEST_CASE("A file that nests without end is refused", "[camera]")
{
    const std::string heads[] = { "%YAML:1.0\n---\na: ", "<?xml version=\"1.0\"?>\n<opencv_storage>\n", "{\"a\":" };
    const std::string levels[] = { "[", "<a>\n", "[" };
    for (int i = 0; i < 3; i++)
    {
        std::string text = heads[i];
        for (int level = 0; level < 1000000; level++)
            text += levels[i];
        const TemporaryFile file(".yml", text);
        CHECK_THAT(thrown([&] { RefractiveCamera::read(file.path); }), Contains(file.path) && Contains("nest"));
    }
}

TEST_CASE("A file may nest 256 deep", "[camera]")
{
    for (int levels : { 256, 257 })
    {
        const TemporaryFile file(".yml", "%YAML:1.0\n---\na: " + std::string(levels, '[') + std::string(levels, ']') + "\n");
        const std::string sentence = thrown([&] { RefractiveCamera::read(file.path); });
        CAPTURE(sentence);
        CHECK_THAT(sentence, Contains(file.path));
        CHECK(Contains("nest").match(sentence) == (levels > 256));
    }
}

TEST_CASE("A matrix takes no more memory than its numbers", "[camera]")
{
    for (const char* rows : { "2000000000", "-3", "three", "4" })
    {
        const TemporaryFile file(".yml", std::string("%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: ") + rows
            + "\n   cols: 3\n   dt: d\n   data: [ 1000., 0., 640., 0., 1000., 480., 0., 0., 1. ]\n");
        CHECK_THAT(thrown([&] { RefractiveCamera::read(file.path); }), Contains(file.path) && Contains("camera_matrix"));
    }
}

TEST_CASE("A camera file cut anywhere is read whole or refused", "[camera]")
{
    for (const char* suffix : { ".yml", ".xml", ".json" })
    {
        const LensKind& kind = lensNamed("5 coefficients");
        FileStorage fs(suffix, FileStorage::WRITE | FileStorage::MEMORY);
        makeCamera(kind, someWindow())->write(fs);
        const std::string text = fs.releaseAndGetString();
        for (size_t length = 0; length < text.size(); length += 37)
        {
            CAPTURE(suffix, length);
            const TemporaryFile file(suffix, text.substr(0, length));
            Ptr<RefractiveCamera> camera;
            try { camera = RefractiveCamera::read(file.path); }
            catch (const cv::Exception&) { continue; }
            // YAML may end between two keys; what is there must be right.
            CHECK(largestDifference(camera->cameraMatrix(), kind.K) == 0);
        }
    }
}
