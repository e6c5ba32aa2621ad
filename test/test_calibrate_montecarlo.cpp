// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Accuracy of the calibrators by simulation, beside what the Cramer-Rao bound allows. The long forms are hidden: run with
// [.monte-carlo].
#include "cramer_rao.hpp"
#include "rig_scenes.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

//! The paper's equations (1)-(3): the point nearest to all lines in the undistorted image.
static Vec3d paperNormal(const CalibrationScene& scene, const Ptr<RefractiveCamera>& camera)
{
    Matx22d A = Matx22d::zeros();
    Vec2d b;
    for (size_t view = 0; view < scene.direct.size(); view++)
    {
        std::vector<Point2d> from, to;
        refractiveUndistortPoints(scene.direct[view], from, camera->cameraMatrix(), camera->distCoeffs(), GlassWindow(), noArray());
        refractiveUndistortPoints(scene.refracted[view], to, camera->cameraMatrix(), camera->distCoeffs(), GlassWindow(), noArray());
        for (size_t i = 0; i < from.size(); i++)
        {
            const Vec2d across = normalize(Vec2d(to[i].y - from[i].y, from[i].x - to[i].x));
            A += across*across.t();
            b += across*across.dot(Vec2d(from[i].x, from[i].y));
        }
    }
    const Vec2d centre = A.inv()*b;
    return normalize(Vec3d(centre[0], centre[1], 1));
}

namespace {

//! What a case of the paper's rig is calibrated from.
struct Case
{
    const char* name;
    int views;
    bool paired;
    int flags;
    double outliers;        //!< part of the corners that are displaced
};

//! Errors of many trials beside their bound.
struct Statistics
{
    double normal = 0, bound = 0, thickness = 0, thicknessBound = 0;    // mean squares
    Coverage ofNormal, ofThickness;
    double normalRatio() const { return std::sqrt(normal/bound); }
    double thicknessRatio() const { return std::sqrt(thickness/thicknessBound); }
};

//! One trial; adds to the statistics.
void tryOnce(const Case& c, int run, int runs, Statistics& statistics)
{
    const double sigma = 0.1;
    Random random(5000 + run);
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane()), found = paperCamera(paper::pane());
    CalibrationScene perfect = makeScene(camera, c.views, random, 0), scene = withNoise(perfect, random, sigma);
    if (c.outliers > 0)
    {
        perfect.refracted = without(perfect.refracted, displace(scene.refracted, c.outliers, random));
        perfect.direct = without(perfect.direct, displace(scene.direct, c.outliers, random));
    }
    const Mat bound = sigma*sigma*cramerRaoBound(perfect, c.paired, camera, c.flags & ~GLASS_ROBUST);
    Mat deviations, covariance;
    calibrateGlass(scene.object, c.paired ? scene.direct : PixelViews(), scene.refracted, found, noArray(), noArray(),
                   deviations, covariance, noArray(), noArray(), c.flags);

    const Vec3d truth = camera->window().normal, n = found->window().normal;
    statistics.normal += std::pow(angleBetween(n, truth)*CV_PI/180, 2)/runs;
    statistics.bound += (bound.at<double>(0, 0) + bound.at<double>(1, 1))/runs;
    const Matx33d C(covariance(Rect(8, 8, 3, 3)));
    const Matx<double, 3, 2> tangents = tangentsOf(n);
    for (int i = 0; i < 2; i++)
    {
        const Vec3d t(tangents(0, i), tangents(1, i), tangents(2, i));
        statistics.ofNormal.add(t.dot(truth), std::sqrt(t.dot(C*t)));
    }
    if (!(c.flags & GLASS_FREE_THICKNESS))
        return;
    const double error = found->window().thickness[0] - 20;
    statistics.thickness += error*error/runs;
    statistics.thicknessBound += bound.at<double>(2, 2)/runs;
    statistics.ofThickness.add(error, deviations.at<double>(12));
}

Statistics statisticsOf(const Case& c, int runs)
{
    Statistics statistics;
    for (int run = 0; run < runs; run++)
        tryOnce(c, run, runs, statistics);
    return statistics;
}

