// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// computeRefractiveEpilines: the curve of possible partners in the other raw image.
#include "quick_require.hpp"
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

double distanceTo(const Mat& line, const Vec2d& p)
{
    double least = INF;
    for (int i = 0; i < line.rows; i++)
    {
        const Vec2d a = line.at<Vec2d>(std::max(i - 1, 0)), b = line.at<Vec2d>(i), ab = b - a;
        const double length2 = ab.dot(ab), t = length2 > 0 ? std::min(1., std::max(0., (p - a).dot(ab)/length2)) : 0;
        least = std::min(least, norm(p - a - t*ab));
    }
    return least;
}

bool endsFarOut(const Mat& line)
{
    return !line.empty() && (norm(line.at<Vec2d>(0)) > 1e5 || norm(line.at<Vec2d>(line.rows - 1)) > 1e5);
}

//! Two cameras that look at the same place, each behind its own window.
struct Rig
{
    Ptr<RefractiveCamera> camera1, camera2;
    Matx33d R;
    Vec3d T;

    Rig(const LensKind& lens1, const LensKind& lens2, const GlassWindow& window1, const GlassWindow& window2, Random& random)
        : camera1(makeCamera(lens1, window1)), camera2(makeCamera(lens2, window2))
    {
        Rodrigues(Vec3d(0, -0.25, 0) + random.vector(0.05), R);
        T = -(R*(Vec3d(200, 0, -20) + random.vector(20)));     // camera 2's centre, to the right of camera 1
    }

    const Ptr<RefractiveCamera>& camera(int which) const { return which == 1 ? camera1 : camera2; }

    //! A point given in the frame of camera `which`, in the other image.
    void projectToOther(int which, const std::vector<Vec3d>& points, std::vector<Vec2d>& pixels,
                        std::vector<uchar>& status) const
    {
        const Matx33d toOther = which == 1 ? R : R.t();
        const Vec3d t = which == 1 ? T : -(R.t()*T);
        refractiveProjectPoints(points, toOther, t, camera(3 - which), pixels, status);
    }
};

std::vector<Vec2d> pixelsOf(const LensKind& lens, const Ptr<RefractiveCamera>& camera, int count, Random& random)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < count; i++)
        points.push_back(1000*randomNormal(random, std::min(25., lens.halfField)));
    std::vector<Vec2d> pixels;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), camera, pixels);
    return pixels;
}


} // namespace

TEST_CASE("The true partner lies on the curve, every window and lens, both directions", "[epilines]")
{
    CAPTURE(seed());
    Random random;
    double worst = 0, worstFine = 0;
    int partners = 0;
    for (WindowKind kind : allWindows())
        for (size_t l = 0; l < allLenses().size(); l++)
            for (int which : { 1, 2 })
            {
                const LensKind &lens = allLenses()[l], &other = allLenses()[(l + 1)%allLenses().size()];
                const Rig rig(lens, other, makeWindow(kind, random, 15), makeWindow(kind, random, 15), random);
                CAPTURE(name(kind), lens.name, which);
                const std::vector<Vec2d> pixels = pixelsOf(which == 1 ? lens : other, rig.camera(which), 10, random);
                const Vec2d range(400, random.below(2) ? INF : 3000);
                std::vector<Mat> lines, fine;
                std::vector<uchar> status;
                computeRefractiveEpilines(pixels, which, rig.camera1, rig.camera2, rig.R, rig.T, range, lines, 0.01, status);
                computeRefractiveEpilines(pixels, which, rig.camera1, rig.camera2, rig.R, rig.T, range, fine, 1e-4);
                REQUIRE(lines.size() == pixels.size());
                for (int sample = 0; sample < 100; sample++)
                {
                    const double z = 400/random.uniform(range[1] == INF ? 1e-4 : 400./3000, 1);
                    std::vector<Vec3d> points;
                    std::vector<Vec2d> truth;
                    std::vector<uchar> seen;
                    refractivePointsOnPlane(pixels, points, rig.camera(which), Vec4d(0, 0, 1, z));
                    rig.projectToOther(which, points, truth, seen);
                    for (size_t i = 0; i < pixels.size(); i++)
                    {
                        // The paper's lens has no end: a curve that runs out to 1e12 px is mostly rounding.
                        if (seen[i] != REFRACT_OK || endsFarOut(lines[i]))
                            continue;
                        QUICK_REQUIRE(status[i] == REFRACT_OK, i, z, pixels[i], truth[i]);
                        const double distance = distanceTo(lines[i], truth[i]);
                        QUICK_REQUIRE(distance <= 0.0105, i, z, pixels[i], truth[i]);
                        QUICK_REQUIRE(distanceTo(fine[i], truth[i]) <= 1.05e-4, i, z, pixels[i], truth[i]);
                        worst = std::max(worst, distance);
                        worstFine = std::max(worstFine, distanceTo(fine[i], truth[i]));
                        partners++;
                    }
                }
            }
    CHECK(partners > 50000);
    printNumber("epipolar curve, true partners " + std::to_string(partners) + ", worst distance at 0.01", worst, "px");
    printNumber("epipolar curve, worst distance at tolerance 0.0001", worstFine, "px");
}

