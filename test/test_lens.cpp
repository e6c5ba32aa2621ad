// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// One battery over all lens models, through the inner header.
#include "lens/models.hpp"
#include "quick_require.hpp"
#include "scenes.hpp"
#include <iostream>

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

Ptr<Lens> makeLens(const LensKind& kind) { return cv::refract::makeLens({ kind.model, kind.K, kind.coefficients }); }

uchar project(const Lens& lens, const Vec3d& d, Vec2d& pixel, uchar status = REFRACT_OK)
{
    lens.project(1, &d[0], &d[1], &d[2], &pixel[0], &pixel[1], &status);
    return status;
}

uchar unproject(const Lens& lens, const Vec2d& pixel, Vec3d& d, uchar status = REFRACT_OK)
{
    lens.unproject(1, &pixel[0], &pixel[1], &d[0], &d[1], &d[2], &status);
    return status;
}

} // namespace

TEST_CASE("Direction to pixel and back", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    const Ptr<Lens> lens = makeLens(kind);
    Random random;
    double worstPixel = 0, worstDirection = 0;
    for (int i = 0; i < 20000; i++)
    {
        const Vec3d d = randomDirection(kind, random);
        Vec2d pixel, again;
        Vec3d back;
        QUICK_REQUIRE(project(*lens, random.logUniform(1e-6, 1e6)*d, pixel) == REFRACT_OK, d);
        QUICK_REQUIRE(unproject(*lens, pixel, back) == REFRACT_OK, d);
        QUICK_REQUIRE(project(*lens, back, again) == REFRACT_OK, d);
        QUICK_REQUIRE(std::abs(norm(back) - 1) < 1e-15, d);
        worstPixel = std::max(worstPixel, norm(again - pixel));
        worstDirection = std::max(worstDirection, norm(back - d));
    }
    CHECK(worstPixel < 1e-10);
    CHECK(worstDirection < 1e-13);
}

TEST_CASE("The principal point looks along the axis", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    if (kind.isSplined() || (kind.isMrcal() && !kind.coefficients.empty() && kind.coefficients[0] != 0))
        return;         // splines may shift it, and CAHVOR's own axis is another
    const Ptr<Lens> lens = makeLens(kind);
    Vec2d pixel;
    Vec3d d;
    REQUIRE(project(*lens, Vec3d(0, 0, 7), pixel) == REFRACT_OK);
    CHECK(norm(pixel - Vec2d(kind.K(0, 2), kind.K(1, 2))) < 1e-12);
    REQUIRE(unproject(*lens, pixel, d) == REFRACT_OK);
    CHECK(norm(d - Vec3d(0, 0, 1)) < 1e-15);
    REQUIRE(project(*lens, Vec3d(1e-300, -1e-300, 1), pixel) == REFRACT_OK);
    CHECK(norm(pixel - Vec2d(kind.K(0, 2), kind.K(1, 2))) < 1e-12);
}

TEST_CASE("A direction next to the axis has the axis' image and derivatives", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const Ptr<Lens> lens = makeLens(kind);
    const int MANY = 16;        // of which the last ones, or none, are alone in their registers
    const std::vector<double> X(MANY, 0), Z(MANY, 500);
    std::vector<double> u(MANY), v(MANY), onAxis(6*MANY), beside(6*MANY);      // entry by entry, all points of it
    const auto differentiate = [&](const std::vector<double>& x, std::vector<double>& byDirection)
    {
        std::vector<uchar> status(MANY, REFRACT_OK);
        const Columns all = { byDirection.data(), 3, MANY }, none = { nullptr, 0, 0 };
        lens->projectJacobian(MANY, x.data(), x.data(), Z.data(), u.data(), v.data(), all, none, status.data());
        CHECK(status == std::vector<uchar>(MANY, REFRACT_OK));
    };
    differentiate(X, onAxis);
    for (double tiny : { 1e-300, 1e-200, 1e-163, 1e-162, 1e-161, 1e-160, 1e-100, 1e-20 })
    {
        CAPTURE(tiny);
        differentiate(std::vector<double>(MANY, tiny), beside);
        CHECK(largestDifference(Mat(beside), Mat(onAxis)) < 1e-12);
    }
}

