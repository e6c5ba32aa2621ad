// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// triangulateRefractive for any number of cameras.
#include "scenes.hpp"

#include <opencv2/calib3d.hpp>
#include <bitset>
#include <cstring>
#include <functional>
#ifndef REFRACT_WITHOUT_CERES
#include <ceres/tiny_solver.h>
#endif

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using Catch::Matchers::Contains;

namespace {

//! Cameras on an arc around a volume 500 to 900 from camera 1, points that all of them see, and their pixels.
struct Rig
{
    std::vector<Ptr<RefractiveCamera> > cameras;
    std::vector<Mat> Rs;
    std::vector<Vec3d> Ts;
    std::vector<Vec3d> points;
    std::vector<std::vector<Vec2d> > pixels;
    int count() const { return (int)cameras.size(); }
};

std::vector<Vec2d> project(const Rig& rig, int c, const std::vector<Vec3d>& points, std::vector<uchar>& status)
{
    std::vector<Vec2d> pixels;
    refractiveProjectPoints(points, rig.Rs[c], rig.Ts[c], rig.cameras[c], pixels, status);
    return pixels;
}

void addCamera(Rig& rig, const Ptr<RefractiveCamera>& camera, double angle, Random& random)
{
    Mat R = Mat::eye(3, 3, CV_64F);
    const Vec3d centre(0, 0, 700);
    rig.cameras.push_back(camera);
    Vec3d T;
    if (rig.count() > 1)
    {
        Rodrigues(Vec3d(0.3*std::sin(2*angle), -angle, 0) + random.vector(0.03), R);
        T = centre + random.vector(20) - Vec3d(Mat(R*Mat(centre)));
    }
    rig.Rs.push_back(R);
    rig.Ts.push_back(T);
}

void addPoints(Rig& rig, int count, Random& random)
{
    std::vector<Vec3d> all;
    for (int i = 0; i < 3*count; i++)
        all.push_back(Vec3d(random.uniform(-80, 80), random.uniform(-80, 80), random.uniform(550, 850)));
    std::vector<std::vector<Vec2d> > pixels;
    std::vector<uchar> good(all.size(), 1), status;
    for (int c = 0; c < rig.count(); c++)
    {
        pixels.push_back(project(rig, c, all, status));
        for (size_t i = 0; i < all.size(); i++)
            good[i] = good[i] && status[i] == REFRACT_OK && norm(pixels[c][i]) < 1e5;
    }
    rig.pixels.resize(rig.count());
    for (size_t i = 0; i < all.size() && (int)rig.points.size() < count; i++)
        if (good[i])
        {
            rig.points.push_back(all[i]);
            for (int c = 0; c < rig.count(); c++)
                rig.pixels[c].push_back(pixels[c][i]);
        }
    REQUIRE((int)rig.points.size() > count/4);
}

//! Every camera another lens and another window, if they have any.
Rig makeRig(int cameras, int points, Random& random, bool windows = true)
{
    Rig rig;
    for (int c = 0; c < cameras; c++)
    {
        const LensKind& lens = allLenses()[(2 + c)%allLenses().size()];
        const WindowKind kinds[] = { PANE_IN_AIR, LAMINATE, PANE_IN_AIR, NO_WINDOW };
        const GlassWindow window = windows ? makeWindow(kinds[c%4], random, 15) : GlassWindow();
        addCamera(rig, makeCamera(lens, window), (c%2 ? 1 : -1)*0.18*((c + 1)/2), random);
    }
    addPoints(rig, points, random);
    return rig;
}

void addNoise(Rig& rig, double sigma, Random& random)
{
    for (std::vector<Vec2d>& image : rig.pixels)
        for (Vec2d& p : image)
            p += Vec2d(random.normal(sigma), random.normal(sigma));
}

//! The same with only the pixels that `sees` allows.
template<typename Sees>
Rig hidden(Rig rig, const Sees& sees)
{
    for (int c = 0; c < rig.count(); c++)
        for (size_t i = 0; i < rig.points.size(); i++)
            if (!sees(c, (int)i))
                rig.pixels[c][i] = Vec2d(NaN, NaN);
    return rig;
}

std::vector<Vec3d> solve(const Rig& rig, std::vector<uchar>& status, int flags = 0)
{
    std::vector<Vec3d> points;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, points, status, flags);
    return points;
}

