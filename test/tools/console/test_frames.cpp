// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/failure.hpp"
#include "console/frames.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <fstream>

using namespace tools;

namespace {

void writeGrey(const std::string& path, int grey) { cv::imwrite(path, cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(grey))); }

//! Frames that get brighter.
void writeVideo(const std::string& path, int frames)
{
    cv::VideoWriter video(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, cv::Size(64, 48));
    REQUIRE(video.isOpened());
    for (int i = 0; i < frames; i++)
        video.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40*(i + 1))));
}

int greyOf(const cv::Mat& image) { return cvRound(cv::mean(image)[1]); }

} // namespace

TEST_CASE("Frames are an image, a glob, numbered images or a video", "[tools][frames]")
{
    const TemporaryFolder folder;
    for (const int i : {2, 10, 9})
    {
        writeGrey(folder / cv::format("n%d.png", i), 10*i);
        writeGrey(folder / cv::format("p%03d_x.png", i), 10*i);
    }
    writeGrey(folder / "p0011_x.png", 5);       // four digits, but not for want of room
    writeVideo(folder / "v.avi", 4);

    Frames one(folder / "n9.png"), all(folder / "n*.png"), sequence(folder / "n%d.png"), padded(folder / "p%03d_x.png"),
           video(folder / "v.avi");
    REQUIRE(one.size() == 1);
    CHECK(one.stem(0) == "n9");
    REQUIRE(all.size() == 3);
    CHECK(all.stem(0) == "n10");                // by name
    CHECK(!all.numbered());
    for (Frames* frames : {&sequence, &padded})
    {
        REQUIRE(frames->size() == 3);           // by number
        CHECK(frames->numbered());
        CHECK(frames->stem(0) == "frame000002");
        CHECK(frames->stem(2) == "frame000010");
        CHECK(greyOf(frames->read(1)) == 90);
    }
    REQUIRE(video.size() == 4);
    CHECK(video.isVideo());
    CHECK(video.stem(0) == "frame000001");
    CHECK(video.name(3) == (folder / "v.avi") + ", frame 4");
    for (const int i : {0, 1, 3, 2, 0, 3})      // back again, too
        CHECK(std::abs(greyOf(video.read(i)) - 40*(i + 1)) < 4);
}

TEST_CASE("What is no frame is refused in one sentence", "[tools][frames]")
{
    const TemporaryFolder folder;
    std::ofstream(folder / "text.avi") << "hello\n";
    std::ofstream(folder / "empty.mp4");
    writeVideo(folder / "a.avi", 2);
    writeVideo(folder / "b.avi", 2);
    for (const std::string name : {"text.avi", "empty.mp4", "none.png", "none.avi", "n%d.png", "*.png", "?.avi"})
    {
        CAPTURE(name);
        CHECK_THROWS_AS(Frames(folder/name), Failure);
    }
}

TEST_CASE("Images of one moment have one stem, frames one number", "[tools][frames]")
{
    const TemporaryFolder folder;
    for (const char* camera : {"l", "r"})
        for (const char* name : {"a", "b"})
        {
            std::filesystem::create_directories(folder/camera);
            writeGrey(folder/camera + "/" + name + ".png", 50);
        }
    writeGrey(folder / "l/only.png", 50);
    writeGrey(folder / "r/other.png", 50);
    const FramePairs pairs = pairsOf(Frames(folder / "l/*"), Frames(folder / "r/*"));
    REQUIRE(pairs.pairs.size() == 2);
    CHECK(pairs.pairs[1].stem == "b");
    CHECK(pairs.unpaired1 == std::vector<std::string>{"only"});
    CHECK(pairs.unpaired2 == std::vector<std::string>{"other"});
    CHECK(pairsOf(Frames(folder / "l/a.png"), Frames(folder / "r/b.png")).pairs.at(0).stem == "a");

    writeVideo(folder / "l.avi", 3);
    writeVideo(folder / "r.avi", 3);
    writeVideo(folder / "short.avi", 2);
    CHECK(pairsOf(Frames(folder / "l.avi"), Frames(folder / "r.avi")).pairs.size() == 3);
    CHECK_THROWS_WITH(pairsOf(Frames(folder / "l.avi"), Frames(folder / "short.avi")), Catch::Contains("3 and 2"));
    CHECK_THROWS_WITH(pairsOf(Frames(folder / "l.avi"), Frames(folder / "l.avi")), Catch::Contains("both cameras"));
    std::filesystem::create_symlink(folder / "l/a.png", folder / "link.png");
    CHECK_THROWS_WITH(pairsOf(Frames(folder / "l/a.png"), Frames(folder / "link.png")), Catch::Contains("both cameras"));
    CHECK_THROWS_WITH(pairsOf(Frames(folder / "l/*"), Frames(folder / "r/other.png")), Catch::Contains("equal names"));
    writeGrey(folder / "l/a.jpg", 50);
    CHECK_THROWS_WITH(pairsOf(Frames(folder / "l/*"), Frames(folder / "r/*")), Catch::Contains("called 'a'"));
}

TEST_CASE("More bits become eight by one factor for both images", "[tools][frames]")
{
    cv::Mat one(2, 2, CV_16U, cv::Scalar(10000)), two(2, 2, CV_16UC3, cv::Scalar::all(5000));
    makeEightBit(one, two);
    CHECK(one.type() == CV_8U);
    CHECK(two.type() == CV_8UC3);
    CHECK(one.at<uchar>(0) == 255);
    CHECK(std::abs(two.at<cv::Vec3b>(0)[0] - 127.5) <= 0.5);
    cv::Mat black(2, 2, CV_16U, cv::Scalar(0)), bytes(2, 2, CV_8U, cv::Scalar(77));
    makeEightBit(black, bytes);
    CHECK(black.type() == CV_8U);
    CHECK(bytes.at<uchar>(0) == 77);
}