TEST_CASE("Any pixel gives its direction or says that it has none", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    const Ptr<Lens> lens = makeLens(kind);
    Random random;
    double worst = 0;
    for (int i = 0; i < 20000; i++)
    {
        const double size = random.logUniform(10, 1e5);
        const Vec2d pixel(kind.K(0, 2) + random.uniform(-size, size), kind.K(1, 2) + random.uniform(-size, size));
        Vec3d d;
        Vec2d again;
        const uchar status = unproject(*lens, pixel, d);
        QUICK_REQUIRE((status == REFRACT_OK || status == REFRACT_OUTSIDE_LENS_MODEL), pixel);
        if (status != REFRACT_OK)
            continue;
        QUICK_REQUIRE(project(*lens, d, again) == REFRACT_OK, pixel);
        // Far out the pixel's own rounding is what remains.
        worst = std::max(worst, norm(again - pixel)/std::max(1., norm(pixel)/1e3));
    }
    CHECK(worst < 1e-10);
}

TEST_CASE("A direction with an image is the only one with that image", "[lens]")
{
    std::vector<LensKind> kinds = allLenses();
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    kinds.push_back({ "barrel that folds back", "opencv", K, { -0.4, 0, 0, 0 }, 0 });
    kinds.push_back({ "barrel that folds back, decentred", "opencv", K, { -0.3, 0.05, 0.01, -0.02, -0.01 }, 0 });
    kinds.push_back({ "rational with a pole", "opencv", K, { 0, 0, 0, 0, 0, -0.5, 0, 0 }, 0 });
    kinds.push_back({ "strong prism", "opencv", K, { -0.2, 0, 0, 0, 0, 0, 0, 0, 0.05, 0, -0.05, 0 }, 0 });
    kinds.push_back({ "fisheye that folds back", "fisheye", K, { -0.3, 0, 0, 0 }, 0 });
    for (const LensKind& kind : kinds)
    {
        CAPTURE(kind.name, seed());
        const Ptr<Lens> lens = makeLens(kind);
        Random random;
        int inside = 0, outside = 0;
        for (int i = 0; i < 20000; i++)
        {
            const Vec3d d = randomNormal(random, 89);
            Vec2d pixel;
            const uchar status = project(*lens, d, pixel);
            QUICK_REQUIRE((status == REFRACT_OK || status == REFRACT_OUTSIDE_LENS_MODEL), d, pixel);
            if (status != REFRACT_OK)
            {
                outside++;
                continue;
            }
            inside++;
            Vec3d back;
            QUICK_REQUIRE(unproject(*lens, pixel, back) == REFRACT_OK, d, pixel);
            // At the edge of the range the model's slope goes to zero, and with it what a pixel tells of the direction.
            QUICK_REQUIRE(norm(back - d) < 1e-5, d, pixel);
        }
        CHECK(inside > 1000);
        if (kind.halfField == 0)
            CHECK(outside > 1000);
    }
}

