// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bundle as a user runs it, on wands that are waved through water before cameras in housings.
#include "wand_scene.hpp"
#include <nlohmann/json.hpp>
#include <filesystem>
#include <map>

using namespace cv;
using namespace cv::refract;
using namespace wand;

TEST_CASE("refract_bundle finds windows and places from a wand, within their +-", "[tools][bundle]")
{
    const int trials = scenes::trials(10);
    double squares = 0, ofPoints = 0, worst = 0;
    int count = 0, pointCount = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        const Wand wand(100 + trial);
        const TemporaryFolder f;
        wand.write(f);
        const ToolResult result = bundle(f);
        CAPTURE(scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        const Rig found = Rig::read(f / "calib.yml");
        const std::map<std::string, double> truth = wand.truth.parameters(), is = found.parameters(), std = found.deviations();
        for (const auto& parameter : truth)
        {
            const double z = (is.at(parameter.first) - parameter.second)/std.at(parameter.first);
            CAPTURE(parameter.first, parameter.second, is.at(parameter.first), std.at(parameter.first));
            CHECK(std::abs(z) < 5);
            if (parameter.first.find("normal[2]") != std::string::npos)
                continue;
            squares += z*z;
            worst = std::max(worst, std::abs(z));
            count++;
        }
        const std::vector<Row> rows = rowsOf(f / "points.csv");
        REQUIRE(rows.size() == wand.points.size());
        for (size_t i = 0; i < rows.size(); i++)
            if (rows[i].status() == 0)
            {
                const Point3d off = rows[i].X() - wand.points[i];
                ofPoints += std::pow(off.x/rows[i].fromEnd(4), 2) + std::pow(off.y/rows[i].fromEnd(3), 2)
                    + std::pow(off.z/rows[i].fromEnd(2), 2);
                pointCount += 3;
            }
    }
    const double ratio = std::sqrt(squares/count), pointRatio = std::sqrt(ofPoints/pointCount);
    WARN("[numbers] refract_bundle, " << trials << " wands, seed " << scenes::seed() << ": error over stated " << ratio << " (worst "
         << worst << "), of points " << pointRatio);
    CHECK(ratio > 0.8);
    CHECK(ratio < 1.25);
    CHECK(pointRatio > 0.8);
    CHECK(pointRatio < 1.25);
}

TEST_CASE("A second bundle, within what the first one knows, is within its +- too", "[tools][bundle]")
{
    const int trials = scenes::trials(10);
    double squares = 0, worst = 0;
    int count = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        Wand wand(1000 + trial);
        const TemporaryFolder f;
        wand.write(f);
        REQUIRE(bundle(f).code == 0);
        std::filesystem::rename(f / "calib.yml", f / "start.yml");
        wand.wave(60);
        writeFile(f / "matches.csv", wand.matches());
        const ToolResult result = runTool(commandFor(f, ""));
        CAPTURE(scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        const Rig found = Rig::read(f / "calib.yml");
        const std::map<std::string, double> is = found.parameters(), std = found.deviations();
        for (const auto& parameter : wand.truth.parameters())
            if (parameter.first.find("normal[2]") == std::string::npos)
            {
                const double z = (is.at(parameter.first) - parameter.second)/std.at(parameter.first);
                squares += z*z;
                worst = std::max(worst, std::abs(z));
                count++;
            }
    }
    const double ratio = std::sqrt(squares/count);
    WARN("[numbers] refract_bundle after refract_bundle, " << trials << " wands, seed " << scenes::seed() << ": error over stated "
         << ratio << " (worst " << worst << ")");
    CHECK(ratio > 0.8);
    CHECK(ratio < 1.25);
}

