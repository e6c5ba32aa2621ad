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

//! Deviations: of the scale, radians, millimetres.
inline cv::Mat targetCovariance(double scale, double rotation, double translation)
{
    cv::Mat covariance = cv::Mat::zeros(7, 7, CV_64F);
    for (int i = 0; i < 7; i++)
        covariance.at<double>(i, i) = std::pow(i == 0 ? scale : i < 4 ? rotation : translation, 2);
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
    const cv::Vec3d center(0, 0, 610);
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
                    t = center + motion*(t - center) + targets.translation;
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
