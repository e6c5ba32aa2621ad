// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Cameras in domes, calibrated: from crude starts, at the Cramer-Rao bound, with errors as stated. The centre is free, as the normal
// of a pane is.
#include "problem_scenes.hpp"
#include "target_scenes.hpp"
#include "window/wedge.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

const int CENTER = 8, RADIUS = 11, THICKNESS = 12, INDEX = 13, OUTER = 15, COUNT = 16;      // rows of a camera: 8 of the lens
const double SIGMA = 0.1;

GlassWindow domeAt(const Vec3d& center, double outerIndex) { return GlassWindow::dome(center, 70, 7, 1.49, outerIndex); }

//! Cameras as makeRig's, each in a dome of its own, or all in that of the first.
RigTruth domeRig(int count, bool shared, double outerIndex, const Vec3d& center, Random& random, double apart = 0.2)
{
    std::vector<int> windows(count, 0);
    for (int c = 0; c < count && !shared; c++)
        windows[c] = c;
    RigTruth truth = makeRig(count, windows, outerIndex, apart);
    for (int c = 0; c < count; c++)
        truth.cameras[c]->setWindow(c == 0 ? domeAt(center, outerIndex) :
            shared ? windowInFrame(truth.cameras[0]->window(), truth.Rs[c], truth.Ts[c]) : domeAt(center + random.vector(4), outerIndex));
    return truth;
}

//! The centres begin at the cameras.
RigCall callFromCentre(const RigTruth& truth, const RigScene& scene, bool paired)
{
    RigCall call(truth, scene, paired);
    for (size_t c = 0; c < call.cameras.size(); c++)
    {
        GlassWindow window = truth.cameras[c]->window();
        window.center = Vec3d();
        call.cameras[c]->setWindow(window);
    }
    return call;
}

void runWithPriors(RigCall& call, const std::vector<Mat>& priors, int flags)
{
    calibrateGlassRig(call.object, call.direct, call.refracted, call.cameras, call.windows, call.Rs, call.Ts, call.rvecs, call.tvecs,
                      call.deviations, call.covariance, call.perViewErrors, call.imageStatus, call.inliers, call.otherMinima, flags,
                      noArray(), TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 300, 1e-12), priors);
}

double centerError(const RigCall& call, const RigTruth& truth, int c = 0)
{
    return norm(call.cameras[c]->window().center - truth.cameras[c]->window().center);
}

//! Covariance of the centre for pixels of standard deviation 1, all else of the camera known, poses not; without noise.
Matx33d boundOfCenter(const CalibrationScene& perfect, bool paired, const Ptr<RefractiveCamera>& camera)
{
    Ptr<RefractiveCamera> found = camera->clone();
    Mat jacobian;
    calibrateGlass(perfect.object, paired ? perfect.direct : PixelViews(), perfect.refracted, found, noArray(), noArray(), noArray(),
                   noArray(), noArray(), jacobian, 0);
    const int points = (int)perfect.object[0].size(), rows = 2*points*(paired ? 2 : 1);
    Matx33d information = Matx33d::zeros();
    for (int view = 0; view < (int)perfect.object.size(); view++)
    {
        const Mat ofView = jacobian.rowRange(view*rows, (view + 1)*rows), J = ofView.colRange(CENTER, CENTER + 3);
        const Mat K = ofView.colRange(COUNT + 6*view, COUNT + 6*view + 6);
        Mat fit;
        solve(K, J, fit, DECOMP_QR);
        information += Matx33d(Mat(J.t()*(J - K*fit)));
    }
    return information.inv();
}

} // namespace

TEST_CASE("A dome's centre from crude starts, in air and water, thick and thin, far off the camera", "[dome][calibrate]")
{
    Random random(6100);
    CAPTURE(seed());
    for (double outerIndex : { 1., 1.333 })
        for (bool paired : { true, false })
            for (double thickness : { 3., 30. })
                for (const Vec3d& center : { Vec3d(2, -1, 3), Vec3d(0, 0, -15), Vec3d(14, -12, 20), Vec3d(-20, 15, -10) })
                {
                    CAPTURE(outerIndex, paired, thickness, center);
                    RigTruth truth = domeRig(1, false, outerIndex, center, random);
                    GlassWindow window = truth.cameras[0]->window();
                    window.thickness[0] = thickness;
                    truth.cameras[0]->setWindow(window);
                    const RigScene scene = makeRigScene(truth, 8, random, 0);
                    RigCall call = callFromCentre(truth, scene, paired);
                    CHECK(call.run(0) < 1e-6);
                    CHECK(centerError(call, truth) < (paired ? 1e-5 : 1e-3));
                }
}

