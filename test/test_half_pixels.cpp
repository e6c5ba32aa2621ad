// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Pixels of which one coordinate is known, and covariances of pixels: triangulation and poses. A sheet of light is what one image line
// of its emitter sees.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <functional>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

typedef std::vector<Ptr<RefractiveCamera> > Cameras;

//! A camera and emitters beside it, what they see of points, and which coordinates of it are known.
struct SheetRig
{
    Cameras cameras;
    std::vector<Mat> Rs;
    std::vector<Vec3d> Ts;
    std::vector<Vec3d> points;
    std::vector<std::vector<Vec2d> > pixels;

    void add(const Ptr<RefractiveCamera>& camera, const Vec3d& rvec = Vec3d(), const Vec3d& T = Vec3d())
    {
        Mat R;
        Rodrigues(rvec, R);
        cameras.push_back(camera);
        Rs.push_back(R);
        Ts.push_back(T);
    }
    //! Projects exactly, and leaves out points without an image.
    void look(const std::vector<Vec3d>& all)
    {
        pixels.assign(cameras.size(), {});
        std::vector<std::vector<Vec2d> > seen(cameras.size());
        std::vector<uchar> good(all.size(), 1), status;
        for (size_t c = 0; c < cameras.size(); c++)
        {
            refractiveProjectPoints(all, Rs[c], Ts[c], cameras[c], seen[c], status);
            for (size_t i = 0; i < all.size(); i++)
                good[i] = good[i] && status[i] == REFRACT_OK && norm(seen[c][i] - Vec2d(640, 512)) < 1500;
        }
        for (size_t i = 0; i < all.size(); i++)
            for (size_t c = 0; c < cameras.size() && good[i]; c++)
                pixels[c].push_back(seen[c][i]);
        points.clear();
        for (size_t i = 0; i < all.size(); i++)
            if (good[i])
                points.push_back(all[i]);
    }
    void forget(int camera, int coordinate)
    {
        for (Vec2d& pixel : pixels[camera])
            pixel[coordinate] = NaN;
    }
    void noise(Random& random, double sigma)
    {
        for (std::vector<Vec2d>& all : pixels)
            for (Vec2d& pixel : all)
                pixel += Vec2d(random.normal(sigma), random.normal(sigma));
    }
    void triangulate(std::vector<Vec3d>& found, std::vector<uchar>& status, int flags = 0) const
    { triangulateRefractive(cameras, Rs, Ts, pixels, found, status, flags); }
};

std::vector<Vec3d> somewhere(Random& random, int count)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < count; i++)
        points.push_back(Vec3d(random.uniform(-80, 80), random.uniform(-60, 60), random.uniform(550, 850)));
    return points;
}

Ptr<RefractiveCamera> emitter(const GlassWindow& window = GlassWindow())
{
    return RefractiveCamera::create(Matx33d(1500, 0, 640, 0, 1500, 512, 0, 0, 1), noArray(), window);
}

const Vec3d BESIDE(0.02, -0.35, 0.01), AWAY(230, 5, 20);     // where the emitter is

SheetRig laserRig(const GlassWindow& cameras, const GlassWindow& emitters)
{
    SheetRig rig;
    rig.add(makeCamera(lensNamed("the paper's"), cameras));
    rig.add(emitter(emitters), BESIDE, AWAY);
    return rig;
}

GlassWindow tilted(double x, double y, double outer = 1)
{
    return GlassWindow(Vec3d(x, y, 1), 20, 1.5437, 60, outer);
}

double worstDistance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b)
{
    REQUIRE(a.size() == b.size());
    double worst = 0;
    for (size_t i = 0; i < a.size(); i++)
        worst = std::max(worst, norm(a[i] - b[i]));
    return worst;
}

} // namespace

