// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/wide_search.hpp"
#include "console/failure.hpp"
#include "console/progress.hpp"
#include "match/depth_range.hpp"
#include "match/pair_mistakes.hpp"
#include "math/quantile.hpp"
#include "stereo/dense_stereo.hpp"
#include "stereo/depth_picture.hpp"
#include "stereo/match_support.hpp"
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Point2d;
using cv::Point3d;
using cv::Vec3d;

namespace {

const int MOST_DETAILS = 4000;
const double SAME_POINT = 1.5;          // px

} // namespace

std::vector<float> depthsOfFeatures(const Calibration& calibration, const Mat& image1, const Mat& image2)
{
    const Partners partners = findPartners(greyOf(image1, calibration.channel), greyOf(image2, calibration.channel), MOST_DETAILS);
    std::vector<Point3d> points;
    const std::vector<double> misses = missesOf(calibration, partners, points);
    std::vector<float> depths;
    for (size_t i = 0; i < misses.size(); i++)
        if (misses[i] < SAME_POINT)
            depths.push_back((float)points[i].z);
    std::sort(depths.begin(), depths.end());
    return depths;
}

cv::Vec2d depthRangeOf(const std::vector<float>& depths, const Calibration& calibration)
{
    const double rare = 0.02, wider = 0.1;      // what has no details may reach a little farther
    if ((int)depths.size() < MIN_FEATURES)
        throw Failure(cv::format("the depth range of the scene could not be found, as only %d features match in both images: give "
                                 "--depth=NEAR,FAR, and check that the images are of one moment and LEFT is of camera 1",
                                 (int)depths.size()));
    const double nearest = cv::refract::quantile(depths, rare), near = nearest/(1 + wider);
    return cv::Vec2d(isBeyondWindows(calibration, near) ? near : nearest, cv::refract::quantile(depths, 1 - rare)*(1 + wider));
}

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN();
const double MOST_DISPARITIES = 0.75;       // of the image's width: beyond, hardly anything is in both images
const double UNCERTAIN = 1.5;               // px of the small images

//! Of the small images: no more pixels than it takes.
double scaleOf(const RectifiedRig& rig)
{
    const int ENOUGH = 200, across = rig.vertical() ? rig.size().height : rig.size().width;
    double scale = 1;
    while (scale*across > ENOUGH && scale > 1./8)
        scale /= 2;
    return scale;
}

//! For the widest range that both cameras see of depths near to infinity; none if that is not wider.
std::unique_ptr<RectifiedRig> wideRig(const Calibration& calibration, const RectifiedRig& asked)
{
    const double far = std::numeric_limits<double>::infinity();
    const int across = asked.vertical() ? asked.size().height : asked.size().width;
    const double perInverse = asked.depthOf(asked.shift() + 1) - asked.centre()[2];
    const double widest = asked.centre()[2] + perInverse/(MOST_DISPARITIES*across);
    for (double near : {widest, 1.5*widest, 2*widest})
    {
        if (!isBeyondWindows(calibration, near))
            continue;
        try
        {
            return std::make_unique<RectifiedRig>(calibration, cv::Vec2d(near, far));
        }
        catch (const Failure&) {}               // too near
        catch (const cv::Exception&) {}         // no common view
    }
    return nullptr;
}

//! Without what is too fine for small images.
Mat smooth(const Mat& image, double scale)
{
    Mat result;
    const int side = cvRound(1/scale);
    if (side < 2)
        return image;
    cv::blur(image, result, cv::Size(side, side));
    return result;
}

//! 255 where a patch is of the raw image, all of it.
Mat insideOf(const RectifiedRig& rig, const Mat& map, cv::Size raw)
{
    const cv::Size PATCH(11, 11);
    Mat inside(map.size(), CV_8U);
    for (int y = 0; y < map.rows; y++)
        for (int x = 0; x < map.cols; x++)
        {
            const cv::Vec2f& p = map.at<cv::Vec2f>(y, x);
            inside.at<uchar>(y, x) = p[0] >= 0 && p[1] >= 0 && p[0] <= (float)(raw.width - 1) && p[1] <= (float)(raw.height - 1) ? 255 : 0;
        }
    cv::erode(inside, inside, cv::getStructuringElement(cv::MORPH_RECT, PATCH), cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, 0);
    return fromMatcher(rig, inside);
}

//! Removes matches of what is beyond the raw images: black is alike everywhere.
void removeBeyond(const RectifiedRig& rig, const RectifiedImages& pair, cv::Size raw, Mat& disparity)
{
    const Mat inside1 = insideOf(rig, pair.map[0], raw), inside2 = insideOf(rig, pair.map[1], raw);
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            float& d = disparity.at<float>(y, x);
            const int partner = d == d ? cvRound((float)x - d) : -1;
            if (partner < 0 || partner >= disparity.cols || !inside1.at<uchar>(y, x) || !inside2.at<uchar>(y, partner))
                d = NONE;
        }
}

