// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The distance of a pixel from the curve of its partner's ray, C(t): the nearest point has (pixel - C).C' = 0. The search begins
where the pixel's own ray comes nearest to the curve's by angle, mostly a fraction of a pixel off, and goes on by Gauss-Newton
steps; one brings nearly every right match to its end. */

#include "points/epipolar_distance.hpp"
#include "points/epipolar_curve.hpp"
#include "arrays/column_output.hpp"
#include "math/rotation.hpp"
#include <functional>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

/* Pixels along the curve that leave the distance exact: of a curve that bends by kappa it is off by kappa/2 times the square, and
kappa is rarely above 1e-3. Derivatives are off by kappa times them. */
double enoughFor(bool derivatives) { return derivatives ? 1e-4 : 0.02; }

//! Of matches that are far off less is wanted.
bool isThere(double moved, double distance, double enough) { return moved <= enough*(1 + 0.05*std::abs(distance)); }

CurveMotion motionOf(const Matx33d& R12, const Vec3d& T12, int whichImage)
{
    CurveMotion motion;
    Matx33d dR[3];
    rotationMatrix(rotationVector(R12), dR);
    const bool first = whichImage == 1;     // X2 = R X1 + T, or X1 = R^T (X2 - T)
    const Matx33d R = first ? R12 : R12.t(), dT = first ? Matx33d::eye() : -1*R12.t();
    const Vec3d shift = first ? Vec3d() : T12;
    std::copy_n(R.val, 9, motion.R);
    std::copy_n(dT.val, 9, motion.dTranslation);
    std::copy_n(shift.val, 3, motion.shift);
    for (int k = 0; k < 3; k++)
        std::copy_n((first ? dR[k] : dR[k].t()).val, 9, motion.dRotation[k]);
    return motion;
}

} // namespace

//! A block's curves, where on them the search is, and what it found.
struct EpipolarDistance::Search
{
    Rays ray;                                   //!< of the curves' pixels
    double curve[CURVE_COLUMNS*BLOCK], t[BLOCK], nearest[NEAREST_COLUMNS*BLOCK];
    double pixel[2*BLOCK];                      //!< of the other camera
    double byPoint[6*BLOCK];                    //!< of the other camera's image of the point at t
    uchar isCut[BLOCK];                         //!< the curve's range was cut to its visible part
    Columns curves() { return { curve, CURVE_COLUMNS, BLOCK }; }
    Columns results() { return { nearest, NEAREST_COLUMNS, BLOCK }; }
    //! What lane `from` of another search begins with, as lane `to` of this one.
    void begin(const Search& other, int from, int to)
    {
        copy(other.curve, from, curve, to, CURVE_COLUMNS);
        copy(other.t, from, t, to, 1);
        copy(other.pixel, from, pixel, to, 2);
    }
    //! What lane `from` of another search found, as lane `to` of this one.
    void end(const Search& other, int from, int to)
    {
        copy(other.t, from, t, to, 1);
        copy(other.nearest, from, nearest, to, NEAREST_COLUMNS);
        copy(other.byPoint, from, byPoint, to, 6);
    }
    static void copy(const double* source, int from, double* target, int to, int columns)
    {
        for (int k = 0; k < columns; k++)
            target[k*BLOCK + to] = source[k*BLOCK + from];
    }
};

EpipolarDistance::EpipolarDistance(const Camera& camera1, const Camera& camera2, const Matx33d& R, const Vec3d& T,
                                   int whichImage, const DepthRange& range)
    : curves_(whichImage == 1 ? camera1 : camera2), other_(whichImage == 1 ? camera2 : camera1),
      motion_(motionOf(R, T, whichImage))
{
    const Vec3d shift = whichImage == 1 ? T : -(R.t()*T);
    std::copy_n(motion_.R, 9, frame_.R);
    std::copy_n(shift.val, 3, frame_.T);
    std::copy_n(curves_.layers().normal().val, 3, frame_.normal);
    frame_.lastSurface = curves_.layers().lastSurface();
    if (!curves_.layers().refracts())
        frame_.lastSurface.distance = 0;
    frame_.isLimited = range.isLimited();
    frame_.near = range.near;
    frame_.far = range.far < DBL_MAX ? range.far : std::numeric_limits<double>::infinity();
}

