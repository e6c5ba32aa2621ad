// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What belongs together: points of files by their coordinates, images by their names, cameras by what they see in common.
#include "calibrate/poses_file.hpp"
#include "calibrate/rig_data.hpp"
#include "target/detected_images.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>
#include <fstream>

using namespace cv;
using namespace tools;

namespace {

std::vector<DetectedImage> readText(const std::string& text)
{
    const TemporaryFolder folder;
    std::ofstream(folder / "points.csv") << text;
    return readPointsCsv(folder / "points.csv");
}

DetectedImage imageOf(const std::string& name, const std::vector<Point3d>& object, double u)
{
    DetectedImage image{name, "points.csv", {}, object};
    for (size_t i = 0; i < object.size(); i++)
        image.points.emplace_back(u + object[i].x, 10. + object[i].y);
    return image;
}

DetectedImages setOf(const std::vector<DetectedImage>& images)
{
    DetectedImages set;
    set.images = images;
    set.files = {"points.csv"};
    set.imageSize = Size(640, 480);
    return set;
}

const std::vector<Point3d> CUBE = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};

} // namespace

TEST_CASE("A file of observed points is read as spreadsheets write it", "[points_csv]")
{
    const std::vector<DetectedImage> images = readText("\xEF\xBB\xBFview,x,y,z,u,v\r\n# a comment\r\n\r\nb,1,2,3,10.5,20\r\n"
                                                       "\"a, first\",-1e1,0,0.5,,\r\nb,4,5,6,nan,NaN\r\n");
    REQUIRE(images.size() == 2);
    CHECK(images[0].stem == "a, first");
    CHECK(!seen(images[0].points.at(0)));
    CHECK(images[0].objectPoints.at(0) == Point3d(-10, 0, 0.5));
    CHECK(images[1].stem == "b");
    REQUIRE(images[1].points.size() == 2);
    CHECK(images[1].points[0] == Point2d(10.5, 20));
    CHECK(images[1].objectPoints[1] == Point3d(4, 5, 6));
    CHECK(!seen(images[1].points[1]));

    const std::vector<DetectedImage> other = readText("v;u;z;y;x;view\n2;1;5;4;3;name\n");   // any order, semicolons
    CHECK(other.at(0).objectPoints.at(0) == Point3d(3, 4, 5));
    CHECK(other[0].points[0] == Point2d(1, 2));
}

