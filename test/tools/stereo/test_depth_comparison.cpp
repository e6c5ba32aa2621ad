// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "depth_comparison.hpp"
#include "stereo/cloud_file.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <cmath>

using namespace tools;

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN(), FAR = std::numeric_limits<float>::infinity();

//! Looks along z, 100 px focal length, middle at (50, 40).
cv::Ptr<cv::refract::RefractiveCamera> plainCamera()
{
    const cv::Matx33d K(100, 0, 50, 0, 100, 40, 0, 0, 1);
    return cv::refract::RefractiveCamera::create(K, cv::noArray(), cv::refract::GlassWindow());
}

} // namespace

TEST_CASE("Depths are compared as by hand", "[tools][stereo][comparison]")
{
    const cv::Mat truth = (cv::Mat_<float>(2, 5) << 100, 100, 100, 100, NONE, 200, 200, 0, FAR, -5);
    const cv::Mat depth = (cv::Mat_<float>(2, 5) << 101, 98, NONE, 103, 70, 196, 260, 50, 50, FAR);
    const DepthComparison c = compareDepths(depth, truth);
    CHECK(c.known == 6);
    CHECK(c.matched == 5);
    CHECK(c.wrong == 2);            // 103 and 260
    CHECK(c.rms == Approx(std::sqrt((1. + 4 + 16)/3)));     // 2 % themselves are not wrong
    CHECK(c.stated == 0);

    const DepthComparison none = compareDepths(cv::Mat(2, 5, CV_32F, cv::Scalar(NONE)), truth);
    CHECK(none.matched == 0);
    CHECK(std::isnan(none.rms));
}

TEST_CASE("Stated errors are compared where camera 1 sees the points", "[tools][stereo][comparison]")
{
    cv::Mat truth(80, 100, CV_32F, cv::Scalar(500));
    truth(cv::Rect(0, 0, 20, 80)).setTo(300);
    truth(cv::Rect(90, 0, 10, 80)).setTo(NONE);
    const auto at = [](double u, double v, double z, float sigma) {
        const cv::Vec3f X((float)((u - 50)/100*z), (float)((v - 40)/100*z), (float)z);
        return MeasuredPoint{cv::Point3d(X[0], X[1], X[2]), sigma};
    };
    const std::vector<MeasuredPoint> cloud = {at(50.3, 40.7, 501, 1), at(60, 20, 497, 1), at(10, 10, 302, 1.1f), at(10, 10, 302, 1),
                         at(19.5, 10, 300, 1),      // at the edge of two surfaces
                         at(30, 30, 550, 1),        // wrong
                         at(95, 30, 500, 1), at(-5, 30, 500, 1), at(50, 40, 500, NONE)};
    DepthComparison c;
    compareSigmas(cloud, plainCamera(), truth, c);
    CHECK(c.stated == 4);
    CHECK(c.within == 2);
    compareSigmas({}, plainCamera(), truth, c);
    CHECK(c.stated == 4);
}

TEST_CASE("A cloud is read as it was written", "[tools][stereo][comparison]")
{
    const TemporaryFolder folder;
    writeCloud(folder / "cloud.ply", {{{1, 2, 500}, {0.5f, 0.25f, 2}, {1, 2, 3}}, {{-1, 0.5f, 300}, {1, 1, NONE}, {}}}, "mm");
    const std::vector<MeasuredPoint> cloud = readCloud(folder / "cloud.ply");
    REQUIRE(cloud.size() == 2);
    CHECK(cloud[0].point == cv::Point3d(1, 2, 500));
    CHECK(cloud[0].sigmaZ == 2);
    CHECK(cloud[1].point == cv::Point3d(-1, 0.5, 300));
    CHECK(std::isnan(cloud[1].sigmaZ));
}
