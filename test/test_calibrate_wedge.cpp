// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The wedge of a pane, estimated with the normal: at one range the two are hard to tell apart.
#include "problem_scenes.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const double ARC_MINUTE = CV_PI/180/60;
const int NORMAL = 8, WEDGE = 16;       // rows of a camera: 8 of the lens; normal, distance, thickness, index, inner, outer, wedge

RigTruth truthWith(const Vec2d& wedge, double outerIndex = 1)
{
    RigTruth truth = makeRig(1, { 0 }, outerIndex);
    GlassWindow window = truth.cameras[0]->window();
    window.wedge = { wedge };
    truth.cameras[0]->setWindow(window);
    return truth;
}

//! Nothing is known of the wedge.
RigCall callWithoutWedge(const RigTruth& truth, const RigScene& scene)
{
    RigCall made(truth, scene, true);
    for (const Ptr<RefractiveCamera>& camera : made.cameras)
    {
        GlassWindow window = camera->window();
        window.wedge.clear();
        camera->setWindow(window);
    }
    return made;
}

//! Radians.
double normalError(const RigCall& call, const RigTruth& truth)
{
    return angleBetween(call.cameras[0]->window().normal, truth.cameras[0]->window().normal)*CV_PI/180;
}

//! Largest standard deviation of the normal.
double normalSigma(const RigCall& call)
{
    Mat values;
    eigen(call.covariance(Rect(NORMAL, NORMAL, 3, 3)), values);
    return std::sqrt(values.at<double>(0));
}

//! Of the lens and the window: only the wedge is known, with this standard deviation.
Mat ofWedge(double sigma)
{
    Mat covariance(WEDGE + 2, WEDGE + 2, CV_64F, Scalar(0));
    for (int i = 0; i < WEDGE; i++)
        covariance.at<double>(i, i) = NaN;
    covariance.at<double>(WEDGE, WEDGE) = covariance.at<double>(WEDGE + 1, WEDGE + 1) = sigma*sigma;
    return covariance;
}

void runWithPrior(RigCall& call, const Mat& prior, int flags)
{
    call.run(flags, { prior });
}

} // namespace

TEST_CASE("Pairs at several ranges give normal and wedge back", "[wedge]")
{
    Random random(61);
    CAPTURE(seed());
    for (double outerIndex : { 1., 1.333 })
        for (const Vec2d& wedge : { Vec2d(), Vec2d(1, 0), Vec2d(-2, 3), Vec2d(30, -20) })
        {
            CAPTURE(outerIndex, wedge);
            const RigTruth truth = truthWith(ARC_MINUTE*wedge, outerIndex);
            const RigScene scene = makeRigScene(truth, ObjectViews(8, board()), random, 0, 400, 900);
            RigCall call = callWithoutWedge(truth, scene);
            CHECK(call.run(GLASS_FREE_WEDGE | (outerIndex > 1 ? GLASS_FREE_DISTANCE : 0)) < 1e-6);
            REQUIRE(call.cameras[0]->window().wedge.size() == 1);
            CHECK(normalError(call, truth) < 1e-6);
            CHECK(norm(call.cameras[0]->window().wedge[0] - ARC_MINUTE*wedge) < 1e-2*ARC_MINUTE);
            CHECK(call.stdDeviations.rows == WEDGE + 2);
            CHECK(call.stdDeviations.at<double>(WEDGE) > 0);
        }
}

