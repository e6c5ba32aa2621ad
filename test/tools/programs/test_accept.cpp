// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_accept as a user runs it: decisions, certificates, and what it refuses.
#include "calib_scene.hpp"
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <set>

namespace {

using namespace calib_scene;

const char* const BOARD_OPTIONS = " --size=6x5 --square=39";
const char* const HEADING = "name,image1,id1,image2,id2,length,U\n";

//! A calibrated pair, and boards that it measured afterwards; of the same for all tests.
struct Bench
{
    TemporaryFolder folder, fresh;

    Bench()
    {
        SceneOptions options;
        options.views = 6;
        options.stereo = true;
        writeScene(folder, options, 4100);
        writeScene(fresh, options, 4101);
        const ToolResult calibrated = runTool("refract_calib" + std::string(TARGET) + PANE + " --direct=" + folder / "direct1.vnl"
                                              + " --glass=" + folder / "glass1.vnl" + images2(folder) + " --no-cross-validation"
                                              + " --serial=W-17 --quiet --out=" + folder / "calib.yml");
        INFO(calibrated.err);
        REQUIRE(calibrated.code == 0);
        measure(fresh, "points.csv");
        measure(folder, "calibrated.csv");
        writeFile(folder / "lengths.csv", lengths(0.));
    }
    static const Bench& get()
    {
        static const Bench bench;
        return bench;
    }
    std::string calib() const { return folder / "calib.yml"; }
    std::string start() const { return "refract_accept " + calib(); }
    std::string accept(const std::string& points, const std::string& lengthsFile, const std::string& maxError) const
    {
        return start() + " --points=" + points + " --lengths=" + lengthsFile + " --max-error=" + maxError;
    }
    //! With the given lengths, in a file of a folder.
    ToolResult run(const TemporaryFolder& other, const std::string& rows, const std::string& more = " --max-error=1") const
    {
        writeFile(other / "lengths.csv", HEADING + rows);
        return runTool(start() + " --points=" + folder / "points.csv" + " --lengths=" + other / "lengths.csv" + more);
    }
    //! Rows and diagonals of all boards. @param wrong by which the first is off
    static std::string lengths(double wrong)
    {
        return HEADING + format("top,,0,,5,%.4f,0.01\n", 5*SQUARE + wrong) + format("left,,0,,24,%.4f,0.01\n", 4*SQUARE)
            + format("diagonal,,0,,29,%.4f,0.01\n", std::hypot(5*SQUARE, 4*SQUARE));
    }

private:
    void measure(const TemporaryFolder& from, const std::string& file) const
    {
        const ToolResult measured = runTool("refract_measure " + calib() + " " + from / "glass1.vnl" + " " + from / "glass2.vnl"
                                            + BOARD_OPTIONS + " --quiet --out=" + (folder/file));
        INFO(measured.err);
        REQUIRE(measured.code == 0);
    }
};

//! The first points of a table, of one place each and of no image. @param count 30 are those of the first board
std::string placesAlone(const std::string& file, int count)
{
    std::istringstream csv(readFile(file));
    std::ostringstream places("id,x,y,z\n", std::ios::ate);
    std::string line;
    std::getline(csv, line);
    for (int i = 0; i < count && std::getline(csv, line); i++)
    {
        std::vector<std::string> cells;
        std::istringstream row(line);
        for (std::string cell; std::getline(row, cell, ',');)
            cells.push_back(cell);
        places << (i < 30 ? cells[1] : format("%d", i)) << ',' << cells[6] << ',' << cells[7] << ',' << cells[8] << '\n';
    }
    return places.str();
}

nlohmann::json jsonOf(const std::string& file) { return nlohmann::json::parse(readFile(file)); }

bool hasProgram(const std::string& name) { return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0; }

} // namespace

