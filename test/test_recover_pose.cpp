// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"
#include "cramer_rao.hpp"
#include "pose/relative_pose.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

//! Two cameras before a scene, and what they should find.
struct Matched
{
    Ptr<RefractiveCamera> camera1, camera2;
    Vec3d rvec, T;
    std::vector<Point3d> points;
    std::vector<Point2d> perfect1, perfect2, pixels1, pixels2;
    std::vector<uchar> isRight;
};

//! Water, and WEDGE: faces that are not parallel; DOME: spheres; TUBE: cylinders; BENT: spheres that are nearly planes.
enum SceneMedium { NOTHING, AIR, WATER, WEDGE, DOME, TUBE, BENT };

GlassWindow windowIn(SceneMedium medium, bool second)
{
    if (medium == NOTHING)
        return GlassWindow();
    if (medium == DOME)
        return GlassWindow::dome(second ? Vec3d(-5, 12, -40) : Vec3d(15, 10, -45), 90, 12, 1.49, 1.333);
    if (medium == TUBE)
        return GlassWindow::tube(second ? Vec3d(-5, 12, -30) : Vec3d(15, 10, -35), Vec3d(0.1, 1, second ? 0.2 : -0.1), 90, 12, 1.49, 1.333);
    const Vec3d normal = second ? Vec3d(0.2, -0.05, 1) : paper::NORMAL1;
    if (medium == AIR)
        return paper::pane(50, normal);
    GlassWindow window(normal, 15, 1.49, 60, 1.333);
    if (medium == WEDGE)
        window.wedge.push_back(second ? Vec2d(0.03, 0.01) : Vec2d(-0.02, 0.02));
    if (medium == BENT)
    {
        window.shape = WINDOW_BENT;
        window.curvature = second ? 1e-4 : -1e-4;
    }
    return window;
}

enum Scene { DEEP, FLAT };

//! A pair with a wide lens.
Matched matchedScene(SceneMedium medium, Random& random, int count, Scene scene = DEEP,
                     const Vec3d& rvec = Vec3d(0.05, 0.35, -0.04), const Vec3d& T = Vec3d(-200, 15, 40))
{
    Matched m;
    m.camera1 = makeCamera(lensNamed("4 coefficients"), windowIn(medium, false));
    m.camera2 = makeCamera(lensNamed("4 coefficients"), windowIn(medium, true));
    m.rvec = rvec;
    m.T = T;
    const Vec2d slope = scene == FLAT ? Vec2d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)) : Vec2d();
    while ((int)m.points.size() < count)
    {
        Point3d X(random.uniform(-250, 250), random.uniform(-150, 150), random.uniform(350, 900));
        if (scene == FLAT)
            X.z = 600 + slope[0]*X.x + slope[1]*X.y;
        std::vector<Point2d> p, q;
        std::vector<uchar> s1, s2;
        refractiveProjectPoints(std::vector<Point3d>(1, X), Vec3d(), Vec3d(), m.camera1, p, s1);
        refractiveProjectPoints(std::vector<Point3d>(1, X), m.rvec, m.T, m.camera2, q, s2);
        const auto inside = [](const Point2d& a) { return a.x > 0 && a.x < 1280 && a.y > 0 && a.y < 1024; };
        if (s1[0] || s2[0] || !inside(p[0]) || !inside(q[0]))
            continue;
        m.points.push_back(X);
        m.perfect1.push_back(p[0]);
        m.perfect2.push_back(q[0]);
    }
    return m;
}

void disturb(Matched& m, Random& random, double sigma, int wrong)
{
    m.pixels1 = m.perfect1;
    m.pixels2 = m.perfect2;
    m.isRight.assign(m.points.size(), 1);
    for (size_t i = 0; i < m.points.size(); i++)
    {
        m.pixels1[i] += Point2d(random.normal(sigma), random.normal(sigma));
        m.pixels2[i] += Point2d(random.normal(sigma), random.normal(sigma));
        if ((int)i >= wrong)
            continue;
        m.pixels2[i] = Point2d(random.uniform(0, 1280), random.uniform(0, 1024));
        m.isRight[i] = 0;
    }
}