#ifndef REFRACT_WITHOUT_CERES
//! Sum of squared pixel errors of X in all images that see point i, and its gradient by differences, for Ceres.
struct PixelErrors
{
    typedef double Scalar;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 3 };
    const Rig& rig;
    const int i;
    int NumResiduals() const { return 2*rig.count(); }
    void errors(const Vec3d& X, double* e) const
    {
        std::vector<uchar> status;
        for (int c = 0; c < rig.count(); c++)
        {
            const Vec2d d = project(rig, c, { X }, status)[0] - rig.pixels[c][i];
            e[2*c] = std::isnan(rig.pixels[c][i][0]) ? 0 : d[0];
            e[2*c + 1] = std::isnan(rig.pixels[c][i][0]) ? 0 : d[1];
        }
    }
    bool operator()(const double* X, double* e, double* J) const
    {
        const double h = 1e-4;
        errors(Vec3d(X), e);
        std::vector<double> up(NumResiduals()), down(up);
        for (int k = 0; k < 3 && J; k++)
        {
            Vec3d A(X), B(X);
            A[k] += h;
            B[k] -= h;
            errors(A, up.data());
            errors(B, down.data());
            for (int r = 0; r < NumResiduals(); r++)
                J[k*NumResiduals() + r] = (up[r] - down[r])/(2*h);
        }
        return true;
    }
};

Vec3d optimumByCeres(const Rig& rig, int i, const Vec3d& start)
{
    const PixelErrors errors = { rig, i };
    ceres::TinySolver<PixelErrors> solver;
    solver.options.gradient_tolerance = 1e-13;
    solver.options.parameter_tolerance = 1e-13;
    solver.options.cost_threshold = 0;
    Eigen::Vector3d X(start[0], start[1], start[2]);
    solver.Solve(errors, &X);
    return Vec3d(X[0], X[1], X[2]);
}
#endif

//! The point with the least squared distance from the rays, as linear least squares in the frame of camera 1.
Vec3d nearestToRays(const Rig& rig, int i)
{
    Matx33d A = Matx33d::zeros();
    Vec3d b;
    for (int c = 0; c < rig.count(); c++)
    {
        if (std::isnan(rig.pixels[c][i][0]))
            continue;
        std::vector<Vec3d> o, d;
        refractiveUnprojectPoints(std::vector<Vec2d>{ rig.pixels[c][i] }, o, d, rig.cameras[c]);
        const Matx33d R(rig.Rs[c].ptr<double>());
        const Vec3d direction = R.t()*d[0], origin = R.t()*(o[0] - rig.Ts[c]);
        const Matx33d P = Matx33d::eye() - direction*direction.t();
        A += P;
        b += P*origin;
    }
    return A.inv()*b;
}

} // namespace

TEST_CASE("Perfect pixels of any number of cameras give the true point, both flags", "[triangulate_rig]")
{
    CAPTURE(seed());
    double worst = 0;
    for (int cameras : { 2, 3, 4, 5, 8, 16 })
        for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
        {
            Random random(cameras);
            const Rig rig = makeRig(cameras, 150, random);
            std::vector<uchar> status;
            const std::vector<Vec3d> found = solve(rig, status, flags);
            for (size_t i = 0; i < rig.points.size(); i++)
            {
                CAPTURE(cameras, flags, i, rig.points[i]);
                REQUIRE(status[i] == REFRACT_OK);
                const double error = norm(found[i] - rig.points[i])/norm(rig.points[i]);
                REQUIRE(error < 1e-9);
                worst = std::max(worst, error);
            }
        }
    printNumber("triangulation by 2 to 16 cameras of perfect data, worst share of the range", worst, "");
}

