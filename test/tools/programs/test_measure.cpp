// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_measure as a user runs it: on the bundled images, whose truth is known, and on wrong input.
#include "run_tool.hpp"
#include "truth_file.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <regex>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const std::string TARGET = " --size=6x5 --square=39";

std::string image(const std::string& name) { return STEREO + "/" + name + ".jpg"; }

double rmsAgainst(const TrueView& truth, const std::vector<CsvRow>& rows)
{
    const std::vector<cv::Point3d> object = chessboard(6, 5, 39);
    double squares = 0;
    for (const CsvRow& row : rows)
        squares += std::pow(cv::norm(row.point - truth.inCamera1(object[row.id])), 2);
    return std::sqrt(squares/rows.size());
}


//! Copies of bundled images under other names: measure1/FROM -> FOLDER/TO.jpg
void copyImage(const TemporaryFolder& folder, const std::string& from, const std::string& to)
{
    const std::filesystem::path path(folder/(to + ".jpg"));
    std::filesystem::create_directories(path.parent_path());
    std::filesystem::copy_file(image(from), path);
}

//! The truth's file with something else in place of a part of it.
std::string changedTruth(const std::string& part, const std::string& instead)
{
    std::string text = readFile(STEREO + "/truth.yml");
    const size_t at = text.find(part);
    REQUIRE(at != std::string::npos);
    return text.replace(at, part.size(), instead);
}

//! Errors in units of the sigma that the tool states; about 1 if it is honest.
double rmsInSigma(const TrueView& truth, const std::vector<CsvRow>& rows)
{
    const std::vector<cv::Point3d> object = chessboard(6, 5, 39);
    double squares = 0;
    for (const CsvRow& row : rows)
        for (int k = 0; k < 3; k++)
            squares += std::pow((row.point[k] - truth.inCamera1(object[row.id])[k])/row.sigma[k], 2);
    return std::sqrt(squares/(3*rows.size()));
}

} // namespace

TEST_CASE("refract_measure triangulates fresh views to within their stated uncertainty", "[tools][measure]")
{
    const TemporaryFolder folder;
    const auto truth = readTruth(STEREO);
    for (const std::string stem : {"z540_1", "z600_3", "z800_2", "z1200_1"})
    {
        CAPTURE(stem);
        const ToolResult result = runTool("refract_measure " + STEREO + "/truth.yml " + image("measure1/" + stem) + " "
            + image("measure2/" + stem) + TARGET + " --pixel-sigma=0.014 --out=" + (folder / "points.csv"));
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        CHECK(mentions(result.err, "truth.yml' has no covariance"));
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(result.out.find("30 of 30") != std::string::npos);
        const std::vector<CsvRow> rows = readPointsCsv(readFile(folder / "points.csv"));
        REQUIRE(rows.size() == 30);
        const TrueView& view = truth.at("measure1/" + stem + ".jpg");
        CHECK(rmsAgainst(view, rows) < 0.02*std::pow(view.tvec[2]/600, 2));
        CHECK(rmsInSigma(view, rows) < 1.6);
        CHECK(rmsInSigma(view, rows) > 0.4);
        for (size_t i = 0; i < rows.size(); i++)
        {
            CHECK(rows[i].image == stem);
            CHECK(rows[i].id == (int)i);
            CHECK(rows[i].status == 0);
            CHECK(cv::norm(rows[i].pixel1 - view.pixels[i]) < 0.1);
            CHECK(cv::norm(rows[i].pixel2 - truth.at("measure2/" + stem + ".jpg").pixels[i]) < 0.1);
        }
        CHECK(folder.count() == 1);
    }
}

