// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Edges of dots, to thousandths of a pixel; circle grids whose dots are large and tilted.
#include "target/circle_grid.hpp"
#include "target/refine_points.hpp"
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

using namespace cv;
using namespace tools;

namespace {

//! What a pinhole sees of dots on a board: each pixel the mean of 4 x 4 places, blurred, brighter to one side, with noise.
Mat boardImage(const std::vector<Point2d>& dots, double radius, const Matx33d& imageToBoard, double shading, double noise)
{
    scenes::Random random(7100);
    Mat image(480, 640, CV_32F);
    for (int y = 0; y < image.rows; y++)
        for (int x = 0; x < image.cols; x++)
        {
            int dark = 0;
            for (int k = 0; k < 16; k++)
            {
                const Vec3d h = imageToBoard*Vec3d(x + (k % 4 - 1.5)/4, y + (k/4 - 1.5)/4, 1);
                const Point2d p(h[0]/h[2], h[1]/h[2]);
                dark += std::any_of(dots.begin(), dots.end(), [&](const Point2d& d) { return norm(p - d) < radius; });
            }
            const double light = 1 + shading*(x - 320.)/640;
            image.at<float>(y, x) = (float)(light*(200 - 170*dark/16.) + random.normal(noise));
        }
    GaussianBlur(image, image, Size(), 0.8);
    image.convertTo(image, CV_8U);
    return image;
}

} // namespace

TEST_CASE("Dots of a tilted board are found where their centres are", "[target][circles]")
{
    const Size size(6, 5);
    std::vector<Point2d> dots;
    for (int i = 0; i < size.area(); i++)
        dots.emplace_back(i % size.width, i/size.width);
    const Matx33d K(900, 0, 320, 0, 900, 240, 0, 0, 1);
    for (double tilt : {0., 20., 40.})
        for (double radius : {0.2, 0.3, 0.38})
        {
            Matx33d R;
            Rodrigues(Vec3d(0.3, -1, 0.2)*(tilt*CV_PI/180), R);
            const Vec3d t(-2.4, -2, 10);
            const Matx33d H = K*Matx33d(R(0, 0), R(0, 1), t[0], R(1, 0), R(1, 1), t[1], R(2, 0), R(2, 1), t[2]);
            const std::vector<Point2d> found = detectCircleGrid(boardImage(dots, radius, H.inv(), 0.4, 1), size, false);
            CAPTURE(tilt, radius);
            REQUIRE(found.size() == dots.size());
            double squares[2] = {0, 0}, uncorrected = 0;        // counted from either end
            for (size_t i = 0; i < dots.size(); i++)
            {
                const Vec3d h = H*Vec3d(dots[i].x, dots[i].y, 1);
                for (int end : {0, 1})
                    squares[end] += std::pow(norm(found[end ? dots.size() - 1 - i : i] - Point2d(h[0]/h[2], h[1]/h[2])), 2);
                const Matx33d dual = H*Matx33d(dots[i].x*dots[i].x - radius*radius, dots[i].x*dots[i].y, dots[i].x, dots[i].x*dots[i].y,
                                               dots[i].y*dots[i].y - radius*radius, dots[i].y, dots[i].x, dots[i].y, 1)*H.t();
                const Point2d off = Point2d(dual(0, 2)/dual(2, 2), dual(1, 2)/dual(2, 2)) - Point2d(h[0]/h[2], h[1]/h[2]);
                uncorrected += off.dot(off);
            }
            const double rms = std::sqrt(std::min(squares[0], squares[1])/(double)dots.size());
            std::cout << "[numbers] dots of " << radius << " of their distance, tilted by " << tilt << " degrees: " << rms
                      << " px RMS off; the middles of their images are "
                      << std::sqrt(uncorrected/(double)dots.size()) << " off" << std::endl;
            CHECK(rms < 0.025);
        }
}

TEST_CASE("A plate of a thousand dots is found", "[target][circles]")
{
    const Size size(40, 25);
    Mat image(25*24 + 40, 40*24 + 40, CV_8U, Scalar(220));
    for (int i = 0; i < size.area(); i++)
        circle(image, Point(32 + 24*(i % size.width), 32 + 24*(i/size.width)), 7, Scalar(30), FILLED, LINE_AA);
    const std::vector<Point2d> found = detectCircleGrid(image, size, false);
    REQUIRE((int)found.size() == size.area());      // counted from any corner
    CHECK(std::all_of(found.begin(), found.end(), [](const Point2d& p) {
        return std::abs(std::remainder(p.x - 32, 24)) < 0.1 && std::abs(std::remainder(p.y - 32, 24)) < 0.1; }));
}

TEST_CASE("A dot whose surroundings do not do stays where the blob is", "[target][circles]")
{
    std::vector<DotImage> dots = {{Point2d(50, 50), Matx22d(0.1, 0, 0, 0.1)}, {Point2d(-40, 1e6), Matx22d(0.1, 0, 0, 0.1)}};
    const std::vector<DotImage> before = dots;
    refineDots(Mat(100, 100, CV_8U, Scalar(80)), dots, {3, 3});      // nothing to see
    for (size_t i = 0; i < dots.size(); i++)
        CHECK(dots[i].centre == before[i].centre);
    refineDots(Mat(100, 100, CV_8U, Scalar(80)), dots, {0.9, 0.9});    // no room
    CHECK(dots[0].centre == before[0].centre);
}
