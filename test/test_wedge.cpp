// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Windows whose faces are not parallel; against 60-digit references in test_reference.cpp, in every call as two of allWindows().
#include "quick_require.hpp"
#include "scenes.hpp"
#include "window/layers.hpp"
#include "window/wedge.hpp"
#include "window/wedge_kernels.hpp"
#include "window/wedge_path.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

Vec3d unit(const Vec3d& v) { return v/norm(v); }

//! One to three layers in air or water, wedges of up to so many degrees a component.
GlassWindow wedgedWindow(Random& random, double mostDegrees)
{
    const WindowKind kinds[] = { PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, WATER_GLASS_AIR, DOUBLE_GLAZING_IN_WATER, GLASS_ON_LENS };
    GlassWindow window = makeWindow(kinds[random.below(6)], random, 60);
    const double most = mostDegrees*CV_PI/180/std::sqrt(2.*window.thickness.size());
    for (size_t i = 0; i < window.thickness.size(); i++)
        window.wedge.push_back(Vec2d(random.uniform(-most, most), random.uniform(-most, most)));
    return window;
}

Vec3d directionAt(const Vec3d& n, double angle, double azimuth)
{
    const Vec3d across = unit(n.cross(Vec3d(0.36, 0.48, -0.8))), third = n.cross(across);
    return std::cos(angle)*n + std::sin(angle)*(std::cos(azimuth)*across + std::sin(azimuth)*third);
}

//! Faces as planes m.X = d.
struct PlaneOf { Vec3d m; double d; };

//! As the header says it, by a rotation vector.
std::vector<PlaneOf> planesOf(const GlassWindow& w)
{
    const Vec3d n = w.normal, e1 = unit(Vec3d(1, 0, 0) - n[0]*n), e2 = n.cross(e1);
    std::vector<PlaneOf> planes(1, PlaneOf{ n, w.distance });
    Vec2d sum;
    double height = w.distance;
    for (size_t i = 0; i < w.thickness.size(); i++)
    {
        sum += w.wedge[i];
        height += w.thickness[i];
        Matx33d R;
        Rodrigues(sum[0]*e2 - sum[1]*e1, R);
        planes.push_back({ R*n, (R*n).dot(height*n) });
    }
    return planes;
}

//! What makes a path difficult.
struct PathLimits
{
    double cosine = 1;          //!< the least at any face, on either side: there roundings are 1/cosine times larger
    double share = 1;           //!< of its thickness on the axis, the least that a layer has where the light passes
};

//! Vector Snell from any place before the first face.
bool traceFrom(const GlassWindow& w, const std::vector<PlaneOf>& planes, Vec3d& point, Vec3d& direction, PathLimits* limits = nullptr)
{
    double medium = w.innerIndex;
    PathLimits least;
    for (size_t k = 0; k < planes.size(); k++)
    {
        const double next = k < w.index.size() ? w.index[k] : w.outerIndex, c = planes[k].m.dot(direction), ratio = medium/next;
        const double square = 1 - ratio*ratio*(1 - c*c);
        if (!(c > 0 && square > 0))
            return false;
        const double length = (planes[k].d - planes[k].m.dot(point))/c;
        if (k > 0)
            least.share = std::min(least.share, length/w.thickness[k - 1]);
        point += length*direction;
        direction = ratio*direction + (std::sqrt(square) - ratio*c)*planes[k].m;
        medium = next;
        least.cosine = std::min(least.cosine, std::min(c, std::sqrt(square)));
    }
    if (limits)
        *limits = least;
    return true;
}

uchar solveIn(const Layers& layers, const Vec3d& X, double w, Vec3d& direction)
{
    uchar status = REFRACT_OK;
    double ratio;
    layers.solveIn(1, &X[0], &X[1], &X[2], &w, &direction[0], &direction[1], &direction[2], &status, &ratio);
    return status;
}

GlassWindow prism(double degrees)
{
    GlassWindow window(Vec3d(0, 0, 1), 20, 1.5, 50);
    window.wedge.push_back(Vec2d(degrees*CV_PI/180, 0));
    return window;
}

} // namespace

