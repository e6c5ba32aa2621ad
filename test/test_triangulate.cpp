// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// triangulateRefractive.
#include "rig_scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <map>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

//! A stereo pair, points that both cameras see, and their pixels.
struct Scene
{
    Ptr<RefractiveCamera> camera1, camera2;
    Matx33d R;
    Vec3d T;
    std::vector<Vec3d> points;
    std::vector<Vec2d> pixels1, pixels2;
};

Scene makeScene(const LensKind& lens1, const LensKind& lens2, const GlassWindow& w1, const GlassWindow& w2, int count,
                Random& random)
{
    Scene s;
    s.camera1 = makeCamera(lens1, w1);
    s.camera2 = makeCamera(lens2, w2);
    Rodrigues(Vec3d(0, -0.3, 0) + random.vector(0.05), s.R);
    s.T = -(s.R*(Vec3d(220, 0, -30) + random.vector(20)));
    std::vector<Vec3d> all;
    for (int i = 0; i < 2*count; i++)
        all.push_back(Vec3d(random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(500, 900)));
    std::vector<Vec2d> p1, p2;
    std::vector<uchar> st1, st2;
    refractiveProjectPoints(all, Vec3d(), Vec3d(), s.camera1, p1, st1);
    refractiveProjectPoints(all, s.R, s.T, s.camera2, p2, st2);
    for (size_t i = 0; i < all.size() && (int)s.points.size() < count; i++)
        // The paper's lens has no end; far beyond any image its pixels are rounding only.
        if (st1[i] == REFRACT_OK && st2[i] == REFRACT_OK && norm(p1[i]) < 1e5 && norm(p2[i]) < 1e5)
        {
            s.points.push_back(all[i]);
            s.pixels1.push_back(p1[i]);
            s.pixels2.push_back(p2[i]);
        }
    REQUIRE((int)s.points.size() > count/4);
    return s;
}

//! Sum of squared pixel errors of X in both raw images.
double cost(const Scene& s, const Vec3d& X, size_t i)
{
    std::vector<Vec2d> a, b;
    refractiveProjectPoints(std::vector<Vec3d>{ X }, Vec3d(), Vec3d(), s.camera1, a);
    refractiveProjectPoints(std::vector<Vec3d>{ X }, s.R, s.T, s.camera2, b);
    const Vec2d e1 = a[0] - s.pixels1[i], e2 = b[0] - s.pixels2[i];
    return e1.dot(e1) + e2.dot(e2);
}

void addNoise(Scene& s, double sigma, Random& random)
{
    for (std::vector<Vec2d>* pixels : { &s.pixels1, &s.pixels2 })
        for (Vec2d& p : *pixels)
            p += Vec2d(random.normal(sigma), random.normal(sigma));
}

} // namespace

TEST_CASE("Perfect data gives the true point, every window and lens, both flags", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    std::map<int, double> worst;
    for (WindowKind kind : allWindows())
        for (size_t l = 0; l < allLenses().size(); l++)
        {
            const LensKind &lens1 = allLenses()[l], &lens2 = allLenses()[(l + 3)%allLenses().size()];
            const Scene s = makeScene(lens1, lens2, makeWindow(kind, random, 15), makeWindow(kind, random, 15), 100, random);
            for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
            {
                std::vector<Vec3d> found;
                std::vector<uchar> status;
                triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, found, status, flags);
                for (size_t i = 0; i < s.points.size(); i++)
                {
                    CAPTURE(name(kind), lens1.name, lens2.name, flags, i, s.points[i], s.pixels1[i], s.pixels2[i]);
                    REQUIRE(status[i] == REFRACT_OK);
                    const double error = norm(found[i] - s.points[i])/norm(s.points[i]);
                    REQUIRE(error < 1e-8);
                    worst[flags] = std::max(worst[flags], error);
                }
            }
        }
    printNumber("triangulation of perfect data, optimal, worst share of the range", worst[TRIANGULATE_OPTIMAL], "");
    printNumber("triangulation of perfect data, midpoint, worst share of the range", worst[TRIANGULATE_MIDPOINT], "");
}

