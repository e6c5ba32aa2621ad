// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/nearest_pinhole.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const int LENS = 8;             // fx fy cx cy and four coefficients
const int FIRST = 6;            // column of the jacobian: after rvec, tvec

//! The start: as the camera is in the middle of its image. @param scale of its focal length
Ptr<RefractiveCamera> startOf(const RefractiveCamera& camera, double scale)
{
    const Mat lens = camera.lensParameters();
    const double* const p = lens.ptr<double>();
    const Matx33d K(scale*p[0], 0, p[2], 0, scale*p[1], p[3], 0, 0, 1);
    const Mat none = Mat::zeros(4, 1, CV_64F);
    const Ptr<RefractiveCamera> start = camera.lensModel() == "fisheye" ? RefractiveCamera::createFisheye(K, none)
                                                                        : RefractiveCamera::create(K, none);
    start->setImageSize(camera.imageSize());
    return start;
}

//! Seen minus modelled; J of the lens. Points without a pixel count nothing.
Mat residualsOf(const Ptr<RefractiveCamera>& pinhole, const std::vector<Point3d>& points,
                const std::vector<Point2d>& pixels, Mat& J)
{
    std::vector<Point2d> modelled;
    Mat status, all;
    refractiveProjectPoints(points, Vec3d(), Vec3d(), pinhole, modelled, status, all);
    J = all.colRange(FIRST, FIRST + LENS).clone();
    Mat residuals((int)points.size()*2, 1, CV_64F, Scalar(0));
    for (int i = 0; i < (int)points.size(); i++)
    {
        const Point2d off = pixels[i] - modelled[i];
        if (std::isfinite(off.x + off.y))
        {
            residuals.at<double>(2*i) = off.x;
            residuals.at<double>(2*i + 1) = off.y;
        }
        else
            J.rowRange(2*i, 2*i + 2) = 0.;
    }
    return residuals;
}

} // namespace

NearestPinhole nearestPinhole(const Ptr<RefractiveCamera>& camera, const std::vector<Point3d>& points)
{
    const size_t MOST = 20000;
    const GlassWindow window = camera->window();
    NearestPinhole nearest;
    nearest.camera = startOf(*camera, window.outerIndex/window.innerIndex);
    std::vector<Point3d> some;
    for (size_t i = 0; i < points.size(); i += 1 + points.size()/MOST)
        if (std::isfinite(points[i].x))
            some.push_back(points[i]);
    if ((int)some.size() < LENS)
        return nearest;
    std::vector<Point2d> pixels;
    refractiveProjectPoints(some, Vec3d(), Vec3d(), camera, pixels);
    Mat J, step;
    for (int iteration = 0; iteration < 20; iteration++)
    {
        const Mat r = residualsOf(nearest.camera, some, pixels, J);
        Mat scale(LENS, 1, CV_64F);
        for (int k = 0; k < LENS; k++)
        {
            scale.at<double>(k) = 1./std::max(norm(J.col(k)), 1e-12);
            J.col(k) *= scale.at<double>(k);
        }
        solve(J, r, step, DECOMP_SVD);
        nearest.camera->setLensParameters(nearest.camera->lensParameters() + step.mul(scale));
    }
    const Mat r = residualsOf(nearest.camera, some, pixels, J);
    for (int i = 0; i < r.rows; i += 2)
        nearest.max = std::max(nearest.max, std::hypot(r.at<double>(i), r.at<double>(i + 1)));
    nearest.rms = norm(r)/std::sqrt((double)some.size());
    return nearest;
}

} // namespace tools