//! The curves, and where on them the search begins. Status becomes the reason where there is no curve.
void EpipolarDistance::start(const Matches& block, Search& search, int n, uchar* status) const
{
    Rays others, &ray = search.ray;
    uchar otherStatus[BLOCK];
    curves_.unproject(n, block.ofCurve, block.ofCurve + BLOCK, ray, status);
    std::fill_n(otherStatus, n, (uchar)REFRACT_OK);
    other_.unproject(n, block.other, block.other + BLOCK, others, otherStatus);
    for (int i = 0; i < n; i++)
    {
        if (status[i] != REFRACT_OK)
            ray.dx[i] = NaN;
        if (otherStatus[i] != REFRACT_OK)
            others.dx[i] = NaN;     // no ray to begin with; its distance from the curve it has
    }
    const bool all = pointKernels().curvesOf(frame_, n, ray.tau, ray.offsets(), ray.dx, ray.dy, ray.dz, search.curves());
    for (int i = 0; i < n && !all; i++)
        if (status[i] == REFRACT_OK && std::isnan(search.curves().at(0, CURVE_FAR)[i]))
            status[i] = ray.dz[i] > 0 ? REFRACT_BEHIND_WINDOW : REFRACT_NO_INTERSECTION;
    pointKernels().nearestToRay(search.curves(), other_.layers().normal().val, n, others.tau, others.offsets(), others.dx, others.dy,
                                others.dz, search.t);
    std::copy_n(block.other, BLOCK + n, search.pixel);
    std::fill_n(search.isCut, n, (uchar)false);
}

//! At most so many evaluations; which lanes have arrived. Those without an image have not.
void EpipolarDistance::run(Search& search, int n, int rounds, double enough, uchar* arrived) const
{
    double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
    uchar status[BLOCK];
    const Columns byPoint = { search.byPoint, 3, BLOCK }, none = { nullptr, 0, 0 };
    const double *const moved = search.results().at(0, NEAREST_MOVED), *const distance = search.results().at(0, NEAREST_DISTANCE);
    for (int k = 0; k < rounds; k++)
    {
        pointKernels().curvePoints(search.curves(), n, search.t, x, y, z);
        for (int i = 0; i < n; i++)
            status[i] = std::isnan(x[i]) ? REFRACT_NOT_FINITE : REFRACT_OK;
        other_.projectJacobian(n, x, y, z, u, v, byPoint, none, status);
        for (int i = 0; i < n; i++)
            if (status[i] != REFRACT_OK)
                u[i] = NaN;
        pointKernels().approachPixel(search.curves(), enough, n, search.pixel, search.pixel + BLOCK, u, v, byPoint, search.t,
                                     search.results());
        int onTheWay = 0;
        for (int i = 0; i < n; i++)
        {
            arrived[i] = isThere(moved[i], distance[i], enough);
            onTheWay += !arrived[i] && !std::isnan(moved[i]);
        }
        if (onTheWay == 0)
            break;
    }
}

