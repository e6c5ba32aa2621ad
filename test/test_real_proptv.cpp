// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Four real cameras behind one wall of a tank (proPTV's comparison). A lens with more coefficients than one view determines: for two
// of the cameras the least error lies where the wall would pass through the nearest markers, and that is refused. And the lens that
// the markers can carry, by their own comparison's protocol, beside OpenPTV and MyPTV.
#include "real_data.hpp"
#include <opencv2/calib3d.hpp>
#include <functional>

using namespace cv;
using namespace cv::refract;
using namespace real_data;

TEST_CASE("A lens that one view hardly determines is answered within 100 iterations, or refused", "[real]")
{
    int answers = 0;
    for (int c = 0; c < 4; c++)
    {
        const Dots all = readDots(format("proptv/markers_c%d.txt", c));
        if (all.object.empty())
            return;
        for (int half = 0; half < 2; half++)
        {
            Dots some;
            for (size_t i = half; i < all.object.size(); i += 2)
            {
                some.object.push_back(all.object[i]);
                some.pixels.push_back(all.pixels[i]);
            }
            GlassWindow window;
            window.distance = 300;
            window.outerIndex = 1.333;
            const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(2000, 0, 1024, 0, 2000, 1024, 0, 0, 1),
                                                                          std::vector<double>(5, 0.), window);
            Mat rvecs, tvecs, deviations;
            double rms = 0;
            const std::string refusal = scenes::thrown([&]
            {
                rms = calibrateGlass(std::vector<std::vector<Point3d> >{ some.object }, noArray(),
                                     std::vector<std::vector<Point2d> >{ some.pixels }, camera, rvecs, tvecs, deviations, noArray(),
                                     noArray(), noArray(), GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS,
                                     TermCriteria(TermCriteria::COUNT | TermCriteria::EPS, 100, 1e-9));
            });
            CAPTURE(c, half, refusal);
            if (!refusal.empty())
            {
                std::cout << "[numbers] proptv, camera " << c << ", half " << half << ", five coefficients: refused\n";
                CHECK(refusal.find("touches the window of camera 1") != std::string::npos);
                continue;
            }
            answers++;
            std::cout << "[numbers] proptv, camera " << c << ", half " << half << ", five coefficients: " << rms << " px, distance "
                      << camera->window().distance << " +- " << deviations.at<double>(12) << " mm, focal length "
                      << camera->cameraMatrix().at<double>(0, 0) << " +- " << deviations.at<double>(0) << " px\n";
            CHECK(rms < 1);
        }
    }
    CHECK(answers >= 4);
}

namespace {

const int CAMERAS = 4;

//! The markers, which all cameras see, and where each saw them.
struct Markers
{
    Object object;
    std::vector<Pixels> pixels;

    Markers where(const std::function<bool(const Point3d&)>& wanted) const
    {
        Markers some;
        some.pixels.resize(pixels.size());
        for (size_t i = 0; i < object.size(); i++)
        {
            if (!wanted(object[i]))
                continue;
            some.object.push_back(object[i]);
            for (size_t c = 0; c < pixels.size(); c++)
                some.pixels[c].push_back(pixels[c][i]);
        }
        return some;
    }
};

//! Empty where the data are absent.
Markers loadMarkers()
{
    Markers markers;
    for (int c = 0; c < CAMERAS; c++)
    {
        const Dots dots = readDots(format("proptv/markers_c%d.txt", c));
        if (dots.object.empty())
            return Markers();
        REQUIRE((c == 0 || dots.object == markers.object));
        markers.object = dots.object;
        markers.pixels.push_back(dots.pixels);
    }
    return markers;
}

//! What is measured of all or other markers.
struct Measured
{
    double rms;                 //!< 3-D, mm
    int missing;                //!< markers without an answer
    int coefficients;
};

const int CHOSEN = -1, WITH_LEFT_OUT = -2;      // in place of flags: by selectLensCoefficients; the same, with what it leaves open

//! Calibrated on some markers, without a word on wall and lens but rough values; the lens chosen, or as flags say. All are missing where
//! the calibration does not converge.
Measured calibrateAndMeasure(const Markers& train, const Markers& test, int fixed = CHOSEN)
{
    GlassWindow wall;
    wall.distance = 300;
    wall.outerIndex = 1.333;
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<std::vector<Mat> > pixels;
    for (int c = 0; c < CAMERAS; c++)
    {
        cameras.push_back(RefractiveCamera::create(Matx33d(2000, 0, 1023.5, 0, 2000, 1023.5, 0, 0, 1), std::vector<double>(8, 0.), wall));
        pixels.push_back({ Mat(train.pixels[c], true) });
    }
    const std::vector<Object> object = { train.object };
    const std::vector<int> windows(CAMERAS, 0);
    const int flags = GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS;
    Mat_<double> scores;
    std::vector<Mat> leftOut;
    const bool isOpen = fixed == WITH_LEFT_OUT;
    if (fixed < 0)
        fixed = selectLensCoefficients(object, {}, pixels, cameras, windows, noArray(), noArray(), flags, scores, leftOut);
    Measured measured = { 0, 0, -1 };
    for (int i = 0; i < scores.rows; i++)
        if ((int)scores(i, 0) == fixed)
            measured.coefficients = (int)scores(i, 1);
    std::vector<Mat> Rs, Ts, rvecs, tvecs;
    try
    {
        GlassRigOptions options(flags | fixed);
        if (isOpen)
            options.cameraCovariances = leftOut;
        calibrateGlassRig(object, {}, pixels, cameras, windows, Rs, Ts, rvecs, tvecs, options);
    }
    catch (const CalibrationError&)
    {
        measured.rms = scenes::INF;
        measured.missing = (int)test.object.size();
        return measured;
    }
    std::vector<Mat> seen;
    for (const Pixels& ofCamera : test.pixels)
        seen.push_back(Mat(ofCamera));
    Object points;
    std::vector<uchar> status;
    triangulateRefractive(cameras, Rs, Ts, seen, points, status);
    Matx33d R;
    Rodrigues(rvecs[0], R);
    double sum = 0;
    for (size_t i = 0; i < points.size(); i++)
    {
        measured.missing += status[i] != REFRACT_OK;
        if (status[i] == REFRACT_OK)
            sum += norm(R.t()*(Vec3d(points[i]) - Vec3d(tvecs[0].ptr<double>())) - Vec3d(test.object[i]), NORM_L2SQR);
    }
    measured.rms = std::sqrt(sum/((double)points.size() - measured.missing));
    return measured;
}

//! Of the files that hold what others made of the same pixels: X Y Z dX dY dZ.
double rmsOfOthers(const std::string& path)
{
    std::ifstream file = open("proptv/" + path);
    std::string heading;
    if (std::isalpha(file.peek()))
        std::getline(file, heading);
    double sum = 0;
    int count = 0;
    for (double x, y, z, dx, dy, dz; file >> x >> y >> z >> dx >> dy >> dz; count++)
        sum += dx*dx + dy*dy + dz*dz;
    return std::sqrt(sum/count);
}

bool isOnPlane(const Point3d& X, const std::vector<double>& planes)
{
    return std::any_of(planes.begin(), planes.end(), [&](double z) { return std::abs(X.z - z) < 1; });
}

} // namespace