TEST_CASE("Two of any number of cameras are the pair", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    Rig rig = makeRig(2, 1000, random);
    addNoise(rig, 0.3, random);
    rig.pixels[0][5] = Vec2d(NaN, NaN);
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
    {
        std::vector<Vec3d> pair;
        std::vector<uchar> status, statusOfPair;
        const std::vector<Vec3d> found = solve(rig, status, flags);
        triangulateRefractive(rig.cameras[0], rig.cameras[1], rig.Rs[1], rig.Ts[1], rig.pixels[0], rig.pixels[1], pair,
                              statusOfPair, flags);
        for (size_t i = 0; i < rig.points.size(); i++)
        {
            CAPTURE(i, flags);
            if (i == 5)
            {
                CHECK((int)status[i] == (int)REFRACT_TOO_FEW_VIEWS);
                CHECK((int)statusOfPair[i] == (int)REFRACT_NOT_FINITE);
                continue;
            }
            REQUIRE(status[i] == statusOfPair[i]);
            if (status[i] == REFRACT_OK)
                REQUIRE(norm(found[i] - pair[i]) < 1e-9*norm(pair[i]));
        }
    }
    Mat X, st, C, XPair, stPair, CPair;
    int parameters = 6;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        parameters += (int)camera->parameterNames().size();
    const Mat calibration = 1e-6*Mat::eye(parameters, parameters, CV_64F);
    rig.pixels[0][5] = rig.pixels[0][6];
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, X, st, 0, 0.3, calibration, C);
    triangulateRefractive(rig.cameras[0], rig.cameras[1], rig.Rs[1], rig.Ts[1], rig.pixels[0], rig.pixels[1], XPair, stPair, 0,
                          0.3, calibration, CPair);
    REQUIRE(C.size() == CPair.size());
    for (int i = 0; i < C.rows; i++)
        if (st.at<uchar>(i) == REFRACT_OK)
            REQUIRE(norm(C.row(i), CPair.row(i)) <= 1e-9*norm(CPair.row(i)));
}

#ifndef REFRACT_WITHOUT_CERES
TEST_CASE("With noise the optimum is Ceres's, whoever sees the point", "[triangulate_rig]")
{
    CAPTURE(seed());
    const int cameras = GENERATE(3, 4, 5);
    Random random(cameras);
    Rig rig = makeRig(cameras, 60, random);
    addNoise(rig, 0.5, random);
    // Two, three, ... or all cameras see a point, every set of them in turn.
    const Rig some = hidden(rig, [&](int c, int i)
    {
        const int all = (1 << cameras) - 1, set = 1 + i%all, views = (int)std::bitset<16>(set).count();
        return views < 2 || (set >> c & 1);
    });
    for (const Rig& r : { rig, some })
    {
        std::vector<uchar> status;
        const std::vector<Vec3d> found = solve(r, status);
        double worst = 0;
        for (size_t i = 0; i < r.points.size(); i++)
        {
            CAPTURE(cameras, i);
            REQUIRE(status[i] == REFRACT_OK);
            worst = std::max(worst, norm(found[i] - optimumByCeres(r, (int)i, r.points[i])));
        }
        CHECK(worst < 1e-4);        // of 700; differences are what the reference has for derivatives
        printNumber("optimum of several cameras, largest distance from Ceres's, of a range of 700", worst, "");
    }
}
#endif

TEST_CASE("The midpoint of several rays has the least squared distance from them", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    Rig rig = makeRig(5, 200, random);
    addNoise(rig, 1, random);
    rig = hidden(rig, [](int c, int i) { return i%3 || c != i%5; });
    std::vector<uchar> status;
    const std::vector<Vec3d> found = solve(rig, status, TRIANGULATE_MIDPOINT);
    for (size_t i = 0; i < rig.points.size(); i++)
    {
        CAPTURE(i);
        REQUIRE(status[i] == REFRACT_OK);
        CHECK(norm(found[i] - nearestToRays(rig, (int)i)) < 1e-8*norm(found[i]));
    }
}

