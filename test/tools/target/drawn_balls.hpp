// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DRAWN_BALLS_HPP
#define REFRACT_TEST_DRAWN_BALLS_HPP

#include "scenes.hpp"
#include <opencv2/imgproc.hpp>
#include <opencv2/refract.hpp>
#include <vector>

/* Balls as cameras behind windows see them: rays of many places in a pixel are traced. */
namespace drawn_balls {

struct Ball
{
    cv::Point3d center;                 //!< in camera 1
    double radius;
    double level, shading = 0.;         //!< grey levels; what it loses from its upper left to its lower right
};

//! A camera and where it is, from camera 1.
struct View
{
    cv::Ptr<cv::refract::RefractiveCamera> camera;
    cv::Matx33d R;
    cv::Vec3d T;
};

//! Of a ray and a ball, in the ball's radii and the frame of camera 1.
struct Sight
{
    double miss;                        //!< distance of the ray from the centre
    cv::Vec3d point;                    //!< where the ray first meets the ball, or is nearest to it; from the centre
};

inline std::vector<Sight> sightsOf(const Ball& ball, const View& view, const std::vector<cv::Point2d>& pixels)
{
    std::vector<cv::Point3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, view.camera);
    const cv::Vec3d center = view.R*cv::Vec3d(ball.center) + view.T;
    std::vector<Sight> result;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const cv::Vec3d d(directions[i]), from = (cv::Vec3d(origins[i]) - center)/ball.radius;
        const double along = -d.dot(from), miss = cv::norm(from + along*d);
        const double s = along - std::sqrt(std::max(0., 1 - miss*miss));
        result.push_back({miss, view.R.t()*(from + s*d)});
    }
    return result;
}

//! A tank: not even, with a lamp and what a pane mirrors of it, which stand still.
inline cv::Mat tank(cv::Size size, double from, double to, const std::vector<cv::Point2d>& lamps = {})
{
    cv::Mat image(size, CV_32F);
    for (int y = 0; y < size.height; y++)
        image.row(y) = cv::Scalar(from + (to - from)*y/size.height);
    for (const cv::Point2d& lamp : lamps)
        cv::circle(image, cv::Point(lamp*16), 9*16, cv::Scalar(240), -1, cv::LINE_AA, 4);
    return image;
}

//! How much of each place of a grid is within the ball: the edge goes through places, too.
inline cv::Mat shareOf(const cv::Mat& miss)
{
    cv::Mat dx, dy, slope;
    cv::Sobel(miss, dx, CV_32F, 1, 0, 3, 1./8);
    cv::Sobel(miss, dy, CV_32F, 0, 1, 3, 1./8);
    cv::magnitude(dx, dy, slope);
    return cv::min(cv::max(0.5 + (1 - miss)/slope, 0), 1);
}

//! The part of an image that may show a ball; empty: none.
inline cv::Rect partOf(const Ball& ball, const View& view, double blur)
{
    const int RIM = 6;
    const cv::Mat rvec = cv::Mat(view.R), tvec = cv::Mat(view.T);
    std::vector<cv::Point2d> middle;
    cv::refract::refractiveProjectPoints(std::vector<cv::Point3d>{ball.center, ball.center + cv::Point3d(ball.radius, 0, 0)}, rvec, tvec,
                                         view.camera, middle);
    if (std::isnan(middle[0].x) || std::isnan(middle[1].x))
        return cv::Rect();
    const int reach = cvCeil(1.3*cv::norm(middle[1] - middle[0])) + RIM + cvCeil(4*blur);
    return cv::Rect(cvRound(middle[0].x) - reach, cvRound(middle[0].y) - reach, 2*reach + 1, 2*reach + 1);
}

//! Adds a ball to an image without noise. @param fine places in a pixel, each way
inline void draw(const Ball& ball, const View& view, double blur, cv::Mat& image, int fine = 4)
{
    const cv::Rect part = partOf(ball, view, blur), inside = part & cv::Rect(cv::Point(), image.size());
    if (inside.empty())
        return;
    cv::Mat miss(part.size()*fine, CV_32F), light = miss.clone();
    for (int y = 0; y < miss.rows; y++)
    {
        std::vector<cv::Point2d> pixels;
        for (int x = 0; x < miss.cols; x++)
            pixels.emplace_back(part.x + (x + 0.5)/fine - 0.5, part.y + (y + 0.5)/fine - 0.5);
        const std::vector<Sight> sights = sightsOf(ball, view, pixels);
        for (int x = 0; x < miss.cols; x++)
        {
            const cv::Vec3d& at = sights[x].point;
            miss.at<float>(y, x) = (float)sights[x].miss;
            light.at<float>(y, x) = (float)(ball.level - ball.shading*0.5*(1 + (at[0] + at[1])*M_SQRT1_2));
        }
    }
    cv::Mat share = shareOf(miss);
    light = light.mul(share);
    for (cv::Mat* one : {&share, &light})
    {
        cv::GaussianBlur(*one, *one, cv::Size(), blur*fine);
        cv::resize(*one, *one, part.size(), 0, 0, cv::INTER_AREA);
    }
    const cv::Rect there(inside.tl() - part.tl(), inside.size());
    image(inside) = image(inside).mul(1 - share(there)) + light(there);
}

inline cv::Mat exposed(const cv::Mat& image, double noise, scenes::Random& random)
{
    cv::Mat noisy(image.size(), CV_32F), result;
    cv::RNG generator((uint64)random.below(1 << 30));
    generator.fill(noisy, cv::RNG::NORMAL, 0, noise);
    cv::Mat(image + noisy).convertTo(result, CV_8U);
    return result;
}

} // namespace drawn_balls

#endif // REFRACT_TEST_DRAWN_BALLS_HPP