TEST_CASE("Every vertex is the image of a point on the ray, in order of growing depth", "[epilines]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& lens = lensNamed("8 coefficients");
    const Rig rig(lens, lens, makeWindow(PANE_IN_AIR, random), makeWindow(AIR_GLASS_WATER, random), random);
    for (int which : { 1, 2 })
    {
        const std::vector<Vec2d> pixels = pixelsOf(lens, rig.camera(which), 30, random);
        std::vector<Mat> lines;
        computeRefractiveEpilines(pixels, which, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(300, 3000), lines);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            double before = 0;
            for (int k = 0; k < lines[i].rows; k++)
            {
                // The vertex's own depth, by triangulation.
                std::vector<Vec2d> here{ pixels[i] }, there{ lines[i].at<Vec2d>(k) };
                std::vector<Vec3d> X;
                triangulateRefractive(rig.camera1, rig.camera2, rig.R, rig.T, which == 1 ? here : there,
                                      which == 1 ? there : here, X);
                const double z = which == 1 ? X[0][2] : (rig.R*X[0] + rig.T)[2];
                CAPTURE(which, i, k, z, here[0], there[0], lines[i].rows);
                REQUIRE(z > before);
                REQUIRE(z > 300*(1 - 1e-6));
                REQUIRE(z < 3000*(1 + 1e-6));
                std::vector<Vec3d> onRay;
                std::vector<Vec2d> image;
                std::vector<uchar> seen;
                refractivePointsOnPlane(here, onRay, rig.camera(which), Vec4d(0, 0, 1, z));
                rig.projectToOther(which, onRay, image, seen);
                REQUIRE(norm(image[0] - there[0]) < 1e-6);
                before = z;
            }
        }
    }
}

TEST_CASE("The curve ends where the depth range ends", "[epilines]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& lens = lensNamed("8 coefficients");
    const Rig rig(lens, lens, makeWindow(LAMINATE, random), makeWindow(PANE_IN_AIR, random), random);
    const std::vector<Vec2d> pixels = { { 3004, 1997 }, { 2800, 2300 } };
    std::vector<Mat> lines;
    computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(500, 900), lines);
    REQUIRE((!lines[0].empty() && !lines[1].empty()));
    for (double z : { 500., 900. })
    {
        std::vector<Vec3d> points;
        std::vector<Vec2d> image;
        std::vector<uchar> seen;
        refractivePointsOnPlane(pixels, points, rig.camera1, Vec4d(0, 0, 1, z));
        rig.projectToOther(1, points, image, seen);
        for (size_t i = 0; i < pixels.size(); i++)
            CHECK(norm(lines[i].at<Vec2d>(z == 500 ? 0 : lines[i].rows - 1) - image[i]) < 1e-9);
    }
}