TEST_CASE("Several cameras without windows: linear triangulation on perfect data", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    Rig rig;
    for (int c = 0; c < 4; c++)
        addCamera(rig, RefractiveCamera::create(PLAIN_K, noArray()), 0.2*c, random);
    addPoints(rig, 100, random);
    std::vector<uchar> status;
    const std::vector<Vec3d> found = solve(rig, status);
    for (size_t i = 0; i < rig.points.size(); i++)
    {
        // u (P_3 X) = P_1 X and v (P_3 X) = P_2 X of all cameras: the null vector of 2N x 4.
        Mat A;
        for (int c = 0; c < rig.count(); c++)
        {
            Mat P;
            hconcat(rig.Rs[c], Mat(rig.Ts[c]), P);
            P = Mat(PLAIN_K)*P;
            for (int k = 0; k < 2; k++)
                A.push_back(Mat(rig.pixels[c][i][k]*P.row(2) - P.row(k)));
        }
        Mat X;
        SVD::solveZ(A, X);
        X = X.rowRange(0, 3)/X.at<double>(3);
        CHECK(norm(Mat(found[i]), X) < 1e-7*norm(X));
    }
}

TEST_CASE("Points in the covariance's ellipsoids are as many as they should be", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    const double sigma = 0.3;
    const Rig truth = makeRig(4, 3000, random);
    Rig rig = truth;
    addNoise(rig, sigma, random);
    rig = hidden(rig, [](int c, int i) { return i%4 == 0 || c != (i/4)%4; });      // three or four cameras
    Mat points, status, C;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, points, status, TRIANGULATE_OPTIMAL, sigma, noArray(), C);
    REQUIRE(C.size() == Size(9, (int)rig.points.size()));
    double sum = 0;
    int count = 0;
    for (int i = 0; i < points.rows; i++)
    {
        if (status.at<uchar>(i) == REFRACT_OUTSIDE_LENS_MODEL)      // noise may carry a pixel there
            continue;
        REQUIRE(status.at<uchar>(i) == REFRACT_OK);
        const Vec3d e = points.at<Vec3d>(i) - truth.points[i];
        sum += e.dot(Matx33d(C.ptr<double>(i)).inv()*e);
        count++;
    }
    // Chi-square of 3 a point: its mean scatters by sqrt(6/count)/3, here 1.5 %.
    printNumber("triangulation by three or four cameras, mean chi-square over 3", sum/(3*count), "");
    CHECK(std::abs(sum/(3*count) - 1) < 5*std::sqrt(6./count)/3);
}

TEST_CASE("A point that some cameras do not see has the covariance and the errors of those that do", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    const Rig truth = makeRig(4, 130, random);
    Rig all = truth;
    addNoise(all, 0.3, random);
    const Rig rig = hidden(all, [](int c, int i) { return c != i % 4; });       // three of the four
    int total = 6*3;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        total += (int)camera->parameterNames().size();
    Mat root(total, total, CV_64F);
    for (double& value : Mat_<double>(root))
        value = random.normal(1e-5);
    const Mat calibration = root*root.t();
    Mat points, status, C, errors;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, points, status, 0, 0.3, calibration, C, errors);
    const int count = (int)rig.points.size();
    REQUIRE(errors.size() == Size(4, count));
    for (int i : { 1, 2, 3, 5, 64, 65, count - 1 })         // each alone
    {
        REQUIRE(i < count);
        if (status.at<uchar>(i) != REFRACT_OK)
            continue;
        std::vector<std::vector<Vec2d> > one;
        for (int c = 0; c < 4; c++)
            one.push_back(std::vector<Vec2d>(1, rig.pixels[c][i]));
        Mat p, s, own, e;
        triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, one, p, s, 0, 0.3, calibration, own, e);
        CAPTURE(i);
        CHECK(norm(own, C.row(i), NORM_INF) < 1e-9*norm(own, NORM_INF));
        for (int c = 0; c < 4; c++)
        {
            CHECK(std::isnan(e.at<double>(c)) == (c == i % 4));
            if (c != i % 4)
                CHECK(e.at<double>(c) == Approx(errors.at<double>(i, c)).margin(1e-9));
        }
    }
}