/* Covariance bound of (rvec, T) for pixels with a standard deviation of 1, from all right points and the pose at once: the points
are eliminated. Nothing of the code under test is used. */
Matx66d poseBound(const Matched& m)
{
    Mat information = Mat::zeros(6, 6, CV_64F), J1, J2;
    std::vector<Point2d> pixels;
    refractiveProjectPoints(m.points, Vec3d(1e-9, 0, 0), Vec3d(), m.camera1, pixels, noArray(), J1);
    refractiveProjectPoints(m.points, m.rvec, m.T, m.camera2, pixels, noArray(), J2);
    Matx33d R;
    Rodrigues(m.rvec, R);
    for (int i = 0; i < (int)m.points.size(); i++)
    {
        if (!m.isRight[i])
            continue;
        Mat K = Mat::zeros(4, 3, CV_64F), J = Mat::zeros(4, 6, CV_64F), fit;    // by the point, by the pose
        J1(Rect(3, 2*i, 3, 2)).copyTo(K.rowRange(0, 2));
        Mat(J2(Rect(3, 2*i, 3, 2))*Mat(R)).copyTo(K.rowRange(2, 4));
        J2(Rect(0, 2*i, 6, 2)).copyTo(J.rowRange(2, 4));
        solve(K, J, fit, DECOMP_QR);
        information += J.t()*(J - K*fit);
    }
    return Matx66d(Mat(information.inv(DECOMP_SVD)).ptr<double>());
}

//! Trials of one kind, against the bound.
struct Tally
{
    int count = 0, failed = 0, covered = 0, bounded = 0;
    double rotation = 0, direction = 0, rotationBound = 0, directionBound = 0, logLength = 0;
    Coverage axes;              //!< of stated sigmas of the rotation vector and of T across its direction

    void add(const Matched& m, const Matx66d& bound, double sigma, const Mat& R, const Mat& T, const Mat& covariance,
             const Vec2d& interval)
    {
        Matx33d truth;
        Rodrigues(m.rvec, truth);
        Vec3d rvec, t(T.ptr<double>());
        Rodrigues(R, rvec);
        const Matx<double, 3, 2> across = tangentsOf(normalize(m.T));
        const Matx33d rotationC = bound.get_minor<3, 3>(0, 0)*(sigma*sigma), TC = bound.get_minor<3, 3>(3, 3)*(sigma*sigma);
        const Matx22d directionC = (across.t()*TC*across)*(1/m.T.dot(m.T));
        const Vec2d off = across.t()*normalize(t);
        rotation += norm(rvec - m.rvec)*norm(rvec - m.rvec);
        direction += off.dot(off);
        rotationBound += trace(rotationC);
        directionBound += trace(directionC);
        logLength += std::log(norm(t)/norm(m.T));
        covered += interval[0] <= norm(m.T) && norm(m.T) <= interval[1];
        bounded += std::isfinite(interval[1]);
        count++;
        for (int k = 0; k < 3; k++)
            axes.add(rvec[k] - m.rvec[k], std::sqrt(covariance.at<double>(k, k)));
        const Matx22d stated = across.t()*Matx33d(Mat(covariance(Rect(3, 3, 3, 3)).clone()).ptr<double>())*across;
        for (int k = 0; k < 2; k++)
            axes.add(off[k], std::sqrt(stated(k, k))/norm(t));
    }
    void print(const std::string& what) const
    {
        std::cout << "[numbers] refractiveRecoverPose, " << what << ": rotation " << std::sqrt(rotation/rotationBound)
                  << ", direction " << std::sqrt(direction/directionBound) << " times the bound ("
                  << std::sqrt(rotationBound/count)*180/CV_PI << ", " << std::sqrt(directionBound/count)*180/CV_PI
                  << " degrees), length off by " << 100*(std::exp(logLength/count) - 1)
                  << " % on average, 95 % interval holds it in " << 100.*covered/count << " %, has an end above in "
                  << 100.*bounded/count << " % (" << count << " trials, " << failed << " without answer)" << std::endl;
        axes.print("refractiveRecoverPose, " + what + ", covariance");
    }
};

} // namespace