TEST_CASE("No windows, no distortion: two vertices on cv::computeCorrespondEpilines' line", "[epilines]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& lens = lensNamed("0 coefficients");
    const Rig rig(lens, lens, GlassWindow(), GlassWindow(), random);
    const Matx33d cross(0, -rig.T[2], rig.T[1], rig.T[2], 0, -rig.T[0], -rig.T[1], rig.T[0], 0);
    const Matx33d F = lens.K.inv().t()*cross*rig.R*lens.K.inv();
    for (int which : { 1, 2 })
    {
        const std::vector<Vec2d> pixels = pixelsOf(lens, rig.camera(which), 50, random);
        std::vector<Mat> lines;
        std::vector<Vec3d> straight;
        computeRefractiveEpilines(pixels, which, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(400, INF), lines);
        computeCorrespondEpilines(pixels, which, F, straight);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            REQUIRE(lines[i].rows == 2);
            for (int k = 0; k < 2; k++)
            {
                const Vec2d p = lines[i].at<Vec2d>(k);
                REQUIRE(std::abs(straight[i].dot(Vec3d(p[0], p[1], 1))) < 1e-8);
            }
        }
    }
}

TEST_CASE("Few vertices: near the least that the tolerance takes", "[epilines]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& lens = lensNamed("8 coefficients");
    const Rig rig(lens, lens, makeWindow(PANE_IN_AIR, random), makeWindow(AIR_GLASS_WATER, random), random);
    const std::vector<Vec2d> pixels = pixelsOf(lens, rig.camera1, 20, random);
    double sum = 0, sumFewest = 0;
    for (double tolerance : { 0.1, 0.01, 0.001 })
    {
        std::vector<Mat> lines, dense;
        computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(300, INF), lines, tolerance);
        computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(300, INF), dense, tolerance/1000);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            // Greedy: the longest chords of the dense curve that stay within the tolerance; no polyline on the curve needs fewer.
            int fewest = 1;
            for (int begin = 0; begin < dense[i].rows - 1; fewest++)
            {
                int end = begin + 1;
                for (bool fits = true; fits && end < dense[i].rows - 1; )
                {
                    Mat chord(2, 1, CV_64FC2);
                    chord.at<Vec2d>(0) = dense[i].at<Vec2d>(begin);
                    chord.at<Vec2d>(1) = dense[i].at<Vec2d>(end + 1);
                    for (int k = begin; k <= end && fits; k++)
                        fits = distanceTo(chord, dense[i].at<Vec2d>(k)) <= tolerance;
                    end += fits;
                }
                begin = end;
            }
            CAPTURE(tolerance, i, fewest, lines[i].rows);
            sum += lines[i].rows;
            sumFewest += fewest;
            CHECK(lines[i].rows <= 1.5*fewest + 2);
        }
    }
    printNumber("epipolar curve, vertices against the fewest possible", sum/sumFewest, "");
}

TEST_CASE("Parts without an image are left out", "[epilines]")
{
    // Camera 2 sees only a cone; the ray of camera 1 enters it and may leave it.
    const Ptr<RefractiveCamera> camera1 = RefractiveCamera::create(PLAIN_K, noArray());
    const Ptr<RefractiveCamera> camera2 = RefractiveCamera::create(PLAIN_K, std::vector<double>{ -0.5, 0, 0, 0 });
    const Vec2d pixel(700, 330);
    std::vector<Vec3d> ray, origin;
    refractiveUnprojectPoints(std::vector<Vec2d>{ pixel }, origin, ray, camera1);
    for (double degrees : { 0., 20., 45., 60., 75. })
        for (double near : { 100., 10., 1., 0.1, 1e-3 })
        {
            Matx33d R;
            Rodrigues(Vec3d(0, degrees*CV_PI/180, 0), R);
            const Vec3d T = -(R*Vec3d(150, 0, 0));
            std::vector<Mat> lines;
            std::vector<uchar> status;
            computeRefractiveEpilines(std::vector<Vec2d>{ pixel }, 1, camera1, camera2, R, T, Vec2d(near, INF), lines, 0.01,
                                      status);
            double first = INF, last = 0, worst = 0;
            int seenCount = 0;
            for (int i = 0; i <= 4000; i++)
            {
                const double z = near*std::pow(1e6/near, i/4000.);
                std::vector<Vec2d> image;
                std::vector<uchar> seen;
                refractiveProjectPoints(std::vector<Vec3d>{ z/ray[0][2]*ray[0] }, R, T, camera2, image, seen);
                if (seen[0] != REFRACT_OK)
                    continue;
                seenCount++;
                first = std::min(first, z);
                last = std::max(last, z);
                worst = std::max(worst, distanceTo(lines[0], image[0]));
            }
            CAPTURE(degrees, near, first, last);
            CHECK(worst <= 0.0105);
            CHECK((status[0] == REFRACT_OK) == (seenCount > 0));
            CHECK(lines[0].empty() == (seenCount == 0));
        }
}