TEST_CASE("No windows: cv::triangulatePoints on perfect data", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    const LensKind& lens = lensNamed("0 coefficients");
    const Scene s = makeScene(lens, lens, GlassWindow(), GlassWindow(), 200, random);
    Matx34d P1 = Matx34d::eye(), P2;
    for (int r = 0; r < 3; r++)
    {
        for (int c = 0; c < 3; c++)
            P2(r, c) = s.R(r, c);
        P2(r, 3) = s.T[r];
    }
    Mat homogeneous;
    triangulatePoints(lens.K*P1, lens.K*P2, s.pixels1, s.pixels2, homogeneous);
    std::vector<Vec3d> ours;
    triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, ours);
    for (int i = 0; i < homogeneous.cols; i++)
    {
        const Vec4d h(homogeneous.at<double>(0, i), homogeneous.at<double>(1, i), homogeneous.at<double>(2, i),
                      homogeneous.at<double>(3, i));
        REQUIRE(norm(ours[i] - Vec3d(h[0], h[1], h[2])/h[3]) < 1e-8*norm(ours[i]));
    }
}

TEST_CASE("With noise the optimal point has the least reprojection error", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    Scene s = makeScene(lensNamed("4 coefficients"), lensNamed("5 coefficients"), makeWindow(PANE_IN_AIR, random),
                        makeWindow(AIR_GLASS_WATER, random), 150, random);
    addNoise(s, 0.5, random);
    std::vector<Vec3d> optimal, midpoint;
    std::vector<uchar> status;
    triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, optimal, status);
    triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, midpoint, noArray(), TRIANGULATE_MIDPOINT);
    int better = 0;
    for (size_t i = 0; i < s.points.size(); i++)
    {
        if (status[i] == REFRACT_OUTSIDE_LENS_MODEL)    // noise may carry a pixel there
            continue;
        REQUIRE(status[i] == REFRACT_OK);
        const double least = cost(s, optimal[i], i);
        better += least < cost(s, midpoint[i], i)*(1 - 1e-6);
        REQUIRE(least <= cost(s, midpoint[i], i)*(1 + 1e-12));
        for (double step : { 1e-1, 1e-3 })
            for (int c = 0; c < 3; c++)
                for (int sign : { -1, 1 })
                {
                    Vec3d X = optimal[i];
                    X[c] += sign*step;
                    REQUIRE(least < cost(s, X, i));
                }
    }
    CHECK(better > 10);
}

