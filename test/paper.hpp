// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The rig of the paper (Plate2024, Table 3): two cameras, each behind a tilted pane 20 mm thick.
#ifndef REFRACT_TEST_PAPER_HPP
#define REFRACT_TEST_PAPER_HPP

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <vector>

namespace paper {

const cv::Matx33d K1(2438.07, 0, 643.98, 0, 2438.08, 500.01, 0, 0, 1), K2(2443.13, 0, 647.83, 0, 2443.13, 487.49, 0, 0, 1);
const std::vector<double> D1 = { -0.4082, 0.4359, 0, 0 }, D2 = { -0.4100, 0.4389, 0, 0 };
const cv::Vec3d NORMAL1(-0.2483, 0.0961, 1), NORMAL2(0.1823, -0.2809, 1);
const cv::Vec3d T(-211.4756, 1.3306, 53.3775);          //!< left to right
const double THICKNESS = 20, INDEX = 1.5437;

//! The pane before the left camera, or the same with another normal; the paper says no distance.
inline cv::refract::GlassWindow pane(double distance = 50, const cv::Vec3d& normal = NORMAL1, double outerIndex = 1)
{
    return cv::refract::GlassWindow(normal, THICKNESS, INDEX, distance, outerIndex);
}

//! Left to right; what is printed maps right to left, and is a rotation to four digits.
inline cv::Matx33d rotation()
{
    const cv::Matx33d printed(0.9572, 0.0008, -0.2893, -0.0087, 0.9996, -0.0262, 0.2892, 0.0275, 0.9569);
    cv::Vec3d rvec;
    cv::Rodrigues(printed.t(), rvec);
    cv::Matx33d R;
    cv::Rodrigues(rvec, R);
    return R;
}

} // namespace paper

#endif // REFRACT_TEST_PAPER_HPP
