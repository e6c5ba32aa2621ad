// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/dense_stereo.hpp"
#include "math/quantile.hpp"
#include "stereo/match_support.hpp"
#include "stereo/rectified_rig.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Point;
using cv::Size;
using cv::Vec3d;

namespace {

const Size PATCH(13, 13), NEAR(7, 7);
const int STEPS = 2, ENOUGH = 200;      // of a few values nothing is said
const float NONE = std::numeric_limits<float>::quiet_NaN();

//! The other image as the first would show it if the disparity were right; 32F.
Mat warped(const Mat& second, const Mat& disparity)
{
    Mat mapX(disparity.size(), CV_32F), mapY(disparity.size(), CV_32F), result;
    for (int y = 0; y < disparity.rows; y++)
    {
        const float* d = disparity.ptr<float>(y);
        float* u = mapX.ptr<float>(y);
        for (int x = 0; x < disparity.cols; x++)
            u[x] = (float)x - d[x];
        mapY.row(y).setTo(y);
    }
    cv::remap(second, result, mapX, mapY, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return result;
}

Mat sums(const Mat& values, Size around)
{
    Mat result;
    cv::boxFilter(values, result, CV_32F, around, Point(-1, -1), false, cv::BORDER_CONSTANT);
    return result;
}

//! Of both images' slopes: it leans to neither.
Mat meanSlope(const Mat& a, const Mat& b, int byX, int byY)
{
    Mat slopeA, slopeB;
    cv::Sobel(a, slopeA, CV_32F, byX, byY, 3, 1./8);
    cv::Sobel(b, slopeB, CV_32F, byX, byY, 3, 1./8);
    return 0.5*(slopeA + slopeB);
}

/* The mean of the neighbours where all are of one surface: steps of a matcher's fractions are finer than a patch, which would
leave them as they are. */
void levelSteps(Mat& disparity, const Mat& weight)
{
    const double ONE_SURFACE = 1.5, FAR_AWAY = 1e9;
    const Mat known = weight > 0, element = cv::getStructuringElement(cv::MORPH_RECT, NEAR);
    Mat low = disparity.clone(), high = disparity.clone();
    low.setTo(FAR_AWAY, ~known);
    high.setTo(-FAR_AWAY, ~known);
    cv::erode(low, low, element);
    cv::dilate(high, high, element);
    const Mat count = sums(weight, NEAR);
    Mat(sums(disparity.mul(weight), NEAR)/count).copyTo(disparity, known & (high - low < ONE_SURFACE) & (count > 0.9*NEAR.area()));
}

/* By how much the patches' own sigmas must grow to tell what neighbours on smooth surfaces differ by: noise of pixels is not
independent, patches are not moved copies of each other. Third differences along rows and columns, of disparities so far apart
that no pixel is in two patches, know of no surface up to second order; 95 % of them shall be within 1.96 sigma. */
double inflation(const Mat& disparity, const Mat& sigma)
{
    const int APART = PATCH.width + NEAR.width + 2, EVERY = 3;      // 2: of the interpolation
    const float EDGE = 3, weights[] = {1, -3, 3, -1};
    std::vector<float> ratios;
    for (const Point step : {Point(APART, 0), Point(0, APART)})
        for (int y = 0; y + 3*step.y < disparity.rows; y += EVERY)
            for (int x = 0; x + 3*step.x < disparity.cols; x += EVERY)
            {
                float difference = 0, variance = 0;
                for (int k = 0; k < 4; k++)
                {
                    const float s = weights[k]*sigma.at<float>(Point(x, y) + k*step);
                    difference += weights[k]*disparity.at<float>(Point(x, y) + k*step);
                    variance += s*s;
                }
                if (std::abs(difference) < EDGE && variance > 0)
                    ratios.push_back(std::abs(difference)/std::sqrt(variance));
            }
    return (int)ratios.size() < ENOUGH ? NONE : cv::refract::quantile(ratios, 0.95)/1.96;
}

//! How little two rectified images are alike round each pixel of the first, at its disparity; infinite where that is NaN.
Mat unlikeness(const Mat& first, const Mat& second, const Mat& disparity)
{
    Mat columns(disparity.size(), CV_32F), rows(disparity.size(), CV_32F), partners, result;
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            columns.at<float>(y, x) = (float)x - disparity.at<float>(y, x);
            rows.at<float>(y, x) = (float)y;
        }
    cv::remap(second, partners, columns, rows, cv::INTER_LINEAR);
    cv::absdiff(first, partners, partners);
    cv::blur(partners, result, cv::Size(9, 9));
    result.convertTo(result, CV_32F);
    result.setTo(INFINITY, disparity != disparity);
    return result;
}

//! Disparities of images of half the size; where more than one slab has an answer, that which looks most alike.
Mat coarseDisparity(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options)
{
    const double scale = 0.5;
    const Slabs slabs(rig, scale);
    Mat best, least;
    for (int k = 0; k < slabs.count(); k++)
    {
        const Mat plane(1, 1, CV_64F, cv::Scalar(slabs.depth(k)));
        const RectifiedImages pair = rectify(rig, image1, image2, plane, plane, scale);
        const Mat first = forMatcher(rig, pair.image[0]), second = forMatcher(rig, pair.image[1]);
        const Mat found = match(first, second, slabs.from(k), slabs.disparities(k), options);
        if (slabs.count() == 1)
            return fromMatcher(rig, found);
        const Mat unlike = unlikeness(first, second, found);
        if (best.empty())
        {
            best = Mat(found.size(), CV_32F, NAN);
            least = Mat(found.size(), CV_32F, INFINITY);
        }
        const Mat better = unlike < least;
        found.copyTo(best, better);
        unlike.copyTo(least, better);
    }
    return fromMatcher(rig, best);
}

/** @param first, second rectified, 8-bit grey; disparity along the rows
@param disparity CV_32F, NaN: none */
RefinedDisparity refineDisparity(const Mat& first, const Mat& second, const Mat& disparity)
{
    const float ANY = 1e-3f;        // a patch without contrast moves nowhere
    const Mat known = disparity == disparity;
    Mat weight, I1, I2, current = disparity.clone(), sigma, across;
    known.convertTo(weight, CV_32F, 1./255);
    first.convertTo(I1, CV_32F);
    second.convertTo(I2, CV_32F);
    current.setTo(0, ~known);
    const Mat original = current.clone();
    for (int step = 0; step < STEPS; step++)
    {
        levelSteps(current, weight);
        const Mat there = warped(I2, current), difference = (there - I1).mul(weight);
        const Mat slope = meanSlope(I1, there, 1, 0).mul(weight);
        const Mat contrast = sums(slope.mul(slope), PATCH) + ANY, pull = sums(slope.mul(difference), PATCH);
        const Mat move = pull/contrast;     // I2(x - d - move) is I1(x)
        cv::add(current, move, current, known);
        if (step < STEPS - 1)
            continue;
        const Mat left = cv::max(sums(difference.mul(difference), PATCH) - pull.mul(move), 0.f);
        cv::sqrt(left/cv::max(sums(weight, PATCH) - 1, 1.f)/contrast, sigma);
        const Mat fall = meanSlope(I1, there, 0, 1).mul(weight);
        across = sums(fall.mul(difference), PATCH)/(sums(fall.mul(fall), PATCH) + ANY);
    }
    const Mat none = ~known | (cv::abs(current - original) > 1);
    for (Mat* values : {&current, &sigma, &across})
        values->setTo(NONE, none);
    sigma *= inflation(current, sigma);
    return {current, sigma, across};
}

void refine(const RectifiedRig& rig, DenseStereo& result, const Mat& first, const Mat& second)
{
    const RefinedDisparity refined = refineDisparity(first, second, result.disparity);
    result.disparity = fromMatcher(rig, refined.disparity);
    result.disparitySigmas = fromMatcher(rig, refined.sigma);
    result.rowOffset = fromMatcher(rig, refined.rowOffset);
}

void findPoints(const RectifiedRig& rig, const RectifiedImages& rectified, DenseStereo& result)
{
    const Calibration& c = rig.calibration();
    Mat points;
    cv::refract::refractiveReprojectImageTo3D(result.disparity, points, c.cameras[0].camera, c.cameras[1].camera, c.extrinsics[1].R,
                                              c.extrinsics[1].t, rig.R1,
                                              rig.R2, rig.P1, rig.P2, result.depth1, result.depth2);
    cv::transform(points, result.points, rig.R1.t());
    removeInconsistentPoints(rig, rectified, result.disparity, result.points);
}

} // namespace

