// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "rotation.hpp"

/* The curve of possible partners of a pixel: the refracted ray tau n + s d of one camera, seen by the other (raw image).

The parameter is mu = 1/s, in which the image of an evenly spaced row of depths is nearly evenly spaced and infinity is
the ordinary point mu = 0. A chord over a step of mu misses the curve by |second difference across the curve| / 8, so
nodes at equal steps of the integral of its square root share the error evenly: as few points as the tolerance takes. */

namespace cv { namespace refract {

namespace {

typedef std::vector<Vec2d> Polyline;

const double NOWHERE = std::numeric_limits<double>::quiet_NaN();

//! The curve as a function of mu.
class EpipolarCurve
{
public:
    EpipolarCurve(const Camera& other, const Matx33d& R, const Vec3d& T, const Vec3d& normal, double tau, const Vec3d& d)
        : other_(other), direction_(R*d), shift_(R*(tau*normal) + T) {}

    //! Pixel, NaN where there is no image.
    Vec2d at(double mu) const
    {
        Vec2d pixel;
        uchar status;
        evaluate(1, &mu, &pixel, &status);
        return pixel;
    }

    void evaluate(int n, const double* mu, Vec2d* pixel, uchar* status) const
    {
        double x[BLOCK], y[BLOCK], z[BLOCK], u[BLOCK], v[BLOCK];
        for (int i = 0; i < n; ++i)
        {
            const Vec3d X = direction_ + mu[i]*shift_;
            x[i] = X[0]; y[i] = X[1]; z[i] = X[2];
            status[i] = REFRACT_OK;
        }
        other_.project(n, x, y, z, mu, u, v, status);
        for (int i = 0; i < n; ++i)
            pixel[i] = status[i] == REFRACT_OK ? Vec2d(u[i], v[i]) : Vec2d(NOWHERE, NOWHERE);
    }

private:
    const Camera& other_;
    Vec3d direction_, shift_;
};

double distanceToSegment(const Vec2d& p, const Vec2d& a, const Vec2d& b)
{
    const Vec2d ab = b - a, ap = p - a;
    const double length2 = ab.dot(ab), t = length2 > 0 ? std::min(1., std::max(0., ap.dot(ab)/length2)) : 0;
    return cv::norm(ap - t*ab);
}

//! Appends the nodes after `a` up to `b`, splitting where the curve leaves the chord by more than the tolerance.
void appendSegment(const EpipolarCurve& curve, double muA, const Vec2d& a, double muB, const Vec2d& b, double tolerance,
                   int depth, Polyline& line)
{
    double mu[3];
    Vec2d p[3];
    uchar status[3];
    for (int i = 0; i < 3; ++i)
        mu[i] = muA + 0.25*(i + 1)*(muB - muA);
    curve.evaluate(3, mu, p, status);
    // Three points see the largest distance to within a few percent.
    bool close = true;      // a NaN inside (grazing the edge of visibility) compares false and is split as well
    for (int i = 0; i < 3; ++i)
        close = close && distanceToSegment(p[i], a, b) <= 0.97*tolerance;
    if (close || depth == 0 || std::isnan(p[1][0]))
    {
        line.push_back(b);
        return;
    }
    appendSegment(curve, muA, a, mu[1], p[1], tolerance, depth - 1, line);
    appendSegment(curve, mu[1], p[1], muB, b, tolerance, depth - 1, line);
}

const int SAMPLES = 33;

//! Nodes from muA to muB at equal shares of the chord error.
std::vector<double> placeNodes(const EpipolarCurve& curve, double muA, double muB, double tolerance)
{
    double mu[SAMPLES], share[SAMPLES];
    Vec2d p[SAMPLES];
    uchar status[SAMPLES];
    for (int i = 0; i < SAMPLES; ++i)
        mu[i] = muA + (muB - muA)*i/(SAMPLES - 1);
    curve.evaluate(SAMPLES, mu, p, status);
    share[0] = 0;
    for (int i = 1; i < SAMPLES; ++i)
    {
        const int c = std::min(std::max(i, 1), SAMPLES - 2);
        const Vec2d bend = p[c + 1] - 2*p[c] + p[c - 1], chord = p[c + 1] - p[c - 1];
        const double across = std::abs(bend[0]*chord[1] - bend[1]*chord[0])/std::max(cv::norm(chord), DBL_MIN);
        share[i] = share[i - 1] + (std::isfinite(across) ? std::sqrt(across/8/tolerance) : 0);
    }
    // A little more than the estimate, so that the check of the finished segments seldom has to split one.
    const int segments = std::max(1, (int)std::min(1e4, std::ceil(1.05*share[SAMPLES - 1])));
    std::vector<double> nodes(1, muA);
    for (int j = 1, i = 1; j < segments; ++j)
    {
        const double wanted = share[SAMPLES - 1]*j/segments;
        while (i < SAMPLES - 1 && share[i] < wanted)
            ++i;
        const double part = (wanted - share[i - 1])/std::max(share[i] - share[i - 1], DBL_MIN);
        nodes.push_back(mu[i - 1] + (mu[i] - mu[i - 1])*std::min(1., part));
    }
    nodes.push_back(muB);
    return nodes;
}

//! The end of visibility between a visible and an invisible mu, from the visible side.
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

/* The visible part of [muNear, muFar]: one interval, because what lies beyond a window and inside a lens' field is
convex. Returns the status of the far end if nothing is visible. */
uchar visiblePart(const EpipolarCurve& curve, double& muNear, double& muFar)
{
    double mu[SAMPLES];
    Vec2d p[SAMPLES];
    uchar status[SAMPLES];
    for (int i = 0; i < SAMPLES; ++i)
        mu[i] = muNear + (muFar - muNear)*i/(SAMPLES - 1);
    curve.evaluate(SAMPLES, mu, p, status);
    int first = 0, last = SAMPLES - 1;
    while (first < SAMPLES && status[first] != REFRACT_OK)
        ++first;
    if (first == SAMPLES)
        return status[SAMPLES - 1];
    while (status[last] != REFRACT_OK)
        --last;
    if (first > 0)
        muNear = edgeOfVisibility(curve, mu[first], mu[first - 1]);
    if (last < SAMPLES - 1)
        muFar = edgeOfVisibility(curve, mu[last], mu[last + 1]);
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

uchar tracePolyline(const EpipolarCurve& curve, double muNear, double muFar, double tolerance, Polyline& line)
{
    const uchar status = visiblePart(curve, muNear, muFar);
    if (status != REFRACT_OK)
        return status;
    const std::vector<double> nodes = placeNodes(curve, muNear, muFar, tolerance);
    Vec2d a = curve.at(nodes[0]);
    line.assign(1, a);
    for (size_t i = 1; i < nodes.size(); ++i)
    {
        const Vec2d b = curve.at(nodes[i]);
        appendSegment(curve, nodes[i - 1], a, nodes[i], b, tolerance, 12, line);
        a = b;
    }
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
            if (st[i] == REFRACT_OK)
                st[i] = tracePolyline(EpipolarCurve(to, R, T, from.layers().normal(), tau[i], d), muNear, muFar,
                                      tolerance, polylines[begin + i]);
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
