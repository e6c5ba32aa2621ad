// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Calibrated rigs and what they see some time later.
#ifndef REFRACT_TEST_TOOLS_CHECK_SCENES_HPP
#define REFRACT_TEST_TOOLS_CHECK_SCENES_HPP

#include "measure/rig_vector.hpp"
#include "assess/check_problem.hpp"
#include "assess/rig_check.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/units.hpp"
#include "measure/view_observations.hpp"
#include "normal_draw.hpp"
#include "paper_rig.hpp"
#include "simulate/render.hpp"
#include <functional>

namespace check_scenes {

using namespace cv;
using namespace cv::refract;
using namespace tools;

const double SIGMA = 0.05;                  // px
const int CALIBRATION_VIEWS = 20, CALIBRATION_PAIRS = 8, NEW_VIEWS = 4;

inline std::vector<Point3d> checkBoard() { return board(9, 6, 25.); }

struct Scene
{
    std::string name;
    RigModel nominal;
    bool hasPairs;                          // the new images; else through the window only
    MatrixXd prior;                         // covariance of what differs from the nominal rig
};

inline GlassWindow flatSeenFrom(const GlassWindow& window, const RigidTransform& camera_from_owner)
{
    GlassWindow seen = window;
    seen.normal = normalize(camera_from_owner.R*window.normal);
    seen.distance = window.distance - window.normal.dot(camera_from_owner.inverse(Vec3d()));
    return seen;
}

//! A rig with wedges and targets as its parameters.
inline RigModel complete(RigModel rig, bool shared, double outerIndex)
{
    for (size_t c = 0; c < rig.cameras.size(); c++)
    {
        GlassWindow window = rig.cameras[c]->window();
        window.outerIndex = outerIndex;
        if (shared && c == 0)
        {
            window.normal = normalize(Vec3d(0.05, -0.08, 1.));
            window.distance = 150.;
        }
        if (shared && c > 0)
            window = flatSeenFrom(rig.cameras[0]->window(), rig.extrinsics[c]);
        window.wedge.assign(1, Vec2d());
        rig.cameras[c]->setWindow(window);
        if (shared)
            rig.windows.push_back(0);
    }
    rig.targetCovariance = Mat::zeros(TARGET_ERRORS, TARGET_ERRORS, CV_64F);
    return rig;
}

inline MatrixXd priorOf(const RigModel& rig)
{
    MatrixXd C = MatrixXd::Zero(columnCount(rig) + TARGET_ERRORS, columnCount(rig) + TARGET_ERRORS);
    const auto set = [&](int first, int count, double std) { C.diagonal().segment(first, count).setConstant(std*std); };
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        const GlassWindow window = rig.cameras[c]->window();
        set(at.lens, 4, 20.);
        set(at.lens + 4, at.lensCount - 4, 0.05);
        const Eigen::Vector3d n(window.normal.val);
        C.block(at.normal, at.normal, 3, 3) = std::pow(0.2, 2)*(Eigen::Matrix3d::Identity() - n*n.transpose());
        const bool shared = !rig.windows.empty();
        if (window.outerIndex != window.innerIndex)
            set(at.distance, 1, 1.);
        if (!shared)
        {
            set(at.thickness, 1, 0.1);
            set(at.index, 1, 0.001);
            set(at.wedge, 2, ARC_MINUTE);
        }
        if (window.outerIndex != window.innerIndex)
            set(at.outerIndex, 1, 0.0005);
        if (c > 0)
        {
            set(extrinsicsColumn(rig, c), 3, 0.05);
            set(extrinsicsColumn(rig, c) + 3, 3, 10.);
        }
    }
    return C;
}

inline BoardPose poseOfBoard(scenes::Random& random)
{
    const double z = random.uniform(520, 760);
    return {random.vector(0.45), Vec3d(random.uniform(-0.1, 0.1)*z, random.uniform(-0.08, 0.08)*z, z)};
}

//! What lies outside of an image is not seen.
inline View look(const RigModel& rig, const BoardPose& pose, bool direct, bool glass, double sigma, scenes::Random& random)
{
    View view = observe(rig, checkBoard(), pose.rvec, pose.tvec, direct, sigma, random);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        for (std::vector<Point2d>* pixels : {&view.direct[c], &view.glass[c]})
        {
            for (Point2d& p : *pixels)
                if (!Rect2d(0, 0, 1279, 1023).contains(p))
                    p = Point2d(NAN, NAN);
            if (std::count_if(pixels->begin(), pixels->end(), seen) < 20 || (!glass && pixels == &view.glass[c]))
                pixels->clear();
        }
    return view;
}

