// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The stated uncertainty of points measured by one camera, against draws of calibration and pixels.
#include "measure/consistency.hpp"
#include "measure/measurement.hpp"
#include "measure/point_error.hpp"
#include "calibrate/parameter_columns.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double PIXEL = 0.05, FOCAL = 2., THICKNESS = 0.05, TILT = 1e-3;

//! A camera whose focal lengths, thickness and normal are known only so far.
Calibration uncertain(const RigModel& rig)
{
    Calibration c = calibrationOf(rig);
    const ParameterColumns at = columnsOf(rig, 0);
    c.covariance = Mat::zeros(at.end, at.end, CV_64F);
    c.covariance.at<double>(at.lens, at.lens) = c.covariance.at<double>(at.lens + 1, at.lens + 1) = FOCAL*FOCAL;
    c.covariance.at<double>(at.thickness, at.thickness) = THICKNESS*THICKNESS;
    const Vec3d n = rig.cameras[0]->window().normal;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.covariance.at<double>(at.normal + i, at.normal + j) = TILT*TILT*((i == j) - n[i]*n[j]);
    return c;
}

Calibration drawn(const RigModel& rig, scenes::Random& random)
{
    RigModel other = rig.clone();
    Mat lens = other.cameras[0]->lensParameters();
    lens.at<double>(0) += random.normal(FOCAL);
    lens.at<double>(1) += random.normal(FOCAL);
    GlassWindow window = other.cameras[0]->window();
    window.thickness[0] += random.normal(THICKNESS);
    window.normal = normalize(window.normal + Vec3d(random.normal(TILT), random.normal(TILT), random.normal(TILT)));
    other.cameras[0]->setLensParameters(lens);
    other.cameras[0]->setWindow(window);
    return calibrationOf(other);
}

//! Measures the same pixels with drawn calibrations and noise; checks sigma against the spread, coordinate by coordinate.
template <class Measure>
void checkSpread(const RigModel& rig, const std::vector<Point2d>& pixels, unsigned salt, const Measure& measure)
{
    scenes::Random random(salt);
    std::cout << "seed " << scenes::seed() << '\n';
    const Measurement stated = measure(uncertain(rig), pixels);
    const int trials = 1500;
    std::vector<Vec3d> squares(pixels.size());
    for (int t = 0; t < trials; t++)
    {
        std::vector<Point2d> noisy = pixels;
        for (Point2d& p : noisy)
            p += Point2d(random.normal(PIXEL), random.normal(PIXEL));
        const Measurement m = measure(drawn(rig, random), noisy);
        for (size_t i = 0; i < pixels.size(); i++)
        {
            const Vec3d d = m.points[i] - stated.points[i];
            squares[i] += d.mul(d)*(1./trials);
        }
    }
    for (size_t i = 0; i < pixels.size(); i++)
        for (int k = 0; k < 3; k++)
        {
            CAPTURE(i, k);
            CHECK(stated.sigma[i][k] == Approx(std::sqrt(squares[i][k])).epsilon(0.08).margin(1e-9));
        }
}

Target smallBoard()
{
    TargetOptions options;
    options.size = "6x5";
    options.square = 39;
    return Target(options);
}

std::vector<Point2d> seenBy(const Ptr<RefractiveCamera>& camera, const Target& target)
{
    std::vector<Point2d> pixels;
    refractiveProjectPoints(target.objectPoints(), Vec3d(0.2, 0.3, 0.1), Vec3d(-100, -80, 620), camera, pixels);
    return pixels;
}

} // namespace

TEST_CASE("Points on a plane carry the calibration's uncertainty", "[measurement]")
{
    const RigModel rig = paperRig(1);
    checkSpread(rig, {{100, 100}, {640, 500}, {1200, 900}}, 3020, [](const Calibration& c, const std::vector<Point2d>& pixels) {
        return measureOnPlane(c, pixels, Vec4d(0.1, -0.2, 1, 600), PIXEL);
    });
}

TEST_CASE("Points of a target of known shape carry the calibration's uncertainty", "[measurement]")
{
    const RigModel rig = paperRig(1);
    const Target target = smallBoard();
    const std::vector<Point2d> pixels = seenBy(rig.cameras[0], target);
    checkSpread(rig, pixels, 3021, [&target](const Calibration& c, const std::vector<Point2d>& p) {
        return measureTarget(c, target.objectPoints(), p, PIXEL);
    });
}

