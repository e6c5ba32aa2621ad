// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refractiveProjectPoints and refractiveUnprojectPoints.
#include "scenes.hpp"
#include "window/parameters.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

Vec3d transformed(const Vec3d& rvec, const Vec3d& tvec, const Vec3d& X)
{
    Matx33d R;
    Rodrigues(rvec, R);
    return R*X + tvec;
}

const Matx33d K(1000, 0, 640, 0, 1010, 480, 0, 0, 1);

} // namespace

TEST_CASE("Without window: cv::projectPoints, every number of coefficients", "[project]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    if (kind.model != "opencv" && (kind.model != "fisheye" || kind.K(0, 1) != 0))
        return;     // OpenCV has no such lens; the skew is tested below, as cv::fisheye takes alpha instead of a matrix entry
    Random random;
    std::vector<Vec3d> points;
    const Vec3d rvec = random.vector(1), tvec = random.vector(100);
    Matx33d R;
    Rodrigues(rvec, R);
    for (int i = 0; i < 5000; i++)
        points.push_back(R.t()*(random.logUniform(10, 1e5)*randomNormal(random, std::min(80., kind.halfField)) - tvec));
    std::vector<Vec2d> ours, theirs;
    refractiveProjectPoints(points, rvec, tvec, makeCamera(kind, GlassWindow()), ours);
    if (kind.model == "fisheye")
        fisheye::projectPoints(points, theirs, rvec, tvec, kind.K, kind.coefficients);
    else
        projectPoints(points, rvec, tvec, kind.K, kind.coefficients, theirs);
    const double worst = largestDifference(ours, theirs);
    CHECK(worst < 1e-9);
    printNumber(std::string("no window, ") + kind.name + ", against cv, worst", worst, "px");

    std::vector<Vec2d> rotated;
    refractiveProjectPoints(points, R, tvec, makeCamera(kind, GlassWindow()), rotated);
    CHECK(largestDifference(ours, rotated) < 1e-9);
}

TEST_CASE("The fisheye's skew is cv::fisheye's alpha", "[project]")
{
    const double alpha = 0.01;
    const Matx33d straight(400, 0, 640, 0, 410, 512, 0, 0, 1), skewed(400, 400*alpha, 640, 0, 410, 512, 0, 0, 1);
    const std::vector<double> d = { 0.01, -0.003, 0.0005, 0 };
    const std::vector<Vec3d> points = { { 1, 2, 3 }, { -3, 1, 2 }, { 0, 0, 1 }, { 5, -5, 1 } };
    std::vector<Vec2d> ours, theirs;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), RefractiveCamera::createFisheye(skewed, d), ours);
    fisheye::projectPoints(points, theirs, Vec3d(), Vec3d(), straight, d, alpha);
    CHECK(largestDifference(ours, theirs) < 1e-9);
}

TEST_CASE("A pane in air moves the image away from the foot of its normal", "[project]")
{
    // The point seems closer by tau: the pixel is that of the point shifted towards the camera along the normal.
    const GlassWindow window = paper::pane();
    const Vec3d X(30, -40, 600);
    std::vector<Vec2d> with, without, shifted;
    refractiveProjectPoints(std::vector<Vec3d>{ X }, Vec3d(), Vec3d(), K, noArray(), window, with);
    refractiveProjectPoints(std::vector<Vec3d>{ X }, Vec3d(), Vec3d(), K, noArray(), GlassWindow(), without);
    const double c = window.normal.dot(X)/norm(X), mu = 1.5437;
    const double tau = 20*(1 - c/std::sqrt(mu*mu - 1 + c*c));
    refractiveProjectPoints(std::vector<Vec3d>{ X - tau*window.normal }, Vec3d(), Vec3d(), K, noArray(), GlassWindow(),
                            shifted);
    CHECK(norm(with[0] - without[0]) > 1);
    CHECK(norm(with[0] - shifted[0]) < 1e-2*norm(with[0] - without[0]));    // tau of the direction without window
}

