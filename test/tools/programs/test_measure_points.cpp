// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_measure --points: pixels that cannot be right get a status, and no number that looks as good as the others.
#include "run_tool.hpp"
#include "truth_file.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <cmath>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const double SIGMA = 0.014;

//! A row of --points.
struct Match
{
    std::string id;
    cv::Point2d pixel1, pixel2;
};

//! The true pixels of a view at 600 mm.
std::vector<Match> trueMatches()
{
    const auto truth = readTruth(STEREO);
    const TrueView &left = truth.at("measure1/z600_1.jpg"), &right = truth.at("measure2/z600_1.jpg");
    std::vector<Match> matches;
    for (size_t i = 0; i < left.pixels.size(); i++)
        matches.push_back({std::to_string(i), left.pixels[i], right.pixels[i]});
    return matches;
}

ToolResult measured(const TemporaryFolder& folder, const std::vector<Match>& matches, const std::string& more = "")
{
    std::ostringstream csv;
    csv.precision(12);
    csv << "id,u1,v1,u2,v2\n";
    for (const Match& m : matches)
        csv << m.id << ',' << m.pixel1.x << ',' << m.pixel1.y << ',' << m.pixel2.x << ',' << m.pixel2.y << '\n';
    writeFile(folder / "pixels.csv", csv.str());
    return runTool("refract_measure " + STEREO + "/truth.yml --points=" + (folder / "pixels.csv") + " --pixel-sigma="
                   + cv::format("%g", SIGMA) + " --out=" + (folder / "points.csv") + more);
}

std::vector<CsvRow> rowsOf(const TemporaryFolder& folder) { return readPointsCsv(readFile(folder / "points.csv")); }

void checkTerminal(const ToolResult& r)
{
    for (const char* word : {"nan", "inf "})
        CHECK_FALSE(mentions(r.out + r.err, word));
}

} // namespace

TEST_CASE("refract_measure gives no point for a pixel outside of its image", "[tools][measure]")
{
    const TemporaryFolder folder;
    std::vector<Match> matches = trueMatches();
    REQUIRE(measured(folder, matches).code == 0);
    const std::vector<CsvRow> right = rowsOf(folder);

    matches[3].pixel1 = {-200, 300};
    matches[7].pixel2.y = 3000;
    matches[11].pixel1.x = 1281.2;          // more than one pixel beyond the border
    matches[12].pixel1.x = 1280.3;          // a corner at the border, 1279.5, may be found there; but here it misses its curve
    const ToolResult some = measured(folder, matches);
    INFO(some.out << some.err);
    REQUIRE(some.code == 0);
    checkTerminal(some);
    CHECK(mentions(some.err, "3 of 30 points lie outside of an image, first '3' at (-200, 300) in camera 1 (1280x1024); status 11"));
    const std::vector<CsvRow> rows = rowsOf(folder);
    REQUIRE(rows.size() == matches.size());
    for (size_t i = 0; i < rows.size(); i++)
    {
        CAPTURE(i);
        const bool outside = i == 3 || i == 7 || i == 11;
        CHECK(rows[i].status == (outside ? 11 : i == 12 ? 9 : 0));
        CHECK(std::isnan(rows[i].point[2]) == (outside || i == 12));
        CHECK(std::isnan(rows[i].sigma[2]) == (outside || i == 12));
        if (rows[i].status == 0)
            CHECK(cv::norm(rows[i].sigma - right[i].sigma) < 1e-9);        // the others are as good as without them
    }

    // The pixels of an image of three times the size.
    for (Match& m : matches = trueMatches())
    {
        m.pixel1 *= 3;
        m.pixel2 *= 3;
    }
    const ToolResult most = measured(folder, matches);
    INFO(most.out << most.err);
    CHECK(most.code != 0);
    CHECK(mentions(most.err, "another size"));
    if (most.code == 2)
        for (const CsvRow& row : rowsOf(folder))
            CHECK(row.status != 0);

    // On a plane, too.
    const std::string plane = readTruth(STEREO).at("measure1/z600_1.jpg").planeOption();
    matches = trueMatches();
    matches[0].pixel1.y = -7;
    const ToolResult onPlane = measured(folder, matches, plane);
    INFO(onPlane.out << onPlane.err);
    CHECK(onPlane.code == 0);
    CHECK(rowsOf(folder)[0].status == 11);
    CHECK(std::isnan(rowsOf(folder)[0].point[0]));
    CHECK(rowsOf(folder)[1].status == 0);
}

TEST_CASE("refract_measure refuses an id that stands twice", "[tools][measure]")
{
    const TemporaryFolder folder;
    std::vector<Match> matches = trueMatches();
    matches[5].id = "bolt 7";
    matches[9].id = "bolt 7";
    const ToolResult r = measured(folder, matches);
    CHECK(r.code == 1);
    CHECK(mentions(r.err, "pixels.csv' line 11: the id 'bolt 7' stands in line 7 already"));
    CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(folder / "points.csv"));
}

TEST_CASE("A match off its curve has status 9 and a +- that contains it, also among few", "[tools][measure]")
{
    const std::vector<Match> all = trueMatches();
    const auto truth = readTruth(STEREO).at("measure1/z600_1.jpg");
    const std::vector<cv::Point3d> object = chessboard(6, 5, 39);
    for (size_t count : {1, 2, 3, 30})
        for (double off : {8., 12., 25., 80.})      // of the residual, in standard deviations
        {
            const TemporaryFolder folder;
            std::vector<Match> matches(all.begin(), all.begin() + count);
            matches.back().pixel2.y += off*SIGMA*std::sqrt(2.);         // curves are about horizontal
            const ToolResult r = measured(folder, matches);
            CAPTURE(count, off, r.out, r.err);
            REQUIRE(r.code == (count < 3 ? 2 - (count == 2) * 2 : 0));
            checkTerminal(r);
            const std::vector<CsvRow> rows = rowsOf(folder);
            for (size_t i = 0; i + 1 < count; i++)
                CHECK(rows[i].status == 0);
            CHECK(rows.back().status == 9);
            const cv::Vec3d error = rows.back().point - truth.inCamera1(object[count - 1]);
            for (int k = 0; k < 3; k++)
            {
                CHECK(std::abs(error[k]) < 3*rows.back().sigma[k]);
                CHECK(rows.back().sigma[k] > (count > 1 ? 2*rows[0].sigma[k] : 0));
            }
        }
}

TEST_CASE("refract_measure prints no nan where another calibration has no answer", "[tools][measure]")
{
    const TemporaryFolder folder;
    std::string behind = readFile(STEREO + "/truth.yml");
    const std::string T = "-2.1147559999999999e+02";
    behind.replace(behind.find(T), T.size(), "+2.1147559999999999e+02");     // camera 2 on the other side: its rays meet behind both
    writeFile(folder / "behind.yml", behind);
    const ToolResult r = measured(folder, trueMatches(), " --compare-with=" + (folder / "behind.yml"));
    INFO(r.out << r.err);
    CHECK(r.code == 0);
    checkTerminal(r);
    const size_t at = r.out.find("behind");
    REQUIRE(at != std::string::npos);
    CHECK(mentions(r.out.substr(at, r.out.find('\n', at) - at), "0 of 30"));
}
