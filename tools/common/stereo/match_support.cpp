// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/match_support.hpp"
#include "console/images.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tools {

using cv::Mat;
using cv::Vec2f;
using cv::Vec3f;

namespace {

const double MOST = 1;      // px between a raw pixel and the other's epipolar curve

//! The raw pixel between two places of a map; NaN where it has none.
Vec2f between(const Vec2f& a, const Vec2f& b, float part)
{
    if (a == Vec2f(-1, -1) || b == Vec2f(-1, -1))
        return Vec2f(NAN, NAN);
    return a + part*(b - a);
}

//! Raw pixel of camera 2 of the partner of (x, y).
Vec2f partnerOf(const Mat& map, bool vertical, int x, int y, float disparity)
{
    const float place = (float)(vertical ? y : x) - disparity;
    const int last = (vertical ? map.rows : map.cols) - 1;
    if (!(place >= 0 && place <= (float)last))
        return Vec2f(NAN, NAN);
    const int first = cvFloor(place), second = std::min(first + 1, last);
    return vertical ? between(map.at<Vec2f>(first, x), map.at<Vec2f>(second, x), place - (float)first)
                    : between(map.at<Vec2f>(y, first), map.at<Vec2f>(y, second), place - (float)first);
}

const cv::Size PATCH(11, 11);
const float ALIKE = 0.6f;           // correlation; true partners have more even where noise is half of the contrast
const float FLAT = 0.25f;           // variance, grey levels squared, as rounding to 8 bits leaves
const float CONTRAST = 4;           // times the variance of the noise: true partners then correlate by 0.75

Mat toFloat(const Mat& image)
{
    Mat result;
    image.convertTo(result, CV_32F);
    return result;
}

//! The second image as the first sees it.
Mat moved(const Mat& second, const Mat& disparity)
{
    Mat mapX(disparity.size(), CV_32F), mapY(disparity.size(), CV_32F), result;
    for (int y = 0; y < disparity.rows; y++)
    {
        const float* row = disparity.ptr<float>(y);
        for (int x = 0; x < disparity.cols; x++)
        {
            const float d = row[x], by = d == d ? d : 0;
            mapX.at<float>(y, x) = (float)x - by;
            mapY.at<float>(y, x) = (float)y;
        }
    }
    cv::remap(second, result, mapX, mapY, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    return result;
}

Mat averaged(const Mat& values)
{
    Mat result;
    cv::blur(values, result, PATCH);
    return result;
}

/* Variance of the pixels' noise: what the best matches leave, of both images together. If all are wrong, it is the contrast of
the scene, and nothing has more than that. */
float noiseOf(const Mat& left, const Mat& matched)
{
    const int FEW = 20, EVERY = 3;
    const double BEST = 0.1;
    std::vector<float> values;
    for (int y = 0; y < left.rows; y += EVERY)
        for (int x = 0; x < left.cols; x += EVERY)
            if (matched.at<uchar>(y, x))
                values.push_back(left.at<float>(y, x));
    if ((int)values.size() < FEW)
        return FLAT;
    const auto at = values.begin() + (int)(BEST*(double)values.size());
    std::nth_element(values.begin(), at, values.end());
    return std::max(FLAT, *at/2);
}

} // namespace

void removeInconsistentPoints(const RectifiedRig& rig, const RectifiedImages& rectified, const Mat& disparity, Mat& points)
{
    const Calibration& c = rig.calibration();
    cv::parallel_for_(cv::Range(0, points.rows), [&](const cv::Range& range) {
        Mat seen1, seen2;
        for (int y = range.start; y < range.end; y++)
        {
            const Mat row = points.row(y);
            cv::refract::refractiveProjectPoints(row, cv::Vec3d(), cv::Vec3d(), c.cameras[0].camera, seen1);
            cv::refract::refractiveProjectPoints(row, c.extrinsics[1].R, c.extrinsics[1].t, c.cameras[1].camera, seen2);
            for (int x = 0; x < points.cols; x++)
            {
                const Vec2f raw1 = rectified.map[0].at<Vec2f>(y, x);
                const Vec2f raw2 = partnerOf(rectified.map[1], rig.vertical(), x, y, disparity.at<float>(y, x));
                // The most likely point is in the middle: each pixel is off by half of what they miss each other by.
                const double miss = std::sqrt(2*(norm(seen1.at<Vec2f>(x) - raw1, cv::NORM_L2SQR)
                                                 + norm(seen2.at<Vec2f>(x) - raw2, cv::NORM_L2SQR)));
                if (!(miss <= MOST))
                    points.at<Vec3f>(y, x) = Vec3f(NAN, NAN, NAN);
            }
        }
    });
}

double MatchSupport::share() const
{
    return textured > 0 ? (double)supported/textured : std::numeric_limits<double>::quiet_NaN();
}

MatchSupport supportOf(const Mat& image1, const Mat& image2, const Mat& disparity)
{
    const Mat first = toFloat(image1), second = moved(toFloat(image2), disparity), matched = disparity == disparity;
    const Mat mean1 = averaged(first), mean2 = averaged(second), product = averaged(first.mul(second));
    const Mat variance1 = averaged(first.mul(first)) - mean1.mul(mean1), variance2 = averaged(second.mul(second)) - mean2.mul(mean2);
    const Mat together = product - mean1.mul(mean2);
    const float contrast = CONTRAST*noiseOf(variance1 + variance2 - 2*together, matched);
    MatchSupport result;
    result.mask = Mat::zeros(first.size(), CV_8U);
    result.correlation = Mat::zeros(first.size(), CV_32F);
    for (int y = 0; y < first.rows; y++)
        for (int x = 0; x < first.cols; x++)
        {
            const float v1 = variance1.at<float>(y, x), v2 = variance2.at<float>(y, x), c = together.at<float>(y, x);
            if (!matched.at<uchar>(y, x))
                continue;
            const float correlation = v1 > FLAT && v2 > FLAT ? c/std::sqrt(v1*v2) : 0;
            const bool alike = correlation > ALIKE;
            result.correlation.at<float>(y, x) = correlation;
            result.mask.at<uchar>(y, x) = alike ? 255 : 0;
            result.textured += v1 > contrast;
            result.supported += alike && v1 > contrast;
        }
    // At an edge of the scene a patch has two depths, and one beside it only one.
    cv::dilate(result.mask, result.nearby, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(3*PATCH.width - 2, 3*PATCH.height - 2)));
    result.nearby &= matched;
    return result;
}

} // namespace tools