TEST_CASE("refract_accept decides with guard bands, and says it in a few lines", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const std::string points = bench.folder / "points.csv", lengths = bench.folder / "lengths.csv", summary = out / "s.json";
    const ToolResult wide = runTool(bench.accept(points, lengths, "2") + " --summary=" + summary);
    CAPTURE(wide.out, wide.err);
    CHECK(wide.code == 0);
    CHECK(wide.err.empty());
    CHECK(wide.out.compare(0, 6, "PASS: ") == 0);
    CHECK(std::count(wide.out.begin(), wide.out.end(), '\n') <= 18);
    CHECK(mentions(wide.out, "the scale"));        // lengths of the board that calibrated
    CHECK(mentions(wide.out, "Not stated: laboratory"));
    CHECK(mentions(wide.out, "VDI/VDE 2634 part 1"));
    std::istringstream lines(wide.out);
    for (std::string line; std::getline(lines, line);)
        CHECK(line.size() <= 80);

    const nlohmann::json json = jsonOf(summary);
    CHECK(json["decision"] == "pass");
    CHECK(json["images_checked"] == true);
    CHECK(json["lengths"].size() == 18);
    REQUIRE(json["budgets"].size() == 5);       // the length, x, y, z, the plane
    double largestU = 0.;
    for (const auto& length : json["lengths"])
    {
        CHECK(std::abs(length["error"].get<double>()) < 2*length["U"].get<double>());      // what is not so is in 1 of 20000
        largestU = std::max(largestU, length["U"].get<double>());
    }
    for (const auto& budget : json["budgets"])
    {
        double squares = 0.;
        for (const auto& row : budget["rows"])
            squares += std::pow(row["contribution"].get<double>(), 2);
        CHECK(squares == Approx(std::pow(budget["u"].get<double>(), 2)).epsilon(0.01));
    }
    const ToolResult narrow = runTool(bench.accept(points, lengths, format("%.6f", 0.9*largestU)));
    CHECK(narrow.code == 2);
    CHECK(mentions(narrow.out, "UNDECIDED: of 18 lengths"));

    writeFile(out / "wrong.csv", Bench::lengths(5.));
    const ToolResult wrong = runTool(bench.accept(points, out / "wrong.csv", "2") + " --verbose");
    CAPTURE(wrong.out);
    CHECK(wrong.code == 2);
    CHECK(mentions(wrong.out, "FAIL: of 18 lengths 6 are beyond their limits"));
    CHECK(mentions(wrong.out, "square of the board"));
    CHECK(mentions(wrong.out, "distance of the plane of"));

    // The same images straight away: numbers of corners are the ids.
    const ToolResult boards = runTool(bench.start() + " " + bench.fresh / "glass1.vnl" + " " + bench.fresh / "glass2.vnl" + BOARD_OPTIONS
                                      + " --lengths=" + lengths + " --max-error=2 --summary=" + out / "boards.json");
    CAPTURE(boards.err);
    CHECK(boards.code == 0);
    const nlohmann::json same = jsonOf(out / "boards.json");
    for (size_t i = 0; i < json["lengths"].size(); i++)
    {
        CHECK(same["lengths"][i]["error"].get<double>() == Approx(json["lengths"][i]["error"].get<double>()).margin(1e-6));
        CHECK(same["lengths"][i]["U"].get<double>() == Approx(json["lengths"][i]["U"].get<double>()).epsilon(1e-4));
    }
}

