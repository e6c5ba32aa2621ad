// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/parameters.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

static const double LEAST_THICKNESS = 1e-6;      // of its start

WindowLayout windowLayout(int layers, bool hasWedge, int shape)
{
    WindowLayout at;
    at.shape = shape;
    at.layers = layers;
    at.normal = 0;
    at.axis = 3;
    at.media = at.distance = shape == WINDOW_TUBE ? 6 : 3;
    at.thickness = at.distance + 1;
    at.index = at.thickness + layers;
    at.innerIndex = at.index + layers;
    at.outerIndex = at.innerIndex + 1;
    at.wedge = at.outerIndex + 1;
    at.curvature = at.wedge + (hasWedge ? 2*layers : 0);
    at.count = at.curvature + (shape == WINDOW_BENT ? 1 : 0);
    return at;
}

WindowLayout windowLayout(const GlassWindow& window)
{
    return windowLayout((int)window.thickness.size(), !window.wedge.empty(), window.shape);
}

WindowParameter kindOf(const WindowLayout& at, int parameter)
{
    CV_DbgAssert(parameter >= 0 && parameter < at.count);
    const bool isRound = hasCenter(at.shape);
    return parameter < at.axis ? (isRound ? WindowParameter::CENTER : WindowParameter::NORMAL) :
           parameter < at.distance ? WindowParameter::AXIS :
           parameter < at.thickness ? (isRound ? WindowParameter::RADIUS : WindowParameter::DISTANCE) :
           parameter < at.index ? WindowParameter::THICKNESS :
           parameter < at.innerIndex ? WindowParameter::INDEX :
           parameter < at.outerIndex ? WindowParameter::INNER_INDEX :
           parameter < at.wedge ? WindowParameter::OUTER_INDEX :
           parameter < at.curvature ? WindowParameter::WEDGE : WindowParameter::CURVATURE;
}

std::vector<String> windowParameterNames(const WindowLayout& at)
{
    std::vector<String> names(at.count);
    const bool isRound = hasCenter(at.shape);
    for (int i = 0; i < 3; i++)
        names[at.normal + i] = format(isRound ? "center[%d]" : "normal[%d]", i);
    for (int i = at.axis; i < at.media; i++)
        names[i] = format("axis[%d]", i - at.axis);
    names[at.distance] = isRound ? "radius" : "distance";
    for (int i = 0; i < at.layers; i++)
    {
        names[at.thickness + i] = format("thickness[%d]", i);
        names[at.index + i] = format("index[%d]", i);
    }
    names[at.innerIndex] = "innerIndex";
    names[at.outerIndex] = "outerIndex";
    for (int i = 0; i < at.curvature - at.wedge; i++)
        names[at.wedge + i] = format("wedge[%d][%d]", i/2, i % 2);
    if (at.count > at.curvature)
        names[at.curvature] = "curvature";
    return names;
}

std::vector<double> windowParameters(const GlassWindow& window)
{
    const WindowLayout at = windowLayout(window);
    std::vector<double> p(at.count);
    const bool isRound = hasCenter(window.shape);
    const Vec3d& where = isRound ? window.center : window.normal;
    std::copy(where.val, where.val + 3, p.begin() + at.normal);
    std::copy(window.axis.val, window.axis.val + (at.media - at.axis), p.begin() + at.axis);
    p[at.distance] = isRound ? window.radius : window.distance;
    std::copy(window.thickness.begin(), window.thickness.end(), p.begin() + at.thickness);
    std::copy(window.index.begin(), window.index.end(), p.begin() + at.index);
    p[at.innerIndex] = window.innerIndex;
    p[at.outerIndex] = window.outerIndex;
    for (int i = 0; i < at.curvature - at.wedge; i++)
        p[at.wedge + i] = window.wedge[i/2][i % 2];
    if (at.count > at.curvature)
        p[at.curvature] = window.curvature;
    return p;
}

GlassWindow withParameters(GlassWindow window, const double* p)
{
    const WindowLayout at = windowLayout(window);
    const int layers = at.layers;
    if (hasCenter(window.shape))
    {
        window.center = Vec3d(p + at.normal);
        window.radius = p[at.distance];
        if (window.shape == WINDOW_TUBE)
            window.axis = normalize(Vec3d(p + at.axis));
    }
    else
    {
        window.normal = normalize(Vec3d(p + at.normal));
        window.distance = p[at.distance];
    }
    window.thickness.assign(p + at.thickness, p + at.thickness + layers);
    window.index.assign(p + at.index, p + at.index + layers);
    window.innerIndex = p[at.innerIndex];
    window.outerIndex = p[at.outerIndex];
    for (int i = 0; i < at.curvature - at.wedge; i++)
        window.wedge[i/2][i % 2] = p[at.wedge + i];
    if (at.count > at.curvature)
        window.curvature = p[at.curvature];
    return window;
}

std::vector<bool> freeWindowParameters(const WindowLayout& at, int flags)
{
    std::vector<bool> isFree(at.count, false);
    for (int i = 0; i < at.count; i++)
        switch (kindOf(at, i))
        {
        case WindowParameter::NORMAL: case WindowParameter::CENTER: case WindowParameter::AXIS: isFree[i] = true; break;
        case WindowParameter::DISTANCE: isFree[i] = (flags & GLASS_FREE_DISTANCE) != 0; break;
        case WindowParameter::THICKNESS: isFree[i] = (flags & GLASS_FREE_THICKNESS) != 0; break;
        case WindowParameter::INDEX: isFree[i] = (flags & GLASS_FREE_INDEX) != 0; break;
        case WindowParameter::INNER_INDEX: break;
        case WindowParameter::RADIUS: isFree[i] = (flags & GLASS_FREE_RADIUS) != 0; break;
        case WindowParameter::OUTER_INDEX: isFree[i] = (flags & GLASS_FREE_OUTER_INDEX) != 0; break;
        case WindowParameter::WEDGE: isFree[i] = (flags & GLASS_FREE_WEDGE) != 0; break;
        case WindowParameter::CURVATURE: isFree[i] = (flags & GLASS_FREE_CURVATURE) != 0; break;
        }
    return isFree;
}

double lowerBound(WindowParameter kind, double start)
{
    switch (kind)
    {
    case WindowParameter::NORMAL: case WindowParameter::CENTER: case WindowParameter::AXIS: case WindowParameter::WEDGE:
    case WindowParameter::CURVATURE:
        return -std::numeric_limits<double>::infinity();
    case WindowParameter::DISTANCE: return 0.;
    case WindowParameter::THICKNESS: case WindowParameter::RADIUS: return LEAST_THICKNESS*start;
    default: return 1.;         // an index
    }
}

double upperBound(WindowParameter kind)
{
    switch (kind)
    {
    case WindowParameter::NORMAL: case WindowParameter::CENTER: case WindowParameter::AXIS: case WindowParameter::WEDGE:
    case WindowParameter::CURVATURE:
        return std::numeric_limits<double>::infinity();
    case WindowParameter::DISTANCE: case WindowParameter::RADIUS: case WindowParameter::THICKNESS: return MAX_LENGTH;
    default: return MAX_INDEX;
    }
}

}} // namespace