TEST_CASE("Both overloads project the same", "[project]")
{
    const std::vector<double> d = { -0.28, 0.09, 7e-4, -4e-4 };
    const std::vector<Vec3d> points = { { 1, 2, 300 }, { -30, 10, 400 }, { 0, 0, 5000 } };
    const Vec3d rvec(0.1, 0.2, -0.1), tvec(5, 6, 70);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, d, paper::pane());
    std::vector<Vec2d> a, b, c;
    std::vector<uchar> sa, sb, sc;
    Mat jacobian;
    refractiveProjectPoints(points, rvec, tvec, K, d, paper::pane(), a, sa);
    refractiveProjectPoints(points, rvec, tvec, camera, b, sb);
    refractiveProjectPoints(points, rvec, tvec, camera, c, sc, jacobian);
    CHECK(largestDifference(a, b) == 0);
    CHECK(largestDifference(a, c) < 1e-10);
    CHECK(sa == std::vector<uchar>(3, REFRACT_OK));
    CHECK(sb == sa);
    CHECK(sc == sa);
    std::vector<Vec3d> o1, d1, o2, d2;
    refractiveUnprojectPoints(a, o1, d1, K, d, paper::pane(), sa);
    refractiveUnprojectPoints(a, o2, d2, camera, sb);
    CHECK(largestDifference(o1, o2) == 0);
    CHECK(largestDifference(d1, d2) == 0);
}

TEST_CASE("One bad point has its status and leaves the others alone", "[project]")
{
    // The water makes the far sideways point's light hit the lens side of the glass beyond any angle.
    const GlassWindow onLens(Vec3d(0, 0, 1), 8, 1.52, 0, 1.333);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, std::vector<double>{ -0.3, 0, 0, 0 }, onLens);
    struct Case { Vec3d X; uchar status; };
    const Case cases[] = {
        { { 10, 20, 300 }, REFRACT_OK },
        { { NaN, 20, 300 }, REFRACT_NOT_FINITE }, { { 10, INF, 300 }, REFRACT_NOT_FINITE },
        { { 10, 20, -INF }, REFRACT_NOT_FINITE },
        { { 1, 1, 8 }, REFRACT_BEHIND_WINDOW }, { { 1, 1, 4 }, REFRACT_BEHIND_WINDOW }, { { 1, 1, -50 }, REFRACT_BEHIND_WINDOW },
        { { 1000, 0, 100 }, REFRACT_TOTAL_REFLECTION },
        { { 105, 0, 100 }, REFRACT_OUTSIDE_LENS_MODEL },
        { { 0, 0, 9 }, REFRACT_OK } };
    std::vector<Vec3d> points;
    for (const Case& c : cases)
        points.push_back(c.X);
    std::vector<Vec2d> pixels, again;
    std::vector<uchar> status;
    Mat jacobian;
    for (bool withJacobian : { false, true })
    {
        if (withJacobian)
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, status, jacobian);
        else
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels, status);
        for (size_t i = 0; i < points.size(); i++)
        {
            CAPTURE(i, cases[i].X, withJacobian);
            CHECK((int)status[i] == (int)cases[i].status);
            const bool ok = cases[i].status == REFRACT_OK;
            CHECK(std::isfinite(pixels[i][0]) == ok);
            CHECK(std::isfinite(pixels[i][1]) == ok);
            if (withJacobian)
                CHECK(std::isfinite(sum(jacobian.rowRange(2*(int)i, 2*(int)i + 2))[0]) == ok);
        }
        refractiveProjectPoints(std::vector<Vec3d>{ points[0], points[9] }, Vec3d(), Vec3d(), camera, again);
        CHECK(norm(again[0] - pixels[0]) < 1e-10);
        CHECK(norm(again[1] - pixels[9]) < 1e-10);
    }
}

