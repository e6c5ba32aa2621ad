// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FACES_HPP
#define OPENCV_REFRACT_FACES_HPP

#include "window/layout.hpp"

/* The faces of a window with a wedge as the kernels see them. No OpenCV in here, see dispatch/kernels.hpp. */

namespace cv { namespace refract {

/** One face, in the window's frame: axes e1, e2 and the normal n of the first face, origin at the centre of projection. Its unit
normal is m, the plane m.X = distance. */
struct Face
{
    double normal[3], distance;
    double after;                   //!< index of the medium behind it
    double excess;                  //!< after^2 - before^2
    double byHeight;                //!< distance by where the face meets the axis along n
    double byTurn[2][3];            //!< m by e1.dn and e2.dn, as the whole window turns
    double byLean[2][3];            //!< m by the two components by which the face leans against the first
    double distanceByLean[2];
};

//! All faces of a window, the camera's first.
struct TiltedFaces
{
    double axes[9];                 //!< rows e1, e2, n
    const Face* faces;
    int count;
    double inner, outer;            //!< index of the camera's and the scene's medium
    WindowLayout at;                //!< columns of derivatives
};

}} // namespace

#endif // OPENCV_REFRACT_FACES_HPP
