// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_WEDGE_HPP
#define OPENCV_REFRACT_WEDGE_HPP

#include "precomp.hpp"
#include "window/faces.hpp"

/* Where the faces of a window with a wedge are. With W = wedge[0] + ... + wedge[i - 1] the normal of face i (0: the camera's) is
the first one's, turned by |W| radians in the direction W:

    m = cos|W| n + sin|W|/|W| (W1 e1 + W2 e2),        m.X = cos|W| (distance + thickness[0] + ... + thickness[i - 1])

e1 is the camera's x axis made orthogonal to n, e2 = n x e1. */

namespace cv { namespace refract {

//! Rows e1, e2, n.
Matx33d windowAxes(const Vec3d& normal);

//! The faces in the frame of windowAxes.
std::vector<Face> facesOf(const GlassWindow& window);

/** The same window in the frame of another camera, X' = R X + T: the normal, the distance, the wedge along the other camera's axes
and the thickness along its own normal through its centre of projection. The distance is negative beyond the first face. */
GlassWindow windowInFrame(GlassWindow window, const Matx33d& R, const Vec3d& T);

}} // namespace

#endif // OPENCV_REFRACT_WEDGE_HPP
