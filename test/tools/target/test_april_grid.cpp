// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Kalibr's AprilGrid: its tags and their places, found in images.
#include "console/failure.hpp"
#include "target/april_grid.hpp"
#include "target/target.hpp"
#include "target/target_search.hpp"
#include "field_boards.hpp"
#include <catch2/catch.hpp>

using namespace tools;
using namespace field_boards;
using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Size;

namespace {

const int FINE_TAG = 200;           // pixels of a tag that is drawn
const double SPACING = 0.3;

struct DrawnTags
{
    Mat drawn;
    bool operator()(const Point2d& p) const
    {
        const cv::Point at(cvFloor((p.x + SPACING)*FINE_TAG), cvFloor((p.y + SPACING)*FINE_TAG));
        return cv::Rect(cv::Point(), drawn.size()).contains(at) && drawn.at<uchar>(at) == 0;
    }
};

Mat aprilPicture(Size tags, const Matx33d& H) { return picture(H, DrawnTags{drawAprilGrid(tags, SPACING, FINE_TAG)}); }

//! Largest error of the corners of tags that were seen.
template <typename ToImage>
double worstCorner(const std::vector<Point2d>& found, const Target& target, const ToImage& toImage)
{
    double most = 0;
    for (int i = 0; i < target.count(); i++)
        if (seen(found[i]))
            most = std::max(most, cv::norm(found[i] - toImage(Point2d(target.objectPoints()[i].x, target.objectPoints()[i].y)
                                                              /target.square())));
    return most;
}

} // namespace

TEST_CASE("An AprilGrid is found, whatever its turn, and tags of which a part is hidden are not", "[target][aprilgrid]")
{
    const Target target(board("aprilgrid", "5x4"));
    CHECK(target.count() == 80);
    CHECK(target.objectPoints()[2].x == Approx(30*1.3));
    for (double degrees : {0., 90., 200.})
        for (double tilt : {0., 4e-4})
        {
            CAPTURE(degrees, tilt);
            const Matx33d H = boardToImage(90, degrees, tilt, Point2d(3.1, 2.5));
            Mat image = aprilPicture(Size(5, 4), H);
            std::vector<Point2d> found = target.detect(image);
            REQUIRE((int)found.size() == target.count());
            CHECK(std::count_if(found.begin(), found.end(), seen) > 60);        // one is cut by the image's border
            const double most = worstCorner(found, target, [&](const Point2d& p) { return through(H, p); });
            std::cout << "[numbers] AprilGrid turned by " << degrees << ", tilt " << tilt << ": worst corner " << most << " px off\n";
            CHECK(most < 0.1);
            // A hand over the first tag of the second row.
            const Point2d hidden = through(H, Point2d(0.5, 1.8));
            cv::circle(image, hidden, 40, cv::Scalar(120), cv::FILLED);
            found = target.detect(image);
            REQUIRE((int)found.size() == target.count());
            CHECK(!seen(found[2*10]));
            CHECK(seen(found[3]));
        }
}

TEST_CASE("Tags in another order than Kalibr's are refused by name", "[target][aprilgrid]")
{
    const Mat drawn = drawAprilGrid(Size(5, 4), 0.3, 60);
    Mat other(drawn.size(), CV_8U, cv::Scalar(255));
    for (int row = 0; row < 4; row++)           // the first tag at the upper left
        drawn.rowRange(18 + (3 - row)*78, 18 + (3 - row)*78 + 60).copyTo(other.rowRange(18 + row*78, 18 + row*78 + 60));
    cv::copyMakeBorder(other, other, 30, 30, 30, 30, cv::BORDER_CONSTANT, 255);
    CHECK_THROWS_WITH(detectIn(other, "a.png", Target(board("aprilgrid", "5x4"))),
                      Catch::StartsWith("'a.png': ") && Catch::Contains("not where Kalibr puts them"));
}

