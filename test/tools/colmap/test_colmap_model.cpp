// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Models of COLMAP as its documentation lays them out, there and back.
#include "colmap/survey.hpp"
#include "console/failure.hpp"
#include "colmap/colmap_model.hpp"
#include "colmap/colmap_files.hpp"

using namespace tools;

namespace {

std::string modelRefusal(const std::string& folder)
{
    try
    {
        readColmapModel(folder);
        return "";
    }
    catch (const Failure& e)
    {
        return e.what();
    }
}

std::string bytesOf(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
}

//! The same model as bytes, record by record, by hand.
void saveBinary(const TemporaryFolder& f)
{
    const auto pose = [](double qw, double qx, double qy, double qz, double tx, double ty, double tz) {
        return raw(std::vector<double>{qw, qx, qy, qz, tx, ty, tz}); };
    const auto pixel = [](double x, double y, uint64_t point) { return raw(std::vector<double>{x, y}) + raw(point); };
    const std::string end(1, '\0');
    saved(f, "cameras.bin", raw<uint64_t>(2) + raw<int32_t>(1) + raw<int32_t>(2) + raw<uint64_t>(1024) + raw<uint64_t>(768)
          + raw(std::vector<double>{1280, 512, 384, 0.05}) + raw<int32_t>(2) + raw<int32_t>(17) + raw<uint64_t>(1024) + raw<uint64_t>(768)
          + raw(std::vector<double>{1024, 768}));
    saved(f, "images.bin", raw<uint64_t>(3) + raw<uint32_t>(1) + pose(0.5, -0.5, 0.5, 0.5, 0.125, -2, 5.000000000000002)
          + raw<uint32_t>(1) + "left/a.png" + end + raw<uint64_t>(2) + pixel(924.0049441902713, 470.75, UINT64_MAX) + pixel(0.5, 0.5, 7)
          + raw<uint32_t>(2) + pose(1, 0, 0, 0, 0, 0, 0) + raw<uint32_t>(2) + "right/a.png" + end + raw<uint64_t>(0)
          + raw<uint32_t>(3) + pose(0, 0, 0, 0, 0, 0, 0) + raw<uint32_t>(1) + "left/b.png" + end + raw<uint64_t>(1) + pixel(10, 20, 7));
    saved(f, "points3D.bin", raw<uint64_t>(1) + raw<uint64_t>(7) + raw(std::vector<double>{0.25, -1.5, 0.001})
          + raw(std::vector<uint8_t>{255, 0, 9}) + raw(0.75) + raw<uint64_t>(2) + raw(std::vector<uint32_t>{1, 1, 3, 0}));
    saved(f, "rigs.bin", raw<uint64_t>(1) + raw<uint32_t>(1) + raw<uint32_t>(3) + raw<int32_t>(0) + raw<uint32_t>(1)
          + raw<int32_t>(0) + raw<uint32_t>(2) + raw<uint8_t>(1) + pose(1, 0, 0, 0, 0.25, 0, 0)
          + raw<int32_t>(1) + raw<uint32_t>(4) + raw<uint8_t>(0));
    saved(f, "frames.bin", raw<uint64_t>(1) + raw<uint32_t>(1) + raw<uint32_t>(1) + pose(0.5, -0.5, 0.5, 0.5, 0.125, -2, 5)
          + raw<uint32_t>(2) + raw<int32_t>(0) + raw<uint32_t>(1) + raw<uint64_t>(1) + raw<int32_t>(0) + raw<uint32_t>(2)
          + raw<uint64_t>(2));
}

const char* const FILES[] = {"cameras", "images", "points3D", "rigs", "frames"};

} // namespace

TEST_CASE("A model of COLMAP is read as it is laid out, as text and as bytes", "[colmap]")
{
    const TemporaryFolder text, binary;
    saveText(text);
    saveBinary(binary);
    for (const TemporaryFolder* f : {&text, &binary})
    {
        const ColmapModel model = readColmapModel(f->path().string());
        CHECK(model.isBinary == (f == &binary));
        REQUIRE(model.cameras.size() == 2);
        CHECK(model.cameras[0].model == "SIMPLE_RADIAL");
        CHECK(model.cameras[0].parameters == std::vector<double>{1280, 512, 384, 0.05});
        CHECK(model.cameras[1].parameters.size() == 2);
        REQUIRE(model.images.size() == 3);
        CHECK(model.images[0].name == "left/a.png");
        CHECK(model.images[0].cam_from_world.q == cv::Vec4d(0.5, -0.5, 0.5, 0.5));
        CHECK(model.images[0].cam_from_world.t[2] == 5.000000000000002);
        REQUIRE(model.images[0].pixels.size() == 2);
        CHECK(model.images[0].pixels[0].point == NO_COLMAP_POINT);
        CHECK(model.images[0].pixels[0].x == 924.0049441902713);
        CHECK(model.images[0].pixels[1].point == 7);
        CHECK(model.images[1].pixels.empty());
        CHECK(isPose(model.images[0].cam_from_world));
        CHECK_FALSE(isPose(model.images[2].cam_from_world));
        REQUIRE(model.points.size() == 1);
        CHECK(model.points[0].X == cv::Vec3d(0.25, -1.5, 0.001));
        CHECK(model.points[0].color == cv::Vec3b(255, 0, 9));
        CHECK(model.points[0].track[1].image == 3);
        REQUIRE(model.rigs.size() == 1);
        CHECK(model.rigs[0].sensors.size() == 3);
        CHECK(model.rigs[0].sensors[1].sensor_from_rig.t[0] == 0.25);
        REQUIRE(model.frames.size() == 1);
        CHECK(model.frames[0].data[1].id == 2);
    }
}