const Case CASES[] = {
    { "1 pair", 1, true, 0, 0 },
    { "10 pairs", 10, true, 0, 0 },
    { "20 glass-only views", 20, false, 0, 0 },
    { "10 pairs, thickness free", 10, true, GLASS_FREE_THICKNESS, 0 },
    { "10 pairs, robust, clean data", 10, true, GLASS_ROBUST, 0 },
    { "10 pairs, robust, 30 % of the corners displaced by 1-20 px", 10, true, GLASS_ROBUST, 0.3 } };

double limitOf(const Case& c) { return c.outliers > 0 ? 1.3 : 1.05; }

} // namespace

TEST_CASE("The normal is as good as the Cramer-Rao bound, and as good as stated: a thousand trials", "[.monte-carlo]")
{
    for (const Case& c : CASES)
    {
        const Statistics s = statisticsOf(c, 1000);
        const std::string what = std::string(c.name) + ", 1000 trials";
        std::cout << "[numbers] " << what << ": normal " << std::sqrt(s.normal)*180/CV_PI << " deg RMS, bound "
                  << std::sqrt(s.bound)*180/CV_PI << ", ratio " << s.normalRatio() << std::endl;
        s.ofNormal.print(what + ", normal");
        CHECK(s.normalRatio() < limitOf(c));
        CHECK(s.ofNormal.one() == Approx(0.68).margin(0.02));
        CHECK(s.ofNormal.two() == Approx(0.95).margin(0.01));
        if (!(c.flags & GLASS_FREE_THICKNESS))
            continue;
        std::cout << "[numbers] " << what << ": thickness " << std::sqrt(s.thickness) << " mm RMS, bound "
                  << std::sqrt(s.thicknessBound) << ", ratio " << s.thicknessRatio() << std::endl;
        s.ofThickness.print(what + ", thickness");
        CHECK(s.thicknessRatio() < limitOf(c));
        CHECK(s.ofThickness.one() == Approx(0.68).margin(0.02));
        CHECK(s.ofThickness.two() == Approx(0.95).margin(0.01));
    }
}

TEST_CASE("The normal is as good as the Cramer-Rao bound: a few trials", "[calibrate_glass][slow]")
{
    CAPTURE(seed());
    for (const Case& c : CASES)
    {
        const int runs = c.paired ? 60 : 20;
        CAPTURE(c.name);
        const Statistics s = statisticsOf(c, runs);
        // the mean of so many squares is known to 1/sqrt(runs): three times that
        CHECK(s.normalRatio() < limitOf(c)*(1 + 1.5/std::sqrt(runs)));
        CHECK(s.ofNormal.rms() == Approx(1).margin(1.5/std::sqrt(runs)));
    }
}

TEST_CASE("The paper's least squares and calibrateGlassNormal on the same rig", "[.monte-carlo]")
{
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    const Vec3d truth = camera->window().normal;
    for (int views : { 1, 10 })
    {
        const int runs = 1000;
        double paper = 0, pairs = 0;
        for (int run = 0; run < runs; run++)
        {
            Random random(5000 + run);
            const CalibrationScene scene = withNoise(makeScene(camera, views, random, 0), random, 0.1);
            const auto square = [&](const Vec3d& normal) { return std::pow(angleBetween(normal, truth), 2)/runs; };
            paper += square(paperNormal(scene, camera));
            Vec3d normal;
            calibrateGlassNormal(scene.direct, scene.refracted, camera, normal);
            pairs += square(normal);
        }
        const std::string what = "normal from " + std::to_string(views) + " pair(s), RMS over " + std::to_string(runs) + ", ";
        printNumber(what + "paper's least squares", std::sqrt(paper), "deg");
        printNumber(what + "calibrateGlassNormal", std::sqrt(pairs), "deg");
        CHECK(pairs < paper);
    }
}

