// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays.hpp"
#include "camera.hpp"
#include "kernels.hpp"
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
    EpipolarCurve(const Matx33d& R, const Vec3d& T, const Vec3d& normal, double tau, const Vec3d& d)
        : direction_(R*d), origin_(R*(tau*normal) + T), unit_(1)
    {
        const double distance = cv::norm(origin_);
        if (distance > 0)       // else the curve is one point in any unit
            unit_ = 1/distance;
    }

    //! The parameter of the point at 1/s.
    double parameter(double mu) const { return mu/(mu + unit_); }

    //! The points at t, in the frame of the other camera, times w.
    void points(int n, const double* t, double* x, double* y, double* z, double* w) const
    {
        for (int i = 0; i < n; ++i)
        {
            w[i] = t[i]*unit_;
            x[i] = (1 - t[i])*direction_[0] + w[i]*origin_[0];
            y[i] = (1 - t[i])*direction_[1] + w[i]*origin_[1];
            z[i] = (1 - t[i])*direction_[2] + w[i]*origin_[2];
        }
    }

private:
    Vec3d direction_, origin_;  //!< in the frame of the other camera
    double unit_;
};

//! Points of one or several curves on their way to pixels, a block at a time.
class Projection
{
public:
    explicit Projection(const Camera& other) : other_(other), size_(0) {}
    int room() const { return BLOCK - size_; }
    void clear() { size_ = 0; }
    //! Returns where the points are among all.
    int add(const EpipolarCurve& curve, int n, const double* t)
    {
        const int begin = size_;
        CV_DbgAssert(n <= room());
        curve.points(n, t, x_ + begin, y_ + begin, z_ + begin, w_ + begin);
        std::copy(t, t + n, t_ + begin);
        size_ += n;
        return begin;
    }
    void run()
    {
        std::fill(status_, status_ + size_, (uchar)REFRACT_OK);
        other_.project(size_, x_, y_, z_, w_, u_, v_, status_);
        for (int i = 0; i < size_; ++i)
            if (status_[i] != REFRACT_OK)
                u_[i] = v_[i] = NOWHERE;
    }
    const Camera& camera() const { return other_; }
    double t(int i) const { return t_[i]; }
    Vec2d pixel(int i) const { return Vec2d(u_[i], v_[i]); }    //!< NaN where there is no image
    const double* u(int i) const { return u_ + i; }
    const double* v(int i) const { return v_ + i; }
    uchar status(int i) const { return status_[i]; }

private:
    const Camera& other_;
    int size_;
    double t_[BLOCK], x_[BLOCK], y_[BLOCK], z_[BLOCK], w_[BLOCK], u_[BLOCK], v_[BLOCK];
    uchar status_[BLOCK];
};

/* Adds the segments between nodes to a projection: their ends and middles, and after the last end a point a quarter before
it, so that each segment's fourth point lies elsewhere on the same stretch of the curve. Returns where they begin. */
int addSegments(const EpipolarCurve& curve, const double* nodes, int segments, Projection& p)
{
    double t[BLOCK];
    for (int j = 0; j < segments; ++j)
    {
        t[2*j] = nodes[j];
        t[2*j + 1] = 0.5*(nodes[j] + nodes[j + 1]);
    }
    t[2*segments] = nodes[segments];
    t[2*segments + 1] = 0.5*(nodes[segments] + t[2*segments - 1]);
    return p.add(curve, 2*segments + 2, t);
}

double cross(const Vec2d& a, const Vec2d& b) { return a[0]*b[1] - a[1]*b[0]; }

/* Whether a segment's chord is within the tolerance of the curve, whose distance across the chord is about
(1 - u^2) (middle + skew u), -1 <= u <= 1 by t, which the middle and the fourth point tell, and at most
middle + skew^2/(4 middle) and middle + 0.385 skew. */
bool isClose(const Projection& p, int segment, double tolerance)
{
    const Vec2d a = p.pixel(segment), b = p.pixel(segment + 2), chord = b - a;
    const double length2 = chord.dot(chord), enough = 0.95*tolerance + 1e-13*(std::abs(b[0]) + std::abs(b[1]));
    const double u = 2*(p.t(segment + 3) - p.t(segment + 1))/(p.t(segment + 2) - p.t(segment));
    const double middle = cross(chord, p.pixel(segment + 1) - a), other = cross(chord, p.pixel(segment + 3) - a);
    const double skew = (other/(1 - u*u) - middle)/u;
    double most = std::abs(middle);
    if (skew != 0 && !std::isnan(skew))     // else the fourth point is out of sight
        most += std::min(0.25*skew*skew/most, 0.385*std::abs(skew));
    return most*most <= enough*enough*length2;      // far beyond any sensor, pixels are rounding
}