TEST_CASE("Round trips through wedges of up to five degrees, up to 85 degrees of incidence", "[wedge]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0, worstFar = 0;
    int trips = 0, left = 0;
    for (int i = 0; i < 40000; i++)
    {
        const GlassWindow window = wedgedWindow(random, i % 2 ? 5 : 0.5);
        const Layers layers(window);
        const Vec3d w = directionAt(window.normal, random.uniform(0, 85)*CV_PI/180, random.uniform(0, 2*CV_PI));
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        Vec3d point, direction = w;
        PathLimits limits;
        const bool gets = traceFrom(window, planesOf(window), point, direction, &limits);
        const double grazing = limits.cosine;
        // Where faces lie across each other the plain tracer goes on.
        QUICK_REQUIRE((gets || status != REFRACT_OK), i, status);
        if (status != REFRACT_OK || limits.share < 1e-3)        // next to the edge where faces meet there may be no answer
            continue;
        QUICK_REQUIRE(norm(rays.direction(0) - direction) < 1e-14/grazing, i, w);
        const Vec3d off = (rays.origin(0, window.normal) - point).cross(direction);
        QUICK_REQUIRE(norm(off) < 1e-13*(1 + norm(point))/grazing, i, w);
        const Vec3d X = point + random.logUniform(1e-2, 1e5)*direction;
        Vec3d back;
        double none;
        left += !wedgeKernels().solveIn(layers.stack(), layers.tilted(), 1, &X[0], &X[1], &X[2], NULL, &back[0], &back[1], &none);
        QUICK_REQUIRE(solveIn(layers, X, 1, back) == REFRACT_OK, i, w, X);
        const double error = norm(unit(back) - w)*grazing;
        QUICK_REQUIRE(error < 1e-13, i, w, X, error);
        worst = std::max(worst, error);
        QUICK_REQUIRE(solveIn(layers, X*1e-4, 1e-4, back) == REFRACT_OK, i, w, X);
        QUICK_REQUIRE(norm(unit(back) - w)*grazing < 1e-13, i, w, X);
        QUICK_REQUIRE(solveIn(layers, direction, 0, back) == REFRACT_OK, i, w);
        worstFar = std::max(worstFar, norm(unit(back) - w)*grazing);
        trips++;
    }
    CHECK(trips > 20000);
    CHECK(worstFar < 1e-13);
    printNumber("round trips through wedges", trips, "");
    printNumber("of which the vector code leaves to the scalar", left, "");
    printNumber("round trip through wedges, worst angle * least cosine of its path", worst, "");
    printNumber("the same from infinity", worstFar, "");
}

TEST_CASE("The convex search finds what the vector code finds", "[wedge]")
{
    CAPTURE(seed());
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 2000; i++)
    {
        const GlassWindow window = wedgedWindow(random, 3);
        const Layers layers(window);
        const Vec3d X = random.logUniform(10, 1e4)*directionAt(window.normal, random.uniform(0, 70)*CV_PI/180,
                                                               random.uniform(0, 2*CV_PI)) + 300*window.normal;
        Vec3d d, slow;
        if (solveIn(layers, X, 1, d) != REFRACT_OK)
            continue;
        const Matx33d axes = windowAxes(window.normal);
        QUICK_REQUIRE(findWedgePath(layers.tilted(), axes*X, 1, slow) == REFRACT_OK, i, X);
        worst = std::max(worst, norm(unit(axes.t()*slow) - unit(d)));
    }
    CHECK(worst < 1e-12);
    printNumber("convex search against vector code, worst", worst, "rad");
}

TEST_CASE("A wedge of 0 is no wedge, to the last bit", "[wedge]")
{
    CAPTURE(seed());
    Random random(2);
    for (WindowKind kind : { PANE_IN_AIR, LAMINATE, AIR_GLASS_WATER, DOUBLE_GLAZING_IN_WATER })
    {
        const GlassWindow parallel = makeWindow(kind, random);
        GlassWindow wedged = parallel;
        wedged.wedge.assign(parallel.thickness.size(), Vec2d());
        const Ptr<RefractiveCamera> a = makeCamera(lensNamed("5 coefficients"), parallel);
        const Ptr<RefractiveCamera> b = makeCamera(lensNamed("5 coefficients"), wedged);
        std::vector<Vec3d> points;
        std::vector<Vec2d> pixels;
        for (int i = 0; i < 200; i++)
        {
            points.push_back(Vec3d(random.uniform(-200, 200), random.uniform(-200, 200), random.uniform(300, 900)));
            pixels.push_back(Vec2d(random.uniform(0, 1280), random.uniform(0, 1024)));
        }
        const auto results = [&](const Ptr<RefractiveCamera>& camera)
        {
            Mat u, J, o, d, far;
            refractiveProjectPoints(points, Vec3d(0.1, 0, 0), Vec3d(1, 2, 3), camera, u, noArray(), J);
            refractiveUnprojectPoints(pixels, o, d, camera);
            refractiveUndistortPoints(pixels, far, camera, 700.);
            return std::vector<Mat>{ u, J.colRange(0, 6 + a->parameterNames().size()).clone(), o, d, far };
        };
        const std::vector<Mat> ofA = results(a), ofB = results(b);
        CAPTURE(name(kind));
        for (size_t k = 0; k < ofA.size(); k++)
        {
            CAPTURE(k);
            REQUIRE(ofA[k].total() == ofB[k].total());
            CHECK(std::equal(ofA[k].datastart, ofA[k].dataend, ofB[k].datastart));
        }
        CHECK(b->parameterNames().size() == a->parameterNames().size() + 2*parallel.thickness.size());
        CHECK(b->parameterNames().back() == format("wedge[%d][1]", (int)parallel.thickness.size() - 1));
    }
}

