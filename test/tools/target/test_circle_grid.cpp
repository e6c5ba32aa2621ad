// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Boards as they are in the field: plates whose dots are covered or of two sizes, and Kalibr's AprilGrid.
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "target/april_grid.hpp"
#include "target/dot_lattice.hpp"
#include "target/target_search.hpp"
#include "target/target.hpp"
#include "scenes.hpp"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <catch2/catch.hpp>
#include <filesystem>

using namespace tools;
using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Size;
using cv::Vec3d;

namespace {

const Size IMAGE(960, 720);

TargetOptions board(const std::string& pattern, const std::string& size)
{
    TargetOptions options;
    options.pattern = pattern;
    options.size = size;
    options.square = 30;
    return options;
}

//! Board coordinates, in squares from the first point, to pixels: turned, and seen at an angle.
Matx33d boardToImage(double square, double degrees, double tilt, Point2d middle)
{
    const double a = degrees*CV_PI/180, c = std::cos(a)*square, s = std::sin(a)*square;
    const Matx33d turned(c, -s, 480 - c*middle.x + s*middle.y, s, c, 360 - s*middle.x - c*middle.y, 0, 0, 1);
    return Matx33d(1, 0, 0, 0, 1, 0, tilt, -0.5*tilt, 1 - 300*tilt)*turned;
}

Point2d through(const Matx33d& H, const Point2d& p)
{
    const Vec3d h = H*Vec3d(p.x, p.y, 1);
    return Point2d(h[0]/h[2], h[1]/h[2]);
}

/** @param toBoard the place of the board that a pixel shows
@param isDark at a place of the board */
template <typename ToBoard, typename Dark>
Mat pictureThrough(const ToBoard& toBoard, const Dark& isDark)
{
    const int FINE = 4;
    scenes::Random random(4501);
    Mat image(IMAGE, CV_32F);
    for (int y = 0; y < image.rows; y++)
        for (int x = 0; x < image.cols; x++)
        {
            int dark = 0;
            for (int k = 0; k < FINE*FINE; k++)
                dark += isDark(toBoard(Point2d(x + (k % FINE + 0.5)/FINE - 0.5, y + (k/FINE + 0.5)/FINE - 0.5)));
            image.at<float>(y, x) = (float)(200 - 170.*dark/(FINE*FINE) + random.normal(1.));
        }
    cv::GaussianBlur(image, image, Size(), 0.7);
    image.convertTo(image, CV_8U);
    return image;
}

template <typename Dark>
Mat picture(const Matx33d& H, const Dark& isDark)
{
    const Matx33d back = H.inv();
    return pictureThrough([&](const Point2d& p) { return through(back, p); }, isDark);
}

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

std::string explained(const Mat& image, const TargetOptions& options)
{
    const std::string path = (std::filesystem::temp_directory_path()/"refract_field_board.png").string();
    cv::imwrite(path, image);
    const std::string text = explainMissing({{path, Size()}}, "'" + path + "'", 1, Target(options), BRIGHTNESS);
    std::filesystem::remove(path);
    return text;
}

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
