// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PARAMETERS_HPP
#define OPENCV_REFRACT_PARAMETERS_HPP

#include "precomp.hpp"
#include "window/layout.hpp"

/* A window as a vector of parameters. What they are called, their order, which are free: here and nowhere else. */

namespace cv { namespace refract {

// Beyond what there is, and small enough that no product of them overflows.
const double MAX_LENGTH = 1e100, MAX_INDEX = 1e6;

enum class WindowParameter { NORMAL, DISTANCE, CENTER, AXIS, RADIUS, THICKNESS, INDEX, INNER_INDEX, OUTER_INDEX, WEDGE, CURVATURE };

WindowLayout windowLayout(int layers, bool hasWedge = false, int shape = WINDOW_FLAT);
WindowLayout windowLayout(const GlassWindow& window);
WindowParameter kindOf(const WindowLayout& at, int parameter);

/** normal[0], normal[1], normal[2], distance, thickness[0], ..., index[0], ..., innerIndex, outerIndex, wedge[0][0], wedge[0][1], ...
A dome's begin center[0], center[1], center[2], radius, a tube's center[0], ..., axis[0], ..., radius; a bent window's end with
curvature. */
std::vector<String> windowParameterNames(const WindowLayout& at);
std::vector<double> windowParameters(const GlassWindow& window);
/** The window with other parameters; it keeps what is none of them.
@param parameters of a normal of any length */
GlassWindow withParameters(GlassWindow window, const double* parameters);

//! GlassCalibrationFlags -> which are free. The normal is always.
std::vector<bool> freeWindowParameters(const WindowLayout& at, int flags);
//! What no parameter falls below while it is estimated, by where it starts.
double lowerBound(WindowParameter kind, double start);
//! What GlassWindow::check() refuses beyond.
double upperBound(WindowParameter kind);

}} // namespace

#endif // OPENCV_REFRACT_PARAMETERS_HPP
