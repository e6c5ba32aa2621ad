// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Targets in survey coordinates, and their poses beside those of targets with the origin among their points.
#ifndef REFRACT_TEST_FAR_ORIGINS_HPP
#define REFRACT_TEST_FAR_ORIGINS_HPP

#include "rig_scenes.hpp"
#include <opencv2/calib3d.hpp>

namespace scenes {

const double OFFSETS[] = { 1e4, 1e6, 1e7, 5.5e9 };         // mm: ten metres to national grids
const double ROUNDING = 1e-15;      // of the offset: what coordinates so large cannot say

inline cv::Vec3d originAt(double offset) { return cv::Vec3d(0.09*offset, -offset, 2e-5*offset); }

inline std::vector<cv::Point3d> movedBy(std::vector<cv::Point3d> points, const cv::Vec3d& offset)
{
    for (cv::Point3d& p : points)
        p += cv::Point3d(offset);
    return points;
}

inline cv::Matx33d matrixOf(const cv::Mat& rvec)
{
    cv::Mat R;
    cv::Rodrigues(rvec, R);
    return R;
}

//! How far the pose of the moved points is from that of the others, of their distance and in radians.
inline double poseDifference(const cv::Mat& rvec, const cv::Mat& tvec, const cv::Vec3d& offset, const cv::Mat& nearRvec,
                             const cv::Mat& nearTvec)
{
    const cv::Matx33d R = matrixOf(rvec);
    return cv::norm(R - matrixOf(nearRvec)) + cv::norm(cv::Vec3d(tvec) + R*offset - cv::Vec3d(nearTvec))/cv::norm(nearTvec);
}

} // namespace scenes

#endif // REFRACT_TEST_FAR_ORIGINS_HPP