TEST_CASE("An AprilGrid that fills the field of a fisheye is where Kalibr puts it", "[target][aprilgrid]")
{
    const double FOCAL = 390, HALF = 50*CV_PI/180;      // to the board's corner, angles alike
    const Target target(board("aprilgrid", "6x6"));
    const Point2d middle(3.75, 3.75), centre(480, 360);     // of 6 tags and 5 gaps; of the image
    const double away = cv::norm(middle)/std::tan(HALF);
    const auto toImage = [&](const Point2d& p) {
        const double r = cv::norm(p - middle);
        return centre + FOCAL*(r > 0 ? std::atan2(r, away)/r : 1/away)*(p - middle);
    };
    const auto toBoard = [&](const Point2d& p) {
        const double r = cv::norm(p - centre), angle = std::min(r/FOCAL, 1.5);
        return middle + (r > 0 ? away*std::tan(angle)/r : away/FOCAL)*(p - centre);
    };
    const std::vector<Point2d> found = target.detect(pictureThrough(toBoard, DrawnTags{drawAprilGrid(Size(6, 6), SPACING, FINE_TAG)}));
    REQUIRE((int)found.size() == target.count());
    const auto seenCount = std::count_if(found.begin(), found.end(), seen);
    const double most = worstCorner(found, target, toImage);
    std::cout << "[numbers] AprilGrid through a fisheye: " << seenCount << " of 144 corners, worst " << most << " px off\n";
    CHECK(seenCount > 100);         // what the detector reads of it
    CHECK(most < 0.5);
}

TEST_CASE("One tag where it does not belong is left out, the others stay", "[target][aprilgrid]")
{
    const int PITCH = 260, FIRST = 60;
    const Target target(board("aprilgrid", "5x4"));
    const Matx33d H = boardToImage(90, 10, 3e-4, Point2d(3.1, 2.5));
    Mat drawn = drawAprilGrid(Size(5, 4), SPACING, FINE_TAG);
    const auto tagAt = [&](int column, int row) {
        return drawn(cv::Rect(FIRST + column*PITCH, FIRST + row*PITCH, FINE_TAG, FINE_TAG)); };
    tagAt(2, 1).copyTo(tagAt(0, 3));
    tagAt(2, 1).setTo(255);
    const std::vector<Point2d> found = target.detect(picture(H, DrawnTags{drawn}));
    REQUIRE((int)found.size() == target.count());
    CHECK(std::count_if(found.begin(), found.end(), seen) == target.count() - 8);
    CHECK(!seen(found[2*10 + 4]));
    CHECK(!seen(found[6*10]));
    CHECK(worstCorner(found, target, [&](const Point2d& p) { return through(H, p); }) < 0.2);
}

TEST_CASE("An AprilGrid in place of another board is called one, whatever its size", "[target][aprilgrid][missing]")
{
    const Mat image = aprilPicture(Size(6, 6), boardToImage(75, 5, 2e-4, Point2d(3.75, 3.75)));
    for (const TargetOptions& options : {board("chessboard", "9x6"), board("circles", "6x6")})
    {
        const std::string text = explained(image, options);
        INFO(text);
        CHECK(text.find("--pattern=aprilgrid (whose --size counts tags)") != std::string::npos);
    }
}

TEST_CASE("A tag is that of Kalibr's family: its bits, in its order", "[target][aprilgrid]")
{
    const uint64_t FIRST = 0xd5d628584ull;      // 36h11, tag 0: the upper left bit is the highest, 1 is light
    const Mat modules = aprilTagModules(0);
    REQUIRE(modules.size() == Size(10, 10));
    for (int i = 0; i < 36; i++)
        CHECK((modules.at<uchar>(2 + i/6, 2 + i % 6) > 0) == (((FIRST >> (35 - i)) & 1) == 1));
    CHECK(cv::countNonZero(modules.row(1)) + cv::countNonZero(modules.row(8)) == 0);
}

TEST_CASE("What is no AprilGrid is none; what does not go with it is refused", "[target][aprilgrid]")
{
    const Target target(board("aprilgrid", "5x4"));
    CHECK(target.detect(Mat(480, 640, CV_8U, cv::Scalar(127))).empty());
    TargetOptions options = board("chessboard", "5x4");
    options.tagSpacing = 0.3;
    CHECK_THROWS_AS(Target(options), Failure);
    options = board("aprilgrid", "30x30");
    CHECK_THROWS_AS(Target(options), Failure);
}