TEST_CASE("Certificates of the same input have the same bytes, and text that means something in HTML and XML", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const std::string command = bench.accept(bench.folder / "points.csv", bench.folder / "lengths.csv", "2+L/1000")
        + " --customer='Wet & <Dry>' --operator=\"O'Neil\" --country=DE --environment='20 C, tap water' --quiet --certificate="
        + out / "c.html" + " --dcc=" + out / "d.xml";
    std::string html, xml;
    for (int run = 0; run < 2; run++)
    {
        const ToolResult result = runTool(command, run ? "TZ=Asia/Tokyo LC_ALL=C" : "");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        CHECK((run == 0 || html == readFile(out / "c.html")));
        CHECK((run == 0 || xml == readFile(out / "d.xml")));
        html = readFile(out / "c.html");
        xml = readFile(out / "d.xml");
    }
    for (const char* part : {"Wet &amp; &lt;Dry&gt;", "W-17", "Conforms: all 18 lengths", "<svg", "20 C, tap water", "signature",
                             "2+L/1000",
                             "Page 1 of 2", "Page 2 of 2", "ISO 14253-1:2017", "the calibrated volume, mm: x", "as it was at the test",
                             "Authorised by", "Not stated: laboratory", "VDI/VDE 2634 part 1", "contribution, mm"})
    {
        CAPTURE(part);
        CHECK(mentions(html, part));
    }
    CHECK(mentions(xml, "schemaVersion=\"3.3.0\""));
    CHECK(mentions(xml, "<dcc:conformity>pass</dcc:conformity>"));
    CHECK(mentions(xml, "<dcc:countryCodeISO3166_1>DE<"));

    if (!hasProgram("xmllint"))
    {
        WARN("SKIPPED: no xmllint (libxml2-utils): the DCC was not read");
        return;
    }
    const std::string xpath = "string(//*[local-name()='customer']/*[local-name()='name'])";
    REQUIRE(std::system(("xmllint --noout " + out / "d.xml").c_str()) == 0);
    REQUIRE(std::system(("xmllint --xpath \"" + xpath + "\" " + out / "d.xml" + " >" + out / "t").c_str()) == 0);
    CHECK(mentions(readFile(out / "t"), "Wet & <Dry>"));
    const char* const schema = std::getenv("REFRACT_DCC_SCHEMA");
    if (!schema)
    {
        WARN("SKIPPED: REFRACT_DCC_SCHEMA names no folder with dcc.xsd of version 3.3.0 and what it imports: not validated");
        return;
    }
    const std::string validate = std::string("xmllint --nonet --noout --path ") + schema + " --schema " + schema + "/dcc.xsd ";
    CHECK(std::system((validate + out / "d.xml" + " 2>" + out / "log").c_str()) == 0);
    INFO(readFile(out / "log"));
    // Every other way a certificate may be: nothing is said, nothing is known.
    writeFile(out / "wrong.csv", Bench::lengths(5.) + format("\"odd; \"\"name\"\"\",view00,0,view01,0,%g,0.1\n", 100.));
    CHECK(runTool(bench.accept(bench.folder / "points.csv", out / "wrong.csv", "0.1") + " --quiet --dcc=" + out / "e.xml").code == 2);
    CHECK(std::system((validate + out / "e.xml" + " 2>>" + out / "log").c_str()) == 0);
}

TEST_CASE("A certificate says where the lengths are that have no room on it, and shows a bar for each", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const std::string command = bench.accept(bench.folder / "points.csv", bench.folder / "lengths.csv", "2") + " --quiet --certificate="
        + out / "c.html";
    REQUIRE(runTool(command + " --dcc=" + out / "d.xml").code == 0);
    CHECK(mentions(readFile(out / "c.html"), "the others are in the DCC."));
    REQUIRE(runTool(command + " --summary=" + out / "s.json").code == 0);
    CHECK(mentions(readFile(out / "c.html"), "the others are in s.json."));
    REQUIRE(runTool(command).code == 0);
    const std::string html = readFile(out / "c.html"), PLACE = "transform='translate(";
    CHECK(mentions(html, "the others are in the picture only."));
    std::set<std::string> places;           // across, of 18 errors of three lengths
    const size_t end = html.find("</svg>");
    for (size_t at = html.find(PLACE); at < end; at = html.find(PLACE, at + 1))
        places.insert(html.substr(at + PLACE.size(), html.find(',', at) - at - PLACE.size()));
    CHECK(places.size() >= 18);
}