TEST_CASE("A camera and a sheet, each behind its own tilted window, meet in the point", "[half_pixels][triangulate]")
{
    Random random(2901);
    double worst = 0;
    int count = 0;
    for (double outer : { 1., 1.333 })
        for (int coordinate : { 0, 1 })
            for (int halfOf : { 0, 1 })
            {
                SheetRig rig = laserRig(tilted(-0.2, 0.1, outer), tilted(0.15, -0.25, outer));
                if (coordinate == 0)            // sheets of one v: the emitter stands above
                    rig.Rs[1] = Mat(Matx33d::eye()), rig.Ts[1] = Vec3d(10, 230, 5);
                rig.look(somewhere(random, 500));
                REQUIRE(rig.points.size() > 300);
                rig.forget(halfOf, coordinate);
                std::vector<Vec3d> found;
                std::vector<uchar> status;
                rig.triangulate(found, status);
                CAPTURE(outer, coordinate, halfOf);
                CHECK(countNonZero(status) == 0);
                worst = std::max(worst, worstDistance(found, rig.points));
                count += (int)rig.points.size();
            }
    CHECK(worst < 1e-9);
    printNumber("camera and sheet behind tilted windows, " + std::to_string(count) + " points, farthest from the truth", worst, "mm");
}

TEST_CASE("Sheets of every window and lens, of any number of emitters", "[half_pixels][triangulate]")
{
    Random random(2902);
    for (int kind = 0; kind < WINDOW_KINDS; kind++)
        for (int halves : { 1, 2, 3 })
        {
            const GlassWindow window = makeWindow((WindowKind)kind, random, 15);
            SheetRig rig;
            for (const Vec3d& rvec : { Vec3d(), Vec3d(0, -0.3, 0), Vec3d(0.3, 0.02, 0.1) })
            {
                Mat R;
                Rodrigues(rvec, R);
                const Vec3d centre(0, 0, 700);
                rig.add(emitter(window), rvec, centre - Vec3d(Mat(R*Mat(centre))));
            }
            rig.look(somewhere(random, 100));
            CAPTURE(name((WindowKind)kind), halves);
            REQUIRE(rig.points.size() > 30);
            // v of the second and u of the third are unknown, so that planes of all directions are there.
            if (halves >= 1)
                rig.forget(1, 1);
            if (halves >= 2)
                rig.forget(2, 0);
            if (halves >= 3)
                rig.forget(0, 0);
            std::vector<Vec3d> found;
            std::vector<uchar> status;
            rig.triangulate(found, status);
            CHECK(countNonZero(status) == 0);
            CHECK(worstDistance(found, rig.points) < 1e-8);
        }
}

TEST_CASE("What half a pixel tells is the likeliest point of all three coordinates", "[half_pixels][triangulate]")
{
    Random random(2903);
    SheetRig rig = laserRig(tilted(-0.2, 0.1), tilted(0.15, -0.25));
    rig.add(emitter(tilted(0.1, 0.1)), Vec3d(0.2, 0.3, 0), Vec3d(-210, 120, 60));
    rig.look(somewhere(random, 200));
    rig.noise(random, 0.3);
    rig.forget(1, 1);
    std::vector<Vec3d> found;
    std::vector<uchar> status;
    rig.triangulate(found, status);
    REQUIRE(countNonZero(status) == 0);
    const auto cost = [&](size_t i, const Vec3d& X)
    {
        double sum = 0;
        for (size_t c = 0; c < 3; c++)
        {
            std::vector<Vec2d> pixel;
            refractiveProjectPoints(std::vector<Vec3d>(1, X), rig.Rs[c], rig.Ts[c], rig.cameras[c], pixel);
            for (int k = 0; k < 2; k++)
                if (!std::isnan(rig.pixels[c][i][k]))
                    sum += std::pow(pixel[0][k] - rig.pixels[c][i][k], 2);
        }
        return sum;
    };
    for (size_t i = 0; i < found.size(); i += 20)
        for (int k = 0; k < 6; k++)
        {
            Vec3d step;
            step[k/2] = k % 2 ? 1e-3 : -1e-3;
            CHECK(cost(i, found[i]) < cost(i, found[i] + step));
        }
}

