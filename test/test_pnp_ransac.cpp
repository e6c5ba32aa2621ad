// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"
#include "pose/generalized_p3p.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! A camera and a target of which some pixels are wrong.
struct WrongMatches
{
    std::vector<Point3d> object;
    std::vector<Point2d> pixels, perfect;
    std::vector<int> right;
    Vec3d rvec, tvec;
};

enum Wrongness { RANDOM, SHIFTED };

struct Camera3
{
    const char* name;
    Ptr<RefractiveCamera> camera;
};

//! Cameras whose rays are ever less central.
std::vector<Camera3> ransacCameras()
{
    GlassWindow near({ -0.1, 0.05, 1 }, 20, 1.49, 15, 1.333), far({ 0.3, 0.1, 1 }, 40, 1.49, 250, 1.333), thick = paper::pane();
    thick.normal = normalize(Vec3d(0.5, -0.2, 1));
    thick.thickness[0] = 100;
    return { { "no window", paperCamera(GlassWindow()) }, { "pane in air", paperCamera(paper::pane()) },
             { "100 mm of glass, tilted by 28 degrees", paperCamera(thick) }, { "housing in water", paperCamera(near) },
             { "wall far off, water behind it", paperCamera(far) } };
}

//! count points in front of the camera, wrong of them with other pixels.
WrongMatches wrongMatches(const Ptr<RefractiveCamera>& camera, Random& random, int count, int wrong, bool planar, Wrongness how,
                          double sigma = 0.2)
{
    WrongMatches s;
    std::vector<uchar> status;
    do
    {
        s.object.clear();
        for (int i = 0; i < count; i++)
            s.object.push_back(Point3d(random.uniform(-90, 90), random.uniform(-70, 70), planar ? 0 : random.uniform(-60, 60)));
        s.rvec = normalize(random.vector(1))*random.uniform(0.2, 0.7);
        s.tvec = Vec3d(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(550, 700));
        refractiveProjectPoints(s.object, s.rvec, s.tvec, camera, s.perfect, status);
    } while (countNonZero(status) > 0);
    s.pixels = s.perfect;
    const Point2d shift(random.uniform(60, 120), random.uniform(30, 60));
    for (int i = 0; i < count; i++)
    {
        s.pixels[i] += Point2d(random.normal(sigma), random.normal(sigma));
        if (i >= wrong)
            s.right.push_back(i);
        else if (how == RANDOM)
            s.pixels[i] = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
        else                            // neighbours in a repeating pattern, in all directions
            s.pixels[i] += Point2d((random.below(3) - 1)*shift.x, (random.below(2)*2 - 1)*shift.y);
    }
    return s;
}

//! RMS of how far the target's images move from the true pose to the found one.
double offPixels(const WrongMatches& s, const Ptr<RefractiveCamera>& camera, InputArray rvec, InputArray tvec)
{
    std::vector<Point2d> pixels;
    refractiveProjectPoints(s.object, rvec, tvec, camera, pixels);
    double sum = 0;
    for (size_t i = 0; i < pixels.size(); i++)
        sum += (pixels[i] - s.perfect[i]).dot(pixels[i] - s.perfect[i]);
    return std::sqrt(sum/(double)pixels.size());
}

} // namespace

