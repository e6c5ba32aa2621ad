// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Our results against 60-digit ones, see reference/make_reference.py, make_wedge_reference.py,
// make_dome_reference.py, make_tube_reference.py and make_bent_reference.py.
#include "scenes.hpp"
#include "paths.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using nlohmann::json;

namespace {

json read(const std::string& name)
{
    std::ifstream file(paths::tests() + "/reference/" + name);
    REQUIRE(file.good());
    return json::parse(file);
}

const json& reference()
{
    static const json cases = read("projection.json");
    return cases;
}

//! Windows whose faces are not parallel.
const json& wedgeReference()
{
    static const json cases = read("wedge.json");
    return cases;
}

const json& domeReference()
{
    static const json cases = read("dome.json");
    return cases;
}

const json& tubeReference()
{
    static const json cases = read("tube.json");
    return cases;
}

const json& bentReference()
{
    static const json cases = read("bent.json");
    return cases;
}

Vec3d vec3(const json& j) { return Vec3d(j[0], j[1], j[2]); }
Vec2d vec2(const json& j) { return Vec2d(j[0], j[1]); }

Ptr<RefractiveCamera> cameraOfCase(const json& c)
{
    const json& w = c["window"];
    GlassWindow window;
    const std::string shape = w.value("shape", "flat");
    if (shape == "dome" || shape == "tube")
    {
        window.shape = shape == "tube" ? WINDOW_TUBE : WINDOW_DOME;
        window.center = vec3(w["center"]);
        window.radius = w["radius"];
        if (window.shape == WINDOW_TUBE)
            window.axis = vec3(w["axis"]);
    }
    else
    {
        window.normal = vec3(w["normal"]);
        window.distance = w["distance"];
    }
    if (shape == "bent")
    {
        window.shape = WINDOW_BENT;
        window.curvature = w["curvature"];
    }
    window.thickness = w["thickness"].get<std::vector<double>>();
    window.index = w["index"].get<std::vector<double>>();
    window.innerIndex = w["inner_index"];
    window.outerIndex = w["outer_index"];
    if (w.contains("wedge"))
        for (const json& pair : w["wedge"])
            window.wedge.push_back(vec2(pair));
    const std::vector<double> core = c["core"], coefficients = c["coefficients"];
    const Matx33d K(core[0], 0, core[2], 0, core[1], core[3], 0, 0, 1);
    return c["lens"] == "fisheye" ? RefractiveCamera::createFisheye(K, coefficients, window)
                                  : RefractiveCamera::create(K, coefficients, window);
}

std::string nameOfCase(const json& c)
{
    return c["window"]["name"].get<std::string>() + ", " + c["lens"].get<std::string>() + " "
           + std::to_string(c["coefficients"].size()) + " coefficients";
}

double smallestIndex(const json& c)
{
    const json& w = c["window"];
    double least = std::min(w["inner_index"].get<double>(), w["outer_index"].get<double>());
    for (const json& index : w["index"])
        least = std::min(least, index.get<double>());
    return least;
}

struct Projected { Vec2d pixel; uchar status; };

Projected projectPoint(const Ptr<RefractiveCamera>& camera, const Vec3d& X, const Vec3d& rvec = Vec3d(),
                       const Vec3d& tvec = Vec3d())
{
    std::vector<Vec2d> pixel;
    std::vector<uchar> status;
    refractiveProjectPoints(std::vector<Vec3d>{ X }, rvec, tvec, camera, pixel, status);
    return { pixel[0], status[0] };
}

struct PixelRay { Vec3d origin, direction; uchar status; };

PixelRay rayOf(const Ptr<RefractiveCamera>& camera, const Vec2d& pixel)
{
    std::vector<Vec3d> origin, direction;
    std::vector<uchar> status;
    refractiveUnprojectPoints(std::vector<Vec2d>{ pixel }, origin, direction, camera, status);
    return { origin[0], direction[0], status[0] };
}

} // namespace