TEST_CASE("A prism turns a ray by (index - 1) times its angle, away from its thin side", "[wedge]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray(), prism(0.01));
    std::vector<Vec3d> origin, direction;
    refractiveUnprojectPoints(std::vector<Vec2d>{ { PLAIN_K(0, 2), PLAIN_K(1, 2) } }, origin, direction, camera);
    CHECK(direction[0][0] == Approx(-0.5*0.01*CV_PI/180).epsilon(1e-6));     // its normal leans to x: there it is thin
    CHECK(std::abs(direction[0][1]) < 1e-17);
    CHECK(std::abs(origin[0][0]) < 0.01);
}

TEST_CASE("Light that a window with a wedge does not let out, or in, has its status", "[wedge]")
{
    // The faces meet 20/tan(5 degrees) to the right of the axis, 229 mm; beyond it there is no pane.
    const Layers layers(prism(5));
    const auto traced = [&](double degrees)
    {
        const Vec3d w(std::sin(degrees*CV_PI/180), 0, std::cos(degrees*CV_PI/180));
        Rays rays;
        uchar status = REFRACT_OK;
        layers.traceOut(1, &w[0], &w[1], &w[2], rays, &status);
        CHECK((status == REFRACT_OK) == !std::isnan(rays.tau[0]));
        return (int)status;
    };
    const double edge = std::atan2(20/std::tan(5*CV_PI/180), 50)*180/CV_PI;
    CHECK(traced(edge - 0.01) == REFRACT_OK);
    CHECK(traced(edge + 0.01) == REFRACT_BEHIND_WINDOW);
    CHECK(traced(-50) == REFRACT_OK);
    CHECK(traced(-85) == REFRACT_TOTAL_REFLECTION);     // 46.6 degrees within the glass, at its outer face
    CHECK(traced(95) == REFRACT_BEHIND_WINDOW);
    Vec3d d;
    CHECK(solveIn(layers, Vec3d(0, 0, 70.001), 1, d) == REFRACT_OK);
    CHECK(solveIn(layers, Vec3d(0, 0, 69.999), 1, d) == REFRACT_BEHIND_WINDOW);
    const double lower = 70 - 100*std::tan(5*CV_PI/180);        // of the outer face at x = 100
    CHECK(solveIn(layers, Vec3d(100, 0, lower + 1e-3), 1, d) == REFRACT_OK);
    CHECK(solveIn(layers, Vec3d(100, 0, lower - 1e-3), 1, d) == REFRACT_BEHIND_WINDOW);
    CHECK(solveIn(layers, Vec3d(5000, 0, 100), 1, d) == REFRACT_BEHIND_WINDOW);      // only past the edge
    CHECK(layers.isBeyond(100, 0, lower + 1e-3));
    CHECK_FALSE(layers.isBeyond(100, 0, lower - 1e-3));
    // Total reflection at the outer face of a dense prism, and on the way back at the inner one.
    GlassWindow dense = prism(-31);
    dense.index[0] = 2;
    const Vec3d w(0, 0, 1);
    Rays rays;
    uchar status = REFRACT_OK;
    Layers(dense).traceOut(1, &w[0], &w[1], &w[2], rays, &status);
    CHECK(status == REFRACT_TOTAL_REFLECTION);
    CHECK(solveIn(Layers(dense), Vec3d(-0.98, 0, 0.17), 0, d) == REFRACT_TOTAL_REFLECTION);
}