/* Appends what follows after the first end of a segment, split where the curve leaves the chord by more than the tolerance.
A NaN inside (grazing the edge of visibility) is not split. */
void appendSegment(const EpipolarCurve& curve, const Projection& p, int segment, double tolerance, int depth, Polyline& line)
{
    const Vec2d b = p.pixel(segment + 2);
    if (depth == 0 || std::isnan(p.pixel(segment + 1)[0]) || isClose(p, segment, tolerance))
    {
        line.push_back(b);
        return;
    }
    const double nodes[] = { p.t(segment), p.t(segment + 1), p.t(segment + 2) };
    Projection halves(p.camera());
    addSegments(curve, nodes, 2, halves);
    halves.run();
    appendSegment(curve, halves, 0, tolerance, depth - 1, line);
    appendSegment(curve, halves, 2, tolerance, depth - 1, line);
}

const int SAMPLES = 24;     // of a curve: a few registers

int addSamples(const EpipolarCurve& curve, double tNear, double tFar, Projection& p)
{
    double t[SAMPLES];
    for (int i = 0; i < SAMPLES; ++i)
        t[i] = tNear + (tFar - tNear)*i/(SAMPLES - 1);
    return p.add(curve, SAMPLES, t);
}

//! Appends nodes over a curve's samples at equal shares of the chord error.
void placeNodes(const Projection& p, int samples, double tolerance, std::vector<double>& nodes)
{
    double root[SAMPLES], share[SAMPLES];   // root of the distance from the neighbours' chord; its sum so far
    double slope[SAMPLES];                  // of t by that sum, to the next sample
    kernels().chordRoots(SAMPLES - 2, p.u(samples), p.v(samples), root + 1);
    root[0] = root[1];
    root[SAMPLES - 1] = root[SAMPLES - 2];
    share[0] = 0;
    for (int i = 1; i < SAMPLES; ++i)
        share[i] = share[i - 1] + root[i - 1] + root[i];
    // The chord of neighbours is two steps long, so its distance is four times a single step's. A little more than the estimate,
    // so that the check of the finished segments seldom has to split one.
    const double estimate = 0.5*share[SAMPLES - 1]/std::sqrt(4*tolerance);
    const int segments = std::max(1, (int)std::min(1e4, std::ceil(1.05*estimate)));
    const double first = p.t(samples), step = p.t(samples + 1) - first, part = share[SAMPLES - 1]/segments;
    for (int i = 0; i < SAMPLES - 1; ++i)
        slope[i] = step/std::max(share[i + 1] - share[i], DBL_MIN);
    nodes.push_back(first);
    for (int j = 1, i = 0; j < segments; ++j)
    {
        while (i < SAMPLES - 2 && share[i + 1] < j*part)
            ++i;
        nodes.push_back(first + i*step + (j*part - share[i])*slope[i]);
    }
    nodes.push_back(p.t(samples + SAMPLES - 1));
}

//! The end of visibility between a visible and an invisible t, from the visible side.
double edgeOfVisibility(const EpipolarCurve& curve, const Camera& other, double visible, double invisible)
{
    const double enough = 1e-9*std::abs(visible - invisible);
    Projection p(other);
    while (std::abs(visible - invisible) > enough)
    {
        const double middle = 0.5*(visible + invisible);
        p.clear();
        p.add(curve, 1, &middle);
        p.run();
        (p.status(0) == REFRACT_OK ? visible : invisible) = middle;
    }
    return visible;
}