TEST_CASE("refract_measure pairs the images of two globs by their stems and compares baselines", "[tools][measure]")
{
    const TemporaryFolder folder;
    const ToolResult result = runTool("refract_measure " + STEREO + "/truth.yml '" + image("measure1/z600_*") + "' '"
        + image("measure2/z600_[1-5]") + "'" + TARGET + " --compare --out=" + (folder / "points.csv"));
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    CHECK(result.out.find("5 views") != std::string::npos);
    CHECK(result.out.find("glass ignored") != std::string::npos);
    const std::vector<CsvRow> rows = readPointsCsv(readFile(folder / "points.csv"));
    REQUIRE(rows.size() == 150);
    CHECK(rows.back().image == "z600_5");
    CHECK(rows.back().id == 29);
    CHECK(mentions(result.err, "z600_6"));          // skipped: it has no partner
    // The truth file has no rms and no --pixel-sigma was given: the uncertainty is unknown, and says so.
    CHECK(std::isnan(rows[0].sigma[0]));
    CHECK(result.out.find("unknown") != std::string::npos);
    CHECK(mentions(result.err, "--pixel-sigma"));
}

TEST_CASE("Where names have more than the moment, --view-pattern says where it stands", "[tools][measure][stereo]")
{
    const TemporaryFolder f;
    for (int c : {1, 2})
        for (int m : {1, 2, 3})
            std::filesystem::copy_file(cv::format("%s/measure%d/z600_%d.jpg", STEREO.c_str(), c, m),
                                       f / cv::format("%c_z%d_%d.jpg", 'k' + c, m, 10*m + 7*c));
    const std::string both = " '" + f / "l_*.jpg' '" + f / "m_*.jpg'", measure = "refract_measure " + STEREO + "/truth.yml" + both + TARGET;
    CHECK(runTool(measure).code == 1);
    CHECK(mentions(runTool(measure + " --view-pattern='x{}'").err, "has no name of this form"));
    const ToolResult measured = runTool(measure + " --view-pattern='*_z{}_*' --out=" + f / "points.csv");
    CAPTURE(measured.out, measured.err);
    CHECK(measured.code == 0);
    CHECK(readPointsCsv(readFile(f / "points.csv")).size() == 90);

    const std::string stereo = "refract_stereo " + STEREO + "/truth.yml" + both + " --depth=500,700 --out-dir=" + f / "clouds";
    CHECK(mentions(runTool(stereo).err, "images of one moment need equal names"));
    CHECK(mentions(runTool(stereo + " --view-pattern='x{}'").err, "has no name of this form"));
}

TEST_CASE("refract_measure meets a known plane, and finds a target's pose, with one camera", "[tools][measure]")
{
    const TemporaryFolder folder;
    const TrueView view = readTruth(STEREO).at("measure1/z600_2.jpg");
    const std::string call = "refract_measure " + STEREO + "/truth.yml " + image("measure1/z600_2") + TARGET
                             + " --pixel-sigma=0.014 --out=" + (folder / "points.csv");

    const ToolResult onPlane = runTool(call + view.planeOption());
    CAPTURE(onPlane.err);
    REQUIRE(onPlane.code == 0);
    std::vector<CsvRow> rows = readPointsCsv(readFile(folder / "points.csv"));
    REQUIRE(rows.size() == 30);
    CHECK(std::isnan(rows[0].pixel2.x));
    CHECK(rmsAgainst(view, rows) < 0.01);
    CHECK(rmsInSigma(view, rows) < 1.6);

    const ToolResult pose = runTool(call);
    CAPTURE(pose.err);
    REQUIRE(pose.code == 0);
    CHECK(pose.out.find("length") == std::string::npos);    // they are given, not measured
    rows = readPointsCsv(readFile(folder / "points.csv"));
    CHECK(rmsAgainst(view, rows) < 0.05);
    CHECK(rmsInSigma(view, rows) < 2.5);        // one pose: three errors, common to all points
}