TEST_CASE("refract_bundle leaves wrong matches out and names them", "[tools][bundle]")
{
    Wand wand(7, 3);
    for (int i : { 11, 40, 77 })
        wand.pixels[1][i] = Point2d(40 + 3*i, 900 - 5*i);
    const TemporaryFolder f;
    wand.write(f);
    const ToolResult result = bundle(f, "--summary=" + f / "summary.json");
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    CHECK(mentions(result.out, "pixels left out: "));
    const std::map<std::string, double> truth = wand.truth.parameters(), is = Rig::read(f / "calib.yml").parameters();
    const std::map<std::string, double> std = Rig::read(f / "calib.yml").deviations();
    for (const auto& parameter : truth)
        CHECK(std::abs(is.at(parameter.first) - parameter.second) < 5*std.at(parameter.first));
    // Two cameras are left of such a point; of a pair nothing is.
    Wand two(8);
    two.pixels[1][20].y += 50;
    two.write(f);
    const ToolResult pair = bundle(f, "--summary=" + f / "summary.json");
    CAPTURE(pair.out, pair.err);
    REQUIRE(pair.code == 0);
    CHECK(mentions(pair.out, "wrong matches: m10 a"));
    CHECK(rowsOf(f / "points.csv")[20].status() == 9);
    const nlohmann::json json = nlohmann::json::parse(readFile(f / "summary.json"));
    CHECK(json["left_out"][0] == "m10 a");
    CHECK(json["rms"].get<double>() < 0.3);
    const ToolResult all = bundle(f, "--no-robust --max-rms=0.3");
    CAPTURE(all.out, all.err);
    CHECK(all.code == 2);
    CHECK(mentions(all.err, "limit not met"));
    CHECK(mentions(all.err, "pixels are wrong ('m10 a'): all others fit"));
    CHECK(mentions(all.err, "leave out --no-robust"));
}

TEST_CASE("refract_bundle names the camera whose pixels are of other moments, before any fit", "[tools][bundle]")
{
    for (int cameras : {2, 3})
    {
        Wand wand(31, cameras);
        std::vector<Point2d>& pixels = wand.pixels[cameras - 1];
        std::rotate(pixels.begin(), pixels.end() - 4, pixels.end());        // two moments of two marks
        const TemporaryFolder f;
        wand.write(f);
        const ToolResult result = bundle(f);
        CAPTURE(scenes::seed(), cameras, result.err);
        CHECK(result.code == 1);
        CHECK((mentions(result.err, format("the pixels of camera %d stand 2 image(s) too far down", cameras))
               || (cameras == 2 && mentions(result.err, "the pixels of camera 1 stand 2 image(s) too far up"))));
        CHECK_FALSE(std::filesystem::exists(f / "calib.yml"));
    }
}

TEST_CASE("refract_bundle names the camera whose pixels are one moment late, which a fit nearly hides", "[tools][bundle]")
{
    for (int cameras : {2, 3})
    {
        Wand wand(40 + cameras, cameras);
        wand.sweep(150);
        const TemporaryFolder f;
        wand.write(f);
        const ToolResult right = bundle(f);
        CAPTURE(scenes::seed(), cameras, right.out, right.err);
        CHECK(right.code == 0);
        CHECK_FALSE(mentions(right.err, "too far"));
        std::vector<Point2d>& pixels = wand.pixels[cameras - 1];
        std::rotate(pixels.begin(), pixels.end() - 2, pixels.end());
        wand.write(f);
        const ToolResult late = bundle(f);
        CAPTURE(late.out, late.err);
        CHECK(late.code != 0);
        CHECK((mentions(late.err, format("the pixels of camera %d stand 1 image(s) too far down", cameras))
               || (cameras == 2 && mentions(late.err, "the pixels of camera 1 stand 1 image(s) too far up"))));
    }
}

TEST_CASE("refract_measure finds the points that refract_bundle wrote", "[tools][bundle]")
{
    Wand wand(9, 3, 60);
    const TemporaryFolder f;
    wand.write(f);
    writeFile(f / "matches.csv", wand.matches(false));          // ids of their own
    std::string lengths = "id1,id2,length,std\n";
    for (int moment = 0; moment < 60; moment += 2)              // the other moments are points like any
        lengths += format("%da,%db,%g,%g\n", moment, moment, WAND, WAND_STD);
    writeFile(f / "lengths.csv", lengths);
    const ToolResult result = bundle(f);
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    const ToolResult measured = runTool("refract_measure " + f / "calib.yml" + " --points=" + f / "matches.csv --out=" + f / "m.csv");
    CAPTURE(measured.out, measured.err);
    REQUIRE(measured.code == 0);
    const std::vector<Row> ours = rowsOf(f / "points.csv"), theirs = rowsOf(f / "m.csv");
    REQUIRE(ours.size() == theirs.size());
    int compared = 0;
    for (size_t i = 0; i < ours.size(); i++)
    {
        if (ours[i].status() != 0)
            continue;
        const double off = norm(ours[i].X() - theirs[i].X());
        CAPTURE(ours[i].id, off, ours[i].fromEnd(2));
        CHECK(ours[i].id == theirs[i].id);
        // A known length moves its two ends within their noise; the others are where their rays are, to rounding.
        CHECK(off < (i/2 % 2 ? 1e-4 : 4*ours[i].fromEnd(2)));
        compared += i/2 % 2;
    }
    CHECK(compared > 20);
    for (const char* tool : { "refract_export %s --to=opencv --depth=600,800 --out=%s", "refract_bundle %s --free=none --points=" })
    {
        const bool isExport = mentions(tool, "export");
        const ToolResult again = runTool(isExport ? format(tool, (f / "calib.yml").c_str(), (f / "central.yml").c_str())
            : "refract_bundle " + f / "calib.yml" + " --points=" + f / "points.csv --out=" + f / "again.yml");
        CAPTURE(tool, again.out, again.err);
        CHECK(again.code == 0);
    }
}

