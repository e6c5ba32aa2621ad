// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DRAWN_BOARD_HPP
#define REFRACT_TEST_DRAWN_BOARD_HPP

#include "target/target.hpp"
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <string>
#include <vector>

//! A chessboard on grey ground, turned in its plane; every pixel the mean of 16.
struct DrawnBoard
{
    cv::Size size;                          //!< inner corners
    cv::Mat image;
    std::vector<cv::Point2d> corners;

    DrawnBoard(cv::Size boardSize, double square, double degrees, cv::Size imageSize = cv::Size(640, 512))
        : size(boardSize), image(imageSize, CV_8U)
    {
        const int FINE = 4;
        const double angle = degrees*CV_PI/180, c = std::cos(angle), s = std::sin(angle);
        const cv::Point2d centre(0.5*imageSize.width, 0.5*imageSize.height);
        cv::Mat fine(imageSize*FINE, CV_8U);
        for (int y = 0; y < fine.rows; y++)
            for (int x = 0; x < fine.cols; x++)
            {
                const cv::Point2d p = cv::Point2d((x + 0.5)/FINE - 0.5, (y + 0.5)/FINE - 0.5) - centre;
                const double u = (c*p.x + s*p.y)/square + 0.5*(size.width + 1), v = (c*p.y - s*p.x)/square + 0.5*(size.height + 1);
                const bool inside = u >= 0 && v >= 0 && u < size.width + 1 && v < size.height + 1;
                const bool dark = ((int)std::floor(u) + (int)std::floor(v)) % 2 == 0;
                fine.at<uchar>(y, x) = !inside ? 200 : dark ? 30 : 200;
            }
        cv::resize(fine, image, imageSize, 0, 0, cv::INTER_AREA);
        for (int row = 0; row < size.height; row++)
            for (int column = 0; column < size.width; column++)
            {
                const double u = (column - 0.5*(size.width - 1))*square, v = (row - 0.5*(size.height - 1))*square;
                corners.emplace_back(centre + cv::Point2d(c*u - s*v, s*u + c*v));
            }
    }

    tools::Target target() const
    {
        tools::TargetOptions options;
        options.size = std::to_string(size.width) + "x" + std::to_string(size.height);
        options.square = 30;
        return tools::Target(options);
    }
};

#endif // REFRACT_TEST_DRAWN_BOARD_HPP