TEST_CASE("A model of COLMAP is written as it was read", "[colmap]")
{
    const TemporaryFolder text, binary, textAgain, binaryAgain;     // numbers have the digits that tell them from all others
    saveText(text);
    saveBinary(binary);
    ColmapModel model = readColmapModel(text.path().string());
    writeColmapModel(model, textAgain.path().string());
    model.isBinary = true;
    writeColmapModel(model, binaryAgain.path().string());
    for (const char* file : FILES)
    {
        CAPTURE(file);
        CHECK(bytesOf(binaryAgain/(file + std::string(".bin"))) == bytesOf(binary/(file + std::string(".bin"))));
        std::string without;
        std::istringstream in(bytesOf(text/(file + std::string(".txt"))));
        for (std::string line; std::getline(in, line); )
            without += !line.empty() && line[0] == '#' ? "" : line + "\n";
        const std::string numbers = bytesOf(textAgain/(file + std::string(".txt")));
        CHECK(numbers == without);
    }
    ColmapModel again = readColmapModel(textAgain.path().string());
    CHECK(again.points[0].X == model.points[0].X);
    CHECK(again.cameras[0].parameters == model.cameras[0].parameters);
}

TEST_CASE("Texts of a model may have blanks in names, and what editors of Windows write", "[colmap]")
{
    const TemporaryFolder f;
    saveText(f);
    for (const char* file : FILES)
    {
        std::string text = "\xEF\xBB\xBF", name = file + std::string(".txt");
        for (char c : bytesOf(f/name))
            text += c == '\n' ? std::string("\r\n") : std::string(1, c);
        const size_t at = text.find("left/a.png");
        if (at != std::string::npos)
            text.insert(at + 5, "pass 2 of ");
        saved(f, name, text);
    }
    const ColmapModel model = readColmapModel(f.path().string());
    REQUIRE(model.images.size() == 3);
    CHECK(model.images[0].name == "left/pass 2 of a.png");
    CHECK(model.images[0].pixels.size() == 2);
    const TemporaryFolder again;
    writeColmapModel(model, again.path().string());
    CHECK(readColmapModel(again.path().string()).images[0].name == model.images[0].name);
}

TEST_CASE("A model of COLMAP takes the place of another in its folder", "[colmap]")
{
    const TemporaryFolder f;
    saveBinary(f);
    ColmapModel model = readColmapModel(f.path().string());
    model.isBinary = false;
    model.rigs.clear();
    model.frames.clear();
    model.points[0].X[0] = 77;
    writeColmapModel(model, f.path().string());
    const ColmapModel again = readColmapModel(f.path().string());
    CHECK(again.points[0].X[0] == 77);
    CHECK(again.rigs.empty());
    model.isBinary = true;
    saved(f, "rigs.bin", "of another");
    saved(f, "frames.bin", "of another");
    writeColmapModel(model, f.path().string());
    CHECK(readColmapModel(f.path().string()).rigs.empty());
    CHECK_FALSE(std::filesystem::exists(f / "cameras.txt"));
}

TEST_CASE("Poses of COLMAP are rotations there and back", "[colmap]")
{
    CHECK(cv::norm(tools::transformOf(ColmapPose{{0.5, -0.5, 0.5, 0.5}, {1, 2, 3}}).R - cv::Matx33d(0, -1, 0, 0, 0, 1, -1, 0, 0)) < 1e-12);
    for (const cv::Vec3d& rvec : {cv::Vec3d(), cv::Vec3d(0.1, 2, -0.3), cv::Vec3d(3.1, 0, 0), cv::Vec3d(1e-9, 0, 0)})
    {
        const RigidTransform there = tools::transformOf(rvec, cv::Vec3d(4, 5, 6)), back = tools::transformOf(colmapPoseOf(there));
        CHECK(cv::norm(there.R - back.R) < 1e-12);
        CHECK(back.t == there.t);
        CHECK(isPose(colmapPoseOf(there)));
    }
}

