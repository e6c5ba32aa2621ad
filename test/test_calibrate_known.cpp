// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is known of a camera beforehand comes into the joint fit with its covariance.
#include "refit_call.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Glass-only views of one camera; the lens that is given is off.
struct KnownLens
{
    RigTruth truth = makeRig(1, { 0 }, 1.);
    RigScene scene;
    explicit KnownLens(Random& random) { scene = makeRigScene(truth, ObjectViews(12, board(9, 6, 25)), random, 0.1); }

    //! fx, fy off by so much, and known to that.
    RigCall call(double offset, const Mat& covariance, int flags)
    {
        RigCall call(truth, scene, false);
        call.windows.clear();
        Mat lens = call.cameras[0]->lensParameters();
        lens.at<double>(0) += offset;
        lens.at<double>(1) += offset;
        call.cameras[0]->setLensParameters(lens);
        call.run(flags, { covariance });
        return call;
    }
};

Mat ofFocalLengths(double deviation, int count = 8)
{
    Mat covariance = Mat::zeros(count, count, CV_64F);
    covariance.at<double>(0, 0) = covariance.at<double>(1, 1) = deviation*deviation;
    return covariance;
}

} // namespace

TEST_CASE("A lens known with a covariance lies between an exact one and a free one", "[known]")
{
    Random random(3300);
    CAPTURE(seed());
    KnownLens k(random);
    const RigCall exact = k.call(0, ofFocalLengths(0), GLASS_FREE_INTRINSICS), sure = k.call(0, ofFocalLengths(1e-4), 0);
    CHECK(exact.stdDeviations.at<double>(0) == 0);
    CHECK(exact.cameras[0]->lensParameters().at<double>(0) == k.truth.cameras[0]->lensParameters().at<double>(0));
    CHECK(norm(exact.cameras[0]->window().normal - sure.cameras[0]->window().normal) < 1e-6);

    const RigCall within = k.call(0, ofFocalLengths(3), 0), free = k.call(0, ofFocalLengths(1e5), 0);
    CHECK(within.stdDeviations.at<double>(0) > 0.1);
    CHECK(within.stdDeviations.at<double>(0) < 3);
    CHECK(within.stdDeviations.at<double>(0) < free.stdDeviations.at<double>(0));
    // The normal's +- grows with what is not known of the lens.
    CHECK(within.stdDeviations.at<double>(8) >= exact.stdDeviations.at<double>(8));
    CHECK(free.stdDeviations.at<double>(8) > exact.stdDeviations.at<double>(8));
    CHECK(within.stdDeviations.at<double>(2) == 0);        // no variance: exact
}

TEST_CASE("Errors of a lens that is known so far are what is stated", "[known][slow]")
{
    std::vector<double> lens, normal;
    double statedLens = 0, statedNormal = 0;
    const double DEVIATION = 5;
    const int TRIALS = 60;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(3310 + trial);
        KnownLens k(random);
        const double offset = random.normal(DEVIATION);
        Mat covariance = ofFocalLengths(DEVIATION);
        covariance.at<double>(0, 1) = covariance.at<double>(1, 0) = 0.9999*DEVIATION*DEVIATION;     // both are off alike
        const RigCall call = k.call(offset, covariance, 0);
        lens.push_back(call.cameras[0]->lensParameters().at<double>(0) - k.truth.cameras[0]->lensParameters().at<double>(0));
        normal.push_back(call.cameras[0]->window().normal[0] - k.truth.cameras[0]->window().normal[0]);
        statedLens += std::pow(call.stdDeviations.at<double>(0), 2);
        statedNormal += std::pow(call.stdDeviations.at<double>(8), 2);
    }
    const double ofLens = cv::norm(lens)/std::sqrt(statedLens), ofNormal = cv::norm(normal)/std::sqrt(statedNormal);
    std::cout << "[numbers] lens known with a covariance, error over stated: focal length " << ofLens << ", normal " << ofNormal
              << std::endl;
    CHECK(ofLens == Approx(1).margin(0.3));
    CHECK(ofNormal == Approx(1).margin(0.3));
}

