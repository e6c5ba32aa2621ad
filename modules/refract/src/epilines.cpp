// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "rotation.hpp"

/* The curve of possible partners of a pixel: the refracted ray tau n + s d of one camera, seen by the other (raw image).

The parameter t runs from infinity (0) to the ray's origin (1): the other camera sees the point (1 - t) d + t e, where e is
the unit vector to the origin. Even steps of t are nearly even steps of the angle there, whatever the depth range; 1/s =
t / ((1 - t) b) with b the distance of the origin. A chord over a step of t misses the curve by |second difference across
the curve| / 8, so nodes at equal steps of the integral of its square root share the error evenly: as few points as the
tolerance takes. */

namespace cv { namespace refract {

namespace {

typedef std::vector<Vec2d> Polyline;

const double NOWHERE = std::numeric_limits<double>::quiet_NaN();

//! The curve as a function of t.
class EpipolarCurve
{
public:
    EpipolarCurve(const Camera& other, const Matx33d& R, const Vec3d& T, const Vec3d& normal, double tau, const Vec3d& d)
        : other_(other), direction_(R*d), origin_(R*(tau*normal) + T), unit_(1)
    {
        const double distance = cv::norm(origin_);
        if (distance > 0)       // else the curve is one point in any unit
            unit_ = 1/distance;
    }

    //! The parameter of the point at 1/s.
    double parameter(double mu) const { return mu/(mu + unit_); }

    //! Pixel, NaN where there is no image.
    Vec2d at(double t) const
    {
        Vec2d pixel;
        uchar status;
        evaluate(1, &t, &pixel, &status);
        return pixel;
    }

