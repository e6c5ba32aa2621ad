// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// rejectOutliers: what the robust fit takes out of the data, and what it says if it cannot.
#include "calibrate/outliers.hpp"
#include "calibrate/fit.hpp"
#include "paper_rig.hpp"

using namespace cv;
using namespace cv::refract;
using namespace tools;

namespace {

//! Six pairs of one camera.
RigData sixPairs(const RigModel& rig, scenes::Random& random)
{
    RigData data;
    data.imageSize[0] = Size(1280, 1024);
    for (int i = 0; i < 6; i++)
    {
        const Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660));
        data.views.push_back(observe(rig, board(6, 5), random.vector(0.4), tvec, true, 0.1, random));
        data.views.back().stem = "pair" + std::to_string(i);
    }
    return data;
}

} // namespace

TEST_CASE("Wrong points and a moved board are taken out by name", "[outliers]")
{
    scenes::Random random(710);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    data.views[1].glass[0][7] += Point2d(5, -3);
    for (Point2d& p : data.views[3].direct[0])
        p += Point2d(2, 1);
    const Outliers outliers = rejectOutliers(data, rig, 0);
    CHECK(outliers.fault == "");
    REQUIRE(outliers.rejected.size() == 2);
    CHECK(outliers.rejected[0].view == "pair1");
    CHECK(outliers.rejected[0].points == 1);
    CHECK(outliers.rejected[0].glass);
    CHECK(std::isnan(data.views[1].glass[0][7].x));
    CHECK(outliers.rejected[1].view == "pair3");
    CHECK(outliers.rejected[1].image);
    CHECK(data.views[3].direct[0].empty() != data.views[3].glass[0].empty());
}

TEST_CASE("If most points are wrong, all stay and it is said", "[outliers]")
{
    scenes::Random random(720);
    CAPTURE(scenes::seed());
    const RigModel rig = paperRig(1);
    RigData data = sixPairs(rig, random);
    for (View& view : data.views)
        for (std::vector<Point2d>* pixels : {&view.direct[0], &view.glass[0]})
            for (Point2d& p : *pixels)
                p += Point2d(random.uniform(-300, 300), random.uniform(-300, 300));
    const Outliers outliers = rejectOutliers(data, rig, 0);
    CHECK(outliers.rejected.empty());
    CHECK_THAT(outliers.fault, Catch::Contains("points fit"));
    CHECK(!std::isnan(data.views[0].glass[0][0].x));
}

TEST_CASE("A lens from few images of a small board does not cost good images", "[outliers]")
{
    for (unsigned salt : {0u, 1u, 2u, 3u, 4u, 5u})
    {
        scenes::Random random(730 + salt);
        CAPTURE(scenes::seed(), salt);
        const RigModel rig = paperRig(4);
        RigData data;
        data.cameraCount = 4;
        data.imageSize.fill(Size(1280, 1024));
        for (int i = 0; i < 8; i++)
        {
            const Vec3d rvec = random.vector(0.4);
            const Vec3d tvec(random.uniform(-60, 60), random.uniform(-50, 50), random.uniform(500, 700));
            data.views.push_back(observe(rig, board(6, 5, 15.), rvec, tvec, true, 0.02, random));
            data.views.back().stem = "pair" + std::to_string(i);
        }
        RigOptions options;
        options.window = rig.cameras[0]->window();
        options.window.normal = Vec3d(0, 0, 1);
        options.lensCoefficients = 4;
        RigModel start;
        std::vector<LensSource> lensSources;
        const Outliers outliers = startWithoutOutliers(data, options, start, lensSources);
        CHECK(outliers.fault == "");
        for (const Rejected& rejected : outliers.rejected)
        {
            CAPTURE(rejected.sentence());
            CHECK(!rejected.image);
        }
    }
}