/** The first pass: depths of both rectified images, CV_32F of the rig's size, from images of half the size. They stay as they
were if hardly anything was matched. */
static void findCoarseDepth(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options, Mat& depth1,
                     Mat& depth2)
{
    const Mat coarse = coarseDisparity(rig, image1, image2, options);
    const int FEW = 64;
    Mat found1, found2;
    if (cv::countNonZero(coarse == coarse) > FEW)
        cv::refract::refractiveRectifiedDepth(coarse, rig.P1, rig.P2, rig.size(), found1, found2);
    if (found2.empty() || std::isnan(found2.at<float>(0, 0)))       // one is NaN where all are, in image 2 if in image 1
        return;
    depth1 = found1;
    depth2 = found2;
}

DenseStereo matchPair(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options)
{
    DenseStereo result;
    result.depth1 = result.depth2 = Mat(1, 1, CV_64F, cv::Scalar(rig.planeDepth()));
    if (options.passes > 1)
        findCoarseDepth(rig, image1, image2, options, result.depth1, result.depth2);
    const RectifiedImages rectified = rectify(rig, image1, image2, result.depth1, result.depth2, 1);
    result.rectified1 = rectified.image[0];
    result.rectified2 = rectified.image[1];
    const Mat first = forMatcher(rig, result.rectified1), second = forMatcher(rig, result.rectified2);
    result.disparity = match(first, second, rig.minDisparity(), rig.disparities(), options);
    refine(rig, result, first, second);
    findPoints(rig, rectified, result);
    return result;
}

