// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A program outside the project: sees a point through a tilted pane, and finds its ray again.
#include <opencv2/refract.hpp>
#include <cstdio>

int main()
{
    const cv::Matx33d K(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
    const cv::refract::GlassWindow window(cv::Vec3d(0.2, 0, 1), 20, 1.5);
    const std::vector<cv::Point3d> point(1, cv::Point3d(50, 30, 600));
    std::vector<cv::Point2d> pixel, ideal;
    cv::refract::refractiveProjectPoints(point, cv::Vec3d(), cv::Vec3d(), K, cv::noArray(), window, pixel);
    cv::refract::refractiveUndistortPoints(pixel, ideal, K, cv::noArray(), window, std::vector<double>(1, 600.),
                                           cv::noArray(), K);
    std::printf("seen at (%.3f, %.3f), without window at (%.3f, %.3f)\n", pixel[0].x, pixel[0].y, ideal[0].x, ideal[0].y);
    const double error = std::abs(ideal[0].x - (640 + 1000*50/600.)) + std::abs(ideal[0].y - (480 + 1000*30/600.));
    return error < 1e-9 ? 0 : 1;
}