TEST_CASE("The covariance of a rig's calibration is carried to the point", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    const Rig rig = makeRig(3, 4, random);
    int total = 6*(rig.count() - 1);
    std::vector<int> first;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
    {
        first.push_back(total - 6*(rig.count() - 1));
        total += (int)camera->parameterNames().size();
    }
    const int extrinsics = total - 6*(rig.count() - 1), POINT = 1;
    // One uncertain parameter at a time: the point must move as the parameter does.
    const auto predicted = [&](int column)
    {
        Mat covariance = Mat::zeros(total, total, CV_64F), points, status, C;
        covariance.at<double>(column, column) = 1;
        triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, points, status, 0, 0., covariance, C);
        return Matx33d(C.ptr<double>(POINT));
    };
    const auto check = [&](int column, const std::function<void(Rig&, double)>& move, double step)
    {
        Vec3d ends[2];
        for (int k = 0; k < 2; k++)
        {
            Rig moved = rig;
            for (Ptr<RefractiveCamera>& camera : moved.cameras)
                camera = camera->clone();
            for (Mat& R : moved.Rs)
                R = R.clone();
            move(moved, k ? -step : step);
            std::vector<uchar> status;
            ends[k] = solve(moved, status)[POINT];
        }
        const Vec3d g = (ends[0] - ends[1])*(0.5/step);
        CAPTURE(column, g);
        CHECK(norm(predicted(column) - Matx33d(g*g.t())) < 1e-5*g.dot(g));
    };
    for (int c = 0; c < rig.count(); c++)
    {
        const auto lens = [=](Rig& r, double step)
        {
            Mat p = r.cameras[c]->lensParameters();
            p.at<double>(0) += step;
            r.cameras[c]->setLensParameters(p);
        };
        const auto thickness = [=](Rig& r, double step)
        {
            GlassWindow w = r.cameras[c]->window();
            w.thickness[0] += step;
            r.cameras[c]->setWindow(w);
        };
        const int lensCount = (int)rig.cameras[c]->lensParameters().total();
        check(first[c], lens, 1e-2);
        if (!rig.cameras[c]->window().thickness.empty())
            check(first[c] + lensCount + 4, thickness, 1e-3);
        for (int k = 0; k < 3 && c > 0; k++)
        {
            const auto turn = [=](Rig& r, double step)
            {
                Vec3d rvec;
                Rodrigues(r.Rs[c], rvec);
                rvec[k] += step;
                Rodrigues(rvec, r.Rs[c]);
            };
            check(extrinsics + 6*(c - 1) + k, turn, 1e-5);
            check(extrinsics + 6*(c - 1) + 3 + k, [=](Rig& r, double step) { r.Ts[c][k] += step; }, 1e-2);
        }
    }
}

TEST_CASE("A point that too few cameras see has no answer, and changes no other", "[triangulate_rig]")
{
    CAPTURE(seed());
    Random random;
    const Rig all = makeRig(4, 300, random);
    const Rig rig = hidden(all, [](int c, int i) { return i%5 > 1 || c < i%5; });    // 0 and 1 of 5 are seen by none and one
    Mat points, C;
    std::vector<uchar> status;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, points, status, 0, 1., noArray(), C);
    for (int i = 0; i < points.rows; i++)
    {
        CAPTURE(i);
        CHECK((int)status[i] == (int)(i%5 > 1 ? REFRACT_OK : REFRACT_TOO_FEW_VIEWS));
        CHECK(std::isnan(points.at<Vec3d>(i)[0]) == (i%5 <= 1));
        CHECK(std::isnan(C.at<double>(i, 8)) == (i%5 <= 1));
        if (i%5 > 1)
            CHECK(norm(points.at<Vec3d>(i) - all.points[i]) < 1e-8*norm(all.points[i]));
    }
    // A camera that sees nothing takes no part, and one alone sees nothing.
    const Rig three = hidden(all, [](int c, int) { return c != 2; }), one = hidden(all, [](int c, int) { return c == 2; });
    const std::vector<Vec3d> found = solve(three, status);
    CHECK(norm(found[7] - all.points[7]) < 1e-8*norm(all.points[7]));
    solve(one, status);
    CHECK(std::count(status.begin(), status.end(), (uchar)REFRACT_TOO_FEW_VIEWS) == (int)status.size());
    Rig alone = all;
    alone.cameras.resize(1); alone.Rs.resize(1); alone.Ts.resize(1); alone.pixels.resize(1);
    solve(alone, status);
    CHECK((int)status[0] == (int)REFRACT_TOO_FEW_VIEWS);
}

