// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/layers.hpp"
#include "window/parameters.hpp"
#include <numeric>

namespace cv { namespace refract {

//! Gap, layers and scene with media of equal index taken together.
static std::vector<Medium> mediaOf(const std::vector<double>& height, const std::vector<double>& index, double outer,
                                   double rarest)
{
    std::vector<Medium> media;
    media.reserve(height.size() + 1);
    const auto medium = [&](double n) -> Medium&
    {
        const Medium empty = { 0, false, n > rarest ? rarest : 1, n*n, 1/n, 1/std::sqrt((n - rarest)*(n + rarest)) };
        const auto at = std::lower_bound(media.begin(), media.end(), empty,
                                         [](const Medium& a, const Medium& b) { return a.index2 < b.index2; });
        return at != media.end() && at->index2 == empty.index2 ? *at : *media.insert(at, empty);
    };
    for (size_t k = 0; k < height.size(); ++k)
        medium(index[k]).height += height[k]*medium(index[k]).scale;
    medium(outer).isScene = true;
    return media;
}

Layers::Layers(const GlassWindow& window)
{
    window.check();
    normal_ = window.normal / cv::norm(window.normal);
    height_.reserve(1 + window.thickness.size());
    index_.reserve(1 + window.index.size());
    height_.assign(1, window.distance);
    index_.assign(1, window.innerIndex);
    height_.insert(height_.end(), window.thickness.begin(), window.thickness.end());
    index_.insert(index_.end(), window.index.begin(), window.index.end());
    const double outer = window.outerIndex, total = std::accumulate(height_.begin(), height_.end(), 0.);
    const double rarest = std::min(outer, *std::min_element(index_.begin(), index_.end()));
    media_ = mediaOf(height_, index_, outer, rarest);
    const bool refracts = !window.thickness.empty() || window.innerIndex != outer;
    stack_ = { { normal_[0], normal_[1], normal_[2] }, refracts, total, window.innerIndex, outer, rarest,
               NULL, (int)media_.size(), NULL, NULL, (int)height_.size(), windowLayout((int)window.thickness.size()) };
    pointIntoVectors();
}

Layers& Layers::operator=(const Layers& other)
{
    normal_ = other.normal_;
    height_ = other.height_;
    index_ = other.index_;
    media_ = other.media_;
    stack_ = other.stack_;
    pointIntoVectors();
    return *this;
}

void Layers::pointIntoVectors()
{
    stack_.media = media_.data();
    stack_.heights = height_.data();
    stack_.indices = index_.data();
}

void Layers::traceOut(int n, const double* wx, const double* wy, const double* wz,
                      double* tau, double* dx, double* dy, double* dz, uchar* status) const
{
    if (!stack_.refracts)
    {
        std::fill(tau, tau + n, 0.);
        std::copy(wx, wx + n, dx); std::copy(wy, wy + n, dy); std::copy(wz, wz + n, dz);
        return;
    }
    if (layerKernels().traceOut(stack_, n, wx, wy, wz, tau, dx, dy, dz))
        return;
    for (int i = 0; i < n; ++i)
    {
        if (status[i] != REFRACT_OK || !std::isnan(tau[i]))
            continue;
        Vec3d d;
        status[i] = traceOne(Vec3d(wx[i], wy[i], wz[i]), tau[i], d);
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
    }
}

uchar Layers::traceOne(const Vec3d& w, double& tau, Vec3d& d) const
{
    const double c = normal_.dot(w), inner = index_[0], outer = stack_.outer, inner2 = inner*inner, outer2 = outer*outer;
    // q^2 = n^2 - p^2 by the cosine: no cancellation near grazing where the medium is the camera's
    const double qOut2 = (outer2 - inner2) + inner2*c*c, qOut = std::sqrt(qOut2);
    bool reflected = !(qOut2 > 0);
    tau = 0;
    for (size_t k = 0; k < height_.size(); ++k)
    {
        const double n2 = index_[k]*index_[k], q2 = (n2 - inner2) + inner2*c*c, q = std::sqrt(q2);
        reflected = reflected || !(q2 > 0);
        tau += height_[k]*(n2 - outer2)/(q*(q + qOut));
    }
    d = inner/outer*w + (qOut - inner*c)/outer*normal_;
    return !(c > 0) ? REFRACT_BEHIND_WINDOW : reflected ? REFRACT_TOTAL_REFLECTION : REFRACT_OK;
}

/* In t = tan(theta) of the rarest medium, n_r sin(theta) = p:

    tan(theta_i) = n_r t / sqrt(n_i^2 + (n_i^2 - n_r^2) t^2)

so f(t) = sum h_i tan(theta_i(t)) - V is increasing and concave, and Newton's method from a point left of the root
rises monotonically to it. Two such points: t = V/U (no medium bends more than the rarest), and what remains when every
denser layer has reached its limit h_i n_r / sqrt(n_i^2 - n_r^2). The unknown is the ratio t/V, regular on the axis. */
uchar Layers::solveTangent(double U, double V, double w, double& ratio) const
{
    const double rarest = stack_.rarest, outer = stack_.outer, r2 = rarest*rarest, hOut = U - w*stack_.total;
    double rareHeight = 0, limit = 0;
    for (size_t k = 0; k <= height_.size(); ++k)
    {
        const bool last = k == height_.size();
        const double h = last ? hOut : w*height_[k], n = last ? outer : index_[k];
        if (n > rarest)
            limit += h*rarest/std::sqrt(n*n - r2);
        else
            rareHeight += h;
    }
    if (!(rareHeight > 0) && V >= limit)
        return REFRACT_TOTAL_REFLECTION;    // beyond the cone that total reflection leaves
    ratio = 1/U;
    if (V > limit)
        ratio = std::max(ratio, (V - limit)/(rareHeight*V));

    for (int iteration = 0; iteration < 100; ++iteration)
    {
        const double t2 = V*ratio*V*ratio;
        double f = -1, slope = 0;
        for (size_t k = 0; k <= height_.size(); ++k)
        {
            const bool last = k == height_.size();
            const double h = last ? hOut : w*height_[k], n = last ? outer : index_[k], n2 = n*n;
            const double root2 = n2 + (n2 - r2)*t2, term = h*rarest/std::sqrt(root2);
            f += term*ratio;
            slope += term*n2/root2;
        }
        const double step = -f/slope;
        ratio += step;
        // The sequence rises until rounding takes over: a step that is not positive is below it.
        if (!(step > 4*DBL_EPSILON*ratio))
            return std::isfinite(ratio) ? REFRACT_OK : REFRACT_NOT_CONVERGED;
    }
    return REFRACT_NOT_CONVERGED;
}

void Layers::solveIn(int n, const double* x, const double* y, const double* z, const double* w,
                     double* dx, double* dy, double* dz, uchar* status, double* ratio) const
{
    if (!stack_.refracts)
    {
        std::copy(x, x + n, dx); std::copy(y, y + n, dy); std::copy(z, z + n, dz);
        return;
    }
    if (layerKernels().solveIn(stack_, n, x, y, z, w, dx, dy, dz, ratio))
        return;
    for (int i = 0; i < n; ++i)
    {
        if (status[i] != REFRACT_OK || !std::isnan(dx[i]))
            continue;
        Vec3d d;
        double found = 0;
        status[i] = solveOne(Vec3d(x[i], y[i], z[i]), w ? w[i] : 1., d, found);
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
        if (ratio)
            ratio[i] = found;
    }
}

uchar Layers::solveOne(const Vec3d& X, double w, Vec3d& d, double& ratio) const
{
    const double U = normal_.dot(X), rarest = stack_.rarest, r2 = rarest*rarest, inner2 = index_[0]*index_[0];
    if (!(U > w*stack_.total))
        return REFRACT_BEHIND_WINDOW;
    const Vec3d radial = X - U*normal_;
    const double V = cv::norm(radial);
    const uchar status = solveTangent(U, V, w, ratio);
    const double t = V*ratio, kappa = rarest*ratio/std::sqrt(inner2 + (inner2 - r2)*t*t);
    d = normal_ + kappa*radial;
    return status;
}

void Layers::chain(int rows, int n, const double* x, const double* y, const double* z, const double* ratio,
                   const Columns& byDirection, const Columns& byPoint, const Columns& byWindow) const
{
    if (stack_.refracts)
    {
        layerKernels().chainWindow(stack_, rows, n, x, y, z, ratio, byDirection, byPoint, byWindow);
        return;
    }
    for (int r = 0; r < rows; ++r)
    {
        for (int c = 0; c < 3; ++c)
            std::copy(byDirection.at(r, c), byDirection.at(r, c) + n, byPoint.at(r, c));
        for (int c = 0; c < (byWindow.data ? stack_.at.count : 0); ++c)
            std::fill(byWindow.at(r, c), byWindow.at(r, c) + n, 0.);
    }
}

}} // namespace
