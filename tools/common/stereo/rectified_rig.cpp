// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/rectified_rig.hpp"
#include "stereo/dense_stereo.hpp"
#include "console/failure.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

namespace tools {

using cv::Mat;
using cv::Vec2d;
using cv::Vec3d;

static Vec3d centreOf(const Mat& P)
{
    const Mat c = -(P.colRange(0, 3).inv()*P.col(3));
    return Vec3d(c.ptr<double>());
}

RectifiedRig::RectifiedRig(const Calibration& calibration, const Vec2d& depthRange)
    : calibration_(calibration), depthRange_(depthRange), size_(calibration.cameras[0].camera->imageSize())
{
    const auto& cameras = calibration.cameras;
    // Each image keeps its own principal point: of cameras that look at one place, a common one shows nothing of it.
    const int flags = 0;
    rowError = cv::refract::refractiveStereoRectify(cameras[0].camera, cameras[1].camera, calibration.extrinsics[1].R,
                                                    calibration.extrinsics[1].t, size_,
                                                    depthRange, R1, R2, P1, P2, Q, flags);
    const Vec3d base = centreOf(P2) - centreOf(P1);
    vertical_ = std::abs(base[1]) > std::abs(base[0]);
    findDisparities();
    const int across = vertical_ ? size_.height : size_.width;
    if (disparities_ >= across)
        throw Failure(cv::format("--depth=%g,%g: over that range the disparity changes by %d pixels, and the images have "
                                 "%d: give a smaller range", depthRange[0], depthRange[1], disparities_, across));
}

void RectifiedRig::correctColours(const ChannelWavelengths& wavelengths, const std::string& of)
{
    for (int c = 0; c < 2; c++)
        colours_[c] = camerasInColours(calibration_.cameras[c].camera, wavelengths, of);
}

Vec3d RectifiedRig::centre() const { return centreOf(P1); }

double RectifiedRig::shift() const
{
    const int axis = vertical_ ? 1 : 0;
    return P1.at<double>(axis, 2) - P2.at<double>(axis, 2);
}

double RectifiedRig::perInverse() const
{
    return P1.at<double>(0, 0)*(centreOf(P2) - centre())[vertical_ ? 1 : 0];
}

double RectifiedRig::depthOf(double disparity) const { return centre()[2] + perInverse()/(disparity - shift()); }

//! The range of disparities is that of the depths in the rectified frame, all over the image.
void RectifiedRig::findDisparities()
{
    const cv::Matx33d turn(R1.ptr<double>());
    const Vec3d c1 = centre();
    double least = INFINITY, most = -INFINITY;
    const auto add = [&](double d) {
        least = std::min(least, std::isnan(d) ? least : d);
        most = std::max(most, std::isnan(d) ? most : d);
    };
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 9; i++)
        {
            const std::vector<cv::Point2d> pixel = {cv::Point2d(0.5*(i % 3)*(size_.width - 1), 0.5*(i/3)*(size_.height - 1))};
            std::vector<Vec3d> X;
            if (std::isinf(depthRange_[k]))
                add(shift());
            else
            {
                cv::refract::refractivePointsOnPlane(pixel, X, calibration_.cameras[0].camera, cv::Vec4d(0, 0, 1, depthRange_[k]));
                add(perInverse()/((turn*X[0])[2] - c1[2]) + shift());
            }
        }
    minDisparity_ = cvFloor(least) - 1;
    disparities_ = cvCeil((most + 1 - minDisparity_)/16)*16;
    const int LARGEST = 2047;       // that cv::StereoSGBM can say, in 16 bits of which 4 are fractions
    if (minDisparity_ < -LARGEST || minDisparity_ + disparities_ > LARGEST)
        throw Failure(cv::format("disparities would be from %d to %d pixels, and cv::StereoSGBM allows up to %d: make images and "
                                 "calibration half as large", minDisparity_, minDisparity_ + disparities_, LARGEST));
}

//! P of the same new image, scale times as large.
static Mat scaled(const Mat& P, double scale)
{
    const cv::Matx33d S(scale, 0, (scale - 1)/2, 0, scale, (scale - 1)/2, 0, 0, 1);     // pixel centres
    return Mat(S)*P;
}

RectifiedImages rectify(const RectifiedRig& rig, const Mat& image1, const Mat& image2, cv::InputArray depth1,
                        cv::InputArray depth2, double scale)
{
    RectifiedImages result;
    const cv::Size size(cvFloor(rig.size().width*scale), cvFloor(rig.size().height*scale));
    for (int c = 0; c < 2; c++)
    {
        const Mat T = c ? Mat(rig.calibration().extrinsics[c].t) : Mat(), P = scaled(c ? rig.P2 : rig.P1, scale);
        const auto mapOf = [&](const cv::Ptr<cv::refract::RefractiveCamera>& camera) {
            Mat map;
            cv::refract::initRefractiveStereoRectifyMap(camera, c ? depth2 : depth1, c ? rig.R2 : rig.R1, P, T, size, CV_32FC2, map,
                                                        cv::noArray());
            return map;
        };
        result.map[c] = mapOf(rig.calibration().cameras[c].camera);
        std::vector<Mat> maps;
        for (const auto& camera : rig.colours(c))
            maps.push_back(mapOf(camera));
        result.image[c] = remapChannels(c ? image2 : image1, maps.empty() ? std::vector<Mat>{result.map[c]} : maps,
                                        cv::INTER_LINEAR);
    }
    return result;
}

Mat fromMatcher(const RectifiedRig& rig, const Mat& image) { return rig.vertical() ? Mat(image.t()) : image; }

Mat forMatcher(const RectifiedRig& rig, const Mat& image)
{
    // Colours that were rectified each by itself lie on each other.
    return fromMatcher(rig, greyOf(image, rig.correctsColours() ? BRIGHTNESS : rig.calibration().channel));
}

Mat match(const Mat& first, const Mat& second, int minDisparity, int disparities, const MatcherOptions& options)
{
    // The matcher answers no column whose farthest partner would be outside: with a margin it answers all.
    const int left = std::max(minDisparity + disparities, 0), right = std::max(-minDisparity, 0);
    Mat wide1, wide2, fixed, result;
    cv::copyMakeBorder(first, wide1, 0, 0, left, right, cv::BORDER_CONSTANT);
    cv::copyMakeBorder(second, wide2, 0, 0, left, right, cv::BORDER_CONSTANT);
    const int area = options.block*options.block;
    const cv::Ptr<cv::StereoSGBM> matcher = cv::StereoSGBM::create(
        minDisparity, disparities, options.block, 8*area, 32*area, 1, 31, 10, 100, 2,
        options.fullPaths ? cv::StereoSGBM::MODE_HH : cv::StereoSGBM::MODE_SGBM_3WAY);
    matcher->compute(wide1, wide2, fixed);
    fixed = fixed(cv::Rect(left, 0, first.cols, first.rows));
    fixed.convertTo(result, CV_32F, 1./cv::StereoMatcher::DISP_SCALE);
    result.setTo(NAN, fixed < minDisparity*cv::StereoMatcher::DISP_SCALE);
    return result;
}

} // namespace tools