TEST_CASE("A dome's radius, thickness and indices are estimated where images tell them", "[dome][calibrate]")
{
    Random random(6101);
    CAPTURE(seed());
    const RigTruth truth = domeRig(1, false, 1.333, { 8, -6, 15 }, random);
    const RigScene scene = makeRigScene(truth, ObjectViews(10, board()), random, 0, 300, 900);
    struct Case { int flag, row; };
    for (const Case& c : { Case{ GLASS_FREE_RADIUS, RADIUS }, Case{ GLASS_FREE_OUTER_INDEX, OUTER } })
    {
        RigCall call = callFromCentre(truth, scene, true);
        GlassWindow window = call.cameras[0]->window();
        window.radius += c.flag == GLASS_FREE_RADIUS ? 5 : 0;
        window.outerIndex += c.flag == GLASS_FREE_OUTER_INDEX ? 0.02 : 0;
        call.cameras[0]->setWindow(window);
        CAPTURE(c.flag);
        CHECK(call.run(c.flag) < 1e-6);
        CHECK(centerError(call, truth) < 1e-4);
        CHECK(std::abs(call.cameras[0]->window().radius - 70) < 1e-4);
        CHECK(std::abs(call.cameras[0]->window().outerIndex - 1.333) < 1e-7);
        CHECK(call.deviations.at<double>(c.row) > 0);
    }
}

TEST_CASE("The centre is as good as the Cramer-Rao bound", "[dome][calibrate][slow]")
{
    CAPTURE(seed());
    const int TRIALS = std::getenv("TRIALS") ? std::atoi(std::getenv("TRIALS")) : 100;
    struct Case { const char* name; bool paired; double outerIndex; int views; };
    for (const Case& c : { Case{ "4 pairs in air", true, 1, 4 }, Case{ "4 pairs in water", true, 1.333, 4 },
                           Case{ "20 hand-held views in water", false, 1.333, 20 } })
    {
        double squares = 0, ofBound = 0, ofStated = 0;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(6200 + trial);
            const Ptr<RefractiveCamera> camera = paperCamera(domeAt({ 4, -3, 6 }, c.outerIndex));
            const CalibrationScene perfect = makeScene(camera, c.views, random, 0), scene = withNoise(perfect, random, SIGMA);
            const Matx33d bound = SIGMA*SIGMA*boundOfCenter(perfect, c.paired, camera);
            Ptr<RefractiveCamera> found = paperCamera(domeAt(Vec3d(), c.outerIndex));
            Mat covariance;
            calibrateGlass(scene.object, c.paired ? scene.direct : PixelViews(), scene.refracted, found, noArray(), noArray(), noArray(),
                           covariance, noArray(), noArray(), 0);
            const Vec3d error = found->window().center - camera->window().center;
            squares += error.dot(error)/TRIALS;
            ofBound += trace(bound)/TRIALS;
            ofStated += squaredMahalanobis({ error[0], error[1], error[2] }, covariance, { CENTER, CENTER + 1, CENTER + 2 })/(3*TRIALS);
        }
        std::cout << "[numbers] dome, " << c.name << ": centre " << std::sqrt(squares) << " mm RMS, of the Cramer-Rao bound "
                  << std::sqrt(squares/ofBound) << ", of what is stated " << std::sqrt(ofStated) << std::endl;
        CAPTURE(c.name);
        CHECK(std::abs(std::sqrt(squares/ofBound) - 1) < 4/std::sqrt(2.*TRIALS));     // one direction may hold it all
        CHECK(std::abs(ofStated - 1) < 4*std::sqrt(2./(3*TRIALS)));
    }
}