TEST_CASE("Whole pixels give the same bits beside halves, and whatever their common covariance", "[half_pixels][triangulate]")
{
    Random random(2904);
    SheetRig rig = laserRig(tilted(-0.2, 0.1), tilted(0.15, -0.25));
    rig.look(somewhere(random, 150));
    rig.noise(random, 0.3);
    std::vector<Vec3d> whole, mixed, weighed;
    std::vector<uchar> status;
    rig.triangulate(whole, status);
    SheetRig some = rig;
    for (size_t i = 0; i < some.points.size(); i += 3)
        some.pixels[1][i][1] = NaN;
    some.triangulate(mixed, status);
    for (size_t i = 0; i < whole.size(); i++)
        if (i % 3)
            CHECK(norm(whole[i] - mixed[i]) < 1e-10);
    Mat covariance, plain, weighedCovariance, errors;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, whole, status, 0, 0.3, noArray(), plain);
    const std::vector<Mat> covariances(2, Mat((int)whole.size(), 1, CV_64FC3, Scalar(0.09, 0, 0.09)));
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, weighed, status, 0, 1, noArray(), weighedCovariance, errors,
                          covariances);
    CHECK(worstDistance(whole, weighed) < 1e-9);
    CHECK(norm(plain, weighedCovariance, NORM_INF) < 1e-8*norm(plain, NORM_INF));
}

TEST_CASE("The covariance of points from halves and weighted pixels is true", "[half_pixels][triangulate]")
{
    Random random(2905);
    const double SIGMA = 0.2;
    SheetRig exact = laserRig(tilted(-0.2, 0.1, 1.333), tilted(0.15, -0.25, 1.333));
    exact.look(somewhere(random, 12000));
    const int count = (int)exact.points.size();
    for (bool isWeighted : { false, true })
        for (bool hasThird : { false, true })
        {
            SheetRig rig = exact;
            if (hasThird)
                rig.add(emitter(tilted(0.1, 0.1, 1.333)), Vec3d(0.2, 0.3, 0), Vec3d(-210, 120, 60));
            rig.look(exact.points);
            std::vector<Mat> covariances;
            for (std::vector<Vec2d>& pixels : rig.pixels)
            {
                Mat C((int)pixels.size(), 4, CV_64F);
                for (size_t i = 0; i < pixels.size(); i++)
                {
                    // L L^T
                    const double a = isWeighted ? random.uniform(0.3, 3) : 1, b = isWeighted ? random.uniform(-1, 1) : 0;
                    const double c = isWeighted ? random.uniform(0.3, 3) : 1;
                    const double x = random.normal(SIGMA), y = random.normal(SIGMA);
                    pixels[i] += Vec2d(a*x, b*x + c*y);
                    const double values[] = { a*a, a*b, a*b, b*b + c*c };
                    std::copy(values, values + 4, C.ptr<double>((int)i));
                }
                covariances.push_back(C);
            }
            rig.forget(1, 1);
            std::vector<Vec3d> found;
            std::vector<uchar> status;
            Mat covariance;
            triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, found, status, 0, SIGMA, noArray(), covariance, noArray(),
                                  isWeighted ? covariances : std::vector<Mat>());
            REQUIRE(countNonZero(status) == 0);
            double sum = 0;
            for (int i = 0; i < (int)found.size(); i++)
            {
                const Vec3d error = found[i] - rig.points[i];
                const Matx33d C(covariance.ptr<double>(i));
                sum += (error.t()*C.inv(DECOMP_CHOLESKY)*error)(0);
            }
            const double ratio = sum/(3.*found.size());
            CAPTURE(isWeighted, hasThird, count, seed());
            CHECK(ratio > 0.97);
            CHECK(ratio < 1.03);
            printNumber(std::string("points from a camera and a sheet") + (hasThird ? " and a camera" : "") +
                        (isWeighted ? ", weighted" : "") + ", mean chi-square over 3", ratio, "");
        }
}

TEST_CASE("Half a pixel carries the calibration's covariance", "[half_pixels][triangulate]")
{
    // Of a parameter alone: the point's motion by it, found by differences.
    Random random(2906);
    SheetRig rig = laserRig(tilted(-0.2, 0.1), tilted(0.15, -0.25));
    rig.look(somewhere(random, 20));
    rig.forget(1, 1);
    int parameters = 6;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        parameters += (int)camera->parameterNames().size();
    Mat calibration = Mat::zeros(parameters, parameters, CV_64F);
    const double SIGMA = 0.05;
    calibration.at<double>(parameters - 3, parameters - 3) = SIGMA*SIGMA;       // x of T
    std::vector<Vec3d> found, moved;
    std::vector<uchar> status;
    Mat covariance;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, found, status, 0, 0, calibration, covariance);
    rig.Ts[1][0] += 1e-4;
    rig.triangulate(moved, status);
    for (size_t i = 0; i < found.size(); i++)
    {
        const Vec3d by = (moved[i] - found[i])*(SIGMA/1e-4);
        const Matx33d C(covariance.ptr<double>((int)i));
        CHECK(norm(C - Matx33d(by*by.t())) < 1e-4*norm(C));
    }
}

