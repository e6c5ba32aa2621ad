// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Dense stereo: what windows add to matching.
#include "rows.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <limits>
#if CV_VERSION_MAJOR >= 5
#include <opencv2/stereo.hpp>
#endif

using namespace cv;
using namespace cv::refract;

namespace bench {

namespace {

const Size SIZE((int)WIDTH, (int)HEIGHT), HALF(SIZE.width/2, SIZE.height/2);
const int DISPARITIES = 256;

//! A pair of the size and range of a usual scene, and all that one image pair takes.
struct Dense
{
    Scene first = Scene(FIVE, 1), second = Scene(FIVE, 1);
    const Matx33d R = Matx33d::eye();
    const Vec3d T = Vec3d(-60, 0, 0);
    Mat left, right, fixed, halfLeft, halfRight;            // rectified images
    Mat disparity, coarse;                                  // what a matcher finds in them: two thirds of the pixels
    Mat R1, R2, P1, P2, Q, map1, map2, depth1, depth2, points;
    Vec2d range = Vec2d(550, 1500);

    Dense()
    {
        RNG rng(1);
        left.create(SIZE, CV_8U);
        rng.fill(left, RNG::UNIFORM, 0, 256);
        GaussianBlur(left, left, Size(), 1.2);
        right = Mat::zeros(SIZE, CV_8U);
        left.colRange(100, SIZE.width).copyTo(right.colRange(0, SIZE.width - 100));
        resize(left, halfLeft, HALF, 0, 0, INTER_AREA);
        resize(right, halfRight, HALF, 0, 0, INTER_AREA);
        refractiveStereoRectify(first.camera, second.camera, R, T, SIZE, range, R1, R2, P1, P2, Q);
        const double perInverse = P1.at<double>(0, 3) - P2.at<double>(0, 3);
        disparity.create(SIZE, CV_32F);
        for (int y = 0; y < SIZE.height; y++)
            for (int x = 0; x < SIZE.width; x++)
                disparity.at<float>(y, x) = x < SIZE.width/3 ? std::numeric_limits<float>::quiet_NaN()
                                                             : (float)(perInverse/(900 + 250*std::sin(x/200.)*std::cos(y/150.)));
        resize(disparity, coarse, HALF, 0, 0, INTER_NEAREST);
        coarse *= 0.5;
    }

    void match(int width, const Mat& a, const Mat& b)
    {
        StereoSGBM::create(0, width, 5, 200, 800, 1, 31, 10, 100, 2, StereoSGBM::MODE_SGBM_3WAY)->compute(a, b, fixed);
    }

    void maps(const Mat& d1, const Mat& d2, const Mat& p1, const Mat& p2, Size size)
    {
        initRefractiveStereoRectifyMap(first.camera, d1, R1, p1, noArray(), size, CV_16SC2, map1, map2);
        initRefractiveStereoRectifyMap(second.camera, d2, R2, p2, T, size, CV_16SC2, map1, map2);
    }

    //! Both passes, but for remapping and matching, which are OpenCV's own.
    void rectifyAndReproject(int ddepth)
    {
        refractiveStereoRectify(first.camera, second.camera, R, T, SIZE, range, R1, R2, P1, P2, Q);
        const Mat plane(1, 1, CV_64F, Scalar(2/(1/range[0] + 1/range[1])));
        const Mat smaller = (Mat_<double>(3, 3) << 0.5, 0, -0.25, 0, 0.5, -0.25, 0, 0, 1);
        maps(plane, plane, smaller*P1, smaller*P2, HALF);
        refractiveRectifiedDepth(coarse, P1, P2, SIZE, depth1, depth2);
        maps(depth1, depth2, P1, P2, SIZE);
        refractiveReprojectImageTo3D(disparity, points, first.camera, second.camera, R, T, R1, R2, P1, P2, depth1, depth2, false,
                                     ddepth);
    }
};

//! What float32 loses of the points, relative.
double roundingOf(Dense& d)
{
    Mat single, exact;
    d.rectifyAndReproject(CV_32F);
    d.points.convertTo(single, CV_64F);
    d.rectifyAndReproject(CV_64F);
    double worst = 0;
    for (int y = 0; y < SIZE.height; y++)
        for (int x = 0; x < SIZE.width; x++)
        {
            const Vec3d& X = d.points.at<Vec3d>(y, x);
            if (!std::isnan(X[2]))
                worst = std::max(worst, norm(X - single.at<Vec3d>(y, x))/norm(X));
        }
    return worst;
}

} // namespace

void addStereoRows(std::vector<Row>& rows)
{
    const auto d = std::make_shared<Dense>();
    Row r = { "dense", "1280x1024: rectify, maps, 3-D, 2 passes", "cv::StereoSGBM, both passes", { 0.15, 0.15 }, SIZE.area(), {}, {}, {},
              {}, 0, "relative", 1e-6, {}, {}, {} };
    r.ours = [=] { d->rectifyAndReproject(CV_32F); };
    r.peer = [=] { d->match(DISPARITIES/2, d->halfLeft, d->halfRight); d->match(DISPARITIES, d->left, d->right); };
    r.error = [=] { return roundingOf(*d); };
    rows.push_back(r);
    Row second = { "second", "1280x1024: matching, both passes", "cv::StereoSGBM, one pass", { 1.5, 1.5 }, SIZE.area(), {}, {}, {}, {},
                   0, "", 0, {}, {}, {} };
    second.ours = r.peer;
    second.peer = [=] { d->match(DISPARITIES, d->left, d->right); };
    rows.push_back(second);
}

} // namespace bench