TEST_CASE("Where the monotone range ends is known exactly", "[lens]")
{
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    // r (1 + k1 r^2) has its maximum at r = 1/sqrt(-3 k1).
    const double k1 = -0.4, edge = 1/std::sqrt(-3*k1), highest = edge*(1 + k1*edge*edge);
    const Ptr<Lens> lens = cv::refract::makeLens({ "opencv", K, { k1, 0, 0, 0 } });
    Vec2d pixel;
    Vec3d d;
    CHECK(project(*lens, Vec3d(0, edge*(1 - 1e-9), 1), pixel) == REFRACT_OK);
    CHECK(project(*lens, Vec3d(0, edge*(1 + 1e-9), 1), pixel) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(unproject(*lens, Vec2d(640 + 1000*highest*(1 - 1e-9), 480), d) == REFRACT_OK);
    CHECK(d[0]/d[2] == Approx(edge).epsilon(1e-4));
    CHECK(unproject(*lens, Vec2d(640 + 1000*highest*(1 + 1e-9), 480), d) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(unproject(*lens, Vec2d(1e9, 480), d) == REFRACT_OUTSIDE_LENS_MODEL);

    const double angle = 1/std::sqrt(0.9);          // theta (1 - 0.3 theta^2)
    const Ptr<Lens> fisheye = cv::refract::makeLens({ "fisheye", K, { -0.3, 0, 0, 0 } });
    CHECK(project(*fisheye, Vec3d(std::sin(angle - 1e-9), 0, std::cos(angle - 1e-9)), pixel) == REFRACT_OK);
    CHECK(project(*fisheye, Vec3d(std::sin(angle + 1e-9), 0, std::cos(angle + 1e-9)), pixel)
          == REFRACT_OUTSIDE_LENS_MODEL);
}

TEST_CASE("Next to a rational lens's pole every pixel has its direction", "[lens]")
{
    CAPTURE(seed());
    Random random;
    int lenses = 0;
    double worst = 0;
    for (int i = 0; lenses < 200 && i < 20000; i++)
    {
        LensKind kind = { "rational", "opencv", { 2400, 0, 1920, 0, 2390, 1090, 0, 0, 1 },
                          { random.uniform(-3, 3), random.uniform(-6, 6), random.normal(1e-3), random.normal(1e-3), random.uniform(-2, 2),
                            random.uniform(-4, 4), random.uniform(-5, 5), random.uniform(-6, 6) }, 0 };
        const double* k = kind.coefficients.data();
        const auto divisor = [=](double s) { return 1 + s*(k[5] + s*(k[6] + s*k[7])); };
        const auto radial = [=](double r) { return r*(1 + r*r*(k[0] + r*r*(k[1] + r*r*k[4])))/divisor(r*r); };
        double pole = 0, most = 0;
        for (double r = 0; r < 2 && divisor(r*r) > 0; r += 1e-4)
        {
            pole = r;
            if (radial(r) < most)
                break;                  // it turns back before the pole
            most = radial(r);
        }
        if (!(divisor((pole + 1e-4)*(pole + 1e-4)) < 0) || pole < 0.2)
            continue;
        lenses++;
        const Ptr<Lens> lens = makeLens(kind);
        for (int j = 0; j < 300; j++)
        {
            const double r = pole*(1 - random.logUniform(1e-7, 1e-1)), azimuth = random.uniform(0, 2*CV_PI);
            const Vec3d d = normalize(Vec3d(r*std::cos(azimuth), r*std::sin(azimuth), 1));
            Vec2d pixel;
            Vec3d back;
            if (project(*lens, d, pixel) != REFRACT_OK)
                continue;
            QUICK_REQUIRE(unproject(*lens, pixel, back) == REFRACT_OK, i, j, r/pole, pixel);
            worst = std::max(worst, norm(back - d));
        }
    }
    CHECK(lenses == 200);
    CHECK(worst < 1e-13);
}

TEST_CASE("Directions behind the camera have no image", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    Vec2d pixel;
    CHECK(project(*makeLens(kind), Vec3d(0, 0, -1), pixel) != REFRACT_OK);
    CHECK(project(*makeLens(kind), Vec3d(0, 0, 0), pixel) != REFRACT_OK);
    if (kind.model == "opencv")
        for (const Vec3d& d : { Vec3d(1, 2, 0), Vec3d(0.1, 0.1, -1), Vec3d(0, 0, 0) })
            CHECK(project(*makeLens(kind), d, pixel) == REFRACT_BEHIND_CAMERA);
}

TEST_CASE("The fisheye goes on beyond 90 degrees", "[lens]")
{
    const Ptr<Lens> lens = cv::refract::makeLens({ "fisheye", Matx33d(400, 0, 640, 0, 400, 512, 0, 0, 1), {} });
    for (double degrees : { 90., 91., 120., 170. })
    {
        const double angle = degrees*CV_PI/180;
        Vec2d pixel;
        Vec3d d;
        REQUIRE(project(*lens, Vec3d(std::sin(angle), 0, std::cos(angle)), pixel) == REFRACT_OK);
        CHECK(pixel[0] == Approx(640 + 400*angle).epsilon(1e-15));
        REQUIRE(unproject(*lens, pixel, d) == REFRACT_OK);
        CHECK(norm(d - Vec3d(std::sin(angle), 0, std::cos(angle))) < 2e-15);
    }
}

TEST_CASE("A lens lane that has a status keeps it", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    const Ptr<Lens> lens = makeLens(kind);
    Vec2d pixel;
    Vec3d d;
    CHECK(project(*lens, Vec3d(0, 0, 1), pixel, REFRACT_TOTAL_REFLECTION) == REFRACT_TOTAL_REFLECTION);
    CHECK(project(*lens, Vec3d(0, 0, -1), pixel, REFRACT_TOTAL_REFLECTION) == REFRACT_TOTAL_REFLECTION);
    CHECK(unproject(*lens, Vec2d(NaN, 3), d, REFRACT_NOT_FINITE) == REFRACT_NOT_FINITE);
}

TEST_CASE("Lens derivatives against central differences of several steps", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name, seed());
    const Ptr<Lens> lens = makeLens(kind);
    const std::vector<double> p = lens->parameters();
    const int count = (int)p.size();
    Random random;
    for (int i = 0; i < 100; i++)
    {
        const Vec3d d = i == 0 ? Vec3d(0, 0, 2) : random.uniform(0.5, 2)*randomNormal(random, 0.9*kind.halfField);
        Vec2d pixel;
        std::vector<double> dDirection(6), dParameters(2*count);
        REQUIRE(lens->projectJacobian(d, pixel, dDirection.data(), dParameters.data()) == REFRACT_OK);
        for (int c = 0; c < 3 + count; c++)
        {
            const bool isDirection = c < 3;
            const Vec2d analytic = isDirection ? Vec2d(dDirection[c], dDirection[3 + c])
                                               : Vec2d(dParameters[c - 3], dParameters[count + c - 3]);
            double best = INF;
            for (double step : { 1e-3, 1e-4, 1e-5, 1e-6, 1e-7 })
            {
                Vec2d ends[2];
                for (int k = 0; k < 2; k++)
                {
                    Vec3d ds = d;
                    std::vector<double> ps = p;
                    (isDirection ? ds[c] : ps[c - 3]) += k ? -step : step;
                    REQUIRE(project(*lens->withParameters(ps), ds, ends[k]) == REFRACT_OK);
                }
                best = std::min(best, norm((ends[0] - ends[1])/(2*step) - analytic));
            }
            CAPTURE(i, c, d, analytic);
            REQUIRE(best < 1e-6*(1 + 1e-2*norm(analytic)));
        }
    }
}

TEST_CASE("A lens keeps its parameters", "[lens]")
{
    const LensKind kind = GENERATE(from_range(allLenses()));
    CAPTURE(kind.name);
    const Ptr<Lens> lens = makeLens(kind);
    const std::vector<double> expected = kind.parameters();
    CHECK(lens->parameters() == expected);
    CHECK(largestDifference(lens->cameraMatrix(), kind.K) == 0);
    CHECK(lens->model() == kind.model);
    CHECK((int)lens->parameterNames().size() == lens->parameterCount());
    const Ptr<Lens> same = lens->withParameters(expected);
    CHECK(same->parameters() == expected);
    CHECK(largestDifference(same->cameraMatrix(), kind.K) == 0);
    CHECK(same->model() == lens->model());
    if (!lens->distCoeffs().empty() || !kind.coefficients.empty())
        CHECK(largestDifference(same->distCoeffs(), kind.coefficients) == 0);
}

TEST_CASE("Every model of the table is among the lenses of the tests", "[lens]")
{
    const auto makerOf = [](const std::string& name)
    {
        for (const LensModel& model : lensModels())
            if (model.isNameOf(name))
                return model.make;
        return (LensMaker*)nullptr;
    };
    for (const LensModel& model : lensModels())
    {
        CAPTURE(model.name);
        CHECK(std::any_of(allLenses().begin(), allLenses().end(),
                          [&](const LensKind& kind) { return makerOf(kind.model) == model.make; }));
    }
}

TEST_CASE("mrcal's names make OpenCV's models, others are refused", "[lens]")
{
    using Catch::Matchers::Contains;
    const std::vector<double> core = { 1000, 1010, 640, 480 };
    struct Model { const char* name; size_t coefficients; };
    for (const Model& m : { Model{ "LENSMODEL_PINHOLE", 0 }, Model{ "LENSMODEL_OPENCV4", 4 },
                            Model{ "LENSMODEL_OPENCV5", 5 }, Model{ "LENSMODEL_OPENCV8", 8 },
                            Model{ "LENSMODEL_OPENCV12", 12 } })
    {
        CAPTURE(m.name);
        std::vector<double> p = core;
        p.resize(4 + m.coefficients, 0.01);
        const Ptr<Lens> lens = makeMrcalLens(m.name, p);
        CHECK(lens->model() == m.name);
        CHECK(lens->parameters() == p);
        CHECK(lens->withParameters(p)->model() == m.name);
        p.push_back(0);
        CHECK_THAT(thrown([&] { makeMrcalLens(m.name, p); }), Contains("intrinsics") && Contains(m.name));
    }
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_CAHVOR", core); }), Contains("LENSMODEL_CAHVOR has 9"));
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_OPENCV", core); }), Contains("known are LENSMODEL_PINHOLE, ")
               && Contains("LENSMODEL_CAHVORE_linearity=...") && Contains("LENSMODEL_SPLINED_STEREOGRAPHIC_order=..."));
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_PINHOLE", { 1000, -5, 1, 1 }); }),
               Contains("intrinsics[1]") && Contains("-5"));
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_PINHOLE", { 1000, 1000, NaN, 1 }); }), Contains("intrinsics[2]"));
}