TEST_CASE("What halves do not determine is no answer", "[half_pixels][triangulate]")
{
    SheetRig rig;
    rig.add(emitter());
    rig.add(emitter(), Vec3d(), Vec3d(0, 200, 0));      // stands above: sheets of one u have camera 1 in them
    rig.look({ Vec3d(20, 30, 600), Vec3d(-50, 10, 700) });
    rig.forget(1, 1);
    std::vector<Vec3d> found;
    std::vector<uchar> status;
    SECTION("a camera's ray in the sheet")
    {
        rig.triangulate(found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_PARALLEL_RAYS));
        CHECK(std::isnan(found[0][0]));
    }
    SECTION("nearly in it: the covariance shows the weak direction")
    {
        double before = 0;
        for (double x : { 100., 10., 1., 0.1 })
        {
            rig.Ts[1] = Vec3d(x, 200, 0);
            rig.look({ Vec3d(20, 30, 600) });
            rig.forget(1, 1);
            Mat covariance;
            triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, found, status, 0, 0.1, noArray(), covariance);
            CHECK(status[0] == REFRACT_OK);
            const double depth = std::sqrt(covariance.at<double>(0, 8));
            CHECK(depth > 8*before);
            before = depth;
        }
        CHECK(before > 100);
    }
    SECTION("behind windows: the sheet through both normals is a plane")
    {
        for (Ptr<RefractiveCamera>& camera : rig.cameras)
            camera = emitter(GlassWindow(Vec3d(0, 0.2, 1), 20, 1.5, 50, 1.333));
        rig.look({ Vec3d(0, 30, 600), Vec3d(0, 10, 700) });
        rig.forget(1, 1);
        rig.triangulate(found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_PARALLEL_RAYS));
    }
    SECTION("fewer than three coordinates")
    {
        rig.forget(0, 1);
        rig.triangulate(found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_TOO_FEW_VIEWS));
        rig.forget(0, 0);
        rig.triangulate(found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_TOO_FEW_VIEWS));
        rig.forget(1, 0);
        rig.triangulate(found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_TOO_FEW_VIEWS));
    }
    SECTION("the midpoint of rays has no use for half a ray")
    {
        rig.triangulate(found, status, TRIANGULATE_MIDPOINT);
        CHECK(status == std::vector<uchar>(2, REFRACT_TOO_FEW_VIEWS));
    }
    SECTION("one infinite coordinate is bad, not missing")
    {
        rig.pixels[1][0][1] = INF;
        rig.triangulate(found, status);
        CHECK(status[0] == REFRACT_NOT_FINITE);
    }
    SECTION("two planes and nothing else of three emitters in a row")
    {
        rig = SheetRig();
        for (double x : { 0., 100., 200. })
            rig.add(emitter(), Vec3d(), Vec3d(x, 0, 0));
        rig.look({ Vec3d(20, 30, 600) });
        for (int c = 0; c < 3; c++)
            rig.forget(c, 1);
        rig.triangulate(found, status);
        CHECK(status[0] == REFRACT_PARALLEL_RAYS);
    }
    SECTION("two cameras alone take a NaN coordinate for none")
    {
        triangulateRefractive(rig.cameras[0], rig.cameras[1], rig.Rs[1], rig.Ts[1], rig.pixels[0], rig.pixels[1], found, status);
        CHECK(status == std::vector<uchar>(2, REFRACT_NOT_FINITE));
    }
}

