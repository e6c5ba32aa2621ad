// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Whose image is whose, and when, in a model of COLMAP.
#include "colmap/survey_adjustment.hpp"
#include "console/failure.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>

using namespace cv;
using namespace cv::refract;
using namespace tools;
using Catch::Contains;

namespace {

RigModel rigOf(int cameras)
{
    RigModel rig;
    for (int c = 0; c < cameras; c++)
    {
        rig.cameras.push_back(RefractiveCamera::create(Matx33d(800, 0, 320, 0, 800, 240, 0, 0, 1), noArray()));
        rig.windows.push_back(c);
        rig.extrinsics.push_back({Matx33d::eye(), Vec3d(-90*c, 0, 0)});
    }
    return rig;
}

//! Three moments of two cameras, of which the second is at (1, 0, 0) in the model's unit. Each image shows the same points.
ColmapModel modelOf(const std::vector<std::string>& names)
{
    ColmapModel model;
    for (uint32_t c = 1; c <= 2; c++)
        model.cameras.push_back({c, "PINHOLE", 640, 480, {800, 800, 320, 240}});
    for (uint64_t id = 1; id <= 8; id++)
    {
        ColmapPoint point;
        point.id = id;
        point.X = Vec3d((double)id, (double)(id % 3), 10);
        model.points.push_back(point);
    }
    for (size_t i = 0; i < names.size(); i++)
    {
        ColmapImage image;
        image.id = (uint32_t)i + 1;
        image.camera = names[i][0] == 'r' ? 2 : 1;
        image.name = names[i];
        image.cam_from_world.t = Vec3d((double)i, 0, 0);
        for (const ColmapPoint& point : model.points)
            image.pixels.push_back({100. + 20*(double)point.id, 200, point.id});
        model.images.push_back(image);
    }
    return model;
}

void addRig(ColmapModel& model, bool isExchanged)
{
    const uint32_t first = isExchanged ? 2 : 1;
    ColmapRig rig;
    rig.id = 1;
    rig.sensors = {{COLMAP_CAMERA, first, 0, {}}, {COLMAP_CAMERA, 3 - first, 1, {}}};
    rig.sensors[1].sensor_from_rig.t = Vec3d(isExchanged ? 1 : -1, 0, 0);
    model.rigs = {rig};
    for (uint32_t moment = 0; moment < 2; moment++)
        model.frames.push_back({moment + 1, 1, {}, {{COLMAP_CAMERA, 1, 2*moment + 1}, {COLMAP_CAMERA, 2, 2*moment + 2}}});
}

std::string refusalOf(const ColmapModel& model, int cameras, const std::vector<std::string>& globs = {})
{
    try
    {
        surveyOf(model, rigOf(cameras), globs, "sparse");
        return "";
    }
    catch (const Failure& e)
    {
        return e.what();
    }
}

const std::vector<std::string> NAMES = {"l/1.png", "r/1.png", "l/2.png", "r/2.png"};

} // namespace

TEST_CASE("A rig of a model is taken for the calibration's only in its order", "[colmap]")
{
    ColmapModel same = modelOf(NAMES), exchanged = modelOf(NAMES);
    addRig(same, false);
    addRig(exchanged, true);
    CHECK(refusalOf(same, 2) == "");
    CHECK_THAT(refusalOf(exchanged, 2), Contains("in another order? Say with --images"));
    CHECK(refusalOf(exchanged, 2, {"l/*", "r/*"}) == "");
    CHECK_THAT(refusalOf(same, 1), Contains("has one camera, and 'sparse' a rig of several"));
    CHECK(refusalOf(same, 1, {"l/*"}) == "");
}

TEST_CASE("Moments of a rig are told by names, once in each camera", "[colmap]")
{
    CHECK(refusalOf(modelOf(NAMES), 2, {"l/*", "r/*"}) == "");
    CHECK_THAT(refusalOf(modelOf({"l/a.png", "r/x.png", "l/b.png", "r/y.png"}), 2, {"l/*", "r/*"}),
               Contains("no two cameras have an image of one moment"));
    ColmapModel twice = modelOf({"l/1.png", "r/1.png", "l/2.png", "l/3.png"});
    addRig(twice, false);
    twice.frames[1].data = {{COLMAP_CAMERA, 1, 3}, {COLMAP_CAMERA, 1, 4}};
    CHECK_THAT(refusalOf(twice, 2), Contains("images 'l/2.png' and 'l/3.png' of camera 1 are of one moment"));
}

TEST_CASE("The place that is known of a view is that of its camera", "[colmap]")
{
    SurveyStart start;
    const Vec3d rvec(0.4, -0.7, 1.1), place(300, -200, 150);
    start.positions[0] = {place, 5.};
    std::vector<Vec3d> rvecs = {rvec}, tvecs = {{}};
    const Matx66d covariance(covariancesOfPoses(start, rvecs, tvecs)[0].ptr<double>());
    const auto centre = [&](Vec3d r, Vec3d t) { return tools::transformOf(r, t).inverse(Vec3d()); };
    CHECK(norm(centre(rvec, tvecs[0]) - place) < 1e-9);
    Matx<double, 3, 6> J;
    const double STEP = 1e-5;
    for (int k = 0; k < 6; k++)
    {
        Vec3d r[2] = {rvec, rvec}, t[2] = {tvecs[0], tvecs[0]};
        for (int side = 0; side < 2; side++)
            (k < 3 ? r[side] : t[side])[k % 3] += side ? STEP : -STEP;
        const Vec3d slope = (centre(r[1], t[1]) - centre(r[0], t[0]))*(0.5/STEP);
        for (int i = 0; i < 3; i++)
            J(i, k) = slope[i];
    }
    const Matx33d ofPlace = J*covariance*J.t();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            CHECK(ofPlace(i, j) == Approx(i == j ? 25. : 0.).margin(0.05));
}

TEST_CASE("What is known of a view's place says nothing of its turn", "[colmap]")
{
    SurveyStart start;
    std::vector<Vec3d> rvecs, tvecs;
    const int views = 6000;
    for (int view = 0; view < views; view++)
    {
        rvecs.push_back({0.1, -0.2, 0.3});
        tvecs.push_back({});
        start.positions[view] = {Vec3d(view - views/2, 0, 0), 0.05};       // less the origin
    }
    double turn = 0;                // about the line, of all views in one
    for (const Mat& covariance : covariancesOfPoses(start, rvecs, tvecs))
        turn += 1/covariance.at<double>(0, 0);
    CHECK(1/std::sqrt(turn) > 0.3);
    CHECK(norm(tvecs[10]) == Approx(2990));
}