TEST_CASE("A pixel that was seen must have a ray", "[triangulate_rig]")
{
    Random random;
    Rig rig;
    for (int c = 0; c < 3; c++)
        addCamera(rig, RefractiveCamera::create(PLAIN_K, std::vector<double>{ -0.3, 0, 0, 0 }), 0.2*c, random);
    addPoints(rig, 4, random);
    rig.pixels[2][0] = Vec2d(1e5, 480);
    rig.pixels[1][1] = Vec2d(INF, 480);
    rig.pixels[1][2] = Vec2d(480, NaN);
    std::vector<uchar> status;
    solve(rig, status);
    CHECK((int)status[0] == (int)REFRACT_OUTSIDE_LENS_MODEL);
    CHECK((int)status[1] == (int)REFRACT_NOT_FINITE);
    CHECK((int)status[2] == (int)REFRACT_OK);
    CHECK((int)status[3] == (int)REFRACT_OK);
}

TEST_CASE("Rays that tell no point say so", "[triangulate_rig]")
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(PLAIN_K, noArray());
    const std::vector<Ptr<RefractiveCamera> > cameras(3, camera);
    const std::vector<Mat> Rs(3, Mat::eye(3, 3, CV_64F));
    const std::vector<std::vector<Vec2d> > parallel(3, { { 640, 480 } }), apart = { { { 640, 480 } }, { { 740, 480 } }, { { 840, 480 } } };
    std::vector<uchar> status;
    Mat points;
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
    {
        const std::vector<Vec3d> Ts = { Vec3d(), Vec3d(-100, 0, 0), Vec3d(-200, 0, 0) }, one(3);
        triangulateRefractive(cameras, Rs, Ts, parallel, points, status, flags);
        CHECK((int)status[0] == (int)REFRACT_PARALLEL_RAYS);
        CHECK(std::isnan(points.at<Vec3d>(0)[2]));
        triangulateRefractive(cameras, Rs, Ts, apart, points, status, flags);
        CHECK((int)status[0] == (int)REFRACT_NO_INTERSECTION);
        triangulateRefractive(cameras, Rs, one, apart, points, status, flags);     // all cameras at one place
        CHECK((int)status[0] == (int)REFRACT_NO_INTERSECTION);
        triangulateRefractive(cameras, Rs, one, parallel, points, status, flags);
        CHECK((int)status[0] == (int)REFRACT_PARALLEL_RAYS);
        // Two at one place and a third elsewhere: the third tells the depth.
        triangulateRefractive(cameras, Rs, std::vector<Vec3d>{ Vec3d(), Vec3d(), Vec3d(-100, 0, 0) },
                              std::vector<std::vector<Vec2d> >{ { { 640, 480 } }, { { 640, 480 } }, { { 540, 480 } } },
                              points, status, flags);
        CHECK((int)status[0] == (int)REFRACT_OK);
        CHECK(norm(points.at<Vec3d>(0) - Vec3d(0, 0, 1000)) < 1e-9);
    }
    // Rays that meet before the scene begins, for the third camera only.
    const Ptr<RefractiveCamera> behindGlass = RefractiveCamera::create(PLAIN_K, noArray(), GlassWindow(Vec3d(0, 0, 1), 20, 1.5, 2000));
    triangulateRefractive({ camera, camera, behindGlass }, Rs, std::vector<Vec3d>{ Vec3d(), Vec3d(-100, 0, 0), Vec3d(-200, 0, 0) },
                          std::vector<std::vector<Vec2d> >{ { { 640, 480 } }, { { 540, 480 } }, { { 440, 480 } } }, points, status);
    CHECK((int)status[0] == (int)REFRACT_BEHIND_WINDOW);
}