namespace {

//! What two cameras see of a board, with noise; `off` is added to the second pixel of point 7, across its epipolar curve.
Measurement seenByTwo(const Calibration& calibration, double noise, Point2d off, scenes::Random& random,
                      std::vector<Point3d>* truth = nullptr)
{
    const std::vector<Point3d> object = board(6, 5);
    const Vec3d rvec(0.2, 0.1, 0.05), tvec(-20, 10, 620);
    Matx33d rotation;
    Rodrigues(rvec, rotation);
    std::vector<Point3d> points;
    for (const Point3d& p : object)
        points.push_back(Point3d(rotation*Vec3d(p) + tvec));
    std::vector<Point2d> pixels[2];
    Vec3d rig;
    Rodrigues(calibration.extrinsics[1].R, rig);
    refractiveProjectPoints(points, Vec3d(), Vec3d(), calibration.cameras[0].camera, pixels[0]);
    refractiveProjectPoints(points, rig, calibration.extrinsics[1].t, calibration.cameras[1].camera, pixels[1]);
    for (std::vector<Point2d>& image : pixels)
        for (Point2d& p : image)
            p += Point2d(random.normal(noise), random.normal(noise));
    pixels[1][7] += off;
    if (truth)
        *truth = points;
    return measureRig(calibration, {pixels[0], pixels[1]}, PIXEL);
}

} // namespace

TEST_CASE("Partners that agree within the noise keep their uncertainty", "[measurement]")
{
    Calibration c = calibrationOf(paperRig(2));
    for (const bool calibrationIsUncertain : {false, true})
    {
        if (calibrationIsUncertain)
        {
            // Wrong by what the covariance says: the normal of camera 2, by several pixels' noise.
            const ParameterColumns at = columnsOf(paperRig(2), 1);
            c.covariance = Mat::zeros(at.end + 6, at.end + 6, CV_64F);
            const Vec3d n = c.cameras[1].camera->window().normal;
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    c.covariance.at<double>(at.normal + i, at.normal + j) = 0.01*0.01*((i == j) - n[i]*n[j]);
        }
        scenes::Random random(3040);
        int flagged = 0, inflated = 0, all = 0;
        for (int trial = 0; trial < 100; trial++)
        {
            RigModel rig = paperRig(2);
            if (calibrationIsUncertain)
            {
                GlassWindow window = rig.cameras[1]->window();
                window.normal = normalize(window.normal + Vec3d(random.normal(0.01), random.normal(0.01), random.normal(0.01)));
                rig.cameras[1]->setWindow(window);
            }
            Measurement m = seenByTwo(calibrationOf(rig), PIXEL, {}, random);
            m = measureRig(c, m.pixels, PIXEL);
            const Measurement before = m;
            checkConsistency(c, PIXEL, m);
            flagged += m.inconsistent();
            for (size_t i = 0; i < m.points.size(); i++, all++)
                inflated += m.sigma[i][2] > 1.001*before.sigma[i][2];
        }
        CAPTURE(calibrationIsUncertain, flagged, inflated, all);
        CHECK(flagged <= 1);
        CHECK(inflated < 0.02*all);
    }
}

TEST_CASE("A partner off its curve has the uncertainty of its misfit, a far one no point", "[measurement]")
{
    const Calibration c = calibrationOf(paperRig(2));
    scenes::Random random(3041);
    std::vector<Point3d> truth;
    const Measurement clean = seenByTwo(c, 0., {}, random, &truth);
    const struct { double off; uchar status; bool answer; } cases[] = {
        {0., 0, true}, {0.9, INCONSISTENT, true}, {2., INCONSISTENT, true}, {30., INCONSISTENT, false}};
    for (const auto& k : cases)
    {
        CAPTURE(k.off);
        Measurement m = seenByTwo(c, 0., Point2d(0, k.off), random);       // the baseline is along x
        checkConsistency(c, PIXEL, m);
        CHECK(m.status[7] == k.status);
        CHECK((m.points[7].z == m.points[7].z) == k.answer);
        CHECK(m.inconsistent() == (k.status ? 1 : 0));
        CHECK(m.answers() == (k.answer ? 30 : 29));
        CHECK(norm(m.sigma[8] - clean.sigma[8]) < 1e-9);
        if (k.off > 0 && k.answer)
        {
            CHECK(m.sigma[7][2] > 0.4*k.off/PIXEL*clean.sigma[7][2]);
            CHECK(norm(Vec3d(m.points[7] - truth[7])) < 3*norm(m.sigma[7]));
        }
    }
    // Without a stated noise only what is gross can be told.
    Measurement unknown = seenByTwo(c, 0., Point2d(0, 30), random);
    checkConsistency(c, std::numeric_limits<double>::quiet_NaN(), unknown);
    CHECK(unknown.inconsistent() == 1);
    CHECK(unknown.answers() == 29);
}

