// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/dense_stereo.hpp"
#include "stereo/coarse_depth.hpp"
#include "stereo/epipolar_check.hpp"
#include "stereo/rectified_match.hpp"
#include "stereo/refine_disparity.hpp"

namespace tools {

using cv::Mat;

namespace {

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
                                              c.extrinsics[1].T, rig.R1,
                                              rig.R2, rig.P1, rig.P2, result.depth1, result.depth2);
    cv::transform(points, result.points, rig.R1.t());
    removeInconsistentPoints(rig, rectified, result.disparity, result.points);
}

} // namespace

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

} // namespace tools