TEST_CASE("What a name of mrcal's goes on with is read or refused", "[lens]")
{
    using Catch::Matchers::Contains;
    const std::string splined = "LENSMODEL_SPLINED_STEREOGRAPHIC_";
    std::vector<double> p = { 1000, 1010, 640, 480 };
    p.resize(4 + 2*5*4);
    CHECK(makeMrcalLens(splined + "order=3_Nx=5_Ny=4_fov_x_deg=90", p)->distCoeffs().total() == 40);
    for (const char* wrong : { "order=3_Nx=5_Ny=4", "order=3_Nx=5_Ny=4_fov_x_deg=", "order=3_Nx=5_Ny=4_fov_x_deg=90_",
                               "order=3_Ny=4_Nx=5_fov_x_deg=90", "order=3_Nx=5_Ny=4_fov_x_deg=90x", "order=x" })
        CHECK_THAT(thrown([&] { makeMrcalLens(splined + wrong, p); }), Contains(splined + wrong) && Contains("must be"));
    for (const char* wrong : { "order=1_Nx=5_Ny=4_fov_x_deg=90", "order=4_Nx=5_Ny=4_fov_x_deg=90", "order=3_Nx=3_Ny=4_fov_x_deg=90",
                               "order=2_Nx=5_Ny=2_fov_x_deg=90", "order=3_Nx=5_Ny=4_fov_x_deg=360",
                               "order=3_Nx=5_Ny=4.5_fov_x_deg=90", "order=3_Nx=-5_Ny=4_fov_x_deg=90",
                               "order=3_Nx=5_Ny=1e9_fov_x_deg=90" })
        CHECK_THAT(thrown([&] { makeMrcalLens(splined + wrong, p); }), Contains(splined + wrong));
    CHECK_THAT(thrown([&] { makeMrcalLens(splined + "order=3_Nx=5_Ny=5_fov_x_deg=90", p); }), Contains("44 values") && Contains("54"));
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_CAHVORE", p); }), Contains("LENSMODEL_CAHVORE_linearity="));
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_CAHVORE_linearity=nan", p); }), Contains("must be"));
    p.assign(12, 0.001);
    p[0] = p[1] = 1000;
    CHECK_THAT(thrown([&] { makeMrcalLens("LENSMODEL_CAHVORE_linearity=0.4", p); }), Contains("intrinsics[9]") && Contains("E = 0"));
}

