// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/seen_points.hpp"
#include "console/failure.hpp"

#include <ceres/ceres.h>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Ptr;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

namespace {

//! All pixels' errors by (rvec, tvec, lens), of a camera without a window.
class CentralResidual : public ceres::CostFunction
{
public:
    CentralResidual(const SeenPoints& sample, const Ptr<RefractiveCamera>& model)
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
    const SeenPoints& sample_;
    Ptr<RefractiveCamera> model_;
    int lens_;
};

//! Distortion begins at zero: that of the lens is another behind a port.
Ptr<RefractiveCamera> startOf(const Ptr<RefractiveCamera>& camera, int coefficients)
{
    const Mat K = startingMatrix(*camera);
    const bool isFisheye = coefficients == 0;
    const Mat none = Mat::zeros(isFisheye ? 4 : coefficients, 1, CV_64F);
    const Ptr<RefractiveCamera> start = isFisheye ? RefractiveCamera::createFisheye(K, none) : RefractiveCamera::create(K, none);
    start->setImageSize(camera->imageSize());
    return start;
}

SeenPoints testPoints(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range) { return seenPoints(camera, range, 40, 30, 12); }

void fit(const SeenPoints& sample, CentralCamera& central, const std::string& name)
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
    central.pose = transformOf(rvec, tvec);
}

} // namespace

CentralCamera fitCentralCamera(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int coefficients,
                               const std::string& name)
{
    const SeenPoints fitted = seenPoints(camera, range, 25, 19, 7);
    requireEnough(fitted, range, name);
    CentralCamera central;
    central.camera = startOf(camera, coefficients);
    fit(fitted, central, name);
    central.error = errorOf(testPoints(camera, range), central);        // elsewhere, too
    return central;
}

CentralCamera centralCamera(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range)
{
    CentralCamera central = { camera->clone(), RigidTransform(), CentralError() };
    central.error = errorOf(testPoints(camera, range), central);
    return central;
}

} // namespace tools
