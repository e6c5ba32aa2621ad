// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/layers.hpp"
#include "math/missing.hpp"
#include "window/curved.hpp"
#include "window/curved_path.hpp"
#include "window/dome.hpp"
#include "window/parameters.hpp"
#include "window/path.hpp"
#include "window/wedge.hpp"
#include "window/wedge_kernels.hpp"
#include "window/wedge_path.hpp"
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
    for (size_t k = 0; k < height.size(); k++)
        medium(index[k]).height += height[k]*medium(index[k]).scale;
    medium(outer).isScene = true;
    return media;
}

Layers::Layers(const GlassWindow& window)
{
    window.check();
    normal_ = window.normal/cv::norm(window.normal);
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
               NULL, (int)media_.size(), NULL, NULL, (int)height_.size(), windowLayout(window) };
    last_ = { { normal_[0], normal_[1], normal_[2] }, total, 0., { 0, 0, 0 }, { 0, 0, 0 } };
    isTilted_ = isDome_ = isCurved_ = false;
    tilted_ = TiltedFaces();
    dome_ = Dome();
    curved_ = CurvedFaces();
    if (!window.wedge.empty() || window.shape == WINDOW_BENT)
        setWedge(window);
    if (refracts && window.shape == WINDOW_DOME)
        setDome(window);
    if (refracts && window.shape == WINDOW_TUBE)
        setTube(window);
    if (refracts && window.shape == WINDOW_BENT)
        setBent(window);
    pointIntoVectors();
}

void Layers::setWedge(const GlassWindow& window)
{
    isTilted_ = std::any_of(window.wedge.begin(), window.wedge.end(), [](const Vec2d& w) { return w != Vec2d(); });
    faces_ = facesOf(window);
    const Matx33d axes = windowAxes(normal_);
    std::copy_n(axes.val, 9, tilted_.axes);
    tilted_.count = (int)faces_.size();
    tilted_.inner = stack_.inner;
    tilted_.outer = stack_.outer;
    tilted_.at = stack_.at;
    if (!isTilted_)
        return;
    const Vec3d last = axes.t()*Vec3d(faces_.back().normal);
    last_ = { { last[0], last[1], last[2] }, faces_.back().distance, 0., { 0, 0, 0 }, { 0, 0, 0 } };
}

void Layers::setDome(const GlassWindow& window)
{
    isDome_ = true;
    spheres_ = spheresOf(window);
    std::copy_n(window.center.val, 3, dome_.center);
    dome_.count = (int)spheres_.size();
    dome_.inner = stack_.inner;
    dome_.outer = stack_.outer;
    dome_.at = stack_.at;
    const double radius = spheres_.back().radius, offset = cv::norm(window.center);
    // Towards the nearest point of the dome or away from it: where the camera looks.
    normal_ = offset > 0 ? window.center/offset : Vec3d(0, 0, 1);
    if (normal_[2] < 0)
        normal_ = -normal_;
    std::copy_n(normal_.val, 3, stack_.normal);
    dome_.along = normal_.dot(window.center);
    stack_.total = radius - offset;         // to the nearest point of the last surface
    const Vec3d outwards = -window.center/radius;
    last_ = { { outwards[0], outwards[1], outwards[2] }, 0.5*(radius - offset)*(1 + offset/radius), 1/radius, { 0, 0, 0 },
              { 0, 0, 0 } };
}

static void setMedia(const Stack& stack, size_t faces, const Matx33d& axes, CurvedFaces& curved)
{
    std::copy_n(axes.val, 9, curved.axes);
    curved.least = -std::numeric_limits<double>::infinity();
    curved.count = (int)faces;
    curved.inner = stack.inner;
    curved.outer = stack.outer;
    curved.at = stack.at;
}