/* What the steps did not find: the nearest of many points of the visible part of the curve is where they begin anew. What the
camera sees of the curve may end before the curve. */
uchar EpipolarDistance::refineFromSamples(Search& search, int lane) const
{
    const auto at = [&](int column) { return search.curve[column*BLOCK + lane]; };
    double& tFar = search.curve[CURVE_FAR*BLOCK + lane];
    double& tNear = search.curve[CURVE_NEAR*BLOCK + lane];
    const Vec3d direction(at(CURVE_DIRECTION), at(CURVE_DIRECTION + 1), at(CURVE_DIRECTION + 2));
    const Vec3d origin(at(CURVE_ORIGIN), at(CURVE_ORIGIN + 1), at(CURVE_ORIGIN + 2));
    const EpipolarCurve curve(Matx33d::eye(), Vec3d(), origin, direction);
    Projection p(other_);
    addSamples(curve, tNear, tFar, Projection::CAPACITY, p);
    p.run();
    double visibleNear, visibleFar;
    if (!visiblePart(curve, p, 0, Projection::CAPACITY, visibleNear, visibleFar))
        return p.status(Projection::CAPACITY - 1);
    search.isCut[lane] = visibleNear != tNear || visibleFar != tFar;
    tNear = visibleNear;
    tFar = visibleFar;
    p.clear();
    addSamples(curve, tNear, tFar, Projection::CAPACITY, p);
    p.run();
    double least = DBL_MAX;
    for (int i = 0; i < Projection::CAPACITY; i++)
    {
        const double distance = norm(p.pixel(i) - Vec2d(search.pixel[lane], search.pixel[BLOCK + lane]));
        if (distance < least)
        {
            least = distance;
            search.t[lane] = p.t()[i];
        }
    }
    return REFRACT_OK;
}

void EpipolarDistance::evaluate(Matches& block, int n, bool derivatives) const
{
    const int TOGETHER = 2, MORE = 10, CLOSER = 30;     // evaluations
    Search search, rest;
    const double enough = enoughFor(derivatives);
    uchar arrived[BLOCK];
    CV_Assert(n > 0 && n <= BLOCK);
    start(block, search, n, block.status);
    run(search, n, TOGETHER, enough, arrived);
    // What is left is mostly far off: wrong matches.
    int lanes[BLOCK], left = 0;
    for (int i = 0; i < n; i++)
        if (block.status[i] == REFRACT_OK && !arrived[i])
            lanes[left++] = i;
    const auto goOn = [&](int rounds)
    {
        int still = 0;
        for (int k = 0; k < left; k++)
            rest.begin(search, lanes[k], k);
        if (left > 0)
            run(rest, left, rounds, enough, arrived);
        for (int k = 0; k < left; k++)
        {
            search.end(rest, k, lanes[k]);
            if (!arrived[k])
                lanes[still++] = lanes[k];
        }
        left = still;
    };
    goOn(MORE);
    int seen = 0;
    for (int k = 0; k < left; k++)
    {
        block.status[lanes[k]] = refineFromSamples(search, lanes[k]);
        if (block.status[lanes[k]] == REFRACT_OK)
            lanes[seen++] = lanes[k];
    }
    left = seen;
    goOn(CLOSER);
    for (int k = 0; k < left; k++)
        block.status[lanes[k]] = REFRACT_NOT_CONVERGED;
    std::copy_n(search.nearest, n, block.distance);
    for (int i = 0; i < n; i++)
    {
        const double t = search.t[i], s = (1 - t)/(t*search.curve[CURVE_UNIT*BLOCK + i]);
        block.depth[i] = search.ray.origin(i, curves_.layers().normal())[2] + s*search.ray.dz[i];
        if (t == search.curve[CURVE_FAR*BLOCK + i] && !search.isCut[i])
            block.depth[i] = frame_.far;
    }
    if (derivatives)
        differentiate(block, search, n);
}

