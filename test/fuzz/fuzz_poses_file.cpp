// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/poses_file.hpp"
#include "file_harness.hpp"
#include <opencv2/calib3d.hpp>

// Known poses, for refract_calib --poses.

const char fuzz::EXTENSION[] = ".csv";

void fuzz::tryFile(const std::string& path)
{
    tools::RigData data;
    data.views.resize(1);
    data.views[0].stem = "a";
    tools::readPoses(path, "mm", data);
    promise(bool(data.views[0].pose), "the view has a pose");
    const tools::KnownPose& pose = *data.views[0].pose;
    promise(cv::checkRange(cv::Mat(pose.rvec)) && cv::checkRange(cv::Mat(pose.tvec)), "the pose is finite");
    promise(pose.covariance.empty() || cv::checkRange(pose.covariance), "its covariance is finite");
}
