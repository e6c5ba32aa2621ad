// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SHEET_HPP
#define OPENCV_REFRACT_SHEET_HPP

#include "points/pixel_block.hpp"
#include "points/point_kernels.hpp"

/* What half a pixel tells. All pixels with its known coordinate see a sheet: a plane, or behind a window nearly so. Where an estimate
starts, it is the plane of two of their rays, next to the principal point. */

namespace cv { namespace refract {

struct Sheets : Rays
{
    double normal[3*BLOCK];         //!< as columns; NaN where the pixel is whole, or has no ray

    Vec3d normalOf(int i) const { return Vec3d(normal[i], normal[BLOCK + i], normal[2*BLOCK + i]); }
    bool isSheet(int i) const { return !std::isnan(normal[i]); }
};

//! Rays of whole pixels, and of halves a ray of the sheet with the sheet's normal; at most a block.
void unprojectSheets(const Camera& camera, int n, const double* u, const double* v, Sheets& sheets, uchar* status);

/** Of points on rays of a whole pixel each, of which this camera sees half: slides them along their rays to where it does. It is exact:
three coordinates determine a point.
@param camera number c of the block's
@param rays of the other camera
@param off by how many pixels points are off at most, in and out; 0: they are there; as it was where this does not lead nearer */
void slideToSheet(const PlacedCamera& camera, int c, const CameraRays& rays, int n, PixelBlock& block, double* off);

}} // namespace

#endif // OPENCV_REFRACT_SHEET_HPP