TEST_CASE("Perfect matches give the perfect pose, its length too", "[pose][recover]")
{
    for (SceneMedium medium : { NOTHING, AIR, WATER, WEDGE, DOME, TUBE, BENT })
    {
        Random random(6000);
        Matched m = matchedScene(medium, random, 60);
        disturb(m, random, 0, 0);
        CAPTURE(medium, seed());
        Mat R, T, covariance;
        std::vector<uchar> mask;
        Vec2d interval;
        REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 0.1, mask, covariance,
                                      interval) == 60);
        Matx33d truth;
        Rodrigues(m.rvec, truth);
        CHECK(norm(R, Mat(truth)) < 1e-4);
        CHECK(norm(normalize(Vec3d(T.ptr<double>())) - normalize(m.T)) < 1e-4);
        CHECK(countNonZero(mask) == 60);
        if (medium == NOTHING)
        {
            CHECK(norm(T) == Approx(1));
            CHECK((interval[0] == 0 && std::isinf(interval[1])));
        }
        else
            CHECK(norm(T) == Approx(norm(m.T)).epsilon(1e-2));
    }
}

TEST_CASE("Two hundred matches, forty percent wrong, against the Cramer-Rao bound", "[pose][recover][slow]")
{
    const int TRIALS = trials(10);
    const double SIGMA = 0.2;
    for (SceneMedium medium : { NOTHING, AIR, WATER })
    {
        Tally tally;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(6100 + trial);
            Matched m = matchedScene(medium, random, 200);
            disturb(m, random, SIGMA, 80);
            Mat R, T, covariance;
            Vec2d interval;
            const int count = refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, noArray(),
                                                    covariance, interval);
            if (count < 100)
                tally.failed++;
            else
                tally.add(m, poseBound(m), SIGMA, R, T, covariance, interval);
        }
        const char* names[] = { "no window", "air", "water" };
        tally.print(names[medium]);
        CAPTURE(medium, seed());
        CHECK(tally.failed == 0);
        const double spread = 1 + 2/std::sqrt(2.*TRIALS);       // of a few trials
        CHECK(std::sqrt(tally.rotation/tally.rotationBound) < 1.2*spread);
        CHECK(std::sqrt(tally.direction/tally.directionBound) < 1.2*spread);
        if (medium != NOTHING)
            CHECK(tally.covered >= TRIALS*0.95 - 3*std::sqrt(TRIALS*0.95*0.05));
    }
}

//! Cameras that hardly move apart or not at all: is the length in its interval, and the rotation off as is stated?
static void checkShortBaseline(SceneMedium medium, double length, int trialCount, double most)
{
    int held = 0;
    double chi2 = 0;
    for (int trial = 0; trial < trialCount; trial++)
    {
        Random random(6900 + trial);
        Matched m = matchedScene(medium, random, 150, DEEP, Vec3d(0.05, 0.15, -0.04), length*normalize(Vec3d(-200, 15, 40)));
        disturb(m, random, 0.2, 0);
        Mat R, T, covariance;
        Vec2d interval;
        CAPTURE(medium, length, trial, seed());
        REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, noArray(), covariance,
                                      interval) > 140);
        Vec3d rvec;
        Rodrigues(R, rvec);
        const Vec3d off = rvec - m.rvec;
        chi2 += off.dot(Matx33d(Mat(covariance(Rect(0, 0, 3, 3)).clone()).ptr<double>()).inv()*off)/trialCount;
        held += interval[0] <= length && length <= interval[1];
    }
    printNumber(std::string("refractiveRecoverPose, ") + (medium == AIR ? "air" : "water") + ", T of " +
                std::to_string((int)length) + " mm: 95 % interval holds it in", 100.*held/trialCount, "%");
    printNumber("chi^2 of the rotation's three", chi2, "");
    CAPTURE(medium, length, seed());
    CHECK(held >= trialCount*0.95 - 3*std::sqrt(trialCount*0.95*0.05));
    CHECK(held <= trialCount*most);
    CHECK(chi2 < 3 + 3*std::sqrt(6./trialCount));
}