TEST_CASE("Points behind a camera without window have no image", "[project]")
{
    std::vector<Vec2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(std::vector<Vec3d>{ { 1, 2, -3 }, { 1, 2, 0 }, { 0, 0, 0 }, { 1, 2, 1e-300 }, { 0, 0, 1 } },
                            Vec3d(), Vec3d(), K, noArray(), GlassWindow(), pixels, status);
    CHECK(status[0] == REFRACT_BEHIND_CAMERA);
    CHECK(status[1] == REFRACT_BEHIND_CAMERA);
    CHECK(status[2] == REFRACT_BEHIND_CAMERA);
    CHECK((status[3] == REFRACT_OK) == std::isfinite(pixels[3][0]));
    CHECK(status[4] == REFRACT_OK);
    CHECK(norm(pixels[4] - Vec2d(640, 480)) == 0);
}

TEST_CASE("Bad pixels have their status", "[project]")
{
    GlassWindow tank(Vec3d(0, 0, 1), 12, 1.5, 60);
    tank.innerIndex = 1.333;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, std::vector<double>{ -0.1, 0, 0, 0 }, tank);
    std::vector<Vec3d> origins, directions;
    std::vector<uchar> status;
    const std::vector<Vec2d> pixels = { { 640, 480 }, { NaN, 480 }, { 640, INF }, { 1e5, 480 }, { 640 + 1080, 480 } };
    refractiveUnprojectPoints(pixels, origins, directions, camera, status);
    const uchar expected[] = { REFRACT_OK, REFRACT_NOT_FINITE, REFRACT_NOT_FINITE, REFRACT_OUTSIDE_LENS_MODEL,
                               REFRACT_TOTAL_REFLECTION };
    for (size_t i = 0; i < pixels.size(); i++)
    {
        CAPTURE(i);
        CHECK((int)status[i] == (int)expected[i]);
        for (int c = 0; c < 3; c++)
        {
            CHECK(std::isfinite(origins[i][c]) == (expected[i] == REFRACT_OK));
            CHECK(std::isfinite(directions[i][c]) == (expected[i] == REFRACT_OK));
        }
    }
    // Along the axis: the paraxial height of the origin.
    CHECK(norm(directions[0] - Vec3d(0, 0, 1)) < 1e-15);
    CHECK(norm(origins[0] - Vec3d(0, 0, 60*(1 - 1/1.333) + 12*(1 - 1/1.5))) < 1e-12);
}

TEST_CASE("The origin lies on the axis, the direction is unit and goes into the scene", "[project]")
{
    const WindowKind kind = GENERATE(from_range(parallelWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    const GlassWindow window = makeWindow(kind, random);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray(), window);
    std::vector<Vec2d> pixels;
    for (int i = 0; i < 1000; i++)
        pixels.push_back(Vec2d(random.uniform(0, 1280), random.uniform(0, 960)));
    std::vector<Vec3d> origins, directions;
    std::vector<uchar> status;
    refractiveUnprojectPoints(pixels, origins, directions, camera, status);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        if (status[i] != REFRACT_OK)
        {
            REQUIRE((kind == WATER_GLASS_AIR || kind == DOUBLE_GLAZING_IN_WATER));
            REQUIRE(status[i] == REFRACT_TOTAL_REFLECTION);
            continue;
        }
        REQUIRE(norm(origins[i].cross(window.normal)) < 1e-13*(1 + norm(origins[i])));
        REQUIRE(std::abs(norm(directions[i]) - 1) < 1e-14);
        REQUIRE(directions[i].dot(window.normal) > 0);
    }
}

