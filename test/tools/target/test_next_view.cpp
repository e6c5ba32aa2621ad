// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What the images of a board still lack: said one by one, and heard.
#include "target/board_quality.hpp"
#include <catch2/catch.hpp>
#include <opencv2/calib3d.hpp>

using namespace tools;

namespace {

const cv::Size IMAGE(1280, 1024);

Target board()
{
    TargetOptions options;
    options.size = "7x6";
    options.square = 30;
    return Target(options);
}

//! The board's middle at a place of the picture (of its width and height), turned about the picture's axes, so far away.
std::vector<cv::Point2d> view(const Target& target, cv::Point2d place, cv::Vec3d degrees, double distance)
{
    const double f = 1500;
    const cv::Matx33d K(f, 0, 640, 0, f, 512, 0, 0, 1);
    const cv::Vec3d rvec = degrees*CV_PI/180, middle(90, 75, 0);
    cv::Matx33d R;
    cv::Rodrigues(rvec, R);
    const cv::Vec3d centre((place.x - 0.5)*IMAGE.width*distance/f, (place.y - 0.5)*IMAGE.height*distance/f, distance);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(target.objectPoints(), rvec, centre - R*middle, K, cv::noArray(), pixels);
    return pixels;
}

bool says(const NextView& views, const std::string& part)
{
    CAPTURE(views.advice());
    const bool found = views.advice().find(part) != std::string::npos;
    CHECK(found);
    return found;
}

} // namespace

TEST_CASE("The next image is to show what the others lack", "[next view]")
{
    const Target target = board();
    NextView views(target, IMAGE);
    says(views, "top left corner");
    views.add(view(target, {0.5, 0.5}, {0, 0, 0}, 900));
    says(views, "top left corner");
    views.add(view(target, {0.3, 0.3}, {0, 0, 0}, 500));
    says(views, "top right corner");
    views.add(view(target, {0.7, 0.3}, {0, 0, 0}, 500));
    says(views, "bottom right corner");
    views.add(view(target, {0.7, 0.7}, {0, 0, 0}, 500));
    says(views, "bottom left corner");
    views.add(view(target, {0.3, 0.7}, {0, 0, 0}, 500));
    // About the picture's y axis (down), the left edge goes away.
    says(views, "left edge");
    views.add(view(target, {0.5, 0.5}, {0, -25, 0}, 900));
    says(views, "right edge");
    views.add(view(target, {0.5, 0.5}, {0, 25, 0}, 900));
    says(views, "upper edge");
    views.add(view(target, {0.5, 0.5}, {25, 0, 0}, 900));
    says(views, "lower edge");
    views.add(view(target, {0.5, 0.5}, {-25, 0, 0}, 900));
    says(views, "nearer");
    views.add(view(target, {0.5, 0.5}, {0, 0, 0}, 450));
    CHECK(views.count() == 10);
    says(views, "2 more");
    views.add(view(target, {0.5, 0.5}, {0, 10, 0}, 900));
    views.add(view(target, {0.5, 0.5}, {0, 0, 10}, 900));
    CHECK(views.advice().empty());
}

TEST_CASE("Boards that are all near lack far ones, and points that were not seen are no corners", "[next view]")
{
    const Target target = board();
    NextView views(target, IMAGE);
    for (const double x : {0.2, 0.8})
        for (const double y : {0.2, 0.8})
            for (const double tilt : {-25, 25})
                views.add(view(target, {x, y}, {tilt, tilt, 0}, 400));
    says(views, "farther");
    NextView partial(target, IMAGE);
    std::vector<cv::Point2d> points = view(target, {0.15, 0.15}, {0, 0, 0}, 900);
    for (size_t i = 0; i < points.size(); i++)
        if (points[i].x < IMAGE.width/3.)
            points[i] = cv::Point2d(NAN, NAN);
    partial.add(points);
    says(partial, "top left corner");
}
