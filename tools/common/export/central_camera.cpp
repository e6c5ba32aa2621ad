// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/central_camera.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include <ceres/ceres.h>
#include <opencv2/core.hpp>
#include <cmath>
#include <limits>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Point3d;
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

/** Where a fit begins: the true camera matrix, as if the window's outer medium were all round. A flat port makes the focal length
longer by the ratio of the indices. */
cv::Mat startingMatrix(const RefractiveCamera& camera)
{
    const cv::refract::GlassWindow window = camera.window();
    cv::Mat K = camera.cameraMatrix().clone();
    if (!isRound(window))           // a dome magnifies nothing, seen from its centre
        K.rowRange(0, 2).colRange(0, 2) *= window.outerIndex/window.innerIndex;
    return K;
}

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

//! @return whether it found a minimum
bool fit(const SeenPoints& sample, CentralCamera& central)
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
        return false;
    central.camera->setLensParameters(lens);
    central.pose = transformOf(rvec, tvec);
    return true;
}

} // namespace

//! Nearly all pixels see z beyond the window; not all of a wide lens do, which looks along a tilted one.
static bool isBeyondWindow(const Ptr<RefractiveCamera>& camera, const std::vector<Point2d>& pixels, double z)
{
    const WindowFace last = WindowFace::last(camera->window());
    std::vector<Vec3d> origins, directions;
    cv::refract::refractiveUnprojectPoints(pixels, origins, directions, camera);
    size_t forward = 0, within = 0;
    for (size_t i = 0; i < pixels.size(); i++)
        if (directions[i][2] > 0)
        {
            const Vec3d X = origins[i] + (z - origins[i][2])/directions[i][2]*directions[i];
            forward++;
            within += last.isBefore(X);
        }
    return 10*within <= forward;
}

SeenPoints seenPoints(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int columns, int rows, int depths)
{
    const cv::Size size = camera->imageSize();
    std::vector<Point2d> grid;
    for (int i = 0; i < columns*rows; i++)
        grid.emplace_back((i % columns)*(size.width - 1.)/(columns - 1), (i/columns)*(size.height - 1.)/(rows - 1));
    SeenPoints all;
    for (int k = 0; k < depths; k++)
    {
        const double part = k/(depths - 1.), z = 1/((1 - part)/range[0] + part/range[1]);
        std::vector<Point3d> seen;
        cv::refract::refractivePointsOnPlane(grid, seen, camera, cv::Vec4d(0, 0, 1, z));
        for (size_t i = 0; i < grid.size(); i++)
            if (seen[i].z == seen[i].z)
            {
                all.points.push_back(seen[i]);
                all.pixels.push_back(grid[i]);
            }
    }
    all.allBeyondWindow = isBeyondWindow(camera, grid, range[0]);
    return all;
}

void requireEnough(const SeenPoints& seen, const cv::Vec2d& range, const std::string& name)
{
    const size_t FEWEST = 100;
    if (seen.points.size() < FEWEST || !seen.allBeyondWindow)
        throw Failure(cv::format("%s sees little or nothing of z = %g to %g: give a range beyond its window", name.c_str(),
                                 range[0], range[1]));
}

CentralError errorOf(const SeenPoints& sample, const cv::Vec2d& range, const CentralCamera& central)
{
    const double WITHIN = 2;        // times the far end: all that a lens of 120 degrees sees there
    std::vector<Point2d> seen;
    std::vector<Vec3d> origins, directions;
    cv::refract::refractiveProjectPoints(sample.points, central.pose.R, central.pose.t, central.camera, seen);
    cv::refract::refractiveUnprojectPoints(sample.pixels, origins, directions, central.camera);
    CentralError e;
    const auto n = (double)sample.points.size();
    int near = 0;
    const cv::Matx33d back = central.pose.R.t();
    for (size_t i = 0; i < sample.points.size(); i++)
    {
        const double px = cv::norm(seen[i] - sample.pixels[i]);
        // NaN counts as the worst there can be
        e.max = px <= e.max ? e.max : px;
        e.rms += px*px/n;
        const Vec3d X = sample.points[i];
        if (cv::norm(X) > WITHIN*range[1])
            continue;
        // From the ray that the central camera takes the pixel for.
        const double length = cv::norm((X - central.pose.inverse(origins[i])).cross(cv::normalize(back*directions[i])));
        e.lengthMax = length <= e.lengthMax ? e.lengthMax : length;
        e.lengthRms += length*length;
        near++;
    }
    e.rms = std::sqrt(e.rms);
    e.lengthRms = std::sqrt(e.lengthRms/near);
    return e;
}

CentralCamera fitCentralCamera(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, int coefficients,
                               const std::string& name)
{
    const SeenPoints fitted = seenPoints(camera, range, 25, 19, 7);
    requireEnough(fitted, range, name);
    CentralCamera central;
    central.camera = startOf(camera, coefficients);
    if (fit(fitted, central))
        central.error = errorOf(testPoints(camera, range), range, central);     // elsewhere, too
    else
        central.error.rms = central.error.max = std::numeric_limits<double>::quiet_NaN();
    return central;
}

void requireNear(const CentralCamera& central, const std::string& name)
{
    const cv::Size size = central.camera->imageSize();
    if (central.error.max <= std::hypot(size.width, size.height))
        return;                     // not, too, if it is NaN
    const bool isFisheye = central.camera->lensModel() == "fisheye";
    throw Failure("no central camera comes near " + name + " over the whole image: its lens is too wide for "
                  + (isFisheye ? "the fisheye model" : "a model without a fisheye's angles; take one with them (--to=opencv, ros or "
                     "colmap, with --coefficients=0)") + ", or give a range farther from the window");
}

CentralCamera centralCamera(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range)
{
    CentralCamera central = { camera->clone(), RigidTransform(), CentralError() };
    central.error = errorOf(testPoints(camera, range), range, central);
    return central;
}

std::string errorText(const CentralRig& rig, const ExportedCamera& camera)
{
    const CentralError& e = camera.central.error;
    const std::string unit = rig.unit.empty() ? "" : " " + rig.unit;
    return cv::format("rms %.3g px, max %.3g px; as length rms %.3g%s, max %.3g%s", e.rms, e.max, e.lengthRms, unit.c_str(),
                      e.lengthMax, unit.c_str());
}

std::string headText(const CentralRig& rig)
{
    return cv::format("central camera(s) nearest to '%s' for z = %g ... %g before each camera: an approximation, only there",
                      rig.source.c_str(), rig.range[0], rig.range[1]);
}

} // namespace tools