TEST_CASE("Three points on three rays have the true pose among theirs", "[pnp][ransac]")
{
    Random random(4000);
    for (const Camera3& c : ransacCameras())
    {
        const int COUNT = 1000;
        int found = 0, foundAmongAll = 0;
        size_t fast = 0, complete = 0;
        double worst = 0;
        for (int trial = 0; trial < COUNT; trial++)
        {
            const WrongMatches s = wrongMatches(c.camera, random, 3, 0, false, RANDOM, 0);
            Mat origins, directions;
            refractiveUnprojectPoints(s.pixels, origins, directions, c.camera);
            SceneRay rays[3];
            Vec3d object[3];
            for (int i = 0; i < 3; i++)
            {
                rays[i] = { origins.at<Vec3d>(i), directions.at<Vec3d>(i) };
                object[i] = Vec3d(s.object[i]);
            }
            RigidTransform motions[4];
            const int count = posesOfThreeRays(rays, object, motions);
            const std::vector<RigidTransform> all = allPosesOfThreeRays(rays, object);
            Matx33d R;
            Rodrigues(s.rvec, R);
            const auto nearest = [&](const RigidTransform* begin, size_t number)
            {
                double least = INF;
                for (const RigidTransform* motion = begin; motion < begin + number; motion++)
                {
                    for (int i = 0; i < 3; i++)     // exact, right or not: its points are on the rays
                    {
                        const Vec3d X = motion->R*object[i] + motion->t - rays[i].origin;
                        worst = std::max(worst, norm(X.cross(rays[i].direction)));
                    }
                    least = std::min(least, norm(motion->t - s.tvec)/norm(s.tvec) + norm(motion->R - R));
                }
                return least;
            };
            found += nearest(motions, count) < 1e-4;
            foundAmongAll += nearest(all.data(), all.size()) < 1e-4;
            fast += count;
            complete += all.size();
        }
        CAPTURE(c.name, seed());
        printNumber(std::string("poses of three rays, ") + c.name + ": true one found", 100.*found/COUNT, "%");
        printNumber(std::string("poses of three rays, ") + c.name + ": per sample", (double)complete/COUNT, "");
        CHECK(found > 0.97*COUNT);
        CHECK(foundAmongAll == COUNT);
        CHECK(complete >= fast);
        CHECK(worst < 1e-4);
    }
}

TEST_CASE("No poses of three points on a line or in one place", "[pnp][ransac]")
{
    const SceneRay rays[3] = { { Vec3d(0, 0, 5), Vec3d(0, 0, 1) }, { Vec3d(0, 0, 6), normalize(Vec3d(0.1, 0, 1)) },
                               { Vec3d(0, 0, 6), normalize(Vec3d(0, 0.1, 1)) } };
    RigidTransform motions[4];
    CHECK(posesOfThreeRays(rays, { Vec3d(0, 0, 0), Vec3d(1, 1, 0), Vec3d(3, 3, 0) }, motions) == 0);
    CHECK(posesOfThreeRays(rays, { Vec3d(2, 0, 0), Vec3d(2, 0, 0), Vec3d(2, 0, 0) }, motions) == 0);
    CHECK(posesOfThreeRays(rays, { Vec3d(2, 0, 0), Vec3d(2, 0, 0), Vec3d(0, 1, 0) }, motions) == 0);
}

TEST_CASE("The right matches are found, whatever lens and window", "[pnp][ransac]")
{
    for (WindowKind kind : allWindows())
        for (const LensKind& lens : allLenses())
            for (bool planar : { true, false })
            {
                Random random(4100 + kind);
                CAPTURE(name(kind), lens.name, planar, seed());
                const Ptr<RefractiveCamera> camera = makeCamera(lens, makeWindow(kind, random));
                WrongMatches s = wrongMatches(camera, random, 40, 16, planar, RANDOM, 0);
                for (int i = 0; i < 16; i++)        // of this lens's image
                    s.pixels[i] = s.perfect[i] + Point2d(random.uniform(20, 60), random.uniform(20, 60));
                Mat r, t;
                std::vector<int> inliers;
                REQUIRE(refractiveSolvePnPRansac(s.object, s.pixels, camera, r, t, false, 200, 2, 0.999, inliers));
                CHECK(inliers == s.right);
                CHECK(norm(t, Mat(s.tvec)) < 1e-5*norm(s.tvec));
                CHECK(norm(r, Mat(s.rvec)) < 1e-5);
            }
}

