// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Which given value the images contradict: the one that is wrong, and not what its error makes look wrong.
#include "diagnose/hypothesis_tests.hpp"
#include "diagnose/causes.hpp"
#include "assess/rig_calibration.hpp"
#include "calibrate/fit.hpp"
#include "measure/distributions.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! A camera in a housing in water, calibrated from boards at known poses; `given` is what the caller believes.
RigCalibration calibrated(const GlassWindow& given, double poseError, bool areExact)
{
    scenes::Random random(3100);
    const GlassWindow port(Vec3d(0.05, -0.08, 1), 15, 1.49, 40, 1.333);
    RigModel rig = paperRig(1);
    rig.cameras[0]->setWindow(port);
    RigCalibration c;
    c.data.cameraCount = 1;
    c.data.imageSize[0] = Size(1280, 1024);
    for (int i = 0; i < 10; i++)
    {
        const Vec3d rvec = random.vector(0.4);
        const Vec3d tvec(random.uniform(-40, 40), random.uniform(-30, 30), random.uniform(500, 800));
        View view = observe(rig, board(6, 5), rvec, tvec, false, 0.1, random);
        const double degree = CV_PI/180;
        view.pose = KnownPose{rvec + 0.1*poseError*degree*random.vector(1), tvec + poseError*random.vector(1),
                           areExact ? Mat() : Mat(Mat::diag(Mat(Vec6d(1e-6, 1e-6, 1e-6, 1, 1, 1))))};
        c.data.views.push_back(view);
        c.fit.views.push_back(i);
    }
    c.options.window = given;
    c.options.flags = GLASS_USE_POSES;
    c.start = rig;
    c.start.cameras[0] = rig.cameras[0]->clone();
    c.start.cameras[0]->setWindow(given);
    c.fit = fitImages(c.data, c.start, c.fit.views, c.options.flags);
    return c;
}

std::string contradicted(const RigCalibration& c)
{
    std::string text;
    for (const Contradiction& contradiction : testGivenValues(c.data, c.options, c.fit))
        text += contradiction.sentence + '\n';
    return text;
}

//! NaN where the text does not begin so.
double numberAfter(const std::string& beginning, const std::string& text)
{
    return text.find(beginning) == 0 ? std::stod(text.substr(beginning.size())) : NAN;
}

const GlassWindow RIGHT(Vec3d(0, 0, 1), 15, 1.49, 40, 1.333);

} // namespace

TEST_CASE("Values given right are not contradicted", "[hypothesis_tests]")
{
    CHECK(contradicted(calibrated(RIGHT, 0, true)) == "");
}

TEST_CASE("Of values given, the one that is wrong is named", "[hypothesis_tests]")
{
    GlassWindow wrong = RIGHT;
    wrong.distance = 25;
    const std::string distance = contradicted(calibrated(wrong, 0, true));
    CAPTURE(distance);
    CHECK(numberAfter("the images contradict --distance=25: set free, the distance would be ", distance) == Approx(40).margin(0.2));
    CHECK(distance.find("--outer-index") == std::string::npos);

    wrong = RIGHT;
    wrong.outerIndex = 1.36;
    const std::string medium = contradicted(calibrated(wrong, 0, true));
    CAPTURE(medium);
    CHECK(numberAfter("the images contradict --outer-index=1.36: set free, the index of the scene's medium would be ", medium)
          == Approx(1.333).margin(1e-3));
}

TEST_CASE("A contradiction says by how much the fit is better, and of a lens, where it errs", "[hypothesis_tests]")
{
    // The lens of a file; its focal length is right, so that fx would be as before, with many standard deviations beside it.
    RigCalibration c = calibrated(RIGHT, 0, true);
    Mat lens = c.start.cameras[0]->lensParameters();
    const int K1 = 4;
    const double right = lens.at<double>(K1), wrong = right + 0.01;
    lens.at<double>(K1) = wrong;
    c.start.cameras[0]->setLensParameters(lens);
    c.options.known[0] = c.start.cameras[0]->clone();
    c.fit = fitImages(c.data, c.start, c.fit.views, c.options.flags);
    const std::string text = contradicted(c), beginning = "the images contradict --camera: set free, the lens would have k1 = ";
    CAPTURE(text);
    REQUIRE(text.find(beginning) != std::string::npos);
    CHECK(numberAfter(beginning, text.substr(text.find(beginning))) == Approx(right).margin(0.005));
    CHECK(text.find(format("in place of %.5g, a better fit by ", wrong)) != std::string::npos);
    CHECK(text.find(" sigma") != std::string::npos);
    CHECK(text.find("standard deviations away") == std::string::npos);
}