TEST_CASE("float32 in, float32 out, computed in double", "[project]")
{
    std::vector<Point3f> points = { { 1, 2, 300 }, { -30, 10, 400 }, { 0.1f, 0.7f, 5000 } };
    std::vector<Vec3d> same;
    for (const Point3f& p : points)
        same.push_back(Vec3d(p.x, p.y, p.z));
    Mat out32, out64;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), K, noArray(), paper::pane(), out32);
    refractiveProjectPoints(same, Vec3d(), Vec3d(), K, noArray(), paper::pane(), out64);
    REQUIRE(out32.type() == CV_32FC2);
    REQUIRE(out64.type() == CV_64FC2);
    Mat rounded;
    out64.convertTo(rounded, CV_32F);
    CHECK(largestDifference(out32, rounded) == 0);
}

TEST_CASE("Bad pose arguments are named with their value", "[project]")
{
    const std::vector<Vec3d> points(1, Vec3d(0, 0, 100));
    const auto project = [&](InputArray rvec, InputArray tvec)
    {
        std::vector<Vec2d> out;
        return thrown([&] { refractiveProjectPoints(points, rvec, tvec, K, noArray(), paper::pane(), out); });
    };
    CHECK(project(Vec3d(), Vec3d()) == "");
    CHECK_THAT(project(Vec3d(0, NaN, 0), Vec3d()), Contains("rvec[1]") && Contains("nan"));
    CHECK_THAT(project(Vec3d(), Vec3d(0, 0, INF)), Contains("tvec[2]") && Contains("inf"));
    CHECK_THAT(project(Vec2d(1, 2), Vec3d()), Contains("rvec") && Contains("2x1"));
    CHECK_THAT(project(Vec3d(), Vec4d()), Contains("tvec") && Contains("4x1"));
    CHECK_THAT(project(Matx33d::eye()*2, Vec3d()), Contains("rvec is not a rotation"));
    CHECK_THAT(project(Matx33d(1, 0, 0, 0, 1, 0, 0, 0, -1), Vec3d()),
               Contains("rvec is not a rotation") && Contains("determinant is -1"));
}

TEST_CASE("The form with derivatives projects as the one without, also by the smallest rotations", "[project]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(900, 0, 322, 0, 905, 236, 0, 0, 1), noArray(),
                                                                  GlassWindow(Vec3d(0.1, 0.1, 1), 20, 1.5, 40));
    const std::vector<Point3d> points = { Point3d(0, 0, 1000), Point3d(100, 200, 900) };
    for (double angle : { 0., 1e-12, 1e-8, 3e-6, 1e-5, 1e-4, 1e-3, 0.1 })
    {
        std::vector<Point2d> plain, withJacobian;
        Mat status, jacobian;
        refractiveProjectPoints(points, Vec3d(angle, -angle, 0), Vec3d(1, 2, 3), camera, plain);
        refractiveProjectPoints(points, Vec3d(angle, -angle, 0), Vec3d(1, 2, 3), camera, withJacobian, status, jacobian);
        INFO("angle " << angle);
        for (size_t i = 0; i < points.size(); i++)
            CHECK(norm(plain[i] - withJacobian[i]) < 1e-11);
    }
}

TEST_CASE("A rotation vector of any length: derivatives are by it, not by the shorter one of the same rotation", "[project]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(900, 0, 640, 0, 905, 470, 0, 0, 1), noArray(),
                                                                  GlassWindow(Vec3d(0.1, 0.1, 1), 20, 1.5, 40));
    CAPTURE(seed());
    Random random;
    const std::vector<Vec3d> points = { { 100, -50, 30 }, { -80, 20, -60 }, { 10, 90, 0 } };
    for (double angle : { 0., 1e-300, 1e-16, 1e-9, 1e-6, 1e-3, 1., 3., CV_PI, 3.2, 4., 2*CV_PI - 1e-3, 2*CV_PI, 10., 100. })
        for (int trial = 0; trial < 20; trial++)
        {
            const Vec3d axis = normalize(random.vector(1)), rvec = angle*axis, tvec(10, -20, 600);
            std::vector<Vec2d> plain, pixels;
            std::vector<uchar> status;
            Mat J;
            refractiveProjectPoints(points, rvec, tvec, camera, plain);
            refractiveProjectPoints(points, rvec, tvec, camera, pixels, status, J);
            CAPTURE(angle, axis);
            REQUIRE(largestDifference(plain, pixels) < 1e-10);
            for (int k = 0; k < 3; k++)
            {
                const double STEP = 1e-4;
                const auto moved = [&](double steps)
                {
                    Vec3d r = rvec;
                    std::vector<Vec2d> out;
                    r[k] += steps*STEP;
                    refractiveProjectPoints(points, r, tvec, camera, out);
                    return Mat(out, true).reshape(1, (int)points.size()*2);
                };
                // To the fourth order in the step; what is left is rounding.
                const Mat by = (8*(moved(1) - moved(-1)) - (moved(2) - moved(-2)))/(12*STEP);
                REQUIRE(norm(by, J.col(k), NORM_INF) < 1e-8*(1 + 10*norm(by, NORM_INF)));
            }
        }
}

