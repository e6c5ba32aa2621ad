// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where a ball's centre is seen: not in the middle of its image.
#include "match/wand_matches.hpp"
#include "scenes.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! The ellipse through pixels whose rays touch a ball, found by bisection along spokes.
DotImage outlineOf(const Ptr<RefractiveCamera>& camera, const Vec3d& center, double radius, const Point2d& middle)
{
    const int SPOKES = 72;
    std::vector<Point2f> rim;
    for (int i = 0; i < SPOKES; i++)
    {
        double inside = 0, outside = 400;
        for (int k = 0; k < 50; k++)
        {
            const double at = 0.5*(inside + outside);
            std::vector<Point3d> origin, direction;
            refractiveUnprojectPoints(std::vector<Point2d>{middle + at*Point2d(std::cos(2*CV_PI*i/SPOKES), std::sin(2*CV_PI*i/SPOKES))},
                                      origin, direction, camera);
            const double miss = norm((center - Vec3d(origin[0])).cross(Vec3d(direction[0])));
            (miss < radius ? inside : outside) = at;
        }
        rim.emplace_back((float)(inside*std::cos(2*CV_PI*i/SPOKES)), (float)(inside*std::sin(2*CV_PI*i/SPOKES)));
    }
    const RotatedRect box = fitEllipseDirect(rim);
    const double angle = box.angle*CV_PI/180;
    const Matx22d turn(std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle));
    return {middle + Point2d(box.center), Matx22d(2/box.size.width, 0, 0, 2/box.size.height)*turn};
}

} // namespace

TEST_CASE("The centre of a ball is found where it is seen, behind any window and far off the axis", "[match][balls]")
{
    scenes::Random random(4550);
    const Matx33d K(1400, 0, 640, 0, 1400, 512, 0, 0, 1);
    const std::vector<GlassWindow> windows = {GlassWindow(), GlassWindow(Vec3d(0.1, -0.05, 1), 10, 1.49, 60, 1.333),
                                              GlassWindow::dome(Vec3d(2, 1, 3), 50, 5, 1.49, 1.333)};
    double worst = 0, worstMiddle = 0, worstRadius = 0;
    for (int trial = 0; trial < 60; trial++)
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, std::vector<double>{-0.1, 0.05, 0, 0}, windows[trial % 3]);
        const Vec3d center(random.uniform(-160, 160), random.uniform(-130, 130), random.uniform(450, 800));
        const double radius = random.uniform(3, 15);
        std::vector<Point2d> pixel;
        refractiveProjectPoints(std::vector<Point3d>{Point3d(center)}, Vec3d(), Vec3d(), camera, pixel);
        const DotImage outline = outlineOf(camera, center, radius, pixel[0]);
        const BallCenter found = centerOfBall(camera, outline, Point3d(center*random.uniform(0.95, 1.05)));
        CAPTURE(scenes::seed(), trial, center, radius);
        worst = std::max(worst, norm(found.pixel - pixel[0]));
        worstMiddle = std::max(worstMiddle, norm(outline.centre - pixel[0]));
        worstRadius = std::max(worstRadius, std::abs(found.radius/radius - 1));
    }
    std::cout << "[numbers] centres of balls, seed " << scenes::seed() << ": " << worst << " px off at most, the middles of their images "
              << worstMiddle << "; radii " << worstRadius << std::endl;
    CHECK(worst < 0.005);
    CHECK(worstMiddle > 0.1);
    CHECK(worstRadius < 0.1);
    CHECK(std::isnan(centerOfBall(RefractiveCamera::create(K, noArray()), {Point2d(NAN, 3), Matx22d::eye()}, Point3d(0, 0, 1)).radius));
}