TEST_CASE("refract_accept refuses images that calibrated, and tells when it cannot know", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const std::string lengths = bench.folder / "lengths.csv";
    const ToolResult again = runTool(bench.accept(bench.folder / "calibrated.csv", lengths, "2"));
    CHECK(again.code == 1);
    CHECK(mentions(again.err, "these images calibrated"));

    // By the bytes of a file: here that of its hash in calib.yml.
    std::string calib = readFile(bench.calib());
    const size_t camera = calib.find("camera: 1", calib.find("calibration_images:"));
    REQUIRE(camera != std::string::npos);
    writeFile(out / "image.png", "abc");
    calib.insert(camera, "sha256: ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad\n      ");      // FIPS 180-4's example
    writeFile(out / "calib.yml", calib);
    const std::string withImages = "refract_accept " + out / "calib.yml" + " --points=" + bench.folder / "points.csv" + " --lengths="
        + lengths + " --max-error=2 --images=";
    const ToolResult used = runTool(withImages + out / "image.png");
    CAPTURE(used.err);
    CHECK(used.code == 1);
    CHECK(mentions(used.err, "image.png"));
    writeFile(out / "other.png", "abd");
    CHECK(runTool(withImages + out / "other.png").code == 0);

    // Without their pixels and by other names, places that calibrated are where the calibration sees its own corners.
    for (const int count : {180, 30, 3})
    {
        writeFile(out / "places.csv", placesAlone(bench.folder / "calibrated.csv", count));
        writeFile(out / "one.csv", std::string(HEADING) + format("side,,0,,2,%.4f,0.01\n", 2*SQUARE));
        const ToolResult places = runTool(bench.accept(out / "places.csv", out / "one.csv", "2"));
        CAPTURE(count, places.out, places.err);
        CHECK(places.code == 1);
        CHECK(mentions(places.err, "these images calibrated"));
    }

    // Spheres: places alone, of no image.
    writeFile(out / "spheres.csv", placesAlone(bench.folder / "points.csv", 30));
    const ToolResult spheres = runTool(bench.accept(out / "spheres.csv", lengths, "2") + " --summary=" + out / "s.json");
    CAPTURE(spheres.out, spheres.err);
    CHECK(spheres.code == 0);
    const nlohmann::json json = jsonOf(out / "s.json");
    CHECK(json["images_checked"] == false);
    CHECK(json["lengths"].size() == 3);
    const std::string notices = json["notices"].dump();
    for (const char* part : {"was not checked", "have no sx, sy, sz", "have no pixels"})
        CHECK(mentions(notices, part));
    // A name is all that can be told of points without pixels.
    writeFile(out / "named.csv", "image,id,x,y,z\nview00,a,0,0,600\nview00,b,100,0,600\n");
    writeFile(out / "named_lengths.csv", std::string(HEADING) + "l,view00,a,view00,b,100,0.1\n");
    CHECK(mentions(runTool(bench.accept(out / "named.csv", out / "named_lengths.csv", "9")).out, "Images of these names calibrated"));
}

TEST_CASE("Images that calibrated are known again, stored anew, cropped or with points left out; a board next to where it was is not",
          "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    scenes::Random random(4110);
    // The calibrating corners moved by so much, in each image by so much more than in the one before; of the first so many are left out.
    const auto accept = [&](double noise, double shift, int leftOut, double more = 0.) {
        for (int camera : {1, 2})
        {
            std::istringstream in(readFile(bench.folder/format("glass%d.vnl", camera)));
            std::ostringstream changed;
            std::map<std::string, int> count;
            for (std::string line; std::getline(in, line);)
            {
                std::istringstream words(line);
                std::string name, rest;
                double x, y;
                if (line[0] == '#' || !(words >> name >> x >> y))
                {
                    changed << line << '\n';
                    continue;
                }
                std::getline(words, rest);
                if (count[name]++ < leftOut)
                    changed << name << " - - -\n";
                else
                    changed << name << format(" %.6f %.6f", x + shift + more*(double)count.size() + random.normal(noise),
                                              y + more + random.normal(noise)) << rest << '\n';
            }
            writeFile(out/format("new%d.vnl", camera), changed.str());
        }
        writeFile(out / "l.csv", HEADING + format("side,,23,,29,%.4f,0.01\n", SQUARE));
        return runTool(bench.start() + " " + out / "new1.vnl" + " " + out / "new2.vnl" + BOARD_OPTIONS + " --lengths=" + out / "l.csv"
                       + " --max-error=5");
    };
    for (const auto& [noise, shift, leftOut] : {std::make_tuple(0., 0., 0), {0.03, 0., 0}, {0., 0., 10}, {0.03, 0., 20},
                                                {0., 1., 0}, {0.03, -3., 0}, {0., 17., 10},        // cropped or rolled
                                                {0., 0.5, 0}, {0.03, -3.4, 0}, {0.01, 0.8, 5}})    // resampled
    {
        const ToolResult same = accept(noise, shift, leftOut);
        CAPTURE(noise, shift, leftOut, same.out, same.err);
        CHECK(same.code == 1);
        CHECK(mentions(same.err, "these images calibrated, stored anew or cropped perhaps"));
    }
    const ToolResult near = accept(0.03, 0.8, 0, 0.45);
    CAPTURE(near.out, near.err);
    CHECK(near.code == 0);
}