namespace {

//! Standard deviations of what is known of a dome; mm.
struct Given
{
    double radius = 0.3, thickness = 0.1, index = 0.002, outerIndex = 0.001;
    double scale = 2e-4, rotation = 3e-4, translation = 0.03;
};

struct Flow
{
    const char* name;
    int cameras;
    bool shared, paired;
    double outerIndex;
    int views, flags;
};

GlassWindow drawn(GlassWindow window, const Given& given, Random& random)
{
    window.radius += random.normal(given.radius);
    window.thickness[0] += random.normal(given.thickness);
    window.index[0] += random.normal(given.index);
    window.outerIndex += window.outerIndex > 1 ? random.normal(given.outerIndex) : 0;
    return window;
}

Mat priorOf(const GlassWindow& window, const Given& given)
{
    Mat covariance = Mat::diag(Mat(COUNT, 1, CV_64F, Scalar(NaN)));
    const auto set = [&](int i, double sigma) { covariance.at<double>(i, i) = sigma*sigma; };
    set(RADIUS, given.radius);
    set(THICKNESS, given.thickness);
    set(INDEX, given.index);
    if (window.outerIndex > 1)
        set(OUTER, given.outerIndex);
    return covariance;
}

//! Mean squares over what is stated: of the centre, of all that is estimated of the first dome.
Vec2d tryFlow(const Flow& flow, const Given& given, int seedOfTrial)
{
    Random random(seedOfTrial);
    const RigTruth nominal = domeRig(flow.cameras, flow.shared, flow.outerIndex, Vec3d(5, -4, 9) + random.vector(3), random,
                                     flow.shared ? 0.02 : 0.2);
    RigTruth truth = nominal;
    for (int c = 0; c < flow.cameras; c++)
    {
        truth.cameras[c] = nominal.cameras[c]->clone();
        truth.cameras[c]->setWindow(c > 0 && flow.shared ? windowInFrame(truth.cameras[0]->window(), truth.Rs[c], truth.Ts[c])
                                                         : drawn(nominal.cameras[c]->window(), given, random));
    }
    RigScene scene = makeRigScene(truth, ObjectViews(flow.views, board()), random, SIGMA, 400, 800);
    imageTargets(truth, drawTargets(random, given.scale, given.rotation, given.translation), random, SIGMA, scene);
    RigCall call = callFromCentre(nominal, scene, flow.paired);
    std::vector<Mat> priors;
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
        priors.push_back(priorOf(camera->window(), given));
    Mat errors;
    calibrateGlassRig(call.object, call.direct, call.refracted, call.cameras, call.windows, call.Rs, call.Ts, call.rvecs, call.tvecs,
                      call.deviations, call.covariance, call.perViewErrors, call.imageStatus, call.inliers, call.otherMinima,
                      targetCovariance(given.scale, given.rotation, given.translation), errors, flow.flags, noArray(),
                      TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 300, 1e-12), priors);
    const std::vector<double> found = static_cast<const Camera&>(*call.cameras[0]).parameters(),
                              exact = static_cast<const Camera&>(*truth.cameras[0]).parameters();
    std::vector<double> difference;
    std::vector<int> rows;
    for (int i = CENTER; i < COUNT; i++)
        if (call.deviations.at<double>(i) > 0)
        {
            rows.push_back(i);
            difference.push_back(found[i] - exact[i]);
        }
    return Vec2d(squaredMahalanobis({ difference[0], difference[1], difference[2] }, call.covariance, { CENTER, CENTER + 1, CENTER + 2 })/3,
                 squaredMahalanobis(difference, call.covariance, rows)/(double)rows.size());
}

} // namespace

