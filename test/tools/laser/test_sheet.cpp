// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A sheet of light from boards with the line on them: its error against its covariance, and what does not determine one.
#include "calibrate/conditions.hpp"
#include "laser/scan_line.hpp"
#include "laser/sheet_fit.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "laser_scene.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>
#include <iostream>

using namespace cv;
using namespace tools;

namespace {

const double CORNER = 0.05;             // px

std::vector<Point2d> cornersOf(const Calibration& calibration, const laser::Pose& pose, scenes::Random& random)
{
    std::vector<Point2d> pixels;
    refract::refractiveProjectPoints(laser::board().objectPoints(), pose.rvec, pose.tvec, calibration.cameras[0].camera, pixels);
    for (Point2d& p : pixels)
        p += Point2d(random.normal(CORNER), random.normal(CORNER));
    return pixels;
}

//! @param as what the lines are looked for with, where it is not what made the images
std::vector<BoardImage> boards(const Calibration& calibration, int count, const Vec4d& sheet, const laser::Light& light, unsigned salt,
                               const Calibration* as = nullptr)
{
    scenes::Random random(salt);
    std::vector<BoardImage> images;
    for (int i = 0; i < count; i++)
    {
        const laser::Pose pose = laser::randomPose(random);
        const std::vector<Point2d> corners = cornersOf(calibration, pose, random);
        const Mat signal = laserSignal(laser::render(calibration, pose, true, sheet, light, random), LASER_GREEN);
        images.push_back(findLinesOnBoard(std::to_string(i), as ? *as : calibration, laser::board(), corners, signal, light.width));
    }
    return images;
}

//! In the basis of the plane's own tangents, so that the covariance has full rank.
double chiSquare(const Sheet& sheet, const Vec4d& truth)
{
    Mat difference(4, 1, CV_64F), inverse;
    for (int i = 0; i < 4; i++)
        difference.at<double>(i) = sheet.plane[i] - truth[i];
    invert(sheet.covariance, inverse, DECOMP_SVD);
    return Mat(difference.t()*inverse*difference).at<double>(0);
}

} // namespace

TEST_CASE("A sheet is where it was, within its covariance", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    std::cout << "seed " << scenes::seed() << '\n';
    double sum = 0., worst = 0., ratio = 0.;
    const int trials = 6;
    for (int trial = 0; trial < trials; trial++)
    {
        const SheetFit fit = fitSheet(boards(calibration, 10, laser::sheet(), laser::Light(), 2910 + trial), calibration, CORNER, 1.7);
        CHECK(fit.lines.size() == 10);
        sum += chiSquare(fit.sheet, laser::sheet());
        worst = std::max(worst, fit.heldOutRms());
        ratio += std::pow(fit.heldOutRatio(), 2)/trials;
    }
    std::cout << "[numbers] sheet of light, 10 boards: error over stated " << std::sqrt(sum/(3*trials)) << " (" << 3*trials
              << " degrees of freedom), held out " << worst << " mm at most, " << std::sqrt(ratio) << " x stated\n";
    CHECK(sum > 4.9);                   // chi^2 of 18 degrees of freedom, 0.1 % on either side
    CHECK(sum < 42.3);
    CHECK(std::sqrt(ratio) > 0.8);
    CHECK(std::sqrt(ratio) < 1.25);
}

