#include "stereo/dense_stereo.hpp"
#include "stereo/point_sigma.hpp"
#include "stereo/refine_disparity.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <tuple>

namespace tools {

using cv::Mat;
using cv::Matx33d;
using cv::Size;

namespace {

const float NONE = std::numeric_limits<float>::quiet_NaN();

double secondsSince(int64 ticks) { return (double)(cv::getTickCount() - ticks)/cv::getTickFrequency(); }

//! P of the same new image, scale times as large.
Mat scaled(const Mat& P, double scale)
{
    const Matx33d S(scale, 0, (scale - 1)/2, 0, scale, (scale - 1)/2, 0, 0, 1);     // pixel centres
    return Mat(S)*P;
}

//! depth1, depth2: of the pass.
std::pair<Mat, Mat> rectify(const RectifiedRig& rig, const Mat& image1, const Mat& image2, cv::InputArray depth1,
                            cv::InputArray depth2, double scale, Size size, double& seconds)
{
    std::pair<Mat, Mat> result;
    const auto& cameras = rig.calibration().cameras;
    for (int c = 0; c < 2; c++)
    {
        const int64 start = cv::getTickCount();
        Mat map1, map2;
        const Mat T = c ? Mat(rig.calibration().Ts[c]) : Mat();
        cv::refract::initRefractiveStereoRectifyMap(cameras[c].camera, c ? depth2 : depth1, c ? rig.R2 : rig.R1,
                                                    scaled(c ? rig.P2 : rig.P1, scale), T, size, CV_16SC2, map1, map2);
        seconds += secondsSince(start);
        cv::remap(c ? image2 : image1, c ? result.second : result.first, map1, map2, cv::INTER_LINEAR);
    }
    return result;
}

Mat grey(const Mat& image)
{
    Mat result = image;
    if (image.channels() == 3)
        cv::cvtColor(image, result, cv::COLOR_BGR2GRAY);
    return result;
}

int roundedUp(double value, int step) { return cvCeil(value/step)*step; }

//! Disparity along the rows, in pixels of the given grey images; NaN: none.
Mat match(const Mat& first, const Mat& second, int minDisparity, int disparities, const MatcherOptions& options, double& seconds)
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
    const int64 start = cv::getTickCount();
    matcher->compute(wide1, wide2, fixed);
    seconds += secondsSince(start);
    fixed = fixed(cv::Rect(left, 0, first.cols, first.rows));
    fixed.convertTo(result, CV_32F, 1./cv::StereoMatcher::DISP_SCALE);
    result.setTo(NONE, fixed < minDisparity*cv::StereoMatcher::DISP_SCALE);
    return result;
}

//! Rows of what is matched are the columns of a vertical pair.
Mat along(const RectifiedRig& rig, const Mat& image) { return rig.vertical() ? Mat(image.t()) : image; }

//! The depths for the maps of the second pass, from images of half the size; none, if nothing was found.
void findCoarseDepth(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options,
                     DenseStereo& result)
{
    const double scale = 0.5;
    const Size half(rig.size().width/2, rig.size().height/2);
    const auto pair = rectify(rig, image1, image2, result.depth1, result.depth2, scale, half, result.mapSeconds);
    const int least = cvFloor(rig.minDisparity()*scale), count = roundedUp(rig.disparities()*scale + 1, 16);
    const Mat coarse = along(rig, match(along(rig, grey(pair.first)), along(rig, grey(pair.second)), least, count, options,
                                        result.matchSeconds[0]));
    const int64 start = cv::getTickCount();
    const int FEW = 64;
    if (cv::countNonZero(coarse == coarse) > FEW)
        cv::refract::refractiveRectifiedDepth(coarse, rig.P1, rig.P2, rig.size(), result.depth1, result.depth2);
    result.mapSeconds += secondsSince(start);
}

void refine(const RectifiedRig& rig, DenseStereo& result, const Mat& first, const Mat& second, Mat& sigma)
{
    const int64 start = cv::getTickCount();
    const RefinedDisparity refined = refineDisparity(first, second, result.disparity);
    result.disparity = along(rig, refined.disparity);
    sigma = along(rig, refined.sigma);
    result.rowOffset = refined.rowOffset;
    std::vector<float> sigmas;
    std::copy_if(sigma.begin<float>(), sigma.end<float>(), std::back_inserter(sigmas), [](float s) { return s == s; });
    if (!sigmas.empty())
    {
        std::nth_element(sigmas.begin(), sigmas.begin() + sigmas.size()/2, sigmas.end());
        result.disparitySigma = sigmas[sigmas.size()/2];
    }
    result.refineSeconds += secondsSince(start);
}

void findPoints(const RectifiedRig& rig, DenseStereo& result)
{
    const int64 start = cv::getTickCount();
    const Calibration& c = rig.calibration();
    Mat points;
    cv::refract::refractiveReprojectImageTo3D(result.disparity, points, c.cameras[0].camera, c.cameras[1].camera, c.Rs[1], c.Ts[1], rig.R1,
                                              rig.R2, rig.P1, rig.P2, result.depth1, result.depth2);
    cv::transform(points, result.points, rig.R1.t());
    result.mapSeconds += secondsSince(start);
}

} // namespace

int DenseStereo::matched() const
{
    int count = 0;
    for (const cv::Vec3f& X : cv::Mat_<cv::Vec3f>(points))
        count += X[2] == X[2];
    return count;
}

DenseStereo matchPair(const RectifiedRig& rig, const Mat& image1, const Mat& image2, const MatcherOptions& options)
{
    DenseStereo result;
    result.depth1 = result.depth2 = Mat(1, 1, CV_64F, cv::Scalar(rig.planeDepth()));
    if (options.passes > 1)
        findCoarseDepth(rig, image1, image2, options, result);
    std::tie(result.rectified1, result.rectified2) = rectify(rig, image1, image2, result.depth1, result.depth2, 1, rig.size(),
                                                             result.mapSeconds);
    const Mat first = along(rig, grey(result.rectified1)), second = along(rig, grey(result.rectified2));
    result.disparity = match(first, second, rig.minDisparity(), rig.disparities(), options, result.matchSeconds[1]);
    Mat sigma;
    refine(rig, result, first, second, sigma);
    findPoints(rig, result);
    result.sigma = pointSigma(rig, result, sigma);
    return result;
}

} // namespace tools
