// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A joint problem at the truth of a scene, with the module's inner types.
#ifndef REFRACT_TEST_PROBLEM_SCENES_HPP
#define REFRACT_TEST_PROBLEM_SCENES_HPP

#include "bundle_scenes.hpp"
#include "rig_scenes.hpp"
#include "adjust/covariance.hpp"
#include "calibrate/failure.hpp"

namespace scenes {

inline cv::refract::Pose poseOf(const cv::Vec3d& rvec, const cv::Vec3d& tvec)
{
    cv::refract::Pose pose;
    pose.rvec = rvec;
    pose.tvec = tvec;
    pose.found = true;
    return pose;
}

//! @param paired with the direct images too
inline std::unique_ptr<cv::refract::Problem> problemAt(const RigTruth& truth, const RigScene& scene, bool paired, int flags,
                                                       const Eigen::MatrixXd& targetCovariance = Eigen::MatrixXd())
{
    using namespace cv::refract;
    Rig rig;
    RigViews views;
    views.object = scene.object;
    for (size_t c = 0; c < truth.cameras.size(); c++)
    {
        cv::Vec3d rvec;
        cv::Rodrigues(truth.Rs[c], rvec);
        rig.cameras.push_back(static_cast<const Camera&>(*truth.cameras[c]));
        rig.owner.push_back((int)(std::find(truth.windows.begin(), truth.windows.end(), truth.windows[c]) - truth.windows.begin()));
        rig.extrinsics.push_back(poseOf(rvec, truth.Ts[c]));
        views.cameras.push_back({ paired ? scene.direct[c] : PixelViews(scene.object.size()), scene.refracted[c] });
    }
    std::vector<Pose> poses;
    for (size_t view = 0; view < scene.object.size(); view++)
        poses.push_back(poseOf(scene.rvecs[view], scene.tvecs[view]));
    return std::unique_ptr<Problem>(new Problem(rig, views, poses, {}, {}, flags, targetCovariance));
}

//! The joint problem of a scene at the truth.
inline std::unique_ptr<cv::refract::Problem> bundleAt(const RigTruth& truth, const BundleScene& scene, double sigma, int flags)
{
    using namespace cv::refract;
    Rig rig;
    std::vector<Pose> poses;
    for (size_t c = 0; c < truth.cameras.size(); c++)
    {
        cv::Vec3d rvec;
        cv::Rodrigues(truth.Rs[c], rvec);
        rig.cameras.push_back(static_cast<const Camera&>(*truth.cameras[c]));
        rig.owner.push_back((int)c);
        rig.extrinsics.push_back(poseOf(rvec, truth.Ts[c]));
    }
    for (size_t view = 0; view < scene.rvecs.size(); view++)
        poses.push_back(poseOf(scene.rvecs[view], scene.tvecs[view]));
    std::vector<PosePrior> priors(poses.size());
    priors[0].kind = PosePrior::EXACT;
    std::vector<KnownLength> knownLengths;
    for (const cv::Vec4d& l : scene.lengths)
        knownLengths.push_back({ (int)l[0], (int)l[1], l[2], l[3] });
    std::unique_ptr<Problem> bundle(new Problem(rig, sceneImages(scene.pixels), (int)scene.points.size(), knownLengths, poses, priors,
                                                flags));
    bundle->setPixelSigma(sigma);
    bundle->setPoints(scene.points, {});
    return bundle;
}

//! Of the public parameters; throws what a calibration does.
inline Eigen::MatrixXd covarianceOf(const cv::refract::Problem& problem, double variance, int required = cv::refract::REQUIRE_ALL)
{
    cv::refract::Covariance covariance;
    cv::refract::throwUnlessConverged(covariance.compute(problem, variance, required), cv::refract::FitKind::CALIBRATION);
    return covariance.ofParameters;
}

} // namespace scenes

#endif // REFRACT_TEST_PROBLEM_SCENES_HPP