/* Nodes of the visible part of the curve: one interval, because what lies beyond a window and inside a lens' field is
convex. Returns the status of the far end if nothing is visible. */
uchar placeVisibleNodes(const EpipolarCurve& curve, const Projection& p, int samples, double tolerance,
                        std::vector<double>& nodes)
{
    int first = 0, last = SAMPLES - 1;
    while (first < SAMPLES && p.status(samples + first) != REFRACT_OK)
        ++first;
    if (first == SAMPLES)
        return p.status(samples + SAMPLES - 1);
    while (p.status(samples + last) != REFRACT_OK)
        --last;
    if (first == 0 && last == SAMPLES - 1)
    {
        placeNodes(p, samples, tolerance, nodes);
        return REFRACT_OK;
    }
    const auto edge = [&](int visible, int step)
    {
        const int beyond = visible + step;
        return beyond < 0 || beyond == SAMPLES
            ? p.t(samples + visible) : edgeOfVisibility(curve, p.camera(), p.t(samples + visible), p.t(samples + beyond));
    };
    Projection visible(p.camera());
    addSamples(curve, edge(first, -1), edge(last, 1), visible);
    visible.run();
    placeNodes(visible, 0, tolerance, nodes);
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

//! A curve to be drawn.
struct Track
{
    EpipolarCurve curve;
    int point;                  //!< of the block
    double tNear, tFar;
    int nodes, segments;        //!< its first node among those of all, and how many segments follow
};

//! Nodes of all tracks; several tracks are projected together. A track without a visible part gets no segments.
void placeAllNodes(const Camera& to, std::vector<Track>& tracks, double tolerance, std::vector<double>& nodes, uchar* status)
{
    Projection p(to);
    const int TOGETHER = BLOCK/SAMPLES, count = (int)tracks.size();
    for (int begin = 0; begin < count; begin += TOGETHER)
    {
        const int end = std::min(begin + TOGETHER, count);
        p.clear();
        for (int i = begin; i < end; ++i)
            addSamples(tracks[i].curve, tracks[i].tNear, tracks[i].tFar, p);
        p.run();
        for (int i = begin; i < end; ++i)
        {
            Track& track = tracks[i];
            track.nodes = (int)nodes.size();
            status[track.point] = placeVisibleNodes(track.curve, p, SAMPLES*(i - begin), tolerance, nodes);
            track.segments = std::max(0, (int)nodes.size() - track.nodes - 1);
        }
    }
}

//! Polylines of a block of points, one after the other.
struct Polylines
{
    Polyline points;
    int end[BLOCK] = {};        //!< of each in points
};

//! Joins the nodes of all tracks; as many segments as fit are projected together.
void joinAllNodes(const Camera& to, const std::vector<Track>& tracks, const std::vector<double>& nodes, double tolerance,
                  Polylines& lines)
{
    struct Piece { const Track* track; int begin, segments; bool isFirst; };
    std::vector<Piece> pieces;
    Projection p(to);
    const auto join = [&]
    {
        p.run();
        for (const Piece& piece : pieces)
        {
            if (piece.isFirst)
                lines.points.push_back(p.pixel(piece.begin));
            for (int j = 0; j < piece.segments; ++j)
                appendSegment(piece.track->curve, p, piece.begin + 2*j, tolerance, 12, lines.points);
            lines.end[piece.track->point] = (int)lines.points.size();
        }
        pieces.clear();
        p.clear();
    };
    for (const Track& track : tracks)
        for (int done = 0, segments; done < track.segments; done += segments)
        {
            if (p.room() < std::min(2*(track.segments - done) + 2, BLOCK/2))
                join();
            segments = std::min(track.segments - done, p.room()/2 - 1);
            pieces.push_back({ &track, addSegments(track.curve, &nodes[track.nodes + done], segments, p), segments, done == 0 });
        }
    join();
}

void writeLines(const std::vector<Polylines>& blocks, int count, int depth, OutputArrayOfArrays lines)
{
    if (lines.fixedType())
        depth = CV_MAT_DEPTH(lines.type(-1));
    lines.create(count, 1, CV_MAKETYPE(depth, 2), -1, true);
    for (int i = 0, begin = 0; i < count; ++i)
    {
        const Polylines& block = blocks[i/BLOCK];
        if (i % BLOCK == 0)
            begin = 0;
        const int n = std::max(0, block.end[i % BLOCK] - begin);
        lines.create(n, 1, CV_MAKETYPE(depth, 2), i, true);
        if (n == 0)
            continue;
        Mat line = lines.getMat(i);
        Mat(line.size(), CV_64FC2, (void*)(block.points.data() + begin)).convertTo(line, depth);    // a vector is a row
        begin += n;
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

    std::vector<Polylines> blocks((in.size() + BLOCK - 1)/BLOCK);
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), [&](int begin, int n)
    {
        double u[BLOCK], v[BLOCK], tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, u, v, NULL, st);
        from.unproject(n, u, v, tau, dx, dy, dz, st);
        std::vector<Track> tracks;
        std::vector<double> nodes;
        tracks.reserve(n);
        for (int i = 0; i < n; ++i)
        {
            const Vec3d d(dx[i], dy[i], dz[i]);
            double muNear, muFar;
            if (st[i] == REFRACT_OK)
                st[i] = depthToMu(from, tau[i], d, depthRange, muNear, muFar);
            if (st[i] != REFRACT_OK)
                continue;
            const EpipolarCurve curve(R, T, from.layers().normal(), tau[i], d);
            tracks.push_back({ curve, i, curve.parameter(muNear), curve.parameter(muFar), 0, 0 });
        }
        placeAllNodes(to, tracks, tolerance, nodes, st);
        joinAllNodes(to, tracks, nodes, tolerance, blocks[begin/BLOCK]);
        outStatus.store(begin, n, st);
    });
    writeLines(blocks, in.size(), in.depth(), lines);
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