TEST_CASE("A sheet's derivative by the calibration is that of a fit with another calibration", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    Calibration other = calibration;
    const ParameterColumns at = columnsOf(*calibration.cameras[0].camera);
    refract::GlassWindow window = calibration.cameras[0].camera->window();
    const double tilt = 2e-3, thicker = 0.1;
    const Vec3d before = window.normal;
    window.normal = normalize(window.normal + Vec3d(0, tilt, 0));
    window.thickness[0] += thicker;
    other.cameras[0].camera = copyWithWindow(calibration.cameras[0].camera, window);
    laser::Light light;
    light.noise = 0.;
    const SheetFit one = fitSheet(boards(calibration, 8, laser::sheet(), light, 2930), calibration, CORNER, 1.7);
    const SheetFit two = fitSheet(boards(calibration, 8, laser::sheet(), light, 2930, &other), other, CORNER, 1.7);
    REQUIRE(one.lines.size() == two.lines.size());
    Mat dp = Mat::zeros(at.end, 1, CV_64F);
    for (int i = 0; i < 3; i++)
        dp.at<double>(at.normal + i) = window.normal[i] - before[i];
    dp.at<double>(at.thickness) = thicker;
    const Mat expected = one.sheet.byParameters*dp;
    for (int i = 0; i < 4; i++)
    {
        CAPTURE(i, expected.at<double>(i));
        CHECK(two.sheet.plane[i] - one.sheet.plane[i] == Approx(expected.at<double>(i)).epsilon(0.05).margin(i < 3 ? 2e-5 : 0.01));
    }
}

TEST_CASE("A board whose line contradicts the others' is named and left out", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    std::vector<BoardImage> images = boards(calibration, 8, laser::sheet(), laser::Light(), 2913);
    // Next to the sheet, within the pixels in which it is looked for.
    const Vec4d beside = laser::sheet() + Vec4d(0, 0, 0, 0.8);
    images.push_back(boards(calibration, 1, beside, laser::Light(), 2914)[0]);
    const SheetFit fit = fitSheet(images, calibration, CORNER, 1.7);
    CAPTURE(fit.poseNoise, fit.lines.size(), fit.without.size());
    CHECK(fit.disagreeing == std::vector<int>{8});
    CHECK(fit.lines.size() == 8);
    CHECK(fit.poseNoise < 2.);
    CHECK(chiSquare(fit.sheet, laser::sheet()) < 16.3);         // 0.1 % of 3 degrees of freedom
}

TEST_CASE("Lines that do not determine a sheet are refused", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    const laser::Light light;
    CHECK_THROWS_WITH(fitSheet({}, calibration, CORNER, 1.7), Catch::Contains("no two images agree"));
    const std::vector<BoardImage> one = boards(calibration, 1, laser::sheet(), light, 2940);
    CHECK_THROWS_WITH(fitSheet(one, calibration, CORNER, 1.7), Catch::Contains("one image of a board"));
    // The same board again and again: all lines are one.
    const std::vector<BoardImage> same(5, one[0]);
    CHECK_THROWS_WITH(fitSheet(same, calibration, CORNER, 1.7), Catch::Contains("do not determine"));
    laser::Light none;
    none.amplitude = 0.;
    CHECK_THROWS_AS(fitSheet(boards(calibration, 5, laser::sheet(), none, 2941), calibration, CORNER, 1.7), Failure);
}

TEST_CASE("A weaker reflection beside the line does not change the sheet", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    laser::Light light;
    light.reflection = 0.3;
    const SheetFit fit = fitSheet(boards(calibration, 8, laser::sheet(), light, 2950), calibration, CORNER, 1.7);
    CHECK(fit.lines.size() == 8);
    CHECK(chiSquare(fit.sheet, laser::sheet()) < 16.3);         // 0.1 % of 3 degrees of freedom
}

