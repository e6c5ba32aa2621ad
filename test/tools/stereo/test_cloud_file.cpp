// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/failure.hpp"
#include "stereo/cloud_file.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

using namespace tools;

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN();

std::string contentsOf(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}

//! Header and what follows it.
std::pair<std::string, std::string> partsOf(const std::string& path)
{
    const std::string text = contentsOf(path), end = "end_header\n";
    const size_t at = text.find(end);
    REQUIRE(at != std::string::npos);
    return {text.substr(0, at), text.substr(at + end.size())};
}

//! Little endian, least byte first.
float floatAt(const std::string& bytes, size_t at)
{
    uint32_t bits = 0;
    for (int i = 0; i < 4; i++)
        bits |= (uint32_t)(unsigned char)bytes[at + i] << 8*i;
    float number;
    std::memcpy(&number, &bits, sizeof number);
    return number;
}

const Cloud TWO = {{{1.5f, -2.25f, 600.125f}, {0.1f, 0.2f, 0.3f}, {255, 128, 7}},
                   {{0, 1e-3f, 12345.678f}, {NONE, NONE, NONE}, {0, 1, 2}}};

} // namespace

TEST_CASE("A cloud has the points that exist, with their colours", "[tools][stereo][cloud]")
{
    cv::Mat points(2, 2, CV_32FC3, cv::Scalar::all(NONE)), sigma(2, 2, CV_32FC3, cv::Scalar::all(NONE));
    points.at<cv::Vec3f>(0, 1) = cv::Vec3f(1, 2, 3);
    points.at<cv::Vec3f>(1, 0) = cv::Vec3f(4, 5, 6);
    points.at<cv::Vec3f>(1, 1) = cv::Vec3f(1, 1, std::numeric_limits<float>::infinity());
    sigma.at<cv::Vec3f>(1, 0) = cv::Vec3f(0.1f, 0.2f, 0.3f);
    cv::Mat colour(2, 2, CV_8UC3, cv::Scalar(10, 20, 30)), grey(2, 2, CV_8U, cv::Scalar(99));
    const Cloud cloud = cloudOf(points, colour, sigma);
    REQUIRE(cloud.size() == 2);
    CHECK(cloud[0].position == cv::Vec3f(1, 2, 3));
    CHECK(std::isnan(cloud[0].sigma[2]));
    CHECK(cloud[0].colour == cv::Vec3b(30, 20, 10));        // red first
    CHECK(cloud[1].sigma == cv::Vec3f(0.1f, 0.2f, 0.3f));
    const Cloud unknown = cloudOf(points, grey, cv::Mat());
    REQUIRE(unknown.size() == 2);
    CHECK(unknown[1].colour == cv::Vec3b(99, 99, 99));
    CHECK(std::isnan(unknown[1].sigma[0]));
}

TEST_CASE("A cloud's file says what is in it, and holds it to the last bit", "[tools][stereo][cloud]")
{
    const TemporaryFolder folder;
    writeCloud(folder / "c.ply", TWO, "mm");
    const auto [header, body] = partsOf(folder / "c.ply");
    CHECK(header.find("ply\nformat binary_little_endian 1.0\n") == 0);
    CHECK(header.find("comment unit mm\n") != std::string::npos);
    CHECK(header.find("element vertex 2\n"
                      "property float x\nproperty float y\nproperty float z\n"
                      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                      "property float sx\nproperty float sy\nproperty float sz\n") != std::string::npos);
    REQUIRE(body.size() == 2*27);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
        {
            CHECK(floatAt(body, 27*i + 4*k) == TWO[i].position[k]);
            CHECK((uchar)body[27*i + 12 + k] == TWO[i].colour[k]);
            const float sigma = floatAt(body, 27*i + 15 + 4*k);
            CHECK((i == 0 ? sigma == TWO[0].sigma[k] : std::isnan(sigma)));
        }
    writeCloud(folder / "none.ply", {}, "");
    CHECK(partsOf(folder / "none.ply").first.find("unit") == std::string::npos);
    CHECK(partsOf(folder / "none.ply").second.empty());
}

TEST_CASE("A cloud that cannot be written leaves nothing behind", "[tools][stereo][cloud]")
{
    const TemporaryFolder folder;
    CHECK_THROWS_AS(writeCloud(folder / "no/c.ply", TWO, "mm"), Failure);
    CHECK_THROWS_AS(writeCloud("/dev/full", Cloud(1000, TWO[0]), "mm"), Failure);
    CHECK(folder.count() == 0);
}
