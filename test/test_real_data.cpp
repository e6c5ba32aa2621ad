// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Real images that nobody on this project made, against both baselines: glass ignored, and a pinhole fitted through it.
// The data stay where they are (REFRACT_DATA_DIR); without them the cases are skipped.

#include "real_data.hpp"
#include "calibration_scenes.hpp"
#include "paths.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/stereo.hpp>
#endif
#include <catch2/catch.hpp>
#include <iostream>
#include <map>

using namespace cv;
using namespace cv::refract;
using namespace real_data;

namespace {

// ---- ouc_laser3d: a chessboard in air and in water

struct Boards
{
    std::vector<Object> object;
    std::vector<Pixels> pixels;
};

Boards boardsOf(const json& data, const std::string& medium)
{
    Boards boards;
    const double square = data["square_mm"];
    for (const auto& item : data["corners"].items())
    {
        if (item.key().compare(0, medium.size(), medium) != 0 || item.value().empty())
            continue;
        Object object;
        Pixels pixels;
        for (const json& c : item.value())      // column, row, x, y
        {
            object.emplace_back(c[0].get<double>()*square, c[1].get<double>()*square, 0);
            pixels.emplace_back(c[2], c[3]);
        }
        boards.object.push_back(object);
        boards.pixels.push_back(pixels);
    }
    return boards;
}

Boards some(const Boards& all, size_t begin, size_t end)
{
    Boards part;
    part.object.assign(all.object.begin() + begin, all.object.begin() + end);
    part.pixels.assign(all.pixels.begin() + begin, all.pixels.begin() + end);
    return part;
}

//! RMS over all points of boards whose poses are fitted with everything else fixed.
double heldOutRms(const Boards& boards, const Ptr<RefractiveCamera>& camera)
{
    const double rms = scenes::rmsOfFittedPoses(boards.object, boards.pixels, camera);
    REQUIRE(std::isfinite(rms));
    return rms;
}

Ptr<RefractiveCamera> pinhole(const Boards& boards, Size size, double& rms)
{
    Mat K, D, rvecs, tvecs;
    rms = calibrateCamera(scenes::as<Point3f>(boards.object), scenes::as<Point2f>(boards.pixels), size, K, D, rvecs, tvecs);
    return RefractiveCamera::create(K, D);
}

GlassWindow waterSurface(double startDistance = 50)
{
    GlassWindow window;
    window.distance = startDistance;
    window.outerIndex = 1.333;
    return window;
}

//! The surface's normal and distance from boards in water, the lens from air.
Ptr<RefractiveCamera> behindWater(const Ptr<RefractiveCamera>& air, const Boards& boards, double& rms,
                                  double startDistance = 50)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(air->cameraMatrix(), air->distCoeffs(),
                                                                  waterSurface(startDistance));
    std::vector<Mat> rvecs, tvecs;
    rms = calibrateGlass(boards.object, noArray(), boards.pixels, camera, rvecs, tvecs, GLASS_FREE_DISTANCE);
    return camera;
}

//! The same with the air views in one fit with the water, the lens free, wrong corners left out.
Ptr<RefractiveCamera> jointlyBehindWater(const Ptr<RefractiveCamera>& air, const Boards& inAir, const Boards& inWater)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(air->cameraMatrix(), air->distCoeffs(), waterSurface());
    std::vector<Object> object = inWater.object;
    object.insert(object.end(), inAir.object.begin(), inAir.object.end());
    std::vector<Pixels> refracted = inWater.pixels, direct(inWater.pixels.size());
    refracted.resize(object.size());
    direct.insert(direct.end(), inAir.pixels.begin(), inAir.pixels.end());
    std::vector<Mat> rvecs, tvecs;
    calibrateGlass(object, direct, refracted, camera, rvecs, tvecs,
                   GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS | GLASS_ROBUST);
    return camera;
}

} // namespace

