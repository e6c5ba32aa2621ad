// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Lines and fringes of emitters behind windows, in images: where the truth says, and where the module projects the points.
#include "laser/ridges.hpp"
#include "scenes.hpp"
#include "simulate/light_source.hpp"
#include "simulate/render.hpp"
#include "target/target.hpp"

#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

Viewpoint camera()
{
    const GlassWindow pane(Vec3d(0.1, -0.15, 1.), 10., 1.49, 40., 1.333);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(400, 0, 160, 0, 400, 120, 0, 0, 1), noArray(), pane);
    camera->setImageSize(Size(320, 240));
    return {camera, Matx33d::eye(), Vec3d()};
}

//! Below the camera, behind a pane that its sheets do not cross straight; sheets of one u run along the image's x.
LightSource source()
{
    LightSource result;
    const Vec3d position(15, 210, 10), z = normalize(Vec3d(0, 0, 450) - position), along(1, 0.02, 0);
    const Vec3d y = normalize(along - along.dot(z)*z);
    const Vec3d x = y.cross(z);
    const GlassWindow pane(Vec3d(0.3, 0.1, 1.), 8., 1.52, 30., 1.333);
    result.emitter.camera = RefractiveCamera::create(Matx33d(1000, 0, 200, 0, 1000, 600, 0, 0, 1), noArray(), pane);
    result.emitter.camera->setImageSize(Size(400, 1200));
    result.emitter.R = Matx33d(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
    result.emitter.position = position;
    result.emitter.line = 200.;
    result.name = "laser";
    result.color = Vec3d(0, 1, 0);
    result.brightness = 100.;
    result.width = 8.;
    return result;
}

Exposure clean()
{
    Exposure exposure;
    exposure.noise = 0.;
    exposure.light = 100.;
    return exposure;
}

//! Distances of the found line's points from the true line, px; away from its ends, where the profile is not whole.
std::vector<double> errorsOf(const Mat& image, const TrueLine& line)
{
    const double FAR = 3.;
    const size_t END = 20;
    std::vector<double> errors;
    for (const RidgePoint& ridge : findRidges(laserSignal(image, LASER_GREEN), 1.7, 0.4))
        for (size_t i = END; i + END < line.pixels.size(); i++)
        {
            const Point2d &a = line.pixels[i - 1], &b = line.pixels[i];
            if (ridge.pixel.x < a.x || ridge.pixel.x >= b.x || norm(line.pixels[i + END] - line.pixels[i - END]) > 2.*END)
                continue;
            const double off = ridge.pixel.y - (a.y + (b.y - a.y)*(ridge.pixel.x - a.x)/(b.x - a.x));
            if (std::abs(off) < FAR)
                errors.push_back(off);
        }
    return errors;
}

double rms(const std::vector<double>& values)
{
    double sum = 0.;
    for (double value : values)
        sum += value*value/values.size();
    return std::sqrt(sum);
}

//! A wall, and a plate before it that throws a shadow.
TexturedScene steps()
{
    TexturedScene scene;
    scene.texture.size = 60.;
    scene.texture.contrast = 0.;
    scene.surfaces = {std::make_shared<Plane>(Vec3d(0, 0, 500), Vec3d(0, 0, -1), Vec3d(1, 1, 1)),
                      std::make_shared<Plane>(Vec3d(0, 0, 430), Vec3d(0, 0, -1), Vec3d(1, 0, 0), Size2d(40, 100), Vec3d(1, 1, 1))};
    return scene;
}

} // namespace

TEST_CASE("A sheet of light behind its own window is where the truth says", "[simulate][emitters]")
{
    TargetOptions options;
    options.size = "8x7";
    options.square = 20.;
    const Target board(options);
    const BoardPose pose = {Vec3d(0.2, -0.1, 0.1), Vec3d(-70, -60, 430)};
    const LightSource laser = source();
    const TrueLine line = trueLine(laser, true, board, pose, camera());
    REQUIRE(line.points.size() > 100);

    // The points are on the sheet, by the module's projection, and on the board; the pixels see them.
    std::vector<Point2d> sent, seen;
    const Viewpoint emitter = laser.view(true);
    const std::vector<Point3d> points(line.points.begin(), line.points.end());
    refractiveProjectPoints(points, emitter.R, emitter.T, emitter.camera, sent);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera().camera, seen);
    const Matx33d R = rotationMatrix(pose.rvec);
    for (size_t i = 0; i < points.size(); i++)
    {
        CHECK(std::abs(sent[i].x - laser.emitter.line) < 1e-9);
        CHECK(std::abs((R.t()*(line.points[i] - pose.tvec))[2]) < 1e-9);
        CHECK(norm(seen[i] - line.pixels[i]) < 1e-9);
    }

    // On the board it is no straight line.
    const Vec3d chord = line.points.back() - line.points.front(), middle = line.points[line.points.size()/2] - line.points.front();
    CHECK(norm(middle.cross(chord))/norm(chord) > 0.3);

    Illumination light;
    light.sources = {laser};
    const Mat image = render(board, pose, camera(), clean(), 1, &light);
    REQUIRE(image.type() == CV_8UC3);
    const std::vector<double> errors = errorsOf(image, line);
    CHECK(errors.size() > 100);
    // Where squares change under the line, its profile is not symmetric: half of the points are off the edges.
    std::vector<double> sizes;
    for (double e : errors)
        sizes.push_back(std::abs(e));
    std::nth_element(sizes.begin(), sizes.begin() + sizes.size()/2, sizes.end());
    std::cout << "[numbers] rendered sheet of light on a board: median " << sizes[sizes.size()/2] << " px from the truth\n";
    CHECK(sizes[sizes.size()/2] < 0.03);

    // Without windows, elsewhere.
    CHECK(norm(trueLine(laser, false, board, pose, camera()).points[0] - line.points[0]) > 3.);
}