TEST_CASE("A bright edge of the board, where its pattern has none, is not the line", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    const auto withEdge = [&](const laser::Light& light)
    {
        scenes::Random random(2955);
        std::vector<BoardImage> images;
        for (int i = 0; i < 8; i++)
        {
            const laser::Pose pose = laser::randomPose(random);
            const std::vector<Point2d> corners = cornersOf(calibration, pose, random);
            Mat signal = laserSignal(laser::render(calibration, pose, true, laser::sheet(), light, random), LASER_GREEN);
            // Twice as bright as the line, and as long as the board.
            std::vector<Point2d> ends;
            const std::vector<Point3d> edge = {Point3d(-1.2*laser::SQUARE, -1.3*laser::SQUARE, 0),
                                               Point3d(8.2*laser::SQUARE, -1.3*laser::SQUARE, 0)};
            refract::refractiveProjectPoints(edge, pose.rvec, pose.tvec, calibration.cameras[0].camera, ends);
            Mat strip = Mat::zeros(signal.size(), CV_8U);
            line(strip, Point(cvRound(16*ends[0].x), cvRound(16*ends[0].y)), Point(cvRound(16*ends[1].x), cvRound(16*ends[1].y)),
                 Scalar(255), 3, LINE_AA, 4);
            strip.convertTo(strip, CV_32F);
            GaussianBlur(strip, strip, Size(), 1.2);
            signal += strip;
            images.push_back(findLinesOnBoard(std::to_string(i), calibration, laser::board(), corners, signal, 1.7));
        }
        return images;
    };
    const SheetFit fit = fitSheet(withEdge(laser::Light()), calibration, CORNER, 1.7);
    CHECK(fit.lines.size() >= 7);
    CHECK(chiSquare(fit.sheet, laser::sheet()) < 16.3);         // 0.1 % of 3 degrees of freedom
    // Edges alone are no sheet.
    laser::Light none;
    none.amplitude = 0.;
    CHECK_THROWS_AS(fitSheet(withEdge(none), calibration, CORNER, 1.7), Failure);
}

TEST_CASE("No point of a line is on a dot of the board", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    for (const char* pattern : {"circles", "acircles"})
    {
        CAPTURE(pattern);
        TargetOptions options;
        options.pattern = pattern;
        options.size = "4x9";
        options.square = laser::SQUARE;
        const Target target(options);
        std::vector<Point2d> dots;
        refract::refractiveProjectPoints(target.objectPoints(), Vec3d(0.1, -0.1, 0.2), Vec3d(-60, -80, 450), calibration.cameras[0].camera,
                                         dots);
        Mat signal = Mat::zeros(laser::IMAGE, CV_32F);
        for (int y = 10; y < signal.rows; y += 20)          // lines wherever there is room for them
            line(signal, Point(0, y), Point(signal.cols, y + 3), Scalar(90), 3, LINE_AA);
        GaussianBlur(signal, signal, Size(), 1.2);
        const BoardImage image = findLinesOnBoard("", calibration, target, dots, signal, 1.7);
        CHECK(image.points.size() > 50);
        for (const BoardPoint& p : image.points)
            for (const Point3d& dot : target.objectPoints())
                REQUIRE(norm(p.onBoard - Point2d(dot.x, dot.y)) > target.dotRadius());
    }
}

TEST_CASE("Points on a sheet are true within their standard deviations", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    scenes::Random random(2960);
    SheetFit fit = fitSheet(boards(calibration, 10, laser::sheet(), laser::Light(), 2961), calibration, CORNER, 1.7);
    fit.sheet.colour = LASER_GREEN;
    double off[2], sigma[2];
    int k = 0;
    for (double reflection : {0., 0.4})
    {
        laser::Light light;
        light.reflection = reflection;
        const laser::Pose pose = {Vec3d(0.05, -0.1, 0.), Vec3d(0, 0, 440)};
        const Mat signal = laserSignal(laser::render(calibration, pose, false, laser::sheet(), light, random), LASER_GREEN);
        const ScanLine line = findScanLine(signal, calibration, fit.sheet, Vec2d(0, 1e9));
        const Measurement m = measureOnSheet(calibration, fit.sheet, line.points);
        REQUIRE(line.points.size() > 500);
        CHECK(line.noise < 0.03);
        const Vec4d plane = pose.plane();
        off[k] = sigma[k] = 0.;
        int outliers = 0;
        for (size_t i = 0; i < m.points.size(); i++)
        {
            CHECK(m.status[i] == 0);
            const double e = plane[0]*m.points[i].x + plane[1]*m.points[i].y + plane[2]*m.points[i].z - plane[3];
            outliers += std::abs(e) > 1.;
            off[k] += e*e/m.points.size();
            sigma[k] += norm(m.sigma[i], NORM_L2SQR)/m.points.size();
        }
        std::cout << "[numbers] points on a sheet of light, a reflection of " << reflection << ": " << std::sqrt(off[k])
                  << " mm off a plane, " << std::sqrt(sigma[k]) << " stated (3-D)\n";
        CHECK(outliers == 0);
        CHECK(off[k] < 4.*sigma[k]);
        k++;
    }
}

