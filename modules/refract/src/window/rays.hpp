// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RAYS_HPP
#define OPENCV_REFRACT_RAYS_HPP

#include "precomp.hpp"
#include "arrays/arrays.hpp"
#include "simd/columns.hpp"

namespace cv { namespace refract {

/** Rays of a block of pixels in the scene, o + s d with unit d. The origin is o = tau n + offset with the window's normal n;
the offset is 0 for parallel faces, and across n. A tube's n is across its axis, and so are all its origins. */
struct Rays
{
    double tau[BLOCK], dx[BLOCK], dy[BLOCK], dz[BLOCK];
    double offset[3*BLOCK];         //!< as columns; set only if hasOffset
    bool hasOffset;                 //!< the window has a wedge, is a tube, or is bent

    Vec3d direction(int i) const { return Vec3d(dx[i], dy[i], dz[i]); }
    Vec3d offsetOf(int i) const { return hasOffset ? Vec3d(offset[i], offset[BLOCK + i], offset[2*BLOCK + i]) : Vec3d(); }
    Vec3d origin(int i, const Vec3d& normal) const
    {
        const Vec3d onAxis = tau[i]*normal;
        return hasOffset ? onAxis + offsetOf(i) : onAxis;
    }
    //! As the kernels take it: null where all origins are on the axis.
    Columns offsets() const { return { hasOffset ? const_cast<double*>(offset) : nullptr, 3, BLOCK }; }
};

}} // namespace

#endif // OPENCV_REFRACT_RAYS_HPP