TEST_CASE("A short baseline's length is in its interval, and a pure rotation's", "[pose][recover]")
{
    checkShortBaseline(WATER, 3, trials(30), 1);
    checkShortBaseline(WATER, 0, trials(60), 1);
    checkShortBaseline(AIR, 0, trials(60), 1);
    checkShortBaseline(AIR, 1, trials(30), 1);
}

TEST_CASE("Intervals of short baselines hold what they say", "[.monte-carlo]")
{
    for (SceneMedium medium : { AIR, WATER })
        for (double length : { 0., 1., 3., 10., 30. })
            checkShortBaseline(medium, length, trials(400), medium == AIR ? 1 : 0.99);
}

TEST_CASE("The errors' derivatives are those of differences", "[pose][recover]")
{
    const SceneMedium medium = GENERATE(WATER, WEDGE, DOME, TUBE, BENT);
    Random random(6950);
    const Matched m = matchedScene(medium, random, 40);
    const Camera &c1 = cameraOf(m.camera1), &c2 = cameraOf(m.camera2);
    const MatchedCameras pair = { c1, c2, Vec3d(), Vec3d() };
    std::vector<Point2d> moved = m.perfect2;
    {
        const std::vector<PixelRay> rays1 = pixelRays(c1, m.perfect1), rays2 = pixelRays(c2, m.perfect2);
        PixelMatches perfect;
        RigidTransform truth;
        std::vector<double> errors;
        for (size_t i = 0; i < moved.size(); i++)
            perfect.push_back({ m.perfect1[i], moved[i], rays1[i], rays2[i] });
        Rodrigues(m.rvec, truth.R);
        truth.t = m.T;
        sampsonErrors(pair, perfect, truth, errors, nullptr);
        CHECK(norm(errors, NORM_INF) < 1e-9);
    }
    for (Point2d& p : moved)
        p += Point2d(random.normal(3), random.normal(3));
    const std::vector<PixelRay> rays1 = pixelRays(c1, m.perfect1), rays2 = pixelRays(c2, moved);
    PixelMatches matches;
    for (size_t i = 0; i < moved.size(); i++)
        matches.push_back({ m.perfect1[i], moved[i], rays1[i], rays2[i] });
    const auto at = [&](const Vec3d& rvec, const Vec3d& T, std::vector<Matx16d>* byPose)
    {
        RigidTransform motion;
        Rodrigues(rvec, motion.R);
        motion.t = T;
        std::vector<double> errors;
        sampsonErrors(pair, matches, motion, errors, byPose);
        return errors;
    };
    std::vector<Matx16d> byPose;
    at(m.rvec, m.T, &byPose);
    double worst = 0;
    for (int k = 0; k < 6; k++)
    {
        const double STEP = k < 3 ? 1e-6 : 1e-4;
        Vec3d rvec[2] = { m.rvec, m.rvec }, T[2] = { m.T, m.T };
        for (int side = 0; side < 2; side++)
            (k < 3 ? rvec[side][k] : T[side][k - 3]) += side ? STEP : -STEP;
        const std::vector<double> low = at(rvec[0], T[0], nullptr), high = at(rvec[1], T[1], nullptr);
        for (size_t i = 0; i < low.size(); i++)
        {
            const double difference = (high[i] - low[i])/(2*STEP);
            worst = std::max(worst, std::abs(difference - byPose[i](k))/(1e-3*(k < 3 ? 1000 : 1) + std::abs(difference)));
        }
    }
    CAPTURE(seed());
    printNumber("derivatives of a match's error, against differences, relative", worst, "");
    CHECK(worst < 1e-5);
}