TEST_CASE("Rays that do not meet say why", "[triangulate]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, std::vector<double>{ -0.3, 0, 0, 0 });
    struct Case { Vec2d pixel1, pixel2; uchar status; };
    const Case cases[] = { { { 640, 480 }, { 540, 480 }, REFRACT_OK },
                           { { 640, 480 }, { 640, 480 }, REFRACT_PARALLEL_RAYS },
                           { { 640, 480 }, { 740, 480 }, REFRACT_NO_INTERSECTION },     // they diverge
                           { { NaN, 480 }, { 540, 480 }, REFRACT_NOT_FINITE },
                           { { 640, 480 }, { 540, INF }, REFRACT_NOT_FINITE },
                           { { 1e5, 480 }, { 540, 480 }, REFRACT_OUTSIDE_LENS_MODEL },
                           { { 640, 480 }, { 1e5, 480 }, REFRACT_OUTSIDE_LENS_MODEL },
                           { { 640, 490 }, { 540, 490 }, REFRACT_OK } };
    std::vector<Vec2d> pixels1, pixels2;
    for (const Case& c : cases)
    {
        pixels1.push_back(c.pixel1);
        pixels2.push_back(c.pixel2);
    }
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
    {
        std::vector<Vec3d> out;
        std::vector<uchar> status;
        triangulateRefractive(camera, camera, Matx33d::eye(), Vec3d(-100, 0, 0), pixels1, pixels2, out, status, flags);
        for (size_t i = 0; i < pixels1.size(); i++)
        {
            CAPTURE(i, flags);
            CHECK((int)status[i] == (int)cases[i].status);
            for (int c = 0; c < 3; c++)
                CHECK(std::isfinite(out[i][c]) == (cases[i].status == REFRACT_OK));
        }
    }
    // Rays that meet before the scene begins.
    const Ptr<RefractiveCamera> behindGlass = RefractiveCamera::create(PLAIN_K, noArray(), GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 500));
    std::vector<Vec3d> out;
    std::vector<uchar> status;
    triangulateRefractive(behindGlass, behindGlass, Matx33d::eye(), Vec3d(-100, 0, 0), std::vector<Vec2d>{ { 640, 480 }, { 640, 480 } },
                          std::vector<Vec2d>{ { 340, 480 }, { 500, 480 } }, out, status);
    CHECK(status[0] == REFRACT_BEHIND_WINDOW);
    CHECK(std::isnan(out[0][2]));
    CHECK(status[1] == REFRACT_OK);
}

TEST_CASE("Both overloads of triangulateRefractive agree; the depth is the deeper of the inputs", "[triangulate]")
{
    const std::vector<double> D = { -0.3, 0.1, 0, 0 };
    const Vec3d rvec(0, -0.2, 0.01), T(-100, 1, 5);
    const std::vector<Point2f> pixels1 = { { 640, 480 }, { 700, 400 } };
    const std::vector<Point2d> pixels2 = { { 560, 480 }, { 610, 400 } };
    Mat a, b, c;
    triangulateRefractive(PLAIN_K, D, paper::pane(), PLAIN_K, D, GlassWindow(), rvec, T, pixels1, pixels2, a);
    triangulateRefractive(RefractiveCamera::create(PLAIN_K, D, paper::pane()), RefractiveCamera::create(PLAIN_K, D), rvec, T,
                          pixels1, pixels2, b);
    CHECK(a.type() == CV_64FC3);
    CHECK(a.size() == Size(1, 2));
    CHECK(largestDifference(a, b) == 0);
    triangulateRefractive(PLAIN_K, D, paper::pane(), PLAIN_K, D, GlassWindow(), rvec, T, pixels1, pixels1, c);
    CHECK(c.type() == CV_32FC3);
}

TEST_CASE("The predicted covariance is that of many noisy measurements", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    const Scene truth = makeScene(lensNamed("4 coefficients"), lensNamed("5 coefficients"), makeWindow(PANE_IN_AIR, random),
                                  makeWindow(AIR_GLASS_WATER, random), 1, random);
    const double sigma = 0.1;
    const int count = 20000;
    Scene noisy = truth;
    noisy.pixels1.assign(count, truth.pixels1[0]);
    noisy.pixels2.assign(count, truth.pixels2[0]);
    addNoise(noisy, sigma, random);
    std::vector<Vec3d> found;
    triangulateRefractive(truth.camera1, truth.camera2, truth.R, truth.T, noisy.pixels1, noisy.pixels2, found);
    Mat predicted, points, status;
    triangulateRefractive(truth.camera1, truth.camera2, truth.R, truth.T, truth.pixels1, truth.pixels2, points, status,
                          TRIANGULATE_OPTIMAL, sigma, noArray(), predicted);
    REQUIRE(predicted.size() == Size(9, 1));
    REQUIRE(predicted.type() == CV_64FC1);
    const Matx33d C(predicted.ptr<double>());
    CHECK(norm(C - C.t()) < 1e-12*norm(C));
    // In the principal axes of C, in units of its standard deviations, the sampled covariance is the identity; with 20000
    // draws its elements scatter by one percent.
    Vec3d variances;
    Matx33d axes;
    eigen(C, variances, axes);
    Matx33d sampled = Matx33d::zeros();
    for (const Vec3d& X : found)
    {
        Vec3d e = axes*(X - truth.points[0]);
        for (int c = 0; c < 3; c++)
            e[c] /= std::sqrt(variances[c]);
        sampled += e*e.t()*(1./count);
    }
    CHECK(norm(sampled - Matx33d::eye(), NORM_INF) < 0.05);
}

