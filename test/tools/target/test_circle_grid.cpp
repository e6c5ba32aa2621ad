// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Plates of dots as they are in the field: some covered, some larger than the others.
#include "console/numbers.hpp"
#include "target/dot_lattice.hpp"
#include "target/target.hpp"
#include "field_boards.hpp"
#include <catch2/catch.hpp>

using namespace tools;
using namespace field_boards;
using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Size;

namespace {

struct Dots
{
    Size size;
    bool asymmetric;
    std::vector<int> missing, large;
    double largeRadius = 0.42;

    bool isDark(const Point2d& p) const
    {
        for (int row = std::max(cvFloor(p.y), 0); row <= std::min(cvFloor(p.y) + 1, size.height - 1); row++)
            for (int column = 0; column < size.width; column++)
            {
                const int i = row*size.width + column, x = asymmetric ? 2*column + row % 2 : column;
                const bool isLarge = std::count(large.begin(), large.end(), i) > 0;
                if (cv::norm(p - Point2d(x, row)) < (isLarge ? largeRadius : 0.26)*(asymmetric ? 1.4 : 1.)
                    && !std::count(missing.begin(), missing.end(), i))
                    return true;
            }
        return false;
    }
};

//! Largest error of the points that were found; those of a board that looks the same turned by half may begin at the other end.
double worst(const std::vector<Point2d>& found, const Target& target, const Matx33d& H, const std::vector<int>& missing)
{
    double least = INFINITY;
    for (bool turned : {false, true})
    {
        double most = 0;
        for (int i = 0; i < target.count(); i++)
        {
            const int of = turned ? target.count() - 1 - i : i;
            const cv::Point3d p = target.objectPoints()[of];
            const bool gone = std::count(missing.begin(), missing.end(), of) > 0;
            most = std::max(most, gone != !seen(found[i]) ? INFINITY
                            : gone ? 0. : cv::norm(found[i] - through(H, Point2d(p.x, p.y)/target.square())));
        }
        least = std::min(least, most);
    }
    return least;
}

} // namespace

TEST_CASE("Plates of dots of which some are covered are found, and the others stay where they are", "[target][circles]")
{
    const Dots plates[] = {{Size(9, 7), false, {31}, {}}, {Size(9, 7), false, {0, 8, 20, 21, 22, 40}, {}},
                           {Size(8, 8), false, {9, 63}, {}}, {Size(5, 9), true, {0, 12, 22}, {}}, {Size(4, 11), true, {17}, {}}};
    for (const Dots& plate : plates)
        for (double degrees : {4., 130.})
        {
            CAPTURE(plate.size, plate.asymmetric, degrees);
            const Target target(board(plate.asymmetric ? "acircles" : "circles", sizeText(plate.size)));
            const double wide = plate.asymmetric ? 2*plate.size.width : plate.size.width;
            const Matx33d H = boardToImage(plate.asymmetric ? 40 : 55, degrees, 3e-4, Point2d(0.5*wide, 0.5*plate.size.height));
            const std::vector<Point2d> found = target.detect(picture(H, [&](const Point2d& p) { return plate.isDark(p); }));
            REQUIRE((int)found.size() == target.count());
            if (plate.size.width != plate.size.height)
                CHECK(worst(found, target, H, plate.missing) < 0.06);
            CHECK(std::count_if(found.begin(), found.end(), seen) == target.count() - (long)plate.missing.size());
        }
}

TEST_CASE("Larger dots that mark the middle of a plate are found as the others are", "[target][circles]")
{
    const Dots plate = {Size(9, 7), false, {}, {21, 31, 40}};
    const Target target(board("circles", "9x7"));
    for (double tilt : {0., 6e-4})
    {
        const Matx33d H = boardToImage(60, 10, tilt, Point2d(4, 3));
        const std::vector<Point2d> found = target.detect(picture(H, [&](const Point2d& p) { return plate.isDark(p); }));
        REQUIRE((int)found.size() == target.count());
        const double most = worst(found, target, H, {});
        std::cout << "[numbers] plate with larger dots, tilt " << tilt << ": worst " << most << " px off" << std::endl;
        CHECK(most < 0.06);
    }
}

