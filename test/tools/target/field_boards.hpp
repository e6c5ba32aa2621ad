// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Pictures of boards that are turned and seen at an angle, with noise.
#ifndef REFRACT_TEST_TOOLS_FIELD_BOARDS_HPP
#define REFRACT_TEST_TOOLS_FIELD_BOARDS_HPP

#include "target/target.hpp"
#include "target/target_search.hpp"
#include "scenes.hpp"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <filesystem>

namespace field_boards {

const cv::Size IMAGE(960, 720);

inline tools::TargetOptions board(const std::string& pattern, const std::string& size)
{
    tools::TargetOptions options;
    options.pattern = pattern;
    options.size = size;
    options.square = 30;
    return options;
}

//! Board coordinates, in squares from the first point, to pixels: turned, and seen at an angle.
inline cv::Matx33d boardToImage(double square, double degrees, double tilt, cv::Point2d middle)
{
    const double a = degrees*CV_PI/180, c = std::cos(a)*square, s = std::sin(a)*square;
    const cv::Matx33d turned(c, -s, 480 - c*middle.x + s*middle.y, s, c, 360 - s*middle.x - c*middle.y, 0, 0, 1);
    return cv::Matx33d(1, 0, 0, 0, 1, 0, tilt, -0.5*tilt, 1 - 300*tilt)*turned;
}

inline cv::Point2d through(const cv::Matx33d& H, const cv::Point2d& p)
{
    const cv::Vec3d h = H*cv::Vec3d(p.x, p.y, 1);
    return cv::Point2d(h[0]/h[2], h[1]/h[2]);
}

/** @param toBoard the place of the board that a pixel shows
@param isDark at a place of the board */
template <typename ToBoard, typename Dark>
cv::Mat pictureThrough(const ToBoard& toBoard, const Dark& isDark)
{
    const int FINE = 4;
    scenes::Random random(4501);
    cv::Mat image(IMAGE, CV_32F);
    for (int y = 0; y < image.rows; y++)
        for (int x = 0; x < image.cols; x++)
        {
            int dark = 0;
            for (int k = 0; k < FINE*FINE; k++)
                dark += isDark(toBoard(cv::Point2d(x + (k % FINE + 0.5)/FINE - 0.5, y + (k/FINE + 0.5)/FINE - 0.5)));
            image.at<float>(y, x) = (float)(200 - 170.*dark/(FINE*FINE) + random.normal(1.));
        }
    cv::GaussianBlur(image, image, cv::Size(), 0.7);
    image.convertTo(image, CV_8U);
    return image;
}

template <typename Dark>
cv::Mat picture(const cv::Matx33d& H, const Dark& isDark)
{
    const cv::Matx33d back = H.inv();
    return pictureThrough([&](const cv::Point2d& p) { return through(back, p); }, isDark);
}

inline std::string explained(const cv::Mat& image, const tools::TargetOptions& options)
{
    const std::string path = (std::filesystem::temp_directory_path()/"refract_field_board.png").string();
    cv::imwrite(path, image);
    const std::string text = tools::explainMissing({{path, cv::Size()}}, "'" + path + "'", 1, tools::Target(options), tools::BRIGHTNESS);
    std::filesystem::remove(path);
    return text;
}

} // namespace field_boards

#endif // REFRACT_TEST_TOOLS_FIELD_BOARDS_HPP