namespace {

//! The surface's depth (rectified frame) at a place of the new image.
double surfaceAt(const Mat& depth, const cv::Point2d& p)
{
    if (depth.total() == 1)
        return depth.at<double>(0);
    const int x = std::clamp(cvRound(p.x), 0, depth.cols - 1), y = std::clamp(cvRound(p.y), 0, depth.rows - 1);
    return depth.at<float>(y, x);
}

//! z between four pixels, if they are of one surface; else of the nearest.
float interpolated(const Mat& points, const cv::Point2d& p)
{
    const double ONE_SURFACE = 0.02;
    const Point nearest(cvRound(p.x), cvRound(p.y));
    if (!cv::Rect(Point(), points.size()).contains(nearest))
        return NONE;
    const float z = points.at<cv::Vec3f>(nearest)[2];
    const int x = cvFloor(p.x), y = cvFloor(p.y);
    if (!(z == z) || x < 0 || y < 0 || x + 1 >= points.cols || y + 1 >= points.rows)
        return z;
    double sum = 0;
    for (int k = 0; k < 4; k++)
    {
        const float corner = points.at<cv::Vec3f>(y + k/2, x + k % 2)[2];
        if (!(std::abs(corner - z) < ONE_SURFACE*z))
            return z;
        sum += (k % 2 ? p.x - x : 1 - (p.x - x))*(k/2 ? p.y - y : 1 - (p.y - y))/corner;
    }
    return (float)(1/sum);
}

} // namespace

Mat depthOfRawPixels(const RectifiedRig& rig, const DenseStereo& stereo)
{
    const int STEPS = 3;        // the surface at the place that the surface at the last place leads to
    const Size size = rig.size();
    const Matx33d turn(rig.R1.ptr<double>()), K(rig.P1.colRange(0, 3).clone().ptr<double>());
    const Vec3d centre = rig.centre();
    Mat depth(size, CV_32F);
    cv::parallel_for_(cv::Range(0, size.height), [&](const cv::Range& range) {
        std::vector<cv::Point2d> pixels(size.width);
        std::vector<Vec3d> origins, directions;
        for (int y = range.start; y < range.end; y++)
        {
            for (int x = 0; x < size.width; x++)
                pixels[x] = cv::Point2d(x, y);
            cv::refract::refractiveUnprojectPoints(pixels, origins, directions, rig.calibration().cameras[0].camera);
            for (int x = 0; x < size.width; x++)
            {
                const Vec3d o = turn*origins[x], d = turn*directions[x];
                double z = rig.planeDepth();
                cv::Point2d p;
                for (int step = 0; step < STEPS; step++)
                {
                    const Vec3d X = o + (z - o[2])/d[2]*d - centre, q = K*X;
                    p = cv::Point2d(q[0]/q[2], q[1]/q[2]);
                    if (!(std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6))
                        break;
                    z = surfaceAt(stereo.depth1, p);
                }
                depth.at<float>(y, x) = std::abs(p.x) < 1e6 && std::abs(p.y) < 1e6 ? interpolated(stereo.points, p) : NONE;
            }
        }
    });
    return depth;
}

} // namespace tools
