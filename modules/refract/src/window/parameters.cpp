// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "window/parameters.hpp"

namespace cv { namespace refract {

static const double LEAST_THICKNESS = 1e-6;      // of its start

WindowLayout windowLayout(int layers, bool hasWedge, int shape)
{
    WindowLayout at;
    at.shape = shape;
    at.layers = layers;
    at.normal = 0;
    at.media = at.distance = 3;
    at.thickness = at.distance + 1;
    at.index = at.thickness + layers;
    at.innerIndex = at.index + layers;
    at.outerIndex = at.innerIndex + 1;
    at.wedge = at.outerIndex + 1;
    at.count = at.wedge + (hasWedge ? 2*layers : 0);
    return at;
}

WindowLayout windowLayout(const GlassWindow& window)
{
    return windowLayout((int)window.thickness.size(), !window.wedge.empty(), window.shape);
}

WindowParameter kindOf(const WindowLayout& at, int parameter)
{
    CV_DbgAssert(parameter >= 0 && parameter < at.count);
    const bool isDome = at.shape == WINDOW_DOME;
    return parameter < at.distance ? (isDome ? WindowParameter::CENTER : WindowParameter::NORMAL) :
           parameter < at.thickness ? (isDome ? WindowParameter::RADIUS : WindowParameter::DISTANCE) :
           parameter < at.index ? WindowParameter::THICKNESS :
           parameter < at.innerIndex ? WindowParameter::INDEX :
           parameter < at.outerIndex ? WindowParameter::INNER_INDEX :
           parameter < at.wedge ? WindowParameter::OUTER_INDEX : WindowParameter::WEDGE;
}

std::vector<String> windowParameterNames(const WindowLayout& at)
{
    std::vector<String> names(at.count);
    for (int i = 0; i < 3; i++)
        names[at.normal + i] = format(at.shape == WINDOW_DOME ? "center[%d]" : "normal[%d]", i);
    names[at.distance] = at.shape == WINDOW_DOME ? "radius" : "distance";
    for (int i = 0; i < at.layers; i++)
    {
        names[at.thickness + i] = format("thickness[%d]", i);
        names[at.index + i] = format("index[%d]", i);
    }
    names[at.innerIndex] = "innerIndex";
    names[at.outerIndex] = "outerIndex";
    for (int i = 0; i < at.count - at.wedge; i++)
        names[at.wedge + i] = format("wedge[%d][%d]", i/2, i % 2);
    return names;
}

std::vector<double> windowParameters(const GlassWindow& window)
{
    const WindowLayout at = windowLayout(window);
    std::vector<double> p(at.count);
    const bool isDome = window.shape == WINDOW_DOME;
    const Vec3d& where = isDome ? window.center : window.normal;
    std::copy(where.val, where.val + 3, p.begin() + at.normal);
    p[at.distance] = isDome ? window.radius : window.distance;
    std::copy(window.thickness.begin(), window.thickness.end(), p.begin() + at.thickness);
    std::copy(window.index.begin(), window.index.end(), p.begin() + at.index);
    p[at.innerIndex] = window.innerIndex;
    p[at.outerIndex] = window.outerIndex;
    for (int i = 0; i < at.count - at.wedge; i++)
        p[at.wedge + i] = window.wedge[i/2][i % 2];
    return p;
}

GlassWindow withParameters(GlassWindow window, const double* p)
{
    const WindowLayout at = windowLayout(window);
    const int layers = at.layers;
    if (window.shape == WINDOW_DOME)
    {
        window.center = Vec3d(p + at.normal);
        window.radius = p[at.distance];
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
    for (int i = 0; i < at.count - at.wedge; i++)
        window.wedge[i/2][i % 2] = p[at.wedge + i];
    return window;
}

std::vector<bool> freeWindowParameters(const WindowLayout& at, int flags)
{
    std::vector<bool> isFree(at.count, false);
    for (int i = 0; i < at.count; i++)
        switch (kindOf(at, i))
        {
        case WindowParameter::NORMAL: case WindowParameter::CENTER: isFree[i] = true; break;
        case WindowParameter::DISTANCE: isFree[i] = (flags & GLASS_FREE_DISTANCE) != 0; break;
        case WindowParameter::THICKNESS: isFree[i] = (flags & GLASS_FREE_THICKNESS) != 0; break;
        case WindowParameter::INDEX: isFree[i] = (flags & GLASS_FREE_INDEX) != 0; break;
        case WindowParameter::INNER_INDEX: case WindowParameter::RADIUS: break;
        case WindowParameter::OUTER_INDEX: isFree[i] = (flags & GLASS_FREE_OUTER_INDEX) != 0; break;
        case WindowParameter::WEDGE: isFree[i] = (flags & GLASS_FREE_WEDGE) != 0; break;
        }
    return isFree;
}

double lowerBound(WindowParameter kind, double start)
{
    switch (kind)
    {
    case WindowParameter::NORMAL: case WindowParameter::CENTER: case WindowParameter::WEDGE:
        return -std::numeric_limits<double>::infinity();
    case WindowParameter::DISTANCE: return 0.;
    case WindowParameter::THICKNESS: case WindowParameter::RADIUS: return LEAST_THICKNESS*start;
    default: return 1.;         // an index
    }
}

double upperBound(WindowParameter kind)
{
    const bool isLength = kind == WindowParameter::DISTANCE || kind == WindowParameter::RADIUS || kind == WindowParameter::THICKNESS;
    if (kind == WindowParameter::NORMAL || kind == WindowParameter::CENTER || kind == WindowParameter::WEDGE)
        return std::numeric_limits<double>::infinity();
    return isLength ? MAX_LENGTH : MAX_INDEX;
}

}} // namespace