TEST_CASE("Nearly parallel rays of several cameras keep their digits", "[triangulate_rig]")
{
    // A base line of 1e-3 to 1 before points 1e3 away, with and without thick and thin windows.
    const double base = GENERATE(1e-3, 1e-1, 1.);
    const double thickness = GENERATE(0., 1e-3, 400.);
    const GlassWindow window = thickness > 0 ? GlassWindow(Vec3d(0.3, 0, 1), thickness, 1.5) : GlassWindow();
    Rig rig;
    for (int c = 0; c < 4; c++)
    {
        rig.cameras.push_back(RefractiveCamera::create(PLAIN_K, noArray(), window));
        rig.Rs.push_back(Mat::eye(3, 3, CV_64F));
        rig.Ts.push_back(Vec3d(-base*(c%2), -base*(c/2), 0));
    }
    Random random;
    addPoints(rig, 50, random);
    for (int flags : { TRIANGULATE_OPTIMAL, TRIANGULATE_MIDPOINT })
    {
        std::vector<uchar> status;
        const std::vector<Vec3d> found = solve(rig, status, flags);
        for (size_t i = 0; i < rig.points.size(); i++)
        {
            CAPTURE(base, thickness, flags, i);
            REQUIRE(status[i] == REFRACT_OK);
            // The pixels' own rounding, 1e-13, over the parallax.
            CHECK(norm(found[i] - rig.points[i]) < 1e-9/base*norm(found[i]));
        }
    }
}

TEST_CASE("Pixels of a rig come in every layout and type", "[triangulate_rig]")
{
    Random random;
    const Rig rig = makeRig(3, 70, random);
    std::vector<uchar> status;
    const std::vector<Vec3d> expected = solve(rig, status);
    std::vector<Mat> rows, strided, narrow;
    std::vector<Vec3d> rvecs;
    for (int c = 0; c < rig.count(); c++)
    {
        const Mat points = Mat(rig.pixels[c], true);
        rows.push_back(points.reshape(1));
        Mat wide(points.rows, 5, CV_64F, Scalar::all(NaN));
        points.reshape(1).copyTo(wide.colRange(1, 3));
        strided.push_back(wide.colRange(1, 3));
        Mat single;
        points.convertTo(single, CV_32F);
        narrow.push_back(single);
        Vec3d rvec;
        Rodrigues(rig.Rs[c], rvec);
        rvecs.push_back(rvec);
    }
    Mat out;
    for (const std::vector<Mat>& pixels : { rows, strided })
    {
        triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, pixels, out);
        CHECK(out.type() == CV_64FC3);
        CHECK(largestDifference(out, expected) == 0);
    }
    triangulateRefractive(rig.cameras, rvecs, rig.Ts, rows, out);
    CHECK(largestDifference(out, expected) < 1e-8);
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, narrow, out);
    CHECK(out.type() == CV_32FC3);
    Mat wide;
    out.convertTo(wide, CV_64F);
    CHECK(largestDifference(wide, expected) < 0.1);
    narrow[1].convertTo(narrow[1], CV_64F);
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, narrow, out);
    CHECK(out.type() == CV_64FC3);          // the deeper of the inputs

    Mat covariance, st;
    triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, std::vector<Mat>(3), out, st, 0, 1., noArray(), covariance);
    CHECK(out.empty());
    CHECK(covariance.empty());
}

TEST_CASE("Points of a rig do not depend on the number of threads", "[triangulate_rig]")
{
    Random random;
    Rig rig = makeRig(3, 2000, random);
    addNoise(rig, 0.5, random);
    rig = hidden(rig, [](int c, int i) { return i%7 || c != 1; });
    for (std::vector<Vec2d>& image : rig.pixels)        // as many as are worth a thread
    {
        const std::vector<Vec2d> once = image;
        for (int k = 0; k < 12; k++)
            image.insert(image.end(), once.begin(), once.end());
    }
    const int before = getNumThreads();
    std::vector<uchar> status;
    setNumThreads(1);
    const std::vector<Vec3d> one = solve(rig, status);
    setNumThreads(3);
    const std::vector<Vec3d> three = solve(rig, status);
    setNumThreads(before);
    CHECK(std::equal(one.begin(), one.end(), three.begin(), [](const Vec3d& a, const Vec3d& b)
                     { return std::memcmp(a.val, b.val, sizeof a.val) == 0; }));
}