TEST_CASE("The noise that a fit tells is that of the pixels, however much priors are contradicted", "[known][prior]")
{
    const double SIGMA = 0.1, DEVIATION = 40;
    const int TRIALS = 400, KNOWN = 4;          // fx, fy, cx, cy
    double squares = 0, withoutPriors = 0;
    CAPTURE(seed());
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(3350 + trial);
        const RigTruth truth = makeRig(1, { 0 }, 1.);
        RigCall call(truth, makeRigScene(truth, ObjectViews(2, board(4, 3, 35)), random, SIGMA), true);
        Mat lens = call.cameras[0]->lensParameters(), covariance = Mat::zeros(lens.rows, lens.rows, CV_64F);
        for (int i = 0; i < KNOWN; i++)
        {
            lens.at<double>(i) += random.normal(DEVIATION);
            covariance.at<double>(i, i) = DEVIATION*DEVIATION;
        }
        call.cameras[0]->setLensParameters(lens);
        refit(call, 0, { covariance });
        squares += std::pow(call.pixelStd/SIGMA, 2)/TRIALS;
        withoutPriors += std::pow(call.rms/SIGMA, 2)*(2*call.object.size()*call.object[0].size())/call.degreesOfFreedom/TRIALS;
    }
    std::cout << "[numbers] squared noise over the true one where priors are contradicted: " << squares
              << "; as if they were met: " << withoutPriors << std::endl;
    CHECK(squares == Approx(1).margin(0.03));
    CHECK(withoutPriors < 0.97);        // else this tests nothing
}

TEST_CASE("A covariance of the wrong size or sign is refused by name", "[known]")
{
    Random random(3320);
    KnownLens k(random);
    CHECK_THROWS_WITH(k.call(0, Mat::eye(3, 3, CV_64F), 0), Catch::Contains("cameraCovariances[0] is 3x3"));
    CHECK_THROWS_WITH(k.call(0, -ofFocalLengths(1), 0), Catch::Contains("negative"));
    Mat indefinite = ofFocalLengths(1);
    indefinite.at<double>(0, 1) = indefinite.at<double>(1, 0) = 2;
    CHECK_THROWS_WITH(k.call(0, indefinite, 0), Catch::Contains("cameraCovariances[0] is not positive semidefinite"));
}

TEST_CASE("A thickness known with a tolerance is estimated within it", "[known]")
{
    Random random(3330);
    CAPTURE(seed());
    RigTruth truth = makeRig(1, { 0 }, 1.);
    const RigScene scene = makeRigScene(truth, ObjectViews(6, board(9, 6, 25)), random, 0.1);
    RigCall call(truth, scene, true);
    GlassWindow window = call.cameras[0]->window();
    window.thickness[0] = 20.3;
    call.cameras[0]->setWindow(window);
    Mat known = Mat::zeros(16, 16, CV_64F);             // lens 8, normal 3, distance, thickness, index, inner, outer
    known.at<double>(12, 12) = 0.3*0.3;
    call.windows.clear();
    call.run(0, { known });
    const double deviation = call.stdDeviations.at<double>(12);
    CHECK(deviation > 0);
    CHECK(deviation < 0.3);
    CHECK(std::abs(call.cameras[0]->window().thickness[0] - 20) < 4*deviation);
}

TEST_CASE("Cameras behind one wall, the second nearer to it than the first was thought to be: no crash, an answer", "[known][slow]")
{
    // The second camera stands 200 mm in front of the first; a start of 25 mm from the first puts it beyond the wall.
    for (int flags : { 0, (int)GLASS_ROBUST })
        for (int run = 0; run < 3; run++)
        {
            Random random(3340 + run);
            CAPTURE(seed(), run, flags);
            RigTruth rig = makeRig(2, { 0, 1 }, 1.333);
            rig.windows = { 0, 0 };
            rig.Ts[1] = Vec3d(-200, 0, -200);
            GlassWindow window({ 0.05, 0.02, 1 }, 10, 1.49, 260, 1.333);
            rig.cameras[0]->setWindow(window);
            const Vec3d there = rig.Rs[1]*window.normal;
            window.distance = 260 + there.dot(rig.Ts[1]);
            window.normal = there;
            rig.cameras[1]->setWindow(window);
            const RigScene scene = makeRigScene(rig, ObjectViews(10, board(9, 6, 25)), random, 0.1, 700, 1000);
            RigCall call(rig, scene, false);
            for (const Ptr<RefractiveCamera>& camera : call.cameras)
            {
                GlassWindow start = camera->window();
                start.distance = 25;
                start.normal = Vec3d(0, 0, 1);
                camera->setWindow(start);
            }
            call.run(flags | GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS);
            for (int c = 0; c < 2; c++)
            {
                const int at = c*16;
                CHECK(std::abs(call.cameras[c]->window().distance - rig.cameras[c]->window().distance) <
                      5*call.stdDeviations.at<double>(at + 11));
                CHECK(angleBetween(call.cameras[c]->window().normal, rig.cameras[c]->window().normal) < 3);
            }
        }
}

