// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The one order of a window's parameters, and what callers are told of it.
#include "camera/camera.hpp"
#include "scenes.hpp"
#include "window/parameters.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

GlassWindow laminate()
{
    GlassWindow window(Vec3d(-0.2, 0.1, 1), 6, 1.52, 40, 1.333);
    window.thickness = { 6, 1.5, 7 };
    window.index = { 1.52, 1.48, 1.53 };
    window.innerIndex = 1.1;
    return window;
}

int indexOf(const std::vector<String>& names, const String& name)
{
    const auto found = std::find(names.begin(), names.end(), name);
    REQUIRE(found != names.end());
    return (int)(found - names.begin());
}

} // namespace

TEST_CASE("Each parameter of a window stands where its name does", "[parameters]")
{
    const GlassWindow window = laminate();
    const std::vector<String> names = windowParameterNames(windowLayout(3));
    const std::vector<double> p = windowParameters(window);
    REQUIRE(names.size() == p.size());
    CHECK(p[indexOf(names, "normal[1]")] == window.normal[1]);
    CHECK(p[indexOf(names, "distance")] == window.distance);
    CHECK(p[indexOf(names, "innerIndex")] == window.innerIndex);
    CHECK(p[indexOf(names, "outerIndex")] == window.outerIndex);
    for (int i = 0; i < 3; i++)
    {
        CHECK(p[indexOf(names, format("thickness[%d]", i))] == window.thickness[i]);
        CHECK(p[indexOf(names, format("index[%d]", i))] == window.index[i]);
    }
    GlassWindow other = window;
    other.normal = Vec3d(0, 0, 1);
    other.distance = other.outerIndex = 3;
    other.index[2] = 2;
    other.thickness[0] = 99;
    other.wavelength = 610;
    other.materials = {"air", "N-BK7", "", "PMMA", "water"};
    const GlassWindow back = withParameters(other, p.data());
    CHECK(back.materials == other.materials);
    CHECK(back.wavelength == 610);
    CHECK(norm(back.normal - normalize(window.normal)) < 1e-15);
    CHECK(windowParameters(back)[3] == p[3]);
    CHECK(back.thickness == window.thickness);
    CHECK(back.index == window.index);
}

TEST_CASE("Flags free what they name, and nothing else", "[parameters]")
{
    const std::vector<String> names = windowParameterNames(windowLayout(3));
    const struct { int flag; const char* name; } cases[] = {
        { 0, "normal" }, { GLASS_FREE_DISTANCE, "distance" }, { GLASS_FREE_THICKNESS, "thickness" },
        { GLASS_FREE_INDEX, "index" }, { GLASS_FREE_OUTER_INDEX, "outerIndex" } };
    for (const auto& c : cases)
    {
        const std::vector<bool> isFree = freeWindowParameters(windowLayout(3), c.flag);
        for (size_t i = 0; i < names.size(); i++)
        {
            CAPTURE(c.name, names[i]);
            CHECK(isFree[i] == (names[i].find("normal") == 0 || names[i].find(c.name) == 0));
        }
    }
}

TEST_CASE("The names of a camera's parameters are those of the jacobian's columns", "[parameters]")
{
    const Matx33d K(2400, 0, 640, 0, 2410, 500, 0, 0, 1);
    const std::vector<double> coefficients = { -0.2, 0.1, 1e-3, -1e-3, 0.02 };
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Mat(K), Mat(coefficients), laminate());
    const std::vector<String> names = camera->parameterNames();
    CHECK((int)names.size() == static_cast<const Camera&>(*camera).parameterCount());
    const std::vector<Point3d> point = { { 60, -40, 700 } };
    std::vector<Point2d> pixel, moved;
    Mat jacobian;
    refractiveProjectPoints(point, Vec3d(), Vec3d(), camera, pixel, noArray(), jacobian);
    REQUIRE(jacobian.cols == 6 + (int)names.size());
    const double step = 1e-5;
    GlassWindow window = camera->window();
    window.index[1] += step;
    camera->setWindow(window);
    refractiveProjectPoints(point, Vec3d(), Vec3d(), camera, moved);
    CHECK((moved[0].x - pixel[0].x)/step == Approx(jacobian.at<double>(0, 6 + indexOf(names, "index[1]"))).epsilon(1e-4));
    camera->setWindow(laminate());
    Mat lens = camera->lensParameters();
    lens.at<double>(indexOf(names, "p2")) += step;
    camera->setLensParameters(lens);
    refractiveProjectPoints(point, Vec3d(), Vec3d(), camera, moved);
    CHECK((moved[0].y - pixel[0].y)/step == Approx(jacobian.at<double>(1, 6 + indexOf(names, "p2"))).epsilon(1e-4));
}