TEST_CASE("the bundled rig, from images to lengths", "[tools][measure]")
{
    const TemporaryFolder folder;
    const std::string calib = folder / "calib.yml";
    const ToolResult calibrated = runTool("refract_calib" + TARGET + " --direct='" + image("direct1/*") + "' --glass='"
        + image("glass1/*") + "' --direct2='" + image("direct2/*") + "' --glass2='" + image("glass2/*")
        + "' --thickness=20 --index=1.5437 --quiet --out=" + calib);
    CAPTURE(calibrated.err);
    REQUIRE(calibrated.code == 0);

    const cv::FileStorage found(calib, cv::FileStorage::READ), truth(STEREO + "/truth.yml", cv::FileStorage::READ);
    for (const std::string camera : {"camera1", "camera2"})
    {
        std::vector<double> n, expected;
        found[camera]["glass_window"]["normal"] >> n;
        truth[camera]["glass_window"]["normal"] >> expected;
        const double angle = std::asin(cv::norm(cv::Vec3d(n.data()).cross(cv::Vec3d(expected.data()))))*180/CV_PI;
        const double stated = (double)found[camera]["glass_window_std"]["normal_deg"][0];
        std::cout << "[numbers] bundled rig, " << camera << ": normal off by " << angle << " degrees, stated " << stated << '\n';
        CHECK(angle < 3*stated);
        CHECK(stated < 0.25);       // 0.12 if the windows were known to be at the camera, from where they are 50 mm
    }

    const ToolResult measured = runTool("refract_measure " + calib + " '" + image("measure1/z600_*") + "' '"
        + image("measure2/z600_*") + "'" + TARGET + " --out=" + (folder / "points.csv"));
    CAPTURE(measured.err);
    REQUIRE(measured.code == 0);
    const std::vector<CsvRow> rows = readPointsCsv(readFile(folder / "points.csv"));
    REQUIRE(rows.size() == 180);
    double squares = 0;
    int count = 0;
    for (size_t i = 1; i < rows.size(); i++)
        if (i % 6)      // a neighbour in the same row of the board
        {
            squares += std::pow(cv::norm(rows[i].point - rows[i - 1].point) - 39, 2);
            count++;
        }
    const double rms = std::sqrt(squares/count);
    std::cout << "[numbers] bundled rig, lengths at 600 mm: RMS error " << rms << " mm (limit 0.05)\n";
    CHECK(rms < 0.05);
}

TEST_CASE("refract_measure names the image of each point, and the images that it skips", "[tools][measure]")
{
    const TemporaryFolder folder;
    for (const std::string camera : {"1", "2"})
    {
        copyImage(folder, "measure" + camera + "/z600_1", camera + "/a");
        copyImage(folder, "measure" + camera + "/z600_3", camera + "/c, d");
    }
    copyImage(folder, "measure1/z600_4", "1/e");
    copyImage(folder, "measure2/z600_5", "2/f");
    for (const std::string camera : {"1", "2"})
        cv::imwrite(folder/(camera + "/b.jpg"), cv::Mat(1024, 1280, CV_8U, cv::Scalar(90)));
    const std::string call = "refract_measure " + STEREO + "/truth.yml --pixel-sigma=0.014" + TARGET + " --out="
                             + (folder / "points.csv") + " '" + (folder / "1/*") + "'";
    const ToolResult result = runTool(call + " '" + (folder / "2/*") + "'");
    INFO(result.out << result.err);
    REQUIRE(result.code == 0);
    const std::string csv = readFile(folder / "points.csv");
    CHECK(csv.find("image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status\na,0,189.66") == 0);
    CHECK(mentions(csv, "\na,29,"));
    CHECK(mentions(csv, "\n\"c, d\",0,"));
    CHECK(mentions(csv, "\n\"c, d\",29,"));
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 61);
    for (const std::string skipped : {"1/b.jpg", "2/b.jpg", "'e'", "'f'"})
        CHECK(mentions(result.err, skipped));

    // What it writes, refract_epilines reads.
    const ToolResult picture = runTool("refract_epilines " + STEREO + "/truth.yml " + (folder / "1/a.jpg") + " "
        + (folder / "2/a.jpg") + " --depth=400,900 --points=" + (folder / "points.csv") + " --out=" + (folder / "p.png"));
    CAPTURE(picture.err);
    CHECK(picture.code == 0);

    const ToolResult one = runTool(call);
    INFO(one.err);
    REQUIRE(one.code == 0);
    CHECK(mentions(one.err, "1/b.jpg"));
    CHECK(mentions(readFile(folder / "points.csv"), "\ne,29,"));
}