//! A point measured by a rig whose windows, R and T were calibrated: as good as its stated covariance.
static Coverage coverageOfPoints(int runs)
{
    const RigTruth truth = paperStereo();
    const double sigma = 0.1;
    Coverage coverage;
    for (int run = 0; run < runs; run++)
    {
        Random random(8000 + run);
        const RigScene scene = makeRigScene(truth, 3, random, sigma);
        RigCall call(truth, scene, true);
        const double rms = call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_THICKNESS);
        const Vec3d X(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(520, 720));
        std::vector<Point2d> pixels[2];
        for (int c = 0; c < 2; c++)
            pixels[c] = seen(std::vector<Point3d>(1, Point3d(0, 0, 0)), Vec3d(), truth.Rs[c]*X + truth.Ts[c], truth.cameras[c],
                             random, sigma);
        // 3 views of 4 images: 720 equations, 10 + 18 unknowns
        const double estimated = rms/std::sqrt(2.)*std::sqrt(720./(720 - 28));
        std::vector<Point3d> point;
        Mat covariance;
        triangulateRefractive(call.cameras[0], call.cameras[1], call.Rs[1], call.Ts[1], pixels[0], pixels[1], point, noArray(),
                              0, estimated, call.covariance, covariance);
        const double errors[] = { point[0].x - X[0], point[0].y - X[1], point[0].z - X[2] };
        for (int i = 0; i < 3; i++)
            coverage.add(errors[i], std::sqrt(covariance.at<double>(0, 4*i)));
    }
    return coverage;
}

TEST_CASE("A measured point is as good as its stated covariance: a thousand trials", "[.monte-carlo]")
{
    const Coverage coverage = coverageOfPoints(1000);
    coverage.print("measured point, rig of 3 pairs, R, T, thickness free, 1000 trials");
    CHECK(coverage.one() == Approx(0.68).margin(0.02));
    CHECK(coverage.two() == Approx(0.95).margin(0.01));
}

TEST_CASE("A measured point is as good as its stated covariance: a few trials", "[stereo_glass]")
{
    CAPTURE(seed());
    CHECK(coverageOfPoints(60).rms() == Approx(1).margin(0.2));
}

//! One row of the table of what the data can tell: predicted standard deviations.
static void printPrediction(int views, bool paired, int flags, const char* free)
{
    const Ptr<RefractiveCamera> camera = paperCamera(paper::pane());
    Random random(6000 + views);
    const CalibrationScene scene = makeScene(camera, views, random, 0.1);
    Mat deviations, covariance;
    const std::string what = std::to_string(views) + (paired ? " pairs" : " glass-only views") + ", free " + free;
    const std::string refusal = thrown([&]
    {
        calibrateGlass(scene.object, paired ? scene.direct : PixelViews(), scene.refracted, camera, noArray(), noArray(),
                       deviations, covariance, noArray(), noArray(), flags);
    });
    if (!refusal.empty())
    {
        std::cout << "[numbers] " << what << ": refused: " << refusal;
        return;
    }
    Mat principal;
    eigen(covariance(Rect(8, 8, 3, 3)), principal);
    std::cout << "[numbers] " << what << ": normal +- " << std::sqrt(principal.at<double>(0))*180/CV_PI << ", "
              << std::sqrt(principal.at<double>(1))*180/CV_PI << " deg, error "
              << angleBetween(camera->window().normal, paper::pane().normal) << "; thickness "
              << camera->window().thickness[0] << " +- " << deviations.at<double>(12) << ", index "
              << camera->window().index[0] << " +- " << deviations.at<double>(13) << std::endl;
}

TEST_CASE("What the data tell on the paper's rig", "[.monte-carlo]")
{
    for (bool paired : { true, false })
    {
        printPrediction(1, paired, 0, "normal");
        printPrediction(10, paired, 0, "normal");
        printPrediction(10, paired, GLASS_FREE_THICKNESS, "normal, thickness");
        printPrediction(10, paired, GLASS_FREE_INDEX, "normal, index");
        printPrediction(10, paired, GLASS_FREE_THICKNESS | GLASS_FREE_INDEX, "normal, thickness, index");
        printPrediction(20, paired, 0, "normal");
    }
}