TEST_CASE("A point without partners gives an empty line and a status", "[epilines]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, std::vector<double>{ -0.3, 0, 0, 0 },
                                                                  GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 50));
    const std::vector<Vec2d> pixels = { { 640, 480 }, { NaN, 480 }, { 1e6, 480 } };
    std::vector<Mat> lines;
    std::vector<uchar> status;
    computeRefractiveEpilines(pixels, 1, camera, camera, Matx33d::eye(), Vec3d(-100, 0, 0), Vec2d(300, 900), lines, 0.01, status);
    CHECK(status[0] == REFRACT_OK);
    CHECK(lines[0].rows >= 2);
    CHECK(status[1] == REFRACT_NOT_FINITE);
    CHECK(status[2] == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK((lines[1].empty() && lines[2].empty()));

    // Camera 2 looks the other way.
    computeRefractiveEpilines(pixels, 1, camera, camera, Matx33d(-1, 0, 0, 0, 1, 0, 0, 0, -1), Vec3d(-100, 0, 0), Vec2d(300, 900),
                              lines, 0.01, status);
    CHECK(status[0] != REFRACT_OK);
    CHECK(lines[0].empty());
    // The whole depth range lies within the window.
    computeRefractiveEpilines(pixels, 1, camera, camera, Matx33d::eye(), Vec3d(-100, 0, 0), Vec2d(10, 60), lines, 0.01, status);
    CHECK(status[0] == REFRACT_BEHIND_WINDOW);
    CHECK(lines[0].empty());
    // A range that begins within the window begins behind it.
    computeRefractiveEpilines(pixels, 1, camera, camera, Matx33d::eye(), Vec3d(-100, 0, 0), Vec2d(10, 900), lines, 0.01, status);
    CHECK(status[0] == REFRACT_OK);
    CHECK(lines[0].rows >= 2);
    // The epipole: the ray passes through the other camera's centre; its image is one point.
    computeRefractiveEpilines(std::vector<Vec2d>{ { 640, 480 } }, 1, RefractiveCamera::create(PLAIN_K, noArray()),
                              RefractiveCamera::create(PLAIN_K, noArray()), Matx33d::eye(), Vec3d(0, 0, -100), Vec2d(200, 900), lines,
                              0.01, status);
    CHECK(status[0] == REFRACT_OK);
    for (int i = 0; i < lines[0].rows; i++)
        CHECK(norm(lines[0].at<Vec2d>(i) - Vec2d(640, 480)) < 1e-9);
}

TEST_CASE("Both overloads of computeRefractiveEpilines agree, float32 as well", "[epilines]")
{
    const GlassWindow window(Vec3d(0.2, 0.1, 1), 20, 1.5, 50);
    const std::vector<Point2f> pixels = { { 640, 480 }, { 300, 200 } };
    const std::vector<double> D = { -0.3, 0.1, 0, 0 };
    const Vec3d rvec(0, -0.2, 0), T(-100, 0, 0);
    std::vector<Mat> a, b;
    std::vector<std::vector<Point2f>> c;
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, D, window);
    computeRefractiveEpilines(pixels, 2, PLAIN_K, D, window, PLAIN_K, D, window, rvec, T, Vec2d(300, INF), a);
    computeRefractiveEpilines(pixels, 2, camera, camera, rvec, T, Vec2d(300, INF), b);
    computeRefractiveEpilines(pixels, 2, camera, camera, rvec, T, Vec2d(300, INF), c);
    REQUIRE(a.size() == 2);
    for (int i = 0; i < 2; i++)
    {
        CHECK(a[i].type() == CV_32FC2);
        CHECK(a[i].cols == 1);
        CHECK(largestDifference(a[i], b[i]) == 0);
        CHECK(largestDifference(a[i], c[i]) == 0);
    }
}

