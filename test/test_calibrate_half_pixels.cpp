// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Calibration and bundle adjustment with pixels of which one coordinate is known, and with covariances of pixels: fringe projectors,
// sheets of light and line cameras.
#include "bundle_scenes.hpp"

#include <functional>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

//! v of all pixels is not known.
void forgetV(PixelViews& views)
{
    for (std::vector<Point2d>& view : views)
        for (Point2d& pixel : view)
            pixel.y = NaN;
}

//! RigCall with what it lacks.
struct HalfCall : RigCall
{
    HalfCall(const RigTruth& rig, const RigScene& scene) : RigCall(rig, scene, false) {}
    double run(int flags)
    {
        GlassRigOptions options(flags);
        options.poseCovariances = poseCovariances;
        options.cameraCovariances = cameraCovariances;
        options.pixelCovariancesRefracted = pixelCovariances;
        return RigCall::run(options);
    }
    std::vector<Mat> cameraCovariances;
    std::vector<std::vector<Mat> > pixelCovariances;
};

int parametersOf(const Ptr<RefractiveCamera>& camera) { return (int)camera->parameterNames().size(); }

//! Nothing is known of a camera's own parameters, and these variances of its rvec and T.
Mat extrinsicPrior(const Ptr<RefractiveCamera>& camera, const Vec6d& variances)
{
    const int own = parametersOf(camera);
    Mat C = Mat::zeros(own + 6, own + 6, CV_64F);
    C.diag().setTo(NaN);
    for (int k = 0; k < 6; k++)
        C.at<double>(own + k, own + k) = variances[k];
    return C;
}

//! Covariance of a rotation vector that may turn by any angle, but not about the camera's x: (turn about x)^2/tiny + turns^2/wide.
Matx33d turnedAcross(const Matx33d& R)
{
    const double H = 1e-5, TINY = 1e-6, WIDE = 1;
    Vec3d rvec, about;
    Rodrigues(R, rvec);
    for (int k = 0; k < 3; k++)
    {
        Matx33d moved;
        Vec3d step = rvec;
        step[k] += H;
        Rodrigues(step, moved);
        const Matx33d turn = moved*R.t();
        about[k] = (turn(2, 1) - turn(1, 2))/(2*H);
    }
    return Matx33d(about*about.t()*(1/TINY) + Matx33d::eye()*(1/WIDE)).inv(DECOMP_CHOLESKY);
}

std::string whyNot(const std::function<void()>& call)
{
    try { call(); }
    catch (const Exception& e) { return e.what(); }
    return "no exception";
}

//! The error of the second camera's place, and the second camera's window, over what covariance says: chi^2 over its dimensions.
double chiSquare(const RigTruth& rig, const std::vector<Ptr<RefractiveCamera> >& cameras, const std::vector<Mat>& Rs,
                 const std::vector<Mat>& Ts, const Mat& covariance)
{
    const int own1 = parametersOf(cameras[0]), own2 = parametersOf(cameras[1]);
    Mat error = Mat::zeros(own1 + own2 + 6, 1, CV_64F);
    const auto put = [&](int row, const Vec3d& values)
    {
        for (int k = 0; k < 3; k++)
            error.at<double>(row + k) = values[k];
    };
    int row = 0;
    for (size_t c = 0; c < 2; c++)
    {
        const int lens = cameras[c]->lensParameters().rows;
        put(row + lens, cameras[c]->window().normal - rig.cameras[c]->window().normal);
        error.at<double>(row + lens + 3) = cameras[c]->window().distance - rig.cameras[c]->window().distance;
        row += parametersOf(cameras[c]);
    }
    Vec3d found, truth;
    Rodrigues(Rs[1], found);
    Rodrigues(rig.Rs[1], truth);
    put(row, found - truth);
    put(row + 3, Vec3d(Ts[1]) - rig.Ts[1]);
    // What is exact, and a normal's third direction, have no variance.
    Mat values, vectors;
    eigen(covariance, values, vectors);
    double sum = 0;
    int dimensions = 0;
    for (int i = 0; i < values.rows; i++)
        if (values.at<double>(i) > 1e-14*values.at<double>(0))
        {
            sum += std::pow(vectors.row(i).dot(error.t()), 2)/values.at<double>(i);
            dimensions++;
        }
    return sum/dimensions;
}

} // namespace

