// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/central_camera.hpp"
#include "console/cli.hpp"

#include <ceres/ceres.h>
#include <opencv2/calib3d.hpp>
#include <cmath>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point3d;
using cv::Ptr;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

namespace {

//! Scene points, camera frame, and the pixels where they are seen.
struct Sample
{
    std::vector<Point3d> points;
    std::vector<Point2d> pixels;
};

//! Pixels all over the image, seen at depths whose inverses are evenly spaced.
Sample sampleRange(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int columns, int rows, int depths)
{
    const cv::Size size = camera->imageSize();
    std::vector<Point2d> grid;
    for (int i = 0; i < columns*rows; i++)
        grid.emplace_back((i % columns)*(size.width - 1.)/(columns - 1), (i/columns)*(size.height - 1.)/(rows - 1));
    Sample sample;
    for (int k = 0; k < depths; k++)
    {
        const double part = k/(depths - 1.), z = 1/((1 - part)/range[0] + part/range[1]);
        std::vector<Point3d> seen;
        cv::refract::refractivePointsOnPlane(grid, seen, camera, cv::Vec4d(0, 0, 1, z));
        for (size_t i = 0; i < grid.size(); i++)
            if (seen[i].z == seen[i].z)
            {
                sample.points.push_back(seen[i]);
                sample.pixels.push_back(grid[i]);
            }
    }
    return sample;
}

//! All pixels' errors by (rvec, tvec, lens), of a camera without a window.
class CentralResidual : public ceres::CostFunction
{
public:
    CentralResidual(const Sample& sample, const Ptr<RefractiveCamera>& model)
        : sample_(sample), model_(model->clone()), lens_((int)model->lensParameters().total())
    {
        set_num_residuals(2*(int)sample.points.size());
        for (int size : {3, 3, lens_})
            mutable_parameter_block_sizes()->push_back(size);
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override
    {
        const Ptr<RefractiveCamera> camera = model_->clone();
        camera->setLensParameters(Mat(lens_, 1, CV_64F, const_cast<double*>(parameters[2])));
        std::vector<Point2d> seen;
        Mat J, status;
        cv::refract::refractiveProjectPoints(sample_.points, Vec3d(parameters[0]), Vec3d(parameters[1]), camera, seen, status, J);
        if (cv::countNonZero(status) > 0)
            return false;       // too far: a shorter step may do
        for (int i = 0; i < (int)seen.size(); i++)
        {
            residuals[2*i] = seen[i].x - sample_.pixels[i].x;
            residuals[2*i + 1] = seen[i].y - sample_.pixels[i].y;
        }
        const int first[] = {0, 3, 6}, size[] = {3, 3, lens_};
        for (int block = 0; block < 3 && jacobians; block++)
            if (jacobians[block])
                J.colRange(first[block], first[block] + size[block]).copyTo(Mat(J.rows, size[block], CV_64F, jacobians[block]));
        return true;
    }

private:
    const Sample& sample_;
    Ptr<RefractiveCamera> model_;
    int lens_;
};

/* The true lens, as if the window's outer medium were all round: a flat port makes the focal length longer by the ratio of the
indices. Distortion begins at zero: that of the lens is another behind a port. */
Ptr<RefractiveCamera> startOf(const Ptr<RefractiveCamera>& camera, int coefficients)
{
    const cv::refract::GlassWindow window = camera->window();
    Mat K = camera->cameraMatrix().clone();
    K.rowRange(0, 2).colRange(0, 2) *= window.outerIndex/window.innerIndex;
    const bool isFisheye = coefficients == 0;
    const Mat none = Mat::zeros(isFisheye ? 4 : coefficients, 1, CV_64F);
    const Ptr<RefractiveCamera> start = isFisheye ? RefractiveCamera::createFisheye(K, none) : RefractiveCamera::create(K, none);
    start->setImageSize(camera->imageSize());
    return start;
}

void fit(const Sample& sample, CentralCamera& central, const std::string& name)
{
    Vec3d rvec, tvec;
    Mat lens = central.camera->lensParameters().clone();
    ceres::Problem problem;
    problem.AddResidualBlock(new CentralResidual(sample, central.camera), nullptr, rvec.val, tvec.val, lens.ptr<double>());
    ceres::Solver::Options options;
    options.max_num_iterations = 1000;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-15;     // exact pixels, long valleys
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable())
        throw Failure("no central camera comes near " + name + " over the whole image: its lens is too wide for this "
                      "lens model, or give a range farther from the window");
    central.camera->setLensParameters(lens);
    Mat R;
    cv::Rodrigues(rvec, R);
    central.R = cv::Matx33d(R.ptr<double>());
    central.T = tvec;
}

CentralError errorOf(const Sample& sample, const CentralCamera& central)
{
    std::vector<Point2d> seen;
    std::vector<Vec3d> origins, directions;
    cv::refract::refractiveProjectPoints(sample.points, central.R, central.T, central.camera, seen);
    cv::refract::refractiveUnprojectPoints(sample.pixels, origins, directions, central.camera);
    CentralError e;
    const auto n = (double)sample.points.size();
    const cv::Matx33d back = central.R.t();
    for (size_t i = 0; i < sample.points.size(); i++)
    {
        // Where the ray that the central camera takes the pixel for passes the depth of the point.
        const Vec3d centre = back*(origins[i] - central.T), along = back*directions[i], X = sample.points[i];
        const double length = cv::norm(centre + along*((X[2] - centre[2])/along[2]) - X);
        const double px = cv::norm(seen[i] - sample.pixels[i]);
        // NaN counts as the worst there can be
        e.max = px <= e.max ? e.max : px;
        e.lengthMax = length <= e.lengthMax ? e.lengthMax : length;
        e.rms += px*px/n;
        e.lengthRms += length*length/n;
    }
    e.rms = std::sqrt(e.rms);
    e.lengthRms = std::sqrt(e.lengthRms);
    return e;
}

} // namespace

CentralCamera fitCentralCamera(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int coefficients,
                               const std::string& name)
{
    const Sample fitted = sampleRange(camera, range, 25, 19, 7);
    const size_t FEWEST = 100;
    if (fitted.points.size() < FEWEST)
        throw Failure(cv::format("%s sees next to nothing between z = %g and %g: give a range beyond its window", name.c_str(),
                                 range[0], range[1]));
    CentralCamera central;
    central.camera = startOf(camera, coefficients);
    fit(fitted, central, name);
    central.error = errorOf(sampleRange(camera, range, 40, 30, 12), central);       // elsewhere, too
    return central;
}

} // namespace tools