namespace {

//! A camera before boards in water, of which the images tell the normal about as well as its prior.
struct KnownNormal
{
    explicit KnownNormal(Random& random, int cameras = 1) : truth(makeRig(cameras, std::vector<int>(cameras, 0), 1.333)),
        scene(makeRigScene(truth, ObjectViews(3, board()), random, 0.5)) {}

    //! Two axes across the normal of a camera's window, beside each other.
    Matx32d acrossNormal(size_t c = 0) const
    {
        const Vec3d n = truth.cameras[c]->window().normal, x = normalize(n.cross(Vec3d(0, 1, 0))), y = n.cross(x);
        return Matx32d(x[0], y[0], x[1], y[1], x[2], y[2]);
    }

    //! @param off of the given normal, radians about two axes, and distance
    RigCall call(const Vec3d& off, const Matx44d& ofPlace, int flags) const
    {
        RigCall call(truth, scene, false);
        for (size_t c = 0; c < call.cameras.size(); c++)
        {
            GlassWindow window = call.cameras[c]->window();
            const Vec3d turn = acrossNormal(c)*Vec2d(off[0], off[1]);
            window.normal = normalize(truth.cameras[c]->window().normal + turn);
            if (!(flags & GLASS_FREE_DISTANCE))
                window.distance = truth.cameras[c]->window().distance + off[2];
            call.cameras[c]->setWindow(window);
        }
        Mat prior(16, 16, CV_64F, Scalar(0));
        Mat(ofPlace).copyTo(prior(Rect(NORMAL, NORMAL, 4, 4)));
        call.run(flags, std::vector<Mat>(call.cameras.size(), prior));
        return call;
    }

    RigCall call(const Vec2d& off, double deviation) const
    {
        const double v = deviation*deviation;
        return call(Vec3d(off[0], off[1], 0), Matx44d::diag(Vec4d(v, v, v, 0)), GLASS_FREE_DISTANCE);
    }

    static const int NORMAL = 8;
    const RigTruth truth;
    const RigScene scene;
};

} // namespace

TEST_CASE("A normal known with a covariance is estimated within it", "[known][prior]")
{
    CAPTURE(seed());
    Random random(3350);
    for (int cameras : { 1, 2 })        // behind one window
    {
        CAPTURE(cameras);
        const KnownNormal k(random, cameras);
        const double DEGREE = CV_PI/180;
        const RigCall unknown = k.call(Vec2d(), 0), roughly = k.call(Vec2d(), 100*DEGREE), known = k.call(Vec2d(), 0.01*DEGREE);
        const int n = KnownNormal::NORMAL;
        CHECK(roughly.stdDeviations.at<double>(n) == Approx(unknown.stdDeviations.at<double>(n)).epsilon(0.02));
        CHECK(known.stdDeviations.at<double>(n) < 0.2*unknown.stdDeviations.at<double>(n));
        // Given with that certainty, it is as given, right or wrong.
        const RigCall wrong = k.call(Vec2d(0.2*DEGREE, 0), 1e-4*DEGREE);
        const double angle = std::acos(wrong.cameras[0]->window().normal.dot(k.truth.cameras[0]->window().normal))/DEGREE;
        CHECK(angle == Approx(0.2).margin(0.005));
    }
}