TEST_CASE("An inexact camera is part of a relative pose's covariance and interval", "[pose][recover]")
{
    const int TRIALS = trials(20);
    const double SIGMA_INDEX = 0.002;
    double inexact = 0, forgotten = 0;
    int held = 0, heldForgotten = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(7000 + trial);
        Matched m = matchedScene(WATER, random, 200);
        disturb(m, random, 0.2, 0);
        GlassWindow window1 = m.camera1->window(), window2 = m.camera2->window();
        window1.outerIndex += random.normal(SIGMA_INDEX);
        window2.outerIndex += random.normal(SIGMA_INDEX);
        m.camera1->setWindow(window1);
        m.camera2->setWindow(window2);
        std::vector<Mat> covariances;
        for (const Ptr<RefractiveCamera>& camera : { m.camera1, m.camera2 })
        {
            const int count = (int)camera->parameterNames().size();
            covariances.push_back(Mat::zeros(count, count, CV_64F));
            covariances.back().at<double>(count - 1, count - 1) = SIGMA_INDEX*SIGMA_INDEX;
        }
        CAPTURE(trial, seed());
        const auto chiSquare = [&](InputArrayOfArrays cameraCovariances, int& inside)
        {
            Mat R, T, C;
            Vec2d interval;
            REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, noArray(), C, interval,
                                          cameraCovariances) > 100);
            inside += interval[0] <= norm(m.T) && norm(m.T) <= interval[1];
            Vec3d rvec;
            Rodrigues(R, rvec);
            const Vec3d off = rvec - m.rvec;
            return off.dot(Matx33d(Mat(C(Rect(0, 0, 3, 3)).clone()).ptr<double>()).inv()*off);
        };
        inexact += chiSquare(covariances, held)/TRIALS;
        forgotten += chiSquare(noArray(), heldForgotten)/TRIALS;
    }
    CAPTURE(seed());
    printNumber("chi^2 of a rotation's three, indices of water off by 0.002: stated", inexact, "");
    printNumber("chi^2 of a rotation's three, indices of water off by 0.002: forgotten", forgotten, "");
    std::cout << "[numbers] intervals that hold the length: " << held << ", forgotten " << heldForgotten << " of " << TRIALS << std::endl;
    CHECK(inexact < 3 + 3*std::sqrt(6./TRIALS));
    CHECK(forgotten > 2*inexact);
    CHECK(held >= TRIALS*0.95 - 3*std::sqrt(TRIALS*0.95*0.05));
}

TEST_CASE("What refraction cannot tell has no upper end", "[pose][recover]")
{
    Random random(6200);
    Matched m = matchedScene(AIR, random, 40);      // few, and noisy
    disturb(m, random, 2, 0);
    Mat R, T, covariance;
    Vec2d interval;
    CAPTURE(seed());
    REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 10, noArray(), covariance,
                                  interval) > 30);
    CAPTURE(interval, norm(T));
    CHECK(std::isinf(interval[1]));
    CHECK(interval[0] < norm(m.T));
    CHECK(checkRange(covariance));
    const Mat along = T/norm(T), C = covariance(Rect(3, 3, 3, 3));
    CHECK(Mat(along.t()*C*along).at<double>(0) < 1e-9*trace(C)[0]);       // at the length that T has
}

TEST_CASE("A flat scene gives the right one of its two poses, or none", "[pose][recover]")
{
    const double SIGMA = 0.2;
    const int TRIALS = trials(10);
    for (SceneMedium medium : { NOTHING, AIR, WATER })
    {
        Coverage axes;
        int refused = 0;
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(6400 + trial);
            Matched m = matchedScene(medium, random, 200, FLAT);
            disturb(m, random, SIGMA, trial % 2 ? 60 : 0);
            CAPTURE(medium, trial, seed());
            Mat R, T, covariance;
            Vec2d interval;
            if (refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, noArray(), covariance,
                                      interval) == 0)
            {
                refused++;
                continue;
            }
            Vec3d rvec;
            Rodrigues(R, rvec);
            CHECK(norm(rvec - m.rvec) < 0.1);       // the other pose is 0.25 off or more
            if (medium == NOTHING || std::isfinite(interval[1]))    // else the covariance is that for one length
                for (int k = 0; k < 3; k++)
                    axes.add(rvec[k] - m.rvec[k], std::sqrt(covariance.at<double>(k, k)));
        }
        const char* names[] = { "no window", "air", "water" };
        std::cout << "[numbers] refractiveRecoverPose, flat scene, " << names[medium] << ": " << refused << " of " << TRIALS
                  << " refused" << std::endl;
        axes.print(std::string("refractiveRecoverPose, flat scene, ") + names[medium]);
        CAPTURE(medium, seed());
        CHECK(refused <= TRIALS/2);
        CHECK(axes.two() > 0.95 - 3*std::sqrt(0.95*0.05/TRIALS));   // three axes of a trial are hardly more than one
    }
}

