// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/next_view.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

namespace {

const double GUESSED_FOCAL_LENGTH = 1.2;        // in image widths; enough to tell a tilted board from one that is not
const double TILT_DEG = 12.;
const double NEAR = 0.45, FAR_OVER_NEAR = 0.7;  // of the picture; of the largest board

} // namespace

void NextView::add(const std::vector<cv::Point2d>& points)
{
    std::vector<cv::Point3f> object;
    std::vector<cv::Point2f> pixels;
    for (size_t i = 0; i < points.size(); i++)
        if (seen(points[i]))
        {
            object.emplace_back(target_.objectPoints()[i]);
            pixels.emplace_back(points[i]);
            const auto third = [](double at, int size) { return std::clamp((int)std::floor(3*at/size), 0, 2); };
            corners_[third(points[i].y, image_.height)][third(points[i].x, image_.width)]++;
        }
    if (pixels.size() < 4)
        return;
    count_++;
    std::vector<cv::Point2f> outline;
    cv::convexHull(pixels, outline);
    const double size = std::sqrt(cv::contourArea(outline)/image_.area());
    nearest_ = std::max(nearest_, size);
    farthest_ = count_ == 1 ? size : std::min(farthest_, size);

    const double focal = GUESSED_FOCAL_LENGTH*image_.width;
    const cv::Matx33d K(focal, 0, 0.5*(image_.width - 1), 0, focal, 0.5*(image_.height - 1), 0, 0, 1);
    cv::Vec3d rvec, tvec;
    if (!cv::solvePnP(object, pixels, K, cv::noArray(), rvec, tvec, false, cv::SOLVEPNP_IPPE))
        return;
    cv::Matx33d R;
    cv::Rodrigues(rvec, R);
    const double sign = R(2, 2) > 0 ? -1 : 1, least = std::sin(TILT_DEG*CV_PI/180);     // the normal towards the camera
    const double x = sign*R(0, 2), y = sign*R(1, 2);
    for (const auto& side : {std::pair(0, x), std::pair(1, -x), std::pair(2, y), std::pair(3, -y)})
        tilted_[side.first] = tilted_[side.first] || side.second > least;
}

//! The middle comes by itself; corners of the picture first, as the lens bends most there.
std::string NextView::emptyPart() const
{
    static const struct { int row, column; const char* name; } parts[] = {
        {0, 0, "top left corner"}, {0, 2, "top right corner"}, {2, 2, "bottom right corner"}, {2, 0, "bottom left corner"},
        {0, 1, "top"}, {2, 1, "bottom"}, {1, 0, "left"}, {1, 2, "right"}, {1, 1, "middle"}};
    for (const auto& part : parts)
        if (corners_[part.row][part.column] == 0)
            return std::string("hold the board into the ") + part.name + " of the picture";
    return "";
}

std::string NextView::missingTilt() const
{
    const char* const edges[] = {"left", "right", "upper", "lower"};
    for (int i = 0; i < 4; i++)
        if (!tilted_[i])
            return std::string("tilt its ") + edges[i] + " edge towards the camera, by 20 to 35 degrees";
    return "";
}

std::string NextView::missingDistance() const
{
    if (nearest_ < NEAR)
        return "go nearer, until the board fills half of the picture";
    return farthest_ > FAR_OVER_NEAR*nearest_ ? "go farther away, to about twice the distance" : "";
}

std::string NextView::advice() const
{
    for (const std::string& text : {emptyPart(), missingTilt(), missingDistance()})
        if (!text.empty())
            return text;
    return count_ < ENOUGH ? cv::format("%d more, each tilted and turned in another way", ENOUGH - count_) : "";
}

} // namespace tools