void Layers::setTube(const GlassWindow& window)
{
    isCurved_ = true;
    const Matx33d axes = tubeAxes(window.axis);
    const Vec3d a(axes.val + 6), center = axes*window.center;
    curvedFaces_ = tubeFaces(window);
    setMedia(stack_, curvedFaces_.size(), axes, curved_);
    curved_.third = 0;
    std::copy_n(center.val, 3, curved_.center);
    // Ahead, as far as that is across the axis.
    const Vec3d ahead = Vec3d(0, 0, 1) - a[2]*a;
    normal_ = normalize(norm(ahead) > 1e-6 ? ahead : Vec3d(1, 0, 0) - a[0]*a);
    std::copy_n((axes*normal_).val, 2, curved_.normal);
    std::copy_n(normal_.val, 3, stack_.normal);
    stack_.total = 1/curvedFaces_.back().curvature - norm(Vec2d(center[0], center[1]));     // to the nearest point of the last surface
    last_ = surfaceOf(curved_, curvedFaces_.back());
}

//! With no curvature it is a flat pane, but for the derivative.
void Layers::setBent(const GlassWindow& window)
{
    isCurved_ = window.curvature != 0;
    curvedFaces_ = bentFaces(window, faces_);
    setMedia(stack_, curvedFaces_.size(), windowAxes(normal_), curved_);
    curved_.third = 1;
    curved_.normal[2] = 1;
    if (isTilted_)
        curved_.least = 0;
    if (isCurved_)
        last_ = surfaceOf(curved_, curvedFaces_.back());
}

Layers& Layers::operator=(const Layers& other)
{
    normal_ = other.normal_;
    height_ = other.height_;
    index_ = other.index_;
    media_ = other.media_;
    stack_ = other.stack_;
    last_ = other.last_;
    isTilted_ = other.isTilted_;
    faces_ = other.faces_;
    tilted_ = other.tilted_;
    isDome_ = other.isDome_;
    spheres_ = other.spheres_;
    dome_ = other.dome_;
    isCurved_ = other.isCurved_;
    curvedFaces_ = other.curvedFaces_;
    curved_ = other.curved_;
    pointIntoVectors();
    return *this;
}

void Layers::pointIntoVectors()
{
    stack_.media = media_.data();
    stack_.heights = height_.data();
    stack_.indices = index_.data();
    tilted_.faces = faces_.data();
    dome_.faces = spheres_.data();
    curved_.faces = curvedFaces_.data();
    curved_.tangents = faces_.data();
}

