// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which matches the images support.
#include "stereo/match_support.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace tools;
using cv::Mat;

TEST_CASE("Matches of flat areas and of noise rest on nothing", "[tools][stereo][support]")
{
    const cv::Size size(120, 90);
    cv::RNG random(3);
    Mat texture(size.height, size.width + 8, CV_8U), other(size, CV_8U);
    random.fill(texture, cv::RNG::NORMAL, 120, 40);
    random.fill(other, cv::RNG::NORMAL, 120, 40);
    Mat disparity(size, CV_32F, cv::Scalar(8));
    disparity.colRange(0, 20).setTo(std::numeric_limits<float>::quiet_NaN());
    const int matched = 100*size.height;
    // What is at x in the first is at x - 8 in the second.
    const Mat first = texture(cv::Rect(0, 0, size.width, size.height)).clone();
    const Mat second = texture(cv::Rect(8, 0, size.width, size.height)).clone();
    const MatchSupport right = supportOf(first, second, disparity);
    CHECK(right.supported > 0.95*matched);
    CHECK(right.textured <= matched);
    CHECK(right.share() > 0.95);
    CHECK(cv::countNonZero(right.mask) == right.supported);
    CHECK(cv::countNonZero(right.nearby) == matched);           // never one that is no match
    CHECK(supportOf(first, other, disparity).supported < 0.01*matched);
    const Mat flat(size, CV_8U, cv::Scalar(90));
    const MatchSupport nothing = supportOf(flat, flat, disparity);
    CHECK(nothing.textured == 0);
    CHECK(std::isnan(nothing.share()));
    CHECK(cv::countNonZero(nothing.nearby) == 0);
}

TEST_CASE("Noise as strong as the texture is no support, weaker noise takes none away", "[tools][stereo][support]")
{
    const cv::Size size(200, 150);
    const Mat disparity(size, CV_32F, cv::Scalar(0));
    for (const double noise : {2., 5., 40.})
    {
        cv::RNG random(5);
        Mat scene(size, CV_16S), images[2];
        random.fill(scene, cv::RNG::NORMAL, 120, 15);
        for (Mat& image : images)
        {
            Mat added(size, CV_16S);
            random.fill(added, cv::RNG::NORMAL, 0, noise);
            Mat(scene + added).convertTo(image, CV_8U);
        }
        const MatchSupport support = supportOf(images[0], images[1], disparity);
        INFO("noise " << noise << ": " << support.supported << " of " << support.textured);
        CHECK((noise < 15 ? support.supported > 0.95*(double)size.area() : support.supported < 0.01*size.area()));
    }
}