TEST_CASE("Points as far away as numbers go are seen where their rays lead, with derivatives", "[project]")
{
    const WindowKind kind = GENERATE(from_range(allWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    for (const LensKind& lens : allLenses())
    {
        const GlassWindow window = makeWindow(kind, random, 10);
        const Ptr<RefractiveCamera> camera = makeCamera(lens, window);
        const double side = 0.3*std::tan(std::min(lens.halfField, 60.)*CV_PI/180);
        std::vector<Vec2d> pixels;
        for (int i = 0; i < 5; i++)
            pixels.push_back(Vec2d(lens.K(0, 2) + lens.K(0, 0)*random.uniform(-side, side),
                                   lens.K(1, 2) + lens.K(1, 1)*random.uniform(-side, side)));
        std::vector<Vec3d> origins, directions, points;
        std::vector<uchar> rays, status, same;
        refractiveUnprojectPoints(pixels, origins, directions, camera, rays);
        for (double exponent : { 6., 12., 30., 60., 61., 77., 100., 154., 154.5, 155., 200., 300., 307., 308. })
        {
            points.clear();
            for (int i = 0; i < 5; i++)
                points.push_back(origins[i] + std::pow(10, exponent)*directions[i]);
            std::vector<Vec2d> seen, again;
            Mat J;
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, seen, status);
            refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, again, same, J);
            REQUIRE(same == status);
            for (int i = 0; i < 5; i++)
            {
                if (rays[i] != REFRACT_OK)
                    continue;
                CAPTURE(lens.name, exponent, pixels[i]);
                REQUIRE(status[i] == REFRACT_OK);
                REQUIRE(norm(seen[i] - pixels[i]) < 1e-8);
                REQUIRE(norm(again[i] - pixels[i]) < 1e-8);
                // A motion across the ray turns it by the motion over the distance; one along it does nothing.
                const Mat byPoint = J.rowRange(2*i, 2*i + 2).colRange(3, 6)*std::pow(10, exponent);
                REQUIRE(checkRange(J.rowRange(2*i, 2*i + 2)));
                REQUIRE(norm(byPoint*Mat(directions[i])) < 1e-5*lens.K(0, 0));
                REQUIRE(norm(byPoint) > 0.1*lens.K(0, 0));
                REQUIRE(norm(byPoint) < 100*lens.K(0, 0));
            }
        }
        // From the largest number on there is no point; and a pose that leads beyond it.
        refractiveProjectPoints(std::vector<Vec3d>{ { 1e308, 1e308, 1.7e308 }, { 0, 0, 1.7e308 }, { INF, 0, 1 } }, Vec3d(0.1, 0, 0),
                                Vec3d(0, 0, 1.7e308), camera, pixels, status);
        REQUIRE(status[1] == REFRACT_OK);
        REQUIRE(status[2] == REFRACT_NOT_FINITE);
        for (int i = 0; i < 2; i++)
            REQUIRE((status[i] == REFRACT_OK) == (bool)std::isfinite(pixels[i][0]));
    }
}