TEST_CASE("A sheet's file comes back, and belongs to its camera", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    Sheet sheet;
    sheet.plane = laser::sheet();
    sheet.covariance = Mat::eye(4, 4, CV_64F)*1e-6;
    sheet.byParameters = Mat::ones(4, columnsOf(*calibration.cameras[0].camera).end, CV_64F);
    sheet.scale = 1.7;
    sheet.colour = LASER_RED;
    sheet.depth = Vec2d(400, 500);
    sheet.unit = "mm";
    const TemporaryFolder folder;
    const std::string path = folder / "sheet.yml";
    writeSheet(path, sheet, calibration);
    const Sheet back = readSheet(path, calibration);
    CHECK(back.plane == sheet.plane);
    CHECK(back.colour == LASER_RED);
    CHECK(back.scale == 1.7);
    CHECK(norm(back.byParameters, sheet.byParameters) == 0.);
    Calibration other = calibration;
    refract::GlassWindow window = other.cameras[0].camera->window();
    window.distance += 1e-6;
    other.cameras[0].camera = copyWithWindow(other.cameras[0].camera, window);
    CHECK_THROWS_WITH(readSheet(path, other), Catch::Contains("another camera calibration"));
    CHECK_THROWS_WITH(readSheet(folder / "none.yml", calibration), Catch::Contains("cannot read") && Catch::Contains("cannot be opened"));
    const std::string empty = folder / "empty.yml";
    std::ofstream(empty).flush();
    CHECK_THROWS_WITH(readSheet(empty, calibration), Catch::Contains("is empty"));
    CHECK_THROWS_WITH(EmitterPrior(empty), Catch::Contains("is empty") && Catch::Contains("rotation_std_deg"));

    // In another medium it is another sheet; within what is known of its index it is the same.
    Medium medium;
    medium.index.value = 1.3335;
    medium.std = Std(0.001);
    CHECK(readSheet(path, inMedium(calibration, medium, "calib.yml")).plane == sheet.plane);
    medium.std = Std(0.0002);
    CHECK_THROWS_WITH(readSheet(path, inMedium(calibration, medium, "calib.yml")), Catch::Contains("index 1.33300, not 1.33350"));
}

TEST_CASE("A ray in the sheet has no point", "[laser][sheet]")
{
    const Calibration calibration = laser::camera();
    // Through the axis of the window: no ray in it leaves it.
    const Vec3d axis = calibration.cameras[0].camera->window().normal, n = normalize(axis.cross(Vec3d(0, 0, 1)));
    Sheet sheet;
    sheet.plane = Vec4d(n[0], n[1], n[2], 0.);
    sheet.covariance = Mat::zeros(4, 4, CV_64F);
    sheet.byParameters = Mat::zeros(4, columnsOf(*calibration.cameras[0].camera).end, CV_64F);
    std::vector<Point2d> pixels;
    refract::refractiveProjectPoints(std::vector<Vec3d>{axis*400. , axis*600.}, Vec3d(), Vec3d(), calibration.cameras[0].camera, pixels);
    std::vector<RidgePoint> line;
    for (const Point2d& p : pixels)
        line.push_back({p, Vec2d(0, 1), 1., 0.1});
    const Measurement m = measureOnSheet(calibration, sheet, line);
    for (size_t i = 0; i < line.size(); i++)
    {
        CHECK(m.status[i] != 0);
        CHECK(m.points[i].x != m.points[i].x);
        CHECK(m.sigma[i][0] != m.sigma[i][0]);
    }
    CHECK(measureOnSheet(calibration, sheet, {}).points.empty());
}