TEST_CASE("What would make a test better than it is, is refused or remarked", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const std::string points = bench.folder / "points.csv", lengths = bench.folder / "lengths.csv";
    const ToolResult boards = runTool(bench.start() + " " + bench.fresh / "glass1.vnl" + " " + bench.fresh / "glass2.vnl" + BOARD_OPTIONS
                                      + " --lengths=" + lengths + " --max-error=2 --pixel-sigma=0.0001");
    CHECK(boards.code == 1);
    CHECK(mentions(boards.err, "--pixel-sigma=0.0001"));
    CHECK(runTool(bench.accept(points, lengths, "2") + " --pixel-sigma=0.0001").code == 1);
    // Less than the rays show, by no more than the calibration's own error could be: that error is one for all points, and no noise.
    const ToolResult half = runTool(bench.accept(points, lengths, "2") + " --pixel-sigma=0.07");
    CAPTURE(half.out, half.err);
    CHECK(half.code == 1);

    // sx, sy, sz beside pixels.
    std::istringstream csv(readFile(points));
    std::ostringstream better;
    std::string line;
    for (int row = 0; std::getline(csv, line); row++)
    {
        std::vector<std::string> cells;
        std::istringstream in(line);
        for (std::string cell; std::getline(in, cell, ',');)
            cells.push_back(cell);
        for (size_t i = 0; i < cells.size(); i++)
            better << (i ? "," : "") << (row && i >= 9 && i <= 11 ? "1e-9" : cells[i]);
        better << '\n';
    }
    writeFile(out / "better.csv", better.str());
    REQUIRE(mentions(readFile(points), "x,y,z,sx,sy,sz"));
    const auto largestU = [&](const std::string& file, const std::string& more) {
        const ToolResult result = runTool(bench.accept(file, lengths, "2") + " --summary=" + out / "s.json" + more);
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        double U = 0.;
        const nlohmann::json summary = jsonOf(out / "s.json");
        for (const auto& length : summary["lengths"])
            U = std::max(U, length["U"].get<double>());
        return U;
    };
    const double U = largestU(points, "");
    CHECK(largestU(out / "better.csv", "") == Approx(U).epsilon(0.02));
    CHECK(mentions(jsonOf(out / "s.json")["notices"].dump(), "are not used"));

    // An end that was not measured.
    std::string some = readFile(points);
    const size_t end = some.find('\n', some.find('\n') + 1);
    REQUIRE(some.substr(end - 2, 2) == ",0");
    some[end - 1] = '9';
    writeFile(out / "some.csv", some);
    largestU(out / "some.csv", "");
    CHECK(mentions(jsonOf(out / "s.json")["notices"].dump(), "3 lengths were not tested, as an end was not measured (top, "));
    CHECK(jsonOf(out / "s.json")["lengths"].size() == 15);

    // A volume of one's own: its numbers, and whose it is.
    largestU(points, " --volume=-10,10,-10,10,500,510 --certificate=" + out / "c.html");
    CHECK(mentions(jsonOf(out / "s.json")["notices"].dump(), "The volume is stated (--volume): x -10 ... 10"));
    CHECK(mentions(readFile(out / "s.json"), "no length is within the stated volume"));
    CHECK(mentions(readFile(out / "c.html"), "dashed: the stated volume"));

    // The standard is 10 K warmer than its certificate.
    largestU(points, " --temperature=30 --temperature-std=1 --expansion=23");
    const nlohmann::json warm = jsonOf(out / "s.json");
    CHECK(warm["lengths"][0]["length"].get<double>() == Approx(5*SQUARE*(1 + 23e-6*10)).margin(1e-6));
    bool hasRow = false;
    for (const auto& row : warm["budgets"][0]["rows"])
        if (row["source"] == "temperature of the standard")
        {
            hasRow = true;
            CHECK(row["contribution"].get<double>() == Approx(23e-6*SQUARE*4).epsilon(0.7));
        }
    CHECK(hasRow);
}

TEST_CASE("A certificate is well-formed whatever letters are given", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const ToolResult latin = bench.run(out, "\"a <b>&\xE9\",view00,0,view00,5,195,0.1\n");
    CHECK(latin.code == 1);
    CHECK(mentions(latin.err, "not UTF-8"));
    CHECK(mentions(bench.run(out, "a,view00,0,view00,5,195,0.1\n", " --max-error=1 --customer='\xE9'").err, "--customer"));
    writeFile(out / "caf\xE9.csv", readFile(bench.folder / "points.csv"));
    const ToolResult named = runTool(bench.accept("'" + out / "caf\xE9.csv'", bench.folder / "lengths.csv", "2") + " --quiet --dcc="
                                     + out / "d.xml");
    CAPTURE(named.err);
    CHECK(named.code == 0);
    CHECK(mentions(readFile(out / "d.xml"), "caf\xEF\xBF\xBD.csv"));
}