TEST_CASE("What an earlier calibration knows has its say in refract_bundle, unless it is freed", "[tools][bundle]")
{
    const Wand wand(11, 2, 150);
    const TemporaryFolder f;
    wand.write(f);
    const ToolResult first = bundle(f);
    CAPTURE(scenes::seed(), first.out, first.err);
    REQUIRE(first.code == 0);
    const auto sigmaOf = [](const Rig& rig, const char* name) { return rig.deviations().at(name); };
    const Rig known = Rig::read(f / "calib.yml");
    std::filesystem::rename(f / "calib.yml", f / "start.yml");
    // Other moments of the same rig, without a length: its scale stays, its +- shrinks, and the truth is within.
    Wand later = wand;
    later.wave(60);
    writeFile(f / "matches.csv", later.matches());
    const ToolResult second = runTool(commandFor(f, ""));
    CAPTURE(second.out, second.err);
    REQUIRE(second.code == 0);
    CHECK(mentions(second.out, "scale: T of the start, +- "));
    const Rig better = Rig::read(f / "calib.yml");
    CHECK(sigmaOf(better, "1 normal[0]") < sigmaOf(known, "1 normal[0]"));
    for (const auto& parameter : wand.truth.parameters())
        CHECK(std::abs(better.parameters().at(parameter.first) - parameter.second) < 5*better.deviations().at(parameter.first));
    // A window that was taken out meanwhile: contradicted, and found if it is free.
    Wand moved = wand;
    GlassWindow window = moved.truth.cameras[1]->window();
    window.normal = normalize(window.normal + Vec3d(0.03, 0, 0));
    moved.truth.cameras[1]->setWindow(window);
    moved.wave(100);
    writeFile(f / "matches.csv", moved.matches());
    const ToolResult held = runTool(commandFor(f, ""));
    CAPTURE(held.out, held.err);
    CHECK(held.code == 2);
    CHECK(mentions(held.err, "not as the start says; explained, with 0."));
    CHECK(mentions(held.err, "if free: normal"));
    const ToolResult freed = runTool(commandFor(f, "--free=normal"));
    CAPTURE(freed.out, freed.err);
    CHECK(freed.code == 0);
    const Rig result = Rig::read(f / "calib.yml");
    CHECK(std::abs(result.cameras[1]->window().normal[0] - window.normal[0]) < 5*sigmaOf(result, "2 normal[0]"));
}

TEST_CASE("What is known of normals has its say in refract_bundle where the start knows no better", "[tools][bundle]")
{
    const Wand wand(17, 2, 30);
    const TemporaryFolder f;
    wand.write(f);
    std::string options = "--normal-std=0.01";
    for (const Ptr<RefractiveCamera>& camera : wand.truth.cameras)
    {
        const Vec3d n = camera->window().normal;
        options += format(" --normal=%.9g,%.9g,%.9g", n[0], n[1], n[2]);
    }
    REQUIRE(bundle(f).code == 0);
    const std::map<std::string, double> loose = Rig::read(f / "calib.yml").deviations();
    const ToolResult result = bundle(f, options);
    CAPTURE(scenes::seed(), result.out, result.err);
    REQUIRE(result.code == 0);
    const Rig found = Rig::read(f / "calib.yml");
    const double known = 0.01*CV_PI/180;
    for (size_t c = 0; c < 2; c++)
    {
        const std::string name = std::to_string(c + 1) + " normal[0]";
        CHECK(found.deviations().at(name) <= 1.001*known);
        CHECK(loose.at(name) > 2*known);
        CHECK(norm(found.cameras[c]->window().normal - wand.truth.cameras[c]->window().normal) < 5*known);
    }
    CHECK(mentions(bundle(f, options + " --free=normal,extrinsics").err, "leave one out"));
    CHECK(mentions(bundle(f, "--normal=0,0,1").err, "say how well it is known"));
    CHECK(mentions(bundle(f, "--normal=0,0,-1 --normal-std=1").err, "its z is more than 0"));
    std::filesystem::rename(f / "calib.yml", f / "start.yml");
    CHECK(mentions(bundle(f, options).err, "has a covariance, which says how well its windows are known"));
}

