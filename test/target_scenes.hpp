// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Targets that are not as they are said to be: larger, or moved between the direct and the refracted images.
#ifndef REFRACT_TEST_TARGET_SCENES_HPP
#define REFRACT_TEST_TARGET_SCENES_HPP

#include "rig_scenes.hpp"

namespace scenes {

//! What a scene's targets have in common.
struct TargetTruth
{
    double scale = 0;       //!< they are larger by this part than the object points say
    cv::Vec3d rvec, translation;
};

//! About where the targets of makeRigScene are.
const cv::Vec3d TARGETS(0, 0, 610);

//! Deviations: of the scale, of a rotation about TARGETS in radians, of a translation in millimetres.
inline cv::Mat targetCovariance(double scale, double rotation, double translation)
{
    const cv::Matx33d cross(0, -TARGETS[2], TARGETS[1], TARGETS[2], 0, -TARGETS[0], -TARGETS[1], TARGETS[0], 0);
    const double variance = rotation*rotation;
    cv::Mat covariance = cv::Mat::zeros(7, 7, CV_64F);
    covariance.at<double>(0, 0) = scale*scale;
    cv::Mat(variance*cv::Matx33d::eye()).copyTo(covariance(cv::Rect(1, 1, 3, 3)));
    cv::Mat(variance*cross).copyTo(covariance(cv::Rect(1, 4, 3, 3)));
    cv::Mat(variance*cross.t()).copyTo(covariance(cv::Rect(4, 1, 3, 3)));
    cv::Mat(translation*translation*cv::Matx33d::eye() + variance*cross*cross.t()).copyTo(covariance(cv::Rect(4, 4, 3, 3)));
    return covariance;
}

inline TargetTruth drawTargets(Random& random, double scale, double rotation, double translation)
{
    TargetTruth targets;
    targets.scale = random.normal(scale);
    for (int i = 0; i < 3; i++)
    {
        targets.rvec[i] = random.normal(rotation);
        targets.translation[i] = random.normal(translation);
    }
    return targets;
}

//! The images of a scene's views with such targets.
inline void imageTargets(const RigTruth& rig, const TargetTruth& targets, Random& random, double sigma, RigScene& scene)
{
    cv::Matx33d motion;
    cv::Rodrigues(targets.rvec, motion);
    for (size_t view = 0; view < scene.object.size(); view++)
    {
        std::vector<cv::Point3d> object;
        for (const cv::Point3d& p : scene.object[view])
            object.push_back(p*(1 + targets.scale));
        for (size_t c = 0; c < rig.cameras.size(); c++)
            for (bool refracted : { false, true })
            {
                cv::Matx33d R;
                cv::Rodrigues(scene.rvecs[view], R);
                cv::Vec3d t = scene.tvecs[view];
                if (refracted)
                {
                    R = motion*R;
                    t = TARGETS + motion*(t - TARGETS) + targets.translation;
                }
                cv::Vec3d rvec;
                cv::Rodrigues(rig.Rs[c]*R, rvec);
                const cv::Ptr<RefractiveCamera> camera = refracted ? rig.cameras[c]
                    : RefractiveCamera::create(rig.cameras[c]->cameraMatrix(), rig.cameras[c]->distCoeffs());
                (refracted ? scene.refracted : scene.direct)[c][view] = seen(object, rvec, rig.Rs[c]*t + rig.Ts[c], camera, random,
                                                                             sigma);
            }
    }
}

} // namespace scenes

#endif // REFRACT_TEST_TARGET_SCENES_HPP
