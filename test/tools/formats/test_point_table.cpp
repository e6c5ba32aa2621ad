// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Tables of points that several cameras saw, in the forms of other programs.
#include "console/csv.hpp"
#include "console/failure.hpp"
#include "formats/foreign_files.hpp"
#include "formats/point_table.hpp"

using tools::CsvTable;

namespace {

CsvTable read(const TemporaryFolder& f, const std::string& text, const tools::PixelOrigin& origin = tools::PixelOrigin())
{
    return tools::readPointTable(saved(f, "t.csv", text), {"id", "u1", "v1"}, "a table", origin);
}

typedef std::vector<std::string> Cells;

const char DEEPLABCUT[] = "scorer,DLC,DLC,DLC,DLC,DLC,DLC\nbodyparts,nose,nose,nose,tail,tail,tail\n"
                          "coords,x,y,likelihood,x,y,likelihood\n";

std::string failure(const TemporaryFolder& f, const std::string& text, const std::string& name = "")
{
    try
    {
        name.empty() ? read(f, text) : tools::readPointTable(f/name, {"id"}, "a table");
        return "read";
    }
    catch (const tools::Failure& e)
    {
        return e.what();
    }
}

} // namespace

TEST_CASE("A row an observation becomes a row a point", "[foreign]")
{
    TemporaryFolder f;
    const CsvTable table = read(f, "frame,cam_id,pt_idx,x,y,radius,status\n0,0,0,640.5,320.1,15.2,Raw\n0,0,1,680.3,325.7,14.8,Raw\n"
                                   "0,2,0,620.1,318.5,15.0,Raw\n7,1,0,1,2,3,Raw\n");
    CHECK(table.names() == std::vector<std::string>{"image", "id", "u1", "v1", "u2", "v2", "u3", "v3"});
    REQUIRE(table.rows().size() == 3);
    CHECK(table.rows()[0].cells == std::vector<std::string>{"0", "0", "640.5", "320.1", "", "", "620.1", "318.5"});
    CHECK(table.rows()[1].cells == std::vector<std::string>{"0", "1", "680.3", "325.7", "", "", "", ""});
    CHECK(table.rows()[2].cells == std::vector<std::string>{"7", "0", "", "", "1", "2", "", ""});
    CHECK(read(f, "FRAME,CAM_ID,PT_IDX,X,Y\r0,0,0,640.5,320.1\r").rows().size() == 1);
}

TEST_CASE("Tables are read as spreadsheets of any country write them", "[foreign]")
{
    TemporaryFolder f;
    for (const std::string text : {"image,id,u1,v1\nm1,\"1,5\",640.5,-2e3\n", "image;id;u1;v1\nm1;1,5;640,5;-2e3\n",
                                   "image\tid\tu1\tv1\r\nm1\t1.5\t640,5\t-2e3\r\n",
                                   "image,id,u1,v1\rm1,1.5,640.5,-2e3\r", "Image,ID,U1,V1\nm1,1.5,640.5,-2e3\n",
                                   "\xEF\xBB\xBFimage;id;u1;v1\n# mine\n\nm1;1.5;640.5;-2e3\n"})
    {
        CAPTURE(text);
        const CsvTable table = read(f, text);
        REQUIRE(table.rows().size() == 1);
        CHECK(table.number(table.rows()[0], "u1") == 640.5);
        CHECK(table.number(table.rows()[0], "v1") == -2000);
    }
    const CsvTable thousands = read(f, "id;u1;v1\na;1.234,5;3\n");
    CHECK_THROWS_WITH(thousands.number(thousands.rows()[0], "u1"), Catch::Contains("u1 must be a number, not '1.234,5'"));
    CHECK(read(f, "id;u1;v1\na;1,234;3,5\n").rows().size() == 1);
    CHECK(read(f, "id;u1;v1\na;0,234;3.5\n").rows().size() == 1);
    CHECK(failure(f, "id;u1;v1\na;640.25;3\nb;1,234;3\n") == "'" + f/"t.csv" + "' line 3: '1,234' may be 1234 or 1.234, as line 2 has "
          "a decimal point: write numbers in one way, without marks of thousands");
    CHECK_THAT(failure(f, "id\tu1\tv1\nb\t-1,234\t0.5\n"), Catch::Contains("line 2: '-1,234' may be"));
    CHECK(tools::headingOf(saved(f, "h.csv", "\xEF\xBB\xBF# mine\nid;u1\n")) == Cells{"id", "u1"});
    CHECK_THAT(failure(f, std::string("\xFF\xFEi\0d\0,\0u\0", 10)), Catch::Contains("is UTF-16"));
}

