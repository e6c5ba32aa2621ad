// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "export/seen_points.hpp"
#include "console/failure.hpp"

#include <Eigen/Sparse>
#include <cmath>
#include <cstdio>

namespace tools {

using cv::Mat;
using cv::Point2d;
using cv::Ptr;
using cv::Vec3d;
using cv::refract::RefractiveCamera;

namespace {

using Row = Eigen::Triplet<double>;

struct Grid
{
    int order = 0, nx = 0, ny = 0;
    int fovX = 0;               //!< degrees; mrcal knows whole ones only

    int size() const { return nx*ny; }
    std::string model() const
    {
        return cv::format("LENSMODEL_SPLINED_STEREOGRAPHIC_order=%d_Nx=%d_Ny=%d_fov_x_deg=%d", order, nx, ny, fovX);
    }
};

/* As many control points as the true lens has, over all directions where the scene is, as seen from near the true centre. A window
makes the field another: a port in water, narrower by a third. */
Grid gridFor(const Ptr<RefractiveCamera>& camera, const SeenPoints& seen)
{
    Grid grid;
    if (std::sscanf(camera->lensModel().c_str(), "LENSMODEL_SPLINED_STEREOGRAPHIC_order=%d_Nx=%d_Ny=%d_", &grid.order, &grid.nx,
                    &grid.ny) != 3)
        throw Failure("the lens " + camera->lensModel() + " has no control points");
    const double MARGIN = 1.15;
    double half = 0;            // of the plane of the stereographic projection
    for (const cv::Point3d& X : seen.points)
    {
        const double scale = 2/(cv::norm(X) + X.z);
        half = std::max({half, std::abs(X.x)*scale, std::abs(X.y)*scale*(grid.nx - grid.order)/(grid.ny - grid.order)});
    }
    grid.fovX = (int)std::ceil(4*std::atan(MARGIN*half/2)*180/CV_PI);
    return grid;
}

/* The pixels' squared errors by T and the control points: linear in these, nearly so in T. R stays 1 and the focal lengths what they
were, as the surface takes their place. Which control points a pixel depends on changes with T, for which no fixed structure of
residual blocks, such as Ceres wants, has room: thus Gauss and Newton's own steps over a sparse matrix. */
class SplinedFit
{
public:
    SplinedFit(const Ptr<RefractiveCamera>& camera, const Grid& grid, const SeenPoints& seen)
        : seen_(seen), grid_(grid), size_(camera->imageSize()), unknowns_(Eigen::VectorXd::Zero(3 + 2*grid.size()))
    {
        const Mat K = startingMatrix(*camera);
        core_ = cv::Vec4d(K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2));
    }

    //! Its length, px or the unit of length, whichever is more.
    double step()
    {
        const int controls = (grid_.order + 1)*(grid_.order + 1), smoothness = 4*grid_.size();
        std::vector<Row> rows;
        rows.reserve(seen_.points.size()*2*(controls + 3) + 3*(size_t)smoothness);
        Eigen::VectorXd errors = Eigen::VectorXd::Zero(2*(Eigen::Index)seen_.points.size() + smoothness);
        addPixels(rows, errors);
        addSmoothness(rows, errors);
        Eigen::SparseMatrix<double> J(errors.size(), unknowns_.size());
        J.setFromTriplets(rows.begin(), rows.end());
        const Eigen::SparseMatrix<double> information = J.transpose()*J;
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information);
        const Eigen::VectorXd change = solver.solve(J.transpose()*errors);
        unknowns_ -= change;
        return std::max(change.head(3).cwiseAbs().maxCoeff(), core_[0]*change.tail(2*grid_.size()).cwiseAbs().maxCoeff());
    }

