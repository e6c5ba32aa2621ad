// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/point_kernels.hpp"
#include "points/triangulate.hpp"

/* The maximum-likelihood point minimises the sum of squared pixel errors in all raw images, by Gauss-Newton with exact
derivatives: many points side by side, and the few that this leaves one by one. */

namespace cv { namespace refract {

namespace {

//! The least squares of linear errors, also where rays are so parallel that the normal equations would not know.
Vec3d gaussNewtonStep(const PointImages& images)
{
    const int rows = (int)images.errors.size();
    const Mat J(rows, 3, CV_64F, const_cast<Vec3d*>(images.byPoint.data()));
    Vec3d step;
    solve(J, Mat(rows, 1, CV_64F, const_cast<double*>(images.errors.data())), step, DECOMP_SVD);
    return -step;
}

//! Whether the images determine the point: their derivatives have three singular values that are not rounding.
bool isDetermined(const PointImages& images)
{
    const double ROUNDING = 1e-10;
    Mat values;
    SVD::compute(Mat((int)images.errors.size(), 3, CV_64F, const_cast<Vec3d*>(images.byPoint.data())), values, SVD::NO_UV);
    return values.at<double>(2) > ROUNDING*values.at<double>(0);
}

/* Far from the minimum a step must reduce the cost; near it full Gauss-Newton steps converge, and the cost, whose
changes drown in rounding there, is not asked. */
uchar refine(const PlacedCameras& cameras, const PixelBlock& block, int i, Vec3d& X)
{
    const double NEAR = 1e-3, DONE = 1e-11, ROUNDING = 1e-6;        // pixels that a step moves the images
    PointImages here((int)cameras.size()), there = here;
    uchar status = projectIntoAll(cameras, block, i, X, here);
    if (status != REFRACT_OK)
        return status;
    double last = DBL_MAX;
    for (int iteration = 0; iteration < 100; iteration++)
    {
        Vec3d move = gaussNewtonStep(here);
        double square = 0;
        for (const Vec3d& row : here.byPoint)
            square += row.dot(move)*row.dot(move);
        const double moved = std::sqrt(square);
        bool taken = false;
        for (int cut = 0; cut < 40 && !taken; cut++, move *= 0.5)
        {
            taken = projectIntoAll(cameras, block, i, X + move, there) == REFRACT_OK
                    && (moved < NEAR || norm(there.errors) < norm(here.errors));
            if (taken)
            {
                X += move;
                std::swap(here, there);
            }
        }
        if (!taken)
            return REFRACT_NOT_CONVERGED;
        if (moved <= DONE || (moved <= ROUNDING && moved >= 0.5*last))
            return isDetermined(here) ? REFRACT_OK : REFRACT_PARALLEL_RAYS;     // also the likeliest point at infinity
        last = moved;
    }
    return REFRACT_NOT_CONVERGED;
}

//! What one camera predicts for a block of points.
struct Prediction
{
    double pixels[2*BLOCK], byPoint[6*BLOCK];
};

/* Full Gauss-Newton steps of all lanes side by side. They converge at a rate that the sum of squares leaves small; a lane
whose moves shrink so fast that less than DONE pixels are left has arrived, and one that moved by less than `enough` pixels,
any other is left where it was, for refine(). Tells which lanes have arrived. */
class TogetherRefinement
{
public:
    TogetherRefinement(const PlacedCameras& cameras, const PixelBlock& block, int n)
        : cameras_(cameras), block_(block), n_(n), predictions_(cameras.size()), errors_(cameras.size())
    {
        CV_Assert(n > 0 && n <= BLOCK);
        std::copy(block.x, block.x + n, x_); std::copy(block.y, block.y + n, y_); std::copy(block.z, block.z + n, z_);
        std::copy(block.status, block.status + n, status_);
    }

    void run(PixelBlock& block, const double* off, double enough, uchar* arrived)
    {
        const double DONE = 1e-11, SHRINK = 0.01;
        const int STEPS = 6;
        double moved[BLOCK], last[BLOCK];
        int missing = 0;
        for (int i = 0; i < n_; i++)
        {
            arrived[i] = off[i] == 0;
            last[i] = off[i]*off[i]/SHRINK;
            missing += !arrived[i] && status_[i] == REFRACT_OK;
        }
        for (int k = 0; k < STEPS && missing > 0; k++)
        {
            step(moved);
            missing = 0;
            for (int i = 0; i < n_; i++)
            {
                // What is left after moves of a, then b: about b^2/a. Squares throughout.
                const bool shrinks = moved[i] <= SHRINK*last[i] && status_[i] == REFRACT_OK;
                const bool done = shrinks && (moved[i]*moved[i] <= DONE*DONE*last[i] || moved[i] < enough*enough);
                if (done && !arrived[i])
                {
                    block.x[i] = x_[i]; block.y[i] = y_[i]; block.z[i] = z_[i];
                    arrived[i] = true;
                }
                if (!shrinks && status_[i] == REFRACT_OK)
                    status_[i] = REFRACT_NOT_CONVERGED;
                missing += !arrived[i] && status_[i] == REFRACT_OK;
                last[i] = moved[i];
            }
        }
    }

private:
    void step(double* moved)
    {
        int count = 0;
        for (int c = 0; c < (int)cameras_.size(); c++)
            if (block_.sees[c] != PixelBlock::NONE)
                errors_[count++] = errorsOf(c);
        pointKernels().gaussNewton(n_, count, errors_.data(), x_, y_, z_, moved);
    }