TEST_CASE("Bad arguments of triangulateRefractive for a rig are named", "[triangulate_rig]")
{
    Random random;
    const Rig rig = makeRig(3, 10, random);
    const auto refused = [](const Rig& r, int flags = 0)
    {
        return thrown([&] { Mat out; triangulateRefractive(r.cameras, r.Rs, r.Ts, r.pixels, out, noArray(), flags); });
    };
    CHECK_THAT(refused(Rig()), Contains("cameras is empty"));
    CHECK_THAT(refused(rig, 7), Contains("flags") && Contains("7"));
    Rig bad = rig;
    bad.cameras[2] = nullptr;
    CHECK_THAT(refused(bad), Contains("cameras[2] is empty"));
    bad = rig;
    bad.Rs.pop_back();
    CHECK_THAT(refused(bad), Contains("Rs has 2 elements; cameras has 3"));
    bad = rig;
    bad.Ts[0][1] = 0.5;
    CHECK_THAT(refused(bad), Contains("Rs[0] and Ts[0]") && Contains("0.5"));
    bad = rig;
    bad.Rs[1] = Mat(rig.Rs[1]*2);
    CHECK_THAT(refused(bad), Contains("Rs[1] is not a rotation"));
    bad = rig;
    bad.pixels.pop_back();
    CHECK_THAT(refused(bad), Contains("imagePoints has 2 elements; cameras has 3"));
    bad = rig;
    bad.pixels[2].pop_back();
    CHECK_THAT(refused(bad), Contains("imagePoints[0] has 10 points, imagePoints[2] 9"));
    bad = rig;
    bad.Rs[0] = (Mat_<double>(3, 1) << 0, 1e-9, 0);      // rounding
    CHECK(refused(bad) == "");
    CHECK_THAT(thrown([&] { Mat a, b, c;
                            triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, a, b, 0, 0.1, Mat::eye(3, 3, CV_64F), c); }),
               Contains("calibrationCovariance") && Contains("9"));
    int parameters = 6*((int)rig.cameras.size() - 1);
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        parameters += (int)camera->lensParameters().total() + 6 + 2*(int)camera->window().thickness.size();
    const auto withCovariance = [&](double entry12, double entry21, double variance)
    {
        Mat C = Mat::eye(parameters, parameters, CV_64F)*1e-6, a, b, c;
        C.at<double>(1, 1) = variance;
        C.at<double>(1, 2) = entry12;
        C.at<double>(2, 1) = entry21;
        return thrown([&] { triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, a, b, 0, 0.1, C, c); });
    };
    CHECK(withCovariance(1e-7, 1e-7, 1e-6) == "");
    CHECK(withCovariance(0, 0, 0) == "");           // known exactly
    CHECK(withCovariance(0, 0, -1e-20) == "");      // rounding
    CHECK_THAT(withCovariance(1e-7, 1e-7, 0), Contains("calibrationCovariance has a covariance that is not 0"));
    CHECK_THAT(withCovariance(0, 0, -1e-6), Contains("calibrationCovariance") && Contains("below 0 on its diagonal"));
    CHECK_THAT(withCovariance(0, 1e-7, 1e-6), Contains("calibrationCovariance is not symmetric"));
    CHECK_THAT(withCovariance(2e-6, 2e-6, 1e-6), Contains("calibrationCovariance is not positive semidefinite"));
    CHECK_THAT(thrown([&] { Mat a, b, c; triangulateRefractive(rig.cameras, rig.Rs, rig.Ts, rig.pixels, a, b, 0, -1., noArray(), c); }),
               Contains("pixelSigma") && Contains("-1"));
}