//! @param tolerance px
static void compareProjection(const json& cases, const char* name, double tolerance, int least)
{
    double worst = 0;
    int points = 0;
    for (const json& c : cases)
    {
        CAPTURE(nameOfCase(c));
        const Ptr<RefractiveCamera> camera = cameraOfCase(c);
        for (const json& p : c["points"])
        {
            CAPTURE(p.dump());
            const Projected result = projectPoint(camera, vec3(p["X"]));
            REQUIRE(result.status == REFRACT_OK);
            const double error = norm(result.pixel - vec2(p["pixel"]));
            CHECK(error < tolerance);
            worst = std::max(worst, error);
            points++;
        }
    }
    CHECK(points > least);
    printNumber(std::string(name) + " against " + std::to_string(points) + " 60-digit references, worst", worst, "px");
}

TEST_CASE("Projection equals the 60-digit references", "[reference]")
{
    compareProjection(reference(), "projection", 1e-9, 400);
}

TEST_CASE("Projection through a wedge equals the 60-digit references", "[reference][wedge]")
{
    compareProjection(wedgeReference(), "projection through wedges", 1e-10, 150);
}

TEST_CASE("Projection through a dome equals the 60-digit references", "[reference][dome]")
{
    compareProjection(domeReference(), "projection through domes", 1e-10, 150);
}

TEST_CASE("Projection through a tube equals the 60-digit references", "[reference][tube]")
{
    compareProjection(tubeReference(), "projection through tubes", 1e-10, 150);
}

TEST_CASE("Projection through a bent pane equals the 60-digit references", "[reference][bent]")
{
    compareProjection(bentReference(), "projection through bent panes", 1e-10, 100);
}

/** A point of the ray, not its origin, is held against the reference.
@param tolerance of the direction
@param last of a window and a direction: the cosine behind the last face, by which roundings of the pixel are larger there */
template<typename Cosine>
static void compareRays(const json& cases, const std::string& name, double tolerance, const Cosine& last)
{
    double worstDirection = 0, worstOrigin = 0;
    for (const json& c : cases)
    {
        CAPTURE(nameOfCase(c));
        const Ptr<RefractiveCamera> camera = cameraOfCase(c);
        for (const json& p : c["points"])
        {
            CAPTURE(p.dump());
            const PixelRay ray = rayOf(camera, vec2(p["pixel"]));
            REQUIRE(ray.status == REFRACT_OK);
            // At a grazing angle behind the last face a rounding of the pixel is 1/cos times larger there.
            const double cosine = last(camera->window(), vec3(p["point"]), vec3(p["direction"]));
            const double directionError = norm(ray.direction - vec3(p["direction"]))*std::abs(cosine);
            const Vec3d off = (ray.origin - vec3(p["point"])).cross(vec3(p["direction"]));
            const double originError = norm(off)/(1 + norm(vec3(p["point"])))*cosine*cosine;
            CHECK(directionError < tolerance);
            CHECK(originError < 1e-14);
            worstDirection = std::max(worstDirection, directionError);
            worstOrigin = std::max(worstOrigin, originError);
        }
    }
    printNumber("ray direction through " + name + " against references, worst * cos(incidence)", worstDirection, "");
    printNumber("ray through " + name + " against references, relative distance, worst * cos(incidence)^2", worstOrigin, "");
}

TEST_CASE("Rays through a wedge equal the 60-digit references", "[reference][wedge]")
{
    compareRays(wedgeReference(), "wedges", 2e-15, [](const GlassWindow& w, const Vec3d&, const Vec3d& d) { return w.normal.dot(d); });
}

TEST_CASE("Rays through a dome equal the 60-digit references", "[reference][dome]")
{
    // Of the direction at the camera, which the lens finds, as much comes out: the dome's faces are nearly across it.
    compareRays(domeReference(), "domes", 5e-15, [](const GlassWindow& w, const Vec3d& point, const Vec3d& d)
                { return normalize(point - w.center).dot(d)/std::max(1., w.radius/1e3); });
}

