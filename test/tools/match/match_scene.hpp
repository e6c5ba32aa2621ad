// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_MATCH_SCENE_HPP
#define REFRACT_TEST_MATCH_SCENE_HPP

#include "measure/rig_vector.hpp"
#include "assess/check_problem.hpp"
#include "calibrate/parameter_columns.hpp"
#include "match/scene_matches.hpp"
#include "math/dense.hpp"
#include "scenes.hpp"
#include "simulate/render.hpp"

#include <memory>

/* Rendered scenes before two cameras behind tilted panes, and a calibration whose covariance is true: what is known beforehand and what
images of a board tell; the real rig is drawn from it. */
namespace match_scene {

using namespace tools;
using namespace cv::refract;
using cv::Matx33d;
using cv::Point2d;
using cv::Point3d;
using cv::Vec3d;

const cv::Size SIZE(640, 512);
const double DEGREE = CV_PI/180, BOARD_SIGMA = 0.03;
const cv::Vec2d DEPTH(450, 1150);

//! @param detail pixels of the sensor for one of 640x512
inline Calibration nominalRig(double outerIndex, double detail)
{
    Calibration rig;
    for (int c = 0; c < 2; c++)
    {
        const double f = detail*(780 + 3*c);
        const Matx33d K(f, 0, detail*(322.5 - 5*c) - 0.5, 0, f, detail*(254.5 + 4*c) - 0.5, 0, 0, 1);
        const GlassWindow window(c ? Vec3d(0.12, -0.17, 0.97) : Vec3d(-0.21, 0.06, 0.97), 25, 1.517, 55 + 5*c, outerIndex);
        CameraCalibration camera;
        camera.camera = RefractiveCamera::create(K, std::vector<double>{ -0.2, 0.12, 0, 0, 0 }, window);
        camera.camera->setImageSize(cv::Size(cvRound(detail*SIZE.width), cvRound(detail*SIZE.height)));
        camera.windowGiven = true;
        rig.add(camera, c ? transformOf(Vec3d(0.01, 0.21, -0.01), Vec3d(-160, 1.5, 18)) : RigidTransform());
    }
    rig.unit = "mm";
    rig.sigma = BOARD_SIGMA;
    rig.dof = 2000;
    rig.provenance.volume = CalibratedVolume{ { -200, -150, 500 }, { 200, 150, 1000 } };
    return rig;
}

//! What is known without images: of the windows a data sheet, of all else some per cent.
inline MatrixXd knownBefore(const RigModel& rig)
{
    VectorXd std = VectorXd::Zero(columnCount(rig));
    MatrixXd C = MatrixXd::Zero(std.size(), std.size());
    for (int c = 0; c < 2; c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        std.segment(at.lens, 4).setConstant(5);
        std[at.lens + 4] = std[at.lens + 5] = 0.02;
        std[at.distance] = 2;
        std[at.thickness] = 0.1;
        std[at.index] = 0.001;
        const Vec3d n = rig.cameras[c]->window().normal, u = cv::normalize(n.cross(Vec3d(0, 1, 0))), v = n.cross(u);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                C(at.normal + i, at.normal + j) = std::pow(0.5*DEGREE, 2)*(u[i]*u[j] + v[i]*v[j]);
    }
    // One medium before both.
    if (rig.cameras[0]->window().outerIndex > 1)
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                C(columnsOf(rig, a).outerIndex, columnsOf(rig, b).outerIndex) = std::pow(0.0005, 2);
    std.segment(extrinsicsColumn(rig, 1), 3).setConstant(1*DEGREE);
    std.segment(extrinsicsColumn(rig, 1) + 3, 3).setConstant(5);
    C.diagonal() += std.cwiseAbs2();
    return C;
}

//! With images of a board, without and through the windows.
inline MatrixXd knownAfter(const RigModel& rig, scenes::Random& random)
{
    MatrixXd C = knownBefore(rig);
    std::vector<Point3d> board;
    for (int i = 0; i < 48; i++)
        board.push_back(Point3d(30.*(i % 8 - 3.5), 30.*(i/8 - 2.5), 0));
    for (int view = 0; view < 10; view++)
    {
        const Vec3d rvec(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2));
        const Vec3d tvec(random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(500, 1000));
        std::vector<ImageOfView> images;
        for (int c = 0; c < 2; c++)
            for (const bool glass : { false, true })
            {
                images.push_back(pointsInImage(rig, board, rvec, tvec, c, glass));
                if (images.back().points.empty())
                    images.pop_back();
            }
        const ViewDerivatives view_ = differentiateView(rig, board, rvec, tvec, images);
        C = covarianceWith(C, PoseNullSpace(view_.byPose)(view_.byParameters), BOARD_SIGMA);
    }
    return 0.5*(C + C.transpose());
}