TEST_CASE("What is wrong with a model of COLMAP is said in a sentence", "[colmap]")
{
    using Catch::Contains;
    const TemporaryFolder none;
    CHECK_THAT(modelRefusal(none.path().string()), Contains("has no cameras.bin and no cameras.txt"));
    const auto spoilt = [](const char* file, const std::string& from, const std::string& to) {
        const TemporaryFolder f;
        saveText(f);
        std::string text = bytesOf(f/file);
        const size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        saved(f, file, text.replace(at, from.size(), to));
        return modelRefusal(f.path().string());
    };
    CHECK_THAT(spoilt("cameras.txt", "SIMPLE_RADIAL", "PINHOLE_9"), Contains("cameras.txt' looks like COLMAP's, but line 4: 'PINHOLE_9'"));
    CHECK_THAT(spoilt("cameras.txt", " 0.05", ""), Contains("line 4: a number is missing"));
    CHECK_THAT(spoilt("cameras.txt", "1024 768\n", "1024 768 3\n"), Contains("line 5: there is more"));
    CHECK_THAT(spoilt("images.txt", "0.5 0.5 7", "0.5 0.5"), Contains("line 6: its list has 5 entries"));
    CHECK_THAT(spoilt("images.txt", "470.75", "abc"), Contains("line 6: 'abc' is not the number"));
    CHECK_THAT(spoilt("images.txt", "10 20 7", "10 20 8"), Contains("image 'left/b.png' shows point 8, which is not there"));
    CHECK_THAT(spoilt("images.txt", "0 1 left/b.png", "0 5 left/b.png"), Contains("is of camera 5, which is not there"));
    CHECK_THAT(spoilt("images.txt", "3 0 0 0 0", "1 0 0 0 0"), Contains("two images with the id 1"));
    CHECK_THAT(spoilt("points3D.txt", "1 1 3 0", "1 0 3 0"), Contains("point 7 is said to be seen in image 1"));
    CHECK_THAT(spoilt("points3D.txt", "255", "256"), Contains("'256' is above 255"));
    CHECK_THAT(spoilt("points3D.txt", "7 0.25 -1.5 0.001 255 0 9 0.75 1 1 3 0\n", ""), Contains("is a model without points"));
    const TemporaryFolder binary;
    saveBinary(binary);
    saved(binary, "images.bin", bytesOf(binary/"images.bin").substr(0, 100));
    CHECK_THAT(modelRefusal(binary.path().string()), Contains("images.bin' looks like COLMAP's, but it ends too early"));
    saveBinary(binary);
    saved(binary, "points3D.bin", bytesOf(binary/"points3D.bin") + "x");
    CHECK_THAT(modelRefusal(binary.path().string()), Contains("1 bytes follow its last record"));
    saveBinary(binary);
    saved(binary, "rigs.bin", raw<uint64_t>(1) + raw<uint32_t>(1) + raw<uint32_t>(1) + raw<int32_t>(7) + raw<uint32_t>(1));
    CHECK_THAT(modelRefusal(binary.path().string()), Contains("rigs.bin' looks like COLMAP's, but '7' is no sensor"));
    std::filesystem::remove(binary/"points3D.bin");
    CHECK_THAT(modelRefusal(binary.path().string()), Contains("there is no '" + binary/"points3D.bin"));
}

TEST_CASE("A model that is cut or damaged anywhere is read or refused in a sentence", "[colmap]")
{
    int refused = 0;
    for (bool isBinary : {false, true})
        for (const char* stem : FILES)
        {
            const TemporaryFolder f;
            isBinary ? saveBinary(f) : saveText(f);
            const std::string file = stem + std::string(isBinary ? ".bin" : ".txt"), whole = bytesOf(f/file);
            for (size_t at = 0; at < whole.size(); at += 3)
                for (bool cut : {true, false})
                {
                    std::string bytes = cut ? whole.substr(0, at) : whole;
                    if (!cut)
                        bytes[at] ^= 0x55;
                    saved(f, file, bytes);
                    const std::string said = modelRefusal(f.path().string());
                    CAPTURE(file, at, cut, said);
                    CHECK((said.empty() || said[0] == '\''));
                    refused += !said.empty();
                }
        }
    CHECK(refused > 300);
}

TEST_CASE("Names of images match patterns", "[colmap]")
{
    CHECK(matchesPattern("port/0001.png", "port/*"));
    CHECK(matchesPattern("a/port/0001.png", "*port*.png"));
    CHECK(matchesPattern("x1", "x?"));
    CHECK(matchesPattern("abcabd", "*abd"));
    CHECK_FALSE(matchesPattern("starboard/0001.png", "port/*"));
    CHECK_FALSE(matchesPattern("x12", "x?"));
    CHECK(matchesPattern("", "*"));
}