TEST_CASE("The calibration's covariance is carried to the point", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    const Scene s = makeScene(lensNamed("4 coefficients"), lensNamed("0 coefficients"), makeWindow(PANE_IN_AIR, random),
                              makeWindow(LAMINATE, random), 1, random);
    // One uncertain parameter at a time: the predicted standard deviation is that of the point moved by one sigma.
    const auto moved = [&](int which, int parameter, double step)
    {
        const Ptr<RefractiveCamera>& camera = which == 1 ? s.camera1 : s.camera2;
        const Ptr<RefractiveCamera> other = which == 1 ? makeCamera(lensNamed("4 coefficients"), camera->window())
                                                       : makeCamera(lensNamed("0 coefficients"), camera->window());
        const int lensCount = (int)camera->lensParameters().total();
        if (parameter < lensCount)
        {
            Mat p = camera->lensParameters();
            p.at<double>(parameter) += step;
            other->setLensParameters(p);
        }
        else
        {
            GlassWindow w = camera->window();
            const int c = parameter - lensCount;
            if (c < 3) w.normal[c] += step;
            else w.thickness[c - 4] += step;
            w.normal = normalize(w.normal);
            other->setWindow(w);
        }
        std::vector<Vec3d> X;
        triangulateRefractive(which == 1 ? other : s.camera1, which == 2 ? other : s.camera2, s.R, s.T, s.pixels1, s.pixels2, X);
        return X[0];
    };
    const auto countOf = [](const Ptr<RefractiveCamera>& c)
    {
        return (int)c->lensParameters().total() + 6 + 2*(int)c->window().thickness.size();
    };
    const int count1 = countOf(s.camera1), count2 = countOf(s.camera2), total = count1 + count2 + 6;
    const int lens1 = (int)s.camera1->lensParameters().total(), lens2 = (int)s.camera2->lensParameters().total();
    const auto predict = [&](int column, double variance)
    {
        Mat covariance = Mat::zeros(total, total, CV_64F), points, status, C;
        covariance.at<double>(column, column) = variance;
        triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, points, status, TRIANGULATE_OPTIMAL, 0.,
                              covariance, C);
        return Matx33d(C.ptr<double>());
    };
    struct Moved { int which, parameter; };
    for (const Moved& m : { Moved{ 1, 0 }, Moved{ 1, 3 }, Moved{ 1, lens1 + 1 }, Moved{ 1, lens1 + 4 }, Moved{ 2, 2 },
                            Moved{ 2, lens2 }, Moved{ 2, lens2 + 5 } })
    {
        const double step = m.parameter < (m.which == 1 ? lens1 : lens2) ? 1e-2 : 1e-5;
        const Vec3d g = (moved(m.which, m.parameter, step) - moved(m.which, m.parameter, -step))*(0.5/step);
        const Matx33d C = predict(m.which == 1 ? m.parameter : count1 + m.parameter, 1), expected = g*g.t();
        CAPTURE(m.which, m.parameter);
        CHECK(norm(C - expected) < 1e-5*norm(expected));
    }
    for (int axis = 0; axis < 3; axis++)        // T, then the rotation vector
    {
        std::vector<Vec3d> ends[2], turned[2];
        Vec3d rvec;
        Rodrigues(s.R, rvec);
        for (int k = 0; k < 2; k++)
        {
            Vec3d T = s.T, r = rvec;
            T[axis] += k ? -1e-3 : 1e-3;
            r[axis] += k ? -1e-6 : 1e-6;
            triangulateRefractive(s.camera1, s.camera2, s.R, T, s.pixels1, s.pixels2, ends[k]);
            triangulateRefractive(s.camera1, s.camera2, r, s.T, s.pixels1, s.pixels2, turned[k]);
        }
        const Vec3d g = (ends[0][0] - ends[1][0])*(0.5/1e-3), h = (turned[0][0] - turned[1][0])*(0.5/1e-6);
        CAPTURE(axis);
        CHECK(norm(predict(count1 + count2 + 3 + axis, 1) - Matx33d(g*g.t())) < 1e-5*norm(g)*norm(g));
        CHECK(norm(predict(count1 + count2 + axis, 1) - Matx33d(h*h.t())) < 1e-5*norm(h)*norm(h));
    }
    CHECK_THAT(thrown([&] { Mat a, b, c;
                            triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, a, b, 0, 0.1,
                                                  Mat::eye(3, 3, CV_64F), c); }),
               Contains("calibrationCovariance") && Contains("9"));
}

