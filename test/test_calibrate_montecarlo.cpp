// Accuracy of the calibrators by simulation, beside what the Cramer-Rao bound allows. Hidden: run with [.monte-carlo].
#include "calibration_scenes.hpp"

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
        refractiveUndistortPoints(scene.direct[view], from, camera->cameraMatrix(), camera->distCoeffs(), GlassWindow());
        refractiveUndistortPoints(scene.refracted[view], to, camera->cameraMatrix(), camera->distCoeffs(), GlassWindow());
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

TEST_CASE("RMS angle of the normal on the paper's rig", "[.monte-carlo]")
{
    const Ptr<RefractiveCamera> camera = paperCamera(paperWindow());
    const Vec3d truth = camera->window().normal;
    for (int views : { 1, 10 })
    {
        const int runs = 1000;
        double paper = 0, pairs = 0, joint = 0, predicted = 0;
        for (int run = 0; run < runs; run++)
        {
            Random random(5000 + run);
            const CalibrationScene scene = makeScene(camera, views, random, 0.1);
            const auto square = [&](const Vec3d& normal) { return std::pow(angleBetween(normal, truth), 2)/runs; };
            paper += square(paperNormal(scene, camera));
            Vec3d normal;
            calibrateGlassNormal(scene.direct, scene.refracted, camera, normal);
            pairs += square(normal);
            Ptr<RefractiveCamera> found = paperCamera(paperWindow());
            Mat deviations;
            calibrateGlass(scene.object, scene.refracted, scene.direct, found, noArray(), noArray(), deviations, noArray(),
                           noArray(), noArray());
            joint += square(found->window().normal);
            predicted += std::pow(norm(deviations)*180/CV_PI, 2)/runs;
        }
        const std::string what = "normal from " + std::to_string(views) + " pair(s), RMS over " + std::to_string(runs) + ", ";
        printNumber(what + "paper's least squares", std::sqrt(paper), "deg");
        printNumber(what + "calibrateGlassNormal", std::sqrt(pairs), "deg");
        printNumber(what + "calibrateGlass", std::sqrt(joint), "deg");
        printNumber(what + "calibrateGlass predicts", std::sqrt(predicted), "deg");
    }
}

//! One row of the table of what the data can tell: predicted standard deviations.
static void printPrediction(int views, bool paired, int flags, const char* free)
{
    const Ptr<RefractiveCamera> camera = paperCamera(paperWindow());
    Random random(6000 + views);
    const CalibrationScene scene = makeScene(camera, views, random, 0.1);
    Mat deviations, covariance;
    const std::string what = std::to_string(views) + (paired ? " pairs" : " glass-only views") + ", free " + free;
    const std::string refusal = thrown([&]
    {
        calibrateGlass(scene.object, scene.refracted, paired ? scene.direct : PixelViews(), camera, noArray(), noArray(),
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
              << angleBetween(camera->window().normal, paperWindow().normal) << "; thickness "
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