TEST_CASE("Of a lens that errs as a whole, no parameter is named", "[hypothesis_tests]")
{
    // One image of a flat board by a tele lens: each of its parameters, and the pose, does nearly what another does.
    scenes::Random random(3110);
    const GlassWindow port(Vec3d(0.05, -0.08, 1), 4, 1.49, 700, 1.333);
    const Matx33d K(8500, 0, 1151.5, 0, 8500, 859.5, 0, 0, 1);
    RigCalibration c;
    c.data.cameraCount = 1;
    c.data.imageSize[0] = Size(2304, 1720);
    RigModel rig;
    rig.add(RefractiveCamera::create(K, Vec4d(-0.1, 0, 0, 0), port), {});
    c.data.views.push_back(observe(rig, board(20, 15, 10), Vec3d(0.1, 0.2, 0), Vec3d(2, 3, 850), false, 0.1, random));
    c.fit.views = {0};
    c.options.window = port;
    c.start = rig;
    c.start.cameras[0] = RefractiveCamera::create(K, Vec4d(), port);
    c.options.known[0] = c.start.cameras[0]->clone();
    c.fit = fitImages(c.data, c.start, c.fit.views, c.options.flags);
    const std::string text = contradicted(c);
    CAPTURE(text);
    CHECK(text.find("the images contradict --camera: set free, the lens would differ as a whole, though in no parameter alone, "
                    "a better fit by ") != std::string::npos);
}

TEST_CASE("Of lenses given right, those that promise nothing are not fitted", "[hypothesis_tests]")
{
    // A lens of eight numbers explains eight units of chi^2 of right images, as one number explains one.
    scenes::Random random(3120);
    RigCalibration c;
    c.data.cameraCount = 3;
    c.start = paperRig(3);
    for (int camera = 0; camera < 3; camera++)
    {
        c.data.imageSize[camera] = Size(1280, 1024);
        c.options.known[camera] = c.start.cameras[camera]->clone();
    }
    c.options.window = paper::pane(50, Vec3d(0, 0, 1));
    for (int i = 0; i < 8; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        c.data.views.push_back(observe(c.start, board(6, 5), random.vector(0.4), tvec, false, 0.1, random));
        c.fit.views.push_back(i);
    }
    c.fit = fitImages(c.data, c.start, c.fit.views, c.options.flags);
    REQUIRE(causesOf(c.data, c.options, c.fit).size() > 6);
    for (const CauseTest& test : testCauses(c.data, c.options, c.fit))
    {
        CAPTURE(test.kind, test.parameters, test.deviance);
        CHECK(upperTailChiSquared(test.parameters, test.deviance) < 0.1);
    }
}

TEST_CASE("Layers given wrong are contradicted by their sum", "[hypothesis_tests]")
{
    GlassWindow layers = RIGHT;         // the same pane, in two
    layers.thickness = {10, 5};
    layers.index = {1.49, 1.49};
    CHECK(contradicted(calibrated(layers, 0, true)) == "");
    layers.thickness = {13, 5};
    const std::string thickness = contradicted(calibrated(layers, 0, true));
    CAPTURE(thickness);
    const size_t at = thickness.find("the images contradict --thickness: set free, the sum");       // the exact poses hide less
    REQUIRE(at != std::string::npos);
    CHECK(numberAfter("the images contradict --thickness: set free, the sum over the layers would be ", thickness.substr(at))
          == Approx(15).margin(0.3));
}

TEST_CASE("Poses that are not as exact as they are said to be are named first", "[hypothesis_tests]")
{
    const std::string exact = contradicted(calibrated(RIGHT, 1, true));
    CAPTURE(exact);
    CHECK(exact.find("the images contradict --poses, which are taken as exact") == 0);
    CHECK(exact.find("sigma_deg") != std::string::npos);
    CHECK(exact.find("--outer-index") == std::string::npos);
    CHECK(contradicted(calibrated(RIGHT, 1, false)).find("--poses") == std::string::npos);
}
