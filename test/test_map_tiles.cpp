// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The map is interpolated between exact pixels: against pixels solved by themselves.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const Size SIZE(640, 480);

//! Largest difference beyond the rounding to float32, and pixels with an answer in one of the two only.
struct Deviation { double largest; int unlike; };

//! The map of a part of the new image against refractiveProjectPoints of the scene's points: of each pixel, or of those step apart.
Deviation deviation(const Ptr<RefractiveCamera>& camera, const Vec4d& plane, const Matx33d& newKOfAll, const Matx33d& R,
                    const Rect& part = Rect(Point(), SIZE), int step = 1)
{
    Mat map, none, status;
    const Matx33d newK = Matx33d(1, 0, -part.x, 0, 1, -part.y, 0, 0, 1)*newKOfAll;
    initRefractiveUndistortRectifyMap(camera, plane, R, newK, part.size(), CV_32FC2, map, none);
    std::vector<Vec3d> points;
    std::vector<Vec2d> raw;
    std::vector<Vec2f> mapped;
    const Matx33d toCamera = R.t()*newK.inv();
    for (int y = part.y % step; y < part.height; y += step)
        for (int x = part.x % step; x < part.width; x += step)
        {
            const Vec3d d = toCamera*Vec3d(x, y, 1);
            const double along = plane[3]/d.dot(Vec3d(plane[0], plane[1], plane[2]));
            points.push_back(along > 0 ? along*d : Vec3d(NaN, NaN, NaN));
            mapped.push_back(map.at<Vec2f>(y, x));
        }
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, raw, status);
    Deviation result = { 0, 0 };
    for (int i = 0; i < (int)mapped.size(); i++)
    {
        const Vec2f p = mapped[i];
        const bool answer = status.at<uchar>(i) == REFRACT_OK;
        if (answer == (p == Vec2f(-1, -1)))
            result.unlike++;
        else if (answer)
            for (int k = 0; k < 2; k++)
            {
                const double exact = raw[i][k], rounding = std::abs((float)exact - exact);
                result.largest = std::max(result.largest, std::abs(p[k] - exact) - rounding);
            }
    }
    return result;
}

/* Every lens behind every window. Of each image one of parts x parts parts, in turn, and of that every step-th pixel in both
directions: the interpolation's error is a polynomial of 8th order in 64 pixels, and hardly changes from one pixel to the next. */
void checkMaps(int parts, int step)
{
    Random random(910);
    CAPTURE(seed());
    double worst = 0;
    const Size size(SIZE.width/parts, SIZE.height/parts);
    int lensNumber = 0, number = 0;
    for (const LensKind& lens : allLenses())
    {
        // Pixels that a wedge, a tube or a bent pane shows nothing take long to be sure of: with every fourth lens.
        const bool areAllTested = lensNumber++ % 4 == 0;
        for (WindowKind kind : allWindows())
            for (double halfField : { 0.5, 0.95, 1.3 })     // inside the lens' domain, up to its edge, beyond it
            {
                CAPTURE(lens.name, name(kind), halfField);
                const GlassWindow window = makeWindow(kind, random);
                const bool isScalar = !window.wedge.empty() || window.shape == WINDOW_TUBE || window.shape == WINDOW_BENT;
                if (isScalar && !areAllTested)
                    continue;
                const double half = std::min(halfField*lens.halfField, 85.)*CV_PI/180, f = SIZE.width/2/std::tan(half);
                const Matx33d newK(f, 0, SIZE.width/2., 0, f, SIZE.height/2., 0, 0, 1);
                const Vec4d plane(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1, random.uniform(300, 2000));
                Matx33d R;
                Rodrigues(random.vector(0.1), R);
                const Rect part(Point(number % parts*size.width, number/parts % parts*size.height), size);
                number++;
                const Deviation d = deviation(makeCamera(lens, window), plane, newK, R, part, step);
                CHECK(d.unlike == 0);
                CHECK(d.largest < 1e-6);
                worst = std::max(worst, d.largest);
            }
    }
    printNumber("map, interpolated against exact, beyond the rounding to float32", worst, "px");
}

} // namespace

TEST_CASE("The interpolated map is the exact one in float32, for windows, lenses and planes", "[undistort_map]") { checkMaps(3, 3); }

TEST_CASE("The interpolated map is the exact one in float32: of all pixels", "[.monte-carlo]") { checkMaps(1, 1); }

TEST_CASE("The interpolated map is right to the horizon and at grazing incidence", "[undistort_map]")
{
    const LensKind& fisheye = lensNamed("fisheye");
    const Matx33d wide(40, 0, 320, 0, 40, 240, 0, 0, 1);        // 83 degrees at the sides
    const GlassWindow pane(Vec3d(0, 0, 1), 20, 1.54, 50), leaning(Vec3d(0.8, 0.1, 0.6), 20, 1.54, 50),
                      water(Vec3d(0.1, 0, 1), 20, 1.54, 0.5, 1.333);
    for (const GlassWindow& window : { pane, leaning, water })
        for (const Vec4d& plane : { Vec4d(0, 0, 1, 80), Vec4d(0, 0, 1, 1e9), Vec4d(1, 0.0123, 0.0071, 200),
                                    Vec4d(0.2, 1.003, 0.0517, 300) })   // whose horizons, infinitely far, meet no pixel
        {
            CAPTURE(window.normal, window.outerIndex, plane);
            const Deviation d = deviation(makeCamera(fisheye, window), plane, wide, Matx33d::eye());
            CHECK(d.unlike == 0);
            CHECK(d.largest < 1e-6);
        }
}