TEST_CASE("A plate of dots of another size is called one", "[target][circles]")
{
    const Dots plate = {Size(9, 7), false, {31}, {}};
    const Mat image = picture(boardToImage(50, 4, 2e-4, Point2d(4, 3)), [&](const Point2d& p) { return plate.isDark(p); });
    for (const TargetOptions& options : {board("circles", "10x7"), board("chessboard", "10x7"), board("aprilgrid", "3x2")})
    {
        CHECK(Target(options).detect(image).empty());
        const std::string text = explained(image, options);
        INFO(text);
        CHECK(text.find("look like a plate of 9x7 dots") != std::string::npos);
    }
}

TEST_CASE("A plate whose outer row is covered is no smaller plate with a free choice of rows", "[target][circles]")
{
    Dots plate = {Size(9, 7), false, {}, {}};
    for (int i = 0; i < 9; i++)
        plate.missing.push_back(i);
    const Mat image = picture(boardToImage(50, 4, 2e-4, Point2d(4, 3)), [&](const Point2d& p) { return plate.isDark(p); });
    CHECK(Target(board("circles", "9x7")).detect(image).empty());
    CHECK(explained(image, board("circles", "9x7")).find("keep its outer rows") != std::string::npos);
}

TEST_CASE("A plate of the right size of which too little is seen is not called one of another size", "[target][circles][missing]")
{
    const Dots plates[] = {{Size(9, 7), false, {0, 1, 2, 3, 4}, {}}, {Size(4, 11), true, {0, 1, 2}, {}}};
    for (const Dots& plate : plates)
    {
        const Matx33d H = boardToImage(plate.asymmetric ? 40 : 50, 4, 2e-4, Point2d(4, 0.5*plate.size.height));
        const Mat image = picture(H, [&](const Point2d& p) { return plate.isDark(p); });
        const TargetOptions options = board(plate.asymmetric ? "acircles" : "circles", sizeText(plate.size));
        CHECK(Target(options).detect(image).empty());
        const std::string text = explained(image, options);
        INFO(text);
        CHECK(text.find("too little is seen") != std::string::npos);
        CHECK(text.find("--size") == std::string::npos);
    }
}

TEST_CASE("The size of an asymmetric plate is told, however it is turned", "[target][circles][missing]")
{
    for (const Size& size : {Size(4, 11), Size(5, 9)})
        for (double degrees : {4., 50., 94., 140., 184., 230., 274., 320.})
        {
            CAPTURE(size, degrees);
            const Dots plate = {size, true, {}, {}};
            const Matx33d H = boardToImage(40, degrees, 2e-4, Point2d(size.width, 0.5*size.height));
            bool asymmetric = false;
            CHECK(dotGridIn(picture(H, [&](const Point2d& p) { return plate.isDark(p); }), asymmetric) == size);
            CHECK(asymmetric);
        }
}

TEST_CASE("One dot that is much larger than the others leaves those far from it as precise", "[target][circles]")
{
    const Dots plate = {Size(9, 7), false, {}, {31}, 0.65};
    const Target target(board("circles", "9x7"));
    const Matx33d H = boardToImage(38, 10, 3e-4, Point2d(4, 3));
    Mat image = picture(H, [&](const Point2d& p) { return plate.isDark(p); });
    for (int x = 0; x < image.cols; x++)            // light from one side: one threshold for all is not half-way of each
        image.col(x) *= 0.4 + 0.6*x/image.cols;
    const std::vector<Point2d> found = target.detect(image);
    REQUIRE((int)found.size() == target.count());
    double most = 0;
    for (int i = 0; i < target.count(); i++)
        if (std::abs(i % 9 - 4) > 1 || std::abs(i/9 - 3) > 1)
        {
            double off = INFINITY;
            for (const int of : {i, target.count() - 1 - i})
                off = std::min(off, cv::norm(found[i] - through(H, Point2d(of % 9, of/9))));
            most = std::max(most, off);
        }
    std::cout << "[numbers] plate with one large dot, radii of 10 px: worst of the others " << most << " px off" << std::endl;
    CHECK(most < 0.06);
}
