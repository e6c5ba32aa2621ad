// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/triangulate.hpp"
#include "math/covariance_matrix.hpp"
#include "math/rotation.hpp"
#include "points/point_kernels.hpp"

/* Covariance of the maximum-likelihood point: J^+ (S + P C P^T) J^+^T, from the covariance S of the pixels and C of the
calibration; J and P are the derivatives of all pixels by the point and by the parameters. Zero where a camera does not see the
point; whitened where the pixels have covariances, so that S is that of usual ones. */

namespace cv { namespace refract {

PointCovariance::PointCovariance(const PlacedCameras& cameras, InputArray calibration)
    : cameras_(cameras), parameters_(cameras.size())
{
    const int count = (int)cameras.size();
    int total = 0;
    for (int c = 0; c < count; c++)
    {
        Parameters& p = parameters_[c];
        p.lensAndWindow = cameras[c].camera->parameterCount();
        p.count = p.lensAndWindow + (c > 0 ? 6 : 0);
        rotationMatrix(rotationVector(cameras[c].place.R), p.dR);
        for (int k = 0; k < p.lensAndWindow; k++)
            p.index.push_back(total++);
    }
    for (int c = 1; c < count; c++)
        for (int k = 0; k < 6; k++)
            parameters_[c].index.push_back(total++);
    std::vector<double> values = readNumbers(calibration, "calibrationCovariance");
    if (values.empty())
        return;
    if (values.size() != (size_t)total*total)
        CV_Error_(Error::StsBadSize, ("calibrationCovariance has %d values; it must be %dx%d", (int)values.size(), total, total));
    const Mat_<double> C(total, total, values.data());
    checkCovariance(C, "calibrationCovariance");
    for (Parameters& p : parameters_)
    {
        const std::vector<int> all = p.index;
        p.index.clear();
        for (int k = 0; k < p.count; k++)
            if (C(all[k], all[k]) != 0)
            {
                p.uncertain.push_back(k);
                p.index.push_back(all[k]);
            }
    }
    for (int a = 0; a < count; a++)
        for (int b = 0; b <= a; b++)
        {
            std::vector<double> pair;
            for (int i : parameters_[a].index)
                for (int j : parameters_[b].index)
                    pair.push_back(a != b || j < i ? C(i, j) : i == j ? C(i, i)/2 : 0);
            covariance_.push_back(pair);
        }
}

//! What evaluate() works on; the cameras that see none of the points are left out.
struct PointCovariance::Block
{
    Block(const PlacedCameras& cameras, const std::vector<Parameters>& parameters, bool isUncertain, bool hasPixels)
        : pixels(cameras.size()), byParameters(cameras.size()), seeing(cameras.size())
    {
        const size_t images = 2*cameras.size();
        size_t size = 6*cameras.size() + (isUncertain || hasPixels ? images*(images + 3) : 0);
        for (size_t c = 0; c < cameras.size() && isUncertain; c++)
            size += (size_t)2*parameters[c].count;
        memory_.allocate(size*BLOCK);
        next_ = memory_.data();
    }
    Columns take(int rows, int columns)
    {
        const Columns taken = { next_, columns, BLOCK };
        next_ += (size_t)rows*columns*BLOCK;
        return taken;
    }
    AutoBuffer<PixelsByPoint, 16> pixels;
    AutoBuffer<PixelsByParameters, 16> byParameters;
    AutoBuffer<int, 16> seeing;         //!< which camera each of them is
    int count = 0;                      //!< how many
    Columns E = { NULL, 0, 0 };         //!< covariance of all pixels, beside the isotropic one
    uchar status[BLOCK];
private:
    AutoBuffer<double, 64*BLOCK> memory_;
    double* next_;
};

//! Whitens the derivatives of a camera's pixels; 0 where they were not seen.
static void weigh(const PixelBlock& block, int c, int n, double* byU, double* byV)
{
    const double *u = block.pixel(2*c), *v = block.pixel(2*c + 1);
    for (int i = 0; i < n && (block.sees[c] == PixelBlock::SOME || block.hasHalves[c]); i++)
    {
        byU[i] = std::isnan(u[i]) ? 0 : byU[i];
        byV[i] = std::isnan(v[i]) ? 0 : byV[i];
    }
    for (int i = 0; i < n && !block.whitening.empty(); i++)
    {
        const Whitening& W = block.whiteningOf(c, i);
        byV[i] = (W.vu*byU[i] + W.vv*byV[i])/block.scale[i];
        byU[i] = W.uu*byU[i]/block.scale[i];
    }
}

//! Derivatives of all pixels.
void PointCovariance::differentiate(const PixelBlock& block, int n, Block& work) const
{
    std::copy(block.status, block.status + n, work.status);
    for (int c = 0; c < (int)cameras_.size(); c++)
    {
        if (block.sees[c] == PixelBlock::NONE)
            continue;
        const Camera& camera = *cameras_[c].camera;
        const RigidTransform& place = cameras_[c].place;
        const Parameters& p = parameters_[c];
        const bool isUncertain = !p.uncertain.empty();
        const Columns byPoint = work.take(2, 3), none = { NULL, 0, 0 };
        const Columns values = isUncertain ? work.take(2, p.count) : none;
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        std::copy(block.x, block.x + n, x); std::copy(block.y, block.y + n, y); std::copy(block.z, block.z + n, z);
        if (c > 0)
            pointKernels().transform(place.R.val, place.t.val, n, x, y, z);
        forSeen(block, c, n, work.status, [&](uchar* status)
        { camera.projectJacobian(n, x, y, z, u, v, byPoint, values, status); });
        if (isUncertain && c > 0)
        {
            for (int k = 0; k < 3; k++)
                pointKernels().chainLinear(p.dR[k].val, n, block.x, block.y, block.z, byPoint, values.from(p.lensAndWindow + k));
            for (int k = 0; k < 6; k++)
                std::copy(byPoint.at(k/3, k % 3), byPoint.at(k/3, k % 3) + n, values.at(k/3, p.lensAndWindow + 3 + k % 3));
        }
        for (int k = 0; k < 3; k++)
            weigh(block, c, n, byPoint.at(0, k), byPoint.at(1, k));
        for (int k = 0; k < (isUncertain ? p.count : 0); k++)
            weigh(block, c, n, values.at(0, k), values.at(1, k));
        work.pixels[work.count] = { c > 0 ? place.R.val : NULL, byPoint };
        work.byParameters[work.count] = { values, p.uncertain.data(), (int)p.uncertain.size() };
        work.seeing[work.count++] = c;
    }
}

//! E, from the calibration's covariance.
void PointCovariance::carry(int n, Block& work) const
{
    for (int a = 0; a < work.count; a++)
        for (int b = 0; b <= a; b++)
        {
            const int i = work.seeing[a], j = work.seeing[b];
            const Columns E = { work.E.at(2*a, 2*b), work.E.perRow, BLOCK };
            pointKernels().carryCovariance(n, work.byParameters[a], work.byParameters[b],
                                           covariance_[(size_t)i*(i + 1)/2 + j].data(), a == b, E);
            for (int k = 0; k < 4 && a != b; k++)
                std::copy(E.at(k/2, k % 2), E.at(k/2, k % 2) + n, work.E.at(2*b + k % 2, 2*a + k/2));
        }
}

void PointCovariance::evaluate(const PixelBlock& block, int n, double variance, const Columns& pixels, Matx33d* covariance) const
{
    const bool isUncertain = !covariance_.empty();
    Block work(cameras_, parameters_, isUncertain, pixels.data != NULL);
    differentiate(block, n, work);
    Columns byPixel = { NULL, 0, 0 };
    if (isUncertain || pixels.data)
    {
        work.E = work.take(2*work.count, 2*work.count);
        byPixel = work.take(2*work.count, 3);
    }
    if (isUncertain)
        carry(n, work);
    else if (pixels.data)
        std::fill(work.E.data, work.E.data + (size_t)4*work.count*work.count*BLOCK, 0.);
    const int last = 2*(work.count - 1);
    for (int k = 0; k < 4 && pixels.data; k++)
        for (int i = 0; i < n; i++)
            work.E.at(last + k/2, last + k % 2)[i] += pixels.at(k/2, k % 2)[i];
    double C[9*BLOCK];
    const Columns out = { C, 3, BLOCK };
    pointKernels().pointCovariance(n, work.count, work.pixels.data(), variance, work.E, byPixel, out);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 9; k++)
            covariance[i].val[k] = work.status[i] == REFRACT_OK ? out.at(0, k)[i] : std::numeric_limits<double>::quiet_NaN();
}

}} // namespace