TEST_CASE("refract_measure gives no point for pixels that contradict each other", "[tools][measure]")
{
    const TemporaryFolder folder;
    const std::string call = "refract_measure " + STEREO + "/truth.yml --pixel-sigma=0.014" + TARGET + " --out="
                             + (folder / "points.csv") + " ";
    const std::string swapped = image("measure2/z600_1") + " " + image("measure1/z600_1");
    const std::string twoViews = image("measure1/z600_1") + " " + image("measure2/z600_2");
    for (const std::string& images : {swapped, twoViews})
    {
        const ToolResult result = runTool(call + images);
        INFO(result.out << result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, "swapped"));
        CHECK(mentions(result.err, "30 of 30 points"));
        CHECK_FALSE(std::filesystem::exists(folder / "points.csv"));
    }

    copyImage(folder, "measure1/z600_1", "1/a");
    copyImage(folder, "measure2/z600_1", "2/a");
    copyImage(folder, "measure1/z600_2", "1/b");
    copyImage(folder, "measure2/z600_3", "2/b");
    const ToolResult mixed = runTool(call + "'" + (folder / "1/*") + "' '" + (folder / "2/*") + "'");
    INFO(mixed.out << mixed.err);
    REQUIRE(mixed.code == 0);
    CHECK(mentions(mixed.err, "('b'; status 9"));
    for (const CsvRow& row : readPointsCsv(readFile(folder / "points.csv")))
    {
        CAPTURE(row.image, row.id);
        CHECK(row.status == (row.image == "a" ? 0 : 9));
        CHECK(std::isnan(row.point[0]) == (row.image == "b"));
        CHECK(std::isnan(row.sigma[0]) == (row.image == "b"));
    }
}

TEST_CASE("refract_measure states no uncertainty of a pose that its points contradict, and ends with 2", "[tools][measure]")
{
    const TemporaryFolder folder;
    std::ofstream(folder / "lens.yml") << changedTruth("-4.0820000000000001e-01", "1.2");     // k1 of camera 1
    const std::string call = " --pixel-sigma=0.014 " + image("measure1/z600_1") + TARGET + " --out=" + (folder / "points.csv");
    REQUIRE(runTool("refract_measure " + STEREO + "/truth.yml" + call).code == 0);
    const ToolResult wrong = runTool("refract_measure " + (folder / "lens.yml") + call);
    INFO(wrong.out << wrong.err);
    REQUIRE(wrong.code == 2);
    CHECK(mentions(wrong.err, "the pose leaves residuals"));
    for (const CsvRow& row : readPointsCsv(readFile(folder / "points.csv")))
    {
        CHECK(row.status == 9);
        CHECK(std::isfinite(row.point[2]));
        CHECK(std::isnan(row.sigma[2]));
    }
}

TEST_CASE("refract_measure ends with 2 if most points contradict themselves", "[tools][measure]")
{
    const TemporaryFolder folder;
    // Off by more than the noise, and not so far that nothing is measured.
    std::ofstream(folder / "moved.yml") << changedTruth("4.8749000000000001e+02", "4.8899e+02");      // cy of camera 2
    const ToolResult r = runTool("refract_measure " + (folder / "moved.yml") + " " + image("measure1/z600_1") + " "
        + image("measure2/z600_1") + TARGET + " --pixel-sigma=0.014 --out=" + (folder / "points.csv"));
    INFO(r.out << r.err);
    CHECK(r.code == 2);
    CHECK(mentions(r.err, "30 of 30 points contradict"));
    CHECK(readPointsCsv(readFile(folder / "points.csv")).size() == 30);
}