TEST_CASE("Rays through a tube equal the 60-digit references", "[reference][tube]")
{
    // In the cross-section and along the axis: a ray next to the axis goes far in the tube.
    compareRays(tubeReference(), "tubes", 5e-15, [](const GlassWindow& w, const Vec3d& point, const Vec3d& d)
    {
        const Vec3d off = point - w.center, across = off - off.dot(w.axis)*w.axis;
        return normalize(across).dot(d)/std::max(1., w.radius/1e3);
    });
}

TEST_CASE("Rays through a bent pane equal the 60-digit references", "[reference][bent]")
{
    compareRays(bentReference(), "bent panes", 5e-15, [](const GlassWindow& w, const Vec3d& point, const Vec3d& d)
                { return (w.normal + w.curvature*(point - w.distance*w.normal)).dot(d); });
}

TEST_CASE("Points inside a tube are behind the window", "[reference][tube]")
{
    int inside = 0;
    for (const json& c : tubeReference())
        for (const json& X : c["inside"])
        {
            CAPTURE(nameOfCase(c), X.dump());
            const Projected result = projectPoint(cameraOfCase(c), vec3(X));
            CHECK(result.status == REFRACT_BEHIND_WINDOW);
            CHECK((std::isnan(result.pixel[0]) && std::isnan(result.pixel[1])));
            inside++;
        }
    CHECK(inside > 20);
}

TEST_CASE("Rays equal the 60-digit references", "[reference]")
{
    double worstDirection = 0, worstTau = 0;
    for (const json& c : reference())
    {
        CAPTURE(nameOfCase(c));
        const Ptr<RefractiveCamera> camera = cameraOfCase(c);
        const Vec3d n = camera->window().normal;
        for (const json& p : c["points"])
        {
            CAPTURE(p.dump());
            const PixelRay ray = rayOf(camera, vec2(p["pixel"]));
            REQUIRE(ray.status == REFRACT_OK);
            // At a grazing angle in the rarest medium a rounding of the pixel is 1/cos times larger there.
            const double sine = norm(n.cross(vec3(p["direction"])))*camera->window().outerIndex/smallestIndex(c);
            const double cosine = std::sqrt(1 - sine*sine), tau = p["tau"];
            const double directionError = norm(ray.direction - vec3(p["direction"]))*cosine;
            const double tauError = norm(ray.origin - tau*n)/(1 + std::abs(tau))*cosine*cosine;
            CHECK(directionError < 1e-14);
            CHECK(tauError < 1e-13);
            worstDirection = std::max(worstDirection, directionError);
            worstTau = std::max(worstTau, tauError);
        }
    }
    printNumber("ray direction against references, worst * cos(grazing angle)", worstDirection, "");
    printNumber("ray origin against references, relative, worst * cos(grazing angle)^2", worstTau, "");
}

//! @param least pixels, and points if the cases have any
static void compareTotalReflection(const json& cases, int least)
{
    int unseen = 0, unseeing = 0;
    bool hasPoints = false;
    for (const json& c : cases)
    {
        CAPTURE(nameOfCase(c));
        const Ptr<RefractiveCamera> camera = cameraOfCase(c);
        hasPoints = c.contains("unseen");
        for (const json& X : hasPoints ? c["unseen"] : json::array())
        {
            const Projected result = projectPoint(camera, vec3(X));
            CHECK(result.status == REFRACT_TOTAL_REFLECTION);
            CHECK((std::isnan(result.pixel[0]) && std::isnan(result.pixel[1])));
            unseen++;
        }
        for (const json& pixel : c["unseeing"])
        {
            const PixelRay ray = rayOf(camera, vec2(pixel));
            CHECK(ray.status == REFRACT_TOTAL_REFLECTION);
            CHECK(std::isnan(ray.origin[0]));
            CHECK(std::isnan(ray.direction[2]));
            unseeing++;
        }
    }
    CHECK((unseen > least || !hasPoints));
    CHECK(unseeing > least);
}