TEST_CASE("A file of observed points that is none is refused with its line", "[points_csv]")
{
    const std::string heading = "view,x,y,z,u,v\n";
    using Catch::Contains;
    CHECK_THROWS_WITH(readText(""), Contains("has no rows") && Contains("view,x,y,z,u,v"));
    CHECK_THROWS_WITH(readText(heading), Contains("has no rows"));
    CHECK_THROWS_WITH(readText("view,x,y,u,v\na,1,2,3,4\n"), Contains("line 1") && Contains("column 'z'"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,3,4,5\na,1,2,3,4\n"), Contains("line 3") && Contains("6 cells"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,x,4,5\n"), Contains("line 2") && Contains("z must be a number, not 'x'"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,inf,4,5\n"), Contains("line 2") && Contains("z must be a number"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,,4,5\n"), Contains("line 2") && Contains("z is empty"));
    CHECK_THROWS_WITH(readText(heading + ",1,2,3,4,5\n"), Contains("line 2") && Contains("view is empty"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,3,4,5\nb,1,2,3,4,5\na,1,2,3,6,7\n"), Contains("line 4") && Contains("already"));
    CHECK_THROWS_WITH(readText(heading + "a,1,2,3,4,nan\n"), Contains("line 2") && Contains("both be numbers, or both empty"));
    CHECK_THROWS_WITH(readPointsCsv("/tmp"), Contains("/tmp") && Contains("folder"));
    CHECK_THROWS_WITH(readPointsCsv("/nowhere/points.csv"), Contains("/nowhere/points.csv"));
}

TEST_CASE("Points that several cameras see are matched by their coordinates, whatever their order", "[rig_data]")
{
    std::vector<Point3d> reversed(CUBE.rbegin(), CUBE.rend() - 2);      // without the first two
    reversed.push_back({7, 7, 7});                                      // that nobody else sees
    RigImages sets;
    sets.glass[0] = setOf({imageOf("a", CUBE, 100), imageOf("b", CUBE, 100)});
    sets.glass[2] = setOf({imageOf("a", reversed, 300)});
    sets.direct[2] = setOf({imageOf("a", CUBE, 500)});
    const RigData data = groupIntoViews(nullptr, sets, false);
    CHECK(data.cameraCount == 3);
    REQUIRE(data.views.size() == 2);
    const View& view = data.views[0];
    CHECK(view.stem == "a");
    CHECK(view.countGlass() == 2);
    CHECK(view.countDirect() == 1);
    REQUIRE(view.objectPoints.size() == 9);
    REQUIRE(view.glass[2].size() == 9);
    REQUIRE(view.glass[0].size() == 9);
    for (size_t i = 0; i < 9; i++)
    {
        CHECK(seen(view.glass[0][i]) == (i < 8));
        CHECK(seen(view.glass[2][i]) == (i >= 2));
        for (const std::vector<Point2d>* pixels : {&view.glass[0], &view.glass[2], &view.direct[2]})
            if (seen((*pixels)[i]))
                CHECK((*pixels)[i].y == 10. + view.objectPoints[i].y);
    }
    CHECK(view.isPair(2));
    CHECK(data.countPairs() == 1);
    CHECK(data.views[1].glass[2].empty());
    CHECK(groupIntoViews(nullptr, sets, true).views.size() == 3);       // no pair
}

TEST_CASE("Points of a file beside a board have the board's numbers where they are its corners", "[rig_data]")
{
    TargetOptions options;
    options.size = "4x3";
    options.square = 10.;
    const Target target(options);
    std::vector<Point3d> some(target.objectPoints().begin() + 2, target.objectPoints().end());
    some.push_back({5, 5, 20});
    RigImages sets;
    sets.glass[0] = setOf({imageOf("a", some, 100)});
    DetectedImage board = imageOf("a", target.objectPoints(), 200);
    board.objectPoints.clear();
    sets.glass[1] = setOf({board});
    const View view = groupIntoViews(&target, sets, false).views.at(0);
    REQUIRE(view.objectPoints.size() == 13);
    CHECK(view.objectPoints[2] == target.objectPoints()[2]);
    CHECK(!seen(view.glass[0][1]));
    CHECK(view.glass[0][2] == Point2d(100 + view.objectPoints[2].x, 10 + view.objectPoints[2].y));
    CHECK(seen(view.glass[0][12]));
    CHECK(!seen(view.glass[1][12]));
    CHECK(view.neighbours.size() == target.neighbours().size());
}

TEST_CASE("Cameras are placed one beside another, and one that shares nothing is named", "[rig_data]")
{
    RigImages sets;
    sets.glass[0] = setOf({imageOf("a", CUBE, 1), imageOf("b", CUBE, 1)});
    sets.glass[1] = setOf({imageOf("c", CUBE, 1), imageOf("d", CUBE, 1)});
    sets.glass[2] = setOf({imageOf("b", CUBE, 1), imageOf("c", CUBE, 1)});
    const std::vector<std::pair<int, int>> chain = {{0, 2}, {2, 1}};
    CHECK(cameraLinks(groupIntoViews(nullptr, sets, false), true) == chain);
    sets.glass[3] = setOf({imageOf("e", CUBE, 1)});
    CHECK_THROWS_WITH(cameraLinks(groupIntoViews(nullptr, sets, false), true), Catch::Contains("camera 4"));
}

TEST_CASE("Points in survey coordinates are moved near their origin, and known poses with them", "[rig_data][far_origin]")
{
    const Vec3d far(900000, 10000000, 200);
    std::vector<Point3d> object = CUBE;
    for (Point3d& p : object)
        p += Point3d(far);
    RigImages sets;
    sets.glass[0] = setOf({imageOf("a", object, 100), imageOf("b", object, 100)});
    RigData data = groupIntoViews(nullptr, sets, false);
    CHECK(data.origin.origin() == far);
    for (const View& view : data.views)
        CHECK(view.objectPoints == CUBE);

    // Of the points as they were given; a small turn about their far origin is a large way.
    const TemporaryFolder folder;
    const Vec3d rvec(0.4, -1.1, 0.8), place(1, 2, 30);
    Matx33d R;
    Rodrigues(rvec, R);
    const Vec3d tvec = place - R*far;
    std::ofstream(folder / "poses.csv") << "view,rx_rad,ry_rad,rz_rad,tx,ty,tz,sigma_deg,sigma\n"
        << format("a,0.4,-1.1,0.8,%.17g,%.17g,%.17g,0,0\nb,0.4,-1.1,0.8,%.17g,%.17g,%.17g,0.001,0.5\n", tvec[0], tvec[1], tvec[2], tvec[0],
                  tvec[1], tvec[2]);
    readPoses(folder / "poses.csv", "mm", data);
    for (const View& view : data.views)
    {
        CHECK(view.pose->rvec == rvec);
        CHECK(norm(view.pose->tvec - place) < 1e-7);
    }
    const Mat C = data.views[1].pose->covariance(Rect(3, 3, 3, 3));
    CHECK(trace(C)[0] == Approx(2*std::pow(0.001*CV_PI/180*norm(far), 2) + 3*0.25).epsilon(1e-6));
}

TEST_CASE("Images of one camera that are given to another are refused", "[rig_data]")
{
    const TemporaryFolder folder;
    std::string text = "view,x,y,z,u,v\n";
    for (int i = 0; i < 6; i++)
        text += format("a,%d,%d,0,%g,%g\n", i % 3, i/3, 100.5 + 20*(i % 3), 200.25 + 20*(i/3));
    std::ofstream(folder / "one.csv") << text;
    std::ofstream(folder / "two.csv") << text << "a,9,9,9,,\n";         // a copy that says no more
    RigSources sources;
    sources.glass[0] = folder / "one.csv";
    PerCamera<Size> sizes;
    sizes[0] = sizes[1] = Size(640, 480);
    CHECK(readRigImages(sources, nullptr, sizes, true).glass[0].images.size() == 1);
    for (const char* second : {"one.csv", "two.csv"})
    {
        sources.glass[1] = folder / second;
        CHECK_THROWS_WITH(readRigImages(sources, nullptr, sizes, true), Catch::Contains("'a' of camera 2")
                          && Catch::Contains("the very pixels of 'a' of camera 1") && Catch::Contains(second));
    }
    // Stored anew, a corner moves by some hundredths.
    const auto write = [&](const char* view, double off) {
        std::ofstream file(folder / "anew.csv");
        file << "view,x,y,z,u,v\n";
        for (int i = 0; i < 6; i++)
            file << format("%s,%d,%d,0,%g,%g\n", view, i % 3, i/3, 100.5 + off + 20*(i % 3), 200.25 - off + 20*(i/3));
    };
    sources.glass[1] = folder / "anew.csv";
    write("a", 0.05);
    CHECK_THROWS_WITH(readRigImages(sources, nullptr, sizes, true), Catch::Contains("'a' of camera 2")
                      && Catch::Contains("the pixels (to 0.1 px) of 'a' of camera 1"));
    write("a", 0.3);
    CHECK_NOTHROW(readRigImages(sources, nullptr, sizes, true));
    write("b", 0.05);           // of another moment, by chance
    CHECK_NOTHROW(readRigImages(sources, nullptr, sizes, true));
    sources.glass[1].clear();
    sources.direct[0] = folder / "two.csv";
    CHECK_THROWS_WITH(readRigImages(sources, nullptr, sizes, true), Catch::Contains("'a' of --glass")
                      && Catch::Contains("the very pixels of 'a' of --direct") && Catch::Contains("give each option its own images"));
}
