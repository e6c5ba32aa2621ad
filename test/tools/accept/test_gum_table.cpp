// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The budget of one quantity: its rows add up, and to what the quantity really errs by.
#include "acceptance_scene.hpp"
#include "accept/test_points.hpp"

using namespace acceptance_scene;

namespace {

const std::vector<Point3d> POINTS = {{-90, -60, 560}, {90, 50, 640}, {-60, 60, 600}, {70, -50, 600}, {0, 0, 600}};

//! The board's plane: z = 600 + x/5.
std::vector<Point3d> pointsOnPlane()
{
    std::vector<Point3d> points;
    for (const Point3d& p : board(4, 3, 40.))
        points.emplace_back(p.x, p.y, 600 + p.x/5);
    return points;
}

double squares(const GumTable& table)
{
    double sum = 0., shares = 0.;
    for (const GumRow& row : table.rows)
    {
        sum += row.contribution*row.contribution;
        shares += row.share;
        if (row.std > 0)
            CHECK(row.std*row.sensitivity == Approx(row.contribution));
    }
    CHECK(shares == Approx(1.).epsilon(1e-9));
    return sum;
}

} // namespace

TEST_CASE("Rows of the budget of a point, a length and a plane add up in squares, and name what was given", "[gum]")
{
    const Calibration calibration = calibrated();
    REQUIRE(calibration.provenance.sources.size() == 3);        // two panes, the square
    scenes::Random random(1231);
    const RigPixels pixels = pixelsOf(modelOf(calibration), pointsOnPlane(), SIGMA, random);
    const TestPoints points = testPoints(calibration, pixels, SIGMA);
    const PointErrors errors(calibration, points, SIGMA, std::nullopt);
    CHECK_FALSE((errors.stated().more || errors.stated().lessThanPixels || errors.stated().lessThanCalibration));
    for (const LinearQuantity& quantity : {coordinateOf(points, 0, 2), distanceOf(points, 0, 11), planeDistanceOf(points, "a")})
    {
        CAPTURE(quantity.name);
        REQUIRE_FALSE(quantity.weights.empty());
        const GumTable table = errors.table(quantity, {{"certified", "", 0.01, 1.}});
        CHECK(squares(table)/(table.u*table.u) == Approx(1.).epsilon(0.01));
        CHECK(table.rows.back().contribution == Approx(0.01));
        CHECK(table.rows.back().sensitivity == Approx(1.));
        CHECK(table.U == Approx(table.k*table.u));
        CHECK(table.k >= 2.);
        CHECK(table.k < 2.05);
    }
    // What sx, sy, sz of a point say.
    for (int axis = 0; axis < 3; axis++)
        CHECK(errors.table(coordinateOf(points, 3, axis)).u == Approx(points.points[3].sigma[axis]).epsilon(1e-4));
}

TEST_CASE("The square of the board has its whole effect on a length, as one scale has", "[gum]")
{
    // So wrong that images tell nothing of it: each length is in proportion.
    const Calibration calibration = calibrated(1e-3);
    scenes::Random random(1232);
    const TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), POINTS, 0., random), SIGMA);
    const PointErrors errors(calibration, points, SIGMA, std::nullopt);
    const LinearQuantity length = distanceOf(points, 0, 1);
    for (const GumRow& row : errors.table(length).rows)
        if (row.source == "square of the board")
        {
            CHECK(row.contribution == Approx(1e-3*length.value).epsilon(0.35));     // the distance of the window does not scale
            CHECK(row.std == Approx(0.039));
        }
}

TEST_CASE("Two points of one calibration err together: a length is known better than its ends", "[gum]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(1233);
    const std::vector<Point3d> near = {{0, 0, 600}, {0, 0, 610}};
    const TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), near, 0., random), SIGMA);
    const PointErrors errors(calibration, points, SIGMA, std::nullopt);
    double ofCalibration = 0., alone = 0.;
    for (const GumRow& row : errors.table(distanceOf(points, 0, 1)).rows)
        if (row.source != "noise of the points' own pixels")
            ofCalibration += row.contribution*row.contribution;
    for (size_t i = 0; i < 2; i++)
        for (const GumRow& row : errors.table(coordinateOf(points, i, 2)).rows)
            if (row.source != "noise of the points' own pixels")
                alone += row.contribution*row.contribution;
    CHECK(ofCalibration < 0.1*alone);
}