TEST_CASE("Few and noisy matches of a deep scene have one pose, upside down as well", "[pose][recover]")
{
    struct Kind { SceneMedium medium; int count; double sigma; Vec3d rvec; };
    for (const Kind& kind : { Kind{ NOTHING, 12, 0.2, Vec3d(0.05, 0.35, -0.04) }, Kind{ WATER, 12, 0.2, Vec3d(0.05, 0.35, -0.04) },
                              Kind{ NOTHING, 30, 0.5, Vec3d(0.05, 0.35, -0.04) }, Kind{ AIR, 30, 0.5, Vec3d(0.05, 0.35, -0.04) },
                              Kind{ WATER, 60, 0.5, Vec3d(0, 0, CV_PI) } })
    {
        int refused = 0, wrong = 0;
        const int TRIALS = trials(20);
        for (int trial = 0; trial < TRIALS; trial++)
        {
            Random random(6700 + trial);
            Matched m = matchedScene(kind.medium, random, kind.count, DEEP, kind.rvec);
            disturb(m, random, kind.sigma, 0);
            Mat R, T;
            if (refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T) == 0)
            {
                refused++;
                continue;
            }
            Matx33d truth;
            Rodrigues(m.rvec, truth);
            wrong += norm(R, Mat(truth)) > 0.1;
        }
        CAPTURE(kind.medium, kind.count, kind.sigma, seed());
        std::cout << "[numbers] refractiveRecoverPose, " << kind.count << " matches, " << kind.sigma << " px: " << refused << " of "
                  << TRIALS << " refused, " << wrong << " wrong" << std::endl;
        CHECK(refused <= TRIALS/10);
        CHECK(wrong == 0);
    }
}

TEST_CASE("Copies of matches change nothing", "[pose][recover]")
{
    Random random(6800);
    Matched m = matchedScene(WATER, random, 40);
    disturb(m, random, 0.2, 5);
    Mat R, T, C, R2, T2, C2;
    Vec2d interval, interval2;
    std::vector<uchar> mask, mask2;
    const int count = refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, mask, C, interval);
    for (int i = 0; i < 300; i++)
    {
        m.pixels1.push_back(m.pixels1[5 + i % 6]);
        m.pixels2.push_back(m.pixels2[5 + i % 6]);
    }
    CAPTURE(seed());
    REQUIRE(count >= 30);
    const int more = refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R2, T2, 0.999, 1, mask2, C2, interval2);
    CHECK(more > count);
    CHECK(more == countNonZero(mask2));
    CHECK(norm(R, R2) == 0);
    CHECK(norm(C, C2) == 0);
    for (int i = 0; i < 340; i++)
        CHECK(mask2[i] == mask[i < 40 ? i : 5 + (i - 40) % 6]);
}

TEST_CASE("Where both poses of a flat scene are as likely there is no answer", "[pose][recover]")
{
    for (double noise : { 0., 0.1 })
        for (int trial = 0; trial < 5; trial++)
        {
            Random random(6500 + trial);
            Matched m = matchedScene(NOTHING, random, 100, FLAT);
            m.rvec = random.vector(0.1);
            m.T = Vec3d(random.uniform(-80, 80), random.uniform(-80, 80), -200);    // sideways one has points behind a camera
            refractiveProjectPoints(m.points, m.rvec, m.T, m.camera2, m.perfect2);
            disturb(m, random, noise, 0);
            Mat R, T;
            CAPTURE(noise, trial, seed());
            CHECK(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T) == 0);
            CHECK(R.empty());
        }
}

