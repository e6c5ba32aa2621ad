// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/wedge.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

Matx33d windowAxes(const Vec3d& n)
{
    const Vec3d e1 = normalize(Vec3d(1, 0, 0) - n[0]*n), e2 = n.cross(e1);
    return Matx33d(e1[0], e1[1], e1[2], e2[0], e2[1], e2[2], n[0], n[1], n[2]);
}

//! cos a, sin(a)/a and the derivative of the latter over a: entire functions of a^2.
struct Turn
{
    explicit Turn(double a) : cosine(std::cos(a)), sine(1), bend(-1./3)
    {
        const double a2 = a*a;
        if (a > 0)
            sine = std::sin(a)/a;
        bend = a < 0.02 ? -1./3 + a2*(1./30 - a2/840) : (cosine - sine)/a2;
    }
    double cosine, sine, bend;
};

//! @param height where the face meets the axis
static Face faceOf(const Vec2d& W, double height, double before, double after, double slope)
{
    const Turn turn(norm(W));
    const double m[] = { turn.sine*W[0], turn.sine*W[1], turn.cosine };
    Face face = { { m[0], m[1], m[2] }, m[2]*height, after, (after - before)*(after + before), m[2],
                  // e1 turns with n by -(e1.dn) n - slope (e2.dn) e2: it stays across the camera's x axis
                  { { m[2], 0, -m[0] }, { slope*m[1], m[2] - slope*m[0], -m[1] } }, {}, {} };
    for (int j = 0; j < 2; j++)
    {
        for (int k = 0; k < 2; k++)
            face.byLean[j][k] = turn.bend*W[j]*W[k] + (j == k ? turn.sine : 0);
        face.byLean[j][2] = -m[j];
        face.distanceByLean[j] = -m[j]*height;
    }
    return face;
}

std::vector<Face> facesOf(const GlassWindow& window)
{
    const Vec3d n = normalize(window.normal);
    const double slope = n[0]/std::sqrt(n[1]*n[1] + n[2]*n[2]);
    std::vector<Face> faces;
    faces.reserve(window.thickness.size() + 1);
    Vec2d lean;
    double height = window.distance, before = window.innerIndex;
    for (size_t i = 0; i <= window.thickness.size(); i++)
    {
        const double after = i < window.index.size() ? window.index[i] : window.outerIndex;
        faces.push_back(faceOf(lean, height, before, after, slope));
        if (i == window.thickness.size())
            break;
        lean += window.wedge.empty() ? Vec2d() : window.wedge[i];
        height += window.thickness[i];
        before = after;
    }
    return faces;
}

//! The spheres stay where they are; the axis is the one through the other camera and their centre. Leaning faces have no common one.
static GlassWindow bentInFrame(GlassWindow window, const Matx33d& R, const Vec3d& T)
{
    if (std::any_of(window.wedge.begin(), window.wedge.end(), [](const Vec2d& w) { return w != Vec2d(); }))
        CV_Error(Error::StsNotImplemented, "a bent pane with a wedge belongs to one camera; make its curvature or its wedge 0");
    const double k = window.curvature, side = 1 - k*window.distance;
    const Vec3d n = R*window.normal, gradient = side*n - k*T;       // at the other camera, of which 1/k times leads to the centre
    const double length = norm(gradient);
    window.normal = gradient/length;
    window.distance = (window.distance*(1 + side) + 2*side*n.dot(T) - k*T.dot(T))/(1 + length);
    return window;
}

GlassWindow windowInFrame(GlassWindow window, const Matx33d& R, const Vec3d& T)
{
    if (hasCenter(window.shape))
    {
        window.center = R*window.center + T;
        window.axis = R*window.axis;
        return window;
    }
    if (window.shape == WINDOW_BENT)
        return bentInFrame(window, R, T);
    const Matx33d here = windowAxes(normalize(window.normal));
    std::vector<Face> faces;
    if (!window.wedge.empty())
        faces = facesOf(window);
    window.normal = R*window.normal;
    window.distance += window.normal.dot(T);
    if (faces.empty())
        return window;
    const Matx33d there = windowAxes(normalize(window.normal)), turn = there*R*here.t();    // about n
    double before = window.distance;
    for (size_t i = 0; i < window.wedge.size(); i++)
    {
        const Face& face = faces[i + 1];
        const Vec3d normal = R*(here.t()*Vec3d(face.normal));
        const double height = (face.distance + normal.dot(T))/face.byHeight;
        window.thickness[i] = height - before;
        window.wedge[i] = Vec2d(turn(0, 0)*window.wedge[i][0] + turn(0, 1)*window.wedge[i][1],
                                turn(1, 0)*window.wedge[i][0] + turn(1, 1)*window.wedge[i][1]);
        before = height;
    }
    return window;
}

}} // namespace