TEST_CASE("Points that are only places have the same error, if their sx, sy, sz are the same", "[gum]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(1234);
    TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), POINTS, 0., random), SIGMA);
    const GumTable withPixels = PointErrors(calibration, points, SIGMA, std::nullopt).table(distanceOf(points, 0, 1));
    points.havePixels = false;
    // Told by sx, sy, sz even if the noise of a pixel is another.
    const GumTable places = PointErrors(calibration, points, 5.*SIGMA, std::nullopt).table(distanceOf(points, 0, 1));
    CHECK(places.u == Approx(withPixels.u).epsilon(0.02));
    // Of noise alone: the calibration's part is added.
    for (TestPoint& point : points.points)
        point.sigma = Vec3d::all(1e-3);
    const PointErrors added(calibration, points, SIGMA, std::nullopt);
    CHECK(added.stated().lessThanCalibration);
    CHECK(added.table(distanceOf(points, 0, 1)).u > 1e-3);
}

TEST_CASE("Beside pixels, sx, sy, sz that say less than these do not make a test better", "[gum]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(1236);
    TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), POINTS, 0., random), SIGMA);
    const double u = PointErrors(calibration, points, SIGMA, std::nullopt).table(distanceOf(points, 0, 1)).u;
    for (TestPoint& point : points.points)
        point.sigma = Vec3d::all(1e-9);
    const PointErrors less(calibration, points, SIGMA, std::nullopt);
    CHECK(less.stated().lessThanPixels);
    CHECK(less.table(distanceOf(points, 0, 1)).u == Approx(u));
    for (TestPoint& point : points.points)
        point.sigma = Vec3d::all(1.);
    const PointErrors more(calibration, points, SIGMA, std::nullopt);
    CHECK(more.stated().more);
    CHECK(more.table(distanceOf(points, 0, 1)).u > 10.*u);
}

TEST_CASE("The noise of a pixel is what the points' own rays show, whatever is stated", "[gum]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(1237);
    std::vector<Point3d> many;
    for (int i = 0; i < 60; i++)
        many.emplace_back(random.uniform(-90, 90), random.uniform(-60, 60), random.uniform(550, 650));
    const TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), many, SIGMA, random), SIGMA);
    CHECK_THROWS_WITH(pixelNoiseOf(calibration, points, 1e-4), Catch::Contains("--pixel-sigma=0.0001") && Catch::Contains("noise of"));
    const PixelNoise usual = pixelNoiseOf(calibration, points, 0.);
    CHECK(usual.sigma == calibration.sigma);
    CHECK(usual.remarks.empty());
    // Sharper images than the calibration's may say so; noisier ones need not be told.
    const TestPoints sharp = testPoints(calibration, pixelsOf(modelOf(calibration), many, 0.2*SIGMA, random), SIGMA);
    const PixelNoise stated = pixelNoiseOf(calibration, sharp, 0.03);
    CHECK(stated.sigma == 0.03);
    CHECK(stated.remarks.size() == 1);
    const TestPoints noisy = testPoints(calibration, pixelsOf(modelOf(calibration), many, 3*SIGMA, random), SIGMA);
    const PixelNoise seen = pixelNoiseOf(calibration, noisy, 0.);
    CHECK(seen.sigma == Approx(3*SIGMA).epsilon(0.3));
    CHECK(seen.remarks.size() == 1);
    TestPoints places = points;
    places.havePixels = false;
    CHECK_THAT(pixelNoiseOf(calibration, places, 0.01).remarks.at(0), Catch::Contains("is not used"));
}

TEST_CASE("Points of another calibration are refused", "[gum]")
{
    const Calibration calibration = calibrated();
    scenes::Random random(1235);
    TestPoints points = testPoints(calibration, pixelsOf(modelOf(calibration), POINTS, SIGMA, random), SIGMA);
    points.points[1].X.z += 0.1;
    CHECK_THROWS_WITH(PointErrors(calibration, points, SIGMA, std::nullopt), Catch::Contains("is not of this calibration"));
}