TEST_CASE("A board in another unit than the calibration's is refused", "[tools][measure][units]")
{
    const TemporaryFolder folder;
    const std::string truth = readFile(STEREO + "/truth.yml"), document = "---\n";
    std::string text = truth;
    text.insert(text.find(document) + document.size(), "unit: mm\ntarget_square: 39.\n");
    std::ofstream(folder / "calib.yml") << text;
    const std::string images = " " + image("measure1/z600_1") + " " + image("measure2/z600_1")
                               + " --size=6x5 --pixel-sigma=0.014";
    const std::string measure = "refract_measure " + (folder / "calib.yml") + images;
    const std::string check = "refract_check " + (folder / "calib.yml") + " --size=6x5 --pixel-sigma=0.014 --glass="
                              + image("measure1/z600_1");
    for (const std::string& tool : {measure, check})
        for (const std::string square : {"0.039", "3.9", "1.535", "0.39"})
        {
            const ToolResult r = runTool(tool + " --square=" + square);
            INFO(square << r.err);
            CHECK(r.code == 1);
            CHECK(mentions(r.err, "squares of 39 mm, this one " + square + ": another unit?"));
            CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
        }
    const ToolResult same = runTool(measure + " --square=39"), inch = runTool(measure + " --square=1.535 --unit=inch");
    CHECK(same.code == 0);
    CHECK(inch.code == 1);
    CHECK(mentions(inch.err, "in mm"));

    // Ten times smaller indeed, says the caller; the lengths say that it is not.
    const ToolResult said = runTool(measure + " --square=3.9 --unit=mm --out=" + (folder / "points.csv"));
    INFO(said.out << said.err);
    CHECK(said.code == 2);
    CHECK(mentions(said.err, "on average 10 times those of the target"));
    CHECK(readPointsCsv(readFile(folder / "points.csv")).size() == 30);
    CHECK(runTool("refract_measure " + STEREO + "/truth.yml" + images + " --square=30").code == 2);      // 1.3 times
    CHECK(runTool("refract_measure " + STEREO + "/truth.yml" + images + " --square=36").code == 0);      // 1.08 times
}

TEST_CASE("A calibration file with numbers that cannot be is refused", "[tools][measure]")
{
    const TemporaryFolder folder;
    const std::string truth = readFile(STEREO + "/truth.yml");
    const auto covarianceOf = [](int size, const std::string& first) {      // of two cameras with a pane each
        std::string text = cv::format("covariance: !!opencv-matrix\n   rows: %d\n   cols: %d\n   dt: d\n   data: [ ",
                                      size, size);
        for (int i = 0; i < size*size; i++)
            text += i == 0 ? first : i % (size + 1) ? ", 0." : ", 1e-6";
        return text + " ]\n";
    };
    const int parameters = 2*(4 + 5 + 8 + 2) + 6;       // lens, window, wedge; R and T
    const struct { std::string text, says; } cases[] = {
        {changedTruth("-2.3994111532053930e-01", "-2.6e-01"), "the normal for camera 1 has the length 1.00"},
        {truth + covarianceOf(parameters, "-1e-6"), "below 0"},
        {truth + covarianceOf(parameters, ".nan"), "covariance"},
        {truth + "covariance: 3\n", "covariance"},
        {truth + "residual_sigma: -0.1\n", "residual_sigma"},
        {truth + "residual_sigma: .nan\n", "residual_sigma"},
        {truth + "degrees_of_freedom: -5\n", "degrees_of_freedom"},
        {"", "is empty"},
        {"\xFF\xFE" + truth, "is UTF-16"},
        {"\xEF\xBB\xBF" + truth, "byte order mark"}};
    for (const auto& c : cases)
    {
        std::ofstream(folder / "calib.yml", std::ios::binary) << c.text;
        const ToolResult r = runTool("refract_measure " + (folder / "calib.yml") + " " + image("measure1/z600_1") + " "
                                     + image("measure2/z600_1") + TARGET + " --pixel-sigma=0.014");
        INFO(c.says << "\n" << r.out << r.err);
        CHECK(r.code == 1);
        CHECK(mentions(r.err, c.says));
        CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
    }
    std::ofstream(folder / "calib.yml") << truth + covarianceOf(parameters, "1e-6");
    CHECK(runTool("refract_measure " + (folder / "calib.yml") + " " + image("measure1/z600_1") + " " + image("measure2/z600_1")
                  + TARGET + " --pixel-sigma=0.014").code == 0);
}