TEST_CASE("What no light connects has the status of total reflection", "[reference]")
{
    compareTotalReflection(reference(), 10);
}

TEST_CASE("What no light connects through a dome has the status of total reflection", "[reference][dome]")
{
    compareTotalReflection(domeReference(), 8);
}

TEST_CASE("What no light connects through a tube has the status of total reflection", "[reference][tube]")
{
    compareTotalReflection(tubeReference(), 8);
}

TEST_CASE("What no light connects through a bent pane has the status of total reflection", "[reference][bent]")
{
    compareTotalReflection(bentReference(), 8);
}

TEST_CASE("Rays that miss a face of a bent pane have a status", "[reference][bent]")
{
    int missing = 0;
    for (const json& c : bentReference())
        for (const json& pixel : c["missing"])
        {
            CAPTURE(nameOfCase(c), pixel.dump());
            const PixelRay ray = rayOf(cameraOfCase(c), vec2(pixel));
            CHECK(ray.status == REFRACT_BEHIND_WINDOW);
            CHECK(std::isnan(ray.origin[2]));
            missing++;
        }
    CHECK(missing > 8);
}

static void compareJacobians(const json& cases, const std::string& name)
{
    double worstPixel = 0, worst = 0;
    for (const json& c : cases)
    {
        CAPTURE(nameOfCase(c));
        const Ptr<RefractiveCamera> camera = cameraOfCase(c);
        const json& posed = c["posed"];
        std::vector<Vec2d> pixel;
        std::vector<uchar> status;
        Mat jacobian;
        refractiveProjectPoints(std::vector<Vec3d>{ vec3(posed["object"]) }, vec3(posed["rvec"]), vec3(posed["tvec"]),
                                camera, pixel, status, jacobian);
        REQUIRE(status[0] == REFRACT_OK);
        const double pixelError = norm(pixel[0] - vec2(posed["pixel"]));
        CHECK(pixelError < 1e-9);
        worstPixel = std::max(worstPixel, pixelError);

        // Without a window the indices belong to a surface that is not there; their columns have no meaning.
        const bool none = c["window"]["name"] == "no window";
        REQUIRE(jacobian.rows == 2);
        REQUIRE(jacobian.cols == (int)posed["jacobian"][0].size());
        for (int column = 0; column < jacobian.cols - (none ? 2 : 0); column++)
        {
            const Vec2d expected(posed["jacobian"][0][column], posed["jacobian"][1][column]);
            const Vec2d computed(jacobian.at<double>(0, column), jacobian.at<double>(1, column));
            const double error = norm(computed - expected)/(1 + norm(expected));
            CAPTURE(column, camera->parameterNames(), expected, computed);
            CHECK(error < 1e-10);
            worst = std::max(worst, error);
        }
    }
    printNumber("posed projection" + name + " against references, worst", worstPixel, "px");
    printNumber("jacobian" + name + " against references, relative, worst", worst, "");
}

TEST_CASE("Jacobians equal the 60-digit references", "[reference]")
{
    compareJacobians(reference(), "");
}

TEST_CASE("Jacobians through a dome equal the 60-digit references", "[reference][dome]")
{
    compareJacobians(domeReference(), " through domes");
}

TEST_CASE("Jacobians through a wedge equal the 60-digit references", "[reference][wedge]")
{
    compareJacobians(wedgeReference(), " through wedges");
}

TEST_CASE("Jacobians through a tube equal the 60-digit references", "[reference][tube]")
{
    compareJacobians(tubeReference(), " through tubes");
}

TEST_CASE("Jacobians through a bent pane equal the 60-digit references", "[reference][bent]")
{
    compareJacobians(bentReference(), " through bent panes");
}