TEST_CASE("Domes with values drawn from their priors: in every flow errors are what is stated", "[dome][given][slow]")
{
    CAPTURE(seed());
    const int TRIALS = std::getenv("TRIALS") ? std::atoi(std::getenv("TRIALS")) : 20;
    const Flow flows[] = {
        { "pairs in air", 1, false, true, 1, 6, 0 },
        { "pairs in water", 1, false, true, 1.333, 6, 0 },
        { "hand-held in water", 1, false, false, 1.333, 15, 0 },
        { "two domes, pairs in water, R and T free", 2, false, true, 1.333, 6, GLASS_FREE_EXTRINSICS },
        { "two domes, hand-held in water", 2, false, false, 1.333, 12, 0 },
        { "two cameras in one dome, pairs in water, R and T free", 2, true, true, 1.333, 6, GLASS_FREE_EXTRINSICS },
        { "pairs in water, lens free", 1, false, true, 1.333, 10, GLASS_FREE_INTRINSICS },
        { "pairs in water, robust", 1, false, true, 1.333, 8, GLASS_ROBUST },
    };
    for (const Flow& flow : flows)
    {
        Vec2d mean;
        for (int trial = 0; trial < TRIALS; trial++)
            mean += tryFlow(flow, Given(), 6300 + trial)*(1./TRIALS);
        std::cout << "[numbers] domes, given values drawn from their priors, " << flow.name << ": error over stated, centre "
                  << std::sqrt(mean[0]) << ", all of the dome " << std::sqrt(mean[1]) << std::endl;
        CAPTURE(flow.name);
        CHECK(std::abs(mean[0] - 1) < 4*std::sqrt(2./(3*TRIALS)));
        CHECK(std::abs(mean[1] - 1) < 4*std::sqrt(2./(6*TRIALS)));
    }
}

TEST_CASE("Two cameras in one dome are calibrated together", "[dome][calibrate]")
{
    Random random(6102);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, true, 1.333, { 5, -4, 9 }, random, 0.02);
    const RigScene scene = makeRigScene(truth, 6, random, 0);
    RigCall call = callFromCentre(truth, scene, true);
    CHECK(call.run(GLASS_FREE_EXTRINSICS) < 1e-6);
    for (int c = 0; c < 2; c++)
        CHECK(centerError(call, truth, c) < 1e-4);
    // Of the second camera the centre is stated in its own frame.
    const Mat own = call.covariance(Rect(CENTER, CENTER, 3, 3)), others = call.covariance(Rect(CENTER + COUNT, CENTER + COUNT, 3, 3));
    CHECK(trace(others)[0] > 0);
    CHECK(trace(own)[0] > 0);
}

TEST_CASE("What images cannot tell of a dome is refused, by its name", "[dome][calibrate]")
{
    Random random(6103);
    CAPTURE(seed());
    // In the centre no ray is refracted, whatever the radius.
    const RigTruth centred = domeRig(1, false, 1.333, Vec3d(), random);
    const RigScene scene = makeRigScene(centred, 8, random, SIGMA);
    for (int flag : { GLASS_FREE_RADIUS, GLASS_FREE_INDEX, GLASS_FREE_THICKNESS, GLASS_FREE_OUTER_INDEX })
    {
        RigCall call = callFromCentre(centred, scene, true);
        const char* const name = flag == GLASS_FREE_RADIUS ? "radius" : flag == GLASS_FREE_INDEX ? "index[0]" :
                                 flag == GLASS_FREE_THICKNESS ? "thickness[0]" : "outerIndex";
        CHECK_THAT(thrown([&] { call.run(flag); }), Catch::Contains(name));
    }
    RigCall known = callFromCentre(centred, scene, true);
    known.run(0);
    CHECK(centerError(known, centred) < 0.5);

    const auto refusal = [&](const GlassWindow& window, int flags)
    {
        RigCall call = callFromCentre(centred, scene, true);
        call.cameras[0]->setWindow(window);
        return thrown([&] { call.run(flags); });
    };
    const GlassWindow dome = domeAt({ 1, 2, 3 }, 1.333);
    CHECK_THAT(refusal(dome, GLASS_FREE_DISTANCE), Catch::Contains("GLASS_FREE_RADIUS"));
    CHECK_THAT(refusal(dome, GLASS_FREE_WEDGE), Catch::Contains("no wedge"));
    CHECK_THAT(refusal(dome, GLASS_FREE_CURVATURE), Catch::Contains("GLASS_FREE_RADIUS"));
    CHECK_THAT(refusal(paper::pane(), GLASS_FREE_RADIUS), Catch::Contains("no radius"));
    GlassWindow none = dome;
    none.thickness.clear();
    none.index.clear();
    none.outerIndex = 1;
    CHECK_THAT(refusal(none, 0), Catch::Contains("does not refract"));

    // Of two cameras in one dome the second is outside of it.
    RigTruth apart = domeRig(2, false, 1.333, { 1, 2, 3 }, random);
    const RigScene seen = makeRigScene(apart, 6, random, SIGMA);
    apart.windows = { 0, 0 };
    RigCall shared = callFromCentre(apart, seen, true);
    CHECK_THAT(thrown([&] { shared.run(0); }), Catch::Contains("beyond the window"));
}