TEST_CASE("A short visible part of a long curve is found", "[epilines]")
{
    // A lens that sees two degrees, turned to any part of a ray that fills a quarter of a turn.
    const Ptr<RefractiveCamera> from = RefractiveCamera::create(PLAIN_K, noArray());
    const Ptr<RefractiveCamera> to = RefractiveCamera::create(PLAIN_K, std::vector<double>({ -1000, 0, 0, 0 }));
    for (double turn = 5; turn < 85; turn += 0.37)
    {
        const double c = std::cos(turn*CV_PI/180), s = std::sin(turn*CV_PI/180);
        const Matx33d R(c, 0, s, 0, 1, 0, -s, 0, c);     // the direction `turn` to the left is ahead
        const Vec3d T = R*Vec3d(-200, 0, 0);
        std::vector<Mat> lines;
        std::vector<uchar> status;
        computeRefractiveEpilines(std::vector<Vec2d>(1, Vec2d(640, 480)), 1, from, to, R, T, Vec2d(1, INF), lines, 0.01, status);
        CAPTURE(turn);
        REQUIRE(status[0] == REFRACT_OK);
        CHECK(lines[0].total() >= 2);
    }
}

TEST_CASE("A line that takes too many points is empty", "[epilines]")
{
    Random random(1900);
    const LensKind& lens = lensNamed("the paper's");
    const Rig rig(lens, lens, makeWindow(AIR_GLASS_WATER, random), makeWindow(AIR_GLASS_WATER, random), random);
    const std::vector<Vec2d> pixels(3, Vec2d(640, 480));
    std::vector<Mat> lines;
    std::vector<uchar> status;
    computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(400, 4000), lines, 1e-13, status);
    for (int i = 0; i < 3; i++)
    {
        CHECK(status[i] == REFRACT_NOT_CONVERGED);
        CHECK(lines[i].empty());
    }
    computeRefractiveEpilines(pixels, 1, rig.camera1, rig.camera2, rig.R, rig.T, Vec2d(400, 4000), lines, 1e-4, status);
    for (int i = 0; i < 3; i++)
    {
        CHECK(status[i] == REFRACT_OK);
        CHECK(lines[i].total() >= 2);
    }
}

TEST_CASE("Bad arguments of computeRefractiveEpilines are named", "[epilines]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray());
    const auto compute = [&](int which, const Vec2d& range, double tolerance, InputArray R, InputArray T)
    {
        std::vector<Mat> lines;
        return thrown([&] { computeRefractiveEpilines(std::vector<Vec2d>(1), which, camera, camera, R, T, range, lines, tolerance); });
    };
    const Matx33d R = Matx33d::eye();
    const Vec3d T(-1, 0, 0);
    CHECK(compute(1, Vec2d(1, 2), 0.01, R, T) == "");
    CHECK_THAT(compute(0, Vec2d(1, 2), 0.01, R, T), Contains("whichImage") && Contains("0"));
    CHECK_THAT(compute(3, Vec2d(1, 2), 0.01, R, T), Contains("whichImage") && Contains("3"));
    CHECK_THAT(compute(1, Vec2d(2, 1), 0.01, R, T), Contains("depthRange") && Contains("(2, 1)"));
    CHECK_THAT(compute(1, Vec2d(-2, 1), 0.01, R, T), Contains("depthRange") && Contains("(-2, 1)"));
    CHECK_THAT(compute(1, Vec2d(NaN, 1), 0.01, R, T), Contains("depthRange") && Contains("nan"));
    CHECK_THAT(compute(1, Vec2d(INF, INF), 0.01, R, T), Contains("depthRange") && Contains("inf"));
    CHECK_THAT(compute(1, Vec2d(1, 2), 0, R, T), Contains("tolerance") && Contains("0"));
    CHECK_THAT(compute(1, Vec2d(1, 2), NaN, R, T), Contains("tolerance") && Contains("nan"));
    CHECK_THAT(compute(1, Vec2d(1, 2), 0.01, R*2, T), Contains("R is not a rotation"));
    CHECK_THAT(compute(1, Vec2d(1, 2), 0.01, R, Vec2d()), Contains("T is 2x1"));
}
