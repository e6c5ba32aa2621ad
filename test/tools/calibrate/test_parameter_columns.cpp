// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which column is which parameter, for windows of each shape: against the module's own derivatives.
#include "calibrate/parameter_columns.hpp"
#include "window/parameters.hpp"
#include <catch2/catch.hpp>
#include <map>

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

std::vector<GlassWindow> windowsOfEachShape()
{
    GlassWindow wedged(normalize(Vec3d(0.2, -0.1, 1)), 20, 1.52, 40, 1.333);
    wedged.wedge = {Vec2d(0.001, -0.002)};
    GlassWindow bent(normalize(Vec3d(-0.1, 0.15, 1)), 20, 1.52, 40, 1.333);
    bent.shape = WINDOW_BENT;
    bent.curvature = 1e-4;
    GlassWindow bentWedge = wedged;
    bentWedge.shape = WINDOW_BENT;
    bentWedge.curvature = -1e-4;
    std::vector<GlassWindow> windows = {GlassWindow(normalize(Vec3d(0.2, -0.1, 1)), 20, 1.52, 40, 1.333), wedged, bent, bentWedge,
                                        GlassWindow::dome(Vec3d(5, -3, 9), 50, 6, 1.49, 1.333),
                                        GlassWindow::tube(Vec3d(5, 0, 9), Vec3d(0.1, 1, -0.2), 50, 6, 1.49, 1.333)};
    for (GlassWindow& window : windows)
        window.innerIndex = 1.01;               // away from its bound, so that there are differences to both sides
    return windows;
}

} // namespace

TEST_CASE("A window's numbers are in the columns of its derivatives, for each shape", "[parameter_columns]")
{
    const Matx33d K(900, 0, 500, 0, 900, 400, 0, 0, 1);
    const std::vector<Point3d> points = {{100, 50, 600}, {-80, 120, 500}, {20, -90, 700}};
    for (const GlassWindow& window : windowsOfEachShape())
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, Mat(), window);
        const ParameterColumns at = columnsOf(*camera);
        CAPTURE(window.shape, at.end);
        CHECK(at.has(at.normal) == (window.shape == WINDOW_FLAT || window.shape == WINDOW_BENT));
        CHECK(at.has(at.center) != at.has(at.normal));
        CHECK(at.has(at.radius) == at.has(at.center));
        CHECK(at.has(at.axis) == (window.shape == WINDOW_TUBE));
        CHECK(at.has(at.curvature) == (window.shape == WINDOW_BENT));
        CHECK((at.wedge < at.curvature) == !window.wedge.empty());
        const std::vector<String> names = camera->parameterNames();
        REQUIRE((int)names.size() == at.end);
        for (const auto& column : std::map<std::string, int>{{"fx", at.lens}, {"normal[0]", at.normal}, {"distance", at.distance},
                 {"center[0]", at.center}, {"axis[0]", at.axis}, {"radius", at.radius}, {"thickness[0]", at.thickness},
                 {"index[0]", at.index}, {"innerIndex", at.innerIndex}, {"outerIndex", at.outerIndex}, {"curvature", at.curvature}})
        {
            CAPTURE(column.first);
            CHECK(std::find(names.begin(), names.end(), column.first) - names.begin() == column.second);
        }
        CHECK(std::count_if(names.begin(), names.end(), [](const String& name) { return name.find("wedge") == 0; })
              == at.curvature - at.wedge);
        Mat pixels, jacobian;
        refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, noArray(), jacobian);
        const std::vector<double> numbers = windowParameters(window);
        REQUIRE((int)numbers.size() == at.end - at.window);
        for (int i = at.window; i < at.end; i++)
        {
            const int k = i - at.window;
            const double step = 1e-6*std::max(1e-3, std::abs(numbers[k]));
            std::vector<Point2d> seen[2];
            for (int side : {0, 1})
            {
                std::vector<double> moved = numbers;
                moved[k] += side ? step : -step;
                const Ptr<RefractiveCamera> other = RefractiveCamera::create(K, Mat(), withParameters(window, moved.data()));
                refractiveProjectPoints(points, Vec3d(), Vec3d(), other, seen[side]);
            }
            CAPTURE(names[i]);
            for (size_t p = 0; p < points.size(); p++)
            {
                const Point2d slope = (seen[1][p] - seen[0][p])*(0.5/step);
                const Point2d stated(jacobian.at<double>(2*(int)p, 6 + i), jacobian.at<double>(2*(int)p + 1, 6 + i));
                CHECK(norm(slope - stated) < 1e-4*(1. + norm(stated)));
            }
        }
        const GlassWindow again = withParameters(window, numbers.data());
        CHECK(norm(again.normal - window.normal) + norm(again.center - window.center) + norm(again.axis - window.axis) < 1e-12);
        CHECK(again.radius == window.radius);
        CHECK(again.curvature == window.curvature);
    }
}
