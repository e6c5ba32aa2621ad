// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Balls in images: where they are, and how well that is known.
#include "drawn_balls.hpp"
#include "target/ball_image.hpp"

#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! What a camera shows of one ball at a time.
struct Shot
{
    double radius, blur, shading = 0;       //!< px, grey levels
    bool bright = true;
    int quality = 0;                        //!< of JPEG; 0: not compressed
};

struct Errors
{
    double squares = 0, off = 0, std = 0;   //!< of errors over what is stated; px^2; px
    int found = 0;
    double ratio() const { return std::sqrt(squares/found); }
};

Errors errorsOf(const Shot& shot, int trials, scenes::Random& random)
{
    const int width = std::max(180, (int)(8*shot.radius));
    const double middle = 0.5*(width - 1);
    const Size size(width, width);
    const Matx33d K(3000, 0, middle, 0, 3000, middle, 0, 0, 1);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray());
    camera->setImageSize(size);
    Matx33d R;
    Rodrigues(Vec3d(-0.4, 0.5, 0), R);              // light comes from the left, above and behind
    const drawn_balls::View view = {camera, R, Vec3d()};
    const auto taken = [&](const Mat& image) {
        const Mat noisy = drawn_balls::exposed(image, 2, random);
        std::vector<uchar> bytes;
        if (!shot.quality)
            return noisy;
        imencode(".jpg", noisy, bytes, {IMWRITE_JPEG_QUALITY, shot.quality});
        return imdecode(bytes, IMREAD_GRAYSCALE);
    };
    const Mat still = drawn_balls::tank(size, shot.bright ? 25 : 190, shot.bright ? 45 : 210);
    std::vector<Mat> others;
    for (int i = 0; i < 15; i++)
        others.push_back(taken(still));
    const Mat background = stillBackground(others);
    Errors errors;
    for (int trial = 0; trial < trials; trial++)
    {
        const Point2d at(middle + random.uniform(-7.5, 7.5), middle + random.uniform(-7.5, 7.5));
        const Vec3d ray = K.inv()*Vec3d(at.x, at.y, 1);
        Mat image = still.clone();
        drawn_balls::draw({Point3d(R.t()*ray*1000), shot.radius/3, shot.bright ? 200. : 90., shot.bright ? shot.shading : 0.5*shot.shading},
                          view, shot.blur, image);
        const std::vector<BallImage> balls = ballsIn(taken(image), background, shot.bright);
        if (balls.size() != 1)
            continue;
        const Point2d error = balls[0].outline.centre - at;
        errors.squares += error.dot(error)/(2*balls[0].std*balls[0].std);
        errors.off += error.dot(error)/2;
        errors.std += balls[0].std;
        errors.found++;
    }
    std::cout << "[numbers] balls of " << shot.radius << " px, blur " << shot.blur << ", shading " << shot.shading << ", "
              << (shot.bright ? "bright" : "dark") << ", quality " << shot.quality << ", seed " << scenes::seed() << ": " << errors.found
              << " of " << trials << " found, " << std::sqrt(errors.off/errors.found) << " px off, stated " << errors.std/errors.found
              << ", ratio " << errors.ratio() << std::endl;
    return errors;
}

//! Of all of these, each alike.
double ratioOf(const std::vector<Shot>& shots, int trials, unsigned salt)
{
    scenes::Random random(salt);
    double squares = 0;
    for (const Shot& shot : shots)
    {
        const Errors errors = errorsOf(shot, trials, random);
        CAPTURE(shot.radius, shot.blur, shot.shading, shot.bright, shot.quality);
        CHECK(errors.found == trials);
        squares += errors.squares/errors.found/(double)shots.size();
    }
    std::cout << "[numbers] all balls, seed " << scenes::seed() << ": error over stated " << std::sqrt(squares) << std::endl;
    return std::sqrt(squares);
}

} // namespace

TEST_CASE("The middles of balls' images are as far off as is stated, small or large, light or dark, sharp or not", "[target][balls]")
{
    std::vector<Shot> shots;
    for (double radius : {3., 5., 10., 22.})
        for (double blur : {0.6, 1.2})
            for (double shading : {0., 60.})
                for (bool bright : {true, false})
                    shots.push_back({radius, blur, shading, bright});
    const double ratio = ratioOf(shots, scenes::trials(12), 4540);
    CHECK(ratio > 0.9);
    CHECK(ratio < 1.1);
}

TEST_CASE("The std of large balls' middles is as right, of whose pixels some are taken together", "[target][balls]")
{
    std::vector<Shot> shots;
    for (double radius : {27., 45., 70.})
        for (double blur : {0.5, 1.5})
            shots.push_back({radius, blur, 30, blur > 1});
    const double ratio = ratioOf(shots, scenes::trials(20), 4544);
    CHECK(ratio > 0.9);
    CHECK(ratio < 1.1);
}

TEST_CASE("The noise that compressed images share between pixels is in the std of a ball's middle", "[target][balls]")
{
    std::vector<Shot> shots;
    for (double radius : {4., 8., 20.})
        for (int quality : {95, 88})
            shots.push_back({radius, 0.8, 0, true, quality});
    const double ratio = ratioOf(shots, scenes::trials(60), 4542);
    CHECK(ratio > 0.9);
    CHECK(ratio < 1.1);
}

TEST_CASE("A ball that is blurred to a spot without an outline is none", "[target][balls]")
{
    scenes::Random random(4543);
    CHECK(errorsOf({2.5, 2.5}, 10, random).found == 0);
    CHECK(errorsOf({2.5, 1.2}, 10, random).found == 10);
}

TEST_CASE("Of very many balls the brightest are looked at, which is said", "[target][balls]")
{
    scenes::Random random(4545);
    const Mat background(240, 320, CV_8U, Scalar(30));
    for (int count : {12, 20})
    {
        Mat image;
        background.convertTo(image, CV_32F);
        for (int i = 0; i < count; i++)
            circle(image, Point(30 + 60*(i % 5), 30 + 50*(i/5)), 6, Scalar(100 + 5*i), -1, LINE_AA);
        GaussianBlur(image, image, Size(), 0.8);
        bool crowded;
        CHECK(ballsIn(drawn_balls::exposed(image, 1, random), background, true, &crowded).size() == 12);
        CHECK(crowded == (count > 12));
    }
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