TEST_CASE("Without a length all points of a ray have one pixel, however near or far", "[project]")
{
    GlassWindow atCamera;       // water from the centre of projection on
    atCamera.normal = Vec3d(0, 0, 1);
    atCamera.outerIndex = 1.333;
    CAPTURE(seed());
    Random random;
    for (const GlassWindow& window : { GlassWindow(), atCamera })
        for (const LensKind& lens : allLenses())
        {
            const Ptr<RefractiveCamera> camera = makeCamera(lens, window);
            for (int i = 0; i < 20; i++)
            {
                const Vec3d d = randomNormal(random, 20);
                std::vector<Vec2d> expected, seen, again;
                std::vector<uchar> status;
                Mat J, unit;
                refractiveProjectPoints(std::vector<Vec3d>{ d }, Vec3d(), Vec3d(), camera, expected, status, unit);
                REQUIRE(status[0] == REFRACT_OK);
                for (int exponent : { -1000, -800, -520, -511, -300, -200, -100, 100, 200, 300, 511, 520, 1000, 1023 })
                {
                    const double scale = std::ldexp(1., exponent);
                    CAPTURE(lens.name, exponent, d);
                    refractiveProjectPoints(std::vector<Vec3d>{ scale*d }, Vec3d(), Vec3d(), camera, seen, status);
                    REQUIRE(status[0] == REFRACT_OK);
                    REQUIRE(norm(seen[0] - expected[0]) < 1e-9);
                    refractiveProjectPoints(std::vector<Vec3d>{ scale*d }, Vec3d(), Vec3d(), camera, again, status, J);
                    REQUIRE(norm(again[0] - expected[0]) < 1e-9);
                    REQUIRE(norm(J.colRange(3, 6)*scale, unit.colRange(3, 6)) < 1e-9*norm(unit.colRange(3, 6)));
                }
            }
        }
}

TEST_CASE("The jacobian against central differences of several steps", "[project]")
{
    const WindowKind kind = GENERATE(from_range(allWindows()));
    CAPTURE(name(kind), seed());
    Random random(kind);
    for (const LensKind& lens : allLenses())
    {
        GlassWindow window = makeWindow(kind, random, 10);
        // Room for the differences above index 1 and distance 0; all media denser alike: the same light paths.
        window.innerIndex *= 1.01;
        window.outerIndex *= 1.01;
        for (double& n : window.index)
            n *= 1.01;
        const bool isRound = window.shape == WINDOW_DOME || window.shape == WINDOW_TUBE;
        window.distance += kind == NO_WINDOW || isRound ? 0 : 1;
        const Ptr<RefractiveCamera> camera = makeCamera(lens, window);
        const Vec3d rvec = random.vector(0.5), tvec = random.vector(30);
        Matx33d R;
        Rodrigues(rvec, R);
        const double side = 0.3*std::tan(std::min(lens.halfField, 60.)*CV_PI/180);
        const Vec3d inCamera = random.uniform(400, 800)*Vec3d(random.uniform(-side, side), random.uniform(-side, side), 1);
        const Vec3d X = R.t()*(inCamera - tvec);
        std::vector<Vec2d> pixel;
        std::vector<uchar> status;
        Mat J;
        refractiveProjectPoints(std::vector<Vec3d>{ X }, rvec, tvec, camera, pixel, status, J);
        CAPTURE(lens.name, X);
        REQUIRE(status[0] == REFRACT_OK);
        const int lensCount = (int)camera->lensParameters().total(), layers = (int)window.thickness.size();
        const int more = window.shape == WINDOW_TUBE ? 3 : window.shape == WINDOW_BENT ? 1 : 0;
        REQUIRE(J.size() == Size(6 + lensCount + 6 + 2*layers + 2*(int)window.wedge.size() + more, 2));

        const auto moved = [&](int column, double step)
        {
            Vec3d r = rvec, t = tvec;
            Mat p = camera->lensParameters();
            std::vector<double> ofWindow = windowParameters(window);
            if (column < 3) r[column] += step;
            else if (column < 6) t[column - 3] += step;
            else if (column < 6 + lensCount) p.at<double>(column - 6) += step;
            else ofWindow[column - 6 - lensCount] += step;
            const GlassWindow w = withParameters(window, ofWindow.data());
            const Ptr<RefractiveCamera> other = makeCamera(lens, w);
            other->setLensParameters(p);
            std::vector<Vec2d> out;
            refractiveProjectPoints(std::vector<Vec3d>{ X }, r, t, other, out);
            return out[0];
        };
        const int columns = kind == NO_WINDOW ? 6 + lensCount : J.cols;
        for (int c = 0; c < columns; c++)
        {
            const Vec2d analytic(J.at<double>(0, c), J.at<double>(1, c));
            double best = INF;
            // A curvature is 1/radius: hundreds of times a parameter of usual size.
            const double unit = c == J.cols - 1 && window.shape == WINDOW_BENT ? 1e-4 : 1;
            for (double step : { 1e-3*unit, 1e-4*unit, 1e-5*unit, 1e-6*unit })
                best = std::min(best, norm((moved(c, step) - moved(c, -step))/(2*step) - analytic)*unit);
            CAPTURE(c, analytic);
            REQUIRE(best < 2e-6*(1 + 1e-2*unit*norm(analytic)));
        }
        // The normal's three columns have no part along it: its length means nothing. Nor have an axis' and what moves along it.
        const bool isTube = window.shape == WINDOW_TUBE;
        const Vec3d along = isTube ? window.axis : window.normal;
        if (kind != NO_WINDOW && window.shape != WINDOW_DOME)
            for (int r = 0; r < 2*(isTube ? 2 : 1); r++)
            {
                const Vec3d row(J.ptr<double>(r % 2) + 6 + lensCount + 3*(r/2));
                CHECK(std::abs(row.dot(along)) < 1e-11*(1 + norm(row)));
            }
    }
}