TEST_CASE("ouc_laser3d: lens from air, one flat surface fitted to water", "[real]")
{
    json data;
    if (!load("ouc_laser3d/corners.json", data))
        return;
    const Size size(data["image_size"][0], data["image_size"][1]);
    const Boards air = boardsOf(data, "air"), water = boardsOf(data, "water");
    REQUIRE(air.object.size() >= 10);
    REQUIRE(water.object.size() >= 10);

    double rmsAir, rmsWater, rmsRefit;
    const Ptr<RefractiveCamera> lens = pinhole(air, size, rmsAir);
    const Ptr<RefractiveCamera> surface = behindWater(lens, water, rmsWater);
    const double ignored = heldOutRms(water, lens);
    pinhole(water, size, rmsRefit);
    std::cout << "[numbers] ouc_laser3d, RMS px: air " << rmsAir << "; water: refraction ignored " << ignored
              << ", flat surface " << rmsWater << " (normal and distance), pinhole refitted " << rmsRefit
              << " (nine lens parameters)" << std::endl;
    CHECK(rmsWater < 0.30);
    CHECK(rmsWater < 0.15*ignored);
    for (double start : { 0., 100. })       // the distance is weakly determined, yet has one minimum
    {
        double rms;
        behindWater(lens, water, rms, start);
        CHECK(rms == Approx(rmsWater).epsilon(1e-6));
    }

    // Few-shot: calibrated on the first k water views, tested on all others.
    for (size_t k : { 1, 2 })
    {
        double rms;
        const Boards train = some(water, 0, k), test = some(water, k, water.object.size());
        const double refractive = heldOutRms(test, behindWater(lens, train, rms));
        const double joint = heldOutRms(test, jointlyBehindWater(lens, air, train));
        const double refit = heldOutRms(test, pinhole(train, size, rms));
        std::cout << "[numbers] ouc_laser3d, calibrated on " << k << " water view(s), tested on the others, RMS px: "
                  << "flat surface " << refractive << ", in one fit with the air views, robust " << joint
                  << ", pinhole refitted " << refit << std::endl;
        CHECK(refractive < refit);
        CHECK(joint < refractive);
        CHECK(joint < (k == 1 ? 0.36 : 0.29));
    }
}

TEST_CASE("ouc_laser3d: distance of a board in water, its air twin as truth", "[real]")
{
    json data;
    if (!load("ouc_laser3d/pair_airwater/points.json", data))
        return;
    Matx33d K;
    for (int i = 0; i < 9; i++)
        K.val[i] = data["K"][i/3][i%3];
    const Object object = objectOf(data["object_points_mm"]);
    std::map<int, Pixels> image;
    for (int i = 1; i <= 4; i++)
        image[i] = pixelsOf(data["image_points"]["cc_rect" + std::to_string(i) + ".png"]);

    // (water, air) images of the pair to learn from, then of the pair to test on
    const int sets[2][4] = { { 3, 4, 1, 2 }, { 1, 2, 3, 4 } };
    for (const auto& s : sets)
    {
        const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, noArray(), waterSurface());
        std::vector<Mat> rvecs, tvecs;
        calibrateGlass(std::vector<Object>(1, object), std::vector<Pixels>(1, image[s[1]]),
                       std::vector<Pixels>(1, image[s[0]]), camera, rvecs, tvecs, GLASS_FREE_DISTANCE);
        const Ptr<RefractiveCamera> air = RefractiveCamera::create(K, noArray());
        Vec3d rvec, truth, ignored, measured;
        std::vector<double> inAir, inWater, modelled;
        REQUIRE(refractiveSolvePnP(object, image[s[3]], air, rvec, truth, false, inAir));
        REQUIRE(refractiveSolvePnP(object, image[s[2]], air, rvec, ignored, false, inWater));
        REQUIRE(refractiveSolvePnP(object, image[s[2]], camera, rvec, measured, false, modelled));
        REQUIRE(inAir[0] < 1/std::sqrt(2.));
        REQUIRE(inWater[0] < 5/std::sqrt(2.));
        REQUIRE(modelled[0] < 2/std::sqrt(2.));
        const double errorIgnored = norm(ignored)/norm(truth) - 1, error = norm(measured)/norm(truth) - 1;
        std::cout << "[numbers] ouc_laser3d pair " << s[2] << "-" << s[3] << ", distance of the board from the water image: "
                  << "refraction ignored " << 100*errorIgnored << " %, fitted on the other pair " << 100*error << " %"
                  << std::endl;
        CHECK(std::abs(error) < 0.015);
        CHECK(std::abs(error) < 0.2*std::abs(errorIgnored));
    }
}

