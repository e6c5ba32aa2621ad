// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

/* A laser line over steps of all heights, some too small to part the line: each point that is told is true within what it says of itself,
next to the steps, too. The sheet and the camera are exact here. */
#include "laser/scan_line.hpp"
#include "calibrate/parameter_columns.hpp"
#include "laser_scene.hpp"
#include "simulate/true_line.hpp"
#include <catch2/catch.hpp>
#include <algorithm>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double FAR = 470.;                // z of the wall behind the bars

LightSource laserBehindPane()
{
    LightSource result;
    const Vec3d position(15, 210, 10), z = normalize(Vec3d(0, 0, 450) - position), along(1, 0.02, 0);
    const Vec3d y = normalize(along - along.dot(z)*z), x = y.cross(z);
    result.emitter.camera = RefractiveCamera::create(Matx33d(1000, 0, 200, 0, 1000, 600, 0, 0, 1), noArray(),
                                                     GlassWindow(Vec3d(0.3, 0.1, 1.), 8., 1.52, 30., 1.333));
    result.emitter.camera->setImageSize(Size(400, 4800));
    result.emitter.camera->setLensParameters(Mat(std::vector<double>{4000, 4000, 200, 2400}));      // dense: the true line's points
    result.emitter.R = Matx33d(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    result.emitter.position = position;
    result.emitter.line = 200.;
    result.color = Vec3d(0, 1, 0);
    result.brightness = 90.;
    result.width = 12.;
    result.speckle = 0.1;
    return result;
}

//! Bars before a wall, each by another step, from a tenth of a millimetre on.
TexturedScene bars(scenes::Random& random)
{
    TexturedScene scene;
    scene.texture.size = 30.;
    scene.texture.contrast = 0.2;
    const Vec3d front(0, 0, -1), right(1, 0, 0), white(1, 1, 1);
    scene.surfaces = {std::make_shared<Plane>(Vec3d(0, 0, FAR), front, white)};
    for (double x = -110; x < 110; x += random.uniform(25, 45))
        scene.surfaces.push_back(std::make_shared<Plane>(Vec3d(x, 0, FAR - std::pow(10., random.uniform(-1., 1.8))), front, right,
                                                         Size2d(random.uniform(7, 12), 150), white));
    return scene;
}

Exposure exposure()
{
    Exposure e;
    e.dark = 25.;
    e.light = 130.;
    e.background = 60.;
    e.noise = laser::NOISE;
    return e;
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
    const LightSource source = laserBehindPane();
    const Viewpoint view = {calibration.cameras[0].camera};
    Tally tally;
    for (int trial = 0; trial < trials; trial++)
    {
        scenes::Random random(salt + trial);
        const TexturedScene scene = bars(random);
        Illumination light;
        light.sources = {source};
        light.seed = (uint64_t)random.uniform(1, 1e9);
        const Mat signal = laserSignal(renderScene(scene, view, exposure(), light.seed + 7, &light), LASER_GREEN);
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
