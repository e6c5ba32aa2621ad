// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// GlassWindow(...) with all fields: C++ has a constructor for one pane only.
#pragma once

static bool numberOrList(PyObject* o, std::vector<double>& v, const char* name)
{
    v.assign(1, 0.);
    return isNumber(o) ? pyopencv_to(o, v[0], ArgInfo(name, 0)) : pyopencv_to(o, v, ArgInfo(name, 0));
}

static bool fillWindow(refract::GlassWindow& window, PyObject* args, PyObject* keywords)
{
    static const char* const NAMES[] = { "normal", "thickness", "index", "distance", "outerIndex", "innerIndex", "wedge",
                                         "wavelength", "materials", "shape", "center", "radius", "axis", "curvature", NULL };
    PyObject *normal = NULL, *thickness = NULL, *index = NULL, *distance = NULL, *outerIndex = NULL, *innerIndex = NULL, *wedge = NULL,
             *wavelength = NULL, *materials = NULL, *shape = NULL, *center = NULL, *radius = NULL, *axis = NULL, *curvature = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|OOOOO$OOOOOOOOO:GlassWindow", (char**)NAMES, &normal, &thickness, &index, &distance,
                                     &outerIndex, &innerIndex, &wedge, &wavelength, &materials, &shape, &center, &radius,
                                     &axis, &curvature))
        return false;
    if (!pyopencv_to(shape, window.shape, ArgInfo("shape", 0)))
        return false;
    const bool isPane = window.shape == refract::WINDOW_FLAT || window.shape == refract::WINDOW_BENT;
    if (!thickness != !index || (isPane && !normal != !thickness))
        return failmsg("normal, thickness and index belong together; for a surface without a pane both are empty lists");
    Vec3d n;
    if ((normal && !pyopencv_to(normal, n, ArgInfo("normal", 0)))
        || (thickness && !(numberOrList(thickness, window.thickness, "thickness") && numberOrList(index, window.index, "index"))))
        return false;
    if (!pyopencv_to(center, window.center, ArgInfo("center", 0)) || !pyopencv_to(radius, window.radius, ArgInfo("radius", 0))
        || !pyopencv_to(axis, window.axis, ArgInfo("axis", 0)) || !pyopencv_to(curvature, window.curvature, ArgInfo("curvature", 0))
        || !pyopencv_to(distance, window.distance, ArgInfo("distance", 0))
        || !pyopencv_to(outerIndex, window.outerIndex, ArgInfo("outerIndex", 0))
        || !pyopencv_to(innerIndex, window.innerIndex, ArgInfo("innerIndex", 0))
        || !pyopencv_to_safe(wedge, window.wedge, ArgInfo("wedge", 0))
        || !pyopencv_to(wavelength, window.wavelength, ArgInfo("wavelength", 0))
        || !pyopencv_to_safe(materials, window.materials, ArgInfo("materials", 0)))
        return false;
    try
    {
        if (normal)
            window.normal = refract::GlassWindow(n, 0., 1.).normal;     // normalised, or refused
        if (axis)
            window.axis = refract::GlassWindow::tube(Vec3d(), window.axis, 1., 0., 1.).axis;
        window.check();
        return true;
    }
    catch (const cv::Exception& e)
    {
        raise(e);
        return false;
    }
}

static PyObject* makeWindow(PyTypeObject*, PyObject* args, PyObject* keywords)
{
    refract::GlassWindow window;
    if (fillWindow(window, args, keywords))
        return pyopencv_from(window);
    blame("GlassWindow");
    return NULL;
}

template<> newfunc makerOf<&pyopencv_cv_refract_refract_GlassWindow_GlassWindow>() { return makeWindow; }