namespace {

//! Markers on each camera's window, beside its axis, measured with so much noise; one table a camera. @return the options
std::string markersOn(const Wand& wand, const TemporaryFolder& f, scenes::Random random, double std, double tooFar = 0)
{
    std::string options;
    for (size_t c = 0; c < wand.truth.cameras.size(); c++)
    {
        const GlassWindow window = wand.truth.cameras[c]->window();
        const Vec3d x = normalize(window.normal.cross(Vec3d(0, 1, 0))), y = window.normal.cross(x);
        std::string table = "id,x,y,z\n";
        for (int i = 0; i < 6; i++)
        {
            const Vec3d X = (window.distance + tooFar)*window.normal + (80. + 60*(i % 3))*x + (100.*(i/3) - 50)*y;
            table += format("%d,%.6f,%.6f,%.6f\n", i, X[0] + random.normal(std), X[1] + random.normal(std), X[2] + random.normal(std));
        }
        const std::string path = f / format("pane%zu.csv", c + 1);
        writeFile(path, table);
        options += " --pane-points=" + path;
    }
    return options + format(" --pane-points-std=%g", std);
}

} // namespace

TEST_CASE("Markers on the panes have their say in refract_bundle, of normal and distance together", "[tools][bundle]")
{
    const int trials = scenes::trials(12);
    double squares = 0;
    int count = 0;
    for (int trial = 0; trial < trials; trial++)
    {
        const Wand wand(1700 + trial, 2, 30);
        const TemporaryFolder f;
        wand.write(f);
        REQUIRE(bundle(f).code == 0);
        const std::map<std::string, double> loose = Rig::read(f / "calib.yml").deviations();
        const ToolResult result = bundle(f, markersOn(wand, f, scenes::Random(4550 + trial), 0.1) + " --distance-std=0");
        CAPTURE(scenes::seed(), trial, result.out, result.err);
        REQUIRE(result.code == 0);
        const Rig found = Rig::read(f / "calib.yml");
        const std::map<std::string, double> is = found.parameters(), std = found.deviations(), truth = wand.truth.parameters();
        for (const std::string name : {"1 normal[0]", "1 distance", "2 normal[1]", "2 distance"})
        {
            CHECK(std.at(name) < 0.7*loose.at(name));
            squares += std::pow((is.at(name) - truth.at(name))/std.at(name), 2);
            count++;
        }
    }
    const double ratio = std::sqrt(squares/count);
    WARN("[numbers] refract_bundle with markers on the panes, " << trials << " wands, seed " << scenes::seed() << ": error over stated "
         << ratio);
    CHECK(ratio > 0.68);                // 48 values, which a camera's normal and distance share: +- 0.13
    CHECK(ratio < 1.32);
}

TEST_CASE("Markers on the panes that the matches contradict are named, and what does not go with them", "[tools][bundle]")
{
    const Wand wand(18, 2, 60);
    const TemporaryFolder f;
    wand.write(f);
    const ToolResult far = bundle(f, markersOn(wand, f, scenes::Random(4590), 0.1, 60) + " --distance-std=0");
    CAPTURE(far.out, far.err);
    CHECK(far.code == 2);
    CHECK(mentions(far.err, "the matches contradict --pane-points of camera"));
    const std::string options = markersOn(wand, f, scenes::Random(4590), 0.1);
    CHECK(mentions(bundle(f, options + " --free=distance").err, "leave one out"));
    CHECK(mentions(bundle(f, "--pane-points=" + f / "pane1.csv --pane-points-std=0.1").err, "there are 2 windows"));
    CHECK(mentions(bundle(f, "--normal-std=1").err, "add --normal"));
    std::filesystem::rename(f / "calib.yml", f / "start.yml");
    CHECK(mentions(bundle(f, options).err, "--pane-points is for a start of nominal values"));
}

