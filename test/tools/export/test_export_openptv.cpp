// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What OpenPTV is told of cameras, read back by the reader that is held against its formula.
#include "console/failure.hpp"
#include "export/export_files.hpp"
#include "formats/foreign_files.hpp"

using namespace tools;
using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Point3d;
using cv::Vec3d;
using cv::refract::GlassWindow;
using cv::refract::RefractiveCamera;

namespace {

Calibration rig(const std::vector<double>& D, const Point2d& centre)
{
    Calibration calibration;
    const Vec3d normals[] = {Vec3d(0.1, -0.05, 1), Vec3d(-0.3, 0.02, 1)};
    for (int c = 0; c < 2; c++)
    {
        GlassWindow window(normalize(normals[c]), 6., 1.46, 300. + 20*c, 1.333);
        CameraCalibration camera;
        camera.camera = RefractiveCamera::create(Matx33d(2005, 0, centre.x, 0, 2000, centre.y, 0, 0, 1), D, window);
        camera.camera->setImageSize(cv::Size(1280, 1024));
        calibration.add(camera, c ? transformOf(Vec3d(0.05, 0.4, -0.02), Vec3d(-250, 12, 40)) : RigidTransform());
    }
    return calibration;
}

std::string failure(const Calibration& calibration)
{
    try
    {
        openPtvFiles(calibration);
        return "written";
    }
    catch (const Failure& e)
    {
        return e.what();
    }
}

} // namespace

TEST_CASE("What OpenPTV is told is what the cameras see", "[export][foreign]")
{
    for (const std::vector<double>& D : {std::vector<double>{}, std::vector<double>{-0.1, 0.05, 1e-3, 0, 0.01}})
    {
        TemporaryFolder f;
        const Calibration calibration = rig(D, D.empty() ? Point2d(650.3, 490.2) : Point2d(639.5, 511.5));
        for (const ExportFile& file : openPtvFiles(calibration))
            saved(f, file.name, file.text);
        const auto read = readForeignRig(f/"cam%d.tif.ori");
        REQUIRE(read);
        REQUIRE(read->cameras.size() == 2);
        std::vector<Point3d> points;
        for (double x = -60; x < 61; x += 30)
            for (double y = -40; y < 41; y += 20)
                points.push_back({x, y, 500 + 0.3*x});
        for (int c = 0; c < 2; c++)
        {
            const RigidTransform place = calibration.extrinsics[c];
            Mat ours, theirs;
            cv::refract::refractiveProjectPoints(points, rotationVector(place.R), place.t, calibration.cameras[c].camera, ours);
            cv::refract::refractiveProjectPoints(points, rotationVector(Matx33d(read->Rs[c])), read->Ts[c], read->cameras[c], theirs);
            CHECK(cv::checkRange(ours));
            CHECK(cv::norm(ours, theirs, cv::NORM_INF) < SAME);
        }
    }
}

TEST_CASE("What OpenPTV has none like is refused by name", "[export][foreign]")
{
    CHECK(failure(rig({}, Point2d(650, 490))) == "written");
    CHECK_THAT(failure(rig({-0.1, 0, 0, 0, 0}, Point2d(650, 490))), Catch::Contains("OpenPTV's is about the middle of the image"));
    CHECK_THAT(failure(rig({-0.1, 0, 0, 1e-4, 0}, Point2d(639.5, 511.5))),
               Catch::Contains("camera1 has a lens that OpenPTV has none like"));
    Calibration calibration = rig({}, Point2d(650, 490));
    const cv::Ptr<RefractiveCamera> second = calibration.cameras[1].camera;
    const GlassWindow pane = second->window();
    calibration.cameras[1].camera = RefractiveCamera::create(Matx33d(2000, 0, 650, 0, 2000, 490, 0, 0, 1), cv::noArray(), pane);
    calibration.cameras[1].camera->setImageSize(second->imageSize());
    CHECK_THAT(failure(calibration), Catch::Contains("camera2 has another fx/fy"));
    calibration.cameras[1].camera = second;
    GlassWindow window = pane;
    window.thickness[0] = 7;
    calibration.cameras[1].camera->setWindow(window);
    CHECK_THAT(failure(calibration), Catch::Contains("camera2 has another pane"));
    window.thickness[0] = 6;
    window.normal = normalize(Vec3d(0, 0.9, 0.1));
    calibration.cameras[1].camera->setWindow(window);
    CHECK_THAT(failure(calibration), Catch::Contains("camera2's window is not before the same water"));
    window.wedge = {cv::Vec2d(1e-4, 0)};
    calibration.cameras[0].camera->setWindow(window);
    CHECK_THAT(failure(calibration), Catch::Contains("with a wedge"));
}