    CentralCamera result() const
    {
        CentralCamera central;
        std::vector<double> intrinsics(core_.val, core_.val + 4);
        intrinsics.insert(intrinsics.end(), unknowns_.data() + 3, unknowns_.data() + unknowns_.size());
        central.camera = RefractiveCamera::createMrcal(grid_.model(), intrinsics);
        central.camera->setImageSize(size_);
        central.pose.T = Vec3d(unknowns_.data());
        return central;
    }

private:
    void addPixels(std::vector<Row>& rows, Eigen::VectorXd& errors) const
    {
        const CentralCamera now = result();
        std::vector<Point2d> pixels;
        Mat status, J, which, weights;
        cv::refract::refractiveProjectPoints(seen_.points, now.pose.R, now.pose.T, now.camera, pixels, status, J);
        cv::refract::refractiveSplineWeights(seen_.points, now.pose.R, now.pose.T, now.camera, which, weights);
        for (int i = 0; i < (int)pixels.size(); i++)
        {
            if (status.at<uchar>(i) != cv::refract::REFRACT_OK)
                continue;           // beyond the control points just now
            const Point2d error = pixels[i] - seen_.pixels[i];
            for (int axis = 0; axis < 2; axis++)
            {
                const int row = 2*i + axis;
                errors[row] = axis == 0 ? error.x : error.y;
                for (int k = 0; k < 3; k++)
                    rows.emplace_back(row, k, J.at<double>(row, 3 + k));
                for (int k = 0; k < which.cols; k++)
                    rows.emplace_back(row, 3 + 2*which.at<int>(i, k) + axis, core_[axis]*weights.at<double>(i, k));
            }
        }
    }

    //! Second differences of the control points, so weak that they only say what those are that no pixel needs.
    void addSmoothness(std::vector<Row>& rows, Eigen::VectorXd& errors) const
    {
        const double WEAK = 1e-3;
        auto row = (int)(2*seen_.points.size());
        for (int y = 0; y < grid_.ny; y++)
            for (int x = 0; x < grid_.nx; x++)
                for (int axis = 0; axis < 2; axis++, row += 2)
                {
                    const int column = 3 + 2*(y*grid_.nx + x) + axis;
                    if (x > 0 && x + 1 < grid_.nx)
                        addBend(row, column, 2, WEAK*core_[axis], rows, errors);
                    if (y > 0 && y + 1 < grid_.ny)
                        addBend(row + 1, column, 2*grid_.nx, WEAK*core_[axis], rows, errors);
                }
    }

    void addBend(int row, int column, int apart, double weight, std::vector<Row>& rows, Eigen::VectorXd& errors) const
    {
        for (const int side : {-1, 0, 1})
        {
            const double slope = weight*(side == 0 ? -2 : 1);
            rows.emplace_back(row, column + side*apart, slope);
            errors[row] += slope*unknowns_[column + side*apart];
        }
    }

    const SeenPoints& seen_;
    const Grid grid_;
    const cv::Size size_;
    cv::Vec4d core_;                //!< fx, fy, cx, cy
    Eigen::VectorXd unknowns_;      //!< T, control points
};

//! A camera without a window is its own central camera.
CentralCamera itself(const Ptr<RefractiveCamera>& camera, const SeenPoints& tested)
{
    CentralCamera central = { camera->clone(), RigidTransform(), CentralError() };
    central.error = errorOf(tested, central);
    return central;
}

} // namespace

CentralCamera fitCentralSplined(const Ptr<RefractiveCamera>& camera, const cv::Vec2d& range, const std::string& name)
{
    const SeenPoints tested = seenPoints(camera, range, 40, 30, 12);
    const cv::refract::GlassWindow window = camera->window();
    if (window.thickness.empty() && window.innerIndex == window.outerIndex)
        return itself(camera, tested);
    requireEnough(tested, range, name);
    const Grid grid = gridFor(camera, tested);
    const int PER_CELL = 2, DEPTHS = 5, ENOUGH = 30;
    const SeenPoints fitted = seenPoints(camera, range, PER_CELL*grid.nx + 1, PER_CELL*grid.ny + 1, DEPTHS);
    SplinedFit fit(camera, grid, fitted);
    double step = HUGE_VAL;
    for (int i = 0; i < ENOUGH && !(step < 1e-6); i++)
        step = fit.step();
    if (!(step < 1e-3))
        throw Failure("no splined central camera comes near " + name + " over the whole image: give a range farther from the window");
    CentralCamera central = fit.result();
    central.error = errorOf(tested, central);       // elsewhere, too
    return central;
}

} // namespace tools