TEST_CASE("proptv: the lens that the markers can carry, beside OpenPTV and MyPTV", "[real][slow]")
{
    const Markers all = loadMarkers();
    if (all.object.empty())
        return;
    const Measured everywhere = calibrateAndMeasure(all, all);
    const Measured between = calibrateAndMeasure(all.where([](const Point3d& X) { return isOnPlane(X, { 26, 150, 274 }); }), all);
    const Measured beyond = calibrateAndMeasure(all.where([](const Point3d& X) { return isOnPlane(X, { 88, 150, 212 }); }), all);
    const Measured open = calibrateAndMeasure(all.where([](const Point3d& X) { return isOnPlane(X, { 88, 150, 212 }); }), all,
                                              WITH_LEFT_OUT);
    std::cout << "[numbers] proptv, 3-D RMS of 1805 markers, calibrated on all / for interpolation / for extrapolation: "
              << everywhere.rms << " / " << between.rms << " / " << beyond.rms << " mm, " << everywhere.missing << " / "
              << between.missing << " / " << beyond.missing << " without an answer, with " << everywhere.coefficients << " / "
              << between.coefficients << " / " << beyond.coefficients << " coefficients; OpenPTV "
              << rmsOfOthers("openptv_errors_allmarkers.txt") << " / " << rmsOfOthers("openptv_errors_interpolation.txt") << " / "
              << rmsOfOthers("openptv_errors_extrapolation.txt") << "; MyPTV, extended Zolof, all: "
              << rmsOfOthers("myptv_errors_ExtendedZolof.txt") << ", Tsai: " << rmsOfOthers("myptv_errors_Tsai.txt")
              << "; extrapolation with what was left out: " << open.rms << std::endl;
    CHECK(everywhere.rms < 0.33);
    CHECK(between.rms < 0.38);
    CHECK(beyond.rms < 0.445);
    CHECK(open.rms < 0.45);
    CHECK(everywhere.missing + between.missing + beyond.missing == 0);
}

TEST_CASE("proptv: calibrated on the middle, the lens holds outside it", "[real][slow]")
{
    const Markers all = loadMarkers();
    if (all.object.empty())
        return;
    const auto isInside = [](const Point3d& X) { return X.x > 100 && X.x < 200 && X.y > 100 && X.y < 200; };
    const Markers middle = all.where(isInside), outside = all.where([&](const Point3d& X) { return !isInside(X); });
    REQUIRE(middle.object.size() == 245);
    const Measured chosen = calibrateAndMeasure(middle, outside), open = calibrateAndMeasure(middle, outside, WITH_LEFT_OUT);
    const int tangent = GLASS_FIX_TANGENT_DIST | GLASS_FIX_K3 | GLASS_FIX_K4 | GLASS_FIX_K5 | GLASS_FIX_K6;
    const Measured none = calibrateAndMeasure(middle, outside, tangent | GLASS_FIX_K1 | GLASS_FIX_K2);
    const Measured two = calibrateAndMeasure(middle, outside, tangent);
    std::cout << "[numbers] proptv, calibrated on the 245 markers of the middle, 3-D RMS of the other 1560: " << chosen.rms << " mm with "
              << chosen.coefficients << " coefficients, " << chosen.missing << " without an answer; none: " << none.rms << ", two: "
              << two.rms << "; with what was left out: " << open.rms << std::endl;
    CHECK(chosen.missing == 0);
    CHECK(open.rms <= chosen.rms);
    CHECK(chosen.rms <= 1.03*std::min(none.rms, two.rms));
}