TEST_CASE("refract_accept says what is wrong in one sentence", "[tools][accept_tool]")
{
    const Bench& bench = Bench::get();
    const TemporaryFolder out;
    const struct { std::string rows, more, expected; } bad[] = {
        {"a,view00,0,view00,5,195,\n", " --max-error=1", "proves nothing"},
        {"a,view00,0,view00,5,195,0\n", " --max-error=1", "proves nothing"},
        {"a,view00,0,view00,5,195,nan\n", " --max-error=1", "proves nothing"},
        {"a,view00,0,view00,5,195,200\n", " --max-error=1", "in the unit of the length"},
        {"a,view00,0,view00,5,-195,0.1\n", " --max-error=1", "length must be more than 0"},
        {"a,view00,0,view00,5,195,0.1\na,view00,0,view00,24,156,0.1\n", " --max-error=1", "the name 'a' stands in line 2 already"},
        {"a,view00,0,view00,5,195,0.1\nb,view00,5,view00,0,195,0.1\n", " --max-error=1", "between these points stands in line 2 already"},
        {"a,view00,0,view00,30,195,0.1\n", " --max-error=1", "the point '30' of the image 'view00' is not in"},
        {"a,view99,0,view99,5,195,0.1\n", " --max-error=1", "the point '0' of the image 'view99' is not in"},
        {"a,view00,0,,5,195,0.1\n", " --max-error=1", "give both images, or none"},
        {"a,view00,0,view00,0,195,0.1\n", " --max-error=1", "same point"},
        {"a,,0,,99,195,0.1\n", " --max-error=1", "no image"},
        {"", " --max-error=1", "has no rows"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=0", "--max-error=0"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1+L", "grows with the tested length"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --date=2026-02-30", "--date=2026-02-30: there is no such time"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --date=26.11.2026", "--date=26.11.2026: give a "},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --country=Germany", "two capital letters"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --date=2999-01-01", "in the future"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --date=1999-01-01", "was calibrated later"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --issued=2001-01-01", "of a test that was"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --serial=W-18", "is of 'W-17'"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --temperature=21", "belong together"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --volume=1,0,1,2,3,4", "each pair growing"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --unit=m", "is in mm"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --size=6x5 --square=39", "leave --size and --square out"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --images='none*.png'", "matches no file"},
        {"a,view00,0,view00,5,195,0.1\n", " --max-error=1 --dcc=" + bench.calib(), "overwritten"}};
    for (const auto& b : bad)
    {
        const ToolResult result = bench.run(out, b.rows, b.more);
        CAPTURE(b.rows, b.more, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, b.expected));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    }

    const std::string points = readFile(bench.folder / "points.csv"), length = "a,view00,0,view00,5,195,0.1\n";
    writeFile(out / "lengths.csv", HEADING + length);
    const auto withPoints = [&](const std::string& text) {
        writeFile(out / "points.csv", text);
        return runTool(bench.accept(out / "points.csv", out / "lengths.csv", "1"));
    };
    const size_t firstEnd = points.find('\n', points.find("view00,0,"));
    std::string refused = points;
    refused[firstEnd - 1] = '9';
    CHECK(mentions(withPoints(refused).err, "has status 9"));
    CHECK(mentions(withPoints(points + points.substr(points.find('\n') + 1)).err, "stands twice"));
    CHECK(mentions(withPoints("image,id,x,y\nview00,0,1,2\n").err, "there is no column 'z'"));
    // Its pixels show the point elsewhere.
    std::string moved = points;
    moved.insert(moved.find("view00,0,") + 9, "1");         // far to the right
    CHECK(mentions(withPoints(moved).err, "is not of this calibration"));

    // A clock that was wrong when the file was written.
    writeFile(out / "points.csv", points);
    std::filesystem::last_write_time(out / "points.csv", std::filesystem::file_time_type::clock::now() + std::chrono::hours(24*400));
    CHECK(mentions(runTool(bench.accept(out / "points.csv", out / "lengths.csv", "1")).err, "newest file"));

    const ToolResult single = runTool("refract_accept " + bench.folder / "camera1.yml" + " --no-window --points=" + out / "points.csv"
                                      + " --lengths=" + out / "lengths.csv" + " --max-error=1");
    CHECK(single.code == 1);
    CHECK(mentions(single.err, "give --plane"));
}