TEST_CASE("A wand in front of two domes", "[dome][bundle]")
{
    Random random(6105);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, false, 1.333, { 5, -4, 9 }, random);
    for (double sigma : { 0., SIGMA })
    {
        const BundleScene scene = makeWandScene(truth, 40, random, sigma);
        BundleCall call(truth, scene, random);
        for (const Ptr<RefractiveCamera>& camera : call.cameras)
        {
            GlassWindow window = domeAt(Vec3d(), 1.333);
            camera->setWindow(window);
        }
        call.run(GLASS_FREE_EXTRINSICS);
        for (int c = 0; c < 2; c++)
        {
            const Vec3d error = call.cameras[c]->window().center - truth.cameras[c]->window().center;
            const int row = CENTER + c*COUNT;
            CAPTURE(sigma, c, error);
            if (sigma == 0)
                CHECK(norm(error) < 1e-6);
            else                                // chi^2 of 3: 1 in 15000
                CHECK(squaredMahalanobis({ error[0], error[1], error[2] }, call.covariance, { row, row + 1, row + 2 }) < 22);
        }
    }
}

TEST_CASE("A rig that is sealed in its domes", "[dome][calibrate]")
{
    Random random(6106);
    CAPTURE(seed());
    const RigTruth truth = domeRig(2, false, 1.333, { 5, -4, 9 }, random);
    const RigScene scene = makeRigScene(truth, ObjectViews(20, board()), random, 0, 400, 800);
    RigCall call = callFromCentre(truth, scene, false);
    for (const Ptr<RefractiveCamera>& camera : call.cameras)
    {
        std::vector<double> lens = camera->lensParameters();
        for (int i = 0; i < 4; i++)
            lens[i] = i < 2 ? 1.05*lens[i] : lens[i] + 15;
        camera->setLensParameters(lens);
    }
    CHECK(call.run(GLASS_FREE_INTRINSICS | GLASS_FREE_EXTRINSICS) < 1e-4);
    // A length behind the domes, as the rig measures it.
    std::vector<Point3d> points;
    triangulateRefractive(call.cameras[0], call.cameras[1], call.Rs[1], call.Ts[1], scene.refracted[0][0], scene.refracted[1][0], points);
    CHECK(std::abs(norm(points[1] - points[0]) - 39) < 1e-3);
}

TEST_CASE("What is known of a dome's centre is a prior", "[dome][calibrate]")
{
    Random random(6104);
    CAPTURE(seed());
    const RigTruth truth = domeRig(1, false, 1., { 4, -3, 6 }, random);
    const RigScene scene = makeRigScene(truth, 1, random, SIGMA);
    double last = 0;
    for (double sigma : { 0.01, 0.3, 3. })
    {
        RigCall call = callFromCentre(truth, scene, true);
        call.cameras[0]->setWindow(truth.cameras[0]->window());
        Mat prior = Mat::diag(Mat(COUNT, 1, CV_64F, Scalar(NaN)));
        for (int i = 0; i < 3; i++)
            prior.at<double>(CENTER + i, CENTER + i) = sigma*sigma;
        runWithPriors(call, { prior }, 0);
        const double found = call.deviations.at<double>(CENTER + 2);
        CAPTURE(sigma, found);
        CHECK(found > last);
        CHECK(found <= 1.000001*sigma);
        CHECK(std::abs(call.cameras[0]->window().center[2] - 6) < 4*found);
        last = found;
    }
}