TEST_CASE("A projector that knows u alone is calibrated behind its window", "[half_pixels][calibrate_rig]")
{
    Random random(2920);
    const double SIGMA = 0.1;
    const RigTruth rig = makeRig(2, { 0, 1 }, 1.333, 0.3);
    double sum = 0;
    const int count = trials(20);
    for (int trial = 0; trial < count; trial++)
    {
        RigScene scene = makeRigScene(rig, 12, random, SIGMA);
        forgetV(scene.refracted[1]);
        HalfCall call(rig, scene);
        // The lens of a projector without distortion does not tell where it is along v; this one's distortion hardly does.
        const Vec6d onlyTy(NaN, NaN, NaN, NaN, 0, NaN);
        call.cameraCovariances = { Mat(), extrinsicPrior(call.cameras[1], onlyTy) };
        const double rms = call.run(GLASS_FREE_EXTRINSICS | GLASS_FREE_DISTANCE);
        CAPTURE(seed(), trial);
        CHECK(rms == Approx(SIGMA*std::sqrt(1.5)).epsilon(0.1));        // as many halves as wholes
        CHECK(call.perViewErrors.at<double>(0, 3) == Approx(SIGMA).epsilon(0.5));
        CHECK(Vec3d(call.Ts[1])[1] == rig.Ts[1][1]);
        CHECK(angleBetween(call.cameras[1]->window().normal, rig.cameras[1]->window().normal) < 3);
        sum += chiSquare(rig, call.cameras, call.Rs, call.Ts, call.covariance);
    }
    CHECK(sum/count > 0.7);
    CHECK(sum/count < 1.3);
    printNumber("camera and projector of u, calibrated, mean chi-square over its dimensions", sum/count, "");
}

TEST_CASE("A straight sheet of light: three of its six are told, the others are named", "[half_pixels][calibrate_rig]")
{
    // The camera's window is known; the emitter has none. Points of a board on the sheet, for each of some places of the board.
    Random random(2921);
    const double SIGMA = 0.05;
    RigTruth rig = makeRig(1, { 0 }, 1.333);
    const Ptr<RefractiveCamera> laser = RefractiveCamera::create(Matx33d(1000, 0, 0, 0, 1000, 0, 0, 0, 1), noArray());
    Matx33d R;
    Rodrigues(Vec3d(0.02, -0.4, 0.03), R);
    const Vec3d T(240, 3, -10);
    RigScene scene = makeRigScene(rig, 8, random, 0);
    PixelViews ofLaser;
    for (size_t view = 0; view < scene.object.size(); view++)
    {
        Matx33d board;
        Rodrigues(scene.rvecs[view], board);
        std::vector<Point2d> pixels(scene.object[view].size(), Point2d(NaN, NaN));
        for (double y = -70; y <= 70; y += 5)
        {
            // x where first row of R (board X + t) + T is 0
            const Vec3d along = R*(board*Vec3d(1, 0, 0)), at = R*(board*Vec3d(0, y, 0) + scene.tvecs[view]) + T;
            const Point3d X(-at[0]/along[0], y, 0);
            if (std::abs(X.x) > 110)
                continue;
            scene.object[view].push_back(X);
            pixels.push_back(Point2d(random.normal(SIGMA), NaN));
        }
        scene.refracted[0][view] = seen(scene.object[view], scene.rvecs[view], scene.tvecs[view], rig.cameras[0], random, SIGMA);
        ofLaser.push_back(pixels);
    }
    rig.cameras.push_back(laser);
    rig.windows.push_back(1);
    rig.Rs.push_back(R);
    rig.Ts.push_back(T);
    scene.refracted.push_back(ofLaser);
    scene.direct.push_back(PixelViews());
    HalfCall call(rig, scene);
    call.cameras[0]->setWindow(rig.cameras[0]->window());
    call.cameras[1] = laser->clone();
    call.Ts[1].at<double>(0) += 3;
    const int flags = GLASS_FREE_EXTRINSICS | GLASS_FIX_NORMAL;
    const std::string why = whyNot([&] { call.run(flags); });
    CHECK_THAT(why, Contains("do not determine") && Contains("T"));
    // T along the sheet alone is not enough.
    call.cameraCovariances = { Mat(), extrinsicPrior(call.cameras[1], { NaN, NaN, NaN, NaN, 0, 0 }) };
    const std::string whyTurn = whyNot([&] { call.run(flags); });
    if (whyTurn == "no exception")          // where noise seems to tell a little of what the sheet does not
        CHECK(norm(call.stdDeviations.rowRange(call.stdDeviations.rows - 6, call.stdDeviations.rows - 3), NORM_INF) > 0.01);
    else
        CHECK_THAT(whyTurn, Contains("do not determine R"));
    call.Rs[1] = Mat(R, true);
    call.Ts[1] = Mat(T + Vec3d(3, 0, 0), true);
    // Nor may it turn about the sheet's normal.
    Mat(turnedAcross(R)).copyTo(call.cameraCovariances[1](Rect(parametersOf(laser), parametersOf(laser), 3, 3)));
    call.run(flags);
    // The plane, in the frame of camera 1: first row of R and x of T.
    const auto planeOf = [](const Matx33d& rotation, const Vec3d& t)
    { return Vec4d(rotation(0, 0), rotation(0, 1), rotation(0, 2), t[0]); };
    const Vec4d truth = planeOf(R, T), found = planeOf(call.Rs[1], Vec3d(call.Ts[1]));
    double worst = 0;
    for (const Point3d& X : { Point3d(-60, -60, 560), Point3d(60, 60, 660), Point3d(0, 0, 600) })
    {
        // A point of the true plane near X, against the found one.
        Vec3d P(X);
        P[0] -= (truth[0]*P[0] + truth[1]*P[1] + truth[2]*P[2] + truth[3])/truth[0];
        worst = std::max(worst, std::abs(found[0]*P[0] + found[1]*P[1] + found[2]*P[2] + found[3]));
    }
    CHECK(worst < 0.05);
    printNumber("sheet of light from 8 images in water, farthest from the true plane", worst, "mm");
    CHECK(Vec3d(call.Ts[1])[1] == T[1]);
    CHECK(Vec3d(call.Ts[1])[2] == T[2]);
    // x of T, which the sheet tells, and how well.
    const double sigma = call.stdDeviations.at<double>(call.stdDeviations.rows - 3);
    CHECK(sigma < 0.1);
    CHECK(std::abs(Vec3d(call.Ts[1])[0] - T[0]) < 5*sigma);
}

