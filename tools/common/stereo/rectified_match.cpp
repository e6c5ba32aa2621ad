// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/rectified_match.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>

namespace tools {

using cv::Mat;

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
        const Mat T = c ? Mat(rig.calibration().extrinsics[c].T) : Mat(), P = scaled(c ? rig.P2 : rig.P1, scale);
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