TEST_CASE("Seventy of a hundred matches wrong", "[pnp][ransac]")
{
    const int TRIALS = trials(20);
    for (const Camera3& c : ransacCameras())
        for (bool planar : { false, true })
            for (float limit : { 8.f, 2.f })
                for (Wrongness how : { RANDOM, SHIFTED })
                {
                    Random random(4200);
                    int right = 0;
                    double all = 0;
                    for (int trial = 0; trial < TRIALS; trial++)
                    {
                        const WrongMatches s = wrongMatches(c.camera, random, 100, 70, planar, how);
                        Mat r, t;
                        std::vector<int> inliers;
                        const bool found = refractiveSolvePnPRansac(s.object, s.pixels, c.camera, r, t, false, 1000, limit, 0.999,
                                                                    inliers);
                        const double off = found ? offPixels(s, c.camera, r, t) : INF;
                        right += off < 0.3 && norm(r, Mat(s.rvec)) < 0.05;
                        all += std::includes(inliers.begin(), inliers.end(), s.right.begin(), s.right.end());
                    }
                    CAPTURE(c.name, planar, limit, how, seed());
                    printNumber(std::string("PnP, 70 of 100 wrong, ") + c.name + (planar ? ", flat" : ", solid") + ", "
                                + (how == RANDOM ? "uniformly random" : "shifted") + ", limit " + std::to_string((int)limit)
                                + " px: right in", 100.*right/TRIALS, "%");
                    CHECK(right >= 0.97*TRIALS);
                    if (limit == 8)
                        CHECK(all >= 0.95*TRIALS);
                }
}

TEST_CASE("Nothing but wrong matches is false, not a pose", "[pnp][ransac]")
{
    Random random(4300);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    int answers = 0;
    for (int trial = 0; trial < 20; trial++)
    {
        const WrongMatches s = wrongMatches(camera, random, 100, 100, trial % 2 == 0, RANDOM);
        Mat r = Mat(Vec3d(1, 2, 3), true), t = Mat(Vec3d(4, 5, 6), true);
        std::vector<int> inliers(5);
        const float limit = trial % 4 < 2 ? 8.f : 2.f;
        const bool found = refractiveSolvePnPRansac(s.object, s.pixels, camera, r, t, false, 500, limit, 0.99, inliers);
        answers += found;
        if (found)
            continue;
        CHECK(r.at<double>(0) == 1);
        CHECK(t.at<double>(2) == 6);
        CHECK(inliers.empty());
    }
    CAPTURE(seed());
    CHECK(answers <= 1);
}

TEST_CASE("RANSAC: few points, unseen ones, a guess, types", "[pnp][ransac]")
{
    Random random(4400);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    WrongMatches s = wrongMatches(camera, random, 30, 10, false, RANDOM, 0.1);
    Mat r, t, r2, t2;
    std::vector<int> inliers, inliers2;
    REQUIRE(refractiveSolvePnPRansac(s.object, s.pixels, camera, r, t, false, 300, 3, 0.999, inliers));
    CHECK(inliers == s.right);

    SECTION("the pose is the most likely one of its inliers")
    {
        std::vector<Point3d> object;
        std::vector<Point2d> pixels;
        for (int i : s.right)
        {
            object.push_back(s.object[i]);
            pixels.push_back(s.pixels[i]);
        }
        REQUIRE(refractiveSolvePnP(object, pixels, camera, r2, t2));
        CHECK(largestDifference(t, t2) < 1e-4);
    }
    SECTION("the overload agrees")
    {
        REQUIRE(refractiveSolvePnPRansac(s.object, s.pixels, camera->cameraMatrix(), camera->distCoeffs(), camera->window(), r2, t2,
                                         false, 300, 3, 0.999, inliers2));
        CHECK(inliers2 == inliers);
        CHECK(largestDifference(t, t2) == 0);
    }
    SECTION("points that were not seen are no inliers, the others keep their numbers")
    {
        s.pixels[0] = s.pixels[12] = Point2d(NaN, NaN);
        REQUIRE(refractiveSolvePnPRansac(s.object, s.pixels, camera, r2, t2, false, 300, 3, 0.999, inliers2));
        inliers.erase(std::find(inliers.begin(), inliers.end(), 12));
        CHECK(inliers2 == inliers);
    }
    SECTION("a guess is as good as a sample")
    {
        r2 = r + 0.0005;
        t2 = t + 0.1;
        REQUIRE(refractiveSolvePnPRansac(s.object, s.pixels, camera, r2, t2, true, 1, 3, 0.99, inliers2));
        CHECK(inliers2 == inliers);
        CHECK(largestDifference(t, t2) < 1e-4);
    }
    SECTION("float32, inliers as cv::solvePnPRansac gives them")
    {
        Mat indices;
        const std::vector<Point3f> object(s.object.begin(), s.object.end());
        const std::vector<Point2f> pixels(s.pixels.begin(), s.pixels.end());
        REQUIRE(refractiveSolvePnPRansac(object, pixels, camera, r2, t2, false, 300, 3, 0.999, indices));
        CHECK(indices.type() == CV_32S);
        CHECK(indices.size() == Size(1, (int)s.right.size()));
        CHECK(largestDifference(t, t2) < 1e-2);
    }
    SECTION("four right points are enough, three are not")
    {
        const std::vector<Point3d> object(s.object.end() - 4, s.object.end());
        std::vector<Point2d> pixels(s.pixels.end() - 4, s.pixels.end());
        CHECK(refractiveSolvePnPRansac(object, pixels, camera, r2, t2, false, 100, 3, 0.99, inliers2));
        CHECK(inliers2.size() == 4);
        pixels[1] = Point2d(NaN, NaN);
        CHECK_FALSE(refractiveSolvePnPRansac(object, pixels, camera, r2, t2, false, 100, 3, 0.99, inliers2));
    }
}

