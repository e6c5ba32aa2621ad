// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "test_scene.hpp"

namespace opencv_test { namespace {

using namespace scene;

TEST(Refract_GlassWindow, may_be_a_dome)
{
    const GlassWindow dome = GlassWindow::dome(Vec3d(3, -2, 12), 50, 7, 1.5, 1.33);
    EXPECT_EQ((int)WINDOW_DOME, dome.shape);
    EXPECT_REFUSED(GlassWindow::dome(Vec3d(0, 0, 60), 50, 7, 1.5), "the camera must be inside the dome");
    const Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const std::vector<Point3d> X = { Point3d(100, -50, 700), Point3d(-20, 80, 300) };
    std::vector<Point2d> pixels;
    std::vector<Point3d> origins, directions;
    refractiveProjectPoints(X, Vec3d(), Vec3d(), K, noArray(), dome, pixels);
    refractiveUnprojectPoints(pixels, origins, directions, K, noArray(), dome);
    for (size_t i = 0; i < X.size(); i++)
        EXPECT_NEAR(0, cv::norm((X[i] - origins[i]).cross(directions[i])), 1e-10);
}

TEST(Refract_GlassWindow, is_checked)
{
    EXPECT_NO_THROW(GlassWindow().check());
    EXPECT_NEAR(1, cv::norm(GlassWindow(Vec3d(1, 2, 3), 10, 1.5).normal), 1e-15);
    EXPECT_REFUSED(GlassWindow(Vec3d(), 10, 1.5), "normal is (0, 0, 0)");
    EXPECT_REFUSED(GlassWindow(Vec3d(0, 0, 1), -2, 1.5), "thickness");
    EXPECT_REFUSED(GlassWindow(Vec3d(0, 0, 1), 10, 0.5), "index");
    GlassWindow window = window1();
    window.outerIndex = NaN;
    EXPECT_REFUSED(window.check(), "outerIndex");
    EXPECT_REFUSED(RefractiveCamera::create(K1(), D1(), window), "outerIndex");
}

TEST(Refract_GlassWindow, is_written_and_read)
{
    GlassWindow window = window1(), copy;
    window.thickness.push_back(0.76);       // laminated, into water
    window.index.push_back(1.48);
    window.outerIndex = 1.333;
    FileStorage fs("window.yml", FileStorage::WRITE | FileStorage::MEMORY);
    fs << "window" << window;
    FileStorage in(fs.releaseAndGetString(), FileStorage::READ | FileStorage::MEMORY);
    in["window"] >> copy;
    EXPECT_NEAR(0, cv::norm(copy.normal - window.normal), 1e-15);
    EXPECT_EQ(window.distance, copy.distance);
    EXPECT_EQ(window.thickness, copy.thickness);
    EXPECT_EQ(window.index, copy.index);
    EXPECT_EQ(window.outerIndex, copy.outerIndex);
}

TEST(Refract_RefractiveIndex, is_the_catalogues)
{
    EXPECT_NEAR(1.51680, refractiveIndex("N-BK7", 587.5618), 1e-5);     // Schott's data sheet, helium's yellow line
    EXPECT_EQ(refractiveIndex("water:T=20", 550), refractiveIndex("water", 550));
    EXPECT_EQ(0.0005, refractiveIndexTolerance("N-BK7"));
    EXPECT_REFUSED(refractiveIndex("N-BK8", 550), "N-BK7");
}

TEST(Refract_Camera, keeps_what_it_was_made_of)
{
    const Ptr<RefractiveCamera> camera = camera2();
    EXPECT_EQ("opencv", camera->lensModel());
    EXPECT_EQ(0, cvtest::norm(camera->cameraMatrix(), Mat(K2()), NORM_INF));
    EXPECT_EQ(0, cvtest::norm(camera->distCoeffs(), D2(), NORM_INF));
    EXPECT_EQ(Size(1, 9), camera->lensParameters().size());
    EXPECT_EQ(Size(), camera->imageSize());
    camera->setImageSize(Size(1280, 1024));
    EXPECT_EQ(Size(1280, 1024), camera->imageSize());
}

TEST(Refract_Camera, changes_what_is_projected)
{
    const Ptr<RefractiveCamera> camera = RefractiveCamera::create(K1(), D1());
    camera->setWindow(window1());
    EXPECT_EQ(project(scenePoints(), camera1()), project(scenePoints(), camera));

    Mat parameters = camera->lensParameters();
    parameters.at<double>(2) += 5;          // cx
    camera->setLensParameters(parameters);
    EXPECT_NEAR(5, project(scenePoints(), camera)[0].x - project(scenePoints(), camera1())[0].x, 1e-9);
    EXPECT_REFUSED(camera->setLensParameters(std::vector<double>(3, 1.)), "parameters has 3 values");
}

TEST(Refract_Camera, fisheye_and_mrcal)
{
    const Ptr<RefractiveCamera> fisheye = RefractiveCamera::createFisheye(K1(), noArray(), window1());
    EXPECT_EQ("fisheye", fisheye->lensModel());
    const std::vector<double> intrinsics = { K1()(0, 0), K1()(1, 1), K1()(0, 2), K1()(1, 2), -0.4082, 0.4359, 0, 0 };
    const Ptr<RefractiveCamera> mrcal = RefractiveCamera::createMrcal("LENSMODEL_OPENCV4", intrinsics, window1());
    EXPECT_EQ("LENSMODEL_OPENCV4", mrcal->lensModel());
    EXPECT_EQ(project(scenePoints(), camera1()), project(scenePoints(), mrcal));
    EXPECT_REFUSED(RefractiveCamera::createMrcal("LENSMODEL_NONE", intrinsics), "LENSMODEL_NONE");
    EXPECT_REFUSED(RefractiveCamera::create(K1(), std::vector<double>(3)), "distCoeffs has 3 values");
}

TEST(Refract_Camera, by_name)
{
    const std::vector<String> names = RefractiveCamera::lensModels();
    EXPECT_EQ(1, std::count(names.begin(), names.end(), "fisheye"));
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createByName("opencv", K1(), D1(), window1());
    EXPECT_EQ("opencv", camera->lensModel());
    EXPECT_EQ(project(scenePoints(), camera1()), project(scenePoints(), camera));
    EXPECT_REFUSED(RefractiveCamera::createByName("none", K1(), D1()), "lensModel is none; known are opencv");
    EXPECT_REFUSED(RefractiveCamera::createByName("LENSMODEL_CAHVOR", K1(), D1()), "distCoeffs has 4 values");
}

// A pixel moves by its weight times what a control point moves, times the focal length.
TEST(Refract_SplineWeights, are_the_derivatives)
{
    const String model = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=2_Nx=9_Ny=8_fov_x_deg=110";
    std::vector<double> intrinsics(4 + 2*9*8);
    intrinsics[0] = intrinsics[1] = 600;
    intrinsics[2] = 320;
    intrinsics[3] = 240;
    for (size_t i = 4; i < intrinsics.size(); i++)
        intrinsics[i] = 0.001*(i % 5);
    const Ptr<RefractiveCamera> camera = RefractiveCamera::createMrcal(model, intrinsics, window1());
    Mat controls, weights, status;
    refractiveSplineWeights(scenePoints(), Vec3d(), Vec3d(), camera, controls, weights, status);
    ASSERT_EQ(Size(9, 30), controls.size());
    ASSERT_EQ(Size(9, 30), weights.size());
    EXPECT_EQ(0, cv::countNonZero(status));
    const std::vector<Point2d> before = project(scenePoints(), camera);
    for (int i = 0; i < 30; i += 10)
    {
        double sum = 0;
        for (int k = 0; k < 9; k++)
        {
            const int control = controls.at<int>(i, k);
            std::vector<double> moved = intrinsics;
            moved[4 + 2*control] += 1e-4;
            const std::vector<Point2d> after = project(scenePoints(), RefractiveCamera::createMrcal(model, moved, window1()));
            EXPECT_NEAR(600*weights.at<double>(i, k), (after[i].x - before[i].x)/1e-4, 1e-4);
            sum += weights.at<double>(i, k);
        }
        EXPECT_NEAR(1, sum, 1e-12);
    }
    EXPECT_REFUSED(refractiveSplineWeights(scenePoints(), Vec3d(), Vec3d(), camera1(), controls, weights), "has no control points");
}

TEST(Refract_Camera, is_written_and_read)
{
    const String filename = cv::tempfile(".yml");
    {
        FileStorage fs(filename, FileStorage::WRITE);
        camera2()->write(fs);
    }
    const Ptr<RefractiveCamera> camera = RefractiveCamera::read(filename);
    remove(filename.c_str());
    EXPECT_EQ(0, cvtest::norm(camera->lensParameters(), camera2()->lensParameters(), NORM_INF));
    EXPECT_EQ(window2().index, camera->window().index);
    EXPECT_REFUSED(RefractiveCamera::read(filename), filename);
}

}} // namespace
