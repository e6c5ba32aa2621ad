// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_CURVED_HPP
#define OPENCV_REFRACT_CURVED_HPP

#include "precomp.hpp"
#include "window/curved_kernels.hpp"
#include "window/surface.hpp"

/* Where the faces of tubes and bent panes are. */

namespace cv { namespace refract {

//! Rows: the frame of a tube, whose axis is the third.
Matx33d tubeAxes(const Vec3d& axis);

//! The faces of a tube, in the frame of tubeAxes.
std::vector<CurvedFace> tubeFaces(const GlassWindow& window);

/** The faces of a bent pane, in the frame of windowAxes: spheres about one point, and where faces lean (see wedge.hpp) each touches its
leaning plane on the axis along the window's normal.
@param tangents facesOf() the pane without curvature */
std::vector<CurvedFace> bentFaces(const GlassWindow& window, const std::vector<Face>& tangents);

//! A face in the camera's frame.
Surface surfaceOf(const CurvedFaces& window, const CurvedFace& face);

/** From a direction p at the camera to the point P on the last face and the optical vector p behind it; all in the window's frame.
@return whether light gets there; if not, why */
uchar traceCurved(const CurvedFaces& window, Vec3d& P, Vec3d& p);

//! Whether the light of a direction, not unit, goes out and passes X/w, as the best that double can tell. @param X finite
bool doesReach(const CurvedFaces& window, const Vec3d& X, double w, const Vec3d& direction);

//! From a direction towards that of X/w, by damped Newton steps as far as they get nearer.
void approachPoint(const CurvedFaces& window, const Vec3d& X, double w, Vec3d& direction);

}} // namespace

#endif // OPENCV_REFRACT_CURVED_HPP