// ---- openptv_cavity: dots on three levels in water, seen through 6 mm glass

namespace {

struct TankCamera
{
    Matx33d K;
    Pixels pixels;              //!< NaN where the dot was not seen
    Vec3d nominalNormal;
    double nominalDistance;
};

TankCamera tankCamera(const json& data, int number)
{
    const json& c = data["cams"][std::to_string(number)];
    TankCamera camera;
    for (int i = 0; i < 9; i++)
        camera.K.val[i] = c["K_nominal"][i/3][i%3];
    camera.nominalNormal = Vec3d(c["normal_cam"][0], c["normal_cam"][1], c["normal_cam"][2]);
    camera.nominalDistance = c["d0_mm"];
    camera.pixels.assign(data["object_points_mm"].size(), Point2d(scenes::NaN, scenes::NaN));
    const Pixels seen = pixelsOf(c["image_points"]);
    for (size_t i = 0; i < seen.size(); i++)
        camera.pixels[c["point_index"][i].get<size_t>()] = seen[i];
    return camera;
}

//! A camera and the pose of the target in its frame.
struct Placed
{
    Ptr<RefractiveCamera> camera;
    Vec3d rvec, tvec;
};

//! Window of nominal thickness, indices and distance; normal and focal lengths from the dots.
Placed fitWindow(const TankCamera& tank, const Object& object)
{
    Placed placed;
    placed.camera = RefractiveCamera::create(tank.K, noArray(),
                                             GlassWindow(tank.nominalNormal, 6, 1.46, tank.nominalDistance, 1.33));
    std::vector<Mat> rvecs, tvecs;
    calibrateGlass(std::vector<Object>(1, object), noArray(), std::vector<Pixels>(1, tank.pixels), placed.camera, rvecs,
                   tvecs, GLASS_FREE_INTRINSICS | GLASS_FIX_PRINCIPAL_POINT);
    placed.rvec = rvecs[0];
    placed.tvec = tvecs[0];
    return placed;
}

Placed fitPinhole(const TankCamera& tank, const Object& object, int flags)
{
    std::vector<std::vector<Point3f>> objects(1);
    std::vector<std::vector<Point2f>> images(1);
    for (size_t i = 0; i < object.size(); i++)
        if (!std::isnan(tank.pixels[i].x))
        {
            objects[0].emplace_back(object[i]);
            images[0].emplace_back(tank.pixels[i]);
        }
    Mat K(tank.K, true), D;
    std::vector<Mat> rvecs, tvecs;
    calibrateCamera(objects, images, Size(1280, 1024), K, D, rvecs, tvecs,
                    flags | CALIB_USE_INTRINSIC_GUESS | CALIB_FIX_ASPECT_RATIO | CALIB_ZERO_TANGENT_DIST | CALIB_FIX_K2 |
                    CALIB_FIX_K3);
    Placed placed;
    placed.camera = RefractiveCamera::create(K, D);
    placed.rvec = rvecs[0];
    placed.tvec = tvecs[0];
    return placed;
}

//! 3-D RMS of the dots, triangulated by two placed cameras, in the target's frame.
double dotError(const Placed& a, const Placed& b, const TankCamera& tankA, const TankCamera& tankB, const Object& object)
{
    Matx33d Ra, Rb;
    Rodrigues(a.rvec, Ra);
    Rodrigues(b.rvec, Rb);
    const Matx33d R = Rb*Ra.t();
    const Vec3d T = b.tvec - R*a.tvec;
    Object points;
    std::vector<uchar> status;
    triangulateRefractive(a.camera, b.camera, R, T, tankA.pixels, tankB.pixels, points, status);
    double sum = 0;
    int count = 0, seenByBoth = 0;
    for (size_t i = 0; i < object.size(); i++)
    {
        seenByBoth += !std::isnan(tankA.pixels[i].x) && !std::isnan(tankB.pixels[i].x);
        if (status[i] != REFRACT_OK)
            continue;
        sum += norm(Ra.t()*(Vec3d(points[i]) - a.tvec) - Vec3d(object[i]), NORM_L2SQR);
        count++;
    }
    CHECK(count == seenByBoth);
    return std::sqrt(sum/count);
}

} // namespace