TEST_CASE("Correlations of the calibration are carried, too", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    const Scene s = makeScene(allLenses()[2], allLenses()[3], makeWindow(LAMINATE, random), makeWindow(AIR_GLASS_WATER, random), 70,
                              random);
    const int total = (int)(s.camera1->parameterNames().size() + s.camera2->parameterNames().size()) + 6;
    const auto predict = [&](const Mat& covariance)
    {
        Mat points, status, C;
        triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, points, status, TRIANGULATE_OPTIMAL, 0.,
                              covariance, C);
        return C;
    };
    Mat all = Mat::zeros(total, total, CV_64F), sum;
    for (int k = 0; k < 5; k++)
    {
        Mat v(total, 1, CV_64F);
        for (int i = 0; i < total; i++)
            v.at<double>(i) = i % 7 == k ? 0 : random.normal(1e-4);     // some are known exactly
        // All parameters move as one, so that the point moves on a line: of rank one.
        const Mat one = predict(v*v.t());
        for (int i = 0; i < one.rows; i++)
        {
            Vec3d variances;
            Matx33d axes;
            eigen(Matx33d(one.ptr<double>(i)), variances, axes);
            REQUIRE(variances[0] > 0);
            REQUIRE(std::abs(variances[1]) < 1e-9*variances[0]);
        }
        all += v*v.t();
        sum = k == 0 ? one.clone() : Mat(sum + one);
    }
    CHECK(norm(predict(all), sum, NORM_INF) < 1e-9*norm(sum, NORM_INF));
}

TEST_CASE("Reprojection errors of triangulated points are those of projecting them", "[triangulate]")
{
    CAPTURE(seed());
    Random random;
    Scene s = makeScene(allLenses()[2], allLenses()[3], makeWindow(PANE_IN_AIR, random), makeWindow(AIR_GLASS_WATER, random), 70, random);
    addNoise(s, 0.5, random);
    s.pixels1[3][0] = NaN;
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
    {
        std::vector<Vec3d> points;
        std::vector<uchar> status;
        std::vector<Vec2d> back1, back2;
        Mat C, errors;
        triangulateRefractive(s.camera1, s.camera2, s.R, s.T, s.pixels1, s.pixels2, points, status, flags, 0.5, noArray(), C, errors);
        refractiveProjectPoints(points, Vec3d(), Vec3d(), s.camera1, back1);
        refractiveProjectPoints(points, s.R, s.T, s.camera2, back2);
        const int count = (int)s.points.size();
        REQUIRE(errors.size() == Size(2, count));
        REQUIRE(errors.type() == CV_64FC1);
        for (int i = 0; i < count; i++)
        {
            CAPTURE(i, flags);
            if (status[i] != REFRACT_OK)
            {
                CHECK((std::isnan(errors.at<double>(i, 0)) && std::isnan(errors.at<double>(i, 1))));
                continue;
            }
            CHECK(errors.at<double>(i, 0) == Approx(norm(back1[i] - s.pixels1[i])).margin(1e-9));
            CHECK(errors.at<double>(i, 1) == Approx(norm(back2[i] - s.pixels2[i])).margin(1e-9));
        }
        CHECK(status[3] == REFRACT_NOT_FINITE);
    }
}