TEST_CASE("A splined surface that folds outside of its middle: one direction a pixel, or none", "[lens]")
{
    CAPTURE(seed());
    for (int order : { 2, 3 })
    {
        Random random(50 + order);
        const int nx = 14, ny = 12;
        std::vector<double> p = { 1000, 1010, 640, 480 };
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++)
            {
                const double outside = std::max(std::abs(i - 0.5*(nx - 1))/nx, std::abs(j - 0.5*(ny - 1))/ny);     // to 0.46
                for (int k = 0; k < 2; k++)
                    p.push_back(random.normal(outside > 0.3 ? 0.3 : 0.01));
            }
        const Ptr<Lens> lens = makeMrcalLens(format("LENSMODEL_SPLINED_STEREOGRAPHIC_order=%d_Nx=%d_Ny=%d_fov_x_deg=120", order, nx, ny),
                                             p);
        int seen = 0, outside = 0, missed = 0;
        for (int i = 0; i < 50000; i++)
        {
            const Vec3d d = randomNormal(random, 75);
            Vec2d pixel, same;
            Vec3d back;
            double byDirection[6], byParameters[8];
            const uchar status = project(*lens, d, pixel);
            CAPTURE(order, d, pixel);
            REQUIRE(lens->projectJacobian(d, same, byDirection, byParameters) == status);
            if (status != REFRACT_OK)
            {
                outside++;
                continue;
            }
            seen++;
            REQUIRE(norm(same - pixel) < 1e-12);
            // The picture is not mirrored: with a third direction across, the determinant of its change keeps the sign.
            const Vec3d x = Vec3d(0, 1, 0).cross(d), y = d.cross(x);
            const Matx23d J(byDirection);
            REQUIRE(determinant(Matx22d((J*x)[0], (J*y)[0], (J*x)[1], (J*y)[1])) > 0);
            if (unproject(*lens, pixel, back) == REFRACT_OK)
                REQUIRE(norm(back - d) < 1e-9);
            else
                missed++;
        }
        CAPTURE(seen, outside, missed);
        CHECK(seen > 5000);
        CHECK(outside > 5000);
        CHECK(missed < 0.02*seen);
        std::cout << "[numbers] folding splines of order " << order << ": " << seen << " directions with a pixel, of which "
                  << missed << " are not found again" << std::endl;
    }
}