TEST_CASE("A calibration that lacks something is not taken silently", "[tools][measure]")
{
    const TemporaryFolder folder;
    const std::string truth = readFile(STEREO + "/truth.yml");
    const size_t window = truth.find("   glass_window:"), camera2 = truth.find("camera2:");
    REQUIRE(window < camera2);
    std::ofstream(folder / "window.yml") << truth.substr(0, window) + truth.substr(camera2);
    std::ofstream(folder / "lens.yml") << changedTruth("   distortion_coefficients:", "   distortion:");
    std::ofstream(folder / "covariance.yml") << truth << "covariance: !!opencv-matrix\n   rows: 2\n   cols: 2\n   dt: d\n"
                                                         "   data: [ 1., 0., 0., 1. ]\n";
    const std::string first = image("measure1/z600_1"), second = image("measure2/z600_1");
    const struct { std::string command, rest; } tools[] = {
        {"refract_measure ", " " + first + " " + second + TARGET},
        {"refract_undistort ", " " + first + " --depth=600 --out-dir=" + (folder / "out")},
        {"refract_epilines ", " " + first + " " + second + TARGET + " --out=" + (folder / "p.png")},
        {"refract_check ", TARGET + " --pixel-sigma=0.014 --glass=" + first}};
    for (const auto& tool : tools)
    {
        const ToolResult noWindow = runTool(tool.command + (folder / "window.yml") + tool.rest);
        INFO(tool.command << noWindow.err);
        CHECK(noWindow.code == 1);
        CHECK(mentions(noWindow.err, "has no glass_window for camera 1"));
        const ToolResult noDistortion = runTool(tool.command + (folder / "lens.yml") + tool.rest);
        INFO(noDistortion.err);
        CHECK(noDistortion.code == 1);
        CHECK(mentions(noDistortion.err, "distortion_coefficients"));
        const ToolResult noFit = runTool(tool.command + (folder / "covariance.yml") + tool.rest);
        INFO(noFit.err);
        CHECK(noFit.code == 1);
        CHECK(mentions(noFit.err, "covariance is 2x2"));
    }
    const ToolResult said = runTool("refract_measure " + (folder / "window.yml") + tools[0].rest + " --no-window");
    CHECK(said.code == 1);                                  // camera 2 has one
    CHECK(mentions(said.err, "leave --no-window out"));
    std::ofstream(folder / "none.yml") << truth.substr(truth.find("   image_width"), window - truth.find("   image_width"));
    const std::string single = std::regex_replace(readFile(folder / "none.yml"), std::regex("(^|\n)   "), "$1");
    std::ofstream(folder / "none.yml") << "%YAML:1.0\n---\n" << single;
    const std::string call = "refract_measure " + (folder / "none.yml") + " " + first + TARGET + " --pixel-sigma=0.014";
    CHECK(runTool(call).code == 1);
    const ToolResult none = runTool(call + " --no-window");
    INFO(none.err);
    CHECK(none.code == 0);
    CHECK(mentions(none.err, "no covariance"));
}

TEST_CASE("refract_measure blames the right image, and knows a target of another size", "[tools][measure]")
{
    const TemporaryFolder folder;
    cv::imwrite(folder / "small.png", cv::Mat(100, 100, CV_8U, cv::Scalar(90)));
    const std::string call = "refract_measure " + STEREO + "/truth.yml ";
    const struct { std::string arguments, expected; } cases[] = {
        {"--nonsense", "there is no option --nonsense"},
        {(folder / "none.png") + TARGET, "there is no file '" + (folder / "none.png")},
        {"'" + (folder / "none*.png") + "'" + TARGET, "no file matches"},
        {"''" + TARGET, "an empty name"},
        {(folder / "small.png") + TARGET, "1280x1024"},
        {image("measure1/z600_1") + " --size=7x6 --square=39", "--size=6x5"},
        {image("measure1/z600_1") + " --size=5x4 --square=39", "--size=6x5"},
        {"'" + image("measure1/z600_?") + "' --size=7x6 --square=39", "--size=6x5"}};
    for (const auto& c : cases)
    {
        const ToolResult result = runTool(call + c.arguments);
        INFO(c.arguments << "\n" << result.err);
        CHECK(result.code == 1);
        CHECK(mentions(result.err, c.expected));
    }
}