//! Disparity in the small rectified images, NaN where they are not alike.
Mat disparityOf(const RectifiedRig& rig, const Mat& image1, const Mat& image2, double scale)
{
    const Slabs slabs(rig, scale);
    const float ALIKE = slabs.count() > 1 ? 0.8f : 0.f;     // of many answers the best is alike by chance
    Mat result, best;
    for (int k = 0; k < slabs.count(); k++)
    {
        const Mat plane(1, 1, CV_64F, cv::Scalar(slabs.depth(k)));
        const RectifiedImages pair = rectify(rig, image1, image2, plane, plane, scale);
        const Mat first = forMatcher(rig, pair.image[0]), second = forMatcher(rig, pair.image[1]);
        Mat found = match(first, second, slabs.from(k), slabs.disparities(k), MatcherOptions());
        removeBeyond(rig, pair, image1.size(), found);
        const MatchSupport support = supportOf(first, second, found);
        if (result.empty())
        {
            result = Mat(found.size(), CV_32F, NONE);
            best = Mat(found.size(), CV_32F, ALIKE);
        }
        const Mat better = support.mask & (support.correlation > best);
        found.copyTo(result, better);
        support.correlation.copyTo(best, better);
    }
    return fromMatcher(rig, result);
}

} // namespace

double WideDepths::outside() const { return sorted.empty() ? 0 : (double)(nearer + farther)/(double)sorted.size(); }

WideSearch::WideSearch(const Calibration& calibration, const RectifiedRig& asked)
    : range_(asked.depthRange()), scale_(scaleOf(asked)), rig_(wideRig(calibration, asked)) {}

WideDepths WideSearch::look(const Mat& image1, const Mat& image2) const
{
    WideDepths result;
    if (!rig_)
        return result;
    const Mat disparity = disparityOf(*rig_, smooth(image1, scale_), smooth(image2, scale_), scale_);
    result.least = Mat(disparity.size(), CV_32F, NONE);
    result.most = result.least.clone();
    const Vec3d centre = rig_->centre();
    const Matx33d back = Matx33d(rig_->R1.ptr<double>()).t();
    const Matx33d rayOf = Matx33d(rig_->P1.colRange(0, 3).clone().ptr<double>()).inv();
    const double perInverse = rig_->depthOf(rig_->shift() + 1) - centre[2];
    for (int y = 0; y < disparity.rows; y++)
        for (int x = 0; x < disparity.cols; x++)
        {
            const double d = disparity.at<float>(y, x)/scale_ - rig_->shift();
            if (!(d == d))
                continue;
            const Vec3d ray = rayOf*Vec3d((x + 0.5)/scale_ - 0.5, (y + 0.5)/scale_ - 0.5, 1);
            const auto depthAt = [&](double disparityHere) {
                return disparityHere > 0 ? (back*(centre + ray*(perInverse/disparityHere)))[2] : INFINITY; };
            const double least = depthAt(d + UNCERTAIN/scale_), most = depthAt(d - UNCERTAIN/scale_);
            if (most < rig_->depthRange()[0])
                continue;           // by chance: disparities are those of the near end in all corners
            result.least.at<float>(y, x) = (float)least;
            result.most.at<float>(y, x) = (float)most;
            result.sorted.push_back((float)depthAt(d));
            result.nearer += most < range_[0];
            result.farther += least > range_[1];
        }
    std::sort(result.sorted.begin(), result.sorted.end());
    return result;
}

bool WideSearch::isContradicted(const WideDepths& seen, bool onlyConfirmed, const cv::Vec3f& X, const Matx33d& K_turn,
                                const Vec3d& offset) const
{
    const Vec3d q = K_turn*Vec3d(X) - offset;
    const int u = cvRound((q[0]/q[2] + 0.5)*scale_ - 0.5), v = cvRound((q[1]/q[2] + 0.5)*scale_ - 0.5);
    bool isOutside = false;
    for (int dv = -1; dv <= 1; dv++)
        for (int du = -1; du <= 1; du++)
        {
            if (u + du < 0 || v + dv < 0 || u + du >= seen.least.cols || v + dv >= seen.least.rows)
                continue;
            const float least = seen.least.at<float>(v + dv, u + du), most = seen.most.at<float>(v + dv, u + du);
            if (X[2] >= least && X[2] <= most)
                return false;
            isOutside = isOutside || most < range_[0] || least > range_[1];
        }
    return isOutside || (onlyConfirmed && X[2] > rig_->depthRange()[0]);
}

void WideSearch::removeContradicted(const WideDepths& seen, bool onlyConfirmed, Mat& points) const
{
    if (!rig_ || seen.least.empty())
        return;
    const Matx33d K(rig_->P1.colRange(0, 3).clone().ptr<double>()), K_turn = K*Matx33d(rig_->R1.ptr<double>());
    const Vec3d offset = K*rig_->centre();
    inParallel(points.rows, [&](int y) {
        for (int x = 0; x < points.cols; x++)
        {
            cv::Vec3f& X = points.at<cv::Vec3f>(y, x);
            if (X[2] == X[2] && isContradicted(seen, onlyConfirmed, X, K_turn, offset))
                X = cv::Vec3f(NONE, NONE, NONE);
        }
    });
}

} // namespace tools