TEST_CASE("openptv_cavity: dots in water through glass, 3-D", "[real]")
{
    json data;
    if (!load("openptv_cavity/points.json", data))
        return;
    const Object object = objectOf(data["object_points_mm"]);
    const struct { int a, b; double limit; } pairs[] = { { 3, 4, 0.12 }, { 1, 2, 0.26 } };
    for (const auto& pair : pairs)
    {
        const TankCamera a = tankCamera(data, pair.a), b = tankCamera(data, pair.b);
        const double refractive = dotError(fitWindow(a, object), fitWindow(b, object), a, b, object);
        const int fOnly = CALIB_FIX_PRINCIPAL_POINT | CALIB_FIX_K1;
        const double f = dotError(fitPinhole(a, object, fOnly), fitPinhole(b, object, fOnly), a, b, object);
        const double fck = dotError(fitPinhole(a, object, 0), fitPinhole(b, object, 0), a, b, object);
        std::cout << "[numbers] openptv_cavity cameras " << pair.a << "+" << pair.b << ", 3-D RMS mm: pinhole f " << f
                  << ", pinhole f, c, k1 " << fck << ", air-glass-water " << refractive << std::endl;
        CHECK(refractive < pair.limit);
        CHECK(refractive < f);
        CHECK(refractive < fck);
    }
}

namespace {

//! Two passes of cv::StereoSGBM over a real pair; points in the rectified frame, and the way there.
struct DensePair
{
    Mat R1, R2, P1, P2, Q, points;

    DensePair(const Placed& a, const Placed& b, const Matx33d& R, const Vec3d& T, const Mat& image1, const Mat& image2, const Vec2d& range)
    {
        const Size size = image1.size();
        refractiveStereoRectify(a.camera, b.camera, R, T, size, range, R1, R2, P1, P2, Q, 0);
        const int nearest = cvCeil(disparityAt(range[0])) + 8, farthest = cvFloor(disparityAt(range[1])) - 8;
        const Ptr<StereoSGBM> matcher = StereoSGBM::create(farthest, (nearest - farthest + 15)/16*16, 9, 648, 2592, 1, 31, 5, 50, 2);
        Mat depth1(1, 1, CV_64F, Scalar(2/(1/range[0] + 1/range[1]))), depth2 = depth1, disparity;
        for (int pass = 0; pass < 2; pass++)
        {
            Mat map11, map12, map21, map22, rectified1, rectified2;
            initRefractiveStereoRectifyMap(a.camera, depth1, R1, P1, noArray(), size, CV_32FC1, map11, map12);
            initRefractiveStereoRectifyMap(b.camera, depth2, R2, P2, T, size, CV_32FC1, map21, map22);
            remap(image1, rectified1, map11, map12, INTER_CUBIC);
            remap(image2, rectified2, map21, map22, INTER_CUBIC);
            matcher->compute(rectified1, rectified2, disparity);
            disparity.convertTo(disparity, CV_32F, 1./StereoMatcher::DISP_SCALE);
            if (pass == 0)
                refractiveRectifiedDepth(disparity, P1, P2, size, depth1, depth2, true);
        }
        refractiveReprojectImageTo3D(disparity, points, a.camera, b.camera, R, T, R1, R2, P1, P2, depth1, depth2, true);
    }

    Vec2d shownAt(const Vec3d& X, const Mat& P) const
    {
        const Vec3d x = Matx34d(P.ptr<double>())*Vec4d(X[0], X[1], X[2], 1);
        return Vec2d(x[0]/x[2], x[1]/x[2]);
    }
    double disparityAt(double z) const { return shownAt(Vec3d(0, 0, z), P1)[0] - shownAt(Vec3d(0, 0, z), P2)[0]; }
};

} // namespace