TEST_CASE("Images noisier than the calibration's make all their points less certain", "[measurement]")
{
    const Calibration c = calibrationOf(paperRig(2));
    scenes::Random random(3042);
    double squares = 0;
    int count = 0, flagged = 0, noticed = 0;
    for (int trial = 0; trial < 100; trial++)
    {
        std::vector<Point3d> truth;
        Measurement m = seenByTwo(c, 3*PIXEL, {}, random, &truth);
        checkConsistency(c, PIXEL, m);
        flagged += m.inconsistent();
        noticed += std::abs(m.noise - 3*PIXEL) < 1.5*PIXEL;
        for (size_t i = 0; i < truth.size(); i++)
            for (int k = 0; k < 3 && m.points[i].x == m.points[i].x; k++, count++)
                squares += std::pow((Vec3d(m.points[i])[k] - Vec3d(truth[i])[k])/m.sigma[i][k], 2);
    }
    CAPTURE(flagged, noticed);
    CHECK(flagged < 30);        // of 3000
    CHECK(noticed > 85);
    CHECK(std::sqrt(squares/count) == Approx(1.).epsilon(0.15));
}

TEST_CASE("A pose carries its residuals, if they are larger than the noise", "[measurement]")
{
    const RigModel rig = paperRig(1);
    const Target target = smallBoard();
    std::vector<Point2d> pixels = seenBy(rig.cameras[0], target);
    scenes::Random random(3043);
    const Calibration c = calibrationOf(rig);
    const Measurement exact = measureTarget(c, target.objectPoints(), pixels, PIXEL);
    for (Point2d& p : pixels)
        p += Point2d(random.normal(10), random.normal(10));
    Measurement m = measureTarget(c, target.objectPoints(), pixels, PIXEL);
    CHECK(m.noise == Approx(10).epsilon(0.3));
    for (size_t i = 0; i < pixels.size(); i++)
        for (int k = 0; k < 3; k++)
            CHECK(m.sigma[i][k] == Approx(m.noise/PIXEL*exact.sigma[i][k]).epsilon(0.3));
    CHECK(m.inconsistent() == 0);
    checkPose(PIXEL, m);
    CHECK(m.inconsistent() == 30);
    CHECK(m.answers() == 30);
}

TEST_CASE("The error map grows with the range and knows what two cameras do not see", "[point_error]")
{
    const Calibration one = calibrationOf(paperRig(1)), two = calibrationOf(paperRig(2));
    double last = 0.;
    for (double z : {400., 600., 1200.})
    {
        const ErrorMap map = mapErrors(two, z, 0.1, 9);
        REQUIRE(map.seen());
        CHECK(map.median() > last);
        CHECK(map.worst() >= map.median());
        CHECK(map.worst() == map.worstPixelNoise());        // the calibration is exact
        last = map.median();
        CHECK(mapErrors(one, z, 0.1, 9).median() == Approx(std::sqrt(2.)*0.1*z/2438.).epsilon(0.15));
    }
    CHECK_FALSE(mapErrors(two, 5000., 0.1, 9).median() < last);
    CHECK_FALSE(mapErrors(two, 60., 0.1, 9).seen());        // inside the glass
    const ErrorMap sure = mapErrors(one, 600., 0.1, 9), unsure = mapErrors(uncertain(paperRig(1)), 600., 0.1, 9);
    CHECK(unsure.worst() > 1.5*sure.worst());
    CHECK(unsure.worstPixelNoise() == Approx(sure.worst()));
}
