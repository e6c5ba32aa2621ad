// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Tables of points that several cameras saw, in the forms of other programs.
#include "console/failure.hpp"
#include "formats/foreign_files.hpp"
#include "formats/point_table.hpp"

using tools::CsvTable;

namespace {

CsvTable read(const TemporaryFolder& f, const std::string& text)
{
    return tools::readPointTable(saved(f, "t.csv", text), {"id", "u1", "v1"}, "a table");
}

std::string failure(const TemporaryFolder& f, const std::string& text)
{
    try
    {
        read(f, text);
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
    CHECK_THAT(failure(f, "a,b\n1,2\n"), Catch::Contains("there is no column 'id'"));
}