    CameraErrors errorsOf(int c)
    {
        const PlacedCamera& camera = cameras_[c];
        Prediction& p = predictions_[c];
        const Columns observed = { const_cast<double*>(block_.pixel(2*c)), 1, BLOCK }, predicted = { p.pixels, 1, BLOCK };
        const Columns byPoint = { p.byPoint, 3, BLOCK }, none = { NULL, 0, 0 };
        double x[BLOCK], y[BLOCK], z[BLOCK];
        const double *px = x_, *py = y_, *pz = z_;
        if (c > 0)
        {
            std::copy(x_, x_ + n_, x); std::copy(y_, y_ + n_, y); std::copy(z_, z_ + n_, z);
            pointKernels().transform(camera.place.R.val, camera.place.t.val, n_, x, y, z);
            px = x; py = y; pz = z;
        }
        forSeen(block_, c, n_, status_, [&](uchar* status)
        { camera.camera->projectJacobian(n_, px, py, pz, p.pixels, p.pixels + BLOCK, byPoint, none, status); });
        return { c > 0 ? camera.place.R.val : NULL, observed, predicted, byPoint, whiteningOf(c) };
    }

    //! As the kernel takes it: null if no covariances were given.
    Columns whiteningOf(int c)
    {
        if (block_.whitening.empty())
            return { NULL, 0, 0 };
        whitening_.resize(3*BLOCK*cameras_.size());
        const Columns W = { &whitening_[(size_t)3*BLOCK*c], 1, BLOCK };
        for (int i = 0; i < n_; i++)
        {
            const Whitening& own = block_.whiteningOf(c, i);
            W.at(0, 0)[i] = own.uu; W.at(1, 0)[i] = own.vu; W.at(2, 0)[i] = own.vv;
        }
        return W;
    }

    const PlacedCameras& cameras_;
    const PixelBlock& block_;
    const int n_;
    AutoBuffer<Prediction, 4> predictions_;
    AutoBuffer<CameraErrors, 16> errors_;
    std::vector<double> whitening_;
    double x_[BLOCK], y_[BLOCK], z_[BLOCK];
    uchar status_[BLOCK];
};

} // namespace

//! Of half a pixel one is NaN.
static double lengthOf(double du, double dv)
{
    return std::isnan(du) ? std::abs(dv) : std::isnan(dv) ? std::abs(du) : std::hypot(du, dv);
}

void reprojectionErrors(const PlacedCameras& cameras, const PixelBlock& block, int n, double* errors)
{
    const int count = (int)cameras.size();
    for (int c = 0; c < count; c++)
    {
        const double *u = block.pixel(2*c), *v = block.pixel(2*c + 1);
        double x[BLOCK], y[BLOCK], z[BLOCK], predictedU[BLOCK], predictedV[BLOCK];
        uchar status[BLOCK];
        std::copy(block.x, block.x + n, x); std::copy(block.y, block.y + n, y); std::copy(block.z, block.z + n, z);
        for (int i = 0; i < n; i++)         // a point that the camera does not see counts as failed already
            status[i] = block.isSeen(c, i) ? block.status[i] : (uchar)REFRACT_TOO_FEW_VIEWS;
        pointKernels().transform(cameras[c].place.R.val, cameras[c].place.t.val, n, x, y, z);
        cameras[c].camera->project(n, x, y, z, NULL, predictedU, predictedV, status);
        for (int i = 0; i < n; i++)
            errors[i*count + c] = status[i] == REFRACT_OK ? lengthOf(predictedU[i] - u[i], predictedV[i] - v[i])
                                                          : std::numeric_limits<double>::quiet_NaN();
    }
}

void refineBlock(const PlacedCameras& cameras, PixelBlock& block, int n, const double* off, double enough)
{
    uchar arrived[BLOCK];
    TogetherRefinement(cameras, block, n).run(block, off, enough, arrived);
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK && !arrived[i])
        {
            Vec3d X(block.x[i], block.y[i], block.z[i]);
            block.status[i] = refine(cameras, block, i, X);
            block.x[i] = X[0]; block.y[i] = X[1]; block.z[i] = X[2];
        }
    checkBeyond(cameras, block, n);
}

}} // namespace