TEST_CASE("refract_measure refuses with one sentence and writes nothing", "[tools][measure]")
{
    const TemporaryFolder folder;
    const std::string calib = STEREO + "/truth.yml", whole = readFile(image("measure1/z600_1"));
    const auto write = [&](const std::string& name, const std::string& bytes) {
        std::ofstream(folder/name, std::ios::binary) << bytes;
        return folder/name;
    };
    std::string noise(4000, 0);
    for (size_t i = 0; i < noise.size(); i++)
        noise[i] = (char)(i*i*2654435761u >> 13);
    const std::string first = image("measure1/z600_1"), second = image("measure2/z600_1");
    const std::string pages = folder / "pages.tiff";
    const cv::Mat page = cv::imread(first);
    REQUIRE(cv::imwritemulti(pages, std::vector<cv::Mat>(2, page)));
    const std::string both = first + " " + second + TARGET, out = " --out=" + (folder / "points.csv");

    struct Case { std::string arguments, expected; };
    const std::vector<Case> cases = {
        {"", "required"},
        {"--no-such-option", "--help"},
        {folder / "none.yml" + " " + both, "none.yml"},
        {write("empty.yml", "") + " " + both, "empty.yml"},
        {write("cut.yml", readFile(calib).substr(0, 1500)) + " " + both, "cut.yml"},
        {write("noise.yml", noise) + " " + both, "noise.yml"},
        {write("list.yml", "%YAML:1.0\n---\n[1, 2]\n") + " " + both, "list.yml"},
        {calib + " " + (folder / "none.jpg") + " " + second + TARGET, "none.jpg"},
        {calib + " " + write("cut.jpg", whole.substr(0, whole.size()/2)) + " " + second + TARGET, "cut short"},
        {calib + " " + write("noise.jpg", noise) + " " + second + TARGET, "noise.jpg"},
        {calib + " " + write("film.MP4", noise) + " " + second + TARGET, "is a video"},
        {calib + " " + write("empty.jpg", "") + " " + second + TARGET, "empty"},
        {calib + " " + STEREO + " " + second + TARGET, "folder"},
        {calib + " " + first + " " + second + " --size=6 --square=39", "--size"},
        {calib + " " + first + " " + second + " --size=9x14 --square=39", "--size=6x5"},
        {calib + " " + first + " " + second + " --size=6x5 --square=-1", "--square"},
        {calib + " " + first + " " + second + " --size=6x5 --square=nan", "--square"},
        {calib + " " + first + " " + second + " --size=6x5 --square=39 --pattern=stripes", "--pattern"},
        {calib + " " + first + " " + second + " --size=6x5 --square=39 --pattern=charuco --dictionary=X", "--dictionary"},
        {calib + " " + first + TARGET + " --plane=1,2,3", "--plane"},
        {calib + " " + first + TARGET + " --plane=0,0,x,600", "--plane"},
        {calib + " " + first + TARGET + " --plane=0,0,0,600", "--plane"},
        {calib + " " + first + TARGET + " --plane=0,0,1,-600", "no point"},
        {calib + " " + both + " --plane=0,0,1,600", "--plane"},
        {calib + " " + both + " --pixel-sigma=nan", "--pixel-sigma"},
        {calib + " " + both + " --pixel-sigma=inf", "--pixel-sigma"},
        {calib + " " + both + " --marker=20", "--marker and --dictionary are for"},
        {calib + " --points=" + (folder / "empty.yml") + TARGET, "leave --size and --square, or --target, out"},
        {calib + " " + pages + " " + second + TARGET, "has 2 pages"},
    };
    const size_t files = folder.count();
    for (const Case& c : cases)
    {
        const ToolResult result = runTool("refract_measure " + c.arguments + out);
        CAPTURE(c.arguments, result.out, result.err);
        CHECK(result.code == 1);
        CHECK(result.err.find("refract_measure: ") != std::string::npos);
        CHECK(result.err.find(c.expected) != std::string::npos);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        CHECK(folder.count() == files);
    }
    const ToolResult noFolder = runTool("refract_measure " + calib + " " + both + " --out=" + (folder / "no/points.csv"));
    CHECK(noFolder.code == 1);
    CHECK(noFolder.err.find("does not exist") != std::string::npos);
}