TEST_CASE("Cameras that only turn: the rotation, and no long T", "[pose][recover]")
{
    for (SceneMedium medium : { NOTHING, AIR, WATER })
    {
        Random random(6600);
        Matched m = matchedScene(medium, random, 200);
        refractiveProjectPoints(m.points, m.rvec, Vec3d(), m.camera2, m.perfect2);
        disturb(m, random, 0.1, 0);
        CAPTURE(medium, seed());
        Mat R, T;
        REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T) > 150);
        Vec3d rvec;
        Rodrigues(R, rvec);
        CAPTURE(T, rvec);
        CHECK(norm(T) < 20);            // the windows are 65 and 75 deep
        CHECK(norm(rvec - m.rvec) < 0.01);
    }
}

TEST_CASE("Where all points may be infinitely far T has no direction, and no covariance", "[pose][recover]")
{
    const int TRIALS = trials(20);
    int without = 0;
    double chi2 = 0;
    for (int trial = 0; trial < TRIALS; trial++)
        for (double length : { 0., 20. })       // the longer one moves pixels by 20 to 60
        {
            Random random(6610 + trial);
            Matched m = matchedScene(NOTHING, random, 80);
            refractiveProjectPoints(m.points, m.rvec, length*normalize(m.T), m.camera2, m.perfect2);
            disturb(m, random, 0.1, 0);
            Mat R, T, mask, covariance;
            Vec2d interval;
            CAPTURE(trial, length, seed());
            REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, mask, covariance, interval) > 60);
            REQUIRE(std::isinf(interval[1]));
            const Matx33d ofRotation(Mat(covariance(Rect(0, 0, 3, 3)).clone()).ptr<double>());
            REQUIRE(checkRange(ofRotation));
            if (length > 0)
            {
                REQUIRE(checkRange(covariance));
                continue;
            }
            int numbers = 0;
            for (int k = 0; k < 36; k++)
                numbers += !std::isnan(covariance.at<double>(k/6, k % 6));
            REQUIRE((numbers == 9 || numbers == 36));
            without += numbers == 9;
            Mat exact;
            Vec3d turn;
            Rodrigues(m.rvec, exact);
            Rodrigues(R*exact.t(), turn);
            chi2 += turn.dot(ofRotation.inv()*turn)/TRIALS;
        }
    CAPTURE(seed());
    CHECK(without == TRIALS);
    CHECK(chi2 < 3 + 3*std::sqrt(6./TRIALS));
}

TEST_CASE("A covariance is not narrower than the interval of the length", "[pose][recover]")
{
    // Domes off the centre tell the length, now and then to an end that is far away.
    const int TRIALS = trials(24);
    const double MOST = 2.9;        // standard deviations to an end of 95 %, 1.96 where the likelihood is normal
    int finite = 0;
    double widest = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        Random random(6640 + trial);
        Matched m = matchedScene(DOME, random, 80, DEEP, random.vector(0.15), random.uniform(100, 200)*normalize(random.vector(1)));
        disturb(m, random, 0.3, 0);
        Mat R, T, mask, covariance;
        Vec2d interval;
        CAPTURE(trial, seed());
        if (refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 2, mask, covariance, interval) == 0
            || std::isinf(interval[1]))
            continue;
        finite++;
        const double length = norm(T);
        const Mat along = T/length;
        const double sigma = std::sqrt(Mat(along.t()*covariance(Rect(3, 3, 3, 3))*along).at<double>(0));
        widest = std::max(widest, std::max(interval[1] - length, length - interval[0])/sigma);
    }
    CAPTURE(finite, seed());
    printNumber("ends of finite intervals of lengths, standard deviations away", widest, "");
    CHECK(finite >= TRIALS/4);
    CHECK(widest < MOST);
}