struct Rig
{
    explicit Rig(unsigned salt, double outerIndex = 1., double detail = 1.) : random(salt), calibration(nominalRig(outerIndex, detail))
    {
        const RigModel model = modelOf(calibration);
        const MatrixXd C = knownAfter(model, random);
        calibration.covariance = toMat(C);
        const SymmetricEigen eigen(C);
        VectorXd p = parametersOf(model);
        for (int i = 0; i < p.size(); i++)
            p += (std::sqrt(std::max(0., eigen.values[i]))*random.normal(1)*eigen.vectors.col(i).array()
                  *(C.diagonal().array() > 0).cast<double>()).matrix();         // what is exact stays so to the last digit
        truth = model.clone();
        setParameters(truth, p);
    }

    //! A camera turned about its own centre since.
    void turnCamera(int c, const Vec3d& rvec)
    {
        if (c > 0)
            truth.extrinsics[c] = RigidTransform{ rotationMatrix(rvec), Vec3d() }*truth.extrinsics[c];
        else
            truth.extrinsics[1] = truth.extrinsics[1]*RigidTransform{ rotationMatrix(rvec).t(), Vec3d() };
    }

    scenes::Random random;
    Calibration calibration;
    RigModel truth;
};

//! Spheres and slabs before a wall, all textured.
inline TexturedScene roomOf(scenes::Random& random, int things = 7)
{
    TexturedScene scene;
    scene.texture.size = 64;
    scene.texture.contrast = 0.95;
    scene.texture.octaves = 8;
    scene.seed = (uint64_t)random.uniform(1, 1e9);
    const Vec3d white(0.9, 0.9, 0.9);
    scene.surfaces.push_back(std::make_shared<Plane>(Vec3d(0, 0, 1080), cv::normalize(Vec3d(random.uniform(-0.1, 0.1),
                                                     random.uniform(-0.1, 0.1), -1)), white));
    for (int i = 0; i < things; i++)
    {
        const double z = random.uniform(560, 950);
        const Vec3d at(random.uniform(-0.35, 0.35)*z, random.uniform(-0.28, 0.28)*z, z);
        if (i % 2)
            scene.surfaces.push_back(std::make_shared<Sphere>(at, random.uniform(40, 90), white));
        else
        {
            const Vec3d normal = cv::normalize(Vec3d(random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4), -1));
            const cv::Size2d half(random.uniform(40, 120), random.uniform(40, 120));
            scene.surfaces.push_back(std::make_shared<Plane>(at, normal, Vec3d(1, 0, 0), half, white));
        }
    }
    return scene;
}

inline Viewpoint viewpointOf(const RigModel& rig, int c)
{
    return { rig.cameras[c], rig.extrinsics[c].R, rig.extrinsics[c].t };
}

inline Exposure usualExposure()
{
    Exposure exposure;
    exposure.dark = 15;
    exposure.light = 240;
    exposure.background = 90;
    exposure.blur = 0.6;
    exposure.noise = 1.5;
    exposure.vignetting = 0.2;
    return exposure;
}

inline std::vector<cv::Mat> render(const TexturedScene& scene, const RigModel& rig, const Exposure& exposure, uint64_t seed)
{
    std::vector<cv::Mat> images;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        images.push_back(greyOf(renderScene(scene, viewpointOf(rig, c), exposure, 2*seed + c), BRIGHTNESS));
    return images;
}

//! Where the first surface that a pixel of camera 1 sees is in camera 2; NaN: nowhere.
inline std::vector<Point2d> truePartners(const TexturedScene& scene, const RigModel& rig, const std::vector<Point2d>& pixels)
{
    std::vector<Point3d> points;
    for (const SceneRay& ray : raysOf(pixels, viewpointOf(rig, 0)))
    {
        const SurfaceHit hit = firstSurface(scene, ray);
        points.push_back(hit.surface ? Point3d(ray.at(hit.intersection.s)) : Point3d(NAN, NAN, NAN));
    }
    std::vector<Point2d> partners;
    refractiveProjectPoints(points, rotationVector(rig.extrinsics[1].R), rig.extrinsics[1].t, rig.cameras[1], partners);
    return partners;
}

inline SceneMatcher matcherOf(const Calibration& calibration)
{
    SceneOptions options;
    options.depth = DEPTH;
    return SceneMatcher(calibration, options);
}

} // namespace match_scene

#endif // REFRACT_TEST_MATCH_SCENE_HPP
