// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Balls in images: where they are, and how well that is known.
#include "drawn_balls.hpp"
#include "target/ball_image.hpp"

#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

TEST_CASE("The middles of balls' images are as far off as is stated, small or large, light or dark, sharp or not", "[target][balls]")
{
    const Size size(180, 180);
    const Matx33d K(3000, 0, 89.5, 0, 3000, 89.5, 0, 0, 1);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray());
    camera->setImageSize(size);
    Matx33d R;
    Rodrigues(Vec3d(-0.4, 0.5, 0), R);              // light comes from the left, above and behind
    const drawn_balls::View view = {camera, R, Vec3d()};
    scenes::Random random(4540);
    const int trials = scenes::trials(12);
    double all = 0;
    int configurations = 0;
    for (double radius : {3., 5., 10., 22.})
        for (double blur : {0.6, 1.2})
            for (double shading : {0., 60.})
                for (bool bright : {true, false})
                {
                    double squares = 0, std = 0, off = 0;
                    int count = 0;
                    const Mat still = drawn_balls::tank(size, bright ? 25 : 190, bright ? 45 : 210);
                    std::vector<Mat> others;
                    for (int i = 0; i < 15; i++)
                        others.push_back(drawn_balls::exposed(still, 2, random));
                    const Mat background = stillBackground(others);
                    for (int trial = 0; trial < trials; trial++)
                    {
                        const Point2d at(random.uniform(82, 97), random.uniform(82, 97));
                        const Vec3d ray = K.inv()*Vec3d(at.x, at.y, 1);
                        const drawn_balls::Ball ball = {Point3d(R.t()*ray*1000), radius/3, bright ? 200. : 90.,
                                                        bright ? shading : 0.5*shading};
                        Mat image = still.clone();
                        drawn_balls::draw(ball, view, blur, image);
                        const std::vector<BallImage> found = ballsIn(drawn_balls::exposed(image, 2, random), background, bright);
                        if (found.size() != 1)
                            continue;
                        const Point2d error = found[0].outline.centre - at;
                        squares += error.dot(error)/(2*found[0].std*found[0].std);
                        off += error.dot(error)/2;
                        std += found[0].std;
                        count++;
                    }
                    const double ratio = std::sqrt(squares/count);
                    std::cout << "[numbers] balls of " << radius << " px, blur " << blur << ", shading " << shading << ", "
                              << (bright ? "bright" : "dark") << ", seed " << scenes::seed() << ": " << count << " of " << trials
                              << " found, " << std::sqrt(off/count) << " px off, stated " << std/count << ", ratio " << ratio << std::endl;
                    CAPTURE(radius, blur, shading, bright);
                    CHECK(count == trials);
                    all += ratio*ratio;
                    configurations++;
                }
    const double ratio = std::sqrt(all/configurations);
    std::cout << "[numbers] all balls, seed " << scenes::seed() << ": error over stated " << ratio << std::endl;
    CHECK(ratio > 0.9);
    CHECK(ratio < 1.1);
}

TEST_CASE("What stands still and what is not round is no ball", "[target][balls]")
{
    scenes::Random random(4541);
    const Size size(320, 240);
    Mat still = drawn_balls::tank(size, 20, 60, {Point2d(60, 50), Point2d(250, 180)});
    std::vector<Mat> others;
    for (int i = 0; i < 9; i++)
        others.push_back(drawn_balls::exposed(still, 2, random));
    const Mat background = stillBackground(others);
    CHECK(ballsIn(drawn_balls::exposed(still, 2, random), background, true).empty());
    Mat image = still.clone();
    line(image, Point(20, 200), Point(140, 120), Scalar(180), 4);           // the wand's stick
    circle(image, Point(160, 100), 8, Scalar(220), -1, LINE_AA);
    circle(image, Point(318, 20), 8, Scalar(220), -1, LINE_AA);             // cut by the edge
    GaussianBlur(image, image, Size(), 0.8);
    const std::vector<BallImage> balls = ballsIn(drawn_balls::exposed(image, 2, random), background, true);
    REQUIRE(balls.size() == 1);
    CHECK(norm(balls[0].outline.centre - Point2d(160, 100)) < 0.1);
    CHECK(ballsIn(drawn_balls::exposed(image, 2, random), background, false).empty());
}
