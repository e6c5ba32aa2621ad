// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/curved.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

static CurvedFace faceBetween(double before, double after)
{
    return { { 0, 0, 0 }, 0, 0, after, (after - before)*(after + before), 0, 0 };
}

Matx33d tubeAxes(const Vec3d& axis)
{
    const Vec3d a = normalize(axis);
    const Matx32d e = tangents(a);
    return Matx33d(e(0, 0), e(1, 0), e(2, 0), e(0, 1), e(1, 1), e(2, 1), a[0], a[1], a[2]);
}

std::vector<CurvedFace> tubeFaces(const GlassWindow& window)
{
    // (|X - S|^2 - R^2)/(2R) = 0 across the axis
    const Vec3d S = tubeAxes(window.axis)*window.center;
    const double offset = std::sqrt(S[0]*S[0] + S[1]*S[1]);
    std::vector<CurvedFace> faces;
    double radius = window.radius, before = window.innerIndex;
    for (size_t i = 0; i <= window.thickness.size(); i++)
    {
        const double after = i < window.index.size() ? window.index[i] : window.outerIndex;
        CurvedFace face = faceBetween(before, after);
        face.curvature = 1/radius;
        face.gradient[0] = -S[0]/radius;
        face.gradient[1] = -S[1]/radius;
        face.distance = 0.5*(radius - offset)*(1 + offset/radius);
        faces.push_back(face);
        if (i < window.thickness.size())
            radius += window.thickness[i];
        before = after;
    }
    return faces;
}

std::vector<CurvedFace> bentFaces(const GlassWindow& window, const std::vector<Face>& tangents)
{
    std::vector<CurvedFace> faces;
    double height = window.distance, before = window.innerIndex;
    for (size_t i = 0; i < tangents.size(); i++)
    {
        const double *m = tangents[i].normal, concentric = 1/(1 + window.curvature*(height - window.distance));
        CurvedFace face = faceBetween(before, tangents[i].after);
        face.height = height;
        face.curvature = window.curvature*concentric;
        face.byCurvature = concentric*concentric;
        // m.Y + curvature/2 |Y|^2 = 0 with Y = X - height n
        const double g[] = { m[0], m[1], m[2] - face.curvature*height };
        std::copy_n(g, 3, face.gradient);
        face.distance = height*(m[2] - 0.5*face.curvature*height);
        faces.push_back(face);
        if (i < window.thickness.size())
            height += window.thickness[i];
        before = tangents[i].after;
    }
    return faces;
}

Surface surfaceOf(const CurvedFaces& window, const CurvedFace& face)
{
    const Vec3d normal = Matx33d(window.axes).t()*Vec3d(face.gradient);
    Surface surface = { { normal[0], normal[1], normal[2] }, face.distance, face.curvature, { 0, 0, 0 }, { 0, 0, 0 } };
    if (window.third == 0)
        std::copy_n(window.axes + 6, 3, surface.axis);
    return surface;
}

uchar traceCurved(const CurvedFaces& window, Vec3d& P, Vec3d& p)
{
    P = Vec3d();
    p = window.inner*normalize(p);
    if (!(window.third == 0 ? norm(Vec2d(p[0], p[1])) > ALONG_AXIS*window.inner : p[2] > 0))
        return REFRACT_BEHIND_WINDOW;
    for (int k = 0; k < window.count; k++)
    {
        const CurvedFace& face = window.faces[k];
        const Vec3d K(face.curvature, face.curvature, face.curvature*window.third), g(face.gradient);
        const Vec3d KP = K.mul(P), Kp = K.mul(p), slope = g + KP;
        const double b = slope.dot(p), ahead = face.distance - g.dot(P) - 0.5*P.dot(KP), bend = p.dot(Kp);
        const double c2 = b*b + 2*bend*ahead, c = std::sqrt(c2), s = b > 0 ? 2*ahead/(b + c) : (c - b)/bend;
        if (!(c2 > 0 && s >= window.least && s <= DBL_MAX))
            return REFRACT_BEHIND_WINDOW;
        const Vec3d m = slope + s*Kp;
        P += s*p;
        if (!(c2 + face.excess > 0))
            return REFRACT_TOTAL_REFLECTION;
        p += (std::sqrt(c2 + face.excess) - c)*m;
    }
    return REFRACT_OK;
}

bool doesReach(const CurvedFaces& window, const Vec3d& X, double w, const Vec3d& direction)
{
    const double NEAR = 1e-9;
    Vec3d P, p = direction;
    if (traceCurved(window, P, p) != REFRACT_OK)
        return false;
    const Vec3d way = X - w*P;
    return way.dot(p) > 0 && norm(way.cross(p)) <= NEAR*window.outer*norm(X);
}

namespace {

//! By how much the ray of a direction misses X/w, times w; false: it finds no way out, or leaves the point behind.
bool missOf(const CurvedFaces& window, const Vec3d& X, double w, const Vec3d& direction, Vec3d& P, Vec3d& p, Vec3d& miss, double& s)
{
    p = direction;
    if (traceCurved(window, P, p) != REFRACT_OK)
        return false;
    const Vec3d way = X - w*P;
    s = way.dot(p)/(window.outer*window.outer);
    miss = way - s*p;
    return s > 0;
}

//! By how much the unit direction turns as a finite point moves.
Vec3d turnOf(const CurvedFaces& window, const Vec3d& direction, const Vec3d& point, const Vec3d& motion)
{
    const Matx33d axes(window.axes);
    const Vec3d X = axes.t()*point, d = axes.t()*direction;
    Matx33d rows = Matx33d::eye(), byPoint;
    const Columns none = { nullptr, 0, 0 };
    curvedKernels().chain(window, 3, 1, &X[0], &X[1], &X[2], &d[0], &d[1], &d[2], { rows.val, 3, 1 }, { byPoint.val, 3, 1 }, none);
    return axes*(byPoint*(axes.t()*motion));
}

} // namespace

void approachPoint(const CurvedFaces& window, const Vec3d& X, double w, Vec3d& direction)
{
    const int STEPS = 100;
    const double LEAST = 1e-6;
    const double FAR = 1e8;         // of the way to the window, instead of infinitely far
    Vec3d P, p, miss;
    double s;
    if (!missOf(window, X, w, direction = normalize(direction), P, p, miss, s))
        return;
    for (int k = 0; k < STEPS; k++)
    {
        const double reach = w > 0 ? s/w : FAR*norm(P);
        const Vec3d turn = turnOf(window, direction, P + reach*p, (reach/s)*miss);
        double part = 1;
        for (; part > LEAST; part *= 0.5)
        {
            Vec3d next = normalize(direction + part*turn), nextP, nextp, nextMiss;
            double nextS;
            if (missOf(window, X, w, next, nextP, nextp, nextMiss, nextS) && norm(nextMiss) < norm(miss))
            {
                direction = next; P = nextP; p = nextp; miss = nextMiss; s = nextS;
                break;
            }
        }
        if (!(part > LEAST))
            return;
    }
}

}} // namespace