namespace {

//! Three cameras in water, of which only images through the windows tell where they are; their lenses are known.
struct SealedRig
{
    RigModel truth;
    RigData data;
    RigOptions options;
};

SealedRig sealedRig(scenes::Random& random)
{
    SealedRig rig;
    rig.truth = paperRig(3);
    rig.data.cameraCount = 3;
    rig.data.imageSize.fill(Size(1280, 1024));
    for (int c = 0; c < 3; c++)
    {
        GlassWindow window = rig.truth.cameras[c]->window();
        rig.options.known[c] = copyWithWindow(rig.truth.cameras[c], GlassWindow());
        window.outerIndex = 1.333;
        rig.truth.cameras[c]->setWindow(window);
    }
    for (int i = 0; i < 9; i++)
    {
        const Vec3d tvec(random.uniform(-60, 60), random.uniform(-50, 50), random.uniform(500, 700));
        rig.data.views.push_back(observe(rig.truth, board(6, 5), random.vector(0.4), tvec, false, 0.05, random));
        rig.data.views.back().stem = "view" + std::to_string(i);
    }
    rig.options.window = rig.truth.cameras[0]->window();
    rig.options.window.normal = Vec3d(0, 0, 1);
    return rig;
}

struct Result
{
    Outliers outliers;
    Fit fit;
};

//! @param only as of startWithoutOutliers
Result calibrated(SealedRig rig, std::optional<RigModel>& only)
{
    Result result;
    RigModel start;
    std::vector<LensSource> sources;
    result.outliers = startWithoutOutliers(rig.data, rig.options, start, sources, MAX_ROBUST_ITERATIONS, only);
    result.fit = fitAllImages(rig.data, start, sources, rig.options.flags, MAX_ITERATIONS, only.has_value());
    return result;
}

double differenceBetween(const RigModel& a, const RigModel& b)
{
    double most = 0.;
    for (size_t c = 0; c < a.cameras.size(); c++)
        most = std::max({most, norm(a.cameras[c]->window().normal - b.cameras[c]->window().normal),
                         norm(rotationVector(a.extrinsics[c].R*b.extrinsics[c].R.t()))});
    return most;
}

} // namespace

TEST_CASE("Where a search met one minimum alone the next fits end where searches of their own do", "[outliers]")
{
    for (unsigned salt : {0u, 1u, 2u})
    {
        scenes::Random random(760 + salt);
        CAPTURE(scenes::seed(), salt);
        SealedRig rig = sealedRig(random);
        std::vector<LensSource> sources;
        const RigModel start = startModel(rig.data, rig.options, sources);
        const Fit first = fitImages(rig.data, start, allViews(rig.data), rig.options.flags);
        REQUIRE(isOnlyMinimum(rig.data, first, rig.options.flags));
        CHECK(differenceBetween(first.rig, rig.truth) < 0.01);
        rig.data.views[2].glass[1][7] += Point2d(4, -3);
        std::optional<RigModel> only = first.rig, none;
        const Result placed = calibrated(rig, only), searched = calibrated(rig, none);
        CHECK(only);
        CHECK(differenceBetween(placed.fit.rig, searched.fit.rig) < 1e-7);
        REQUIRE(placed.outliers.rejected.size() == searched.outliers.rejected.size());
        for (size_t i = 0; i < placed.outliers.rejected.size(); i++)
            CHECK(placed.outliers.rejected[i].sentence() == searched.outliers.rejected[i].sentence());
    }
}

TEST_CASE("A board that moved may have hidden another minimum: all is searched again", "[outliers]")
{
    scenes::Random random(780);
    CAPTURE(scenes::seed());
    SealedRig rig = sealedRig(random);
    for (Point2d& p : rig.data.views[4].glass[2])
        p += Point2d(6, -4);
    std::optional<RigModel> only = rig.truth, none;
    const Result placed = calibrated(rig, only), searched = calibrated(rig, none);
    CHECK(!only);
    CHECK(differenceBetween(placed.fit.rig, searched.fit.rig) == 0);
    CHECK(placed.outliers.rejected.size() == searched.outliers.rejected.size());
}

TEST_CASE("Direct images, one camera, or a lens that is free: each fit searches", "[outliers]")
{
    scenes::Random random(790);
    CAPTURE(scenes::seed());
    SealedRig rig = sealedRig(random);
    Fit fit;
    fit.otherMinima = Mat(3, 5, CV_64F, Scalar(NAN));
    CHECK(isOnlyMinimum(rig.data, fit, 0));
    CHECK(!isOnlyMinimum(rig.data, fit, cv::refract::GLASS_FREE_INTRINSICS));
    CHECK(!isOnlyMinimum(rig.data, fit, cv::refract::GLASS_USE_POSES));
    fit.otherMinima.at<double>(1, 3) = 40.;
    CHECK(!isOnlyMinimum(rig.data, fit, 0));
    fit.otherMinima.at<double>(1, 3) = NAN;
    rig.data.views[0].direct[0] = rig.data.views[0].glass[0];
    CHECK(!isOnlyMinimum(rig.data, fit, 0));
    rig.data.views[0].direct[0].clear();
    rig.data.cameraCount = 1;
    CHECK(!isOnlyMinimum(rig.data, fit, 0));
}
