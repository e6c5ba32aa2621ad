// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* A laser line over steps of all heights, some too small to part the line: each point that is told is true within what it says of itself,
next to the steps, too. The sheet and the camera are exact here. */
#include "laser/scan_line.hpp"
#include "calibrate/parameter_columns.hpp"
#include "laser_behind_pane.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double FAR = 470.;                // z of the wall behind the bars

//! Its true line is dense.
LightSource wideLaser()
{
    LightSource result = laser::laserBehindPane();
    result.emitter.camera->setImageSize(Size(400, 4800));
    result.emitter.camera->setLensParameters(Mat(std::vector<double>{4000, 4000, 200, 2400}));
    result.width = 12.;
    return result;
}

//! Bars before a wall, each by another step, from a tenth of a millimetre on.
TexturedScene bars(scenes::Random& random)
{
    TexturedScene scene = laser::wall(FAR);
    for (double x = -110; x < 110; x += random.uniform(25, 45))
    {
        const double z = FAR - std::pow(10., random.uniform(-1., 1.8));
        scene.surfaces.push_back(laser::bar(Vec3d(x, 0, z), Size2d(random.uniform(7, 12), 150)));
    }
    return scene;
}

Sheet exactSheet(const LightSource& source, const Calibration& calibration)
{
    Sheet sheet;
    sheet.emitter = source.emitter;
    const Vec3d n(source.emitter.R(0, 0), source.emitter.R(0, 1), source.emitter.R(0, 2));
    sheet.plane = Vec4d(n[0], n[1], n[2], n.dot(source.emitter.position));      // near it
    const int state = 6 + columnsOf(*source.emitter.camera).end;
    sheet.covariance = Mat::zeros(state, state, CV_64F);
    sheet.byParameters = Mat::zeros(state, columnsOf(*calibration.cameras[0].camera).end, CV_64F);
    sheet.colour = LASER_GREEN;
    return sheet;
}

//! By how many of its own deviations a point is off the true line in its column; infinite where there is none.
double offBy(const RidgePoint& ridge, const Point3d& X, const Vec3d& sigma, const TrueLine& line)
{
    const double COLUMN = 1.;
    double least = INFINITY;
    for (size_t i = 0; i < line.pixels.size(); i++)
        if (std::abs(line.pixels[i].x - ridge.pixel.x) < COLUMN)
            least = std::min(least, std::abs(X.z - line.points[i][2])/sigma[2]);
    return least;
}

struct Tally
{
    int points = 0, within = 0, far = 0, leftOut = 0;
    double worst = 0.;
};

Tally tallyOf(int trials, unsigned salt)
{
    const Calibration calibration = laser::camera();
    const LightSource source = wideLaser();
    const Viewpoint view = {calibration.cameras[0].camera};
    Tally tally;
    for (int trial = 0; trial < trials; trial++)
    {
        scenes::Random random(salt + trial);
        const TexturedScene scene = bars(random);
        Illumination light;
        light.sources = {source};
        light.seed = (uint64_t)random.uniform(1, 1e9);
        const Mat signal = laserSignal(renderScene(scene, view, laser::exposure(), light.seed + 7, &light), LASER_GREEN);
        const TrueLine line = trueLine(source, true, scene, view);
        Sheet sheet = exactSheet(source, calibration);
        sheet.scale = scaleOfLine(signal, line.pixels);
        const ScanLine found = findScanLine(signal, calibration, sheet, Vec2d(0, 1e9));
        const Measurement m = measureOnSheet(calibration, sheet, found.points);
        tally.leftOut += found.mixed;
        for (size_t i = 0; i < found.points.size(); i++)
        {
            if (m.status[i] != REFRACT_OK)
                continue;
            const double off = offBy(found.points[i], m.points[i], m.sigma[i], line);
            tally.points++;
            tally.within += off <= 1.96;
            tally.far += off > 5.;
            tally.worst = std::max(tally.worst, off);
        }
    }
    std::cout << "seed " << scenes::seed() << '\n'
              << "[numbers] laser line over steps: " << 100.*tally.within/tally.points << " % of " << tally.points
              << " points within 1.96 sz, " << tally.far << " farther than 5 sz off, the worst "
              << tally.worst << "; " << tally.leftOut << " left out\n";
    return tally;
}

} // namespace

TEST_CASE("Points of a laser line next to steps are true within what they say, or left out", "[laser][mixed]")
{
    const Tally t = tallyOf(3, 2960);
    CHECK(t.within >= 0.93*t.points);           // 95 %, neighbours share their noise
    CHECK(t.far <= 0.002*t.points);
    CHECK(t.points > 1.5*t.leftOut);            // every second point is near a step
}

TEST_CASE("Points of a laser line next to steps, many scenes", "[.][monte-carlo][mixed_many]")
{
    const Tally t = tallyOf(scenes::trials(40), 7000);
    CHECK(t.within >= 0.94*t.points);
    CHECK(t.far <= 0.001*t.points);
}