inline Scene makeScene(const std::string& name, int cameras, bool shared, double outerIndex)
{
    Scene scene{name, complete(paperRig(cameras), shared, outerIndex), outerIndex == 1., {}};
    scene.prior = priorOf(scene.nominal);
    return scene;
}

inline std::vector<Scene> allScenes()
{
    return {makeScene("one camera, air, pairs", 1, false, 1.), makeScene("stereo, air, pairs", 2, false, 1.),
            makeScene("stereo, water", 2, false, 1.333), makeScene("three cameras, one window, air, pairs", 3, true, 1.)};
}

inline std::vector<View> calibrationViews(const Scene& scene, const RigModel& truth, scenes::Random& random)
{
    std::vector<View> views;
    for (int i = 0; i < CALIBRATION_VIEWS; i++)
    {
        views.push_back(look(truth, poseOfBoard(random), true, scene.hasPairs && i < CALIBRATION_PAIRS, SIGMA, random));
        if (!scene.hasPairs)
            views.push_back(look(truth, poseOfBoard(random), false, true, SIGMA, random));
    }
    return views;
}

//! A rig as it is, and as it was calibrated: the most probable one of the priors and the images, and its covariance there.
struct Calibrated
{
    RigModel truth;
    CheckInput input;
    MatrixXd covariance;                    // of the input, and of the targets' errors
};

//! @param asIs makes the rig another one than was given
inline Calibrated calibrated(const Scene& scene, scenes::Random& random, const std::function<void(RigModel&)>& asIs = [](RigModel&) {})
{
    Calibrated c;
    c.truth = scene.nominal.clone();
    // Given values differ from piece to piece; what is estimated from the images alone is as the nominal rig's.
    MatrixXd given = MatrixXd::Zero(scene.prior.rows(), scene.prior.cols());
    for (int k = 0; k < (int)c.truth.cameras.size(); k++)
    {
        const ParameterColumns at = columnsOf(c.truth, k);
        for (int i = at.distance; i < at.end; i++)
            given(i, i) = scene.prior(i, i);
    }
    setParameters(c.truth, parametersOf(scene.nominal) + scenes::drawn(scenes::rootOf(given), random));
    asIs(c.truth);
    const CheckProblem problem({scene.nominal, toMat(scene.prior), SIGMA, 1e8}, calibrationViews(scene, c.truth, random), SIGMA);
    const CheckFit fit = problem.fitUnchanged();
    REQUIRE(std::isfinite(fit.chiSquare));
    MatrixXd C = scene.prior;
    for (const ViewObservations& observed : fit.views)
    {
        const ViewDerivatives d = differentiateView(fit.rig, observed.objectPoints, observed.rvec, observed.tvec, observed.images);
        C = covarianceWith(C, PoseNullSpace(d.byPose)(d.byParameters), SIGMA);
        C = 0.5*(C + C.transpose()).eval();
    }
    const double scale = fit.chiSquare/problem.observations();
    const int count = columnCount(c.truth);
    c.input.rig = fit.rig.clone();
    c.input.rig.targetCovariance.release();
    c.covariance = C*scale;
    c.input.covariance = toMat(MatrixXd(C.topLeftCorner(count, count)*scale));
    c.input.sigma = SIGMA*std::sqrt(scale);
    c.input.dof = problem.observations();
    return c;
}

inline std::vector<View> newViews(const Scene& scene, const RigModel& now, scenes::Random& random, double sigma = SIGMA)
{
    std::vector<View> views;
    const int cameras = (int)now.cameras.size();
    for (int attempt = 0; attempt < 50*NEW_VIEWS && (int)views.size() < NEW_VIEWS; attempt++)
    {
        const View view = look(now, poseOfBoard(random), scene.hasPairs, true, sigma, random);
        if (view.countGlass() == cameras || (cameras > 2 && view.countGlass() == 2))
            views.push_back(view);
    }
    REQUIRE((int)views.size() == NEW_VIEWS);
    return views;
}

} // namespace check_scenes

#endif // REFRACT_TEST_TOOLS_CHECK_SCENES_HPP