TEST_CASE("An emitter behind its window: a point before the window is no answer", "[half_pixels][triangulate]")
{
    // A camera without a window sees a place between the emitter and its window.
    SheetRig rig;
    rig.add(emitter());
    rig.add(emitter(GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 900)), Vec3d(), Vec3d(200, 0, 0));
    const Vec3d X(20, 30, 600);
    const std::vector<Vec2d> pixels = { Vec2d(640 + 1500*X[0]/X[2], 512 + 1500*X[1]/X[2]) };
    rig.pixels = { pixels, { Vec2d(640 + 1500*(X[0] + 200)/X[2], NaN) } };
    std::vector<Vec3d> found;
    std::vector<uchar> status;
    rig.triangulate(found, status);
    CHECK(status[0] != REFRACT_OK);
    CHECK(std::isnan(found[0][0]));
}

TEST_CASE("Covariances of pixels come in any usual form, and bad ones are refused by name", "[half_pixels][arrays]")
{
    Random random(2907);
    SheetRig rig = laserRig(tilted(-0.2, 0.1), tilted(0.15, -0.25));
    rig.look(somewhere(random, 3));
    rig.noise(random, 0.5);
    const int N = (int)rig.points.size();
    REQUIRE(N > 1);
    rig.pixels[1][0][1] = NaN;
    const auto run = [&](const std::vector<Mat>& covariances)
    {
        std::vector<Vec3d> found;
        triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, found, noArray(), 0, 1, noArray(), noArray(), noArray(),
                              covariances);
        return found;
    };
    Mat four(N, 4, CV_64F), three(N, 3, CV_64F);
    for (int i = 0; i < N; i++)
    {
        const double uu = 1 + i, uv = 0.25, vv = 0.5 + i, both[] = { uu, uv, uv, vv }, half[] = { uu, uv, vv };
        std::copy(both, both + 4, four.ptr<double>(i));
        std::copy(half, half + 3, three.ptr<double>(i));
    }
    Mat single;
    four.convertTo(single, CV_32F);
    const int sizes[] = { N, 2, 2 };
    const std::vector<Vec3d> expected = run({ Mat(), four });
    CHECK(worstDistance(expected, run({ Mat(), Mat() })) > 1e-3);
    for (const Mat& form : { three, three.reshape(3), four.reshape(4), four.reshape(2), four.reshape(1, 3, sizes), single })
        CHECK(worstDistance(expected, run({ Mat(), form })) < 1e-9);
    const auto why = [&](std::function<void(Mat&)> spoil)
    {
        Mat bad = four.clone();
        spoil(bad);
        try { run({ Mat(), bad }); }
        catch (const Exception& e) { return std::string(e.what()); }
        return std::string("no exception");
    };
    CHECK_THAT(why([](Mat& m) { m.at<double>(1, 0) = -1; }), Contains("pixelCovariances[1] has (-1, 0.25, 1.5) as uu, uv, vv of pixel 1"));
    CHECK_THAT(why([](Mat& m) { m.at<double>(1, 1) = 5; }), Contains("positive definite"));
    CHECK_THAT(why([](Mat& m) { m.at<double>(1, 0) = NaN; }), Contains("pixelCovariances[1]"));
    CHECK_THAT(why([](Mat& m) { m = m.rowRange(0, 1); }), Contains("it must be Nx4"));
    CHECK_THAT(why([](Mat& m) { m.convertTo(m, CV_32S); }), Contains("float32 or float64"));
    four.at<double>(0, 3) = NaN;           // of the coordinate that is not known
    four.at<double>(0, 1) = NaN;
    CHECK(worstDistance(expected, run({ Mat(), four })) < 1e-9);
    try { run({ four }); FAIL("accepted"); }
    catch (const Exception& e) { CHECK_THAT(e.what(), Contains("pixelCovariances has 1 elements; cameras has 2")); }
}

namespace {

struct PoseScene
{
    explicit PoseScene(Random& random, double sigma = 0) : camera(makeCamera(lensNamed("the paper's"), tilted(-0.2, 0.1)))
    {
        for (int i = 0; i < 40; i++)
            object.push_back(random.vector(90));
        rvec = random.vector(0.4);
        tvec = Vec3d(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(560, 660));
        std::vector<uchar> status;
        refractiveProjectPoints(object, rvec, tvec, camera, pixels, status);
        REQUIRE(countNonZero(status) == 0);
        for (Vec2d& pixel : pixels)
            pixel += Vec2d(random.normal(sigma), random.normal(sigma));
    }
    Ptr<RefractiveCamera> camera;
    std::vector<Vec3d> object;
    std::vector<Vec2d> pixels;
    Vec3d rvec, tvec;
};

} // namespace