TEST_CASE("Errors of a normal that is known so far are what is stated", "[known][prior]")
{
    const int TRIALS = 40;
    const double DEVIATION = 0.3*CV_PI/180;
    double errors[2] = {}, stated[2] = {}, alone = 0;
    CAPTURE(seed());
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(3360 + trial);
        const KnownNormal k(random);
        const RigCall call = k.call(Vec2d(random.normal(DEVIATION), random.normal(DEVIATION)), DEVIATION);
        for (int i = 0; i < 2; i++)
        {
            errors[i] += std::pow(call.cameras[0]->window().normal[i] - k.truth.cameras[0]->window().normal[i], 2);
            stated[i] += std::pow(call.stdDeviations.at<double>(KnownNormal::NORMAL + i), 2);
        }
        alone += trial ? 0 : std::pow(k.call(Vec2d(), 0).stdDeviations.at<double>(KnownNormal::NORMAL), 2);
    }
    const double x = std::sqrt(errors[0]/stated[0]), y = std::sqrt(errors[1]/stated[1]);
    std::cout << "[numbers] normal known to 0.3 degrees, error over stated: x " << x << ", y " << y << "; stated "
              << std::sqrt(stated[0]/TRIALS)*180/CV_PI << " degrees, " << std::sqrt(alone)*180/CV_PI << " from the images alone"
              << std::endl;
    CHECK(x == Approx(1).margin(0.3));
    CHECK(y == Approx(1).margin(0.3));
    CHECK(stated[0]/TRIALS < std::min(alone, DEVIATION*DEVIATION));
}

TEST_CASE("A normal and a distance that are known together are estimated within that", "[known][prior]")
{
    // As markers on the window tell them, beside the camera's axis: where the window is further away there, or more inclined.
    const int TRIALS = 40;
    const double MARKER = 0.3;
    double mahalanobis = 0, errors[3] = {}, stated[3] = {};
    CAPTURE(seed());
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(3370 + trial);
        const KnownNormal k(random);
        const Matx32d across = k.acrossNormal();
        Matx33d information = Matx33d::zeros();
        for (int i = 0; i < 4; i++)             // of turns about the two axes, and of the distance
        {
            const Vec3d row(200 + 60*(i % 2), 60*(i/2), -1);
            information += row*row.t()*(1/(MARKER*MARKER));
        }
        const Matx33d ofTurns = information.inv(DECOMP_CHOLESKY);
        Mat values, vectors;
        eigen(ofTurns, values, vectors);
        Vec3d off;
        for (int i = 0; i < 3; i++)
            off += random.normal(std::sqrt(values.at<double>(i)))*Vec3d(vectors.ptr<double>(i));
        Matx43d place = Matx43d::zeros();
        for (int i = 0; i < 6; i++)
            place(i/2, i % 2) = across(i/2, i % 2);
        place(3, 2) = 1;
        const RigCall call = k.call(off, place*ofTurns*place.t(), 0);
        const GlassWindow found = call.cameras[0]->window(), truth = k.truth.cameras[0]->window();
        const Vec2d turn = across.t()*(found.normal - truth.normal);
        const Vec3d error(turn[0], turn[1], found.distance - truth.distance);
        const Matx44d C = Mat(call.covariance(Rect(KnownNormal::NORMAL, KnownNormal::NORMAL, 4, 4)));
        const Matx33d ofError = place.t()*C*place;
        mahalanobis += error.dot(ofError.inv(DECOMP_CHOLESKY)*error)/3;
        const Vec3d atMarkers(230, 30, -1);         // how far the window is from the middle of the markers
        CHECK(std::sqrt(atMarkers.dot(ofError*atMarkers)) < 1.001*MARKER/2);
        for (int i = 0; i < 3; i++)
        {
            errors[i] += error[i]*error[i];
            stated[i] += ofError(i, i);
        }
    }
    std::cout << "[numbers] normal and distance known together, error over stated: turns " << std::sqrt(errors[0]/stated[0]) << ", "
              << std::sqrt(errors[1]/stated[1]) << ", distance " << std::sqrt(errors[2]/stated[2]) << "; all three "
              << std::sqrt(mahalanobis/TRIALS) << std::endl;
    for (int i = 0; i < 3; i++)
        CHECK(std::sqrt(errors[i]/stated[i]) == Approx(1).margin(0.3));
    CHECK(std::sqrt(mahalanobis/TRIALS) == Approx(1).margin(0.2));
}
