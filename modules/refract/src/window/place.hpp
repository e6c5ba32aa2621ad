// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PLACE_HPP
#define OPENCV_REFRACT_PLACE_HPP

#include "precomp.hpp"
#include "window/layout.hpp"

namespace cv { namespace refract {

/* Where a window is: the parameters that its layout has first. Of a pane the normal, of a dome the center, of a tube the center and
the axis. Estimation asks here what each shape may be, and needs to know no shape. */

//! Of the shape's own fields; the others are as they are.
struct WindowPlace
{
    Vec3d normal, center, axis;
};
WindowPlace placeOf(const GlassWindow& window);
GlassWindow withPlace(GlassWindow window, const WindowPlace& place);

//! It has a center and a radius, not a normal and a distance.
bool hasCenter(int shape);

//! From the camera to the first surface, along its normal through the camera; negative: the camera is beyond it.
double distanceToSurface(const GlassWindow& window);

//! Whether a fit may try these parameters: a camera before the window, lengths and indices in their ranges.
bool isPossible(const WindowLayout& at, const double* parameters);

/** Other places of the window, where a cost may have other minima: so many normals about the optical axis, tilted by so much; of a dome
or tube centers that are as far from the camera, in radii, a dome's also before and behind it.
@param first where the ring begins, in steps */
std::vector<WindowPlace> placesAround(const GlassWindow& window, double tilt, int count, double first);

//! On the other side of the optical axis, and of the camera: a place that images can mistake for this one.
std::vector<WindowPlace> mirroredPlaces(const GlassWindow& window);

//! The angle between two places: of normals and axes, and that of centers as the camera sees them from a radius away.
double angleBetweenPlaces(const GlassWindow& a, const GlassWindow& b);

}} // namespace

#endif // OPENCV_REFRACT_PLACE_HPP