TEST_CASE("A wrong wedge is named with its value", "[wedge][window]")
{
    const auto complaint = [](const std::vector<Vec2d>& wedge, double thickness)
    {
        GlassWindow window(Vec3d(0, 0, 1), thickness, 1.5, 50);
        window.wedge = wedge;
        return thrown([&] { window.check(); });
    };
    CHECK(complaint({}, 20).empty());
    CHECK(complaint({ { 0.1, -0.2 } }, 20).empty());
    CHECK(complaint({ { 0, 0 } }, 0).empty());
    CHECK_THAT(complaint({ { 0, 0 }, { 0, 0 } }, 20), Contains("window.wedge has 2 layers, window.thickness 1"));
    CHECK_THAT(complaint({ { 0, NaN } }, 20), Contains("window.wedge[0] is (0, nan)"));
    CHECK_THAT(complaint({ { INF, 0 } }, 20), Contains("window.wedge[0] is (inf, 0)"));
    CHECK_THAT(complaint({ { 0, 1.6 } }, 20), Contains("window.wedge[0] is (0, 1.6); it must be finite and below 90 degrees"));
    CHECK_THAT(complaint({ { 1e-3, 0 } }, 0), Contains("window.thickness[0] is 0; it must be positive in a window with a wedge"));
    GlassWindow two(Vec3d(0, 0, 1), 20, 1.5, 50);
    two.thickness.push_back(3);
    two.index.push_back(1.4);
    two.wedge = { { 1, 0 }, { 0.9, 0 } };
    CHECK_THAT(thrown([&] { two.check(); }), Contains("window.wedge[0] to [1] add up to (1.9, 0)"));
    two.wedge[1][0] = -0.9;
    CHECK_NOTHROW(two.check());
}

TEST_CASE("The wedge of a window is in its file, and only there where it has one", "[wedge][window]")
{
    GlassWindow window(Vec3d(0.1, -0.2, 1), 20, 1.5, 50);
    const auto stored = [&]
    {
        FileStorage fs("a.yml", FileStorage::WRITE | FileStorage::MEMORY);
        fs << "glass_window" << window;
        return fs.releaseAndGetString();
    };
    CHECK(stored().find("wedge") == String::npos);
    window.thickness = { 20, 1./3 };
    window.index = { 1.5, 1.4 };
    window.wedge = { { 1./3000, -2e-4 }, { 0, 1e-5 } };
    for (const char* format : { "a.yml", "a.json", "a.xml" })
    {
        FileStorage fs(format, FileStorage::WRITE | FileStorage::MEMORY);
        fs << "glass_window" << window;
        GlassWindow back;
        FileStorage(fs.releaseAndGetString(), FileStorage::READ | FileStorage::MEMORY)["glass_window"] >> back;
        CAPTURE(format);
        CHECK(back.wedge == window.wedge);
    }
    for (const char* wrong : { "[ 1, 2 ]", "[ [ 1, 2, 3 ] ]", "[ [ 1, \"a\" ] ]", "3" })
    {
        FileStorage fs(String("%YAML:1.0\nglass_window: { normal: [0, 0, 1], thickness: [20], index: [1.5], wedge: ") + wrong + " }\n",
                       FileStorage::READ | FileStorage::MEMORY);
        GlassWindow back;
        CAPTURE(wrong);
        CHECK_THAT(thrown([&] { fs["glass_window"] >> back; }), Contains("glass_window.wedge must be a list of pairs"));
    }
}

TEST_CASE("A window in the frame of another camera is the same piece of glass", "[wedge]")
{
    CAPTURE(seed());
    Random random(5);
    for (int i = 0; i < 200; i++)
    {
        const GlassWindow window = wedgedWindow(random, 5);
        Matx33d R;
        Rodrigues(random.vector(0.3), R);
        const Vec3d T = random.vector(30), centre = -(R.t()*T);
        const GlassWindow other = windowInFrame(window, R, T);
        if (!(other.normal[2] > 0.1) || other.distance < 0 || *std::min_element(other.thickness.begin(), other.thickness.end()) <= 0)
            continue;
        const Vec3d w = directionAt(window.normal, random.uniform(0, 60)*CV_PI/180, random.uniform(0, 2*CV_PI)), turned = R*w;
        Vec3d point = centre, direction = w;
        Rays rays;
        uchar status = REFRACT_OK;
        Layers(other).traceOut(1, &turned[0], &turned[1], &turned[2], rays, &status);
        if (!traceFrom(window, planesOf(window), point, direction) || status != REFRACT_OK)
            continue;
        CAPTURE(i);
        CHECK(norm(R*direction - rays.direction(0)) < 1e-12);
        CHECK(norm((R*point + T - rays.origin(0, other.normal)).cross(rays.direction(0))) < 1e-11*(1 + norm(point)));
    }
}
