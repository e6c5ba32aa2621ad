// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/curved_path.hpp"
#include "window/curved.hpp"

/* If no face leans, a path stays in the plane of the window's normal and the point, and one angle is unknown: at 0 the ray passes the
point on the axis' side, and somewhere before it finds no way out it passes on the other, if there is a path. Faces that lean
move that path a little: damped Newton steps go there, from it or, where light does not take it, from nearer to the axis. */

namespace cv { namespace refract {

namespace {

//! The faces as if none leaned.
std::vector<CurvedFace> uprightFaces(const CurvedFaces& window)
{
    std::vector<CurvedFace> faces(window.faces, window.faces + window.count);
    for (CurvedFace& face : faces)
    {
        face.gradient[0] = face.gradient[1] = 0;
        face.gradient[2] = 1 - face.curvature*face.height;
        face.distance = face.height*(1 - 0.5*face.curvature*face.height);
    }
    return faces;
}

bool isUpright(const CurvedFaces& window)
{
    for (int k = 0; k < window.count; k++)
        if (window.faces[k].gradient[0] != 0 || window.faces[k].gradient[1] != 0)
            return false;
    return true;
}

//! By halves of the angle at the camera.
uchar findInPlane(const CurvedFaces& window, const Vec3d& X, double w, Vec3d& direction)
{
    const double away = std::sqrt(X[0]*X[0] + X[1]*X[1]);
    const Vec3d across = away > 0 ? Vec3d(X[0]/away, X[1]/away, 0) : Vec3d();
    const auto at = [&](double angle) { return std::sin(angle)*across + Vec3d(0, 0, std::cos(angle)); };
    double low = 0, high = CV_PI/2;
    uchar beyond = REFRACT_BEHIND_WINDOW;       // of high: why it has no light
    for (double middle; away > 0 && (middle = 0.5*(low + high)) > low && middle < high;)
    {
        Vec3d P, p = at(middle);
        const uchar status = traceCurved(window, P, p);
        const Vec3d way = X - w*P;
        const bool isShort = status == REFRACT_OK && way.dot(across)*p[2] > way[2]*p.dot(across);
        (isShort ? low : high) = middle;
        if (!isShort)
            beyond = status;
    }
    direction = at(low);
    return doesReach(window, X, w, direction) ? (uchar)REFRACT_OK : beyond == REFRACT_OK ? (uchar)REFRACT_NOT_CONVERGED : beyond;
}

} // namespace

uchar findBentPath(const CurvedFaces& window, const Vec3d& X, double w, Vec3d& direction)
{
    const std::vector<CurvedFace> faces = uprightFaces(window);
    CurvedFaces upright = window;
    upright.faces = faces.data();
    const uchar status = findInPlane(upright, X, w, direction);
    if (status == REFRACT_OK && isUpright(window))
        return status;
    const Vec3d ahead(0, 0, 1);
    for (Vec3d start : { direction, Vec3d(direction + 0.1*ahead), ahead })
    {
        approachPoint(window, X, w, start);
        direction = start;
        if (doesReach(window, X, w, direction))
            return REFRACT_OK;
    }
    return status != REFRACT_OK ? status : (uchar)REFRACT_NOT_CONVERGED;
}

}} // namespace