TEST_CASE("Tables of points that cannot be read are refused in a sentence", "[foreign]")
{
    TemporaryFolder f;
    const std::string heading = "frame,cam_id,pt_idx,x,y\n";
    CHECK(failure(f, heading + "0,0,0,1,2\n0,0,0,3,4\n") == "'" + f/"t.csv" + "' line 3: camera 0 saw the point 0 of frame 0 in an "
          "earlier line already");
    CHECK_THAT(failure(f, heading + "0,left,0,1,2\n"), Catch::Contains("line 2: cam_id must be a number"));
    CHECK_THAT(failure(f, heading + "0,-1,0,1,2\n"), Catch::Contains("line 2: cam_id must be the number of a camera, from 0"));
    CHECK_THAT(failure(f, heading), Catch::Contains("has no rows"));
    CHECK_THAT(failure(f, "pt1_cam1_X,pt1_cam1_Y\n1,2\n"), Catch::Contains("looks like a table of DLTdv or Argus"));
    CHECK_THAT(failure(f, DEEPLABCUT), Catch::Contains("DeepLabCut's table of one camera"));
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("there is no file"));
    saved(f, "cam1.csv", std::string(DEEPLABCUT) + "0,1,2,0.9,3,4\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("line 4: 7 cells expected"));
    saved(f, "cam1.csv", std::string(DEEPLABCUT) + "0,1,2,0.9,3,4,x\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("line 4: 'x' is no number"));
    saved(f, "cam1.csv", "scorer,a,a,a\nindividuals,m,m,m\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("of several animals it is not read"));
    saved(f, "cam1.csv", "2\n0 1 2 3 4 5 6 0\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("has 1 of 2: is it cut short?"));
    saved(f, "cam1.csv", "1\n0 1 2 3 4 5 6\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("line 2: 8 numbers of a target"));
    saved(f, "cam1.csv", "id,u1\n");
    CHECK_THAT(failure(f, "", "cam%d.csv"), Catch::Contains("is neither a table of DeepLabCut"));
    CHECK_THAT(failure(f, "a,b\n1,2\n"), Catch::Contains("there is no column 'id'"));
}

TEST_CASE("Where y begins is refused where it says nothing", "[foreign]")
{
    TemporaryFolder f;
    for (const char* text : {"frame,cam_id,pt_idx,x,y\n0,0,0,1,2\n", "id,u1,v1\n1,2,3\n"})
    {
        CHECK(read(f, text).rows().size() == 1);
        CHECK_THROWS_WITH(read(f, text, {"top", {}}), Catch::Contains("--y-from=top is for tables of DLTdv or Argus"));
    }
    saved(f, "cam0.csv", std::string(DEEPLABCUT) + "0,1,2,0.9,3,4,0.9\n");
    CHECK_THROWS_WITH(tools::readPointTable(f/"cam%d.csv", {"id"}, "a table", {"bottom", {cv::Size(9, 9)}}), Catch::Contains("--y-from"));
}

TEST_CASE("A camera is called as its table calls it, and none is left out without a word", "[foreign]")
{
    TemporaryFolder f;
    const auto tracks = [&](const std::string& text) { return [&f, text] { read(f, text, {"top", {}}); }; };
    CHECK_THROWS_WITH(tracks("pt1_cam2_X,pt1_cam2_Y,pt01_cam2_X,pt01_cam2_Y\n1,2,3,4\n")(), Catch::Contains("camera 2 saw the point 1"));
    CHECK_THROWS_WITH(tracks("pt1_cam1_X,pt1_cam1_Y\n1,\n")(), Catch::Contains("pt1_cam1_x and pt1_cam1_y must both be numbers"));
    CHECK_THROWS_WITH(tracks("pt1_cam1_X,b\n1,2\n")(), Catch::Contains("there is no column 'pt1_cam1_y'"));
    CHECK_THROWS_WITH(tracks("pt1_cam1_X,pt1_cam1_Y\n1,inf\n")(), Catch::Contains("line 2: 'inf' is no number"));
    // 2^64 + 1 is no other point than 1.
    CHECK(read(f, "pt18446744073709551617_cam1_X,pt1_cam1_X,pt1_cam1_Y\n5,1,2\n", {"top", {}}).rows().size() == 1);
    saved(f, "t1.csv", "2\n0 1 2 3 4 5 6 0\n1 1 2 3 4 5 6 0\n");
    CHECK_THAT(failure(f, "", "t%d.csv"), Catch::Contains("line 3: camera 1 saw the point 0"));
    saved(f, "t1.csv", "1\n0 1 2 3 4 5 6 0\n\n \n");
    CHECK(failure(f, "", "t%d.csv") == "read");
    saved(f, "t3.csv", "1\n0 1 2 3 4 5 6 0\n");
    CHECK_THAT(failure(f, "", "t%d.csv"), Catch::Contains("t3.csv', but no '") && Catch::Contains("t2.csv'"));
}

TEST_CASE("Tracks of DLTdv and Argus count from 1, and from where it is said", "[foreign]")
{
    TemporaryFolder f;
    const std::string text = "pt1_cam1_X,pt1_cam1_Y,pt1_cam2_X,pt1_cam2_Y,pt2_cam1_X,pt2_cam1_Y,pt2_cam2_X,pt2_cam2_Y\n"
                             "11,21,31,41,NaN,NaN,7,8\n1,1,2,2,3,3,4,4\n";
    const CsvTable top = read(f, text, {"top", {}});
    CHECK(top.names() == Cells{"image", "id", "u1", "v1", "u2", "v2"});
    REQUIRE(top.rows().size() == 4);
    CHECK(top.rows()[0].cells == Cells{"1", "1", "10", "20", "30", "40"});
    CHECK(top.rows()[1].cells == Cells{"1", "2", "", "", "6", "7"});
    CHECK(top.rows()[2].cells == Cells{"2", "1", "0", "0", "1", "1"});
    CHECK(read(f, "PT1_CAM1_X,PT1_CAM1_Y\n11,21\n", {"top", {}}).rows()[0].cells == Cells{"1", "1", "10", "20"});
    // The lowest row of an image of 100 rows is the last one, 99 from the first.
    const CsvTable bottom = read(f, text, {"bottom", {cv::Size(640, 100), cv::Size(640, 480)}});
    CHECK(bottom.rows()[2].cells == Cells{"2", "1", "0", "99", "1", "478"});
    try
    {
        read(f, text, {"bottom", {cv::Size(640, 100)}});
        CHECK(false);
    }
    catch (const tools::Failure& e)
    {
        CHECK_THAT(e.what(), Catch::Contains("the size of camera 2's image is not known"));
    }
}

TEST_CASE("A file of each camera becomes one table: DeepLabCut's, and OpenPTV's targets", "[foreign]")
{
    TemporaryFolder f;
    saved(f, "cam0.csv", std::string(DEEPLABCUT) + "0,10.5,20,0.99,5,6,0.3\n1,11,21,0.9,7,8,1\n");
    saved(f, "cam1.csv", std::string(DEEPLABCUT) + "0,30,40,0.7,9,10,0.8\n1,,,,1,2,0.9\n");
    const CsvTable table = tools::readPointTable(f/"cam%d.csv", {"id"}, "a table");
    REQUIRE(table.rows().size() == 4);
    CHECK(table.rows()[0].cells == Cells{"0", "nose", "10.5", "20", "30", "40"});
    CHECK(table.rows()[1].cells == Cells{"0", "tail", "", "", "9", "10"});
    CHECK(table.rows()[2].cells == Cells{"1", "nose", "11", "21", "", ""});
    CHECK(table.rows()[3].cells == Cells{"1", "tail", "7", "8", "1", "2"});
    // Of OpenPTV's pixels (0, 0) is a corner; -1 is a target without partners.
    saved(f, "cam1.10001_targets", "3\n   0  10.5  20.25 7 3 3 900  1\n   1 5 6 7 3 3 900 -1\n   2 8 9 7 3 3 900 0\n");
    saved(f, "cam2.10001_targets", "1\n   0  1.5  2.5 7 3 3 900  1\n");
    const CsvTable targets = tools::readPointTable(f/"cam%d.10001_targets", {"id"}, "a table");
    REQUIRE(targets.rows().size() == 2);
    CHECK(targets.rows()[0].cells == Cells{"0", "1", "10", "19.75", "1", "2"});
    CHECK(targets.rows()[1].cells == Cells{"0", "0", "7.5", "8.5", "", ""});
}