TEST_CASE("RANSAC: what has no pose, and bad arguments", "[pnp][ransac]")
{
    Random random(4500);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const WrongMatches s = wrongMatches(camera, random, 12, 0, false, RANDOM, 0);
    Mat r, t;
    const auto solve = [&](const std::vector<Point3d>& object, const std::vector<Point2d>& pixels, int iterations = 100,
                           float limit = 8, double confidence = 0.99)
    { return refractiveSolvePnPRansac(object, pixels, camera, r, t, false, iterations, limit, confidence); };
    CHECK(solve(s.object, s.pixels));
    std::vector<Point3d> line;
    for (int i = 0; i < 12; i++)
        line.push_back(Point3d(10*i, 5*i, 0));
    std::vector<Point2d> onLine;
    refractiveProjectPoints(line, Vec3d(), Vec3d(0, 0, 600), camera, onLine);
    CHECK_FALSE(solve(line, onLine));
    CHECK_FALSE(solve(std::vector<Point3d>(12, s.object[0]), std::vector<Point2d>(12, s.pixels[0])));
    CHECK_FALSE(solve(s.object, std::vector<Point2d>(12, Point2d(NaN, NaN))));
    CHECK_FALSE(solve(s.object, std::vector<Point2d>(12, Point2d(1e6, 1e6))));
    std::vector<Point3d> copies;            // of three points, which four poses agree with
    std::vector<Point2d> copied;
    for (int i = 0; i < 12; i++)
    {
        copies.push_back(s.object[i % 3]);
        copied.push_back(s.pixels[i % 3]);
    }
    CHECK_FALSE(solve(copies, copied));

    const auto why = [&](int count, int iterations, float limit, double confidence)
    {
        return thrown([&] { solve({ s.object.begin(), s.object.begin() + count }, { s.pixels.begin(), s.pixels.begin() + count },
                                  iterations, limit, confidence); });
    };
    CHECK_THAT(why(3, 100, 8, 0.99), Catch::Contains("objectPoints has 3 points"));
    CHECK_THAT(why(12, 0, 8, 0.99), Catch::Contains("iterationsCount is 0"));
    CHECK_THAT(why(12, 100, 0, 0.99), Catch::Contains("reprojectionError is 0"));
    CHECK_THAT(why(12, 100, (float)NaN, 0.99), Catch::Contains("reprojectionError is nan"));
    CHECK_THAT(why(12, 100, 8, 1), Catch::Contains("confidence is 1"));
}
