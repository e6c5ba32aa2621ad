// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_undistort and refract_epilines as a user runs them, on the bundled images.
#include "run_tool.hpp"
#include "truth_file.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <algorithm>
#include <cmath>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const std::string TARGET = " --size=6x5 --square=39";

std::string image(const std::string& name) { return STEREO + "/" + name + ".jpg"; }

//! RMS and largest of the last line of the table that refract_epilines prints.
std::pair<double, double> lastNumbers(const std::string& table)
{
    std::istringstream in(table.substr(table.rfind('\n', table.size() - 2) + 1));
    std::vector<std::string> words;
    for (std::string word; in >> word; )
        words.push_back(word);
    REQUIRE(words.size() >= 2);
    return {std::stod(words[words.size() - 2]), std::stod(words.back())};
}

} // namespace

TEST_CASE("refract_undistort turns a plane's image into the pinhole's", "[tools][undistort]")
{
    const TemporaryFolder folder;
    const TrueView view = readTruth(STEREO).at("measure1/z600_2.jpg");
    const ToolResult result = runTool("refract_undistort " + STEREO + "/truth.yml " + image("measure1/z600_2")
        + view.planeOption()
        + " --out-dir=" + (folder / "new/deep"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    const cv::Mat corrected = cv::imread(folder / "new/deep/z600_2.jpg", cv::IMREAD_GRAYSCALE);
    REQUIRE(corrected.size() == cv::Size(1280, 1024));

    std::vector<cv::Point2f> corners;
    REQUIRE(cv::findChessboardCornersSB(corrected, cv::Size(6, 5), corners, cv::CALIB_CB_EXHAUSTIVE));
    cv::cornerSubPix(corrected, corners, cv::Size(9, 9), cv::Size(-1, -1), cv::TermCriteria(3, 50, 1e-4));
    cv::Mat K;
    cv::FileStorage(STEREO + "/truth.yml", cv::FileStorage::READ)["camera1"]["camera_matrix"] >> K;
    std::vector<cv::Point2d> pinhole;
    cv::projectPoints(chessboard(6, 5, 39), view.rvec, view.tvec, K, cv::noArray(), pinhole);
    if (cv::norm(cv::Point2d(corners[0]) - pinhole[0]) > 100)       // OpenCV may count from the other end
        std::reverse(corners.begin(), corners.end());
    double squares = 0;
    for (size_t i = 0; i < corners.size(); i++)
        squares += std::pow(cv::norm(cv::Point2d(corners[i]) - pinhole[i]), 2);
    CHECK(std::sqrt(squares/corners.size()) < 0.05);
}

TEST_CASE("refract_undistort takes globs, a depth, the second camera", "[tools][undistort]")
{
    const TemporaryFolder folder;
    for (const std::string depth : {"600", "inf"})
    {
        const ToolResult result = runTool("refract_undistort " + STEREO + "/truth.yml '" + image("measure2/z600_[12]")
            + "' --camera=2 --depth=" + depth + " --quiet --out-dir=" + (folder/depth));
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        CHECK(result.out.empty());
        for (const std::string name : {"z600_1.jpg", "z600_2.jpg"})
            CHECK(cv::imread(folder/(depth + "/" + name)).size() == cv::Size(1280, 1024));
    }
    CHECK(readFile(folder / "600/z600_1.jpg") != readFile(folder / "inf/z600_1.jpg"));
}

TEST_CASE("refract_undistort takes videos and numbered images", "[tools][undistort]")
{
    const TemporaryFolder folder;
    {
        cv::VideoWriter video(folder / "v.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, cv::Size(1280, 1024));
        REQUIRE(video.isOpened());
        for (const std::string name : {"measure1/z600_1", "measure1/z600_2"})
            video.write(cv::imread(image(name)));
    }
    std::filesystem::copy_file(image("measure1/z600_1"), folder / "n3.jpg");
    const std::string call = "refract_undistort " + STEREO + "/truth.yml --depth=600 --out-dir=" + (folder / "out");
    const ToolResult result = runTool(call + " " + (folder / "v.avi") + " " + (folder / "n%d.jpg"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    CHECK(result.out.find("3 images") != std::string::npos);
    const cv::Mat frame = cv::imread(folder / "out/frame000001.png"), numbered = cv::imread(folder / "out/n3.jpg");
    REQUIRE(frame.size() == cv::Size(1280, 1024));
    REQUIRE(numbered.size() == cv::Size(1280, 1024));
    CHECK(cv::norm(frame, numbered, cv::NORM_L1)/(double)(frame.total()*3) < 2);       // the same image, twice compressed
    CHECK(std::filesystem::exists(folder / "out/frame000002.png"));
    const ToolResult both = runTool(call + " " + (folder / "v.avi") + " " + (folder / "v.avi"));
    CAPTURE(both.err);
    CHECK(both.code == 1);
    CHECK(both.err.find("same name") != std::string::npos);
}

//! Four bytes, the checksum of a PNG's chunk.
std::string crcOf(const std::string& bytes)
{
    uint32_t crc = 0xffffffff;
    for (const unsigned char byte : bytes)
    {
        crc ^= byte;
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    crc = ~crc;
    return {(char)(crc >> 24), (char)(crc >> 16), (char)(crc >> 8), (char)crc};
}

//! EXIF data with nothing but the orientation, in a JPEG or in a chunk of a PNG.
void addOrientation(const std::string& path, unsigned char orientation)
{
    using namespace std::string_literals;
    const std::string tiff = "II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s + (char)orientation + "\0\0\0\0\0\0\0"s;
    std::string file = readFile(path);
    if (file[0] == '\xff')
    {
        const std::string exif = "Exif\0\0"s + tiff;
        file.insert(2, "\xff\xe1\0"s + (char)(exif.size() + 2) + exif);
    }
    else
        file.insert(33, "\0\0\0"s + (char)tiff.size() + "eXIf" + tiff + crcOf("eXIf" + tiff));      // after IHDR
    writeFile(path, file);
}

TEST_CASE("refract_undistort keeps alpha and 16 bits", "[tools][undistort]")
{
    const TemporaryFolder folder;
    const cv::Mat grey = cv::imread(image("measure1/z600_1"), cv::IMREAD_GRAYSCALE);
    cv::Mat opaque, colours, deep;
    cv::merge(std::vector<cv::Mat>{grey, 255 - grey, grey, cv::Mat(grey.size(), CV_8U, cv::Scalar(255))}, opaque);
    opaque(cv::Rect(600, 500, 80, 60)).setTo(cv::Scalar(90, 90, 90, 0));
    opaque.convertTo(deep, CV_16U, 257);
    cv::cvtColor(opaque, colours, cv::COLOR_BGRA2BGR);
    cv::imwrite(folder / "alpha.png", opaque);
    cv::imwrite(folder / "deep.png", deep);
    cv::imwrite(folder / "colours.png", colours);
    cv::imwrite(folder / "grey.tif", deep.reshape(1).colRange(0, 1280));
    const ToolResult result = runTool("refract_undistort " + STEREO + "/truth.yml " + (folder / "*.png") + " " + (folder / "grey.tif")
                                      + " --depth=300 --out-dir=" + (folder / "out"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    CHECK(result.err.empty());
    const auto corrected = [&](const std::string& name) { return cv::imread(folder/("out/" + name), cv::IMREAD_UNCHANGED); };
    const cv::Mat four = corrected("alpha.png"), sixteen = corrected("deep.png"), three = corrected("colours.png");
    REQUIRE(four.type() == CV_8UC4);
    REQUIRE(sixteen.type() == CV_16UC4);
    REQUIRE(three.type() == CV_8UC3);
    CHECK(corrected("grey.tif").type() == CV_16UC1);
    cv::Mat back, alpha;
    sixteen.convertTo(back, CV_8U, 1/257.);
    CHECK(cv::norm(back, four, cv::NORM_INF) <= 1);
    cv::cvtColor(four, back, cv::COLOR_BGRA2BGR);
    CHECK(cv::norm(back, three, cv::NORM_INF) == 0);
    cv::extractChannel(four, alpha, 3);
    CHECK(alpha.at<uchar>(300, 300) == 255);
    CHECK(cv::countNonZero(alpha == 0) > 60*50);        // the hole
    // What the old image does not show is transparent.
    const int outside = cv::countNonZero(alpha(cv::Rect(0, 0, 1280, 1)) == 0) + cv::countNonZero(alpha(cv::Rect(0, 1023, 1280, 1)) == 0)
                        + cv::countNonZero(alpha.col(0) == 0) + cv::countNonZero(alpha.col(1279) == 0);
    CHECK(outside > 500);
}

TEST_CASE("Images are used as stored, and a rotation that EXIF data ask for is named", "[tools][undistort]")
{
    const TemporaryFolder folder;
    std::filesystem::copy_file(image("measure1/z600_1"), folder / "plain.jpg");
    const cv::Mat picture = cv::imread(folder / "plain.jpg", cv::IMREAD_GRAYSCALE);
    cv::imwrite(folder / "plain.png", picture);
    const std::string call = "refract_undistort " + STEREO + "/truth.yml --quiet --depth=600 --out-dir=" + (folder / "out") + " ";
    for (const std::string type : {".jpg", ".png"})
        for (const int orientation : {1, 3, 6, 8})
        {
            const std::string name = "turned" + std::to_string(orientation) + type;
            std::filesystem::copy_file(folder/("plain" + type), folder/name);
            addOrientation(folder/name, (unsigned char)orientation);
            const ToolResult plain = runTool(call + (folder/("plain" + type))), turned = runTool(call + (folder/name));
            CAPTURE(name, turned.err);
            CHECK(plain.err.empty());
            REQUIRE(turned.code == 0);
            CHECK(cv::norm(cv::imread(folder/("out/plain" + type)), cv::imread(folder/("out/" + name)), cv::NORM_INF) == 0);
            CHECK(mentions(turned.err, "'" + (folder/name) + "' asks for a turned picture") == (orientation != 1));
            CHECK(std::count(turned.err.begin(), turned.err.end(), '\n') == (orientation != 1));
        }
    const ToolResult both = runTool("refract_measure " + STEREO + "/truth.yml " + (folder / "turned6.jpg") + " " + image("measure2/z600_1")
                                    + TARGET + " --pixel-sigma=0.014 --quiet --out=" + (folder / "points.csv"));
    CAPTURE(both.err);
    CHECK(both.code == 0);
    CHECK(mentions(both.err, "turned6.jpg' asks for a turned picture"));
}

TEST_CASE("refract_epilines shows that the partners lie on their curves", "[tools][epilines]")
{
    const TemporaryFolder folder;
    const std::string call = "refract_epilines " + STEREO + "/truth.yml " + image("measure1/z600_1") + " "
                             + image("measure2/z600_1") + " --out=" + (folder / "picture.png");
    const ToolResult result = runTool(call + TARGET);
    CAPTURE(result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(lastNumbers(result.out).first < 0.03);
    CHECK(lastNumbers(result.out).second < 0.08);
    CHECK(result.out.find("windows ignored") != std::string::npos);
    CHECK(cv::imread(folder / "picture.png").size() == cv::Size(2*1280 + 8, 1024));

    const ToolResult exchanged = runTool("refract_epilines " + STEREO + "/truth.yml " + image("measure2/z600_1") + " "
                                         + image("measure1/z600_1") + TARGET + " --out=" + (folder / "exchanged.png"));
    CAPTURE(exchanged.err);
    CHECK(exchanged.code == 2);
    CHECK(mentions(exchanged.err, "off their curves"));
    CHECK(std::filesystem::exists(folder / "exchanged.png"));

    // Rays that meet behind the cameras only are off their curves, too: camera 2 to the other side.
    std::string calib = readFile(STEREO + "/truth.yml");
    const std::string T = "data: [ -2.1147", other = "data: [ +2.1147";
    REQUIRE(calib.find(T) != std::string::npos);
    writeFile(folder / "other.yml", calib.replace(calib.find(T), T.size(), other));
    const std::string images = " " + image("measure1/z600_1") + " " + image("measure2/z600_1") + TARGET;
    const ToolResult behind = runTool("refract_epilines " + folder / "other.yml" + images + " --out=" + folder / "other.png");
    CAPTURE(behind.out, behind.err);
    CHECK(behind.code == 2);
    CHECK(mentions(behind.err, "30 of 30 points are off their curves"));
    const ToolResult measured = runTool("refract_measure " + folder / "other.yml" + images + " --pixel-sigma=0.014 --out="
                                        + folder / "other.csv");
    CAPTURE(measured.err);
    CHECK(measured.code == 1);
    CHECK(mentions(measured.err, "What explains it: "));

    std::ofstream(folder / "points.txt") << "# u v\n640 500\n300.5, 420.25\n";
    std::ofstream(folder / "points.csv") << "id,u1,v1,u2\n0,640,500,1\n1,nan,nan,2\n";
    for (const std::string name : {"points.txt", "points.csv"})
    {
        const ToolResult points = runTool(call + " --depth=400,2000 --points=" + (folder/name));
        CAPTURE(points.err);
        CHECK(points.code == 0);
    }
}

TEST_CASE("refract_epilines names the points that are outside the image", "[tools][epilines]")
{
    const TemporaryFolder folder;
    writeFile(folder / "points.txt", "100 100\n9000 9000\n-0.4 1023.4\n");
    const ToolResult result = runTool("refract_epilines " + STEREO + "/truth.yml " + image("measure1/z600_1") + " "
        + image("measure2/z600_1") + " --points=" + (folder / "points.txt") + " --out=" + (folder / "curves.png"));
    CAPTURE(result.err);
    CHECK(result.code == 0);
    CHECK(mentions(result.err, "1 of 3 points are outside"));
    CHECK(mentions(result.err, "2 (9000 9000)"));
    CHECK(mentions(result.err, "1280x1024"));
}

TEST_CASE("An output where no file can be made is named as the user named it", "[tools][outputs]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_epilines " + STEREO + "/truth.yml " + image("measure1/z600_1") + " "
        + image("measure2/z600_1") + TARGET + " --out=/proc/x.png");
    CAPTURE(result.err);
    CHECK(result.code == 1);
    CHECK(mentions(result.err, "'/proc/x.png'"));
    CHECK_FALSE(mentions(result.err, ".lock"));
}

TEST_CASE("refract_undistort and refract_epilines refuse with one sentence and write nothing", "[tools]")
{
    const TemporaryFolder folder;
    const std::string calib = STEREO + "/truth.yml", first = image("measure1/z600_1"), second = image("measure2/z600_1");
    const std::string whole = readFile(first);
    std::ofstream(folder / "cut.jpg", std::ios::binary) << whole.substr(0, whole.size()/2);
    std::ofstream(folder / "bad.txt") << "1 2\nx y\n";
    std::ofstream(folder / "none.txt") << "# nothing\n";
    cv::imwrite(folder / "small.png", cv::Mat(100, 100, CV_8U, cv::Scalar(90)));
    cv::imwrite(folder / "blank.png", cv::Mat(1024, 1280, CV_8U, cv::Scalar(90)));
    const std::string undistort = "refract_undistort ", epilines = "refract_epilines ";
    const std::string folderOut = " --out-dir=" + (folder / "out"), picture = " --out=" + (folder / "picture.png");

    struct Case { std::string command, expected; };
    const std::vector<Case> cases = {
        {undistort + calib + " " + first + folderOut, "--depth"},
        {undistort + calib + " " + first + " --depth=600 --plane=0,0,1,600" + folderOut, "--depth"},
        {undistort + calib + " " + first + " --depth=-1" + folderOut, "--depth"},
        {undistort + calib + " " + first + " --depth=5" + folderOut, "beyond the window"},
        {undistort + calib + " " + first + " --plane=0,0,0,600" + folderOut, "--plane"},
        {undistort + calib + " " + first + " --depth=600 --out-dir=" + STEREO + "/measure1", "overwritten"},
        {undistort + calib + " " + first + " " + second + " --depth=600" + folderOut, "same name"},
        {undistort + calib + " " + (folder / "cut.jpg") + " --depth=600" + folderOut, "cut short"},
        {undistort + calib + " " + (folder / "small.png") + " --depth=600" + folderOut, "1280x1024"},
        {undistort + calib + " " + first + " --depth=600 --camera=3" + folderOut, "--camera"},
        {epilines + calib + " " + first + " " + second + picture, "--points"},
        {epilines + calib + " " + first + " " + second + TARGET + " --points=" + (folder / "bad.txt") + picture, "either"},
        {epilines + calib + " " + first + " " + second + " --points=" + (folder / "bad.txt") + picture, "line 2"},
        {epilines + calib + " " + first + " " + second + " --points=" + (folder / "none.txt") + picture, "no points"},
        {epilines + calib + " " + first + " " + second + TARGET + " --depth=5,1" + picture, "--depth"},
        {epilines + calib + " " + first + " " + second + " --size=7x6 --square=39" + picture, "6x5"},
        {epilines + calib + " " + first + " " + (folder / "small.png") + TARGET + picture, "1280x1024"},
        {epilines + calib + " " + first + " " + (folder / "blank.png") + TARGET + picture, "not found"},
        {epilines + calib + " " + first + " " + second + TARGET + " --out=" + (folder / "picture.xyz"), "extension"},
    };
    const size_t files = folder.count();
    for (const Case& c : cases)
    {
        const ToolResult result = runTool(c.command);
        CAPTURE(c.command, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(folder.count() == files);
    }
}

TEST_CASE("every tool explains itself", "[tools]")
{
    for (const std::string tool : {"refract_simulate", "refract_measure", "refract_undistort", "refract_epilines",
                                   "refract_stereo", "refract_board", "refract_bundle", "refract_calib", "refract_check", "refract_export"})
    {
        const ToolResult help = runTool(tool + " --help"), version = runTool(tool + " --version");
        CHECK(help.code == 0);
        CHECK(help.out.find(tool + " ") != std::string::npos);
        CHECK(help.out.find("--quiet") != std::string::npos);
        CHECK(version.code == 0);
        CHECK(version.out.find(tool) == 0);
    }
}