TEST_CASE("refract_bundle says in one sentence what is wrong with its input", "[tools][bundle]")
{
    const Wand wand(13, 2, 30);
    const TemporaryFolder f;
    wand.write(f);
    const std::string matches = wand.matches(), lengths = readFile(f / "lengths.csv"), start = readFile(f / "start.yml");
    const std::string line1 = matches.substr(0, matches.find('\n') + 1), head = "image,id,u1,v1,u2,v2\n";
    struct Bad { std::string matches, lengths, options, expected; };
    const Bad bad[] = {
        {matches + "m0,a,100,100,200,200\n", lengths, "", "the point 'm0 a' is in line 2 already"},
        {head + "m0,a,100,100,200,200\nm0,b,2000,100,200,200\n", lengths, "", "(2000, 100) is outside the image of camera 1"},
        {head + "m0,a,100,,200,200\n", lengths, "", "must both be numbers"},
        {head + "m0,a,inf,100,200,200\n", lengths, "", "u1 must be a number"},
        {head + "m0,a,x,100,200,200\n", lengths, "", "u1 must be a number"},
        {head + "m0,a,nan,nan,200,200\nm0,b,100,100,,\n", lengths, "", "camera 1 has no point in common"},
        {head, lengths, "", "has no rows"}, {"", lengths, "", "has no rows"},
        {"id,u1,v1\n1,2,3\n", lengths, "", "no column 'u2'"},
        {"id,u1,v1,u2,v2,u3,v3\n1,2,3,4,5,6,7\n", lengths, "", "pixels of camera 3"},
        {"id,u1,v1,u2,v2,w\n1,2,3,4,5,6\n", lengths, "", "the column 'w'"},
        {head + "m0,a,100,100,200,200\nm0,b,150,100,250,200\n", "id1,id2,length,std\na,b,200,0.1\n", "", "fewer than are needed"},
        {matches, "id1,id2,length,std\na,c,200,0.1\n", "", "has no point 'c'"},
        {matches, "id1,id2,length,std\na,a,200,0.1\n", "", "a length is between two points"},
        {matches, "id1,id2,length,std\na,b,200,0\n", "", "std is 0"}, {matches, "id1,id2,length,std\na,b,-1,0.1\n", "", "length is -1"},
        {matches, "id1,id2,length,std\na,b,nan,0.1\n", "", "length must be a number"},
        {matches, "id1,id2,length,std\na,b,0.2,200\n", "", "exchanged"},
        {matches, "id1,id2,length,std\na,b,200,0.1\nb,a,200,0.1\n", "", "is in line 2 already"},
        {matches, "id1,id2,length,std\na,b,0.2,0.0001\n", "", "in another unit"},
        {matches, "image,id1,id2,length,std\nm99,a,b,200,0.1\n", "", "has no image 'm99'"},
        {matches, "image1,id1,image2,id2,length,U\nm1,a,m1,b,200,0.1\n", "", "no column 'std'"},
        {matches, "", "", "nothing tells the scale"}, {matches, lengths, "--free=normals", "--free"},
        {matches, lengths, "--free=none,normal", "leave the other names out"}, {matches, lengths, "--unit=furlong", "--unit"},
        {matches, lengths, "--max-rms=nan", "--max-rms"}, {matches, lengths, "--no-window", "has a glass_window"},
        {matches, lengths, "--config=" + f / "none.toml", "no such file"}};
    for (const Bad& b : bad)
    {
        writeFile(f / "matches.csv", b.matches);
        writeFile(f / "lengths.csv", b.lengths);
        writeFile(f / "calib.yml", "old");
        const ToolResult result = b.lengths.empty() ? runTool(commandFor(f, b.options)) : bundle(f, b.options);
        CAPTURE(b.matches.substr(0, 80), b.lengths, b.options, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, b.expected));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(readFile(f / "calib.yml") == "old");
    }
    writeFile(f / "matches.csv", matches);
    writeFile(f / "lengths.csv", lengths);
    wand.start.cameras[0]->save(f / "start.yml");
    const ToolResult one = bundle(f);
    CAPTURE(one.err);
    CHECK(one.code == 1);
    CHECK(mentions(one.err, "has one camera"));
    writeFile(f / "start.yml", start);
    const ToolResult loose = bundle(f, "--free=normal,extrinsics,intrinsics,thickness,index,distance,outer-index --exact");
    CAPTURE(loose.out, loose.err);
    CHECK(loose.code != 0);
    const ToolResult over = runTool("refract_bundle " + f / "start.yml" + " --points=" + f / "matches.csv --out=" + f / "start.yml");
    CHECK(over.code == 1);
}