TEST_CASE("Lenses of the whole sphere", "[lens]")
{
    CAPTURE(seed());
    Random random;
    for (const LensKind& kind : allLenses())
    {
        if (!kind.isMrcal() || !kind.coefficients.empty())
            continue;
        CAPTURE(kind.name);
        const Ptr<Lens> lens = makeLens(kind);
        double worst = 0;
        for (int i = 0; i < 20000; i++)
        {
            const Vec3d d = randomNormal(random, 179);
            Vec2d pixel;
            Vec3d back;
            CAPTURE(d);
            REQUIRE(project(*lens, d, pixel) == REFRACT_OK);
            REQUIRE(unproject(*lens, pixel, back) == REFRACT_OK);
            worst = std::max(worst, norm(back - d));
        }
        CHECK(worst < 1e-14);
        Vec2d pixel;
        CHECK(project(*lens, Vec3d(0, 0, -3), pixel) == REFRACT_OUTSIDE_LENS_MODEL);
    }
    Vec2d pixel;
    Vec3d d;
    const Ptr<Lens> lonlat = makeMrcalLens("LENSMODEL_LONLAT", { 100, 100, 0, 0 });
    const Ptr<Lens> latlon = makeMrcalLens("LENSMODEL_LATLON", { 100, 100, 0, 0 });
    CHECK(project(*lonlat, Vec3d(0, 1, 0), pixel) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(project(*latlon, Vec3d(-1, 0, 0), pixel) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(unproject(*lonlat, Vec2d(100*CV_PI + 1e-9, 0), d) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(unproject(*lonlat, Vec2d(100*CV_PI - 1e-9, 0), d) == REFRACT_OK);
    CHECK(unproject(*lonlat, Vec2d(0, 50*CV_PI + 1e-9), d) == REFRACT_OUTSIDE_LENS_MODEL);
    CHECK(unproject(*latlon, Vec2d(50*CV_PI - 1e-9, 0), d) == REFRACT_OK);
}
