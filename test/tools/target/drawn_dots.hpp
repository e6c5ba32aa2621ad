// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DRAWN_DOTS_HPP
#define REFRACT_TEST_DRAWN_DOTS_HPP

#include "scenes.hpp"
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>
#include <vector>

namespace drawn_dots {

//! Rows of dots on three levels as in PTV's tanks: every second one is a dot shorter, so that it is not the same the other way round.
inline std::vector<cv::Point3d> threeLevels()
{
    const double ROWS[][2] = {{-25, 8}, {-15, 0}, {0, -8}, {15, 0}, {25, 8}};
    std::vector<cv::Point3d> dots;
    for (int row = 0; row < 5; row++)
        for (int column = row % 2; column < 15; column++)
            dots.emplace_back(5*column - 40, ROWS[row][0], ROWS[row][1]);
    return dots;
}

//! Bright dots on a dark ground that is not even, and specks; every pixel the mean of 16, with noise.
inline cv::Mat picture(const std::vector<cv::Point3d>& dots, double radius, const cv::Vec3d& rvec, const cv::Vec3d& tvec,
                       const cv::Ptr<cv::refract::RefractiveCamera>& camera, scenes::Random& random)
{
    const int FINE = 4, RIM = 24, SPECKS = 200;
    const cv::Size size = camera->imageSize();
    cv::Mat fine(size*FINE, CV_8U), image;
    for (int y = 0; y < fine.rows; y++)
        fine.row(y) = cv::Scalar(20 + 40.*y/fine.rows);
    for (const cv::Point3d& dot : dots)
    {
        std::vector<cv::Point3d> rim;
        for (int i = 0; i < RIM; i++)
            rim.push_back(dot + radius*cv::Point3d(std::cos(2*CV_PI*i/RIM), std::sin(2*CV_PI*i/RIM), 0));
        std::vector<cv::Point2d> seen;
        cv::refract::refractiveProjectPoints(rim, rvec, tvec, camera, seen);
        std::vector<cv::Point> corners;
        for (const cv::Point2d& p : seen)
            corners.emplace_back(cvRound((p.x + 0.5)*FINE*16 - 8), cvRound((p.y + 0.5)*FINE*16 - 8));
        cv::fillPoly(fine, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(150), cv::LINE_AA, 4);
    }
    cv::resize(fine, image, size, 0, 0, cv::INTER_AREA);
    for (int i = 0; i < SPECKS; i++)
        image.at<uchar>(random.below(size.height), random.below(size.width)) = 255;
    cv::Mat noisy(size, CV_8U);
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
            noisy.at<uchar>(y, x) = cv::saturate_cast<uchar>(image.at<uchar>(y, x) + random.normal(2.));
    return noisy;
}

} // namespace drawn_dots

#endif // REFRACT_TEST_DRAWN_DOTS_HPP