void Layers::traceOut(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const
{
    rays.hasOffset = hasOffsets();
    if (isCurved_)
        return traceOutCurved(n, wx, wy, wz, rays, status);
    if (isTilted_)
        return traceOutTilted(n, wx, wy, wz, rays, status);
    if (isDome_)
        return traceOutDome(n, wx, wy, wz, rays, status);
    if (!stack_.refracts)
    {
        std::fill(rays.tau, rays.tau + n, 0.);
        std::copy(wx, wx + n, rays.dx); std::copy(wy, wy + n, rays.dy); std::copy(wz, wz + n, rays.dz);
        return;
    }
    if (!layerKernels().traceOut(stack_, n, wx, wy, wz, rays.tau, rays.dx, rays.dy, rays.dz))
        answerMissing(n, rays.tau, status, [=](int i)
                      { return normal_.dot(Vec3d(wx[i], wy[i], wz[i])) > 0 ? REFRACT_TOTAL_REFLECTION : REFRACT_BEHIND_WINDOW; });
}

void Layers::traceOutTilted(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const
{
    if (!wedgeKernels().traceOut(tilted_, n, wx, wy, wz, rays.tau, rays.offsets(), rays.dx, rays.dy, rays.dz))
        answerMissing(n, rays.tau, status, [=](int i)
                      { return statusOfDirection(tilted_, Matx33d(tilted_.axes)*Vec3d(wx[i], wy[i], wz[i])); });
}

void Layers::traceOutDome(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const
{
    if (!domeKernels().traceOut(dome_, n, wx, wy, wz, rays.tau, rays.dx, rays.dy, rays.dz))
        answerMissing(n, rays.tau, status, [](int) { return REFRACT_TOTAL_REFLECTION; });
}

void Layers::traceOutCurved(int n, const double* wx, const double* wy, const double* wz, Rays& rays, uchar* status) const
{
    if (!curvedKernels().traceOut(curved_, n, wx, wy, wz, rays.tau, rays.offsets(), rays.dx, rays.dy, rays.dz))
        answerMissing(n, rays.tau, status, [=](int i)
        {
            Vec3d P, p = Matx33d(curved_.axes)*Vec3d(wx[i], wy[i], wz[i]);
            const uchar reason = traceCurved(curved_, P, p);
            return reason != REFRACT_OK ? reason : (uchar)REFRACT_NOT_CONVERGED;
        });
}

double Layers::leavingMu(const Rays& rays, int i) const
{
    const double infinity = std::numeric_limits<double>::infinity();
    if (!stack_.refracts)
        return infinity;
    if (!isTilted_ && !isDome_ && !isCurved_)
        return stack_.total > rays.tau[i] ? normal_.dot(rays.direction(i))/(stack_.total - rays.tau[i]) : infinity;
    const Vec3d o = rays.origin(i, normal_), d = rays.direction(i);
    const double length = lengthTo(last_, o[0], o[1], o[2], d[0], d[1], d[2]);
    return length > 0 ? 1/length : infinity;
}

void Layers::solveIn(int n, const double* x, const double* y, const double* z, const double* w,
                     double* dx, double* dy, double* dz, uchar* status, double* ratio) const
{
    if (!stack_.refracts)
    {
        std::copy(x, x + n, dx); std::copy(y, y + n, dy); std::copy(z, z + n, dz);
        return;
    }
    if (isCurved_)
        return solveInCurved(n, x, y, z, w, dx, dy, dz, status);
    if (isTilted_)
        return solveInTilted(n, x, y, z, w, dx, dy, dz, status);
    if (isDome_)
        return solveInDome(n, x, y, z, w, dx, dy, dz, status);
    if (layerKernels().solveIn(stack_, n, x, y, z, w, dx, dy, dz, ratio))
        return;
    answerMissing(n, dx, status, [=](int i)
    {
        double d[3] = {}, found = 0;
        const uchar solved = solveOne(Vec3d(x[i], y[i], z[i]), w ? w[i] : 1., d, found);
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
        if (ratio)
            ratio[i] = found;
        return solved;
    });
}

void Layers::solveInTilted(int n, const double* x, const double* y, const double* z, const double* w,
                           double* dx, double* dy, double* dz, uchar* status) const
{
    if (wedgeKernels().solveIn(stack_, tilted_, n, x, y, z, w, dx, dy, dz))
        return;
    answerMissing(n, dx, status, [=](int i)
    {
        const Matx33d axes(tilted_.axes);
        Vec3d d;
        const uchar found = findWedgePath(tilted_, axes*Vec3d(x[i], y[i], z[i]), w ? w[i] : 1., d);
        d = axes.t()*d;
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
        return found;
    });
}

void Layers::solveInDome(int n, const double* x, const double* y, const double* z, const double* w,
                         double* dx, double* dy, double* dz, uchar* status) const
{
    if (domeKernels().solveIn(dome_, n, x, y, z, w, dx, dy, dz))
        return;
    answerMissing(n, dx, status, [=](int i)
    {
        Vec3d d;
        const uchar found = findDomePath(dome_, Vec3d(x[i], y[i], z[i]), w ? w[i] : 1., d);
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
        return found;
    });
}

bool Layers::mayComeRoundEdge(double x, double y, double z, double w) const
{
    return last_.curvature < 0 && last_.normal[0]*x + last_.normal[1]*y + last_.normal[2]*z > last_.distance*w;
}

bool Layers::comesRoundEdge(double x, double y, double z, double w) const
{
    Vec3d d;
    return mayComeRoundEdge(x, y, z, w) && findBentPath(curved_, Matx33d(curved_.axes)*Vec3d(x, y, z), w, d) == REFRACT_OK;
}

//! The search begins in a tube along the straight way, in a bent pane where planes would have the path.
void Layers::solveInCurved(int n, const double* x, const double* y, const double* z, const double* w,
                           double* dx, double* dy, double* dz, uchar* status) const
{
    const bool isTube = curved_.third == 0;
    if (isTube)
    {
        std::copy(x, x + n, dx); std::copy(y, y + n, dy); std::copy(z, z + n, dz);
    }
    else if (isTilted_)
        wedgeKernels().solveIn(stack_, tilted_, n, x, y, z, w, dx, dy, dz);
    else
        layerKernels().solveIn(stack_, n, x, y, z, w, dx, dy, dz, NULL);
    if (curvedKernels().solveIn(curved_, n, x, y, z, w, dx, dy, dz))
        return;
    answerMissing(n, dx, status, [=](int i)
    {
        const double weight = w ? w[i] : 1.;
        const bool isThere = refract::isBeyond(last_, x[i], y[i], z[i], weight);
        if (!isThere && !mayComeRoundEdge(x[i], y[i], z[i], weight))
            return (uchar)REFRACT_BEHIND_WINDOW;
        const Matx33d axes(curved_.axes);
        Vec3d d;
        const uchar found = (isTube ? findTubePath : findBentPath)(curved_, axes*Vec3d(x[i], y[i], z[i]), weight, d);
        d = axes.t()*d;
        dx[i] = d[0]; dy[i] = d[1]; dz[i] = d[2];
        return found == REFRACT_OK || isThere ? found : (uchar)REFRACT_BEHIND_WINDOW;
    });
}

//! Newton's method from a ratio left of the root.
static uchar climb(const Stack& stack, const Path<double>& path, double& ratio)
{
    for (int iteration = 0; iteration < 100; iteration++)
    {
        const PathFunction<double> F(stack, path, ratio);
        const double step = -F.value/F.slope;
        ratio += step;
        // The sequence rises until rounding takes over: a step that is not positive is below it.
        if (!(step > 4*DBL_EPSILON*ratio))
            return std::isfinite(ratio) ? REFRACT_OK : REFRACT_NOT_CONVERGED;
    }
    return REFRACT_NOT_CONVERGED;
}

uchar Layers::solveOne(const Vec3d& X, double w, double* d, double& ratio) const
{
    const Path<double> path = pathTo(stack_, X[0], X[1], X[2], w);
    if (!(path.scene > 0))
        return REFRACT_BEHIND_WINDOW;
    const PathBounds<double> bounds(stack_, path);
    if (!(bounds.rare > 0) && path.radius2 >= square(bounds.limit))
        return REFRACT_TOTAL_REFLECTION;    // beyond the cone that total reflection leaves
    ratio = firstRatio(stack_, path);
    const uchar status = climb(stack_, path, ratio);
    direction(stack_, path, ratio, d);
    return status;
}

void Layers::chain(int rows, int n, const double* x, const double* y, const double* z, const double* dx, const double* dy,
                   const double* dz, const double* ratio, const Columns& byDirection, const Columns& byPoint,
                   const Columns& byWindow) const
{
    if (isDome_)
        return domeKernels().chain(dome_, rows, n, x, y, z, dx, dy, dz, byDirection, byPoint, byWindow);
    const bool isBent = stack_.refracts && stack_.at.shape == WINDOW_BENT;
    if (isCurved_ || (isBent && (isTilted_ || byWindow.data)))
        curvedKernels().chain(curved_, rows, n, x, y, z, dx, dy, dz, byDirection, byPoint, byWindow);
    else if (isTilted_ || (!faces_.empty() && byWindow.data))
        wedgeKernels().chain(tilted_, rows, n, x, y, z, dx, dy, dz, byDirection, byPoint, byWindow);
    if (isTilted_ || isCurved_)
        return;
    if (stack_.refracts)        // of a wedge or a curvature of 0, all but by these once more: as without them
    {
        layerKernels().chainWindow(stack_, rows, n, x, y, z, ratio, byDirection, byPoint, byWindow);
        return;
    }
    for (int r = 0; r < rows; r++)
    {
        for (int c = 0; c < 3; c++)
            std::copy(byDirection.at(r, c), byDirection.at(r, c) + n, byPoint.at(r, c));
        for (int c = 0; c < (byWindow.data ? stack_.at.count : 0); c++)
            std::fill(byWindow.at(r, c), byWindow.at(r, c) + n, 0.);
    }
}

}} // namespace