TEST_CASE("A wedge that is ignored looks like a tilt; estimated, errors are what is stated", "[wedge]")
{
    CAPTURE(seed());
    const int TRIALS = 20;
    const RigTruth truth = truthWith(ARC_MINUTE*Vec2d(1, 0));
    double ignored = 0, ofNormal = 0, ofWedge = 0, stated = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(700 + trial);
        const RigScene scene = makeRigScene(truth, ObjectViews(10, board()), random, 0.1);
        RigCall without = callWithoutWedge(truth, scene), with = without;
        with.cameras = { without.cameras[0]->clone() };
        without.run(0);
        with.run(GLASS_FREE_WEDGE);
        ignored += std::pow(normalError(without, truth)/normalSigma(without), 2)/TRIALS;
        stated += std::pow(normalSigma(with), 2)/TRIALS;
        for (int i = 0; i < 2; i++)
            ofWedge += std::pow((with.cameras[0]->window().wedge[0][i] - truth.cameras[0]->window().wedge[0][i])/
                                with.stdDeviations.at<double>(WEDGE + i), 2)/(2*TRIALS);
        const Vec3d error = with.cameras[0]->window().normal - truth.cameras[0]->window().normal;
        const Mat inverse = with.covariance(Rect(NORMAL, NORMAL, 3, 3)).inv(DECOMP_SVD);
        ofNormal += Mat(Mat(error).t()*inverse*Mat(error)).at<double>(0)/(2*TRIALS);
    }
    std::cout << "[numbers] wedge of 1 arc minute, 10 pairs in air: ignored, the normal is off by " << std::sqrt(ignored)
              << " stated standard deviations; estimated, error over stated " << std::sqrt(ofNormal) << " (normal, +- "
              << std::sqrt(stated)*180/CV_PI << " degrees), " << std::sqrt(ofWedge) << " (wedge)" << std::endl;
    CHECK(ignored > 10*10);
    CHECK(std::abs(ofNormal - 1) < 4/std::sqrt(2.*TRIALS)*std::sqrt(2.));       // chi^2 of 2 TRIALS
    CHECK(std::abs(ofWedge - 1) < 4/std::sqrt(2.*TRIALS)*std::sqrt(2.));
}

TEST_CASE("What a data sheet says of a wedge is a prior", "[wedge]")
{
    Random random(63);
    CAPTURE(seed());
    const RigTruth truth = truthWith(ARC_MINUTE*Vec2d(0.7, -0.4));
    const RigScene scene = makeRigScene(truth, ObjectViews(4, board()), random, 0.1);
    double last = 0;
    for (double sigma : { 0.01, 0.3, 1., 3. })
    {
        CAPTURE(sigma);
        RigCall call = callWithoutWedge(truth, scene);
        runWithPrior(call, ofWedge(sigma*ARC_MINUTE), GLASS_FREE_WEDGE);
        CHECK(normalSigma(call) > last);
        std::cout << "[numbers] wedge known to " << sigma << " arc minutes, 4 pairs in air: normal +- " << normalSigma(call)*180/CV_PI
                  << " degrees, off by " << normalError(call, truth)*180/CV_PI << "; wedge "
                  << call.cameras[0]->window().wedge[0]/ARC_MINUTE << " arc minutes" << std::endl;
        CHECK(call.stdDeviations.at<double>(WEDGE) <= sigma*ARC_MINUTE*1.000001);
        if (sigma > 0.5)
            CHECK(normalError(call, truth) < 3.5*normalSigma(call));
        last = normalSigma(call);
    }
}

TEST_CASE("A wedge that nothing tells is refused", "[wedge]")
{
    Random random(64);
    CAPTURE(seed());
    const RigTruth truth = truthWith(Vec2d());
    const RigScene scene = makeRigScene(truth, ObjectViews(1, board()), random, 1);
    RigCall pair = callWithoutWedge(truth, scene);
    CHECK_THAT(thrown([&] { pair.run(GLASS_FREE_WEDGE); }), Catch::Contains("wedge[0]"));

    GlassWindow surface;
    surface.distance = 50;
    surface.outerIndex = 1.333;
    RigCall bare = callWithoutWedge(truth, scene);
    bare.cameras[0]->setWindow(surface);
    CHECK_THAT(thrown([&] { bare.run(GLASS_FREE_WEDGE); }), Catch::Contains("no layer whose"));
}

TEST_CASE("Two cameras behind one pane with a wedge", "[wedge]")
{
    Random random(65);
    CAPTURE(seed());
    RigTruth truth = makeRig(2, { 0, 0 }, 1);
    GlassWindow window = truth.cameras[0]->window();
    window.wedge = { ARC_MINUTE*Vec2d(2, 1) };
    truth.cameras[0]->setWindow(window);
    truth.cameras[1]->setWindow(windowInFrame(window, truth.Rs[1], truth.Ts[1]));
    const RigScene scene = makeRigScene(truth, ObjectViews(8, board()), random, 0, 400, 900);
    RigCall call = callWithoutWedge(truth, scene);
    CHECK(call.run(GLASS_FREE_WEDGE) < 1e-6);
    for (int c = 0; c < 2; c++)
    {
        CHECK(angleBetween(call.cameras[c]->window().normal, truth.cameras[c]->window().normal) < 1e-4);
        CHECK(norm(call.cameras[c]->window().wedge[0] - truth.cameras[c]->window().wedge[0]) < 1e-2*ARC_MINUTE);
    }
}