TEST_CASE("A sheet of light on surfaces, and its shadow", "[simulate][emitters]")
{
    const TexturedScene scene = steps();
    const LightSource laser = source();
    const TrueLine line = trueLine(laser, true, scene, camera());
    int wall = 0, plate = 0;
    for (const Vec3d& X : line.points)
        (std::abs(X[2] - 500) < 1e-6 ? wall : plate) += 1;
    REQUIRE(wall > 100);
    REQUIRE(plate > 50);
    Illumination light;
    light.sources = {laser};
    const Mat image = renderScene(scene, camera(), clean(), 1, &light);
    const std::vector<double> errors = errorsOf(image, line);
    std::cout << "[numbers] rendered sheet of light on surfaces: " << rms(errors) << " px RMS from the truth\n";
    CHECK(errors.size() > 200);
    CHECK(rms(errors) < 0.03);

    // The wall behind the plate is dark, where it is lit without the plate.
    TexturedScene wallAlone = scene;
    wallAlone.surfaces.pop_back();
    const TrueLine whole = trueLine(laser, true, wallAlone, camera());
    const Mat signal = laserSignal(image, LASER_GREEN);
    int dark = 0;
    for (size_t i = 0; i < whole.pixels.size(); i++)
        dark += signal.at<float>(Point(cvRound(whole.pixels[i].x), cvRound(whole.pixels[i].y))) < 3.f;
    CHECK(dark > 40);
}

TEST_CASE("Fringes have the phase of the emitter's u, in each step", "[simulate][emitters]")
{
    const TexturedScene scene = steps();
    LightSource projector = source();
    projector.periods = {400., 50.};
    projector.steps = 5;
    projector.phase = 0.3;
    projector.color = Vec3d(1, 1, 1);
    Illumination light;
    light.sources = {projector};
    std::vector<Mat> images;
    for (light.picture = 0; light.picture < projector.pictures(); light.picture++)
        images.push_back(renderScene(scene, camera(), clean(), 1, &light));
    REQUIRE(images.size() == 10);
    const Mat depth = depthOfScene(scene, camera());
    const Viewpoint emitter = projector.view(true);
    double squares[2] = {0., 0.};
    int count = 0;
    for (int y = 5; y < 235; y += 3)
        for (int x = 5; x < 315; x += 3)
        {
            double least, most;
            minMaxLoc(depth(Rect(x - 4, y - 4, 9, 9)), &least, &most);
            if (!(most - least < 5.))
                continue;
            std::vector<Point3d> X;
            refractivePointsOnPlane(std::vector<Point2d>(1, Point2d(x, y)), X, camera().camera, Vec4d(0, 0, 1, depth.at<float>(y, x)));
            std::vector<Point2d> u;
            refractiveProjectPoints(X, emitter.R, emitter.T, emitter.camera, u);
            double phase[2], modulation[2];
            for (int p = 0; p < 2; p++)
            {
                double s = 0., c = 0.;
                for (int k = 0; k < 5; k++)
                {
                    const double grey = images[5*p + k].at<Vec3b>(y, x)[1];
                    s += grey*std::sin(2*CV_PI*k/5);
                    c += grey*std::cos(2*CV_PI*k/5);
                }
                phase[p] = std::atan2(s, c);
                modulation[p] = std::hypot(s, c)/2.5;
            }
            if (modulation[1] < 0.9*50.)        // in shadow, or beyond the emitter's image
                continue;
            for (int p = 0; p < 2; p++)
            {
                const double expected = 2*CV_PI*u[0].x/projector.periods[p] + projector.phase;
                squares[p] += std::pow(std::remainder(phase[p] - expected, 2*CV_PI)*projector.periods[p]/(2*CV_PI), 2);
            }
            count++;
        }
    REQUIRE(count > 2000);
    std::cout << "[numbers] rendered fringes: u off by " << std::sqrt(squares[0]/count) << " and " << std::sqrt(squares[1]/count)
              << " px RMS, of periods of 400 and 50 px, 8 bits\n";
    CHECK(std::sqrt(squares[0]/count) < 0.5);
    CHECK(std::sqrt(squares[1]/count) < 0.1);
}

TEST_CASE("Speckle has the contrast and the mean that were asked for", "[simulate][emitters]")
{
    LightSource lamp = source();
    lamp.width = 1e5;           // an even light
    lamp.speckleSize = 1.5;
    Illumination light;
    const Mat points(960, 1280, CV_64FC3, Scalar(0, 0, 450)), white(960, 1280, CV_32FC3, Scalar::all(1));
    for (double contrast : {0., 0.2, 0.6})
    {
        lamp.speckle = contrast;
        light.sources = {lamp};
        Mat levels = Mat::zeros(points.size(), CV_32FC3), green;
        addLight(light, points, white, nullptr, levels);
        extractChannel(levels, green, 1);
        Scalar mean, deviation;
        meanStdDev(green, mean, deviation);
        CHECK(mean[0] == Approx(100.).epsilon(0.02));
        CHECK(deviation[0]/mean[0] == Approx(contrast).epsilon(0.05).margin(1e-6));
        CHECK(norm(levels.reshape(1).col(0)) == 0.);        // blue
    }
}
