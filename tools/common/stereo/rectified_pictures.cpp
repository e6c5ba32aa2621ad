// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/rectified_pictures.hpp"
#include "console/file_output.hpp"
#include "report/drawing.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>

namespace tools {

namespace {

cv::Mat inColour(const cv::Mat& image)
{
    cv::Mat colour = image;
    if (image.channels() == 1)
        cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
    return colour;
}

} // namespace

cv::Mat sideBySide(const cv::Mat& rectified1, const cv::Mat& rectified2, bool vertical)
{
    const int LINES = 16, GAP = 8;
    const cv::Mat first = inColour(rectified1), second = inColour(rectified2);
    cv::Mat picture;
    if (vertical)
    {
        const cv::Mat gap(GAP, first.cols, CV_8UC3, cv::Scalar::all(255));
        cv::vconcat(std::vector<cv::Mat>{first, gap, second}, picture);
    }
    else
    {
        const cv::Mat gap(first.rows, GAP, CV_8UC3, cv::Scalar::all(255));
        cv::hconcat(std::vector<cv::Mat>{first, gap, second}, picture);
    }
    const int across = vertical ? picture.cols : picture.rows, along = vertical ? picture.rows : picture.cols;
    for (int i = 0; i < LINES; i++)
    {
        const double at = (i + 0.5)*across/LINES;
        const cv::Point2d from = vertical ? cv::Point2d(at, 0) : cv::Point2d(0, at);
        const cv::Point2d to = vertical ? cv::Point2d(at, along - 1) : cv::Point2d(along - 1, at);
        drawCurve(picture, {from, to}, colourOf(i, LINES));
    }
    return picture;
}

std::vector<std::string> rectifiedFiles(const std::string& prefix)
{
    return {prefix + "left.png", prefix + "right.png", prefix + "pair.png", prefix + "disparity.tiff"};
}

void writeRectified(const std::string& prefix, const cv::Mat& rectified1, const cv::Mat& rectified2, const cv::Mat& disparity,
                    bool vertical)
{
    const std::vector<std::string> files = rectifiedFiles(prefix);
    writeImage(files[0], rectified1);
    writeImage(files[1], rectified2);
    writeImage(files[2], sideBySide(rectified1, rectified2, vertical));
    writeImage(files[3], disparity);
}

} // namespace tools