TEST_CASE("A camera of which both coordinates are unknown everywhere has no images", "[half_pixels][calibrate_rig]")
{
    Random random(2926);
    RigTruth rig = makeRig(2, { 0, 1 }, 1.333);
    RigScene scene = makeRigScene(rig, 4, random, 0);
    for (std::vector<Point2d>& view : scene.refracted[1])
        for (Point2d& pixel : view)
            pixel = Point2d(NaN, NaN);
    scene.direct[1] = PixelViews();
    HalfCall call(rig, scene);
    const std::string why = whyNot([&] { call.run(0); });
    CHECK_THAT(why, Contains("imagePointsRefracted[1] has no point that was seen"));
}

TEST_CASE("Weighted pixels calibrate a rig, and their common factor is estimated", "[half_pixels][calibrate_rig]")
{
    Random random(2922);
    const double SIGMA = 0.05, FACTOR = 25;
    const RigTruth rig = makeRig(2, { 0, 1 }, 1);
    double weighted = 0, plain = 0, sum = 0;
    const int count = trials(6);
    for (int trial = 0; trial < count; trial++)
    {
        RigScene scene = makeRigScene(rig, 8, random, 0);
        std::vector<std::vector<Mat> > covariances;
        for (PixelViews& views : scene.refracted)
        {
            covariances.push_back({});
            for (std::vector<Point2d>& view : views)
            {
                Mat C((int)view.size(), 3, CV_64F);
                for (size_t i = 0; i < view.size(); i++)
                {
                    const double scale = i % 2 ? 1 : 12;
                    view[i] += Point2d(random.normal(scale*SIGMA), random.normal(scale*SIGMA));
                    C.at<double>((int)i, 0) = C.at<double>((int)i, 2) = FACTOR*scale*scale;
                    C.at<double>((int)i, 1) = 0;
                }
                covariances.back().push_back(C);
            }
        }
        HalfCall with(rig, scene), without(rig, scene);
        with.pixelCovariances = covariances;
        with.run(GLASS_FREE_EXTRINSICS);
        without.run(GLASS_FREE_EXTRINSICS);
        const auto off = [&](const HalfCall& call)
        { return std::pow(angleBetween(call.cameras[0]->window().normal, rig.cameras[0]->window().normal), 2); };
        weighted += off(with);
        plain += off(without);
        sum += chiSquare(rig, with.cameras, with.Rs, with.Ts, with.covariance);
    }
    CAPTURE(seed());
    CHECK(weighted < 0.25*plain);
    CHECK(sum/count > 0.4);
    CHECK(sum/count < 1.9);
    printNumber("rig with weighted pixels, error of the normal, of that without weights", std::sqrt(weighted/plain), "");
}

