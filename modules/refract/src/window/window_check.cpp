// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/parameters.hpp"

/* What is no window, and why. */

namespace cv { namespace refract {

//! layer >= 0: the name's element. Nothing is formatted unless it is wrong: cameras may be made by the call.
static void checkBetween(const char* name, double value, double least, double most, int layer = -1)
{
    if (value >= least && value <= most)
        return;
    const String element = layer < 0 ? String() : format("[%d]", layer);
    if (value > most && std::isfinite(value))
        CV_Error_(Error::StsOutOfRange, ("%s%s is %g; it must be at most %g", name, element.c_str(), value, most));
    CV_Error_(Error::StsOutOfRange, ("%s%s is %g; it must be finite and at least %g", name, element.c_str(), value, least));
}

//! Faces that lean by a right angle are no window; and where a thickness is 0, faces that lean meet on the axis.
static void checkWedge(const GlassWindow& window)
{
    if (!window.wedge.empty() && window.wedge.size() != window.thickness.size())
        CV_Error_(Error::StsUnmatchedSizes, ("window.wedge has %d layers, window.thickness %d; it must be empty, or they must agree",
                                             (int)window.wedge.size(), (int)window.thickness.size()));
    Vec2d lean;
    for (size_t i = 0; i < window.wedge.size(); i++)
    {
        const Vec2d& w = window.wedge[i];
        lean += w;
        if (!(cv::norm(w) < CV_PI/2))
            CV_Error_(Error::StsOutOfRange, ("window.wedge[%d] is (%g, %g); it must be finite and below 90 degrees, in radians", (int)i,
                                             w[0], w[1]));
        if (!(cv::norm(lean) < CV_PI/2))
            CV_Error_(Error::StsOutOfRange, ("window.wedge[0] to [%d] add up to (%g, %g); that must be below 90 degrees, in radians",
                                             (int)i, lean[0], lean[1]));
    }
    const bool isTilted = std::any_of(window.wedge.begin(), window.wedge.end(), [](const Vec2d& w) { return w != Vec2d(); });
    for (size_t i = 0; isTilted && i < window.thickness.size(); i++)
        if (!(window.thickness[i] > 0))
            CV_Error_(Error::StsOutOfRange, ("window.thickness[%d] is %g; it must be positive in a window with a wedge", (int)i,
                                             window.thickness[i]));
}

//! What the other shape has is not silently ignored.
static void checkUnused(const char* name, bool isInitial, const char* text, const char* shape)
{
    if (!isInitial)
        CV_Error_(Error::StsBadArg, ("window.%s is set, but the window is %s: it must stay %s", name, shape, text));
}

static void checkPane(const GlassWindow& window)
{
    const Vec3d& normal = window.normal;
    const double length = cv::norm(normal);
    // Room for a normal that was stored as float or printed with six digits; the kernels normalise once more.
    if (!(std::abs(length - 1) < 1e-5))
        CV_Error_(Error::StsBadArg, ("window.normal is (%g, %g, %g) with length %g; it must be a unit vector",
                                     normal[0], normal[1], normal[2], length));
    if (!(normal[2] > 0))
        CV_Error_(Error::StsBadArg, ("window.normal is (%g, %g, %g); it must point from the camera to the scene, "
                                     "normal[2] > 0", normal[0], normal[1], normal[2]));
    checkBetween("window.distance", window.distance, 0, MAX_LENGTH);
}

//! What only a shape about a centre or an axis has, and the curvature.
static void checkNotRound(const GlassWindow& window, const char* shape)
{
    checkUnused("center", window.center == Vec3d(), "(0, 0, 0)", shape);
    checkUnused("axis", window.axis == Vec3d(), "(0, 0, 0)", shape);
    checkUnused("radius", window.radius == 0, "0", shape);
}

static void checkNotPane(const GlassWindow& window, const char* shape)
{
    checkUnused("normal", window.normal == Vec3d(0, 0, 1), "(0, 0, 1)", shape);
    checkUnused("distance", window.distance == 0, "0", shape);
    checkUnused("wedge", window.wedge.empty(), "empty", shape);
    checkUnused("curvature", window.curvature == 0, "0", shape);
}

static void checkFlat(const GlassWindow& window)
{
    checkPane(window);
    checkNotRound(window, "flat (window.shape)");
    checkUnused("curvature", window.curvature == 0, "0", "flat (window.shape)");
}

//! All faces are met in front of the camera, before the centre of the spheres: else the pane is none.
static void checkBent(const GlassWindow& window)
{
    checkPane(window);
    checkNotRound(window, "a bent pane");
    double depth = window.distance;
    for (double thickness : window.thickness)
        depth += thickness;
    if (!(std::abs(window.curvature)*depth < 1) || !std::isfinite(window.curvature))
        CV_Error_(Error::StsOutOfRange, ("window.curvature is %g, a radius of %g; it must be finite, and the radius larger than "
                                         "window.distance with all of window.thickness, %g, in the same unit", window.curvature,
                                         1/window.curvature, depth));
}

static void checkRadius(const GlassWindow& window)
{
    if (!(window.radius > 0 && window.radius <= MAX_LENGTH))
        CV_Error_(Error::StsOutOfRange, ("window.radius is %g; it must be positive and finite", window.radius));
    if (!std::isfinite(cv::norm(window.center)))
        CV_Error_(Error::StsBadArg, ("window.center is (%g, %g, %g); it must be finite", window.center[0], window.center[1],
                                     window.center[2]));
}

static void checkTube(const GlassWindow& window)
{
    const Vec3d &axis = window.axis, &center = window.center;
    const double length = cv::norm(axis);
    checkRadius(window);
    if (!(std::abs(length - 1) < 1e-5))         // as a normal
        CV_Error_(Error::StsBadArg, ("window.axis is (%g, %g, %g) with length %g; it must be a unit vector", axis[0], axis[1], axis[2],
                                     length));
    const double offset = cv::norm(center - center.dot(axis)/(length*length)*axis);
    if (!(offset < window.radius))
        CV_Error_(Error::StsOutOfRange, ("window.center is (%g, %g, %g), an axis at %g from the camera; the camera must be inside the "
                                         "tube, whose window.radius is %g: that of its inner face, in the same unit", center[0],
                                         center[1], center[2], offset, window.radius));
    checkNotPane(window, "a tube");
}

static void checkDome(const GlassWindow& window)
{
    const Vec3d& center = window.center;
    const double offset = cv::norm(center);
    checkRadius(window);
    if (!(offset < window.radius))
        CV_Error_(Error::StsOutOfRange, ("window.center is (%g, %g, %g), %g from the camera; the camera must be inside the dome, whose "
                                         "window.radius is %g: that of its inner face, in the same unit", center[0], center[1],
                                         center[2], offset, window.radius));
    checkUnused("axis", window.axis == Vec3d(), "(0, 0, 0)", "a dome");
    checkNotPane(window, "a dome");
}

void GlassWindow::check() const
{
    switch (shape)
    {
    case WINDOW_FLAT: checkFlat(*this); break;
    case WINDOW_DOME: checkDome(*this); break;
    case WINDOW_TUBE: checkTube(*this); break;
    case WINDOW_BENT: checkBent(*this); break;
    default:
        CV_Error_(Error::StsOutOfRange, ("window.shape is %d; it must be WINDOW_FLAT (%d), WINDOW_DOME (%d), WINDOW_TUBE (%d) or "
                                         "WINDOW_BENT (%d)", shape, (int)WINDOW_FLAT, (int)WINDOW_DOME, (int)WINDOW_TUBE,
                                         (int)WINDOW_BENT));
    }
    checkBetween("window.innerIndex", innerIndex, 1, MAX_INDEX);
    checkBetween("window.outerIndex", outerIndex, 1, MAX_INDEX);
    if (thickness.size() != index.size())
        CV_Error_(Error::StsUnmatchedSizes, ("window.thickness has %d layers, window.index %d; they must agree",
                                             (int)thickness.size(), (int)index.size()));
    for (size_t i = 0; i < thickness.size(); i++)
    {
        checkBetween("window.thickness", thickness[i], 0, MAX_LENGTH, (int)i);
        checkBetween("window.index", index[i], 1, MAX_INDEX, (int)i);
    }
    if (!wedge.empty())
        checkWedge(*this);
    checkBetween("window.wavelength", wavelength, 0, MAX_LENGTH);
    if (!materials.empty() && materials.size() != index.size() + 2)
        CV_Error_(Error::StsUnmatchedSizes, ("window.materials has %d names; it must be empty or have %d: inner medium, layers, "
                                             "outer medium", (int)materials.size(), (int)index.size() + 2));
}

}} // namespace