TEST_CASE("A point without answer has no covariance", "[triangulate]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray());
    Mat points, status, C;
    triangulateRefractive(camera, camera, Matx33d::eye(), Vec3d(-100, 0, 0), std::vector<Vec2d>{ { 640, 480 }, { 640, 480 } },
                          std::vector<Vec2d>{ { 640, 480 }, { 600, 480 } }, points, status, 0, 0.1, noArray(), C);
    for (int i = 0; i < 9; i++)
    {
        CHECK(std::isnan(C.at<double>(0, i)));
        CHECK(std::isfinite(C.at<double>(1, i)));
    }
}

TEST_CASE("Bad arguments of triangulateRefractive are named", "[triangulate]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray());
    const std::vector<Vec2d> two(2), three(3);
    Mat out;
    const Matx33d R = Matx33d::eye();
    const Vec3d T(1, 0, 0);
    CHECK_THAT(thrown([&] { triangulateRefractive(camera, camera, R, T, two, three, out); }),
               Contains("points1") && Contains("2") && Contains("3"));
    CHECK_THAT(thrown([&] { triangulateRefractive(camera, camera, R, T, two, two, out, noArray(), 77); }),
               Contains("flags") && Contains("77"));
    CHECK_THAT(thrown([&] { triangulateRefractive(camera, camera, R*3, T, two, two, out); }), Contains("R is not a rotation"));
    CHECK_THAT(thrown([&] { triangulateRefractive(camera, camera, R, Vec3d(NaN, 0, 0), two, two, out); }),
               Contains("T[0]") && Contains("nan"));
    CHECK_THAT(thrown([&] { Mat s, c; triangulateRefractive(camera, camera, R, T, two, two, out, s, 0, -1., noArray(), c); }),
               Contains("pixelSigma") && Contains("-1"));
}

TEST_CASE("A point whose likeliest place is at infinity has none", "[triangulate]")
{
    Random random(950);
    const RigTruth rig = paperStereo();
    std::vector<Point3d> X;
    for (int i = 0; i < trials(40000); i++)
    {
        const double z = random.uniform(5e5, 1e6);
        X.push_back(Point3d(random.uniform(-0.1, 0.2)*z, random.uniform(-0.1, 0.1)*z, z));
    }
    std::vector<Point2d> pixels[2];
    std::vector<uchar> status;
    for (int c = 0; c < 2; c++)
    {
        refractiveProjectPoints(X, rig.Rs[c], rig.Ts[c], rig.cameras[c], pixels[c], status);
        for (Point2d& pixel : pixels[c])
            pixel += Point2d(random.normal(1), random.normal(1));
    }
    std::vector<Point3d> points;
    Mat covariances;
    triangulateRefractive(rig.cameras[0], rig.cameras[1], rig.Rs[1], rig.Ts[1], pixels[0], pixels[1], points, status, 0, 1, noArray(),
                          covariances);
    int found = 0;
    double farthest = 0;
    for (int i = 0; i < (int)X.size(); i++)
    {
        const bool isFound = status[i] == REFRACT_OK;
        CAPTURE(i, (int)status[i], points[i], seed());
        CHECK(isFound == checkRange(covariances.row(i)));
        farthest = isFound ? std::max(farthest, norm(points[i])) : farthest;
        found += isFound;
    }
    CAPTURE(found, farthest);
    CHECK(found > 0);
    CHECK(farthest < 1e14);         // rounding, of rays half a metre apart
}