TEST_CASE("A transformed object is the object in camera coordinates", "[project]")
{
    CAPTURE(seed());
    Random random;
    for (int i = 0; i < 200; i++)
    {
        // Also at and near the half turn, where a rotation vector is hardest.
        const Vec3d rvec = i == 0 ? Vec3d() : i == 1 ? Vec3d(0, CV_PI, 0) : i == 2 ? Vec3d(0, 0, CV_PI - 1e-9)
                                    : i == 3 ? Vec3d(1e-9, -1e-10, 0) : random.vector(3);
        const Vec3d inCamera(random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(200, 900));
        const Vec3d tvec = random.vector(100);
        Matx33d R;
        Rodrigues(rvec, R);
        const Vec3d X = R.t()*(inCamera - tvec);
        std::vector<Vec2d> a, b;
        refractiveProjectPoints(std::vector<Vec3d>{ X }, rvec, tvec, K, noArray(), paper::pane(), a);
        refractiveProjectPoints(std::vector<Vec3d>{ transformed(rvec, tvec, X) }, Vec3d(), Vec3d(), K, noArray(), paper::pane(), b);
        CAPTURE(rvec);
        REQUIRE(norm(a[0] - b[0]) < 1e-9);
    }
}

TEST_CASE("A pixel that overflows is none, and has a status", "[project]")
{
    const Matx33d K(1115, 0, 453, 0, 1071, 509, 0, 0, 1);
    const std::vector<double> huge = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -2.5e307, 1e-4, 1e-3, 1e-6};
    std::vector<Point2d> pixels;
    std::vector<uchar> status;
    refractiveProjectPoints(std::vector<Point3d>{{-290, -290, 125}}, Vec3d(), Vec3d(), K, huge, GlassWindow(), pixels, status);
    CHECK(status[0] == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(std::isnan(pixels[0].x));
    CHECK(std::isnan(pixels[0].y));
}