    void evaluate(int n, const double* t, Vec2d* pixel, uchar* status) const
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], w[BLOCK], u[BLOCK], v[BLOCK];
        for (int i = 0; i < n; ++i)
        {
            w[i] = t[i]*unit_;
            const Vec3d X = (1 - t[i])*direction_ + w[i]*origin_;
            x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
            status[i] = REFRACT_OK;
        }
        other_.project(n, x, y, z, w, u, v, status);
        for (int i = 0; i < n; ++i)
            pixel[i] = status[i] == REFRACT_OK ? Vec2d(u[i], v[i]) : Vec2d(NOWHERE, NOWHERE);
    }

private:
    const Camera& other_;
    Vec3d direction_, origin_;  //!< in the frame of the other camera
    double unit_;
};

//! Square of the distance.
double distanceToSegment2(const Vec2d& p, const Vec2d& a, const Vec2d& b)
{
    const Vec2d ab = b - a, ap = p - a;
    const double length2 = ab.dot(ab), t = length2 > 0 ? std::min(1., std::max(0., ap.dot(ab)/length2)) : 0;
    const Vec2d across = ap - t*ab;
    return across.dot(across);
}

/* Whether the curve at the quarters of a segment is within the tolerance of the chord: three points see the largest
distance to within a few percent. A NaN inside (grazing the edge of visibility) is not. */
bool isClose(const Vec2d* quarters, const Vec2d& a, const Vec2d& b, double tolerance)
{
    const double enough = 0.95*tolerance + 1e-13*cv::norm(b);   // far beyond any sensor, pixels are rounding
    bool close = true;
    for (int i = 0; i < 3; ++i)
        close = close && distanceToSegment2(quarters[i], a, b) <= enough*enough;
    return close;
}

void setQuarters(double tA, double tB, double* t)
{
    for (int i = 0; i < 3; ++i)
        t[i] = tA + 0.25*(i + 1)*(tB - tA);
}

//! Appends the nodes after `a` up to `b`, splitting where the curve leaves the chord by more than the tolerance.
void appendSegment(const EpipolarCurve& curve, double tA, const Vec2d& a, double tB, const Vec2d& b, const Vec2d* quarters,
                   double tolerance, int depth, Polyline& line)
{
    if (depth == 0 || std::isnan(quarters[1][0]) || isClose(quarters, a, b, tolerance))
    {
        line.push_back(b);
        return;
    }
    const double tMiddle = 0.5*(tA + tB);
    double t[6];
    Vec2d p[6];
    uchar status[6];
    setQuarters(tA, tMiddle, t);
    setQuarters(tMiddle, tB, t + 3);
    curve.evaluate(6, t, p, status);
    appendSegment(curve, tA, a, tMiddle, quarters[1], p, tolerance, depth - 1, line);
    appendSegment(curve, tMiddle, quarters[1], tB, b, p + 3, tolerance, depth - 1, line);
}

const int SAMPLES = 33;

//! The curve at even steps of t.
struct Samples
{
    Samples(const EpipolarCurve& curve, double tA, double tB)
    {
        for (int i = 0; i < SAMPLES; ++i)
            t[i] = tA + (tB - tA)*i/(SAMPLES - 1);
        curve.evaluate(SAMPLES, t, p, status);
    }
    double t[SAMPLES];
    Vec2d p[SAMPLES];
    uchar status[SAMPLES];
};

typedef AutoBuffer<double, 64> Nodes;

//! Nodes over the samples at equal shares of the chord error.
void placeNodes(const Samples& s, double tolerance, Nodes& nodes)
{
    double density[SAMPLES], share[SAMPLES];
    for (int i = 0; i < SAMPLES; ++i)
    {
        const int c = std::min(std::max(i, 1), SAMPLES - 2);
        const Vec2d bend = s.p[c + 1] - 2*s.p[c] + s.p[c - 1], chord = s.p[c + 1] - s.p[c - 1];
        const double across = std::abs(bend[0]*chord[1] - bend[1]*chord[0])/std::max(cv::norm(chord), DBL_MIN);
        density[i] = std::isfinite(across) ? std::sqrt(across/8/tolerance) : 0;
    }
    share[0] = 0;
    for (int i = 1; i < SAMPLES; ++i)
        share[i] = share[i - 1] + 0.5*(density[i - 1] + density[i]);
    // A little more than the estimate, so that the check of the finished segments seldom has to split one.
    const int segments = std::max(1, (int)std::min(1e4, std::ceil(1.05*share[SAMPLES - 1])));
    nodes.allocate(segments + 1);
    nodes[0] = s.t[0];
    for (int j = 1, i = 1; j < segments; ++j)
    {
        const double wanted = share[SAMPLES - 1]*j/segments;
        while (i < SAMPLES - 1 && share[i] < wanted)
            ++i;
        const double part = (wanted - share[i - 1])/std::max(share[i] - share[i - 1], DBL_MIN);
        nodes[j] = s.t[i - 1] + (s.t[i] - s.t[i - 1])*std::min(1., part);
    }
    nodes[segments] = s.t[SAMPLES - 1];
}

//! The polyline through the nodes, checked between them; as many segments as fill a block at a time.
void joinNodes(const EpipolarCurve& curve, const Nodes& nodes, double tolerance, Polyline& line)
{
    const int segments = (int)nodes.size() - 1, MANY = (BLOCK - 1)/4;
    double t[BLOCK];
    Vec2d p[BLOCK];
    uchar status[BLOCK];
    line.reserve(segments + 1);
    for (int begin = 0; begin < segments; begin += MANY)
    {
        const int count = std::min(MANY, segments - begin);
        for (int j = 0; j < count; ++j)
        {
            t[4*j] = nodes[begin + j];
            setQuarters(nodes[begin + j], nodes[begin + j + 1], t + 4*j + 1);
        }
        t[4*count] = nodes[begin + count];
        curve.evaluate(4*count + 1, t, p, status);
        if (begin == 0)
            line.push_back(p[0]);
        for (int j = 0; j < count; ++j)
            appendSegment(curve, t[4*j], p[4*j], t[4*j + 4], p[4*j + 4], p + 4*j + 1, tolerance, 12, line);
    }
}

//! The end of visibility between a visible and an invisible t, from the visible side.
double edgeOfVisibility(const EpipolarCurve& curve, double visible, double invisible)
{
    const double enough = 1e-9*std::abs(visible - invisible);
    while (std::abs(visible - invisible) > enough)
    {
        const double middle = 0.5*(visible + invisible);
        (std::isnan(curve.at(middle)[0]) ? invisible : visible) = middle;
    }
    return visible;
}

/* The visible part of the samples: one interval, because what lies beyond a window and inside a lens' field is convex.
Returns the status of the far end if nothing is visible. */
uchar visiblePart(const EpipolarCurve& curve, const Samples& s, double& tNear, double& tFar)
{
    int first = 0, last = SAMPLES - 1;
    while (first < SAMPLES && s.status[first] != REFRACT_OK)
        ++first;
    if (first == SAMPLES)
        return s.status[SAMPLES - 1];
    while (s.status[last] != REFRACT_OK)
        --last;
    if (first > 0)
        tNear = edgeOfVisibility(curve, s.t[first], s.t[first - 1]);
    if (last < SAMPLES - 1)
        tFar = edgeOfVisibility(curve, s.t[last], s.t[last + 1]);
    return REFRACT_OK;
}

/* The range of mu in which the ray lies beyond its own window and within the depth range. */
uchar depthToMu(const Camera& camera, double tau, const Vec3d& d, const Vec2d& depthRange, double& muNear, double& muFar)
{
    const Vec3d normal = camera.layers().normal();
    if (!(d[2] > 0))
        return REFRACT_NO_INTERSECTION;
    const double ahead = depthRange[0] - tau*normal[2];
    muNear = ahead > 0 ? d[2]/ahead : DBL_MAX;
    muFar = d[2]/(depthRange[1] - tau*normal[2]);
    muNear = std::min(muNear, camera.layers().leavingMu(tau, normal.dot(d)));
    return muFar >= 0 && muFar < muNear ? REFRACT_OK : REFRACT_BEHIND_WINDOW;
}

uchar tracePolyline(const EpipolarCurve& curve, double tNear, double tFar, double tolerance, Polyline& line)
{
    Samples samples(curve, tNear, tFar);
    double visibleNear = tNear, visibleFar = tFar;
    const uchar status = visiblePart(curve, samples, visibleNear, visibleFar);
    if (status != REFRACT_OK)
        return status;
    if (visibleNear != tNear || visibleFar != tFar)
        samples = Samples(curve, visibleNear, visibleFar);
    Nodes nodes;
    placeNodes(samples, tolerance, nodes);
    joinNodes(curve, nodes, tolerance, line);
    return REFRACT_OK;
}

void writeLines(const std::vector<Polyline>& polylines, int depth, OutputArrayOfArrays lines)
{
    if (lines.fixedType())
        depth = CV_MAT_DEPTH(lines.type(-1));
    lines.create((int)polylines.size(), 1, CV_MAKETYPE(depth, 2), -1, true);
    for (size_t i = 0; i < polylines.size(); ++i)
    {
        const int n = (int)polylines[i].size();
        lines.create(n, 1, CV_MAKETYPE(depth, 2), (int)i, true);
        if (n == 0)
            continue;
        Mat line = lines.getMat((int)i);
        Mat(line.size(), CV_64FC2, (void*)polylines[i].data()).convertTo(line, depth);    // a vector is a row
    }
}

} // namespace