void EpipolarDistance::differentiate(Matches& block, const Search& search, int n) const
{
    double x[BLOCK], y[BLOCK], z[BLOCK], m[3*BLOCK], byPoint[6*BLOCK], u[BLOCK], v[BLOCK];
    uchar status[BLOCK];
    const Rays& ray = search.ray;
    std::copy_n(ray.dx, BLOCK, m); std::copy_n(ray.dy, BLOCK, m + BLOCK); std::copy_n(ray.dz, BLOCK, m + 2*BLOCK);
    for (int i = 0; i < n; i++)
    {
        const double t = search.t[i], s = (1 - t)/(t*search.curve[CURVE_UNIT*BLOCK + i]);
        const Vec3d origin = ray.origin(i, curves_.layers().normal());
        x[i] = origin[0] + s*ray.dx[i];
        y[i] = origin[1] + s*ray.dy[i];
        z[i] = origin[2] + s*ray.dz[i];
        status[i] = block.status[i];
        if (search.nearest[NEAREST_AT_END*BLOCK + i] == 0)
            continue;
        const bool isWindow = t == search.curve[CURVE_NEAR*BLOCK + i] && !(frame_.isLimited && z[i] < frame_.near*(1 + 1e-6));
        double normal[3] = { 0, 0, 1 };
        if (isWindow)
            gradientAt(frame_.lastSurface, x[i], y[i], z[i], normal);
        for (int c = 0; c < 3; c++)
            m[c*BLOCK + i] = normal[c];
    }
    const Columns byPoint1 = { byPoint, 3, BLOCK }, none = { nullptr, 0, 0 }, out = { block.jacobian, 10, BLOCK };
    const Columns byPoint2 = { const_cast<double*>(search.byPoint), 3, BLOCK };
    const Columns nearest = { const_cast<double*>(search.nearest), NEAREST_COLUMNS, BLOCK };
    curves_.projectJacobian(n, x, y, z, u, v, byPoint1, none, status);
    pointKernels().distanceDerivatives(motion_, n, x, y, z, ray.dx, ray.dy, ray.dz, m, m + BLOCK, m + 2*BLOCK, byPoint1,
                                       byPoint2, nearest, out);
    for (int i = 0; i < n; i++)
    {
        block.isCut[i] = search.isCut[i] && search.nearest[NEAREST_AT_END*BLOCK + i] != 0;
        for (int c = 0; c < 10 && status[i] != REFRACT_OK; c++)
            out.at(0, c)[i] = NaN;
    }
}

/** Where the nearest point of a lane is the last that the other camera sees, it moves along the edge of what that sees. The edge is
known by bisection only, to 1e-9 of the curve; so all derivatives but those by the other's pixel are differences. */
static void differentiateEnd(const std::function<EpipolarDistance(const Vec3d&, const Vec3d&)>& distanceOf, const Vec3d& rvec,
                             const Vec3d& T, Matches& block, int lane)
{
    const double PIXELS = 0.1, RADIANS = 1e-4;
    for (int c = 0; c < 10; c++)
    {
        if (c == 2 || c == 3)
            continue;
        const double step = c < 2 ? PIXELS : c < 7 ? RADIANS : RADIANS*std::max(norm(T), DBL_MIN);
        double ends[2];
        for (int side = 0; side < 2; side++)
        {
            Vec3d r = rvec, t = T;
            Matches one;
            one.status[0] = REFRACT_OK;
            for (int k = 0; k < 2; k++)
            {
                one.ofCurve[k*BLOCK] = block.ofCurve[k*BLOCK + lane];
                one.other[k*BLOCK] = block.other[k*BLOCK + lane];
            }
            (c < 2 ? one.ofCurve[c*BLOCK] : c < 7 ? r[c - 4] : t[c - 7]) += side ? step : -step;
            distanceOf(r, t).evaluate(one, 1, true);
            ends[side] = one.status[0] == REFRACT_OK && one.isCut[0] ? one.distance[0] : NaN;
        }
        block.jacobian[c*BLOCK + lane] = (ends[1] - ends[0])/(2*step);
    }
}