TEST_CASE("Half an outlier is found beside whole pixels", "[half_pixels][calibrate_rig][robust]")
{
    Random random(2923);
    const RigTruth rig = makeRig(2, { 0, 1 }, 1, 0.3);
    RigScene scene = makeRigScene(rig, 10, random, 0.1);
    forgetV(scene.refracted[1]);
    for (size_t view = 0; view < 10; view++)
        scene.refracted[1][view][3 + view].x += 6;
    HalfCall call(rig, scene);
    call.cameraCovariances = { Mat(), extrinsicPrior(call.cameras[1], { NaN, NaN, NaN, NaN, 0, NaN }) };
    call.run(GLASS_FREE_EXTRINSICS | GLASS_ROBUST);
    int lost = 0;
    for (int view = 0; view < 10; view++)
    {
        const Mat& mask = call.inliers[4*view + 3];
        CHECK(mask.at<uchar>(3 + view) == 0);
        lost += mask.rows - countNonZero(mask);
    }
    CHECK(lost == 10);
}

TEST_CASE("A moved scene with a line camera beside cameras: bundle adjustment takes halves", "[half_pixels][bundle]")
{
    Random random(2924);
    const double SIGMA = 0.1;
    const RigTruth rig = makeRig(3, { 0, 1, 2 }, 1.333, 0.3);
    double sum = 0;
    int number = 0;
    for (int trial = 0; trial < trials(20); trial++)
    {
        BundleScene scene = makeWandScene(rig, 60, random, SIGMA);
        forgetV(scene.pixels[2]);
        BundleCall call(rig, scene, random, 0);
        for (size_t c = 0; c < rig.cameras.size(); c++)         // near the truth: there are other minima
        {
            GlassWindow window = rig.cameras[c]->window();
            window.normal = normalize(window.normal + random.vector(0.03));
            call.cameras[c]->setWindow(window);
            for (int k = 0; k < 3 && c > 0; k++)
                call.Ts[c].at<double>(k) += random.normal(1);
        }
        // Distortion and window hardly tell where it is along v.
        call.Ts[2].at<double>(1) = rig.Ts[2][1];
        const std::vector<Mat> known = { Mat(), Mat(), extrinsicPrior(call.cameras[2], { NaN, NaN, NaN, NaN, 0, NaN }) };
        BundleAdjustOptions options(GLASS_FREE_EXTRINSICS);
        options.cameraCovariances = known;
        const double rms = call.run(options);
        CAPTURE(seed(), trial);
        CHECK(rms < 0.2);
        for (size_t i = 0; i < scene.points.size(); i++)
        {
            const Point3d error = call.points[i] - scene.points[i];
            const double e[] = { error.x, error.y, error.z };
            for (int k = 0; k < 3 && std::isfinite(error.x); k++, number++)
                sum += std::pow(e[k]/call.pointDeviations.at<double>((int)i, k), 2);
        }
        const Vec3d T(call.Ts[2]);
        for (int k = 0; k < 3; k++)
            CHECK(std::abs(T[k] - rig.Ts[2][k]) <= 5*call.stdDeviations.at<double>(call.stdDeviations.rows - 3 + k));
    }
    const double ratio = sum/number;
    CHECK(ratio > 0.6);
    CHECK(ratio < 1.5);
    printNumber("bundle of two cameras and one of u alone, points' squared errors over stated", ratio, "");
}

TEST_CASE("Points that a camera and a sheet see start from their meeting", "[half_pixels][bundle]")
{
    Random random(2925);
    const RigTruth rig = makeRig(2, { 0, 1 }, 1.333, 0.3);
    BundleScene scene = makeWandScene(rig, 20, random, 0);
    forgetV(scene.pixels[1]);
    BundleCall call(rig, scene, random, 0);
    CHECK(call.run(GLASS_FIX_NORMAL) < 1e-6);
    double worst = 0;
    int used = 0;
    for (size_t i = 0; i < scene.points.size(); i++)
        if (std::isfinite(call.points[i].x))
        {
            worst = std::max(worst, norm(call.points[i] - scene.points[i]));
            used++;
        }
    CHECK(used > 30);
    CHECK(worst < 1e-5);
    SECTION("both coordinates unknown everywhere")
    {
        for (std::vector<Point2d>& view : scene.pixels[1])
            for (Point2d& pixel : view)
                pixel = Point2d(NaN, NaN);
        BundleCall blind(rig, scene, random, 0);
        CHECK_THROWS_AS(blind.run(GLASS_FIX_NORMAL), Exception);
    }
    SECTION("two halves are not enough")
    {
        forgetV(scene.pixels[0]);
        BundleCall halves(rig, scene, random, 0);
        CHECK_THROWS_AS(halves.run(GLASS_FIX_NORMAL), Exception);
    }
}
