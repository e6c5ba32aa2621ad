// The stated uncertainty of points measured by one camera, against draws of calibration and pixels.
#include "measurement.hpp"
#include "paper_rig.hpp"
#include "point_error.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

const double PIXEL = 0.05, FOCAL = 2., THICKNESS = 0.05, TILT = 1e-3;

//! A camera whose focal lengths, thickness and normal are known only so far.
Calibration uncertain(const Rig& rig)
{
    Calibration c = calibrationOf(rig);
    const ParameterColumns at = columnsOf(rig, 0);
    c.covariance = Mat::zeros(at.end, at.end, CV_64F);
    c.covariance.at<double>(at.lens, at.lens) = c.covariance.at<double>(at.lens + 1, at.lens + 1) = FOCAL * FOCAL;
    c.covariance.at<double>(at.thickness, at.thickness) = THICKNESS * THICKNESS;
    const Vec3d n = rig.cameras[0]->window().normal;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.covariance.at<double>(at.normal + i, at.normal + j) = TILT * TILT * ((i == j) - n[i] * n[j]);
    return c;
}

Calibration drawn(const Rig& rig, scenes::Random& random)
{
    Rig other = rig.clone();
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
void checkSpread(const Rig& rig, const std::vector<Point2d>& pixels, unsigned salt, const Measure& measure)
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
            squares[i] += d.mul(d) * (1. / trials);
        }
    }
    for (size_t i = 0; i < pixels.size(); i++)
        for (int k = 0; k < 3; k++)
        {
            CAPTURE(i, k);
            CHECK(stated.sigma[i][k] == Approx(std::sqrt(squares[i][k])).epsilon(0.08).margin(1e-9));
        }
}

} // namespace

TEST_CASE("Points on a plane carry the calibration's uncertainty", "[measurement]")
{
    const Rig rig = paperRig(1);
    checkSpread(rig, {{100, 100}, {640, 500}, {1200, 900}}, 3020, [](const Calibration& c, const std::vector<Point2d>& pixels) {
        return measureOnPlane(c, pixels, Vec4d(0.1, -0.2, 1, 600), PIXEL);
    });
}

TEST_CASE("Points of a target of known shape carry the calibration's uncertainty", "[measurement]")
{
    const Rig rig = paperRig(1);
    TargetOptions options;
    options.size = "6x5";
    options.square = 39;
    const Target target(options);
    std::vector<Point2d> pixels;
    refractiveProjectPoints(target.objectPoints(), Vec3d(0.2, 0.3, 0.1), Vec3d(-100, -80, 620), rig.cameras[0], pixels);
    checkSpread(rig, pixels, 3021, [&target](const Calibration& c, const std::vector<Point2d>& p) {
        return measureTarget(c, target, p, PIXEL);
    });
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
        CHECK(map.worst() == map.worstOfPixels());          // the calibration is exact
        last = map.median();
        CHECK(mapErrors(one, z, 0.1, 9).median() == Approx(std::sqrt(2.) * 0.1 * z / 2438.).epsilon(0.15));
    }
    CHECK_FALSE(mapErrors(two, 5000., 0.1, 9).median() < last);
    CHECK_FALSE(mapErrors(two, 60., 0.1, 9).seen());        // inside the glass
    const ErrorMap sure = mapErrors(one, 600., 0.1, 9), unsure = mapErrors(uncertain(paperRig(1)), 600., 0.1, 9);
    CHECK(unsure.worst() > 1.5 * sure.worst());
    CHECK(unsure.worstOfPixels() == Approx(sure.worst()));
}