static void distances(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                      const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, OutputArray distances_,
                      OutputArray status, int whichImage, const Vec2d& depthRange, Mat* depths, Mat* jacobian)
{
    if (whichImage != 1 && whichImage != 2)
        CV_Error_(Error::StsBadArg, ("whichImage is %d; it must be 1 or 2", whichImage));
    const Vec2d ends = readDepthRange(depthRange, true);
    const DepthRange range = { ends[0], ends[1] };
    const Camera& cam1 = cameraOf(camera1, "camera1");
    const Camera& cam2 = cameraOf(camera2, "camera2");
    const Matx33d turn = readRotation(R, "R");
    const Vec3d rvec = rotationVector(turn), shift = readVec3(T, "T");
    const EpipolarDistance distance(cam1, cam2, turn, shift, whichImage, range);
    const auto distanceOf = [&](const Vec3d& r, const Vec3d& t)
    { return EpipolarDistance(cam1, cam2, rotationMatrix(r), t, whichImage, range); };
    const PointReader in1(points1, 2, "points1"), in2(points2, 2, "points2");
    const int count = in1.size();
    if (count != in2.size())
        CV_Error_(Error::StsUnmatchedSizes, ("points1 has %d points, points2 %d; they must agree", count, in2.size()));
    Mat found(count, 1, CV_64F);
    if (depths)
        depths->create(count, 1, CV_64F);
    if (jacobian)
        jacobian->create(count, 10, CV_64F);
    const PointReader &ofCurve = whichImage == 1 ? in1 : in2, &other = whichImage == 1 ? in2 : in1;
    StatusWriter outStatus(status, count);
    forEachBlock(count, 15*POINT_COST, [&](int begin, int n)
    {
        Matches block;
        uchar otherStatus[BLOCK];
        ofCurve.load(begin, n, block.ofCurve, block.ofCurve + BLOCK, nullptr, block.status);
        other.load(begin, n, block.other, block.other + BLOCK, nullptr, otherStatus);
        for (int i = 0; i < n; i++)
            if (block.status[i] == REFRACT_OK)
                block.status[i] = otherStatus[i];
        distance.evaluate(block, n, jacobian != nullptr);
        for (int i = 0; i < n; i++)
        {
            const bool ok = block.status[i] == REFRACT_OK;
            found.at<double>(begin + i) = ok ? block.distance[i] : NaN;
            if (depths)
                depths->at<double>(begin + i) = ok ? block.depth[i] : NaN;
            if (jacobian && ok && block.isCut[i])
                differentiateEnd(distanceOf, rvec, shift, block, i);
            for (int c = 0; c < 10 && jacobian; c++)
            {
                const int from = c < 4 && whichImage == 2 ? (c + 2) % 4 : c;
                jacobian->at<double>(begin + i, c) = ok ? block.jacobian[from*BLOCK + i] : NaN;
            }
        }
        outStatus.store(begin, n, block.status);
    });
    const int depth = distances_.fixedType() ? CV_MAT_DEPTH(distances_.type()) : std::max(in1.depth(), in2.depth());
    found.convertTo(found, depth);
    writeColumn(found, distances_);
}

void refractiveEpipolarDistance(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                                const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, OutputArray distances_,
                                OutputArray status, int whichImage, const Vec2d& depthRange)
{
    CV_INSTRUMENT_REGION();

    distances(points1, points2, camera1, camera2, R, T, distances_, status, whichImage, depthRange, nullptr, nullptr);
}

void refractiveEpipolarDistance(InputArray points1, InputArray points2, InputArray cameraMatrix1, InputArray distCoeffs1,
                                const GlassWindow& window1, InputArray cameraMatrix2, InputArray distCoeffs2,
                                const GlassWindow& window2, InputArray R, InputArray T, OutputArray distances_,
                                OutputArray status, int whichImage, const Vec2d& depthRange)
{
    CV_INSTRUMENT_REGION();

    refractiveEpipolarDistance(points1, points2, RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                               RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2), R, T, distances_, status,
                               whichImage, depthRange);
}

void refractiveEpipolarDistance(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                                const Ptr<RefractiveCamera>& camera2, InputArray R, InputArray T, OutputArray distances_,
                                OutputArray status, int whichImage, const Vec2d& depthRange, OutputArray depths_,
                                OutputArray jacobian_)
{
    CV_INSTRUMENT_REGION();

    Mat depths, jacobian;
    distances(points1, points2, camera1, camera2, R, T, distances_, status, whichImage, depthRange, &depths, &jacobian);
    writeColumn(depths, depths_);
    if (jacobian_.needed())
        jacobian.copyTo(jacobian_);
}

}} // namespace