TEST_CASE("A pose from whole and half pixels", "[half_pixels][pnp]")
{
    Random random(2910);
    PoseScene scene(random);
    for (size_t i = 0; i < scene.pixels.size(); i++)
        if (i % 5)
            scene.pixels[i][i % 2] = NaN;
    Vec3d rvec, tvec;
    std::vector<double> error;
    REQUIRE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec, false, error));
    CHECK(norm(rvec - scene.rvec) < 1e-9);
    CHECK(norm(tvec - scene.tvec) < 1e-6);
    CHECK(error[0] < 1e-8);
    for (size_t i = 0; i < scene.pixels.size(); i++)
        scene.pixels[i][1] = NaN;               // a line camera that sees u
    rvec = scene.rvec + Vec3d(0.05, -0.03, 0.04);
    tvec = scene.tvec + Vec3d(9, -7, 12);
    CHECK_FALSE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec));
    REQUIRE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec, true));
    CHECK(norm(rvec - scene.rvec) < 1e-6);
    CHECK(norm(tvec - scene.tvec) < 1e-2);      // lens and window tell its motion along v, hardly
    scene.pixels.resize(5);                     // five coordinates
    scene.object.resize(5);
    CHECK_FALSE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec, true));
    for (Vec2d& pixel : scene.pixels)
        pixel = Vec2d(NaN, NaN);
    CHECK_FALSE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec, true));
}

TEST_CASE("The covariance of a pose from halves and weighted pixels is true", "[half_pixels][pnp]")
{
    const double SIGMA = 0.1;
    Random random(2911);
    const PoseScene exact(random);
    for (double given : { SIGMA, 0. })
    {
        double sum = 0;
        const int count = trials(4000);
        for (int trial = 0; trial < count; trial++)
        {
            PoseScene scene = exact;
            Mat covariances(40, 3, CV_64F);
            for (int i = 0; i < 40; i++)
            {
                const double a = random.uniform(0.5, 2), b = random.uniform(-1, 1), c = random.uniform(0.5, 2);
                const double x = random.normal(SIGMA), y = random.normal(SIGMA);
                scene.pixels[i] += Vec2d(a*x, b*x + c*y);
                const double values[] = { a*a, a*b, b*b + c*c };
                std::copy(values, values + 3, covariances.ptr<double>(i));
                if (i % 2)
                    scene.pixels[i][i/2 % 2] = NaN;
            }
            Vec3d rvec, tvec;
            Mat covariance;
            REQUIRE(refractiveSolvePnP(scene.object, scene.pixels, scene.camera, rvec, tvec, false, noArray(), covariance, given, noArray(),
                                       covariances));
            const Vec3d r = rvec - scene.rvec, t = tvec - scene.tvec;
            const Vec6d error(r[0], r[1], r[2], t[0], t[1], t[2]);
            sum += (error.t()*Matx66d(covariance.ptr<double>()).inv(DECOMP_CHOLESKY)*error)(0)/6;
        }
        // Estimated from n residuals, its mean is that of Fisher's F: n/(n - 2).
        const double freedom = 60 - 6, ratio = sum/count*(given > 0 ? 1 : (freedom - 2)/freedom);
        CAPTURE(given, seed());
        CHECK(ratio > 0.97);
        CHECK(ratio < 1.03);
        printNumber(std::string("pose from halves and weighted pixels, mean chi-square over 6, sigma ") +
                    (given > 0 ? "given" : "estimated"), ratio, "");
    }
}

TEST_CASE("Calls for whole pixels take a half for not seen", "[half_pixels][pnp]")
{
    Random random(2912);
    PoseScene scene(random);
    for (size_t i = 0; i < 10; i++)
        scene.pixels[i] = Vec2d(NaN, 1e4);      // would spoil any pose
    Vec3d rvec, tvec;
    std::vector<int> inliers;
    REQUIRE(refractiveSolvePnPRansac(scene.object, scene.pixels, scene.camera, rvec, tvec, false, 100, 8.f, 0.99, inliers));
    CHECK(inliers.size() == 30);
    CHECK(norm(tvec - scene.tvec) < 1e-6);
}
