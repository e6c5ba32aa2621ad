// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "colmap/scene_depth.hpp"
#include "console/numbers.hpp"
#include <opencv2/imgproc.hpp>
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

const int CELL = 16;            // px

/** 1/z = p0 + p1 x + p2 y, where x, y are -1 ... 1; of few points it is their median. Points far off it have little say: a wrong one near
the camera has a 1/z above all others. */
Vec3d planeOf(const std::vector<Point2d>& pixels, const std::vector<double>& inverses, Size size)
{
    const int FEW = 8, ROUNDS = 10, count = (int)pixels.size();
    const Vec3d start(median(inverses), 0., 0.);
    if (count < FEW)
        return start;
    Mat A(count, 3, CV_64F), b(inverses, true), residuals, solution = Mat(start, true);
    for (int i = 0; i < count; i++)
    {
        A.at<double>(i, 0) = 1.;
        A.at<double>(i, 1) = 2.*pixels[i].x/size.width - 1.;
        A.at<double>(i, 2) = 2.*pixels[i].y/size.height - 1.;
    }
    for (int round = 0; round < ROUNDS; round++)
    {
        residuals = cv::abs(A*solution - b);
        const double scale = median(std::vector<double>(residuals.begin<double>(), residuals.end<double>()));
        Mat weights = 1./(residuals + std::max(scale, 1e-9*std::abs(start[0])));
        cv::sqrt(weights, weights);
        solve(A.mul(repeat(weights, 1, 3)), b.mul(weights), solution, DECOMP_SVD);
    }
    return Vec3d(solution.ptr<double>());
}

double valueAt(const Vec3d& plane, double x, double y, Size size)
{
    return plane[0] + plane[1]*(2.*x/size.width - 1.) + plane[2]*(2.*y/size.height - 1.);
}

//! Where there is no weight, as around it: from coarser to finer cells.
Mat filled(const Mat& sums, const Mat& weights)
{
    const double LITTLE = 0.25;             // of a point: cells with one hardly heed their neighbours
    if (sums.rows == 1 && sums.cols == 1)
        return sums/std::max(weights.at<double>(0), 1e-12);
    const Size half((sums.cols + 1)/2, (sums.rows + 1)/2);
    Mat evenSums, evenWeights, coarse;
    copyMakeBorder(sums, evenSums, 0, 2*half.height - sums.rows, 0, 2*half.width - sums.cols, BORDER_CONSTANT, Scalar(0));
    copyMakeBorder(weights, evenWeights, 0, 2*half.height - sums.rows, 0, 2*half.width - sums.cols, BORDER_CONSTANT, Scalar(0));
    resize(evenSums, coarse, half, 0, 0, INTER_AREA);
    Mat coarseWeights;
    resize(evenWeights, coarseWeights, half, 0, 0, INTER_AREA);
    Mat around;
    resize(filled(4*coarse, 4*coarseWeights), around, evenSums.size(), 0, 0, INTER_LINEAR);
    around = around(Rect(0, 0, sums.cols, sums.rows));
    Mat numerator = sums + LITTLE*around, denominator = weights + LITTLE;
    return numerator/denominator;
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

Point depthCellOf(const Point2d& pixel, Size size)
{
    const auto clamped = [](double x, int length) { return (int)std::min(std::max(x, 0.), length - 1.)/CELL; };
    return {clamped(pixel.x, size.width), clamped(pixel.y, size.height)};
}

Mat_<double> sceneDepth(const std::vector<Point2d>& all, const std::vector<double>& depths, Size size)
{
    // What is far beside the image is wrong, and would hold the plane.
    std::vector<Point2d> pixels;
    std::vector<double> inverses;
    for (size_t i = 0; i < all.size(); i++)
        if (std::abs(all[i].x) < 2.*size.width && std::abs(all[i].y) < 2.*size.height)
        {
            pixels.push_back(all[i]);
            inverses.push_back(1./depths[i]);
        }
    if (pixels.empty())
        return Mat_<double>(size, median(depths));
    const Vec3d plane = planeOf(pixels, inverses, size);
    const Size cells((size.width + CELL - 1)/CELL, (size.height + CELL - 1)/CELL);
    std::vector<std::vector<double>> ofCells((size_t)cells.area());
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Point cell = depthCellOf(pixels[i], size);
        ofCells[cell.y*cells.width + cell.x].push_back(inverses[i] - valueAt(plane, pixels[i].x, pixels[i].y, size));
    }
    Mat_<double> sums(cells, 0.), weights(cells, 0.);
    for (int i = 0; i < cells.area(); i++)
        if (!ofCells[i].empty())
        {
            weights(i/cells.width, i % cells.width) = (double)ofCells[i].size();
            sums(i/cells.width, i % cells.width) = (double)ofCells[i].size()*median(ofCells[i]);
        }
    Mat off;
    resize(filled(sums, weights), off, Size(cells.width*CELL, cells.height*CELL), 0, 0, INTER_LINEAR);
    const auto range = std::minmax_element(depths.begin(), depths.end());
    Mat_<double> depth(size);
    for (int y = 0; y < size.height; y++)
        for (int x = 0; x < size.width; x++)
        {
            const double inverse = valueAt(plane, x, y, size) + off.at<double>(y, x);
            depth(y, x) = inverse > 0 ? std::min(std::max(1./inverse, *range.first), *range.second) : *range.second;
        }
    return depth;
}

} // namespace tools
