// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/epipolar_curve.hpp"
#include "points/point_kernels.hpp"
#include "math/rotation.hpp"

/* The curve of possible partners of a pixel, as a polyline. A chord over a step of t misses the curve by |second difference
across the curve| / 8, so nodes at equal steps of the integral of its square root share the error evenly: as few points as the
tolerance takes. */

namespace cv { namespace refract {

namespace {

typedef std::vector<Vec2d> Polyline;

/* Adds the segments between nodes to a projection: their ends, then their middles and a point a quarter before the last end,
so that each segment's next middle lies elsewhere on the same stretch of the curve. Returns where the ends begin. */
int addSegments(const EpipolarCurve& curve, const double* nodes, int segments, Projection& p)
{
    double middles[Projection::CAPACITY/2];
    for (int j = 0; j < segments; j++)
        middles[j] = 0.5*(nodes[j] + nodes[j + 1]);
    middles[segments] = 0.5*(nodes[segments] + 0.5*(nodes[segments - 1] + nodes[segments]));
    const int begin = p.add(curve, segments + 1, nodes);
    p.add(curve, segments + 1, middles);
    return begin;
}

/* Appends what follows after the first end of segments, which are split where the curve leaves the chord by more than the
tolerance. A NaN inside (grazing the edge of visibility) is not split. False, with the line cut off somewhere, if that takes more
than `most` points, as where the tolerance is less than the rounding of pixels far off. */
bool appendSegments(const EpipolarCurve& curve, const Projection& p, int begin, int segments, double tolerance, int depth,
                    size_t most, Polyline& line)
{
    double slack[Projection::CAPACITY/2];       // NaN where a segment is not close
    const double *t = p.t() + begin, *u = p.u() + begin, *v = p.v() + begin;
    const int middles = segments + 1;
    const bool allClose = pointKernels().areClose(segments, tolerance, t, u, v, t + middles, u + middles, v + middles, slack);
    for (int j = 0; j < segments; j++)
        if (allClose || !std::isnan(slack[j]) || std::isnan(u[middles + j]))
            line.push_back(Vec2d(u[j + 1], v[j + 1]));
        else if (depth == 0 || line.size() >= most)
            return false;
        else
        {
            const double nodes[] = { t[j], t[middles + j], t[j + 1] };
            Projection halves(p.camera());
            addSegments(curve, nodes, 2, halves);
            halves.run();
            if (!appendSegments(curve, halves, 0, 2, tolerance, depth - 1, most, line))
                return false;
        }
    return true;
}

const int SAMPLES = 24;     // of a curve: a few registers

//! Appends nodes over a curve's samples at equal shares of the chord error.
void placeNodes(const Projection& p, int samples, double tolerance, std::vector<double>& nodes)
{
    double root[SAMPLES], share[SAMPLES];   // root of the distance from the neighbours' chord; its sum so far
    double slope[SAMPLES];                  // of t by that sum, to the next sample
    pointKernels().chordRoots(SAMPLES - 2, p.u() + samples, p.v() + samples, root + 1);
    root[0] = root[1];
    root[SAMPLES - 1] = root[SAMPLES - 2];
    share[0] = 0;
    for (int i = 1; i < SAMPLES; i++)
        share[i] = share[i - 1] + root[i - 1] + root[i];
    // The chord of neighbours is two steps long, so its distance is four times a single step's. A little more than the estimate,
    // so that the check of the finished segments rarely has to split one.
    const double estimate = 0.5*share[SAMPLES - 1]/std::sqrt(4*tolerance);
    const int segments = std::max(1, (int)std::min(1e4, std::ceil(1.05*estimate)));
    const double first = p.t()[samples], step = p.t()[samples + 1] - first, part = share[SAMPLES - 1]/segments;
    for (int i = 0; i < SAMPLES - 1; i++)
        slope[i] = step/std::max(share[i + 1] - share[i], DBL_MIN);
    nodes.push_back(first);
    for (int j = 1, i = 0; j < segments; j++)
    {
        while (i < SAMPLES - 2 && share[i + 1] < j*part)
            i++;
        nodes.push_back(first + i*step + (j*part - share[i])*slope[i]);
    }
    nodes.push_back(p.t()[samples + SAMPLES - 1]);
}

//! Appends nodes of the visible part of a curve. Returns the status of the far end if nothing is visible.
uchar placeVisibleNodes(const EpipolarCurve& curve, const Projection& p, int samples, double tolerance,
                        std::vector<double>& nodes)
{
    const double wholeNear = p.t()[samples], wholeFar = p.t()[samples + SAMPLES - 1];
    double tNear, tFar;
    Projection other(p.camera());
    if (!visiblePart(curve, p, samples, SAMPLES, tNear, tFar))
    {
        addSamples(curve, wholeNear, wholeFar, Projection::CAPACITY, other);       // a closer look
        other.run();
        if (!visiblePart(curve, other, 0, Projection::CAPACITY, tNear, tFar))
            return p.status(samples + SAMPLES - 1);
    }
    if (tNear == wholeNear && tFar == wholeFar)
    {
        placeNodes(p, samples, tolerance, nodes);
        return REFRACT_OK;
    }
    other.clear();
    addSamples(curve, tNear, tFar, SAMPLES, other);
    other.run();
    placeNodes(other, 0, tolerance, nodes);
    return REFRACT_OK;
}

/* The range of mu in which the ray lies beyond its own window and within the depth range. */
uchar depthToMu(const Camera& camera, const Rays& rays, int i, const Vec2d& depthRange, double& muNear, double& muFar)
{
    const double originZ = rays.origin(i, camera.layers().normal())[2], dz = rays.dz[i];
    if (!(dz > 0))
        return REFRACT_NO_INTERSECTION;
    const double ahead = depthRange[0] - originZ;
    muNear = ahead > 0 ? dz/ahead : DBL_MAX;
    muFar = dz/(depthRange[1] - originZ);
    muNear = std::min(muNear, camera.layers().leavingMu(rays, i));
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
    const int TOGETHER = Projection::CAPACITY/SAMPLES, count = (int)tracks.size();
    for (int begin = 0; begin < count; begin += TOGETHER)
    {
        const int end = std::min(begin + TOGETHER, count);
        p.clear();
        for (int i = begin; i < end; i++)
            addSamples(tracks[i].curve, tracks[i].tNear, tracks[i].tFar, SAMPLES, p);
        p.run();
        for (int i = begin; i < end; i++)
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

/** Joins the nodes of all tracks; as many segments as fit are projected together. A line of too many points is left empty, and has
the status. */
void joinAllNodes(const Camera& to, const std::vector<Track>& tracks, const std::vector<double>& nodes, double tolerance,
                  Polylines& lines, uchar* status)
{
    struct Piece { const Track* track; int begin, segments; bool isFirst; };
    std::vector<Piece> pieces;
    lines.points.reserve(nodes.size());
    Projection p(to);
    const size_t MOST = 100000;     // points of a line
    size_t first = 0;               // of the line that is made
    const auto join = [&]
    {
        p.run();
        for (const Piece& piece : pieces)
        {
            const int point = piece.track->point;
            if (status[point] != REFRACT_OK)
                continue;
            if (piece.isFirst)
            {
                first = lines.points.size();
                lines.points.push_back(p.pixel(piece.begin));
            }
            if (!appendSegments(piece.track->curve, p, piece.begin, piece.segments, tolerance, 30, first + MOST, lines.points))
            {
                lines.points.resize(first);
                status[point] = REFRACT_NOT_CONVERGED;
            }
            lines.end[point] = (int)lines.points.size();
        }
        pieces.clear();
        p.clear();
    };
    for (const Track& track : tracks)
        for (int done = 0, segments; done < track.segments; done += segments)
        {
            if (p.room() < std::min(2*(track.segments - done) + 2, Projection::CAPACITY/2))
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
    for (int i = 0, begin = 0; i < count; i++)
    {
        const Polylines& block = blocks[i/BLOCK];
        if (i % BLOCK == 0)
            begin = 0;
        const int n = std::max(0, block.end[i % BLOCK] - begin);
        lines.create(n, 1, CV_MAKETYPE(depth, 2), i, true);
        if (n == 0)
            continue;
        Mat line = lines.getMat(i);
        const Vec2d* points = block.points.data() + begin;
        if (depth == CV_64F)
            std::copy(points, points + n, line.ptr<Vec2d>());
        else
            std::copy(points, points + n, line.ptr<Vec2f>());
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
    const Vec2d range = readDepthRange(depthRange, false);
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

    // A segment is measured in its middle. Where the curvature jumps, another of its points lies up to twice as far off.
    const double atMiddle = to.lens().isSmooth() ? tolerance : 0.5*tolerance;
    std::vector<Polylines> blocks((in.size() + BLOCK - 1)/BLOCK);
    StatusWriter outStatus(status, in.size());
    forEachBlock(in.size(), 150*POINT_COST, [&](int begin, int n)
    {
        Rays rays;
        double u[BLOCK], v[BLOCK];
        uchar st[BLOCK];
        in.load(begin, n, u, v, NULL, st);
        from.unproject(n, u, v, rays, st);
        std::vector<Track> tracks;
        std::vector<double> nodes;
        tracks.reserve(n);
        for (int i = 0; i < n; i++)
        {
            double muNear, muFar;
            if (st[i] == REFRACT_OK)
                st[i] = depthToMu(from, rays, i, range, muNear, muFar);
            if (st[i] != REFRACT_OK)
                continue;
            const EpipolarCurve curve(R, T, rays.origin(i, from.layers().normal()), rays.direction(i));
            tracks.push_back({ curve, i, curve.parameter(muNear), curve.parameter(muFar), 0, 0 });
        }
        placeAllNodes(to, tracks, atMiddle, nodes, st);
        joinAllNodes(to, tracks, nodes, atMiddle, blocks[begin/BLOCK], st);
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