TEST_CASE("What cannot be so is not called usable by refract_bundle", "[tools][bundle]")
{
    const Wand wand(15, 2, 60);
    const TemporaryFolder f;
    wand.write(f);
    Wand swapped = wand, mirrored = wand;
    std::swap(swapped.pixels[0], swapped.pixels[1]);
    for (Point2d& p : mirrored.pixels[1])
        p.x = SIZE.width - 1 - p.x;
    for (const std::string& matches : { swapped.matches(), mirrored.matches() })
    {
        writeFile(f / "matches.csv", matches);
        const ToolResult result = bundle(f);
        CAPTURE(scenes::seed(), result.out, result.err);
        CHECK(result.code != 0);
        CHECK((result.code == 1 || mentions(result.out, "NOT USABLE: ")));
    }
    writeFile(f / "matches.csv", wand.matches());
    const ToolResult held = bundle(f, "--free=none");
    CAPTURE(held.out, held.err);
    CHECK(held.code == 2);
    CHECK(mentions(held.err, "order of the start"));
    CHECK(mentions(readFile(f / "calib.yml"), "NOT USABLE"));
    CHECK(bundle(f, "--pixel-sigma=0.1").code == 0);
    CHECK(bundle(f, "--pixel-sigma=0.01").code == 2);
}

TEST_CASE("refract_bundle says what it found in ten lines of 80 columns", "[tools][bundle]")
{
    for (int cameras : { 2, 3, 6 })
    {
        const Wand wand(17, cameras, 40);
        const TemporaryFolder f;
        wand.write(f);
        const ToolResult result = bundle(f, "--max-rms=1");
        CAPTURE(cameras, result.out, result.err);
        CHECK(result.code == 0);
        CHECK(mentions(result.out, "PASS"));
        CHECK(std::count(result.out.begin(), result.out.end(), '\n') <= 10);
        std::istringstream lines(result.out);
        for (std::string line; std::getline(lines, line); )
            CHECK(line.size() <= 80);
        CHECK(bundle(f, "--quiet").out.empty());
    }
}

// samples/data/wand: what its start.yml thinks, and what is so.
TEST_CASE("The wand of the guide is made anew", "[.wand-data]")
{
    const std::string folder = paths::bundled() + "/wand";
    Wand wand(0);
    wand.start = Rig::read(folder + "/start.yml");
    wand.truth = Rig::read(folder + "/start.yml");
    wand.random = scenes::Random(1);
    wand.length = WAND + (wand.length - WAND)*0.1/WAND_STD;         // this one is known to 0.1 mm
    for (int c = 0; c < 2; c++)
    {
        GlassWindow window = wand.truth.cameras[c]->window();
        window.normal = normalize(window.normal + Vec3d(0.05 - 0.09*c, 0.04 + 0.02*c, 0));
        window.distance += wand.random.normal(1);
        window.thickness[0] += wand.random.normal(0.1);
        window.index[0] += wand.random.normal(0.001);
        window.wedge = { Vec2d(wand.random.normal(ARC_MINUTE), wand.random.normal(ARC_MINUTE)) };
        wand.truth.cameras[c]->setWindow(window);
    }
    Matx33d turned;
    Rodrigues(Vec3d(0.01, -0.02, 0.015), turned);
    wand.truth.Rs[1] = Mat(turned)*wand.truth.Rs[1];
    wand.truth.Ts[1] += Mat(Vec3d(4, -6, 5));
    wand.wave(80);
    wand.pixels[1][2*31] += Point2d(15, 60);       // a glint, taken for the wand's end
    std::string csv = wand.matches();
    for (const auto& name : { std::make_pair(std::string(",a,"), std::string(",red,")), { ",b,", ",green," } })
        for (size_t at = csv.find(name.first); at != std::string::npos; at = csv.find(name.first, at))
            csv.replace(at, name.first.size(), name.second);
    writeFile(folder + "/matches.csv", csv);
    writeRig(folder + "/truth.yml", wand.truth.cameras, wand.truth.Rs, wand.truth.Ts);
}