TEST_CASE("Relative poses: unseen points, nothing to find, overload, errors", "[pose][recover]")
{
    Random random(6300);
    Matched m = matchedScene(WATER, random, 50);
    disturb(m, random, 0.1, 10);
    Mat R, T, R2, T2;
    std::vector<uchar> mask, mask2;
    CAPTURE(seed());
    REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R, T, 0.999, 1, mask) >= 39);
    CHECK(R.type() == CV_64F);
    CHECK(T.size() == Size(1, 3));
    for (int i = 10; i < 50; i++)
        CHECK(mask[i] == 1);

    SECTION("the overload agrees")
    {
        refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1->cameraMatrix(), m.camera1->distCoeffs(), m.camera1->window(),
                              m.camera2->cameraMatrix(), m.camera2->distCoeffs(), m.camera2->window(), R2, T2, 0.999, 1, mask2);
        CHECK(mask == mask2);
        CHECK(largestDifference(T, T2) == 0);
    }
    SECTION("NaN points are left out")
    {
        m.pixels1[20].x = m.pixels2[30].y = NaN;
        REQUIRE(refractiveRecoverPose(m.pixels1, m.pixels2, m.camera1, m.camera2, R2, T2, 0.999, 1, mask2) >= 37);
        CHECK((mask2[20] == 0 && mask2[30] == 0 && mask2[31] == 1));
    }
    SECTION("no pose leaves R and T as they were")
    {
        const std::vector<Point2d> unseen(50, Point2d(NaN, NaN));
        R2 = Mat(1, 1, CV_64F, Scalar(3));
        CHECK(refractiveRecoverPose(unseen, m.pixels2, m.camera1, m.camera2, R2, T2, 0.999, 1, mask2) == 0);
        CHECK(R2.at<double>(0) == 3);
        CHECK((T2.empty() && mask2.size() == 50 && countNonZero(mask2) == 0));
        const std::vector<Point2d> same(50, Point2d(600, 500));
        CHECK(refractiveRecoverPose(same, same, m.camera1, m.camera2, R2, T2) == 0);
    }
    SECTION("copies of matches tell nothing")
    {
        std::vector<Point2d> p, q;
        for (int i = 0; i < 60; i++)
        {
            p.push_back(m.pixels1[10 + i % 6]);
            q.push_back(m.pixels2[10 + i % 6]);
        }
        CHECK(refractiveRecoverPose(p, q, m.camera1, m.camera2, R2, T2, 0.999, 1, mask2) == 0);
        CHECK((T2.empty() && countNonZero(mask2) == 0));
    }
    SECTION("nothing but wrong matches is no pose")
    {
        Matched all = matchedScene(WATER, random, 200);
        disturb(all, random, 0.2, 200);
        CHECK(refractiveRecoverPose(all.pixels1, all.pixels2, all.camera1, all.camera2, R2, T2, 0.999, 1, mask2) == 0);
        CHECK((T2.empty() && countNonZero(mask2) == 0));
    }
    SECTION("no matches are no inliers")
    {
        mask2.resize(3);
        CHECK(refractiveRecoverPose(std::vector<Point2d>(), std::vector<Point2d>(), m.camera1, m.camera2, R2, T2, 0.999, 1,
                                    mask2) == 0);
        CHECK((R2.empty() && T2.empty() && mask2.empty()));
    }
    SECTION("errors")
    {
        const auto why = [&](int count, double prob, double threshold)
        {
            const std::vector<Point2d> p(m.pixels1.begin(), m.pixels1.begin() + count);
            return thrown([&] { refractiveRecoverPose(p, p, m.camera1, m.camera2, R, T, prob, threshold); });
        };
        CHECK_THAT(why(5, 0.9, 1), Catch::Contains("points1 has 5 points"));
        CHECK_THAT(why(9, 1, 1), Catch::Contains("prob is 1"));
        CHECK_THAT(why(9, 0.9, NaN), Catch::Contains("threshold is nan"));
        CHECK_THAT(thrown([&] { refractiveRecoverPose(m.pixels1, std::vector<Point2d>(3), m.camera1, m.camera2, R, T); }),
                   Catch::Contains("points1 has 50 points, points2 3"));
    }
}