TEST_CASE("openptv_cavity: the dots in depths of whole images", "[real]")
{
    json data;
    if (!load("openptv_cavity/points.json", data))
        return;
    const Object object = objectOf(data["object_points_mm"]);
    const TankCamera tankA = tankCamera(data, 3), tankB = tankCamera(data, 4);
    const std::string folder = paths::data() + "/openptv_cavity/cal/";
    const Mat image1 = imread(folder + "cam3.tif", IMREAD_GRAYSCALE), image2 = imread(folder + "cam4.tif", IMREAD_GRAYSCALE);
    REQUIRE(!image1.empty());
    double ours = 0;
    for (const bool ignored : { false, true })
    {
        const Placed a = ignored ? fitPinhole(tankA, object, CALIB_FIX_PRINCIPAL_POINT | CALIB_FIX_K1) : fitWindow(tankA, object);
        const Placed b = ignored ? fitPinhole(tankB, object, CALIB_FIX_PRINCIPAL_POINT | CALIB_FIX_K1) : fitWindow(tankB, object);
        Matx33d Ra, Rb;
        Rodrigues(a.rvec, Ra);
        Rodrigues(b.rvec, Rb);
        const Matx33d R = Rb*Ra.t();
        double near = scenes::INF, far = 0;
        for (const Point3d& X : object)
        {
            const double z = (Ra*Vec3d(X) + a.tvec)[2];
            near = std::min(near, z);
            far = std::max(far, z);
        }
        const DensePair dense(a, b, R, b.tvec - R*a.tvec, image1, image2, Vec2d(near - 20, far + 20));
        std::vector<double> errors;
        int seen = 0;
        for (size_t i = 0; i < object.size(); i++)
        {
            if (std::isnan(tankA.pixels[i].x) || std::isnan(tankB.pixels[i].x))
                continue;
            seen++;
            const Vec3d X = Matx33d(dense.R1.ptr<double>())*(Ra*Vec3d(object[i]) + a.tvec);
            const Vec2d at = dense.shownAt(X, dense.P1);
            const Point pixel(cvRound(at[0]), cvRound(at[1]));
            if (!Rect(Point(), image1.size()).contains(pixel) || std::isnan(dense.points.at<Vec3f>(pixel)[2]))
                continue;
            errors.push_back(std::abs(dense.points.at<Vec3f>(pixel)[2] - X[2]));
        }
        std::sort(errors.begin(), errors.end());
        REQUIRE(!errors.empty());
        std::cout << "[numbers] openptv_cavity cameras 3+4, cv::StereoSGBM in two passes, " << (ignored ? "pinhole f" : "air-glass-water")
                  << ": " << errors.size() << " of " << seen << " dots have a depth, its error is " << errors[errors.size()/2]
                  << " mm (median), " << errors[errors.size()*9/10] << " (90 %)" << std::endl;
        const double median = errors[errors.size()/2];
        if (ignored)
            CHECK(median > 3*ours);
        else
        {
            CHECK((int)errors.size() > 0.85*seen);
            CHECK(median < 0.1);
            ours = median;
        }
    }
}

TEST_CASE("One view of a real target in water: starts far apart end in one minimum", "[real][slow]")
{
    for (int cameraNumber = 1; cameraNumber <= 3; cameraNumber++)
    {
        const Dots dots = readDots(format("myptv/cam%d_cal_points", cameraNumber));
        if (dots.object.empty())
            return;
        for (int coefficients : { 0, 4 })
        {
            std::vector<double> rms;
            for (double focal : { 5400., 6600. })
                for (double distance : { 50., 400. })
                {
                    GlassWindow window;
                    window.distance = distance;
                    window.outerIndex = 1.33;
                    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(
                        Matx33d(focal, 0, 640, 0, focal, 512, 0, 0, 1), std::vector<double>(coefficients, 0.), window);
                    Mat rvecs, tvecs;
                    rms.push_back(calibrateGlass(std::vector<Object>{ dots.object }, noArray(), std::vector<Pixels>{ dots.pixels },
                                                 camera, rvecs, tvecs,
                                                 GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS | GLASS_FIX_TANGENT_DIST));
                }
            CAPTURE(cameraNumber, coefficients, rms);
            const auto ends = std::minmax_element(rms.begin(), rms.end());
            std::cout << "[numbers] myptv, camera " << cameraNumber << ", " << coefficients << " coefficients: " << *ends.first
                      << " to " << *ends.second << " px from four starts\n";
            CHECK(*ends.second - *ends.first < 1e-6);
        }
    }
}
