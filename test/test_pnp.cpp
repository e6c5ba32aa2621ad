#include "calibration_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

TEST_CASE("The pose of a perfectly seen target is exact, whatever lens and window", "[pnp]")
{
    double largest = 0;
    for (WindowKind kind : allWindows())
        for (const LensKind& lens : allLenses())
            for (bool planar : { true, false })
            {
                Random random(200 + kind);
                CAPTURE(name(kind), lens.name, planar, seed());
                const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random));
                const std::vector<Point3d> object = planar ? board() : cloud(random);
                const Vec3d rvec(0.3, -0.4, 0.2), tvec(20, -10, 600);
                Mat r, t;
                const double rms = refractiveSolvePnP(object, seen(object, rvec, tvec, camera, random, 0), camera, r, t);
                CHECK(rms < 1e-7);
                largest = std::max(largest, std::max(norm(t, Mat(tvec))/norm(tvec), norm(r, Mat(rvec))));
                CHECK(norm(t, Mat(tvec)) < 1e-6*norm(tvec));
                CHECK(norm(r, Mat(rvec)) < 1e-6);
            }
    printNumber("refractiveSolvePnP on perfect data, relative", largest, "");
}

TEST_CASE("A wide lens sees the target beyond 90 degrees", "[pnp]")
{
    Random random(210);
    const LensKind& fisheye = allLenses()[7];
    const Ptr<RefractiveCamera> camera = makeCamera(fisheye, GlassWindow());
    const std::vector<Point3d> object = board();
    const Vec3d rvec(0, 1.5, 0), tvec(500, 30, 40);
    Mat r, t;
    CHECK(refractiveSolvePnP(object, seen(object, rvec, tvec, camera, random, 0), camera, r, t) < 1e-7);
    CHECK(norm(t, Mat(tvec)) < 1e-4);
}

TEST_CASE("Noise, missing points and a guess", "[pnp]")
{
    Random random(220);
    const Ptr<RefractiveCamera> camera = paperCamera(paperWindow());
    const std::vector<Point3d> object = board();
    const Vec3d rvec(0.3, -0.4, 0.2), tvec(20, -10, 600);
    std::vector<Point2d> pixels = seen(object, rvec, tvec, camera, random, 0.1);
    Mat r, t, r2, t2;
    const double rms = refractiveSolvePnP(object, pixels, camera, r, t);
    CHECK(rms == Approx(0.1*std::sqrt(2.)).epsilon(0.25));
    CHECK(norm(t, Mat(tvec)) < 1);

    SECTION("the overload agrees")
    {
        CHECK(refractiveSolvePnP(object, pixels, camera->cameraMatrix(), camera->distCoeffs(), camera->window(), r2, t2)
              == rms);
        CHECK(largestDifference(t, t2) == 0);
    }
    SECTION("a guess leads to the same minimum")
    {
        r2 = r + 0.02;
        t2 = t + 3;
        CHECK(refractiveSolvePnP(object, pixels, camera, r2, t2, true) == Approx(rms).epsilon(1e-9));
        CHECK(largestDifference(t, t2) < 1e-5);
    }
    SECTION("points that were not seen are left out")
    {
        std::vector<Point3d> fewer(object.begin() + 4, object.end());
        std::vector<Point2d> fewerPixels(pixels.begin() + 4, pixels.end());
        refractiveSolvePnP(fewer, fewerPixels, camera, r, t);
        for (int i = 0; i < 4; i++)
            pixels[i] = Point2d(NaN, NaN);
        refractiveSolvePnP(object, pixels, camera, r2, t2);
        CHECK(largestDifference(t, t2) < 1e-6);
    }
    SECTION("three points and a guess")
    {
        const std::vector<Point3d> three = { object[0], object[5], object[25] };
        r2 = r + 0.001;
        t2 = t + 0.1;
        CHECK(refractiveSolvePnP(three, std::vector<Point2d>{ pixels[0], pixels[5], pixels[25] }, camera, r2, t2, true)
              < 1e-6);
    }
}

TEST_CASE("No pose is NaN, bad arguments are named", "[pnp]")
{
    Random random(230);
    const Ptr<RefractiveCamera> camera = paperCamera(paperWindow());
    const std::vector<Point3d> object = board();
    const std::vector<Point2d> pixels = seen(object, Vec3d(), Vec3d(0, 0, 600), camera, random, 0);
    Mat r, t;
    const auto nothing = [&](const std::vector<Point3d>& o, const std::vector<Point2d>& p)
    { return std::isnan(refractiveSolvePnP(o, p, camera, r, t)) && std::isnan(t.at<double>(2)) &&
             std::isnan(r.at<double>(0)); };

    CHECK(nothing({ object.begin(), object.begin() + 6 }, { pixels.begin(), pixels.begin() + 6 }));     // one row
    CHECK(nothing(std::vector<Point3d>(6, object[0]), std::vector<Point2d>(6, pixels[0])));
    CHECK(nothing(object, std::vector<Point2d>(object.size(), Point2d(NaN, NaN))));
    CHECK(nothing(object, std::vector<Point2d>(object.size(), Point2d(1e6, 1e6))));     // outside the lens model

    const auto why = [&](const std::vector<Point3d>& o, const std::vector<Point2d>& p)
    { return thrown([&] { refractiveSolvePnP(o, p, camera, r, t); }); };
    CHECK_THAT(why(object, { pixels[0] }), Catch::Contains("objectPoints has 30 points, imagePoints 1"));
    CHECK_THAT(why({ object[0] }, { pixels[0] }), Catch::Contains("at least 4"));
    CHECK_THAT(why({}, {}), Catch::Contains("at least 4"));
    CHECK_THAT(why(std::vector<Point3d>(30, Point3d(NaN, 0, 0)), pixels), Catch::Contains("must be finite"));
    CHECK_THAT(thrown([&] { refractiveSolvePnP(object, pixels, Ptr<RefractiveCamera>(), r, t); }),
               Catch::Contains("camera is empty"));
}
