// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/dot_map.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>

using cv::Point2d;

namespace tools {

static cv::Point pixelOf(const Point2d& p, cv::Size image)
{
    return {std::clamp(cvRound(p.x), 0, image.width - 1), std::clamp(cvRound(p.y), 0, image.height - 1)};
}

DotMap::DotMap(const std::vector<Point2d>& dots, cv::Size image) : dots_(dots)
{
    cv::Mat empty(image, CV_8U, cv::Scalar(255)), distance;
    for (const Point2d& dot : dots)
        empty.at<uchar>(pixelOf(dot, image)) = 0;
    cv::distanceTransform(empty, distance, nearest_, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    ofLabel_.resize(dots.size() + 1, -1);
    for (int i = 0; i < (int)dots.size(); i++)
        ofLabel_[nearest_.at<int>(pixelOf(dots[i], image))] = i;
}

bool DotMap::isInside(const Point2d& p) const
{
    return p.x > -0.5 && p.y > -0.5 && p.x < nearest_.cols - 0.5 && p.y < nearest_.rows - 0.5;
}

int DotMap::at(const Point2d& p, double reach) const
{
    if (!isInside(p))
        return -1;
    const int dot = ofLabel_[nearest_.at<int>(pixelOf(p, nearest_.size()))];
    return dot >= 0 && cv::norm(dots_[dot] - p) < reach ? dot : -1;
}

} // namespace tools