void computeRefractiveEpilines(InputArray points, int whichImage,
                               const Ptr<RefractiveCamera>& camera1, const Ptr<RefractiveCamera>& camera2,
                               InputArray R_, InputArray T_, const Vec2d& depthRange,
                               OutputArrayOfArrays lines, double tolerance, OutputArray status)
{
    CV_INSTRUMENT_REGION();

    if (whichImage != 1 && whichImage != 2)
        CV_Error_(Error::StsBadArg, ("whichImage is %d; it must be 1 or 2", whichImage));
    if (!(depthRange[0] > 0) || !(depthRange[1] > depthRange[0]))
        CV_Error_(Error::StsOutOfRange, ("depthRange is (%g, %g); it must be 0 < near < far", depthRange[0], depthRange[1]));
    if (!(tolerance > 0) || !std::isfinite(tolerance))
        CV_Error_(Error::StsOutOfRange, ("tolerance is %g; it must be positive", tolerance));
    const bool first = whichImage == 1;
    const Camera& from = first ? cameraOf(camera1, "camera1") : cameraOf(camera2, "camera2");
    const Camera& to = first ? cameraOf(camera2, "camera2") : cameraOf(camera1, "camera1");
    const PointReader in(points, 2, "points");
    const Matx33d R12 = readRotation(R_, "R");
    const Vec3d T12 = readVec3(T_, "T");
    const Matx33d R = first ? R12 : R12.t();
    const Vec3d T = first ? T12 : -(R*T12);

    std::vector<Polyline> polylines(in.size());
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double u[BLOCK], v[BLOCK], tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, u, v, NULL, st);
        from.unproject(n, u, v, tau, dx, dy, dz, st);
        for (int i = 0; i < n; ++i)
        {
            const Vec3d d(dx[i], dy[i], dz[i]);
            double muNear, muFar;
            if (st[i] == REFRACT_OK)
                st[i] = depthToMu(from, tau[i], d, depthRange, muNear, muFar);
            if (st[i] != REFRACT_OK)
                continue;
            const EpipolarCurve curve(to, R, T, from.layers().normal(), tau[i], d);
            st[i] = tracePolyline(curve, curve.parameter(muNear), curve.parameter(muFar), tolerance,
                                  polylines[begin + i]);
        }
        outStatus.store(begin, n, st);
    });
    writeLines(polylines, in.depth(), lines);
}

void computeRefractiveEpilines(InputArray points, int whichImage,
                               InputArray cameraMatrix1, InputArray distCoeffs1, const GlassWindow& window1,
                               InputArray cameraMatrix2, InputArray distCoeffs2, const GlassWindow& window2,
                               InputArray R, InputArray T, const Vec2d& depthRange,
                               OutputArrayOfArrays lines, double tolerance, OutputArray status)
{
    computeRefractiveEpilines(points, whichImage, RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                              RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2), R, T, depthRange,
                              lines, tolerance, status);
}

}} // namespace
